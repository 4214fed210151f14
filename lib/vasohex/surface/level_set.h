#pragma once
/// \file A signed distance on a lattice as a tricubic B-spline, known near the lumen only.

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "vasohex/skeleton/network.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// A C2 function: a tensor product of cubic B-splines. Its coefficients are kept in bricks of 8^3 cells, each with the
/// 11^3 coefficients its cells need, where the lumen is within reach; elsewhere there is nothing.
class LevelSet {
 public:
  static constexpr int kEdge = 8;              ///< cells along an edge of a brick
  static constexpr int kStored = kEdge + 3;    ///< coefficients along it, the first one node before its first cell
  static constexpr int kBrickSize = kStored * kStored * kStored;

  /// A lattice of `size` nodes: node (i, j, k) lies at origin + axes * (spacing times indices); axes orthonormal.
  struct Lattice {
    std::array<int, 3> size{};
    Vec3 spacing = Vec3::Ones();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Vec3 origin = Vec3::Zero();
  };

  explicit LevelSet(const Lattice& lattice);
  /// A brick by its place among the bricks, each index in [0, brick_counts()); its coefficients, x fastest.
  void add_brick(const std::array<int, 3>& place, const std::array<float, kBrickSize>& coefficients);

  const Lattice& lattice() const { return lattice_; }
  std::array<int, 3> brick_counts() const { return bricks_; }
  std::size_t bytes() const { return coefficients_.size() * sizeof(float) + brick_at_.size() * sizeof(int); }

  /// Whether there is a brick at x.
  bool covers(const Vec3& x) const;
  /// About the signed distance, < 0 inside, and its gradient if asked for; false, and nothing set, where there is none.
  bool value(const Vec3& x, double& value, Vec3* gradient) const;

 private:
  const float* cell(const Vec3& x, Vec3& within) const;

  Lattice lattice_;
  std::array<int, 3> bricks_{};
  std::vector<int> brick_at_;  ///< [brick], -1: none
  std::vector<float> coefficients_;
};

/// The lumen where the level set is negative. value: about the signed distance, a length, C2 within the level set's
/// bricks, which reach some voxels beyond the wall; farther out the distance to the tubes of the network. radius: that
/// of the network's axis nearest in terms of radii.
/// Throws Error (bad_input) if the network has no branch.
std::unique_ptr<ImplicitSurface> make_level_set_surface(std::shared_ptr<const LevelSet> level_set,
                                                        const Network& network);

}  // namespace vasohex
