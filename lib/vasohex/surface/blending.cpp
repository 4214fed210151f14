#include "vasohex/surface/blending.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <ranges>
#include <set>
#include <tuple>
#include <utility>

#include "vasohex/core/disjoint_sets.h"
#include "vasohex/core/equal_shares.h"
#include "vasohex/core/smooth_step.h"

namespace vasohex {
namespace {

/// Radii: so far from a junction its branches still blend where their tubes overlap. Beyond, their union has a crease
/// that no block can follow; with 8, forks below 10 degrees had folded elements in the crotch.
constexpr double kFarthest = 40;

AxisPoint end_point(const Network& network, const BranchEnd& end, double distance) {
  const Branch& branch = network.branches[end.branch];
  return axis_point(branch, end.end == 1 ? branch.length() - distance : distance);
}

/// How far along tube i, from the node, its wall lies within tube j: two straight tubes at the angle of their
/// directions over the first radius of arc.
double overlap_straight(const Vec3& direction_i, double radius_i, const Vec3& direction_j, double radius_j) {
  const double cosine = std::clamp(direction_i.dot(direction_j), -1.0, 1.0);
  const double sine = std::sqrt(1 - cosine * cosine);
  const double reach = radius_j + radius_i * cosine;
  const double longest = cosine < 0 ? radius_j : 8 * std::max(radius_i, radius_j);
  return reach >= longest * sine ? longest : std::max(reach / sine, 0.0);
}

/// The distance from the node at which curved tubes have parted: branches that leave a junction side by side and
/// diverge later overlap further than their directions at the node tell.
double overlap_curved(const Network& network, const BranchEnd& i, const BranchEnd& j, double step, double longest) {
  double gap = 0, gap_before = 0;
  for (double s = step; s < longest; s += step, gap_before = gap) {
    const AxisPoint a = end_point(network, i, s), b = end_point(network, j, s);
    gap = (a.position - b.position).norm() - a.radius - b.radius;
    if (gap >= 0) {
      return gap_before < 0 ? s - step * gap / (gap - gap_before) : s;
    }
    if (s > network.branches[i.branch].length() && s > network.branches[j.branch].length()) {
      return s;  // both have ended: the joints beyond take over
    }
  }
  return longest;
}

BlendBall node_ball(const Network& network, int node, const std::vector<BranchEnd>& ends) {
  BlendBall ball;
  ball.center = network.nodes[node].position;
  if (ends.size() < 2) {
    return ball;
  }
  std::vector<Vec3> directions;
  std::vector<double> radii;
  for (const BranchEnd& end : ends) {
    const AxisPoint start = end_point(network, end, 0);
    const double length = network.branches[end.branch].length();
    const AxisPoint next = end_point(network, end, std::min(start.radius, 0.5 * length));
    directions.push_back((next.position - start.position).normalized());
    radii.push_back(next.radius);
  }
  const double radius = *std::max_element(radii.begin(), radii.end());
  double overlap = radius;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t j = 0; j < ends.size(); ++j) {
      if (i != j) {
        overlap = std::max(overlap, overlap_straight(directions[i], radii[i], directions[j], radii[j]));
      }
      if (i < j) {
        overlap = std::max(overlap, overlap_curved(network, ends[i], ends[j], 0.1 * radius, kFarthest * radius));
      }
    }
  }
  ball.inner = overlap + radius;
  ball.outer = ball.inner + 2 * radius;
  return ball;
}

/// The distance along a branch end, at most `longest`, at which it is nearest to x.
double nearest_to(const Network& network, const BranchEnd& end, double step, double longest, const Vec3& x) {
  double nearest = 0, least = std::numeric_limits<double>::infinity();
  for (double s = 0; s <= std::min(longest, network.branches[end.branch].length()); s += step) {
    const double distance = (end_point(network, end, s).position - x).norm();
    if (distance < least) {
      least = distance;
      nearest = s;
    }
  }
  return nearest;
}

