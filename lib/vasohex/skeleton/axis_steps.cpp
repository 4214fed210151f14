#include "vasohex/skeleton/axis_steps.h"

#include <algorithm>
#include <array>

#include "vasohex/core/short_text.h"

namespace vasohex {
namespace {

constexpr double kThinAxis = 0.2;        // mean spacings: least radius around an axis
constexpr std::ptrdiff_t kNearNeck = 5;  // voxels of the axis within which a vessel's radius is looked for

/// Whether two neighbouring voxels touch by an edge or a corner only: no way of voxels inside that share faces leads
/// from one to the other through the box of both.
bool only_touch(const LabelVolume& volume, std::size_t first, std::size_t second) {
  const std::array<int, 3> a = volume.voxel(first), b = volume.voxel(second);
  const int apart = (a[0] != b[0]) + (a[1] != b[1]) + (a[2] != b[2]);
  if (apart < 2) {
    return false;
  }
  std::array<int, 3> order{0, 1, 2};
  do {
    std::array<int, 3> v = a;
    bool inside = true;
    for (const int d : order) {
      v[d] = b[d];
      inside &= volume.inside[volume.index(v[0], v[1], v[2])] != 0;
    }
    if (inside) {
      return false;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return true;
}

}  // namespace

void add_axis_steps(const LabelVolume& volume, const std::vector<std::size_t>& chain,
                    const std::vector<double>& radii, std::vector<AxisStep>& axis,
                    std::vector<std::string>& repairs) {
  const double thin = kThinAxis * volume.spacing.mean();
  for (std::size_t k = 1; k < chain.size(); ++k) {
    AxisStep step{{chain[k - 1], chain[k]}, thin};
    if (only_touch(volume, step.voxels[0], step.voxels[1])) {
      const auto at = radii.begin() + static_cast<std::ptrdiff_t>(k);
      const auto before = std::min(kNearNeck, at - radii.begin()), after = std::min(kNearNeck, radii.end() - at);
      const double neck = std::min(*std::max_element(at - before, at), *std::max_element(at, at + after));
      if (neck > thin) {
        step.radius = neck;
        const Vec3 place = 0.5 * (volume.centre(step.voxels[0]) + volume.centre(step.voxels[1]));
        repairs.push_back("vessels touch at " + short_text(place) +
                          " by an edge or a corner of voxels: joined there with radius " + short_text(neck));
      }
    }
    axis.push_back(step);
  }
}

}  // namespace vasohex
