#include "vasohex/surface/label_volume.h"

#include <algorithm>
#include <cmath>

#include "vasohex/core/error.h"
#include "vasohex/core/short_text.h"
#include "vasohex/skeleton/clean.h"

namespace vasohex {

std::string voxel_count(std::size_t voxels) { return std::to_string(voxels) + (voxels == 1 ? " voxel" : " voxels"); }

std::vector<std::size_t> flood(const LabelVolume& volume, std::size_t seed, std::uint8_t of, bool faces_only,
                               std::vector<std::uint8_t>& marked) {
  std::vector<std::size_t> group{seed};
  marked[seed] = 1;
  for (std::size_t next = 0; next < group.size(); ++next) {
    const std::array<int, 3> v = volume.voxel(group[next]);
    for (int n = 0; n < 27; ++n) {
      const int a = n % 3 - 1, b = n / 3 % 3 - 1, c = n / 9 - 1;
      if (faces_only && std::abs(a) + std::abs(b) + std::abs(c) != 1) {
        continue;
      }
      const int i = v[0] + a, j = v[1] + b, k = v[2] + c;
      if (i < 0 || j < 0 || k < 0 || i >= volume.size[0] || j >= volume.size[1] || k >= volume.size[2]) {
        continue;
      }
      const std::size_t at = volume.index(i, j, k);
      if (volume.inside[at] == of && !marked[at]) {
        marked[at] = 1;
        group.push_back(at);
      }
    }
  }
  return group;
}

long euler_number(const LabelVolume& volume) {
  const auto in = [&](int i, int j, int k) {
    return i >= 0 && j >= 0 && k >= 0 && i < volume.size[0] && j < volume.size[1] && k < volume.size[2] &&
           volume.inside[volume.index(i, j, k)];
  };
  long euler = 0;
  for (int k = 0; k <= volume.size[2]; ++k) {
    for (int j = 0; j <= volume.size[1]; ++j) {
      for (int i = 0; i <= volume.size[0]; ++i) {
        // the cells whose lowest corner is the lowest corner of voxel (i, j, k): each counts once if any voxel has it
        bool at[2][2][2];
        bool any = false;
        for (int n = 0; n < 8; ++n) {
          any |= at[n & 1][n >> 1 & 1][n >> 2] = in(i - 1 + (n & 1), j - 1 + (n >> 1 & 1), k - 1 + (n >> 2));
        }
        if (!any) {
          continue;
        }
        euler += 1;
        euler -= at[1][0][0] | at[1][1][0] | at[1][0][1] | at[1][1][1];
        euler -= at[0][1][0] | at[1][1][0] | at[0][1][1] | at[1][1][1];
        euler -= at[0][0][1] | at[1][0][1] | at[0][1][1] | at[1][1][1];
        euler += at[1][1][0] | at[1][1][1];
        euler += at[1][0][1] | at[1][1][1];
        euler += at[0][1][1] | at[1][1][1];
        euler -= at[1][1][1];
      }
    }
  }
  return euler;
}

void check(const LabelVolume& volume) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::bad_input, what); };
  std::size_t count = 1;
  for (int d = 0; d < 3; ++d) {
    if (volume.size[d] < 1) {
      fail("the volume has " + std::to_string(volume.size[d]) + " voxels along " + "ijk"[d] +
           ", must have at least 1");
    }
    count *= volume.size[d];
    if (!(volume.spacing[d] > 0) || !std::isfinite(volume.spacing[d])) {
      fail("voxel spacing " + short_text(volume.spacing[d]) + " along " + "ijk"[d] + ", must be finite and > 0");
    }
  }
  if (volume.inside.size() != count) {
    fail(std::to_string(volume.inside.size()) + " labels, must be one for each of the " + std::to_string(count) +
         " voxels");
  }
  if (!volume.origin.allFinite() || !volume.axes.allFinite()) {
    fail("the volume's place in space is not finite");
  }
  if (!(volume.axes.transpose() * volume.axes).isIdentity(1e-4)) {
    fail("the volume's axes are not at right angles: resample it to a lattice with orthogonal axes");
  }
  if (std::find(volume.inside.begin(), volume.inside.end(), 1) == volume.inside.end()) {
    fail("no voxel is in the lumen");
  }
}

LabelVolume cropped(const LabelVolume& volume, int margin) {
  check(volume);
  std::array<int, 3> low = volume.size, high{-1, -1, -1};
  for (std::size_t row = 0; row < volume.inside.size(); row += volume.size[0]) {
    const auto begin = volume.inside.begin() + static_cast<std::ptrdiff_t>(row), end = begin + volume.size[0];
    const auto first = std::find(begin, end, 1);
    if (first == end) {
      continue;
    }
    auto last = end - 1;
    while (*last != 1) {
      --last;
    }
    const std::array<int, 3> v = volume.voxel(row);
    const std::array<int, 3> from{static_cast<int>(first - begin), v[1], v[2]};
    const std::array<int, 3> to{static_cast<int>(last - begin), v[1], v[2]};
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], from[d]);
      high[d] = std::max(high[d], to[d]);
    }
  }
  LabelVolume result = volume;
  result.origin =
      volume.to_world(volume.spacing.cwiseProduct(Vec3(low[0] - margin, low[1] - margin, low[2] - margin)));
  for (int d = 0; d < 3; ++d) {
    result.size[d] = high[d] - low[d] + 1 + 2 * margin;
  }
  result.inside.assign(static_cast<std::size_t>(result.size[0]) * result.size[1] * result.size[2], 0);
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      const auto from = volume.inside.begin() + static_cast<std::ptrdiff_t>(volume.index(low[0], j, k));
      const std::size_t to = result.index(margin, j - low[1] + margin, k - low[2] + margin);
      std::copy(from, from + (high[0] - low[0] + 1), result.inside.begin() + static_cast<std::ptrdiff_t>(to));
    }
  }
  return result;
}

CleanLabels clean_labels(const LabelVolume& given, std::size_t least_voxels, int margin) {
  CleanLabels result;
  LabelVolume volume = cropped(given, std::max(margin, 1));
  std::vector<std::uint8_t> marked(volume.inside.size(), 0);
  flood(volume, 0, 0, true, marked);
  std::vector<std::size_t> filled;
  for (std::size_t i = 0; i < volume.inside.size(); ++i) {
    if (!volume.inside[i] && !marked[i]) {
      const std::vector<std::size_t> cavity = flood(volume, i, 0, true, marked);
      result.repairs.push_back("cavity of " + voxel_count(cavity.size()) + " at " + short_text(volume.centre(i)) +
                               " filled");
      filled.insert(filled.end(), cavity.begin(), cavity.end());
    }
  }
  for (const std::size_t i : filled) {
    volume.inside[i] = 1;
  }
  std::fill(marked.begin(), marked.end(), 0);
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < volume.inside.size(); ++i) {
    if (volume.inside[i] && !marked[i]) {
      groups.push_back(flood(volume, i, 1, false, marked));
    }
  }
  std::size_t largest = 0;
  for (const auto& group : groups) {
    largest = std::max(largest, group.size());
  }
  for (const auto& group : groups) {
    if (group.size() >= least_voxels || group.size() == largest) {
      ++result.components;
      continue;
    }
    for (const std::size_t i : group) {
      volume.inside[i] = 0;
    }
    result.repairs.push_back("fragment of " + voxel_count(group.size()) + " at " +
                             short_text(volume.centre(group.front())) + " left out");
  }
  result.tunnels = static_cast<int>(result.components - euler_number(volume));
  result.volume = cropped(volume, margin);
  return result;
}

}  // namespace vasohex
