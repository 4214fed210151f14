#pragma once
/// \file The point of a set of triangles that is closest to a point.

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "vasohex/surface/tri_surface.h"

namespace vasohex {

struct ClosestPoint {
  Vec3 point = Vec3::Zero();
  double distance2 = std::numeric_limits<double>::infinity();  ///< squared distance
  int triangle = -1;
  /// Where on the triangle: 0 to 2 its corner, 3 to 5 the edge from corner (feature - 3) to the next, 6 inside.
  int feature = 6;
  Vec3 weights = Vec3::Zero();  ///< barycentric coordinates of `point`
};

/// The closest point of triangle a, b, c (C. Ericson, Real-Time Collision Detection, 2005, 5.1.5); `triangle` is
/// left.
ClosestPoint closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x);

/// A tree of boxes, four to a node, built by the surface area heuristic. Double precision throughout.
class TriangleTree {
 public:
  TriangleTree() = default;
  /// Keeps a copy of the corners.
  explicit TriangleTree(const TriSurface& surface);

  /// The closest point to x; of several equally close triangles one that depends on nothing but the input. triangle
  /// -1 if there is none nearer than `furthest`.
  ClosestPoint closest(const Vec3& x, double furthest = std::numeric_limits<double>::infinity()) const;

 private:
  static constexpr int kWidth = 4;
  struct Node {
    std::array<std::array<double, kWidth>, 3> min{}, max{};
    std::array<std::int32_t, kWidth> first{};  ///< of a leaf: its first triangle; otherwise the child node
    std::array<std::int32_t, kWidth> count{};  ///< of triangles; 0: a node; -1: nothing here
  };
  struct Corners {
    Vec3 a, b, c;
    int triangle = 0;
  };
  struct Item;
  void build(std::vector<Item>& items, int begin, int end, int node);

  std::vector<Node> nodes_;
  std::vector<Corners> corners_;  ///< in the order of the leaves
};

}  // namespace vasohex
