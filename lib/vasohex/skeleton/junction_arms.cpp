#include "vasohex/skeleton/junction_arms.h"

#include "vasohex/core/disjoint_sets.h"

namespace vasohex {
namespace {

constexpr double kLinkLength = 3;  ///< widths: junctions nearer than that are looked at together

}  // namespace

std::optional<Arrival> arrival_of(const Path& path, int vessel, bool back) {
  const Path stations = counted(path, back);
  if (stations.size() < 2) {
    return {};
  }
  const Station& first = stations.front();
  std::size_t k = 1;
  while (k + 1 < stations.size() && (stations[k].point - first.point).norm() < first.radius) {
    ++k;
  }
  return Arrival{vessel,       back,
                 first.point,  (stations[k].point - first.point).normalized(),
                 first.radius, std::min(first.radius, stations[k].radius),
                 false};
}

Arrivals arrivals_of(const VesselGraph& graph, const std::vector<Path>& paths, const std::vector<SurfaceEnd>& ends) {
  Arrivals arrivals(graph.vessels.size());
  for (int v = 0; v < static_cast<int>(graph.vessels.size()); ++v) {
    for (const bool back : {false, true}) {
      arrivals[v][back] = arrival_of(paths[v], v, back);
      const int end = graph.nodes[graph.vessels[v].nodes[!back]].end;
      if (!arrivals[v][back] && end >= 0) {
        arrivals[v][back] = {v, back, ends[end].centre, ends[end].normal, ends[end].radius, ends[end].radius, true};
      }
    }
  }
  return arrivals;
}

Cluster cluster_of(const VesselGraph& graph, const Arrivals& arrivals, const std::vector<int>& nodes) {
  Cluster cluster;
  cluster.nodes = nodes;
  for (int v = 0; v < static_cast<int>(graph.vessels.size()); ++v) {
    const auto [a, b] = graph.vessels[v].nodes;
    if (nodes.size() > 1 && cluster.has(a) && cluster.has(b)) {
      cluster.inner.push_back(v);
      continue;
    }
    for (const bool back : {false, true}) {
      if (cluster.has(back ? b : a) && arrivals[v][back]) {
        cluster.arms.push_back(*arrivals[v][back]);
      } else if (cluster.has(back ? b : a)) {
        cluster.is_complete = false;
      }
    }
  }
  return cluster;
}

std::vector<std::vector<int>> near_junctions(const VesselGraph& graph, const std::vector<Path>& paths) {
  std::vector<int> degree(graph.nodes.size(), 0);
  for (const Vessel& v : graph.vessels) {
    ++degree[v.nodes[0]];
    ++degree[v.nodes[1]];
  }
  DisjointSets sets(static_cast<int>(graph.nodes.size()));
  for (std::size_t v = 0; v < graph.vessels.size(); ++v) {
    const auto [a, b] = graph.vessels[v].nodes;
    const double length = length_along(paths[v], 0, static_cast<double>(paths[v].size() - 1));
    if (degree[a] > 2 && degree[b] > 2 &&
        length < kLinkLength * std::max(graph.nodes[a].width, graph.nodes[b].width)) {
      sets.join(a, b);
    }
  }
  std::vector<std::vector<int>> all(graph.nodes.size());
  for (int i = 0; i < static_cast<int>(graph.nodes.size()); ++i) {
    all[sets.find(i)].push_back(i);
  }
  std::erase_if(all, [](const std::vector<int>& nodes) { return nodes.empty(); });
  return all;
}

}  // namespace vasohex
