#include "vasohex/skeleton/vessel_graph.h"

#include <algorithm>
#include <limits>

#include "vasohex/core/short_text.h"
#include "vasohex/skeleton/chain_graph.h"
#include "vasohex/skeleton/dead_ends.h"

namespace vasohex {
namespace {

constexpr double kMergeJunctions = 0.2;  ///< local widths

/// Every end becomes a point with one edge.
void free_ends(ChainGraph& graph, const CurveGraph& curves, const std::vector<SurfaceEnd>& ends) {
  for (std::size_t e = 0; e < ends.size(); ++e) {
    int anchor = curves.anchors[e];
    const bool is_taken = graph.end_of[anchor] >= 0;
    if (graph.degree(anchor) > 1 || is_taken) {
      // a stub so short that its end fell together with the vessel: that one passes a radius behind the end
      const int tip = graph.add(ends[e].centre, ends[e].radius);
      if (!is_taken) {
        graph.points[anchor] -= ends[e].radius * ends[e].normal;
      }
      graph.join(anchor, tip);
      anchor = tip;
    }
    graph.points[anchor] = ends[e].centre;
    graph.widths[anchor] = std::max(graph.widths[anchor], ends[e].radius);
    graph.end_of[anchor] = static_cast<int>(e);
  }
}

void merge_near_junctions(ChainGraph& graph) {
  for (;;) {
    Chain best;
    double least = kMergeJunctions;
    const std::vector<Chain> chains = graph.chains();
    for (const Chain& chain : chains) {
      const int a = chain.front(), b = chain.back();
      if (a == b || graph.degree(a) < 3 || graph.degree(b) < 3) {
        continue;
      }
      const auto links = std::count_if(chains.begin(), chains.end(), [&](const Chain& c) {
        return (c.front() == a && c.back() == b) || (c.front() == b && c.back() == a);
      });
      const double apart = graph.length(chain) / std::max(graph.widths[a], graph.widths[b]);
      if (links == 1 && apart < least) {
        least = apart;
        best = chain;
      }
    }
    if (best.empty()) {
      return;
    }
    for (std::size_t k = 1; k < best.size(); ++k) {
      graph.unite(best[0], best[k]);
    }
  }
}

}  // namespace

VesselGraph split_into_vessels(const CurveGraph& curves, const SizedLumen& sized, const ClosedLumen& lumen,
                               const std::vector<SurfaceEnd>& ends, std::vector<std::string>& notes) {
  ChainGraph graph(curves, sized);
  free_ends(graph, curves, ends);
  treat_dead_ends(graph, lumen, notes);
  merge_near_junctions(graph);

  VesselGraph result;
  std::vector<int> node(graph.points.size(), -1), vessel(graph.points.size(), -1);
  std::vector<std::vector<std::pair<int, int>>> leaving(graph.points.size());  // of nodes: vessel, first point
  for (const Chain& chain : graph.chains()) {
    Vessel v;
    const int index = static_cast<int>(result.vessels.size());
    for (const bool last : {false, true}) {
      const int i = last ? chain.back() : chain.front();
      if (node[i] < 0) {
        node[i] = static_cast<int>(result.nodes.size());
        const int end = graph.end_of[i];
        result.nodes.push_back({graph.points[i], graph.widths[i], std::max(end, -1), end == ChainGraph::kDeadEnd});
      }
      v.nodes[last] = node[i];
      leaving[i].emplace_back(index, last ? chain[chain.size() - 2] : chain[1]);
    }
    for (const int i : chain) {
      v.points.push_back(graph.points[i]);
      v.widths.push_back(graph.widths[i]);
      vessel[i] = index;
    }
    result.vessels.push_back(std::move(v));
  }
  for (std::size_t i = 0; i < graph.points.size(); ++i) {
    if (!graph.is_gone(static_cast<int>(i)) && graph.degree(static_cast<int>(i)) == 0) {
      notes.push_back("the piece of the lumen around " + short_text(graph.points[i]) +
                      " is no longer than wide: left out");
    }
  }
  for (std::size_t p = 0; p < sized.surface.points.size(); ++p) {
    const int i = graph.root(curves.node_of[p]);
    int own = vessel[i];
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [v, next] : leaving[i]) {
      if (const double d = distance_to_segment(sized.surface.points[p], graph.points[i], graph.points[next]);
          d < least) {
        least = d;
        own = v;
      }
    }
    result.vessel_of.push_back(own);
  }
  return result;
}

}  // namespace vasohex
