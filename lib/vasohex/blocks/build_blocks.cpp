#include "vasohex/blocks/build_blocks.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <map>
#include <mutex>
#include <optional>

#include "vasohex/blocks/branch_blocks.h"
#include "vasohex/blocks/hubs.h"
#include "vasohex/blocks/solve_cluster.h"
#include "vasohex/blocks/topology.h"
#include "vasohex/core/node_family.h"
#include "vasohex/core/parallel.h"
#include "vasohex/quality/validity.h"

namespace vasohex {
namespace {

/// A cross-section that a branch's blocks start or end with: its frame, its eight global vertices.
struct SectionVertices {
  SectionFrame frame;
  std::array<int, 4> inner{}, outer{};
};

/// inlet*, then the others, each by number where names end in one.
bool surface_before(const std::string& a, const std::string& b) {
  const auto key = [](const std::string& name) {
    const std::size_t digits = name.find_last_not_of("0123456789") + 1;
    const bool numbered = digits < name.size() && name.size() - digits < 10;
    return std::tuple(!name.starts_with("inlet"), name.substr(0, digits),
                      numbered ? std::stol(name.substr(digits)) : 0L, name);
  };
  return key(a) < key(b);
}

class Assembly {
 public:
  Assembly(const Network& network, BlockStructure& out) : network_(network), out_(out) {
    out_.degree = kBlockDegree;
    out_.units = network.units;
    out_.surfaces = {"wall"};
    std::vector<std::pair<std::string, int>> ends;
    for (int n = 0; n < static_cast<int>(network.nodes.size()); ++n) {
      if (network.nodes[n].degree == 1 && !network.nodes[n].blind) {
        ends.emplace_back(network.nodes[n].name, n);
      }
    }
    std::stable_sort(ends.begin(), ends.end(),
                     [](const auto& a, const auto& b) { return surface_before(a.first, b.first); });
    for (const auto& [name, node] : ends) {
      surface_of_node_[node] = static_cast<int>(out_.surfaces.size());
      out_.surfaces.push_back(name);
    }
    out_.ends.resize(ends.size());
  }

  int new_vertices(int count) {
    out_.vertex_count += count;
    return out_.vertex_count - count;
  }
  /// The blocks to come follow the surface of these stretches.
  void begin_region(const std::vector<Stretch>& stretches) { out_.regions.push_back(stretches); }
  int add_block(const std::array<int, 8>& vertices, const DirectionKinds& kinds, int place, const Vec3* nodes) {
    out_.blocks.push_back(vertices);
    out_.block_region.push_back(static_cast<int>(out_.regions.size()) - 1);
    out_.kinds.push_back(kinds);
    out_.places.push_back(place);
    lattices_.insert(lattices_.end(), nodes, nodes + kBlockNodes);
    return static_cast<int>(out_.blocks.size()) - 1;
  }
  /// Face `face` of the block is the end of the network's node.
  void add_end(int block, int face, int node, SectionFrame outward) {
    const int surface = surface_of_node_.at(node);
    out_.boundary.push_back({block, face, surface});
    out_.ends[surface - 1] = outward;
  }
  const std::vector<Vec3>& lattices() const { return lattices_; }
  /// Shares the control points of common faces, finds the wall.
  void finish() {
    const BlockTopology topology = build_topology(out_.vertex_count, out_.blocks);
    const LatticeNumbering numbering(topology, std::vector<int>(topology.edges.size(), kBlockDegree));
    out_.nodes.assign(numbering.node_count(), Vec3::Zero());
    std::vector<int> ids;
    // where two blocks know a point, the first block's is taken: clusters are added before branches
    for (std::size_t b = out_.blocks.size(); b-- > 0;) {
      numbering.block_nodes(static_cast<int>(b), ids);
      for (int i = 0; i < kBlockNodes; ++i) {
        out_.nodes[ids[i]] = lattices_[b * kBlockNodes + i];
      }
    }
    std::map<std::pair<int, int>, bool> tagged;
    for (const auto& f : out_.boundary) {
      tagged[{f.block, f.face}] = true;
    }
    for (int b = 0; b < static_cast<int>(out_.blocks.size()); ++b) {
      numbering.block_nodes(b, ids);
      out_.block_nodes.insert(out_.block_nodes.end(), ids.begin(), ids.end());
      for (int f = 0; f < 6; ++f) {
        if (topology.face_block_count[topology.block_faces[b][f].face] == 1 && !tagged.contains({b, f})) {
          out_.boundary.push_back({b, f, 0});
        }
      }
    }
  }

 private:
  const Network& network_;
  BlockStructure& out_;
  std::map<int, int> surface_of_node_;
  std::vector<Vec3> lattices_;  ///< [blocks][kBlockNodes]
};

/// Whether no cube and no cap of the cluster stands elsewhere.
bool same_places(const Cluster& a, const Cluster& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](const Hub& x, const Hub& y) {
    return x.centre == y.centre && std::equal(x.arms.begin(), x.arms.end(), y.arms.begin(),
                                              [](const Arm& p, const Arm& q) { return p.cap == q.cap; });
  });
}

