#include "vasohex/surface/smooth_labels.h"

#include <algorithm>
#include <cmath>

#include "vasohex/core/parallel.h"

namespace vasohex {
namespace {

constexpr double kBand = 4;           // of the largest spacing: how far from the wall the function is smoothed
constexpr std::size_t kGrain = 8192;  // nodes a task; sums are taken per task, so they do not depend on threads

/// Second derivatives of a function on some nodes of a lattice, where all nodes needed are there, and their adjoint.
class ThinPlate {
 public:
  ThinPlate(const LabelVolume& volume, const std::vector<std::size_t>& nodes, const std::vector<int>& node_at,
            const Vec3& spacing)
      : count_(nodes.size()), neighbours_(nodes.size()), whole_(nodes.size()), residuals_(nodes.size() + 1) {
    const std::array<std::ptrdiff_t, 3> step{1, volume.size[0],
                                             static_cast<std::ptrdiff_t>(volume.size[0]) * volume.size[1]};
    for (int d = 0; d < 3; ++d) {
      weight_[d] = static_cast<float>(1 / (spacing[d] * spacing[d]));
      // each mixed derivative occurs twice in the squared norm of the matrix
      weight_[3 + d] = static_cast<float>(std::sqrt(2.0) / (spacing[d] * spacing[(d + 1) % 3]));
      bound_ += 16 * weight_[d] * weight_[d] + 16 * weight_[3 + d] * weight_[3 + d];
    }
    residuals_.back() = {};
    for (std::size_t n = 0; n < count_; ++n) {
      const auto at = [&](std::ptrdiff_t away) {
        const int node = node_at[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(nodes[n]) + away)];
        return node < 0 ? static_cast<int>(count_) : node;
      };
      std::array<int, 12>& to = neighbours_[n];
      for (int d = 0; d < 3; ++d) {
        const std::ptrdiff_t diagonal = step[d] + step[(d + 1) % 3];
        to[2 * d] = at(-step[d]);
        to[2 * d + 1] = at(step[d]);
        to[6 + 2 * d] = at(-diagonal);
        to[7 + 2 * d] = at(diagonal);
      }
      const int none = static_cast<int>(count_);
      for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3;
        whole_[n] |= (to[2 * d] != none && to[2 * d + 1] != none) << d;
        whole_[n] |= (to[2 * d + 1] != none && to[2 * e + 1] != none && to[7 + 2 * d] != none) << (3 + d);
      }
    }
  }

  /// No eigenvalue of the adjoint times the derivatives is greater.
  double bound() const { return bound_; }

  /// gradient[n] of half the sum of squares at `f`, which has one entry more than there are nodes.
  void gradient(const std::vector<float>& f, std::vector<float>& gradient, const Run& run) {
    parallel_for(run, count_, kGrain, [&](std::size_t from, std::size_t to) {
      for (std::size_t n = from; n < to; ++n) {
        const std::array<int, 12>& at = neighbours_[n];
        std::array<float, 6>& r = residuals_[n];
        for (int d = 0; d < 3; ++d) {
          const int e = (d + 1) % 3;
          r[d] = whole_[n] >> d & 1 ? weight_[d] * weight_[d] * (f[at[2 * d]] - 2 * f[n] + f[at[2 * d + 1]]) : 0.0f;
          r[3 + d] = whole_[n] >> (3 + d) & 1 ? weight_[3 + d] * weight_[3 + d] *
                                                    (f[at[7 + 2 * d]] - f[at[2 * d + 1]] - f[at[2 * e + 1]] + f[n])
                                              : 0.0f;
        }
      }
    });
    parallel_for(run, count_, kGrain, [&](std::size_t from, std::size_t to) {
      for (std::size_t n = from; n < to; ++n) {
        const std::array<int, 12>& at = neighbours_[n];
        float sum = 0;
        for (int d = 0; d < 3; ++d) {
          const int e = (d + 1) % 3;
          sum += residuals_[at[2 * d]][d] - 2 * residuals_[n][d] + residuals_[at[2 * d + 1]][d];
          sum += residuals_[n][3 + d] - residuals_[at[2 * d]][3 + d] - residuals_[at[2 * e]][3 + d] +
                 residuals_[at[6 + 2 * d]][3 + d];
        }
        gradient[n] = sum;
      }
    });
  }

 private:
  std::size_t count_;
  std::vector<std::array<int, 12>> neighbours_;  ///< count_: none
  std::vector<unsigned char> whole_;             ///< bits: the six derivatives that exist
  std::vector<std::array<float, 6>> residuals_;
  std::array<float, 6> weight_{};
  double bound_ = 0;
};

