#include "vasohex/skeleton/thinning.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <unordered_map>

namespace vasohex {
namespace {

constexpr std::uint32_t kMiddle = 1u << 13;

/// For each of the 27 places the others that touch it, by faces (and, or edges and corners).
constexpr std::array<std::uint32_t, 27> touching(bool faces_only) {
  std::array<std::uint32_t, 27> result{};
  for (int a = 0; a < 27; ++a) {
    for (int b = 0; b < 27; ++b) {
      const int x = a % 3 - b % 3, y = a / 3 % 3 - b / 3 % 3, z = a / 9 - b / 9;
      const int square = x * x + y * y + z * z;
      const bool near = x >= -1 && x <= 1 && y >= -1 && y <= 1 && z >= -1 && z <= 1;
      if (a != b && near && (!faces_only || square == 1)) {
        result[a] |= 1u << b;
      }
    }
  }
  return result;
}
constexpr std::array<std::uint32_t, 27> kTouching = touching(false), kSharingFace = touching(true);

constexpr std::uint32_t without_corners() {
  std::uint32_t result = 0;
  for (int a = 0; a < 27; ++a) {
    const int off = (a % 3 != 1) + (a / 3 % 3 != 1) + (a / 9 != 1);
    result |= (off == 1 || off == 2) ? 1u << a : 0u;
  }
  return result;
}
constexpr std::uint32_t kFacesAndEdges = without_corners();

/// The part of `set` that hangs together with its members in `seed`.
std::uint32_t connected(std::uint32_t seed, std::uint32_t set, const std::array<std::uint32_t, 27>& neighbours) {
  std::uint32_t all = seed & set;
  for (std::uint32_t fresh = all; fresh != 0;) {
    std::uint32_t next = 0;
    for (; fresh != 0; fresh &= fresh - 1) {
      next |= neighbours[std::countr_zero(fresh)];
    }
    fresh = next & set & ~all;
    all |= fresh;
  }
  return all;
}

/// Steps to the 26 neighbours of a voxel, and their lengths.
struct Steps {
  std::array<std::ptrdiff_t, 27> offset{};
  std::array<double, 27> length{};

