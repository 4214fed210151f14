#include "vasohex/surface/triangle_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vasohex/surface/half_edges.h"
#include "vasohex/surface/repair_triangles.h"

namespace vasohex {
namespace {

constexpr double kProlonged = 1.5;  // radii of the end, beyond its plane
constexpr double kRimReach = 0.25;  // radii of the end, along its rim

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

/// Unit normals along a closed rim, [rim]: of the triangles there by their areas, less the further along the rim they
/// are, up to `reach`. Half the lumen may be judged by one of them, so no splinter must decide it.
std::vector<Vec3> rim_normals(const TriSurface& surface, const std::vector<int>& rim, const std::vector<Vec3>& areas,
                              double reach) {
  const std::size_t n = rim.size();
  std::vector<Vec3> normals;
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 sum = areas[rim[i]];
    for (const std::size_t step : {std::size_t{1}, n - 1}) {
      double along = 0;
      for (std::size_t k = 1, j = i; k <= n / 2; ++k) {
        const std::size_t next = (j + step) % n;
        along += (surface.points[rim[next]] - surface.points[rim[j]]).norm();
        if (along >= reach) {
          break;
        }
        sum += (1 - along / reach) * areas[rim[next]];
        j = next;
      }
    }
    normals.push_back(unit(sum));
  }
  return normals;
}

}  // namespace

std::vector<Vec3> angle_weighted_normals(const TriSurface& surface) {
  std::vector<Vec3> normals(surface.points.size(), Vec3::Zero());
  for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
    const Vec3 normal = unit(area_normal(surface, t));
    for (int k = 0; k < 3; ++k) {
      const auto& corners = surface.triangles[t];
      const Vec3 a = surface.points[corners[(k + 1) % 3]] - surface.points[corners[k]];
      const Vec3 b = surface.points[corners[(k + 2) % 3]] - surface.points[corners[k]];
      normals[corners[k]] += std::atan2(a.cross(b).norm(), a.dot(b)) * normal;
    }
  }
  for (Vec3& n : normals) {
    n = unit(n);
  }
  return normals;
}

TriangleSurface::TriangleSurface(PreparedSurface prepared, const Network& network)
    : prepared_(std::move(prepared)), radius_(network), tree_(prepared_.surface) {
  const TriSurface& s = prepared_.surface;
  const int n = static_cast<int>(s.triangles.size());
  const std::vector<int> opposite = pair_half_edges(s);
  normals_.resize(n);
  for (int t = 0; t < n; ++t) {
    normals_[t] = unit(area_normal(s, t));
  }
  point_normals_ = angle_weighted_normals(s);
  edge_normals_.resize(3 * static_cast<std::size_t>(n));
  rim_of_edge_.assign(edge_normals_.size(), -1);
  rim_of_point_.assign(s.points.size(), -1);
  rim_normals_.assign(s.points.size(), Vec3::Zero());
  std::vector<Vec3> areas(s.points.size(), Vec3::Zero());
  for (int t = 0; t < n; ++t) {
    for (const int p : s.triangles[t]) {
      areas[p] += area_normal(s, t);
    }
  }
  for (std::size_t e = 0; e < prepared_.rims.size(); ++e) {
    const std::vector<int>& rim = prepared_.rims[e];
    const std::vector<Vec3> normals = rim_normals(s, rim, areas, kRimReach * prepared_.ends[e].radius);
    for (std::size_t i = 0; i < rim.size(); ++i) {
      rim_of_point_[rim[i]] = static_cast<int>(e);
      rim_normals_[rim[i]] = normals[i];
    }
  }
  for (int h = 0; h < 3 * n; ++h) {
    edge_normals_[h] = opposite[h] < 0 ? normals_[h / 3] : unit(normals_[h / 3] + normals_[opposite[h] / 3]);
    if (opposite[h] < 0) {
      rim_of_edge_[h] = rim_of_point_[start_point(s, h)];
    }
  }
}

double TriangleSurface::value_from(const Vec3& x, const ClosestPoint& c, Vec3& gradient, bool& beyond) const {
  const Vec3 away = x - c.point;
  int end = -1;
  const Vec3* normal = &normals_[c.triangle];
  if (c.feature < 3) {
    const int p = prepared_.surface.triangles[c.triangle][c.feature];
    normal = &point_normals_[p];
    end = rim_of_point_[p];
  } else if (c.feature < 6) {
    const int h = 3 * c.triangle + c.feature - 3;
    normal = &edge_normals_[h];
    end = rim_of_edge_[h];
  }
  beyond = end >= 0;
  if (beyond) {
    // the wall goes on, then a plane
    const auto& corners = prepared_.surface.triangles[c.triangle];
    Vec3 onward = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      onward += c.weights[k] * rim_normals_[corners[k]];
    }
    onward = unit(onward);
    const SurfaceEnd& e = prepared_.ends[end];
    const double upright = away.dot(onward), behind = e.normal.dot(x - e.centre) - kProlonged * e.radius;
    gradient = behind > upright ? e.normal : onward;
    return std::max(upright, behind);
  }
  const double upright = away.dot(*normal);
  const double distance = std::sqrt(c.distance2);
  const double sign = upright < 0 ? -1 : 1;
  gradient = std::abs(upright) > 1e-9 * distance && distance > 0 ? Vec3(sign / distance * away) : *normal;
  return sign * distance;
}

double TriangleSurface::value(const Vec3& x, Vec3& gradient) const {
  bool beyond = false;
  return value_from(x, tree_.closest(x), gradient, beyond);
}

double TriangleSurface::value(const Vec3& x) const {
  Vec3 gradient;
  return value(x, gradient);
}

SignCheck check_sign(const TriangleSurface& surface, int triangles) {
  TriSurface closed = surface.prepared().surface;
  const int n = static_cast<int>(closed.triangles.size());
  for (std::size_t e = 0; e < surface.prepared().rims.size(); ++e) {
    const auto& rim = surface.prepared().rims[e];
    const int middle = static_cast<int>(closed.points.size());
    closed.points.push_back(surface.prepared().ends[e].centre);
    for (std::size_t i = 0; i < rim.size(); ++i) {
      closed.triangles.push_back({middle, rim[i], rim[(i + 1) % rim.size()]});
    }
  }
  SignCheck check;
  for (int i = 0; i < std::min(triangles, n); ++i) {
    const int t = static_cast<int>(static_cast<long long>(i) * n / std::min(triangles, n));
    const auto& [a, b, c] = closed.triangles[t];
    const Vec3 middle = (closed.points[a] + closed.points[b] + closed.points[c]) / 3;
    const Vec3 normal = area_normal(closed, t);
    if (!(normal.norm() > 0)) {
      continue;
    }
    const double off = 0.25 * std::min(std::sqrt(normal.norm()), surface.radius(middle));
    for (const double side : {-1.0, 1.0}) {
      const Vec3 x = middle + side * off * normal.normalized();
      ++check.samples;
      if ((winding_number(closed, x) > 0.5) != (surface.value(x) < 0)) {
        check.place = check.contradictions++ == 0 ? x : check.place;
      }
    }
  }
  return check;
}

}  // namespace vasohex
