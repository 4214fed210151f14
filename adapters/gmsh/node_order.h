#pragma once
/// \file Node order and element types of complete hexahedra and quadrangles in MSH files.

#include <vector>

namespace vasohex {

/// Place g of an MSH hexahedron of the given order holds the lexicographic node result[g] = i + (p+1) * (j + (p+1) *
/// k). Corners, then edges, faces and the inside, each as a smaller element of its own [Gmsh reference manual, Node
/// ordering].
std::vector<int> gmsh_hex_order(int order);

/// The same of a quadrangle, i + (p+1) * j.
std::vector<int> gmsh_quad_order(int order);

inline constexpr int kGmshMaxOrder = 9;

/// Element type numbers of orders 1 to kGmshMaxOrder.
int gmsh_hex_type(int order);
int gmsh_quad_type(int order);

}  // namespace vasohex