/// Clusters that failed, or nearly, are solved with their cubes and caps at other places, and the best is kept. Not
/// those of more than kMostMoved hubs: that takes longest, and has not made one valid in any network seen.
void try_other_places(const Network& network, const ImplicitSurface& surface, const std::vector<Cluster>& clusters,
                      const BlockOptions& options, const Run& run, std::vector<ClusterResult>& solved) {
  // less than where solve_cluster() gets patient: here each try is a search of its own
  constexpr double kNearlyFailed = 0.35;
  constexpr std::size_t kMostMoved = 2;
  constexpr double kAtNode = std::numeric_limits<double>::infinity();
  constexpr std::array<Placement, 5> kPlaces{{{1, 0.5}, {0.3, 0}, {-0.5, 0}, {kAtNode, 0}, {kAtNode, 0.5}}};
  std::vector<std::vector<Cluster>> tried{clusters};
  for (const Placement& placement : kPlaces) {
    std::vector<std::size_t> failed;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      const BlockSolution& now = solved[c].solution;
      if (clusters[c].size() <= kMostMoved && (!now.certified || now.min_jacobian < kNearlyFailed)) {
        failed.push_back(c);
      }
    }
    if (failed.empty()) {
      break;
    }
    const std::vector<Cluster> moved = find_clusters(network, surface, placement);
    parallel_for(run, failed.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Cluster& now = moved[failed[i]];
        if (std::any_of(tried.begin(), tried.end(),
                        [&](const std::vector<Cluster>& t) { return same_places(now, t[failed[i]]); })) {
          continue;
        }
        ClusterResult& best = solved[failed[i]];
        BlockOptions fewer = options;
        fewer.candidates = std::min(options.candidates, is_hopeless(best) ? 1 : 2);
        ClusterResult r = try_cluster(*surface.part(stretches_of(network, now)), now, fewer);
        const int candidates = best.candidates + r.candidates;
        const double cpu_seconds = best.cpu_seconds + r.cpu_seconds;
        if (r.solution.is_better_than(best.solution)) {
          best = std::move(r);
        }
        best.candidates = candidates;
        best.cpu_seconds = cpu_seconds;
      }
    });
    tried.push_back(moved);
  }
}

}  // namespace

