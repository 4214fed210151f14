#pragma once
/// \file The reference hexahedron [0,1]^3: corners, edges, faces. All numbering of the project is here.
///
///        6 --------- 7          corner c lies at (c & 1, c >> 1 & 1, c >> 2 & 1)
///       /|          /|
///      4 --------- 5 |          face f = 2 * direction + side:
///      | |         | |            0: i = 0    2: j = 0    4: k = 0
///      | 2 --------| 3            1: i = 1    3: j = 1    5: k = 1
///  k ^ |/          |/
///    | 0 --------- 1            edge e = 4 * direction + (side of the next direction) + 2 * (side of the one after),
///    +--> i   (j goes back)     directions in the cyclic order i, j, k

#include <array>

namespace vasohex {

/// Corners of edge e, from its start (coordinate 0 along its direction) to its end.
constexpr std::array<int, 2> hex_edge(int e) {
  const int d = e / 4, d1 = (d + 1) % 3, d2 = (d + 2) % 3;
  const int c = ((e & 1) << d1) | (((e >> 1) & 1) << d2);
  return {c, c | (1 << d)};
}

/// The two directions (a, b) that span face f, ordered so that a x b points out of the hexahedron.
constexpr std::array<int, 2> hex_face_axes(int f) {
  const int d = f / 2, d1 = (d + 1) % 3, d2 = (d + 2) % 3;
  return f % 2 == 1 ? std::array<int, 2>{d1, d2} : std::array<int, 2>{d2, d1};
}

/// Corners of face f at (a, b) = (0,0), (1,0), (0,1), (1,1) in the axes of hex_face_axes.
constexpr std::array<int, 4> hex_face(int f) {
  const auto [a, b] = hex_face_axes(f);
  const int c = (f % 2) << (f / 2);
  return {c, c | (1 << a), c | (1 << b), c | (1 << a) | (1 << b)};
}

/// Index within the lexicographic lattice of (n[0], n[1], n[2]) points of the point at (a, b) on face f.
constexpr int hex_face_point(int f, int a, int b, const std::array<int, 3>& n) {
  std::array<int, 3> ijk{};
  const auto [da, db] = hex_face_axes(f);
  ijk[f / 2] = f % 2 == 1 ? n[f / 2] - 1 : 0;
  ijk[da] = a;
  ijk[db] = b;
  return ijk[0] + n[0] * (ijk[1] + n[1] * ijk[2]);
}

}  // namespace vasohex
