#include "vasohex/skeleton/voxel_graph.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include "vasohex/core/short_text.h"

namespace vasohex {
namespace {

std::string place_of(const LabelVolume& volume, std::size_t voxel) {
  return short_text(volume.centre(voxel));
}

/// Voxels with their neighbours among themselves.
struct Lines {
  std::vector<std::size_t> voxels;
  std::vector<std::vector<int>> neighbours;
};

Lines lines_of(const LabelVolume& volume, const std::vector<std::size_t>& voxels) {
  Lines lines{voxels, std::vector<std::vector<int>>(voxels.size())};
  std::unordered_map<std::size_t, int> at;
  at.reserve(voxels.size());
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    at[voxels[v]] = static_cast<int>(v);
  }
  const std::ptrdiff_t row = volume.size[0], slice = row * volume.size[1];
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    for (int n = 0; n < 27; ++n) {
      const auto found = at.find(voxels[v] + (n % 3 - 1) + row * (n / 3 % 3 - 1) + slice * (n / 9 - 1));
      if (n != 13 && found != at.end()) {
        lines.neighbours[v].push_back(found->second);
      }
    }
  }
  return lines;
}

double length_of(const LabelVolume& volume, const VoxelChain& chain) {
  double length = 0;
  for (std::size_t k = 1; k < chain.voxels.size(); ++k) {
    length += (volume.centre(chain.voxels[k]) - volume.centre(chain.voxels[k - 1])).norm();
  }
  return length;
}

std::vector<int> degrees(const VoxelGraph& graph) {
  std::vector<int> degree(graph.nodes.size(), 0);
  for (const VoxelChain& chain : graph.chains) {
    ++degree[chain.nodes[0]];
    ++degree[chain.nodes[1]];
  }
  return degree;
}

/// How far a chain sticks out of the ball around its node, and its own largest radius out there.
struct Spur {
  double beyond = 0;  ///< length
  double radius = 0;
};
Spur spur_of(const LabelVolume& volume, const std::vector<float>& distances, const VoxelChain& chain, int free_side) {
  std::vector<std::size_t> voxels = chain.voxels;  // from the junction to the tip
  if (free_side == 0) {
    std::reverse(voxels.begin(), voxels.end());
  }
  const double ball = -distances[voxels.front()];
  const Vec3 centre = volume.centre(voxels.front());
  Spur spur;
  const double away = (volume.centre(voxels.back()) - centre).norm();
  // a tip within the ball is no vessel, however deep in the lumen it lies (the thickest place of a component)
  spur.beyond = away < ball ? away - ball : length_of(volume, chain) - distances[voxels.back()] - ball;
  for (const std::size_t v : voxels) {
    if ((volume.centre(v) - centre).norm() > ball) {
      spur.radius = std::max<double>(spur.radius, -distances[v]);
    }
  }
  return spur;
}

/// Joins the two chains at nodes of degree 2; drops nodes that have no chain.
void simplify(VoxelGraph& graph) {
  std::vector<std::vector<int>> chains_at(graph.nodes.size());
  for (std::size_t c = 0; c < graph.chains.size(); ++c) {
    for (const int n : graph.chains[c].nodes) {
      chains_at[n].push_back(static_cast<int>(c));
    }
  }
  std::vector<bool> gone(graph.chains.size(), false);
  for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
    if (chains_at[n].size() != 2 || chains_at[n][0] == chains_at[n][1]) {
      continue;
    }
    const int a = chains_at[n][0], b = chains_at[n][1];
    VoxelChain& first = graph.chains[a];
    VoxelChain second = graph.chains[b];
    const int node = static_cast<int>(n);
    if (first.nodes[1] != node) {
      std::swap(first.nodes[0], first.nodes[1]);
      std::reverse(first.voxels.begin(), first.voxels.end());
    }
    if (second.nodes[0] != node) {
      std::swap(second.nodes[0], second.nodes[1]);
      std::reverse(second.voxels.begin(), second.voxels.end());
    }
    first.nodes[1] = second.nodes[1];
    first.voxels.insert(first.voxels.end(), second.voxels.begin() + 1, second.voxels.end());
    gone[b] = true;
    chains_at[n].clear();
    std::replace(chains_at[second.nodes[1]].begin(), chains_at[second.nodes[1]].end(), b, a);
  }
  VoxelGraph result;
  std::vector<int> number(graph.nodes.size(), -1);
  for (std::size_t c = 0; c < graph.chains.size(); ++c) {
    if (gone[c]) {
      continue;
    }
    VoxelChain& chain = graph.chains[c];
    for (int& n : chain.nodes) {
      if (number[n] < 0) {
        number[n] = static_cast<int>(result.nodes.size());
        result.nodes.push_back(graph.nodes[n]);
      }
      n = number[n];
    }
    result.chains.push_back(std::move(chain));
  }
  graph = std::move(result);
}

}  // namespace