/// Where branches from two nodes close to each other have not parted yet: around all points of each that lie within the
/// other, and beyond by as much as a tube needs for a rounded crotch. They are together from both their nodes on, or
/// one comes past the node of the other. Nothing if they are apart there. Tubes that part within their trunk get a ball
/// within it, which cannot be seen.
std::optional<BlendBall> sibling_ball(const Network& network, const BranchEnd& i, const BranchEnd& j) {
  const AxisPoint start_i = end_point(network, i, 0), start_j = end_point(network, j, 0);
  const double step = 0.1 * std::min(start_i.radius, start_j.radius);
  const double longest = kFarthest * std::max(start_i.radius, start_j.radius);
  std::array<double, 2> together{};  // along each
  double depth = 0;
  const double past_j = nearest_to(network, i, step, longest, start_j.position);
  const double past_i = nearest_to(network, j, step, longest, start_i.position);
  for (const auto& [s, t] : {std::pair(0.0, 0.0), std::pair(past_j, 0.0), std::pair(0.0, past_i)}) {
    const AxisPoint a = end_point(network, i, s), b = end_point(network, j, t);
    const double here = a.radius + b.radius - (a.position - b.position).norm();
    if (depth <= 0 && here > 0) {
      together = {s, t};
      depth = here;
    }
  }
  if (depth <= 0) {
    return std::nullopt;
  }
  const AxisPoint first_i = end_point(network, i, together[0]), first_j = end_point(network, j, together[1]);
  BlendBall ball;
  ball.center = 0.5 * (first_i.position + first_j.position);
  for (const auto& [from, to, start] : {std::tuple(i, j, together[0]), std::tuple(j, i, together[1])}) {
    const double length = std::min(start + longest, network.branches[from.branch].length());
    const double other = std::min(longest, network.branches[to.branch].length());
    bool within = true;
    for (double s = start; s < length && within; s += step) {
      const AxisPoint a = end_point(network, from, s);
      within = false;
      for (double t = 0; t < other && !within; t += step) {
        const AxisPoint b = end_point(network, to, t);
        within = (a.position - b.position).norm() < a.radius + b.radius;
      }
      ball.inner = std::max(ball.inner, (a.position - ball.center).norm());
    }
  }
  const double margin = std::min({depth, first_i.radius, first_j.radius});
  ball.inner += margin;
  ball.outer = ball.inner + 2 * margin;
  return ball;
}

/// Small, so that the turns of a coil stay apart; yet where both sides of the cut reach (1.5 radii, 1.7 on steep
/// tapers) the weight is 1, and the cut cannot be seen.
BlendBall cut_ball(const Branch& branch, double arc) {
  const AxisPoint at = axis_point(branch, arc);
  return {at.position, 1.75 * at.radius, 2.5 * at.radius};
}

/// Cuts about every 6 radii of arc, such that the balls of no two joints along the branch meet.
std::vector<double> cut_branch(const Branch& branch, double first_ball, double last_ball) {
  std::vector<double> radii_of_arc(branch.points.size(), 0);  // arc length measured in local radii
  for (std::size_t k = 1; k < branch.points.size(); ++k) {
    radii_of_arc[k] =
        radii_of_arc[k - 1] + 2 * (branch.arc[k] - branch.arc[k - 1]) / (branch.radii[k] + branch.radii[k - 1]);
  }
  const int pieces = static_cast<int>(std::min(radii_of_arc.back() / 6 + 1e-6, 1e6));
  std::vector<double> cuts;
  for (const auto& [k, part] : equal_shares(radii_of_arc, pieces)) {
    const double arc = branch.arc[k] + part * (branch.arc[k + 1] - branch.arc[k]);
    const double outer = cut_ball(branch, arc).outer;
    if (arc > first_ball + outer && arc < branch.length() - last_ball - outer) {
      cuts.push_back(arc);
    }
  }
  return cuts;
}

