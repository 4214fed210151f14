#include "vasohex/skeleton/narrow_holes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vasohex/core/short_text.h"
#include "vasohex/skeleton/thinning.h"
#include "vasohex/surface/distance_map.h"

namespace vasohex {
namespace {

/// The volume without what a ball of this radius, centred on a voxel, can cover from outside. Centres of voxels.
LabelVolume closed(const LabelVolume& volume, double radius, const Run& run) {
  LabelVolume result = volume;
  std::vector<float> distances = signed_centre_distances(volume, run);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    result.inside[i] = distances[i] <= radius;
  }
  distances = signed_centre_distances(result, run);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    result.inside[i] = volume.inside[i] || -distances[i] > radius;
  }
  return result;
}

/// By how much the Euler number grows if the voxels are filled.
long euler_gain(const LabelVolume& volume, const std::vector<std::size_t>& voxels) {
  std::array<int, 3> low = volume.size, high{0, 0, 0};
  for (const std::size_t i : voxels) {
    const std::array<int, 3> v = volume.voxel(i);
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], v[d] - 1);
      high[d] = std::max(high[d], v[d] + 1);
    }
  }
  LabelVolume around;
  for (int d = 0; d < 3; ++d) {
    around.size[d] = high[d] - low[d] + 1;
  }
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      for (int i = low[0]; i <= high[0]; ++i) {
        around.inside.push_back(volume.inside[volume.index(i, j, k)]);
      }
    }
  }
  const long before = euler_number(around);
  for (const std::size_t i : voxels) {
    const std::array<int, 3> v = volume.voxel(i);
    around.inside[around.index(v[0] - low[0], v[1] - low[1], v[2] - low[2])] = 1;
  }
  return euler_number(around) - before;
}

}  // namespace

LabelVolume without_narrow_holes(const LabelVolume& given, double width, std::vector<std::string>& repairs,
                                 const Run& run) {
  LabelVolume volume = cropped(given, 2 + static_cast<int>(std::ceil(width / given.spacing.minCoeff())));
  // between the centres of voxels a gap is a voxel wider
  LabelVolume sheets = closed(volume, 0.5 * (width + volume.spacing.mean()), run);
  std::vector<std::size_t> lumen;
  for (std::size_t i = 0; i < volume.inside.size(); ++i) {
    if (volume.inside[i]) {
      lumen.push_back(i);
    }
  }
  const std::vector<std::size_t> left = thin(sheets, signed_centre_distances(sheets, run), lumen);
  std::fill(sheets.inside.begin(), sheets.inside.end(), 0);
  for (const std::size_t i : left) {
    sheets.inside[i] = !volume.inside[i];
  }
  std::vector<std::uint8_t> marked(volume.inside.size(), 0);
  for (const std::size_t first : left) {
    if (!sheets.inside[first] || marked[first]) {
      continue;
    }
    const std::vector<std::size_t> sheet = flood(sheets, first, 1, false, marked);
    if (euler_gain(volume, sheet) < 1) {
      continue;  // a bridge
    }
    for (const std::size_t i : sheet) {
      volume.inside[i] = 1;
    }
    repairs.push_back("hole narrower than " + short_text(width) + " at " + short_text(volume.centre(first)) +
                      " filled: " + voxel_count(sheet.size()));
  }
  return volume;
}

}  // namespace vasohex
