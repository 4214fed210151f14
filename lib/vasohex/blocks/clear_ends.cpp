#include "vasohex/blocks/clear_ends.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vasohex/blocks/hubs.h"
#include "vasohex/core/short_text.h"

namespace vasohex {

void clear_ends(Network& network) {
  const auto ends = branch_ends(network);
  for (int n = 0; n < static_cast<int>(network.nodes.size()); ++n) {
    if (network.nodes[n].seam || network.nodes[n].degree < 2) {
      continue;
    }
    const std::vector<double> distance = cap_distances(network, n);
    for (std::size_t a = 0; a < ends[n].size(); ++a) {
      Branch& branch = network.branches[ends[n][a].branch];
      const int far = branch.nodes[1 - ends[n][a].end];
      if (network.nodes[far].degree != 1) {
        continue;
      }
      const bool at_back = ends[n][a].end == 0;
      const double radius = at_back ? branch.radii.back() : branch.radii.front();
      const double missing = distance[a] - branch.length();
      if (missing <= 0) {
        continue;
      }
      // straight on, with the radius of the end
      const Vec3 tangent = at_back ? branch.tangents.back() : branch.tangents.front();
      const Vec3 outward = at_back ? tangent : Vec3(-tangent);
      const Vec3 end = at_back ? branch.points.back() : branch.points.front();
      const int steps = std::max(1, static_cast<int>(std::ceil(missing / (0.4 * radius))));
      std::vector<Vec3> points;
      for (int i = 1; i <= steps; ++i) {
        points.push_back(end + missing * i / steps * outward);
      }
      if (at_back) {
        const double length = branch.length();
        for (int i = 0; i < steps; ++i) {
          branch.points.push_back(points[i]);
          branch.arc.push_back(length + missing * (i + 1) / steps);
        }
        branch.radii.resize(branch.points.size(), radius);
        branch.tangents.resize(branch.points.size(), tangent);
      } else {
        for (double& s : branch.arc) {
          s += missing;
        }
        for (int i = 0; i < steps; ++i) {
          branch.points.insert(branch.points.begin(), points[i]);
          branch.arc.insert(branch.arc.begin(), missing * (steps - 1 - i) / steps);
        }
        branch.radii.insert(branch.radii.begin(), steps, radius);
        branch.tangents.insert(branch.tangents.begin(), steps, tangent);
      }
      network.nodes[far].position = points.back();
      network.repairs.push_back("end " + network.nodes[far].name + " at " + short_text(end) +
                                " lies inside its junction: branch lengthened by " + short_text(missing));
    }
  }
}

}  // namespace vasohex
