#pragma once
/// \file A lumen as a segmentation: the voxels of an image that lie in it.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// Voxels on a lattice with orthogonal axes, of any spacing per axis.
struct LabelVolume {
  std::array<int, 3> size{};                           ///< voxels along i, j, k
  Vec3 spacing = Vec3::Ones();                         ///< > 0, from one voxel to the next along i, j, k
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: unit directions of i, j, k; may be left-handed
  Vec3 origin = Vec3::Zero();                          ///< centre of voxel (0, 0, 0)
  std::vector<std::uint8_t> inside;                    ///< [i + size[0] * (j + size[1] * k)], 1: in the lumen, else 0
  std::string units;                                   ///< `mm`, `cm`, `m`, `um`, or empty: not stated

  std::size_t index(int i, int j, int k) const {
    return i + static_cast<std::size_t>(size[0]) * (j + static_cast<std::size_t>(size[1]) * k);
  }
  std::array<int, 3> voxel(std::size_t index) const {
    const std::size_t row = index / size[0];
    return {static_cast<int>(index % size[0]), static_cast<int>(row % size[1]), static_cast<int>(row / size[1])};
  }
  /// A place in the volume's own frame (spacing times voxel indices) in space.
  Vec3 to_world(const Vec3& local) const { return origin + axes * local; }
  Vec3 to_local(const Vec3& world) const { return axes.transpose() * (world - origin); }
  Vec3 centre(std::size_t i) const {
    const std::array<int, 3> v = voxel(i);
    return to_world(spacing.cwiseProduct(Vec3(v[0], v[1], v[2])));
  }
};

/// Throws Error (bad_input) if sizes do not fit each other, the axes are not orthonormal (1e-4), a spacing is not >
/// 0, a number is not finite, or no voxel is inside.
void check(const LabelVolume& volume);

/// The box around the voxels inside and `margin` voxels more on each side, all of them outside (also beyond the given
/// volume). Voxels keep their places in space.
LabelVolume cropped(const LabelVolume& volume, int margin);

/// Marks the voxels that hang together with `seed` through voxels of the value `of`, faces only or also edges and
/// corners, and returns them.
std::vector<std::size_t> flood(const LabelVolume& volume, std::size_t seed, std::uint8_t of, bool faces_only,
                               std::vector<std::uint8_t>& marked);

/// Vertices - edges + faces - voxels of the union of closed voxels, which 26-connectivity is the connectivity of:
/// components - tunnels + cavities.
long euler_number(const LabelVolume& volume);

/// `1 voxel`, `7 voxels`
std::string voxel_count(std::size_t voxels);

/// What was cleaned from a segmentation, and what it looks like after.
struct CleanLabels {
  LabelVolume volume;
  int components = 0;                ///< 26-connected
  int tunnels = 0;                   ///< holes through the lumen (first Betti number)
  std::vector<std::string> repairs;  ///< one line each
};

/// The volume cropped, with cavities (voxels outside that the lumen encloses, 6-connected) filled and components of
/// fewer than `least_voxels` voxels left out, all of which is reported. The largest component always stays.
CleanLabels clean_labels(const LabelVolume& volume, std::size_t least_voxels, int margin);

}  // namespace vasohex
