#include "vasohex/surface/repair_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "vasohex/core/disjoint_sets.h"
#include "vasohex/core/error.h"
#include "vasohex/core/short_text.h"
#include "vasohex/surface/half_edges.h"

namespace vasohex {
namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

Vec3 middle(const TriSurface& surface, int triangle) {
  const auto& [a, b, c] = surface.triangles[triangle];
  return (surface.points[a] + surface.points[b] + surface.points[c]) / 3;
}

/// Removes the triangles for which `gone` is true.
void remove_triangles(TriSurface& surface, const std::vector<char>& gone) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!gone[t]) {
      surface.triangles[kept++] = surface.triangles[t];
    }
  }
  surface.triangles.resize(kept);
}

std::array<int, 3> sorted(std::array<int, 3> corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Points closer than near[] of both become one, the first; triangles with equal corners go.
void weld(TriSurface& surface, const std::vector<double>& near, const std::string& how,
          std::vector<std::string>& repairs) {
  // sweep along a direction in which points of axis-parallel planes do not coincide
  const Vec3 sweep = Vec3(0.65, 0.59, 0.48).normalized();
  std::vector<int> order(surface.points.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> along(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    along[i] = sweep.dot(surface.points[i]);
  }
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return along[a] != along[b] ? along[a] < along[b] : a < b; });
  DisjointSets same(static_cast<int>(order.size()));
  std::size_t welded = 0;
  int example = -1;
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size() && along[order[j]] - along[order[i]] <= near[order[i]]; ++j) {
      if ((surface.points[order[i]] - surface.points[order[j]]).norm() <= std::min(near[order[i]], near[order[j]])) {
        const int a = same.find(order[i]), b = same.find(order[j]);
        if (a != b) {
          same.join(a, b);
          ++welded;
          example = example < 0 ? std::min(a, b) : example;
        }
      }
    }
  }
  std::vector<char> gone(surface.triangles.size(), 0);
  std::size_t flat = 0;
  Vec3 at = Vec3::Zero();
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    auto& corners = surface.triangles[t];
    for (int& p : corners) {
      p = same.find(p);
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      gone[t] = 1;
      at = flat++ == 0 ? surface.points[corners[0]] : at;
    }
  }
  remove_triangles(surface, gone);
  if (welded > 0) {
    repairs.push_back(counted(welded, "point", "points") + " welded to another " + how + ", the first at " +
                      short_text(surface.points[example]));
  }
  if (flat > 0) {
    repairs.push_back(counted(flat, "triangle", "triangles") + " with equal corners removed, the first at " +
                      short_text(at));
  }
}

}  // namespace

void check_triangles(const TriSurface& surface) {
  for (std::size_t p = 0; p < surface.points.size(); ++p) {
    if (!surface.points[p].allFinite()) {
      throw Error(ErrorCode::bad_input, "point " + std::to_string(p) + ": a coordinate is not a finite number");
    }
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const int p : surface.triangles[t]) {
      if (p < 0 || p >= static_cast<int>(surface.points.size())) {
        throw Error(ErrorCode::bad_input, "triangle " + std::to_string(t) + " has point " + std::to_string(p) +
                                              ", must be 0 to " + std::to_string(surface.points.size()) + " - 1");
      }
    }
  }
}

void weld_points(TriSurface& surface, std::vector<std::string>& repairs) {
  Box box;
  for (const Vec3& p : surface.points) {
    box.add(p);
  }
  if (box.empty()) {
    return;
  }
  const double largest = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
  const double near = std::max(2e-7 * largest, 1e-7 * (box.max - box.min).norm());
  weld(surface, std::vector<double>(surface.points.size(), near), "within " + short_text(near), repairs);
}

void weld_cracks(TriSurface& surface, std::vector<std::string>& repairs) {
  const std::vector<int> opposite = pair_half_edges(surface);
  std::vector<double> near(surface.points.size(), 0);
  for (int h = 0; h < static_cast<int>(opposite.size()); ++h) {
    if (opposite[h] < 0) {
      near[start_point(surface, h)] = near[end_point(surface, h)] = std::numeric_limits<double>::infinity();
    }
  }
  for (int h = 0; h < static_cast<int>(opposite.size()); ++h) {
    const int a = start_point(surface, h), b = end_point(surface, h);
    const double tenth = 0.1 * (surface.points[a] - surface.points[b]).norm();
    near[a] = std::min(near[a], tenth);
    near[b] = std::min(near[b], tenth);
  }
  weld(surface, near, "across cracks", repairs);
}