/// Bounds of the function at a node.
struct Bounds {
  float low = 0, high = 0;
};

Bounds bounds_of(float centre_distance, double margin, double largest) {
  const auto d = std::abs(centre_distance);
  const auto least = static_cast<float>(std::max<double>(d - largest, margin));
  return centre_distance < 0 ? Bounds{-d, -least} : Bounds{least, d};
}

/// Lowers the bounds such that the steps of the axis are inside, with their radii.
void keep_axis(const LabelVolume& volume, const std::vector<AxisStep>& axis, const std::vector<int>& node_at,
               std::vector<Bounds>& bounds) {
  const auto place = [&](const std::array<int, 3>& v) -> Vec3 {
    return volume.spacing.cwiseProduct(Vec3(v[0], v[1], v[2]));
  };
  for (const AxisStep& step : axis) {
    const std::array<int, 3> a = volume.voxel(step.voxels[0]), b = volume.voxel(step.voxels[1]);
    const auto from_axis = [&](const std::array<int, 3>& v) {
      return distance_to_segment(place(v), place(a), place(b));
    };
    // halfway the function is the mean over the corners of the box from a to b, and those outside raise it
    double raised = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const std::array<int, 3> v{corner & 1 ? a[0] : b[0], corner & 2 ? a[1] : b[1], corner & 4 ? a[2] : b[2]};
      raised += volume.inside[volume.index(v[0], v[1], v[2])] ? 0 : from_axis(v) / 8;
    }
    for (int k = std::min(a[2], b[2]) - 1; k <= std::max(a[2], b[2]) + 1; ++k) {
      for (int j = std::min(a[1], b[1]) - 1; j <= std::max(a[1], b[1]) + 1; ++j) {
        for (int i = std::min(a[0], b[0]) - 1; i <= std::max(a[0], b[0]) + 1; ++i) {
          const int node = node_at[volume.index(i, j, k)];
          const auto most = static_cast<float>(from_axis({i, j, k}) - step.radius - raised);
          if (node >= 0 && most < bounds[node].high) {
            bounds[node].high = most;
            bounds[node].low = std::min(bounds[node].low, most);
          }
        }
      }
    }
  }
}

/// Accelerated projected gradients, started anew whenever a step turns back.
void minimise(ThinPlate& plate, const std::vector<Bounds>& bounds, int iterations, std::vector<float>& f,
              const Run& run) {
  const std::size_t count = bounds.size();
  const auto step = static_cast<float>(1 / plate.bound());
  std::vector<float> ahead = f, gradient(count), next(count);
  std::vector<double> turned((count + kGrain - 1) / kGrain);
  double t = 1;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    run.progress("level set", static_cast<double>(iteration) / iterations);
    plate.gradient(ahead, gradient, run);
    parallel_for(run, count, kGrain, [&](std::size_t from, std::size_t to) {
      double sum = 0;
      for (std::size_t n = from; n < to; ++n) {
        next[n] = std::clamp(ahead[n] - step * gradient[n], bounds[n].low, bounds[n].high);
        sum += static_cast<double>(ahead[n] - next[n]) * (next[n] - f[n]);
      }
      turned[from / kGrain] = sum;
    });
    double back = 0;
    for (const double sum : turned) {
      back += sum;
    }
    const double t_next = back > 0 ? 1 : 0.5 * (1 + std::sqrt(1 + 4 * t * t));
    const auto momentum = static_cast<float>(back > 0 ? 0 : (t - 1) / t_next);
    parallel_for(run, count, kGrain, [&](std::size_t from, std::size_t to) {
      for (std::size_t n = from; n < to; ++n) {
        ahead[n] = next[n] + momentum * (next[n] - f[n]);
        f[n] = next[n];
      }
    });
    t = t_next;
  }
  run.progress("level set", 1);
}

/// A block of values on kRead^3 nodes.
constexpr int kRead = LevelSet::kStored + 6;  // what the coefficients of a brick depend on
using Block = std::vector<double>;

/// Replaces values by centre * value + side * (sum of the two neighbours) along each axis; the outermost stay.
void filter(Block& block, double centre, double side, Block& buffer) {
  for (const int stride : {1, kRead, kRead * kRead}) {
    for (int n = 0; n < static_cast<int>(block.size()); ++n) {
      const int along = n / stride % kRead;
      const bool inner = along > 0 && along + 1 < kRead;
      buffer[n] = inner ? centre * block[n] + side * (block[n - stride] + block[n + stride]) : block[n];
    }
    block.swap(buffer);
  }
}

