#include "vtk/labels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "vasohex/core/error.h"

namespace vasohex {
namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::bad_input, what); }

std::string voxel_name(const LabelVolume& volume, std::size_t i) {
  const std::array<int, 3> v = volume.voxel(i);
  return "voxel (" + std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]) + ")";
}

template <class T>
void pick(const T* voxels, const std::vector<int>& labels, LabelVolume& volume) {
  std::map<long long, bool> known;  // label -> inside
  const auto is_inside = [&](long long label) {
    return labels.empty() ? label > 0 : std::find(labels.begin(), labels.end(), label) != labels.end();
  };
  T before = 0;
  bool inside = is_inside(0);
  bool first = true;
  for (std::size_t i = 0; i < volume.inside.size(); ++i) {
    const T value = voxels[i];
    if (first || value != before) {  // not equal to itself: not a number
      const auto number = static_cast<double>(value);
      if (!(std::abs(number) < 1e15) || number != std::floor(number)) {
        fail(voxel_name(volume, i) + " has the value " + std::to_string(number) +
             ", must be a label (a whole number): this is no segmentation, threshold it first");
      }
      const auto label = static_cast<long long>(value);
      inside = known.emplace(label, is_inside(label)).first->second;
      before = value;
      first = false;
    }
    volume.inside[i] = inside;
  }
  std::string there;
  int listed = 0;
  for (const auto& [label, in] : known) {
    if (label != 0 && ++listed <= 20) {
      there += (there.empty() ? "" : ", ") + std::to_string(label);
    }
  }
  there = there.empty() ? "no label but 0" : "the labels " + there + (listed > 20 ? ", ..." : "");
  for (const int label : labels) {
    if (!known.contains(label)) {
      fail("no voxel has the label " + std::to_string(label) + "; the file has " + there);
    }
  }
  if (std::none_of(known.begin(), known.end(), [](const auto& label) { return label.second; })) {
    fail("the segmentation is empty, must have voxels with a label > 0; it has " + there);
  }
}

}  // namespace

std::size_t size_of(VoxelType type) {
  switch (type) {
    case VoxelType::int8:
    case VoxelType::uint8:
      return 1;
    case VoxelType::int16:
    case VoxelType::uint16:
      return 2;
    case VoxelType::int32:
    case VoxelType::uint32:
    case VoxelType::float32:
      return 4;
    default:
      return 8;
  }
}

LabelVolume pick_labels(const VoxelImage& image, const std::vector<int>& labels) {
  LabelVolume volume;
  volume.size = image.size;
  volume.units = image.units;
  volume.origin = image.origin;
  std::size_t count = 1;
  for (int d = 0; d < 3; ++d) {
    if (image.size[d] < 1) {
      fail("it has no voxels");
    }
    count *= image.size[d];
    volume.spacing[d] = image.columns.col(d).norm();
    volume.axes.col(d) = image.columns.col(d) / volume.spacing[d];
  }
  volume.inside.resize(count);
  switch (image.type) {
    case VoxelType::int8:
      pick(static_cast<const std::int8_t*>(image.voxels), labels, volume);
      break;
    case VoxelType::uint8:
      pick(static_cast<const std::uint8_t*>(image.voxels), labels, volume);
      break;
    case VoxelType::int16:
      pick(static_cast<const std::int16_t*>(image.voxels), labels, volume);
      break;
    case VoxelType::uint16:
      pick(static_cast<const std::uint16_t*>(image.voxels), labels, volume);
      break;
    case VoxelType::int32:
      pick(static_cast<const std::int32_t*>(image.voxels), labels, volume);
      break;
    case VoxelType::uint32:
      pick(static_cast<const std::uint32_t*>(image.voxels), labels, volume);
      break;
    case VoxelType::int64:
      pick(static_cast<const std::int64_t*>(image.voxels), labels, volume);
      break;
    case VoxelType::uint64:
      pick(static_cast<const std::uint64_t*>(image.voxels), labels, volume);
      break;
    case VoxelType::float32:
      pick(static_cast<const float*>(image.voxels), labels, volume);
      break;
    case VoxelType::float64:
      pick(static_cast<const double*>(image.voxels), labels, volume);
      break;
  }
  return cropped(volume, 0);
}

void lps_to_ras(VoxelImage& image) {
  image.columns.topRows<2>() *= -1;
  image.origin.head<2>() *= -1;
}

}  // namespace vasohex
