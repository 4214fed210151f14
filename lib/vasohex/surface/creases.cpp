#include "vasohex/surface/creases.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "vasohex/core/disjoint_sets.h"
#include "vasohex/surface/half_edges.h"

namespace vasohex {
namespace {

constexpr double kSharp = 50 * std::numbers::pi / 180;
constexpr double kGoesOn = 15 * std::numbers::pi / 180;
constexpr double kStandsOut = 3, kStillStandsOut = 2;  // times the turn around
constexpr double kSure = 0.6;                          // part of a crease's length
constexpr double kRough = 0.1;                         // part of its points
constexpr double kSmallest = 2;                        // extent, in radii

/// Angle by which the surface turns at each half-edge's edge; 0 at a rim.
std::vector<double> turns(const TriSurface& surface, const std::vector<int>& opposite) {
  std::vector<double> turn(opposite.size(), 0);
  for (std::size_t h = 0; h < opposite.size(); ++h) {
    if (opposite[h] >= 0) {
      turn[h] = angle_between(area_normal(surface, static_cast<int>(h) / 3), area_normal(surface, opposite[h] / 3));
    }
  }
  return turn;
}

struct SharpEdges {
  std::vector<double> turn;  ///< [half-edges]
  std::vector<char> edges;  ///< [half-edges] of a pair the first, whether a crease may go on there
  std::vector<char> sure;   ///< of those, which are sure to be one
};

SharpEdges sharp_edges(const TriSurface& surface, const std::vector<int>& opposite) {
  SharpEdges sharp;
  sharp.turn = turns(surface, opposite);
  const std::vector<double>& turn = sharp.turn;
  sharp.edges.assign(turn.size(), 0);
  sharp.sure.assign(turn.size(), 0);
  for (int h = 0; h < static_cast<int>(turn.size()); ++h) {
    const int o = opposite[h];
    if (o < h || turn[h] < kGoesOn) {
      continue;
    }
    const int h1 = next_half_edge(h), h2 = next_half_edge(h1), o1 = next_half_edge(o), o2 = next_half_edge(o1);
    const double around = (turn[h1] + turn[h2] + turn[o1] + turn[o2]) / 4;
    sharp.edges[h] = turn[h] > kStillStandsOut * around;
    sharp.sure[h] = turn[h] > kSharp && turn[h] > kStandsOut * around;
  }
  return sharp;
}

/// Sharp edges that hang together, and what tells a crease from noise.
struct Chain {
  Box extent;
  double length = 0, sure = 0, turn = 0;  ///< turn: integral along the chain
  int points = 0, rough = 0;              ///< rough: where it forks, or other edges turn half as much as it does
};

/// Both half-edges of the edges of chains that are creases.
std::vector<char> crease_edges(const TriSurface& surface, const std::vector<int>& opposite, const SharpEdges& sharp,
                               const std::function<double(const Vec3&)>& radius) {
  const int count = static_cast<int>(opposite.size());
  DisjointSets sets(static_cast<int>(surface.points.size()));
  std::vector<int> sharp_at(surface.points.size(), 0);
  std::vector<double> other_turn(surface.points.size(), 0);  // largest, of edges that are not sharp
  for (int h = 0; h < count; ++h) {
    const int a = start_point(surface, h), b = end_point(surface, h);
    if (sharp.edges[h]) {
      sets.join(a, b);
      ++sharp_at[a];
      ++sharp_at[b];
    } else if (opposite[h] >= h) {
      other_turn[a] = std::max(other_turn[a], sharp.turn[h]);
      other_turn[b] = std::max(other_turn[b], sharp.turn[h]);
    }
  }
  std::map<int, Chain> chains;
  for (int h = 0; h < count; ++h) {
    if (sharp.edges[h]) {
      Chain& chain = chains[sets.find(start_point(surface, h))];
      const double length = (surface.points[end_point(surface, h)] - surface.points[start_point(surface, h)]).norm();
      chain.length += length;
      chain.sure += sharp.sure[h] ? length : 0;
      chain.turn += length * sharp.turn[h];
    }
  }
  for (int p = 0; p < static_cast<int>(sharp_at.size()); ++p) {
    if (sharp_at[p] > 0) {
      Chain& chain = chains[sets.find(p)];
      chain.extent.add(surface.points[p]);
      ++chain.points;
      chain.rough += sharp_at[p] > 2 || 2 * other_turn[p] * chain.length > chain.turn;
    }
  }
  std::vector<char> creases(count, 0);
  for (int h = 0; h < count; ++h) {
    if (sharp.edges[h]) {
      const Chain& c = chains[sets.find(start_point(surface, h))];
      const Vec3 middle = (c.extent.min + c.extent.max) / 2;
      creases[h] = creases[opposite[h]] = c.sure >= kSure * c.length && c.rough <= kRough * c.points &&
                                          (c.extent.max - c.extent.min).norm() >= kSmallest * radius(middle);
    }
  }
  return creases;
}

/// Of the triangles around the start of each half-edge.
std::vector<Vec3> side_normals(const TriSurface& surface, const std::vector<int>& opposite,
                               const std::vector<char>& creases) {
  const int count = static_cast<int>(opposite.size());
  DisjointSets sets(count);  // corners of one side
  for (int h = 0; h < count; ++h) {
    if (const int o = opposite[h]; o >= 0 && !creases[h] && start_point(surface, h) == end_point(surface, o)) {
      sets.join(h, next_half_edge(o));
      sets.join(next_half_edge(h), o);
    }
  }
  std::vector<Vec3> sums(count, Vec3::Zero());
  for (int h = 0; h < count; ++h) {
    const Vec3& at = surface.points[start_point(surface, h)];
    const Vec3 a = surface.points[end_point(surface, h)] - at;
    const Vec3 b = surface.points[end_point(surface, next_half_edge(h))] - at;
    sums[sets.find(h)] += angle_between(a, b) * a.cross(b).stableNormalized();
  }
  std::vector<Vec3> normals(count);
  for (int h = 0; h < count; ++h) {
    normals[h] = sums[sets.find(h)].stableNormalized();
  }
  return normals;
}

}  // namespace

Creases find_creases(const TriSurface& surface, const std::function<double(const Vec3&)>& radius) {
  const std::vector<int> opposite = pair_half_edges(surface);
  Creases creases;
  creases.edges = crease_edges(surface, opposite, sharp_edges(surface, opposite), radius);
  creases.normals = side_normals(surface, opposite, creases.edges);
  creases.along.resize(surface.points.size());
  for (int h = 0; h < static_cast<int>(opposite.size()); ++h) {
    if (creases.edges[h]) {
      creases.along[start_point(surface, h)].push_back(end_point(surface, h));
    }
  }
  return creases;
}

}  // namespace vasohex