/// Coefficients of a cubic spline that is the given values, up to eighth order: 1 - (second difference) / 6 along
/// each axis is the inverse of the spline's values up to fourth order, applied twice. Local, and it damps what the
/// lattice can hardly hold.
void add_bricks(const LabelVolume& volume, const std::vector<float>& values, double reach, LevelSet& level_set) {
  constexpr int edge = LevelSet::kEdge, stored = LevelSet::kStored, before = (kRead - stored) / 2;
  const std::array<int, 3> counts = level_set.brick_counts();
  const auto value_at = [&](int i, int j, int k) {
    return values[volume.index(std::clamp(i, 0, volume.size[0] - 1), std::clamp(j, 0, volume.size[1] - 1),
                               std::clamp(k, 0, volume.size[2] - 1))];
  };
  // visit(n, value) for the nodes of a box that begins at a node
  const auto for_nodes = [&](const std::array<int, 3>& first, int count, auto&& visit) {
    int n = 0;
    for (int k = 0; k < count; ++k) {
      for (int j = 0; j < count; ++j) {
        for (int i = 0; i < count; ++i) {
          visit(n++, value_at(first[0] + i, first[1] + j, first[2] + k));
        }
      }
    }
  };
  Block given(kRead * kRead * kRead), once(given.size()), rest(given.size()), buffer(given.size());
  std::array<float, LevelSet::kBrickSize> coefficients;
  for (int z = 0; z < counts[2]; ++z) {
    for (int y = 0; y < counts[1]; ++y) {
      for (int x = 0; x < counts[0]; ++x) {
        const std::array<int, 3> first{x * edge, y * edge, z * edge};
        bool near = false;
        for_nodes(first, edge + 1, [&](int, float value) { near |= value <= reach; });
        if (!near) {
          continue;
        }
        const int back = before + 1;  // the first coefficient is one node before the brick's first cell
        for_nodes({first[0] - back, first[1] - back, first[2] - back}, kRead,
                  [&](int n, float value) { given[n] = value; });
        once = given;
        filter(once, 4.0 / 3, -1.0 / 6, buffer);
        rest = once;
        filter(rest, 2.0 / 3, 1.0 / 6, buffer);
        for (std::size_t n = 0; n < rest.size(); ++n) {
          rest[n] = given[n] - rest[n];
        }
        filter(rest, 4.0 / 3, -1.0 / 6, buffer);
        for (int k = 0; k < stored; ++k) {
          for (int j = 0; j < stored; ++j) {
            for (int i = 0; i < stored; ++i) {
              const int n = i + before + kRead * (j + before + kRead * (k + before));
              coefficients[i + stored * (j + stored * k)] = static_cast<float>(once[n] + rest[n]);
            }
          }
        }
        level_set.add_brick({x, y, z}, coefficients);
      }
    }
  }
}

}  // namespace

LevelSet make_level_set(const LabelVolume& volume, std::vector<float> distances,
                        const std::vector<AxisStep>& axis, const SmoothLabelsOptions& options, const Run& run) {
  const double smallest = volume.spacing.minCoeff(), largest = volume.spacing.maxCoeff();
  std::vector<float> values = std::move(distances);
  std::vector<std::size_t> nodes;
  std::vector<int> node_at(values.size(), -1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] < kBand * largest) {
      node_at[i] = static_cast<int>(nodes.size());
      nodes.push_back(i);
    }
  }
  std::vector<Bounds> bounds(nodes.size());
  std::vector<float> f(nodes.size() + 1, 0);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    bounds[n] = bounds_of(values[nodes[n]], options.margin * smallest, largest);
  }
  keep_axis(volume, axis, node_at, bounds);
  // the wall halfway between centres, to start with and where it is not smoothed
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] -= static_cast<float>(values[i] > 0 ? 0.5 * smallest : -0.5 * smallest);
    if (node_at[i] >= 0) {
      f[node_at[i]] = std::clamp(values[i], bounds[node_at[i]].low, bounds[node_at[i]].high);
    }
  }
  {
    ThinPlate plate(volume, nodes, node_at, volume.spacing / smallest);
    minimise(plate, bounds, options.iterations, f, run);
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    values[nodes[n]] = f[n];
  }
  LevelSet level_set({volume.size, volume.spacing, volume.axes, volume.origin});
  add_bricks(volume, values, (kBand - 1) * largest, level_set);
  return level_set;
}

}  // namespace vasohex