/// The balls of the siblings of all joints.
void add_siblings(const Network& network, Blending& blending) {
  // [piece]: the ends of its branch where it starts and ends
  std::vector<int> branch_of(blending.nodes_of.size(), 0);
  for (std::size_t b = 0; b < blending.first_piece.size(); ++b) {
    const int first = blending.first_piece[b];
    std::fill_n(branch_of.begin() + first, blending.cuts[b].size() + 1, static_cast<int>(b));
  }
  blending.siblings.resize(blending.joints.size());
  for (std::size_t joint = 0; joint < blending.joints.size(); ++joint) {
    const std::vector<int>& pieces = blending.pieces_of[joint];
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (std::size_t k = i + 1; k < pieces.size(); ++k) {
        if (!blending.are_siblings(static_cast<int>(joint), pieces[i], pieces[k])) {
          continue;
        }
        for (int side = 0; side < 4; ++side) {
          const int p = pieces[i], q = pieces[k], at_p = side % 2, at_q = side / 2;
          const int here = static_cast<int>(joint);
          if (blending.joints_at[p][at_p] != here || blending.joints_at[q][at_q] != here) {
            continue;
          }
          if (const auto ball = sibling_ball(network, {branch_of[p], at_p}, {branch_of[q], at_q})) {
            blending.siblings[joint].push_back({{p, q}, *ball});
          }
        }
      }
    }
    // after all pairs: whether the joint has siblings is told by the number of its balls
    for (const SiblingBall& s : blending.siblings[joint]) {
      blending.joints[joint].push_back(s.ball);
    }
  }
}

/// 1 - product over the balls of (1 - weight).
template <typename Balls>
BlendWeight weight_of(Balls&& balls, const Vec3& x) {
  double rest = 1;  // product of (1 - weight)
  Vec3 gradient = Vec3::Zero();
  for (const BlendBall& ball : balls) {
    const Vec3 away = x - ball.center;
    const double squared = away.squaredNorm();
    if (squared >= ball.outer * ball.outer) {
      continue;
    }
    if (squared <= ball.inner * ball.inner) {
      return {1, Vec3::Zero()};
    }
    const double distance = std::sqrt(squared), width = ball.outer - ball.inner;
    const double t = (distance - ball.inner) / width;
    const double factor = smooth_step(t);
    gradient = factor * gradient - rest * (30 * t * t * (1 - t) * (1 - t) / (width * distance)) * away;
    rest *= factor;
  }
  return {1 - rest, gradient};
}

}  // namespace

BlendWeight Blending::weight(int joint, const Vec3& x) const { return weight_of(joints[joint], x); }

BlendWeight Blending::sibling_weight(int joint, int piece, int other, const Vec3& x) const {
  const std::array<int, 2> pair{std::min(piece, other), std::max(piece, other)};
  const auto of_pair = [&](const SiblingBall& s) { return s.pieces == pair; };
  return weight_of(siblings[joint] | std::views::filter(of_pair) | std::views::transform(&SiblingBall::ball), x);
}

bool Blending::are_siblings(int joint, int piece, int other) const {
  if (joints[joint].size() < 2) {
    return false;  // a lone node or a cut: all its pieces meet there
  }
  for (const int a : nodes_of[piece]) {
    for (const int b : nodes_of[other]) {
      if (a >= 0 && a == b) {
        return false;
      }
    }
  }
  return std::abs(piece - other) != 1 || nodes_of[std::min(piece, other)][1] >= 0;
}

std::vector<int> Blending::pieces_around(const std::vector<Stretch>& stretches) const {
  std::set<int> around;
  for (const Stretch& stretch : stretches) {
    for (int k = 0; k <= static_cast<int>(cuts[stretch.branch].size()); ++k) {
      const int piece = first_piece[stretch.branch] + k;
      if (arcs[piece][0] > stretch.to || arcs[piece][1] < stretch.from) {
        continue;
      }
      around.insert(piece);
      for (int side = 0; side < 2; ++side) {
        const int joint = joints_at[piece][side], node = nodes_of[piece][side];
        if (joint >= 0) {
          const double inner = node >= 0 ? node_balls[node].inner : joints[joint].front().inner;
          const double at = arcs[piece][side];
          if (at > stretch.from - inner && at < stretch.to + inner) {
            around.insert(pieces_of[joint].begin(), pieces_of[joint].end());
          }
        }
      }
    }
  }
  return {around.begin(), around.end()};
}

