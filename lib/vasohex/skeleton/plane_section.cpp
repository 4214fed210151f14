#include "vasohex/skeleton/plane_section.h"

#include <unordered_set>

#include "vasohex/surface/half_edges.h"

namespace vasohex {

std::vector<SectionLoop> plane_section(const ClosedLumen& lumen, const Vec3& origin, const Vec3& normal,
                                       std::span<const int> through) {
  const TriSurface& surface = lumen.surface;
  const auto height = [&](int point) { return (surface.points[point] - origin).dot(normal); };
  const auto is_above = [&](int point) { return height(point) >= 0; };
  // of the three half-edges of a triangle that the plane cuts, one falls through it and one rises
  const auto falls = [&](int h) { return is_above(start_point(surface, h)) && !is_above(end_point(surface, h)); };
  const auto rises = [&](int h) { return falls(lumen.opposite[h]); };
  std::vector<SectionLoop> loops;
  std::unordered_set<int> seen;
  for (const int h : through) {
    const int start = falls(h) ? h : rises(h) ? lumen.opposite[h] : -1;
    if (start < 0 || seen.contains(start)) {
      continue;
    }
    SectionLoop loop;
    int at = start;
    do {
      seen.insert(at);
      const int a = start_point(surface, at), b = end_point(surface, at);
      const double s = height(a) / (height(a) - height(b));
      loop.points.push_back((1 - s) * surface.points[a] + s * surface.points[b]);
      loop.nearest.push_back(s < 0.5 ? a : b);
      const int next = next_half_edge(at);
      at = lumen.opposite[rises(next) ? next : next_half_edge(next)];
    } while (at != start);
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace vasohex
