#pragma once
/// \file What the readers of segmentations share: voxels of any type, a map into space.

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "vasohex/surface/label_volume.h"

namespace vasohex {

enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
std::size_t size_of(VoxelType type);

/// An image in memory: voxel (i, j, k), i fastest, lies at columns * (i, j, k) + origin.
struct VoxelImage {
  VoxelType type = VoxelType::uint8;
  const void* voxels = nullptr;
  std::array<int, 3> size{};
  Eigen::Matrix3d columns = Eigen::Matrix3d::Identity();
  Vec3 origin = Vec3::Zero();
  std::string units;
};

/// The volume of the voxels that have one of the labels, cropped; see read_labelmap, also for errors.
LabelVolume pick_labels(const VoxelImage& image, const std::vector<int>& labels);

/// Turns coordinates to the left and the back (LPS) into RAS.
void lps_to_ras(VoxelImage& image);

/// An NRRD file with its voxels in it; throws as read_labelmap. `storage` gets what `voxels` points to.
VoxelImage read_nrrd(const std::string& path, std::vector<char>& storage);

}  // namespace vasohex