VoxelGraph voxel_graph(const LabelVolume& volume, const std::vector<std::size_t>& voxels) {
  const Lines lines = lines_of(volume, voxels);
  const int count = static_cast<int>(voxels.size());
  VoxelGraph graph;
  std::vector<int> node_of(count, -1);
  const auto add_node = [&](int v) {
    std::vector<int> group{v};
    node_of[v] = static_cast<int>(graph.nodes.size());
    if (lines.neighbours[v].size() > 2) {
      for (std::size_t next = 0; next < group.size(); ++next) {
        for (const int w : lines.neighbours[group[next]]) {
          if (node_of[w] < 0 && lines.neighbours[w].size() > 2) {
            node_of[w] = node_of[v];
            group.push_back(w);
          }
        }
      }
    }
    Vec3 middle = Vec3::Zero();
    for (const int w : group) {
      middle += volume.centre(voxels[w]) / static_cast<double>(group.size());
    }
    const int best = *std::min_element(group.begin(), group.end(), [&](int a, int b) {
      return (volume.centre(voxels[a]) - middle).norm() < (volume.centre(voxels[b]) - middle).norm();
    });
    graph.nodes.push_back(voxels[best]);
  };
  for (int v = 0; v < count; ++v) {
    if (node_of[v] < 0 && lines.neighbours[v].size() != 2) {
      add_node(v);
    }
  }
  std::vector<bool> used(count, false);
  const auto follow = [&](int from, int v) {  // from a voxel of a node along voxels with two neighbours
    VoxelChain chain;
    chain.nodes[0] = node_of[from];
    chain.voxels = {voxels[from]};
    int before = from;
    while (node_of[v] < 0) {
      used[v] = true;
      chain.voxels.push_back(voxels[v]);
      const int next = lines.neighbours[v][0] == before ? lines.neighbours[v][1] : lines.neighbours[v][0];
      before = v;
      v = next;
    }
    chain.voxels.push_back(voxels[v]);
    chain.nodes[1] = node_of[v];
    graph.chains.push_back(std::move(chain));
  };
  const auto follow_all = [&](int v) {
    for (const int w : lines.neighbours[v]) {
      if (node_of[w] < 0 && !used[w]) {
        follow(v, w);
      } else if (node_of[w] > node_of[v]) {
        graph.chains.push_back({{node_of[v], node_of[w]}, {voxels[v], voxels[w]}});
      }
    }
  };
  for (int v = 0; v < count; ++v) {
    if (node_of[v] >= 0) {
      follow_all(v);
    }
  }
  for (int v = 0; v < count; ++v) {  // rings
    if (node_of[v] < 0 && !used[v]) {
      add_node(v);
      follow_all(v);
    }
  }
  // A chain's own voxels lead it into the group of a junction; the node's voxel is where it ends.
  std::vector<VoxelChain> chains;
  for (VoxelChain& chain : graph.chains) {
    const std::size_t first = graph.nodes[chain.nodes[0]], last = graph.nodes[chain.nodes[1]];
    if (chain.nodes[0] == chain.nodes[1] && chain.voxels.size() < 5) {
      continue;
    }
    if (chain.voxels.front() != first) {
      chain.voxels.insert(chain.voxels.begin(), first);
    }
    if (chain.voxels.back() != last) {
      chain.voxels.push_back(last);
    }
    chains.push_back(std::move(chain));
  }
  graph.chains = std::move(chains);
  simplify(graph);
  return graph;
}

void prune(const LabelVolume& volume, const std::vector<float>& distances, double least_radii, VoxelGraph& graph,
           std::vector<std::string>& repairs) {
  const double voxel = volume.spacing.mean();
  while (true) {
    const std::vector<int> degree = degrees(graph);
    int worst = -1;
    double least = std::numeric_limits<double>::infinity();
    std::string text;
    for (std::size_t c = 0; c < graph.chains.size(); ++c) {
      const VoxelChain& chain = graph.chains[c];
      const bool free[2] = {degree[chain.nodes[0]] == 1, degree[chain.nodes[1]] == 1};
      if (!free[0] && !free[1]) {
        continue;
      }
      const double length = length_of(volume, chain);
      if (free[0] && free[1]) {
        double radius = 0;
        for (const std::size_t v : chain.voxels) {
          radius = std::max<double>(radius, -distances[v]);
        }
        if (length < 2 * std::max(radius, voxel) && length < least) {
          worst = static_cast<int>(c);
          least = length;
          text = "piece at " + place_of(volume, chain.voxels[chain.voxels.size() / 2]) + " of length " +
                 short_text(length) + " left out: not longer than wide";
        }
        continue;
      }
      const Spur spur = spur_of(volume, distances, chain, free[1] ? 1 : 0);
      if (spur.beyond < std::max(least_radii * spur.radius, 2 * voxel) && spur.beyond < least) {
        worst = static_cast<int>(c);
        least = spur.beyond;
        const std::size_t tip = free[1] ? chain.voxels.back() : chain.voxels.front();
        text = spur.beyond < std::max(spur.radius, voxel)
                   ? ""
                   : "branch at " + place_of(volume, tip) + " left out: it sticks out by " + short_text(spur.beyond);
      }
    }
    if (worst < 0) {
      return;
    }
    if (!text.empty()) {
      repairs.push_back(text);
    }
    graph.chains.erase(graph.chains.begin() + worst);
    simplify(graph);
  }
}

}  // namespace vasohex