  explicit Steps(const LabelVolume& volume) {
    for (int n = 0; n < 27; ++n) {
      const int a = n % 3 - 1, b = n / 3 % 3 - 1, c = n / 9 - 1;
      offset[n] = a + static_cast<std::ptrdiff_t>(volume.size[0]) *
                          (b + static_cast<std::ptrdiff_t>(volume.size[1]) * c);
      length[n] = volume.spacing.cwiseProduct(Vec3(a, b, c)).norm();
    }
  }
};

std::uint32_t neighbourhood(const std::vector<std::uint8_t>& inside, const Steps& steps, std::size_t at) {
  std::uint32_t bits = 0;
  for (int n = 0; n < 27; ++n) {
    bits |= static_cast<std::uint32_t>(inside[at + steps.offset[n]]) << n;
  }
  return bits;
}

/// The radius of the ball that fills the lumen around a voxel: deeper as long as the ball there still reaches it.
double local_radius(const LabelVolume& volume, const std::vector<float>& distances, const Steps& steps, std::size_t from) {
  std::size_t at = from;
  const Vec3 start = volume.centre(from);
  while (true) {
    std::size_t best = at;
    for (const std::ptrdiff_t offset : steps.offset) {
      if (distances[at + offset] < distances[best]) {
        best = at + offset;
      }
    }
    if (best == at || (volume.centre(best) - start).norm() > -distances[best] + volume.spacing.maxCoeff()) {
      return -distances[at];
    }
    at = best;
  }
}

}  // namespace

bool is_simple(std::uint32_t bits) {
  bits &= ~kMiddle;
  const std::uint32_t outside = ~bits & ((1u << 27) - 1) & kFacesAndEdges;
  const std::uint32_t faces = outside & kSharingFace[13];
  if (bits == 0 || faces == 0) {
    return false;
  }
  return connected(bits & (~bits + 1), bits, kTouching) == bits &&
         (connected(faces & (~faces + 1), outside, kSharingFace) & faces) == faces;
}

std::vector<std::size_t> vessel_tips(const LabelVolume& volume, const std::vector<float>& distances,
                                     double least_radii) {
  const Steps steps(volume);
  std::vector<std::size_t> voxels;
  for (std::size_t i = 0; i < volume.inside.size(); ++i) {
    if (volume.inside[i]) {
      voxels.push_back(i);
    }
  }
  std::vector<std::size_t> by_depth = voxels;
  std::stable_sort(by_depth.begin(), by_depth.end(),
                   [&](std::size_t a, std::size_t b) { return distances[a] < distances[b]; });
  // Ways from the deepest voxel of each component
  std::unordered_map<std::size_t, double> away;
  away.reserve(voxels.size());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const std::size_t root : by_depth) {
    if (away.contains(root)) {
      continue;
    }
    away[root] = 0;
    queue.emplace(0, root);
    while (!queue.empty()) {
      const auto [length, at] = queue.top();
      queue.pop();
      if (length > away[at]) {
        continue;
      }
      for (int n = 0; n < 27; ++n) {
        const std::size_t to = at + steps.offset[n];
        if (n == 13 || !volume.inside[to]) {
          continue;
        }
        const double there = length + steps.length[n];
        const auto [known, is_new] = away.emplace(to, there);
        if (is_new || there < known->second) {
          known->second = there;
          queue.emplace(there, to);
        }
      }
    }
  }
  // From the farthest voxels inwards: where two parts meet, the shorter one ends. It is a vessel if it is long enough.
  std::vector<std::size_t> by_length = voxels;
  std::stable_sort(by_length.begin(), by_length.end(),
                   [&](std::size_t a, std::size_t b) { return away[a] > away[b]; });
  std::unordered_map<std::size_t, std::size_t> parent;  // towards the voxel of a part that is farthest
  parent.reserve(voxels.size());
  const auto top_of = [&](std::size_t i) {
    while (parent[i] != i) {
      i = parent[i] = parent[parent[i]];
    }
    return i;
  };
  std::vector<std::size_t> tips, roots;
  for (const std::size_t at : by_length) {
    parent[at] = at;
    double radius = -1;
    for (const std::ptrdiff_t offset : steps.offset) {
      const std::size_t to = at + offset;
      if (to == at || !volume.inside[to] || !parent.contains(to)) {
        continue;
      }
      std::size_t a = top_of(at), b = top_of(to);
      if (a == b) {
        continue;
      }
      if (away[b] > away[a] || (away[b] == away[a] && b < a)) {
        std::swap(a, b);  // b is the shorter one
      }
      if (b != at) {
        if (radius < 0) {
          radius = local_radius(volume, distances, steps, at);
        }
        if (away[b] - away[at] > least_radii * radius) {
          tips.push_back(b);
        }
      }
      parent[b] = a;
    }
    if (away[at] == 0) {
      roots.push_back(at);
    }
  }
  std::unordered_map<std::size_t, int> tips_of;  // by the farthest voxel of a component
  for (const std::size_t tip : tips) {
    ++tips_of[top_of(tip)];
  }
  for (const std::size_t root : roots) {
    const std::size_t farthest = top_of(root);
    tips.push_back(farthest);
    if (tips_of[farthest] == 0) {
      tips.push_back(root);  // the farthest is the only end: its thickest place is the other one
    }
  }
  std::sort(tips.begin(), tips.end());
  tips.erase(std::unique(tips.begin(), tips.end()), tips.end());
  return tips;
}

std::vector<std::size_t> thin(const LabelVolume& volume, const std::vector<float>& distances,
                              const std::vector<std::size_t>& kept) {
  const Steps steps(volume);
  std::vector<std::uint8_t> inside = volume.inside;
  std::vector<std::uint8_t> waiting(inside.size(), 0);  // 1: in the queue; 2: kept
  using Entry = std::pair<float, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const std::size_t i : kept) {
    waiting[i] = 2;
  }
  const auto wait = [&](std::size_t i) {
    if (inside[i] && !waiting[i]) {
      waiting[i] = 1;
      queue.emplace(-distances[i], i);
    }
  };
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i]) {
      wait(i);
    }
  }
  while (!queue.empty()) {
    const std::size_t at = queue.top().second;
    queue.pop();
    waiting[at] = 0;
    if (!is_simple(neighbourhood(inside, steps, at))) {
      continue;
    }
    inside[at] = 0;
    for (const std::ptrdiff_t offset : steps.offset) {
      wait(at + offset);
    }
  }
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < inside.size(); ++i) {
    if (inside[i]) {
      result.push_back(i);
    }
  }
  return result;
}

}  // namespace vasohex
