#include "vasohex/surface/cone_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace vasohex {

ConeTree::ConeTree(std::vector<ConeSegment> segments) : segments_(std::move(segments)) {
  if (!segments_.empty()) {
    build(0, static_cast<std::uint32_t>(segments_.size()));
  }
}

void ConeTree::build(std::uint32_t begin, std::uint32_t end) {
  constexpr std::uint32_t leaf_size = 4;
  const auto at = static_cast<std::uint32_t>(nodes_.size());
  Core core;
  Box reach, middles;
  for (std::uint32_t i = begin; i < end; ++i) {
    const ConeSegment& segment = segments_[i];
    const Vec3 last = segment.start + segment.length * segment.direction;
    const double last_radius = segment.radius + segment.slope * segment.length;
    core.axis.add(segment.start);
    core.axis.add(last);
    core.max_radius = std::max({core.max_radius, segment.radius, last_radius});
    // a hair more than the reach: rounding must not cut off what the kernel itself sees
    const Vec3 ball = Vec3::Constant(kernel_reach * (1 + 1e-12) * segment.radius);
    const Vec3 last_ball = Vec3::Constant(kernel_reach * (1 + 1e-12) * last_radius);
    reach.add(segment.start - ball);
    reach.add(segment.start + ball);
    reach.add(last - last_ball);
    reach.add(last + last_ball);
    middles.add(0.5 * (segment.start + last));
  }
  Node node;
  for (int d = 0; d < 3; ++d) {
    node.min[d] = reach.min[d];
    node.max[d] = reach.max[d];
  }
  const bool leaf = end - begin <= leaf_size;
  node.first = begin;
  node.count = leaf ? end - begin : 0;
  nodes_.push_back(node);
  cores_.push_back(core);
  if (!leaf) {
    int axis = 0;
    (middles.max - middles.min).maxCoeff(&axis);
    // stable: the order of equal keys, hence every sum, does not depend on the standard library
    std::stable_sort(
        segments_.begin() + begin, segments_.begin() + end, [axis](const ConeSegment& a, const ConeSegment& b) {
          return 2 * a.start[axis] + a.length * a.direction[axis] < 2 * b.start[axis] + b.length * b.direction[axis];
        });
    const std::uint32_t middle = begin + (end - begin) / 2;
    build(begin, middle);
    build(middle, end);
  }
  nodes_[at].skip = static_cast<std::uint32_t>(nodes_.size());
}

double ConeTree::bound(std::uint32_t node, const Vec3& x) const {
  const Core& core = cores_[node];
  const Vec3 outside = (core.axis.min - x).cwiseMax(x - core.axis.max).cwiseMax(0.0);
  return outside.norm() / core.max_radius;
}

void ConeTree::nearest(std::uint32_t at, const Vec3& x, ConeNearest& best) const {
  const Node& node = nodes_[at];
  for (std::uint32_t k = 0; k < node.count; ++k) {
    const ConeNearest candidate = cone_nearest(segments_[node.first + k], x);
    if (candidate.ratio < best.ratio) {
      best = candidate;
    }
  }
  if (node.count > 0) {
    return;
  }
  std::pair<double, std::uint32_t> near{bound(at + 1, x), at + 1};
  std::pair<double, std::uint32_t> far{bound(nodes_[at + 1].skip, x), nodes_[at + 1].skip};
  if (far.first < near.first) {
    std::swap(near, far);
  }
  for (const auto& [least, child] : {near, far}) {
    if (least < best.ratio) {
      nearest(child, x, best);
    }
  }
}

ConeNearest ConeTree::nearest(const Vec3& x) const {
  ConeNearest best;
  best.ratio = std::numeric_limits<double>::infinity();
  if (!nodes_.empty()) {
    nearest(0, x, best);
  }
  return best;
}

}  // namespace vasohex