void drop_copies(TriSurface& surface, std::vector<std::string>& repairs) {
  std::map<std::array<int, 3>, std::vector<int>> copies;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    copies[sorted(surface.triangles[t])].push_back(static_cast<int>(t));
  }
  std::map<std::array<int, 2>, int> others;  // triangles at each edge of a copied one, copied ones left out
  for (const auto& [corners, group] : copies) {
    if (group.size() > 1) {
      for (int k = 0; k < 3; ++k) {
        others[{corners[k == 2 ? 0 : k], corners[k == 2 ? 2 : k + 1]}] = 0;
      }
    }
  }
  if (others.empty()) {
    return;
  }
  for (const auto& [corners, group] : copies) {
    for (int k = 0; k < 3 && group.size() == 1; ++k) {
      const auto edge = others.find({corners[k == 2 ? 0 : k], corners[k == 2 ? 2 : k + 1]});
      if (edge != others.end()) {
        ++edge->second;
      }
    }
  }
  std::vector<char> gone(surface.triangles.size(), 0);
  std::size_t doubles = 0, films = 0;
  Vec3 double_at = Vec3::Zero(), film_at = Vec3::Zero();
  for (const auto& [corners, group] : copies) {
    if (group.size() == 1) {
      continue;
    }
    int open = 0;  // edges that need a triangle
    for (int k = 0; k < 3; ++k) {
      open += others[{corners[k == 2 ? 0 : k], corners[k == 2 ? 2 : k + 1]}] % 2;
    }
    const bool film = open <= 1;
    for (std::size_t i = film ? 0 : 1; i < group.size(); ++i) {
      gone[group[i]] = 1;
    }
    std::size_t& count = film ? films : doubles;
    (film ? film_at : double_at) = count++ == 0 ? middle(surface, group[0]) : (film ? film_at : double_at);
  }
  remove_triangles(surface, gone);
  if (doubles > 0) {
    repairs.push_back(counted(doubles, "triangle", "triangles") +
                      " given more than once, copies removed, the first at " + short_text(double_at));
  }
  if (films > 0) {
    repairs.push_back(counted(films, "pair", "pairs") +
                      " of triangles without anything between removed, the first at " + short_text(film_at));
  }
}

void flip_needles(TriSurface& surface, std::vector<std::string>& repairs) {
  constexpr double kFlat = 1e-4;  // height over the longest edge
  const auto flatness = [&](const std::array<int, 3>& t) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (surface.points[t[k]] - surface.points[t[(k + 1) % 3]]).squaredNorm());
    }
    const Vec3 normal =
        (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]);
    return longest > 0 ? normal.norm() / longest : 0;
  };
  std::size_t flips = 0;
  Vec3 at = Vec3::Zero();
  for (int round = 0; round < 3; ++round) {
    const std::vector<int> opposite = pair_half_edges(surface);
    std::map<std::array<int, 2>, int> edges;
    std::vector<char> changed(surface.triangles.size(), 0);
    std::size_t before = flips;
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
      if (changed[t] || flatness(surface.triangles[t]) > kFlat) {
        continue;
      }
      int h = 3 * t;  // the longest edge
      for (int k = 1; k < 3; ++k) {
        const auto length = [&](int e) {
          return (surface.points[start_point(surface, e)] - surface.points[end_point(surface, e)]).squaredNorm();
        };
        h = length(3 * t + k) > length(h) ? 3 * t + k : h;
      }
      const int o = opposite[h];
      if (o < 0 || changed[o / 3] || start_point(surface, o) != end_point(surface, h)) {
        continue;
      }
      const int a = start_point(surface, h), b = end_point(surface, h);
      const int tip = end_point(surface, next_half_edge(h)), other = end_point(surface, next_half_edge(o));
      if (edges.empty()) {
        for (int e = 0; e < static_cast<int>(opposite.size()); ++e) {
          const auto [low, high] = std::minmax({start_point(surface, e), end_point(surface, e)});
          edges[{low, high}] = 1;
        }
      }
      const std::array<int, 3> one{tip, a, other}, two{tip, other, b};
      const auto [low, high] = std::minmax({tip, other});
      if (tip == other || edges.count({low, high}) > 0 || std::min(flatness(one), flatness(two)) <= kFlat) {
        continue;
      }
      at = flips == 0 ? middle(surface, t) : at;
      surface.triangles[t] = one;
      surface.triangles[o / 3] = two;
      edges[{low, high}] = 1;
      changed[t] = changed[o / 3] = 1;
      ++flips;
    }
    if (flips == before) {
      break;
    }
  }
  if (flips > 0) {
    repairs.push_back(counted(flips, "triangle", "triangles") + " without height flipped, the first at " +
                      short_text(at));
  }
}

