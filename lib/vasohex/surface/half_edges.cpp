#include "vasohex/surface/half_edges.h"

#include <algorithm>
#include <numeric>

namespace vasohex {
namespace {

/// Pairs of one edge's half-edges, straightest continuation first.
void pair_crowd(const TriSurface& surface, const int* crowd, std::size_t count, std::vector<int>& opposite) {
  const auto away = [&](int h) {  // from the edge into the triangle
    const Vec3& a = surface.points[start_point(surface, h)];
    const Vec3 along = (surface.points[end_point(surface, h)] - a).normalized();
    const Vec3 to_tip = surface.points[end_point(surface, next_half_edge(h))] - a;
    return Vec3((to_tip - along.dot(to_tip) * along).normalized());
  };
  struct Pair {
    double cosine;
    int a, b;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      pairs.push_back({away(crowd[i]).dot(away(crowd[j])), crowd[i], crowd[j]});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) { return p.cosine < q.cosine; });
  for (const Pair& p : pairs) {
    if (opposite[p.a] < 0 && opposite[p.b] < 0) {
      opposite[p.a] = p.b;
      opposite[p.b] = p.a;
    }
  }
}

}  // namespace

std::vector<int> pair_half_edges(const TriSurface& surface, std::vector<int>* crowded) {
  struct Side {
    int low, high, half_edge;
  };
  const int count = static_cast<int>(3 * surface.triangles.size());
  std::vector<Side> sides(count);
  for (int h = 0; h < count; ++h) {
    const auto [low, high] = std::minmax({start_point(surface, h), end_point(surface, h)});
    sides[h] = {low, high, h};
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.half_edge < b.half_edge;
  });
  std::vector<int> opposite(count, -1), crowd;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t j = i;
    crowd.clear();
    while (j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high) {
      crowd.push_back(sides[j++].half_edge);
    }
    if (crowd.size() == 2) {
      opposite[crowd[0]] = crowd[1];
      opposite[crowd[1]] = crowd[0];
    } else if (crowd.size() > 2) {
      pair_crowd(surface, crowd.data(), crowd.size(), opposite);
      if (crowded) {
        crowded->push_back(crowd[0]);
      }
    }
    i = j;
  }
  return opposite;
}

std::vector<std::vector<int>> rim_loops(const std::vector<int>& opposite) {
  std::vector<char> seen(opposite.size(), 0);
  std::vector<std::vector<int>> loops;
  for (int start = 0; start < static_cast<int>(opposite.size()); ++start) {
    if (opposite[start] >= 0 || seen[start]) {
      continue;
    }
    loops.emplace_back();
    for (int h = start; !seen[h];) {
      seen[h] = 1;
      loops.back().push_back(h);
      h = next_half_edge(h);  // around the point where h ends, to the other side of the fan
      while (opposite[h] >= 0) {
        h = next_half_edge(opposite[h]);
      }
    }
  }
  return loops;
}

std::vector<int> triangle_components(const std::vector<int>& opposite) {
  std::vector<int> component(opposite.size() / 3, -1), stack;
  int count = 0;
  for (int seed = 0; seed < static_cast<int>(component.size()); ++seed) {
    if (component[seed] >= 0) {
      continue;
    }
    component[seed] = count;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const int t = stack.back();
      stack.pop_back();
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        const int neighbour = opposite[h] / 3;
        if (opposite[h] >= 0 && component[neighbour] < 0) {
          component[neighbour] = count;
          stack.push_back(neighbour);
        }
      }
    }
    ++count;
  }
  return component;
}

}  // namespace vasohex
