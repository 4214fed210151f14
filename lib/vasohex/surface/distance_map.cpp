#include "vasohex/surface/distance_map.h"

#include <cmath>
#include <limits>

#include "vasohex/core/parallel.h"

namespace vasohex {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

/// Replaces the values of a line, `step` apart, by min over q of values[q] + (spacing (p - q))^2.
class LineEnvelope {
 public:
  void operator()(float* values, int n, std::size_t step, double spacing) {
    place_.clear();
    begin_.clear();
    height_.clear();
    for (int q = 0; q < n; ++q) {
      const double h = values[q * step];
      if (h == kFar) {
        continue;
      }
      double begin = -std::numeric_limits<double>::infinity();
      while (!place_.empty()) {
        const double x = q * spacing, y = place_.back() * spacing;
        begin = ((h + x * x) - (height_.back() + y * y)) / (2 * (x - y));
        if (begin > begin_.back()) {
          break;
        }
        place_.pop_back();
        begin_.pop_back();
        height_.pop_back();
        begin = -std::numeric_limits<double>::infinity();
      }
      place_.push_back(q);
      begin_.push_back(begin);
      height_.push_back(h);
    }
    if (place_.empty()) {
      return;
    }
    std::size_t k = 0;
    for (int p = 0; p < n; ++p) {
      while (k + 1 < place_.size() && begin_[k + 1] < p * spacing) {
        ++k;
      }
      const double away = (p - place_[k]) * spacing;
      values[p * step] = static_cast<float>(height_[k] + away * away);
    }
  }

 private:
  std::vector<int> place_;
  std::vector<double> begin_, height_;
};

/// Squared distance to the nearest voxel with inside == of.
std::vector<float> squared_distances(const LabelVolume& volume, std::uint8_t of, const Run& run) {
  const auto [nx, ny, nz] = volume.size;
  const std::size_t row = nx, slice = row * ny;
  std::vector<float> d(volume.inside.size());
  parallel_for(run, nz, 1, [&](std::size_t from, std::size_t to) {
    LineEnvelope envelope;
    for (std::size_t k = from; k < to; ++k) {
      float* const plane = &d[k * slice];
      for (std::size_t i = 0; i < slice; ++i) {
        plane[i] = volume.inside[k * slice + i] == of ? 0 : kFar;
      }
      for (int j = 0; j < ny; ++j) {
        envelope(plane + j * row, nx, 1, volume.spacing[0]);
      }
      for (int i = 0; i < nx; ++i) {
        envelope(plane + i, ny, row, volume.spacing[1]);
      }
    }
  });
  parallel_for(run, ny, 1, [&](std::size_t from, std::size_t to) {
    LineEnvelope envelope;
    for (std::size_t j = from; j < to; ++j) {
      for (int i = 0; i < nx; ++i) {
        envelope(&d[j * row + i], nz, slice, volume.spacing[2]);
      }
    }
  });
  return d;
}

}  // namespace

std::vector<float> signed_centre_distances(const LabelVolume& volume, const Run& run) {
  std::vector<float> outside = squared_distances(volume, 1, run);
  const std::vector<float> inside = squared_distances(volume, 0, run);
  for (std::size_t i = 0; i < outside.size(); ++i) {
    outside[i] = volume.inside[i] ? -std::sqrt(inside[i]) : std::sqrt(outside[i]);
  }
  return outside;
}

}  // namespace vasohex
