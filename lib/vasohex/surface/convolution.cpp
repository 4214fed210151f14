#include "vasohex/surface/convolution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vasohex/core/parallel.h"
#include "vasohex/surface/convolution_surface.h"
#include "vasohex/surface/convolved_axis.h"
#include "vasohex/surface/project.h"

namespace vasohex {
namespace {

void check(const Network& network) {
  if (network.branches.empty()) {
    throw Error(ErrorCode::bad_input, "a network without branches has no surface");
  }
  for (std::size_t b = 0; b < network.branches.size(); ++b) {
    const Branch& branch = network.branches[b];
    const auto fail = [b](const std::string& what) {
      throw Error(ErrorCode::bad_input, "branch " + std::to_string(b) + ": " + what);
    };
    const std::size_t n = branch.points.size();
    if (n < 2 || branch.radii.size() != n || branch.tangents.size() != n || branch.arc.size() != n) {
      fail("needs at least 2 points, and a radius, a tangent and an arc length for each");
    }
    for (const int node : branch.nodes) {
      if (node < 0 || node >= static_cast<int>(network.nodes.size())) {
        fail("node " + std::to_string(node) + " does not exist");
      }
    }
    for (std::size_t k = 0; k < n; ++k) {
      if (!(branch.radii[k] > 0 && std::isfinite(branch.radii[k])) || !branch.points[k].allFinite()) {
        fail("point " + std::to_string(k) + " has radius " + std::to_string(branch.radii[k]) +
             ", must be finite and > 0, at a finite place");
      }
      if (k > 0 && !(branch.arc[k] > branch.arc[k - 1])) {
        fail("arc length does not increase at point " + std::to_string(k));
      }
    }
  }
}

/// What the rays in the normal plane of a sample met: distances from the target's axis, in target radii.
struct Section {
  double mean = 1;
  Vec3 shift = Vec3::Zero();
};

/// The surface as one piece sees it, so that rays pass through other vessels.
class PieceView final : public ImplicitSurface {
 public:
  PieceView(const ConvolutionSurface& surface, int piece) : surface_(surface), piece_(piece) {}
  double value(const Vec3& x) const override {
    Vec3 gradient;
    return value(x, gradient);
  }
  double value(const Vec3& x, Vec3& gradient) const override { return surface_.value_of_piece(piece_, x, gradient); }
  bool is_round() const override { return true; }
  double radius(const Vec3& x) const override { return surface_.radius(x); }

 private:
  const ConvolutionSurface& surface_;
  int piece_;
};

/// Distance / radius along a unit direction across the axis: Newton from the radius asked for, as all but wild shapes
/// are near it; else the search that cannot fail but by there being nothing.
std::optional<double> ray_length(const PieceView& surface, const AxisPoint& from, const Vec3& direction) {
  double t = from.radius;
  for (int iteration = 0; iteration < 4; ++iteration) {
    Vec3 gradient;
    const double value = surface.value(from.position + t * direction, gradient);
    const double step = -value / gradient.dot(direction);
    if (!(std::abs(step) < 0.25 * from.radius && gradient.dot(direction) > 0)) {
      break;
    }
    t += step;
    if (std::abs(step) < 1e-3 * from.radius) {  // the next would be of its square
      return t / from.radius;
    }
  }
  const std::optional<double> hit = shoot(surface, from.position, direction, from.radius, 2 * from.radius);
  return hit ? std::optional(*hit / from.radius) : std::nullopt;
}

std::optional<Section> measure(const PieceView& surface, const AxisPoint& target, const Vec3& normal) {
  constexpr int rays = 8;
  const Vec3 binormal = target.tangent.cross(normal);
  Section section;
  section.mean = 0;
  for (int k = 0; k < rays; ++k) {
    const double angle = 2 * std::numbers::pi * k / rays;
    const Vec3 direction = std::cos(angle) * normal + std::sin(angle) * binormal;
    const std::optional<double> length = ray_length(surface, target, direction);
    if (!length) {
      return std::nullopt;
    }
    section.mean += *length / rays;
    section.shift += (2 * *length / rays) * direction;
  }
  return section;
}

/// One round of corrections.
void calibrate(const Network& network, const ConvolutionSurface& surface, const Run& run,
               std::vector<ConvolvedAxis>& axes) {
  std::vector<std::pair<int, int>> samples;
  for (std::size_t b = 0; b < axes.size(); ++b) {
    for (std::size_t k = 0; k < axes[b].arc.size(); ++k) {
      if (axes[b].freedom[k] > 0) {
        samples.emplace_back(b, k);
      }
    }
  }
  parallel_for(run, samples.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto [b, k] = samples[i];
      ConvolvedAxis& axis = axes[b];
      const AxisPoint& target = axis.target[k];
      const PieceView view(surface, axis.piece[std::min<std::size_t>(k, axis.piece.size() - 1)]);
      const std::optional<Section> section = measure(view, target, axis.normal[k]);
      if (section) {
        const double factor = std::clamp(1 / section->mean, 0.8, 1.25);
        axis.factor[k] = std::clamp(axis.factor[k] * (1 + axis.freedom[k] * (factor - 1)), 0.5, 2.0);
        // the whole shift overshoots where bends are narrow
        Vec3 shift = axis.shift[k] - (0.8 * axis.freedom[k] * target.radius) * section->shift;
        const double longest = 0.5 * target.radius;
        axis.shift[k] = shift.norm() > longest ? Vec3(longest * shift.normalized()) : shift;
      }
    }
  });
  // Where a branch goes on in another, or in itself, both sides must stay together.
  std::vector<std::vector<std::pair<int, int>>> ends(network.nodes.size());
  for (std::size_t b = 0; b < axes.size(); ++b) {
    ends[network.branches[b].nodes[0]].emplace_back(b, 0);
    ends[network.branches[b].nodes[1]].emplace_back(b, static_cast<int>(axes[b].arc.size()) - 1);
  }
  for (const std::vector<std::pair<int, int>>& pair : ends) {
    if (pair.size() == 2) {
      const auto [b, k] = pair[0];
      const auto [c, l] = pair[1];
      axes[b].factor[k] = axes[c].factor[l] = 0.5 * (axes[b].factor[k] + axes[c].factor[l]);
      axes[b].shift[k] = axes[c].shift[l] = 0.5 * (axes[b].shift[k] + axes[c].shift[l]);
    }
  }
}

}  // namespace

std::unique_ptr<ImplicitSurface> make_convolution_surface(const Network& network, const ConvolutionOptions& options,
                                                          const Run& run) {
  check(network);
  const auto blending = std::make_shared<const Blending>(make_blending(network));
  std::vector<ConvolvedAxis> axes(network.branches.size());
  parallel_for(run, axes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      axes[b] = make_axis(network, static_cast<int>(b), *blending);
    }
  });
  auto surface = std::make_unique<ConvolutionSurface>(make_segments(network, axes), blending);
  for (int pass = 0; pass < options.calibration_passes; ++pass) {
    run.progress("surface", static_cast<double>(pass) / options.calibration_passes);
    calibrate(network, *surface, run, axes);
    surface = std::make_unique<ConvolutionSurface>(make_segments(network, axes), blending);
  }
  run.progress("surface", 1);
  return surface;
}

}  // namespace vasohex
