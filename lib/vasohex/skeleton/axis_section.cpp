#include "vasohex/skeleton/axis_section.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "vasohex/skeleton/plane_section.h"
#include "vasohex/surface/half_edges.h"

namespace vasohex {
namespace {

constexpr double kLeastArc = 0.45;  ///< part of the way around that lies on the circle
constexpr double kOff = 0.1;        ///< radii: what lies further from the circle is not of it
constexpr double kMoved = 0.5;      ///< radii

double angle_around(const Vec3& centre, const Vec3& normal, const Vec3& a, const Vec3& b) {
  return std::atan2(normal.dot((a - centre).cross(b - centre)), (a - centre).dot(b - centre));
}

/// Centroid and area of a polygon in the plane with `normal`.
std::pair<Vec3, double> centroid_of(const std::vector<Vec3>& polygon, const Vec3& normal) {
  Vec3 sum = Vec3::Zero();
  double twice_area = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const double a = (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]).dot(normal);
    sum += a / 3 * (polygon[0] + polygon[i] + polygon[i + 1]);
    twice_area += a;
  }
  return {twice_area > 0 ? Vec3(sum / twice_area) : polygon[0], twice_area / 2};
}

/// The loop around the origin, otherwise the nearest.
std::optional<SectionLoop> loop_around(const std::vector<SectionLoop>& loops, const Vec3& origin,
                                       const Vec3& normal) {
  const SectionLoop* best = nullptr;
  double least = 0;
  for (const SectionLoop& loop : loops) {
    double around = 0, distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < loop.points.size(); ++i) {
      around += angle_around(origin, normal, loop.points[i], loop.points[(i + 1) % loop.points.size()]);
      distance = std::min(distance, (loop.points[i] - origin).norm());
    }
    const double badness = around > std::numbers::pi ? -1 : distance;
    if (best == nullptr || badness < least) {
      best = &loop;
      least = badness;
    }
  }
  return best == nullptr ? std::nullopt : std::optional(*best);
}

/// Least-squares circle [Coope 1993: linear in centre and r^2 - c^2] through points in a plane.
struct Circle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 0;
};

std::optional<Circle> fitted(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& weights) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Vec3 right = Vec3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 row(2 * points[i].x(), 2 * points[i].y(), 1);
    matrix += weights[i] * row * row.transpose();
    right += weights[i] * points[i].squaredNorm() * row;
  }
  const Vec3 x = matrix.ldlt().solve(right);
  const double square = x.z() + x.head<2>().squaredNorm();
  return x.allFinite() && square > 0 ? std::optional(Circle{x.head<2>(), std::sqrt(square)}) : std::nullopt;
}

}  // namespace

PartedLumen parted_lumen(const ClosedLumen& lumen, const std::vector<int>& vessel_of, std::size_t vessels) {
  PartedLumen parted{lumen, vessel_of, std::vector<std::vector<int>>(vessels)};
  for (int h = 0; h < static_cast<int>(lumen.opposite.size()); ++h) {
    if (const int v = vessel_of[start_point(lumen.surface, h)]; v >= 0) {
      parted.edges[v].push_back(h);
    }
  }
  return parted;
}

std::optional<Section> section_of(const PartedLumen& parted, int vessel, const Vec3& origin, const Vec3& normal) {
  const std::vector<int>& vessel_of = parted.vessel_of;
  const auto best = loop_around(plane_section(parted.lumen, origin, normal, parted.edges[vessel]), origin, normal);
  if (!best) {
    return {};
  }
  std::vector<Vec3> own;
  for (std::size_t i = 0; i < best->points.size(); ++i) {
    if (vessel_of[best->nearest[i]] == vessel) {
      own.push_back(best->points[i]);
    }
  }
  if (own.size() < 3) {
    return {};
  }
  Section section;
  std::tie(section.centre, section.area) = centroid_of(own, normal);
  for (std::size_t i = 0; i < best->points.size(); ++i) {
    const std::size_t j = (i + 1) % best->points.size();
    if (vessel_of[best->nearest[i]] == vessel && vessel_of[best->nearest[j]] == vessel) {
      section.own += angle_around(section.centre, normal, best->points[i], best->points[j]) / (2 * std::numbers::pi);
    }
  }
  return section;
}

std::optional<Section> circle_of(const PartedLumen& parted, const std::vector<int>& vessels, const Vec3& origin,
                                 const Vec3& normal, double radius) {
  std::vector<int> edges;
  for (const int v : vessels) {
    edges.insert(edges.end(), parted.edges[v].begin(), parted.edges[v].end());
  }
  const auto loop = loop_around(plane_section(parted.lumen, origin, normal, edges), origin, normal);
  if (!loop) {
    return {};
  }
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Eigen::Vector2d> points;  // middles of the pieces of the loop, in terms of the radius
  std::vector<double> lengths;
  for (std::size_t i = 0; i < loop->points.size(); ++i) {
    const Vec3 &a = loop->points[i], &b = loop->points[(i + 1) % loop->points.size()];
    const Vec3 middle = ((a + b) / 2 - origin) / radius;
    points.emplace_back(middle.dot(u), middle.dot(v));
    lengths.push_back((b - a).norm() / radius);
  }
  Circle circle{Eigen::Vector2d::Zero(), 1};
  double on_circle = 0;
  for (const double band : {0.5, 0.35, 0.25, 2 * kOff, 2 * kOff}) {
    std::vector<double> weights(points.size());
    on_circle = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double off = ((points[i] - circle.centre).norm() / circle.radius - 1) / band;
      on_circle += std::abs(off) * band < kOff ? lengths[i] : 0;
      weights[i] = lengths[i] * std::pow(std::max(1 - off * off, 0.0), 2);
    }
    const auto next = fitted(points, weights);
    if (!next || next->centre.norm() > kMoved || next->radius < 0.7 || next->radius > 1.4) {
      return {};
    }
    circle = *next;
  }
  const double arc = on_circle / (2 * std::numbers::pi * circle.radius);
  if (arc < kLeastArc) {
    return {};
  }
  const double r = circle.radius * radius;
  return Section{origin + radius * (circle.centre.x() * u + circle.centre.y() * v), std::numbers::pi * r * r, arc};
}

}  // namespace vasohex