void separate_sheets(TriSurface& surface, std::vector<std::string>& repairs) {
  std::vector<int> crowded;
  const std::vector<int> opposite = pair_half_edges(surface, &crowded);
  const int count = static_cast<int>(opposite.size());
  // corners around one point that hang together: those of pairs, matched by the point
  DisjointSets fans(count);
  for (int h = 0; h < count; ++h) {
    if (const int o = opposite[h]; o > h) {
      const bool against = start_point(surface, o) == end_point(surface, h);
      fans.join(h, against ? next_half_edge(o) : o);
      fans.join(next_half_edge(h), against ? o : next_half_edge(o));
    }
  }
  std::vector<int> owner(surface.points.size(), -1);  // the fan that keeps the point
  std::vector<int> number(count, -1);
  std::size_t split = 0;
  Vec3 at = Vec3::Zero();
  for (int c = 0; c < count; ++c) {
    const int fan = fans.find(c);
    const int p = start_point(surface, c);
    if (number[fan] < 0) {
      if (owner[p] < 0) {
        owner[p] = fan;
        number[fan] = p;
      } else {
        at = split++ == 0 ? surface.points[p] : at;
        number[fan] = static_cast<int>(surface.points.size());
        const Vec3 copy = surface.points[p];
        surface.points.push_back(copy);
      }
    }
  }
  for (int c = 0; c < count; ++c) {
    surface.triangles[c / 3][c % 3] = number[fans.find(c)];
  }
  if (!crowded.empty()) {
    const int h = crowded[0];
    repairs.push_back(
        counted(crowded.size(), "edge", "edges") + " of more than two triangles: sheets separated, the first at " +
        short_text((surface.points[start_point(surface, h)] + surface.points[end_point(surface, h)]) / 2));
  } else if (split > 0) {
    repairs.push_back(counted(split, "point", "points") + " where sheets touch separated, the first at " +
                      short_text(at));
  }
}

void orient_outward(TriSurface& surface, std::vector<std::string>& repairs) {
  const std::vector<int> opposite = pair_half_edges(surface);
  const std::vector<int> component = triangle_components(opposite);
  const int n = static_cast<int>(surface.triangles.size());
  std::vector<signed char> turn(n, 0);  // 1 as it is, -1 turned over
  std::vector<int> stack;
  for (int seed = 0; seed < n; ++seed) {
    if (turn[seed] != 0) {
      continue;
    }
    turn[seed] = 1;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const int t = stack.back();
      stack.pop_back();
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        const int o = opposite[h];
        if (o < 0) {
          continue;
        }
        const bool against = start_point(surface, o) == end_point(surface, h);
        const signed char wanted = static_cast<signed char>(against ? turn[t] : -turn[t]);
        if (turn[o / 3] == 0) {
          turn[o / 3] = wanted;
          stack.push_back(o / 3);
        } else if (turn[o / 3] != wanted) {
          throw Error(ErrorCode::bad_input, "the surface has one side only (a Moebius band), seen at " +
                                                short_text(middle(surface, t)) +
                                                "; it cannot be the wall of a lumen");
        }
      }
    }
  }
  // the minority within each component, before the question which side is out
  const int components = n == 0 ? 0 : *std::max_element(component.begin(), component.end()) + 1;
  std::vector<int> as_is(components, 0), turned(components, 0);
  for (int t = 0; t < n; ++t) {
    ++(turn[t] > 0 ? as_is : turned)[component[t]];
  }
  std::size_t minority = 0;
  Vec3 at = Vec3::Zero();
  for (int t = 0; t < n; ++t) {
    const bool less =
        turn[t] > 0 ? as_is[component[t]] < turned[component[t]] : turned[component[t]] <= as_is[component[t]];
    if (less) {
      at = minority++ == 0 ? middle(surface, t) : at;
    }
    if (turn[t] < 0) {
      std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    }
  }
  if (minority > 0) {
    repairs.push_back(counted(minority, "triangle", "triangles") +
                      " turned over to agree with the neighbours, the first at " + short_text(at));
  }
  // outward: signed volume with each rim closed by a fan around its middle, relative to a point of the component
  const std::vector<int> pairs = pair_half_edges(surface);
  std::vector<double> volume(components, 0);
  std::vector<Vec3> origin(components);
  for (int t = n - 1; t >= 0; --t) {
    origin[component[t]] = surface.points[surface.triangles[t][0]];
  }
  for (int t = 0; t < n; ++t) {
    volume[component[t]] += area_normal(surface, t).dot(middle(surface, t) - origin[component[t]]);
  }
  for (const auto& loop : rim_loops(pairs)) {
    const int c = component[loop[0] / 3];
    Vec3 centre = Vec3::Zero();
    for (const int h : loop) {
      centre += surface.points[start_point(surface, h)] / static_cast<double>(loop.size());
    }
    for (const int h : loop) {
      const Vec3& a = surface.points[end_point(surface, h)];
      const Vec3& b = surface.points[start_point(surface, h)];
      volume[c] += (a - centre).cross(b - centre).dot(centre - origin[c]);
    }
  }
  std::vector<char> inward(components, 0);
  for (int t = 0; t < n; ++t) {
    if (volume[component[t]] < 0) {
      std::swap(surface.triangles[t][1], surface.triangles[t][2]);
      inward[component[t]] = 1;
    }
  }
  const std::size_t flipped = static_cast<std::size_t>(std::count(inward.begin(), inward.end(), 1));
  if (flipped > 0) {
    repairs.push_back(components == 1 ? "the normals pointed inward: all triangles turned over"
                                      : "the normals of " + std::to_string(flipped) + " of " +
                                            std::to_string(components) + " components pointed inward: turned over");
  }
}

