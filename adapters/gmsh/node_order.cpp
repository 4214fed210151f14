#include "gmsh/node_order.h"

#include <array>

namespace vasohex {
namespace {

using Place = std::array<int, 3>;

Place operator+(const Place& a, const Place& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Place operator*(int s, const Place& a) { return {s * a[0], s * a[1], s * a[2]}; }

Place direction(const Place& from, const Place& to) {
  Place d{};
  for (int c = 0; c < 3; ++c) {
    d[c] = (to[c] > from[c]) - (to[c] < from[c]);
  }
  return d;
}

void append_edge(const Place& from, const Place& to, int order, std::vector<Place>& places) {
  for (int i = 1; i < order; ++i) {
    places.push_back(from + i * direction(from, to));
  }
}

void append_quad(const std::array<Place, 4>& corner, int order, std::vector<Place>& places) {
  if (order < 0) {
    return;
  }
  if (order == 0) {
    places.push_back(corner[0]);
    return;
  }
  places.insert(places.end(), corner.begin(), corner.end());
  for (int e = 0; e < 4; ++e) {
    append_edge(corner[e], corner[(e + 1) % 4], order, places);
  }
  std::array<Place, 4> inner;
  for (int c = 0; c < 4; ++c) {
    inner[c] = corner[c] + direction(corner[c], corner[(c + 2) % 4]);
  }
  append_quad(inner, order - 2, places);
}

constexpr std::array<std::array<int, 2>, 12> kEdges{
    {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}};
constexpr std::array<std::array<int, 4>, 6> kFaces{
    {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3}, {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}}};

/// The hexahedron of `order` whose first corner lies at (start, start, start).
void append_hex(int start, int order, std::vector<Place>& places) {
  if (order < 0) {
    return;
  }
  if (order == 0) {
    places.push_back({start, start, start});
    return;
  }
  std::array<Place, 8> corner;
  for (int c = 0; c < 8; ++c) {
    const int i = (c ^ c >> 1) & 1, j = c >> 1 & 1, k = c >> 2;
    corner[c] = {start + order * i, start + order * j, start + order * k};
    places.push_back(corner[c]);
  }
  for (const auto& [a, b] : kEdges) {
    append_edge(corner[a], corner[b], order, places);
  }
  for (const auto& face : kFaces) {
    std::array<Place, 4> inner;
    for (int c = 0; c < 4; ++c) {
      inner[c] = corner[face[c]] + direction(corner[face[c]], corner[face[(c + 2) % 4]]);
    }
    append_quad(inner, order - 2, places);
  }
  append_hex(start + 1, order - 2, places);
}

std::vector<int> lexicographic(const std::vector<Place>& places, int order) {
  const int n = order + 1;
  std::vector<int> result;
  for (const Place& p : places) {
    result.push_back(p[0] + n * (p[1] + n * p[2]));
  }
  return result;
}

}  // namespace

std::vector<int> gmsh_hex_order(int order) {
  std::vector<Place> places;
  append_hex(0, order, places);
  return lexicographic(places, order);
}

std::vector<int> gmsh_quad_order(int order) {
  std::vector<Place> places;
  append_quad({{{0, 0, 0}, {order, 0, 0}, {order, order, 0}, {0, order, 0}}}, order, places);
  return lexicographic(places, order);
}

int gmsh_hex_type(int order) {
  constexpr std::array<int, kGmshMaxOrder> types{5, 12, 92, 93, 94, 95, 96, 97, 98};
  return types.at(order - 1);
}

int gmsh_quad_type(int order) {
  constexpr std::array<int, kGmshMaxOrder> types{3, 10, 36, 37, 38, 47, 48, 49, 50};
  return types.at(order - 1);
}

}  // namespace vasohex
