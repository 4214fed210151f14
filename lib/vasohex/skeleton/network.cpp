#include "vasohex/skeleton/network.h"

#include <algorithm>

#include "vasohex/skeleton/spline.h"

namespace vasohex {

AxisPoint axis_point(const Branch& branch, double s) {
  const std::vector<double>& arc = branch.arc;
  s = std::clamp(s, 0.0, arc.back());
  const int last = static_cast<int>(arc.size()) - 1;
  const int i =
      std::clamp(static_cast<int>(std::upper_bound(arc.begin(), arc.end(), s) - arc.begin()) - 1, 0, last - 1);
  const double h = arc[i + 1] - arc[i], u = (s - arc[i]) / h;

  AxisPoint point;
  point.position = hermite(branch.points[i], branch.tangents[i], branch.points[i + 1], branch.tangents[i + 1], h, u);
  point.tangent =
      hermite_derivative(branch.points[i], branch.tangents[i], branch.points[i + 1], branch.tangents[i + 1], h, u)
          .normalized();
  // slopes from up to two neighbours to either side
  const int begin = std::max(i - 1, 0), end = std::min(i + 2, last);
  const std::span<const double> t(arc.data() + begin, end - begin + 1);
  const std::span<const double> r(branch.radii.data() + begin, end - begin + 1);
  const std::vector<double> slopes = monotone_slopes(t, r);
  point.radius = hermite(r[i - begin], slopes[i - begin], r[i + 1 - begin], slopes[i + 1 - begin], h, u);
  return point;
}

double mean_radius(const Branch& branch) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < branch.arc.size(); ++i) {
    sum += (branch.arc[i + 1] - branch.arc[i]) * (branch.radii[i] + branch.radii[i + 1]) / 2;
  }
  return sum / branch.length();
}

std::vector<std::vector<BranchEnd>> branch_ends(const Network& network) {
  std::vector<std::vector<BranchEnd>> ends(network.nodes.size());
  for (std::size_t b = 0; b < network.branches.size(); ++b) {
    for (int end = 0; end < 2; ++end) {
      ends[network.branches[b].nodes[end]].push_back({static_cast<int>(b), end});
    }
  }
  return ends;
}

}  // namespace vasohex