double winding_number(const TriSurface& surface, const Vec3& x) {
  double sum = 0;
  for (const auto& t : surface.triangles) {
    const Vec3 a = surface.points[t[0]] - x, b = surface.points[t[1]] - x, c = surface.points[t[2]] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

int drop_fragments(TriSurface& surface, std::vector<std::string>& repairs) {
  const std::vector<int> component = triangle_components(pair_half_edges(surface));
  const int n = static_cast<int>(surface.triangles.size());
  const int components = n == 0 ? 0 : *std::max_element(component.begin(), component.end()) + 1;
  if (components <= 1) {
    return components;
  }
  std::vector<double> area(components, 0);
  std::vector<int> seed(components, -1);
  for (int t = 0; t < n; ++t) {
    area[component[t]] += area_normal(surface, t).norm() / 2;
    seed[component[t]] = seed[component[t]] < 0 ? t : seed[component[t]];
  }
  const double largest = *std::max_element(area.begin(), area.end());
  std::vector<char> drop(components, 0);
  std::size_t small = 0, inside = 0;
  Vec3 small_at = Vec3::Zero(), inside_at = Vec3::Zero();
  for (int c = 0; c < components; ++c) {
    const Vec3 at = middle(surface, seed[c]);
    if (area[c] < 0.01 * largest) {
      drop[c] = 1;
      small_at = small++ == 0 ? at : small_at;
    }
  }
  for (int c = 0; c < components; ++c) {
    for (int other = 0; other < components && !drop[c]; ++other) {
      if (other == c || drop[other] || area[other] < area[c]) {
        continue;
      }
      TriSurface shell{surface.points, {}, {}};
      for (int t = 0; t < n; ++t) {
        if (component[t] == other) {
          shell.triangles.push_back(surface.triangles[t]);
        }
      }
      const Vec3 at = middle(surface, seed[c]);
      if (winding_number(shell, at) > 0.5) {
        drop[c] = 1;
        inside_at = inside++ == 0 ? at : inside_at;
      }
    }
  }
  std::vector<char> gone(n, 0);
  for (int t = 0; t < n; ++t) {
    gone[t] = drop[component[t]];
  }
  remove_triangles(surface, gone);
  if (small > 0) {
    repairs.push_back(counted(small, "fragment", "fragments") +
                      " of less than 1 % of the largest component's area dropped, the first at " +
                      short_text(small_at));
  }
  if (inside > 0) {
    repairs.push_back(counted(inside, "component", "components") + " inside another dropped, the first at " +
                      short_text(inside_at));
  }
  return components - static_cast<int>(small + inside);
}

void drop_unused_points(TriSurface& surface) {
  std::vector<int> number(surface.points.size(), -1);
  for (const auto& t : surface.triangles) {
    for (const int p : t) {
      number[p] = 0;
    }
  }
  int kept = 0;
  for (std::size_t p = 0; p < number.size(); ++p) {
    if (number[p] == 0) {
      number[p] = kept;
      surface.points[kept++] = surface.points[p];
    }
  }
  surface.points.resize(kept);
  for (auto& t : surface.triangles) {
    for (int& p : t) {
      p = number[p];
    }
  }
}

}  // namespace vasohex
