#include "vasohex/blocks/build_blocks.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>

#include "vasohex/blocks/hubs.h"
#include "vasohex/blocks/junction.h"
#include "vasohex/blocks/optimise.h"
#include "vasohex/blocks/split_hub.h"
#include "vasohex/blocks/topology.h"
#include "vasohex/core/node_family.h"
#include "vasohex/core/parallel.h"
#include "vasohex/quality/validity.h"

namespace vasohex {
namespace {

constexpr int kLine = kBlockDegree + 1;

/// A cross-section that a branch's blocks start or end with: its frame, its eight global vertices.
struct SectionVertices {
  SectionFrame frame;
  std::array<int, 4> inner{}, outer{};
};

struct ClusterResult {
  Cluster cluster;                          ///< as solved: hubs may have been divided
  std::vector<CubeAssignment> assignments;  ///< [hubs]
  ClusterBlocks blocks;
  BlockSolution solution;
};

std::vector<CubeAssignment> assignments_of(const Hub& hub, int count) {
  std::vector<Vec3> directions;
  for (const Arm& arm : hub.arms) {
    directions.push_back(arm.direction);
  }
  return cube_assignments(directions, count);
}

/// The hub with the least scaled Jacobian among those not tried yet; nothing if all were.
std::optional<int> weakest_hub(const ClusterResult& r, const std::vector<char>& tried) {
  std::vector<double> least(r.cluster.size(), 2.0);
  for (std::size_t b = 0; b < r.blocks.problem.blocks.size(); ++b) {
    const auto nodes = r.solution.nodes.begin() + static_cast<std::ptrdiff_t>(b) * kBlockNodes;
    double& of_hub = least[r.blocks.block_hub[b]];
    of_hub = std::min(of_hub, least_jacobian(std::vector<Vec3>(nodes, nodes + kBlockNodes)));
  }
  std::optional<int> weakest;
  for (int h = 0; h < static_cast<int>(least.size()); ++h) {
    if (!tried[h] && (!weakest || least[h] < least[*weakest])) {
      weakest = h;
    }
  }
  return weakest;
}

/// Clusters in which no hub has more arms than a cube can take.
std::vector<Cluster> with_small_hubs(const Cluster& cluster) {
  std::vector<Cluster> all{cluster};
  for (int h = 0; h < static_cast<int>(cluster.size()); ++h) {
    if (cluster[h].arms.size() > kCubeArms) {
      std::vector<Cluster> divided;
      for (const Cluster& c : all) {
        for (Cluster& d : split_hub(c, h)) {
          divided.push_back(std::move(d));
        }
      }
      all = std::move(divided);
    }
  }
  if (all.empty()) {
    throw Error(ErrorCode::internal, "a junction of more than 6 branches could not be divided among cubes");
  }
  constexpr std::size_t kMost = 4;
  all.resize(std::min(all.size(), kMost));
  return all;
}

/// One cube per junction; while that is weak, other assignments of the weakest junction's arms, or a tree of cubes there.
std::pair<ClusterResult, int> solve_cluster(const ImplicitSurface& surface, const Cluster& cluster,
                                            const BlockOptions& options) {
  std::optional<ClusterResult> best;
  int tried = 0;
  const auto is_good = [&] {
    return best && best->solution.certified && best->solution.min_jacobian >= options.good_jacobian;
  };
  const auto attempt = [&](const Cluster& c, const std::vector<CubeAssignment>& assignments) {
    ClusterResult r{c, assignments, cluster_blocks(surface, c, assignments), {}};
    r.solution = optimise_blocks(r.blocks.problem);
    ++tried;
    if (!best || r.solution.is_better_than(best->solution)) {
      best = std::move(r);
    }
  };
  for (const Cluster& c : with_small_hubs(cluster)) {
    std::vector<CubeAssignment> assignments;
    for (const Hub& hub : c) {
      assignments.push_back(assignments_of(hub, 1).front());
    }
    if (!is_good()) {
      attempt(c, assignments);
    }
  }
  constexpr int kMostRounds = 6;
  std::vector<char> done(best->cluster.size(), 0);
  for (int round = 0; round < kMostRounds && !is_good(); ++round) {
    const std::optional<int> hub = weakest_hub(*best, done);
    if (!hub) {
      break;
    }
    const ClusterResult before = *best;
    const std::vector<CubeAssignment> others = assignments_of(before.cluster[*hub], options.candidates);
    for (std::size_t rank = 1; rank < others.size() && !is_good(); ++rank) {
      std::vector<CubeAssignment> assignments = before.assignments;
      assignments[*hub] = others[rank];
      attempt(before.cluster, assignments);
    }
    if (before.cluster[*hub].arms.size() >= 4) {
      for (const Cluster& c : split_hub(before.cluster, *hub)) {
        std::vector<CubeAssignment> assignments = before.assignments;
        assignments[*hub] = assignments_of(c[*hub], 1).front();
        for (std::size_t h = before.cluster.size(); h < c.size(); ++h) {
          assignments.push_back(assignments_of(c[h], 1).front());
        }
        if (!is_good()) {
          attempt(c, assignments);
        }
      }
    }
    done.resize(best->cluster.size(), 1);
    done[*hub] = 1;
  }
  return {std::move(*best), tried};
}

/// Rotation-minimising frames at the ascending arc lengths `s`, by double reflection [Wang, Jüttler, Zheng, Liu 2008].
std::vector<SectionFrame> transported_frames(const Branch& branch, const std::vector<double>& s, const Vec3& start) {
  std::vector<SectionFrame> frames;
  AxisPoint here = axis_point(branch, s.front());
  Vec3 x = (start - here.tangent.dot(start) * here.tangent).normalized();
  double at = s.front();
  for (const double target : s) {
    const int steps = std::max(1, static_cast<int>(std::ceil((target - at) / (0.1 * here.radius))));
    const double from = at;
    for (int i = 1; i <= steps && target > from; ++i) {
      const AxisPoint next = axis_point(branch, from + (target - from) * i / steps);
      const Vec3 v1 = next.position - here.position;
      const double c1 = v1.squaredNorm();
      if (c1 > 0) {
        const Vec3 x_left = x - 2 / c1 * v1.dot(x) * v1;
        const Vec3 t_left = here.tangent - 2 / c1 * v1.dot(here.tangent) * v1;
        const Vec3 v2 = next.tangent - t_left;
        const double c2 = v2.squaredNorm();
        x = c2 > 0 ? Vec3(x_left - 2 / c2 * v2.dot(x_left) * v2) : x_left;
        x = (x - next.tangent.dot(x) * next.tangent).normalized();
      }
      here = next;
    }
    at = target;
    SectionFrame f;
    f.origin = here.position;
    f.x = x;
    f.y = here.tangent.cross(x);
    f.radius = here.radius;
    frames.push_back(f);
  }
  return frames;
}

/// A direction across the branch that turns with it when it is turned: towards its point furthest from the chord.
/// Straight branches have none; any direction does.
Vec3 own_direction(const Branch& branch) {
  const Vec3 chord = branch.points.back() - branch.points.front();
  const double length2 = chord.squaredNorm();
  Vec3 furthest = Vec3::Zero();
  for (const Vec3& p : branch.points) {
    Vec3 aside = p - branch.points.front();
    if (length2 > 0) {
      aside -= chord.dot(aside) / length2 * chord;
    }
    if (aside.squaredNorm() > furthest.squaredNorm() * (1 + 1e-9)) {
      furthest = aside;
    }
  }
  const Vec3& t = branch.tangents.front();
  const Vec3 across = furthest - t.dot(furthest) * t;
  return across.norm() > 1e-6 * branch.length() ? across.normalized() : t.unitOrthogonal();
}

/// Where blocks of the branch between arc lengths s0 and s1 meet: about block_length radii apart, closer in bends.
std::vector<double> stations(const Branch& branch, double s0, double s1, double block_length, int at_least) {
  constexpr int kSamples = 400;
  std::vector<double> blocks_before(kSamples + 1, 0.0);
  AxisPoint before = axis_point(branch, s0);
  for (int i = 1; i <= kSamples; ++i) {
    const AxisPoint p = axis_point(branch, s0 + (s1 - s0) * i / kSamples);
    const double turn = std::atan2(before.tangent.cross(p.tangent).norm(), before.tangent.dot(p.tangent));
    const double along = (s1 - s0) / kSamples / (block_length * 0.5 * (p.radius + before.radius));
    blocks_before[i] = blocks_before[i - 1] + std::max(along, turn / 0.6);
    before = p;
  }
  const int count = std::max(at_least, static_cast<int>(std::lround(blocks_before.back())));
  std::vector<double> s{s0};
  int i = 0;
  for (int b = 1; b < count; ++b) {
    const double wanted = blocks_before.back() * b / count;
    while (blocks_before[i + 1] < wanted) {
      ++i;
    }
    const double part = (wanted - blocks_before[i]) / (blocks_before[i + 1] - blocks_before[i]);
    s.push_back(s0 + (s1 - s0) * (i + part) / kSamples);
  }
  s.push_back(s1);
  return s;
}

double angle_about(const SectionFrame& frame, const Vec3& direction) {
  return std::atan2(direction.dot(frame.y), direction.dot(frame.x));
}

/// Blocks of one branch between its caps or ends, before they have global vertices.
struct BranchPiece {
  int branch = 0;
  bool closed = false;
  std::vector<double> stations;
  int quarter_turns = 0;             ///< corner j at the end is corner j + quarter_turns of what lies there
  std::vector<SectionFrame> frames;  ///< [kBlockDegree * blocks + 1] at the Gauss-Lobatto points of the stations
  std::vector<Vec3> nodes;           ///< [5 blocks][kLine^3], quad by quad, station by station
};

void fill_nodes(const ImplicitSurface& surface, BranchPiece& piece) {
  const std::vector<double> gauss = family_nodes(NodeFamily::gauss_lobatto, kBlockDegree);
  const int layers = static_cast<int>(piece.stations.size()) - 1;
  // section by section: the last of a layer is the first of the next
  std::vector<std::vector<Vec3>> sections(piece.frames.size(), std::vector<Vec3>(5 * kLine * kLine));
  for (std::size_t s = 0; s < piece.frames.size(); ++s) {
    for (int quad = 0; quad < 5; ++quad) {
      for (int at = 0; at < kLine * kLine; ++at) {
        sections[s][quad * kLine * kLine + at] =
            place_section_point(surface, piece.frames[s], quad, gauss[at % kLine], gauss[at / kLine]);
      }
    }
  }
  piece.nodes.resize(static_cast<std::size_t>(5) * layers * kBlockNodes);
  for (int layer = 0; layer < layers; ++layer) {
    for (int quad = 0; quad < 5; ++quad) {
      for (int k = 0; k < kLine; ++k) {
        for (int at = 0; at < kLine * kLine; ++at) {
          piece.nodes[static_cast<std::size_t>(5 * layer + quad) * kBlockNodes + k * kLine * kLine + at] =
              sections[layer * kBlockDegree + k][quad * kLine * kLine + at];
        }
      }
    }
  }
}

/// Frames along the piece: transported without rotation, turned so that the corners meet those of `first` and `last`
/// (frames of what lies at the ends, seen along the branch), the least turn spread evenly.
void place_frames(const Branch& branch, const SectionFrame* first, const SectionFrame* last, BranchPiece& piece) {
  const std::vector<double> gauss = family_nodes(NodeFamily::gauss_lobatto, kBlockDegree);
  std::vector<double> s{piece.stations.front()};
  for (std::size_t b = 0; b + 1 < piece.stations.size(); ++b) {
    for (int k = 1; k < kLine; ++k) {
      s.push_back(piece.stations[b] + gauss[k] * (piece.stations[b + 1] - piece.stations[b]));
    }
  }
  piece.frames = transported_frames(branch, s, own_direction(branch));
  std::optional<double> turn0, turn1;
  if (first) {
    turn0 = angle_about(piece.frames.front(), first->x);
  }
  if (last) {
    turn1 = angle_about(piece.frames.back(), last->x);
  }
  if (piece.closed) {
    turn0 = 0.0;
    turn1 = angle_about(piece.frames.back(), piece.frames.front().x);
  }
  if (turn0 && turn1) {
    constexpr double kQuarter = std::numbers::pi / 2;
    // ties (45 degrees exactly) must not be decided by rounding
    piece.quarter_turns = static_cast<int>(std::floor((*turn0 - *turn1) / kQuarter + 0.5 + 1e-6));
    *turn1 += piece.quarter_turns * kQuarter;
  }
  const double begin = turn0 ? *turn0 : turn1.value_or(0.0);
  const double end = turn1 ? *turn1 : begin;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double part = (s[i] - s.front()) / (s.back() - s.front());
    piece.frames[i] = turned(piece.frames[i], begin + part * (end - begin));
  }
}

/// Improves runs of layers whose blocks are weak, with the cross-sections around them fixed.
void optimise_weak_layers(const Branch& branch, const ImplicitSurface& surface, double good, BranchPiece& piece) {
  const int layers = static_cast<int>(piece.stations.size()) - 1;
  const auto layer_nodes = [&](int layer, int count) {
    const auto begin = piece.nodes.begin() + static_cast<std::ptrdiff_t>(5) * layer * kBlockNodes;
    return std::vector<Vec3>(begin, begin + static_cast<std::ptrdiff_t>(5) * count * kBlockNodes);
  };
  std::vector<char> weak(layers);
  for (int layer = 0; layer < layers; ++layer) {
    const BlockSolution judged = judge_blocks(layer_nodes(layer, 1));
    weak[layer] = !judged.certified || judged.min_jacobian < good;
  }
  for (int first = 0; first < layers; ++first) {
    if (!weak[first]) {
      continue;
    }
    int last = first;
    while (last + 1 < layers && (weak[last + 1] || (last + 2 < layers && weak[last + 2]))) {
      ++last;
    }
    const int from = std::max(0, first - 1), to = std::min(layers - 1, last + 1);
    BlockProblem problem;
    problem.surface = &surface;
    BlockProblem::Aim aim;
    for (int i = 0; i <= 24 * (to - from + 1); ++i) {
      const double s0 = piece.stations[from], s1 = piece.stations[to + 1];
      aim.axis.push_back(axis_point(branch, s0 + (s1 - s0) * i / (24 * (to - from + 1))).position);
    }
    problem.aims.push_back(aim);
    std::array<int, 4> in0{}, out0{};
    for (int layer = from; layer <= to + 1; ++layer) {
      const SectionFrame& frame = piece.frames[layer * kBlockDegree];
      std::array<int, 4> in1{}, out1{};
      for (int j = 0; j < 4; ++j) {
        in1[j] = static_cast<int>(problem.vertices.size());
        problem.vertices.push_back(place_section_point(surface, frame, 1 + j, 0, 0));
        out1[j] = static_cast<int>(problem.vertices.size());
        problem.vertices.push_back(place_section_point(surface, frame, 1 + j, 1, 0));
      }
      if (layer > from) {
        const auto add = [&](const std::array<int, 4>& low, const std::array<int, 4>& high) {
          problem.blocks.push_back({low[0], low[1], low[3], low[2], high[0], high[1], high[3], high[2]});
          problem.block_aim.push_back(0);
        };
        add(in0, in1);
        for (int j = 0; j < 4; ++j) {
          const int n = (j + 1) % 4;
          add({in0[j], out0[j], out0[n], in0[n]}, {in1[j], out1[j], out1[n], in1[n]});
        }
      }
      in0 = in1;
      out0 = out1;
    }
    for (int quad = 0; quad < 5; ++quad) {
      problem.sections.push_back({quad, 4, quad, piece.frames[from * kBlockDegree]});
      problem.sections.push_back({5 * (to - from) + quad, 5, quad, piece.frames[(to + 1) * kBlockDegree]});
    }
    const BlockSolution before = judge_blocks(layer_nodes(from, to - from + 1));
    const BlockSolution after = optimise_blocks(problem);
    if (after.is_better_than(before)) {
      std::copy(after.nodes.begin(), after.nodes.end(),
                piece.nodes.begin() + static_cast<std::ptrdiff_t>(5) * from * kBlockNodes);
    }
    first = last;
  }
}

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
      if (network.nodes[n].degree == 1) {
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
  int add_block(const std::array<int, 8>& vertices, const DirectionKinds& kinds, int place, const Vec3* nodes) {
    out_.blocks.push_back(vertices);
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

}  // namespace

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
      network.repairs.push_back("end " + network.nodes[far].name + " at (" + std::to_string(end.x()) + ", " +
                                std::to_string(end.y()) + ", " + std::to_string(end.z()) +
                                ") lies inside its junction: branch lengthened by " + std::to_string(missing));
    }
  }
}

