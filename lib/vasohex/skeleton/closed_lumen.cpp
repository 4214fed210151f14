#include "vasohex/skeleton/closed_lumen.h"

#include <array>
#include <cmath>

#include "vasohex/core/error.h"
#include "vasohex/core/short_text.h"
#include "vasohex/surface/half_edges.h"

namespace vasohex {
namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::bad_input, what); }

[[noreturn]] void fail_manifold(const Vec3& place, const std::string& what) {
  fail("the surface is not a manifold at " + short_text(place) + ": " + what + "; prepare_surface repairs it");
}

void check(const TriSurface& surface) {
  if (surface.triangles.empty()) {
    fail("the surface has no triangles");
  }
  const int n = static_cast<int>(surface.points.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const int i : surface.triangles[t]) {
      if (i < 0 || i >= n) {
        fail("triangle " + std::to_string(t) + " has the point " + std::to_string(i) + ", must be 0 to " +
             std::to_string(n - 1));
      }
      if (!surface.points[i].allFinite()) {
        fail("point " + std::to_string(i) + " of the surface is not finite");
      }
    }
  }
}

/// Half-edges of a surface whose edges have one or two triangles that turn alike.
std::vector<int> oriented_pairs(const TriSurface& surface) {
  std::vector<int> crowded;
  const std::vector<int> opposite = pair_half_edges(surface, &crowded);
  if (!crowded.empty()) {
    fail_manifold(surface.points[start_point(surface, crowded[0])], "an edge has more than two triangles");
  }
  for (int h = 0; h < static_cast<int>(opposite.size()); ++h) {
    if (start_point(surface, h) == end_point(surface, h)) {
      fail_manifold(surface.points[start_point(surface, h)], "a triangle has a corner twice");
    }
    if (opposite[h] >= 0 && start_point(surface, h) == start_point(surface, opposite[h])) {
      fail_manifold(surface.points[start_point(surface, h)], "neighbours turn against each other");
    }
  }
  return opposite;
}

/// Throws if the triangles around some point are more than one fan; `opposite` without openings.
void check_fans(const TriSurface& surface, const std::vector<int>& opposite) {
  std::vector<int> around(surface.points.size(), 0), seen(surface.points.size(), 0);
  for (int h = 0; h < static_cast<int>(opposite.size()); ++h) {
    ++around[start_point(surface, h)];
  }
  for (int h = 0; h < static_cast<int>(opposite.size()); ++h) {
    const int point = start_point(surface, h);
    if (seen[point] == 0) {
      for (int at = h; seen[point] == 0 || at != h; at = next_half_edge(opposite[at])) {
        ++seen[point];
      }
      if (seen[point] != around[point]) {
        fail_manifold(surface.points[point], "pieces meet in one point");
      }
    }
  }
}

/// Mean of a closed polyline, weighted by length.
Vec3 middle_of(const TriSurface& surface, const std::vector<int>& rim) {
  Vec3 sum = Vec3::Zero();
  double length = 0;
  for (const int h : rim) {
    const Vec3 &a = surface.points[start_point(surface, h)], &b = surface.points[end_point(surface, h)];
    sum += (b - a).norm() * (a + b) / 2;
    length += (b - a).norm();
  }
  return sum / length;
}

/// V - E + F = 2 (components - genus).
int genus_of(const ClosedLumen& lumen) {
  std::vector<bool> used(lumen.surface.points.size(), false);
  int vertices = 0, components = 0;
  for (const auto& t : lumen.surface.triangles) {
    for (const int i : t) {
      vertices += !used[i];
      used[i] = true;
    }
  }
  for (const int c : triangle_components(lumen.opposite)) {
    components = std::max(components, c + 1);
  }
  const int euler = vertices - static_cast<int>(lumen.surface.triangles.size()) / 2;
  return components - euler / 2;
}

}  // namespace

ClosedLumen close_lumen(const TriSurface& surface, const std::vector<SurfaceEnd>& ends,
                        std::vector<std::string>& notes) {
  check(surface);
  ClosedLumen lumen;
  lumen.surface = surface;
  lumen.is_cap.assign(surface.triangles.size(), false);
  lumen.anchors.assign(ends.size(), -1);
  for (const std::vector<int>& rim : rim_loops(oriented_pairs(surface))) {
    const Vec3 middle = middle_of(surface, rim);
    int end = -1;
    for (int e = 0; e < static_cast<int>(ends.size()); ++e) {
      const double d = (ends[e].centre - middle).norm();
      if (lumen.anchors[e] < 0 && d < 0.5 * ends[e].radius && (end < 0 || d < (ends[end].centre - middle).norm())) {
        end = e;
      }
    }
    const int centre = static_cast<int>(lumen.surface.points.size());
    if (end < 0) {
      notes.push_back("the opening at " + short_text(middle) + " is not the end of a vessel: closed");
    } else {
      lumen.anchors[end] = centre;
    }
    lumen.surface.points.push_back(end < 0 ? middle : ends[end].centre);
    for (const int h : rim) {
      lumen.surface.triangles.push_back({end_point(surface, h), start_point(surface, h), centre});
      lumen.is_cap.push_back(true);
    }
  }
  for (std::size_t e = 0; e < ends.size(); ++e) {
    if (lumen.anchors[e] < 0) {
      fail("no opening of the surface has its middle at the end " + short_text(ends[e].centre) +
           "; drop flat caps first (prepare_surface)");
    }
  }
  lumen.opposite = oriented_pairs(lumen.surface);
  check_fans(lumen.surface, lumen.opposite);
  lumen.genus = genus_of(lumen);
  return lumen;
}

}  // namespace vasohex
