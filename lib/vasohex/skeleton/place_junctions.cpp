#include "vasohex/skeleton/place_junctions.h"

#include <algorithm>
#include <cmath>

#include "vasohex/skeleton/through_vessel.h"

namespace vasohex {
namespace {

constexpr double kStay = 0.01;  ///< weight of the place of a junction in the graph, next to 1 of its widest axis

/// The point nearest to the lines of the vessels that meet.
Vec3 meeting_point(const std::vector<Arrival>& arrivals, const Vec3& before, double width) {
  double widest = 0;
  for (const Arrival& a : arrivals) {
    widest = std::max(widest, a.radius);
  }
  Eigen::Matrix3d matrix = kStay * Eigen::Matrix3d::Identity();
  Vec3 right = Vec3::Zero();
  for (const Arrival& a : arrivals) {
    const double w = a.radius * a.radius / (widest * widest);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - a.outward * a.outward.transpose();
    matrix += w * across;
    right += w * across * (a.point - before);
  }
  const Vec3 step = matrix.ldlt().solve(right);
  return before + step * std::min(1.0, 1.5 * std::max(width, widest) / std::max(step.norm(), 1e-300));
}

/// The arm's stations on the axis become those of the axis beyond the junction.
void lead_in(Path& path, const Arrival& arm, bool is_last, const ThroughVessel& vessel) {
  Path stations = counted(path, arm.back);
  stations.erase(stations.begin(), stations.begin() + static_cast<long>(leg_size(stations, arm.radius)));
  const double junction = is_last ? vessel.junctions.back() : vessel.junctions.front();
  Path lead;
  for (std::size_t i = 1; i + 1 < vessel.axis.size(); ++i) {
    if (is_last ? static_cast<double>(i) > junction : static_cast<double>(i) < junction) {
      lead.push_back(vessel.axis[i]);
    }
  }
  if (!is_last) {
    std::reverse(lead.begin(), lead.end());
  }
  stations.insert(stations.begin(), lead.begin(), lead.end());
  Path whole{arm.back ? path.back() : path.front()};
  whole.insert(whole.end(), stations.begin(), stations.end());
  whole.push_back(arm.back ? path.front() : path.back());
  whole.front().radius = whole.back().radius = 0;
  if (arm.back) {
    std::reverse(whole.begin(), whole.end());
  }
  path = std::move(whole);
}

void lay_out(const ThroughVessel& vessel, std::vector<Path>& paths, JunctionLayout& layout) {
  std::vector<int> nodes;
  for (std::size_t k = 0; k < vessel.junctions.size(); ++k) {
    if (k < vessel.nodes.size()) {
      nodes.push_back(vessel.nodes[k]);
    } else {
      nodes.push_back(static_cast<int>(layout.nodes.size()));
      layout.nodes.emplace_back();
    }
    layout.nodes[nodes[k]] = station_at(vessel.axis, vessel.junctions[k]);
  }
  for (const int v : vessel.inner) {
    layout.vessels[v] = {-1, -1};
  }
  for (const auto& [arm, path, k] : vessel.sides) {
    layout.vessels[arm.vessel][arm.back] = nodes[k];
    paths[arm.vessel] = path;
    if (arm.is_end) {
      paths[arm.vessel] = {paths[arm.vessel].front(), paths[arm.vessel].back()};
    }
  }
  for (const bool last : {false, true}) {
    const Arrival& arm = vessel.arms[last];
    layout.vessels[arm.vessel][arm.back] = last ? nodes.back() : nodes.front();
    lead_in(paths[arm.vessel], arm, last, vessel);
    const Vec3 along = tangent_at(vessel.axis, last ? vessel.junctions.back() : vessel.junctions.front());
    layout.inward[arm.vessel][arm.back] = last ? along : Vec3(-along);
  }
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    JunctionLink link{{nodes[k], nodes[k + 1]}, {}};
    for (double i = std::floor(vessel.junctions[k]) + 1; i < vessel.junctions[k + 1]; ++i) {
      link.path.push_back(vessel.axis[static_cast<std::size_t>(i)]);
    }
    layout.links.push_back(std::move(link));
  }
}

void place_alone(const VesselNode& node, const std::vector<Arrival>& arms, Station& place) {
  if (node.end >= 0) {
    return;
  }
  if (node.dead_end && arms.size() == 1 && !arms[0].is_end) {
    place.point = arms[0].point - (arms[0].point - place.point).norm() * arms[0].outward;
  } else if (arms.size() >= 2) {
    place.point = meeting_point(arms, node.position, node.width);
  }
  place.radius = 0;
  for (const Arrival& a : arms) {
    place.radius = std::max(place.radius, a.radius);
  }
}

}  // namespace

JunctionLayout place_junctions(const VesselGraph& graph, const PartedLumen& lumen, std::vector<Path>& paths,
                               const std::vector<Station>& nodes, const std::vector<SurfaceEnd>& ends) {
  const std::size_t n = graph.vessels.size();
  const Arrivals arrivals = arrivals_of(graph, paths, ends);
  JunctionLayout layout;
  layout.nodes = nodes;
  layout.inward.resize(n);
  for (const Vessel& v : graph.vessels) {
    layout.vessels.push_back(v.nodes);
  }
  std::vector<bool> is_placed(graph.nodes.size(), false);
  const auto try_part = [&](const std::vector<int>& together) {
    const auto vessel = through_vessel(cluster_of(graph, arrivals, together), graph, arrivals, lumen, paths);
    if (vessel) {
      lay_out(*vessel, paths, layout);
      for (const int i : vessel->nodes) {
        is_placed[i] = true;
      }
    }
    return vessel.has_value();
  };
  for (const std::vector<int>& together : near_junctions(graph, paths)) {
    const bool is_done = try_part(together);
    for (const int i : together) {
      if (!is_placed[i] && (is_done || together.size() == 1 || !try_part({i}))) {
        place_alone(graph.nodes[i], cluster_of(graph, arrivals, {i}).arms, layout.nodes[i]);
      }
    }
  }
  return layout;
}

}  // namespace vasohex
