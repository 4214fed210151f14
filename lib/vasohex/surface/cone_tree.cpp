#include "vasohex/surface/cone_tree.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

namespace vasohex {

namespace {

Vec3 middle_of(const ConeSegment& segment) { return segment.start + 0.5 * segment.length * segment.direction; }

kernel::ConeGroup group_of(std::span<const ConeSegment> segments) {
  kernel::ConeGroup group;
  std::fill_n(group.radius, kernel::kCones, 1.0);
  group.piece = segments.front().piece;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const ConeSegment& segment = segments[i];
    for (int d = 0; d < 3; ++d) {
      group.start[d][i] = segment.start[d];
      group.direction[d][i] = segment.direction[d];
      group.curvature[d][i] = segment.curvature[d];
      group.end_normal[d][i] = segment.end_normal[d];
    }
    group.length[i] = segment.length;
    group.radius[i] = segment.radius;
    group.slope[i] = segment.slope;
    group.scale[i] = segment.scale;
    group.end_offset[i] = segment.end_offset;
    group.inverse_fade[i] = segment.end_fade > 0 ? 1 / segment.end_fade : 0.0;
  }
  return group;
}

/// Sorts along the longest side of the box around the middles. Stable: the order of equal keys, hence every sum, does
/// not depend on the standard library.
template <class Iterator, class Middle>
void sort_along_longest(Iterator begin, Iterator end, const Middle& middle) {
  Box middles;
  for (Iterator i = begin; i != end; ++i) {
    middles.add(middle(*i));
  }
  int axis = 0;
  (middles.max - middles.min).maxCoeff(&axis);
  std::stable_sort(begin, end, [&](const auto& a, const auto& b) { return middle(a)[axis] < middle(b)[axis]; });
}

}  // namespace

ConeTree::ConeTree(std::vector<ConeSegment> segments) : segments_(std::move(segments)) {
  std::stable_sort(segments_.begin(), segments_.end(),
                   [](const ConeSegment& a, const ConeSegment& b) { return a.piece < b.piece; });
  std::vector<Range> ranges;
  const auto size = static_cast<std::uint32_t>(segments_.size());
  for (std::uint32_t begin = 0, end = 0; begin < size; begin = end) {
    while (end < size && segments_[end].piece == segments_[begin].piece) {
      ++end;
    }
    divide(begin, end, ranges);
  }
  if (!ranges.empty()) {
    build(ranges, 0, static_cast<std::uint32_t>(ranges.size()));
  }
}

void ConeTree::divide(std::uint32_t begin, std::uint32_t end, std::vector<Range>& ranges) {
  const std::uint32_t count = end - begin, groups = (count + kernel::kCones - 1) / kernel::kCones;
  if (groups > 1) {
    sort_along_longest(segments_.begin() + begin, segments_.begin() + end, middle_of);
    const std::uint32_t middle = begin + count * (groups / 2) / groups;
    divide(begin, middle, ranges);
    divide(middle, end, ranges);
    return;
  }
  Range range{begin, end, Vec3::Zero()};
  for (std::uint32_t i = begin; i < end; ++i) {
    range.middle += middle_of(segments_[i]) / count;
  }
  ranges.push_back(range);
}

void ConeTree::build(std::vector<Range>& ranges, std::uint32_t begin, std::uint32_t end) {
  const auto at = static_cast<std::uint32_t>(nodes_.size());
  Core core;
  Box reach;
  for (std::uint32_t r = begin; r < end; ++r) {
    for (std::uint32_t i = ranges[r].begin; i < ranges[r].end; ++i) {
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
    }
  }
  Node node;
  for (int d = 0; d < 3; ++d) {
    node.min[d] = reach.min[d];
    node.max[d] = reach.max[d];
  }
  const bool leaf = end - begin == 1;
  if (leaf) {
    node.first = static_cast<std::uint32_t>(groups_.size());
    node.count = 1;
    const auto [first, last] = std::pair(ranges[begin].begin, ranges[begin].end);
    of_group_.push_back({first, last});
    groups_.push_back(group_of(std::span(segments_).subspan(first, last - first)));
  }
  nodes_.push_back(node);
  cores_.push_back(core);
  if (!leaf) {
    sort_along_longest(ranges.begin() + begin, ranges.begin() + end, [](const Range& r) { return r.middle; });
    const std::uint32_t middle = begin + (end - begin) / 2;
    build(ranges, begin, middle);
    build(ranges, middle, end);
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
  if (node.count > 0) {
    const auto [begin, end] = of_group_[node.first];
    for (std::uint32_t i = begin; i < end; ++i) {
      const ConeNearest candidate = cone_nearest(segments_[i], x);
      if (candidate.ratio < best.ratio) {
        best = candidate;
      }
    }
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