BlockStructure build_blocks(const Network& network, const ImplicitSurface& surface, const BlockOptions& options,
                            const Run& run) {
  const std::vector<Cluster> clusters = find_clusters(network, surface);

  const auto start = std::chrono::steady_clock::now();
  std::vector<std::pair<ClusterResult, int>> solved(clusters.size());
  std::mutex progress;
  std::size_t done = 0;
  parallel_for(run, clusters.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      solved[c] = solve_cluster(surface, clusters[c], options);
      const std::lock_guard lock(progress);
      run.progress("junctions", static_cast<double>(++done) / clusters.size());
    }
  });

  BlockStructure out;
  out.optimise_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Assembly assembly(network, out);
  // cap of each branch end: arc length from that end, and its section seen along the branch
  std::vector<std::array<double, 2>> cap(network.branches.size(), {0, 0});
  std::vector<std::array<std::optional<SectionVertices>, 2>> section(network.branches.size());
  std::vector<char> linked(network.branches.size(), 0);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const auto& [r, tried] = solved[c];
    const int base = assembly.new_vertices(static_cast<int>(r.blocks.problem.vertices.size()));
    const int first_block = static_cast<int>(out.blocks.size());
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
                               clusters[c].size() > 1               ? "cubes linked"
                               : r.cluster.size() > 1 ? "tree of cubes"
                                                      : "cube",
                               r.solution.min_jacobian,
                               r.solution.certified, tried});
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
      piece.stations = stations(branch, cap[b][0], branch.length() - cap[b][1], options.block_length,
                                piece.closed ? 3 : 1);
      place_frames(branch, section[b][0] ? &section[b][0]->frame : nullptr,
                   section[b][1] ? &section[b][1]->frame : nullptr, piece);
      fill_nodes(surface, piece);
      optimise_weak_layers(branch, surface, 0.7, piece);
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