BlockStructure build_blocks(const Network& network, const ImplicitSurface& surface, const BlockOptions& options,
                            const Run& run) {
  const std::vector<Cluster> clusters = find_clusters(network, surface);

  const auto start = std::chrono::steady_clock::now();
  std::vector<ClusterResult> solved(clusters.size());
  std::mutex progress;
  std::size_t done = 0;
  parallel_for(run, clusters.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      solved[c] = solve_cluster(*surface.part(stretches_of(network, clusters[c])), clusters[c], options);
      const std::lock_guard lock(progress);
      run.progress("junctions", static_cast<double>(++done) / clusters.size());
    }
  });

  try_other_places(network, surface, clusters, options, run, solved);

  BlockStructure out;
  out.optimise_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Assembly assembly(network, out);
  // cap of each branch end: arc length from that end, and its section seen along the branch
  std::vector<std::array<double, 2>> cap(network.branches.size(), {0, 0});
  std::vector<std::array<std::optional<SectionVertices>, 2>> section(network.branches.size());
  std::vector<char> linked(network.branches.size(), 0);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const ClusterResult& r = solved[c];
    const int base = assembly.new_vertices(static_cast<int>(r.blocks.problem.vertices.size()));
    const int first_block = static_cast<int>(out.blocks.size());
    assembly.begin_region(stretches_of(network, clusters[c]));
    for (std::size_t b = 0; b < r.blocks.problem.blocks.size(); ++b) {
      std::array<int, 8> vertices = r.blocks.problem.blocks[b];
      for (int& v : vertices) {
        v += base;
      }
      assembly.add_block(vertices, r.blocks.kinds[b], -1 - r.cluster[r.blocks.block_hub[b]].node,
                         &r.solution.nodes[b * kBlockNodes]);
    }
    for (const ClusterBlocks::Cap& k : r.blocks.caps) {
      const Arm& arm = r.cluster[k.hub].arms[k.arm];
      const Branch& branch = network.branches[arm.branch];
      cap[arm.branch][arm.end] = arm.cap;
      SectionVertices s{k.frame, k.inner, k.outer};
      if (arm.end == 1) {
        // seen against its normal: X and Y change places, and so do corners 1 and 3
        std::swap(s.frame.x, s.frame.y);
        std::swap(s.inner[1], s.inner[3]);
        std::swap(s.outer[1], s.outer[3]);
      }
      for (int j = 0; j < 4; ++j) {
        s.inner[j] += base;
        s.outer[j] += base;
      }
      section[arm.branch][arm.end] = s;
      if (arm.cap >= branch.length()) {
        linked[arm.branch] = 1;  // the cap is the end: no blocks of the branch's own
        for (const int b : k.blocks) {
          assembly.add_end(first_block + b, 5, branch.nodes[1 - arm.end], k.frame);
        }
      }
    }
    for (const Hub& hub : clusters[c]) {
      out.junctions.push_back({hub.node, static_cast<int>(hub.arms.size()),
                               clusters[c].size() > 1 ? "cubes linked"
                               : r.cluster.size() > 1 ? "tree of cubes"
                                                      : "cube",
                               r.solution.min_jacobian, r.solution.certified, r.candidates,
                               r.cpu_seconds / clusters[c].size()});
      for (const Arm& arm : hub.arms) {
        linked[arm.branch] |= arm.link >= 0;
      }
    }
  }

  std::vector<BranchPiece> pieces(network.branches.size());
  done = 0;
  parallel_for(run, network.branches.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      if (linked[b]) {
        continue;
      }
      const Branch& branch = network.branches[b];
      BranchPiece& piece = pieces[b];
      piece.branch = static_cast<int>(b);
      piece.closed = network.nodes[branch.nodes[0]].seam;
      piece.stations =
          stations(branch, cap[b][0], branch.length() - cap[b][1], options.block_length, piece.closed ? 3 : 1);
      constexpr int kMostHalved = 2;
      int halved = 0;
      do {
        place_frames(branch, section[b][0] ? &section[b][0]->frame : nullptr,
                     section[b][1] ? &section[b][1]->frame : nullptr, piece);
        fill_nodes(surface, piece);
      } while (halved++ < kMostHalved && halve_rough_layers(branch, surface, piece));
      optimise_weak_layers(branch, surface, options.mesh, 0.7, piece);
      const std::lock_guard lock(progress);
      run.progress("branches", static_cast<double>(++done) / network.branches.size());
    }
  });

  for (const BranchPiece& piece : pieces) {
    if (piece.stations.empty()) {
      continue;
    }
    const Branch& branch = network.branches[piece.branch];
    const int layers = static_cast<int>(piece.stations.size()) - 1;
    const auto new_section = [&] {
      SectionVertices s;
      const int base = assembly.new_vertices(8);
      for (int j = 0; j < 4; ++j) {
        s.inner[j] = base + j;
        s.outer[j] = base + 4 + j;
      }
      return s;
    };
    const SectionVertices first = section[piece.branch][0] ? *section[piece.branch][0] : new_section();
    SectionVertices low = first;
    for (int layer = 0; layer < layers; ++layer) {
      SectionVertices high;
      if (layer + 1 < layers) {
        high = new_section();
      } else if (piece.closed || section[piece.branch][1]) {
        const SectionVertices& end = piece.closed ? first : *section[piece.branch][1];
        for (int j = 0; j < 4; ++j) {
          const int corner = ((j + piece.quarter_turns) % 4 + 4) % 4;
          high.inner[j] = end.inner[corner];
          high.outer[j] = end.outer[corner];
        }
      } else {
        high = new_section();
      }
      assembly.begin_region({{piece.branch, piece.stations[layer], piece.stations[layer + 1]}});
      for (int quad = 0; quad < 5; ++quad) {
        const auto ring = [&](const SectionVertices& s) -> std::array<int, 4> {
          if (quad == 0) {
            return s.inner;
          }
          const int j = quad - 1, n = quad % 4;
          return {s.inner[j], s.outer[j], s.outer[n], s.inner[n]};
        };
        const auto l = ring(low), h = ring(high);
        const int block =
            assembly.add_block({l[0], l[1], l[3], l[2], h[0], h[1], h[3], h[2]}, quad == 0 ? kCoreBlock : kOuterBlock,
                               piece.branch, &piece.nodes[static_cast<std::size_t>(5 * layer + quad) * kBlockNodes]);
        if (layer == 0 && !piece.closed && !section[piece.branch][0]) {
          SectionFrame outward = piece.frames.front();
          std::swap(outward.x, outward.y);
          assembly.add_end(block, 4, branch.nodes[0], outward);
        }
        if (layer == layers - 1 && !piece.closed && !section[piece.branch][1]) {
          assembly.add_end(block, 5, branch.nodes[1], piece.frames.back());
        }
      }
      low = high;
    }
  }
  assembly.finish();
  out.min_jacobian = least_jacobian(assembly.lattices());
  for (const Validity& v : certify(kBlockDegree, NodeFamily::gauss_lobatto, out.nodes, out.block_nodes, run)) {
    out.certified += v.state == ValidityState::certified;
  }
  return out;
}

}  // namespace vasohex
