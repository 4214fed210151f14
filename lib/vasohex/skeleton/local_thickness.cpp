#include "vasohex/skeleton/local_thickness.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "vasohex/core/parallel.h"
#include "vasohex/skeleton/point_tree.h"
#include "vasohex/surface/half_edges.h"

namespace vasohex {
namespace {

/// Where the angle between two contact points seen from the ball's centre is smaller, the wall is rough, not thin.
constexpr double kLeastAngle = 0.6;
/// Cosine of the angle between both contact points from which on a ball spans the lumen: in convex edges of the wall
/// and at the narrow sides of flat sections balls become ever smaller, and their contact points come close.
constexpr double kAcross = -0.7;
/// Of a radius.
constexpr double kTolerance = 0.02;
/// Balls smaller than this part of the shortest edge at their point see facets, not vessels.
constexpr double kOfEdge = 0.5;
/// A ball counts for points of the wall up to this part of its radius from the centre.
constexpr double kReach = 1.1;
/// ... if their normal is within 60 degrees of the ball's.
constexpr double kAlike = 0.5;

/// Unit normals of the points, weighted by the angles of the triangles; zero for points of no wall triangle.
std::vector<Vec3> wall_normals(const TriSurface& surface, const std::vector<bool>& is_cap) {
  std::vector<Vec3> normals(surface.points.size(), Vec3::Zero());
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    const Vec3 normal = area_normal(surface, static_cast<int>(i));
    if (normal.norm() == 0 || is_cap[i]) {
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const Vec3& p = surface.points[t[k]];
      const double angle = angle_between(surface.points[t[(k + 1) % 3]] - p, surface.points[t[(k + 2) % 3]] - p);
      normals[t[k]] += angle * normal.normalized();
    }
  }
  for (Vec3& n : normals) {
    n = n.norm() > 1e-6 ? n.normalized() : Vec3::Zero();
  }
  return normals;
}

/// The shortest edge at each point.
std::vector<double> shortest_edges(const TriSurface& surface) {
  std::vector<double> shortest(surface.points.size(), std::numeric_limits<double>::infinity());
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      const double length = (surface.points[a] - surface.points[b]).norm();
      shortest[a] = std::min(shortest[a], length);
      shortest[b] = std::min(shortest[b], length);
    }
  }
  return shortest;
}

/// Radius of the ball inside that touches the wall at point i and once more, across the lumen; 0 if there is none.
/// The search starts from a ball of radius `guess`.
double ball_at(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const PointTree& tree, int i,
               double guess, double largest) {
  const Vec3 &p = points[i], &n = normals[i];
  double radius = guess;
  int touched = -1;
  for (int step = 0; step < 60; ++step) {
    const int j = tree.nearest(p - radius * n, i, radius * (1 - kTolerance));
    if (j < 0 && touched < 0 && radius < largest) {
      radius *= 2;
      continue;
    }
    if (j < 0 || (p - points[j]).dot(n) <= 0) {
      break;
    }
    const Vec3 d = p - points[j];
    const double next = d.squaredNorm() / (2 * d.dot(n));
    const Vec3 to_j = points[j] - (p - next * n);
    if (touched >= 0 && n.dot(to_j) > std::cos(kLeastAngle) * to_j.norm()) {
      break;
    }
    radius = next;
    touched = j;
  }
  if (touched < 0) {
    return 0;
  }
  const Vec3 opposite = (points[touched] - (p - radius * n)).normalized();
  // A ball outside the lumen touches the wall from outside.
  return opposite.dot(n) < kAcross && opposite.dot(normals[touched]) > 0.3 ? radius : 0;
}

/// Points without a width take that of the nearest one along the edges of the triangles.
void fill(const TriSurface& surface, std::vector<double>& widths, double otherwise) {
  const std::vector<Vec3>& points = surface.points;
  std::vector<std::vector<int>> neighbours(points.size());
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) {
      neighbours[t[k]].push_back(t[(k + 1) % 3]);
      neighbours[t[k]].push_back(t[(k + 2) % 3]);
    }
  }
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (widths[i] > 0) {
      distance[i] = 0;
      open.emplace(0, i);
    }
  }
  while (!open.empty()) {
    const auto [d, i] = open.top();
    open.pop();
    for (const int j : neighbours[i]) {
      const double next = d + (points[i] - points[j]).norm();
      if (d == distance[i] && next < distance[j]) {
        distance[j] = next;
        widths[j] = widths[i];
        open.emplace(next, j);
      }
    }
  }
  std::replace(widths.begin(), widths.end(), 0.0, otherwise);
}

}  // namespace

std::vector<double> local_thickness(const TriSurface& surface, const std::vector<bool>& is_cap, const Run& run) {
  const std::vector<Vec3>& points = surface.points;
  const std::vector<Vec3> all_normals = wall_normals(surface, is_cap);
  std::vector<Vec3> wall, normals;
  std::vector<int> place;  // of wall points in `points`
  Box box;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (all_normals[i].norm() > 0) {
      place.push_back(static_cast<int>(i));
      wall.push_back(points[i]);
      normals.push_back(all_normals[i]);
      box.add(points[i]);
    }
  }
  const PointTree tree(wall);
  const double largest = (box.max - box.min).norm();
  const std::vector<double> shortest = shortest_edges(surface);
  std::vector<double> balls(wall.size());
  parallel_for(run, wall.size(), 256, [&](std::size_t begin, std::size_t end) {
    double guess = largest;
    for (std::size_t i = begin; i < end; ++i) {
      balls[i] = ball_at(wall, normals, tree, static_cast<int>(i), guess, largest);
      if (balls[i] < kOfEdge * shortest[place[i]]) {
        balls[i] = 0;
      }
      guess = balls[i] > 0 ? 2 * balls[i] : guess;
    }
  });

  std::vector<int> order(wall.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return balls[a] > balls[b]; });
  std::vector<double> widths(points.size(), 0);
  for (const int i : order) {
    const double radius = balls[i];
    if (radius <= widths[place[i]]) {
      continue;
    }
    const Vec3 centre = wall[i] - radius * normals[i];
    tree.within(centre, kReach * radius, [&](int j) {
      const Vec3 d = wall[j] - centre;
      if (d.dot(normals[j]) >= kAlike * d.norm()) {
        widths[place[j]] = std::max(widths[place[j]], radius);
      }
    });
  }
  fill(surface, widths, largest);
  return widths;
}

}  // namespace vasohex
