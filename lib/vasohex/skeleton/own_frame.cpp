#include "vasohex/skeleton/own_frame.h"

#include <cmath>

namespace vasohex {
namespace {

constexpr double kGrid = 1.0 / (1 << 28);

double rounded(double x) { return std::round(x / kGrid) * kGrid; }
Vec3 rounded(const Vec3& x) { return {rounded(x.x()), rounded(x.y()), rounded(x.z())}; }

/// The sample whose `length` is largest by more than a hair: the first of those that are as good.
template <class F>
Vec3 largest(const Network& network, F&& length) {
  Vec3 best = Vec3::Zero();
  double most = -1;
  for (const Branch& branch : network.branches) {
    for (const Vec3& p : branch.points) {
      const double l = length(p);
      if (l > most * (1 + 1e-6)) {
        most = l;
        best = p;
      }
    }
  }
  return best;
}

}  // namespace

OwnFrame own_frame(const Network& network) {
  OwnFrame frame;
  double radius = 0, samples = 0;
  for (const Branch& branch : network.branches) {
    for (std::size_t i = 0; i < branch.points.size(); ++i) {
      frame.origin += branch.points[i];
      radius += branch.radii[i];
      samples += 1;
    }
  }
  frame.origin /= samples;
  frame.scale = radius / samples;
  const Vec3 x =
      (largest(network, [&](const Vec3& p) { return (p - frame.origin).norm(); }) - frame.origin).normalized();
  const auto aside = [&](const Vec3& p) { return Vec3((p - frame.origin) - x.dot(p - frame.origin) * x); };
  Vec3 y = aside(largest(network, [&](const Vec3& p) { return aside(p).norm(); }));
  y = y.norm() > 1e-6 * frame.scale ? y.normalized() : x.unitOrthogonal();
  frame.rotation << x, y, x.cross(y);
  return frame;
}

Network in_frame(const Network& network, const OwnFrame& frame) {
  Network moved = network;
  for (NetworkNode& node : moved.nodes) {
    node.position = rounded(frame.inward(node.position));
    node.radius = rounded(node.radius / frame.scale);
  }
  for (Branch& branch : moved.branches) {
    for (std::size_t i = 0; i < branch.points.size(); ++i) {
      branch.points[i] = rounded(frame.inward(branch.points[i]));
      branch.radii[i] = rounded(branch.radii[i] / frame.scale);
      branch.tangents[i] = rounded(Vec3(frame.rotation.transpose() * branch.tangents[i])).normalized();
      branch.arc[i] = rounded(branch.arc[i] / frame.scale);
    }
  }
  return moved;
}

}  // namespace vasohex