Blending make_blending(const Network& network) {
  const int nodes = static_cast<int>(network.nodes.size());
  const int branches = static_cast<int>(network.branches.size());
  const std::vector<std::vector<BranchEnd>> ends = branch_ends(network);
  Blending blending;
  for (int node = 0; node < nodes; ++node) {
    blending.node_balls.push_back(node_ball(network, node, ends[node]));
  }

  int pieces = 0;
  std::vector<std::vector<BlendBall>> cut_balls(branches);
  for (int b = 0; b < branches; ++b) {
    const Branch& branch = network.branches[b];
    blending.cuts.push_back(
        cut_branch(branch, blending.node_balls[branch.nodes[0]].outer, blending.node_balls[branch.nodes[1]].outer));
    blending.first_piece.push_back(pieces);
    pieces += static_cast<int>(blending.cuts[b].size()) + 1;
  }
  blending.joints_of.resize(pieces);
  blending.nodes_of.assign(pieces, {-1, -1});
  blending.joints_at.assign(pieces, {-1, -1});
  blending.arcs.resize(pieces);
  for (int b = 0; b < branches; ++b) {
    const std::vector<double>& cuts = blending.cuts[b];
    const int first = blending.first_piece[b];
    blending.nodes_of[first][0] = network.branches[b].nodes[0];
    blending.nodes_of[first + cuts.size()][1] = network.branches[b].nodes[1];
    for (std::size_t k = 0; k <= cuts.size(); ++k) {
      blending.arcs[first + k] = {k == 0 ? 0.0 : cuts[k - 1],
                                  k == cuts.size() ? network.branches[b].length() : cuts[k]};
    }
  }

  // Nodes whose balls meet along a branch form one joint.
  DisjointSets near(nodes);
  for (const Branch& branch : network.branches) {
    const BlendBall &first = blending.node_balls[branch.nodes[0]], &last = blending.node_balls[branch.nodes[1]];
    if (first.inner > 0 && last.inner > 0 && branch.length() < first.inner + last.inner) {
      near.join(branch.nodes[0], branch.nodes[1]);
    }
  }
  std::vector<int> joint_of_node(nodes, -1);
  for (int node = 0; node < nodes; ++node) {
    if (blending.node_balls[node].inner > 0) {
      const int top = near.find(node);
      if (joint_of_node[top] < 0) {
        joint_of_node[top] = static_cast<int>(blending.joints.size());
        blending.joints.emplace_back();
      }
      joint_of_node[node] = joint_of_node[top];
      blending.joints[joint_of_node[node]].push_back(blending.node_balls[node]);
    }
  }
  const auto join = [&](int piece, int side, int joint) {
    blending.joints_at[piece][side] = joint;
    std::vector<int>& of_piece = blending.joints_of[piece];
    if (std::find(of_piece.begin(), of_piece.end(), joint) == of_piece.end()) {
      of_piece.push_back(joint);
    }
  };
  for (int b = 0; b < branches; ++b) {
    const std::array<int, 2>& at = network.branches[b].nodes;
    const int first = blending.first_piece[b], last = first + static_cast<int>(blending.cuts[b].size());
    if (joint_of_node[at[0]] >= 0) {
      join(first, 0, joint_of_node[at[0]]);
    }
    if (joint_of_node[at[1]] >= 0) {
      join(last, 1, joint_of_node[at[1]]);
    }
    for (int cut = 0; cut < last - first; ++cut) {
      const int joint = static_cast<int>(blending.joints.size());
      blending.joints.push_back({cut_ball(network.branches[b], blending.cuts[b][cut])});
      join(first + cut, 1, joint);
      join(first + cut + 1, 0, joint);
    }
  }
  blending.pieces_of.resize(blending.joints.size());
  for (int piece = 0; piece < pieces; ++piece) {
    std::sort(blending.joints_of[piece].begin(), blending.joints_of[piece].end());
    for (const int joint : blending.joints_of[piece]) {
      blending.pieces_of[joint].push_back(piece);
    }
  }
  add_siblings(network, blending);
  return blending;
}

}  // namespace vasohex
