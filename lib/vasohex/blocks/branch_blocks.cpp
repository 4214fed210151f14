#include "vasohex/blocks/branch_blocks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "vasohex/core/equal_shares.h"
#include "vasohex/core/node_family.h"

namespace vasohex {
namespace {

constexpr int kLine = kBlockDegree + 1;

/// Rotation-minimising frames at the ascending arc lengths `s`, by double reflection [Wang, Jüttler, Zheng, Liu
/// 2008].
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

double angle_about(const SectionFrame& frame, const Vec3& direction) {
  return std::atan2(direction.dot(frame.y), direction.dot(frame.x));
}

/// The control points of layers `from` to `to`.
std::vector<Vec3> nodes_of(const BranchPiece& piece, int from, int to) {
  const auto begin = piece.nodes.begin() + static_cast<std::ptrdiff_t>(5) * from * kBlockNodes;
  return {begin, begin + static_cast<std::ptrdiff_t>(5) * (to - from + 1) * kBlockNodes};
}

/// Layers `from` to `to`, optimised between the cross-sections at their ends.
BlockSolution optimised(const Branch& branch, const ImplicitSurface& surface, const MeshDivision& mesh,
                        const BranchPiece& piece, int from, int to) {
  const std::shared_ptr<const ImplicitSurface> part =
      surface.part({{piece.branch, piece.stations[from], piece.stations[to + 1]}});
  BlockProblem problem;
  problem.surface = part.get();
  problem.mesh = mesh;
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
      problem.vertices.push_back(place_section_point(*part, frame, 1 + j, 0, 0));
      out1[j] = static_cast<int>(problem.vertices.size());
      problem.vertices.push_back(place_section_point(*part, frame, 1 + j, 1, 0));
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
  constexpr double kWeak = 0.7;  // below it blocks are worth refining
  return fit_to_mesh(problem, refine_blocks(problem, optimise_blocks(problem), kWeak, false));
}

/// Whether the surface leaves the wall of the layer's blocks, as at a bulge, and shorter blocks could follow it
/// better.
bool is_rough(const Branch& branch, const ImplicitSurface& surface, const BranchPiece& piece, int layer) {
  constexpr double kRough = 0.05;  // of the local radius
  constexpr double kShort = 1;     // radii: at bulges, halves of shorter layers fold [measured]
  constexpr int kSamples = 9;      // per direction of a block's wall
  const double s0 = piece.stations[layer], s1 = piece.stations[layer + 1];
  if (surface.is_round() || s1 - s0 < kShort * axis_point(branch, 0.5 * (s0 + s1)).radius) {
    return false;
  }
  std::vector<double> at(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    at[i] = (i + 0.5) / kSamples;
  }
  const std::vector<double> weights = lagrange_values(family_nodes(NodeFamily::gauss_lobatto, kBlockDegree), at);
  const auto part = surface.part({{piece.branch, s0, s1}});
  for (int quad = 1; quad < 5; ++quad) {
    const Vec3* nodes = &piece.nodes[static_cast<std::size_t>(5 * layer + quad) * kBlockNodes];
    for (int sample = 0; sample < kSamples * kSamples; ++sample) {
      Vec3 p = Vec3::Zero();
      for (int k = 0; k < kLine; ++k) {
        for (int j = 0; j < kLine; ++j) {
          p += weights[sample / kSamples * kLine + k] * weights[sample % kSamples * kLine + j] *
               nodes[kLine - 1 + kLine * (j + kLine * k)];
        }
      }
      if (std::abs(part->value(p)) > kRough * part->radius(p)) {
        return true;
      }
    }
  }
  return false;
}

/// The best found for layers `from` to `to`: as they are, optimised all together or, where that is not certified,
/// each half for itself. A long run may turn so far that it meets itself, and then no surface of all of it serves.
BlockSolution improved(const Branch& branch, const ImplicitSurface& surface, const MeshDivision& mesh,
                       const BranchPiece& piece, int from, int to) {
  BlockSolution best = judge_blocks(nodes_of(piece, from, to), mesh);
  const auto keep_better = [&](BlockSolution other) {
    if (other.is_better_than(best)) {
      best = std::move(other);
    }
  };
  keep_better(optimised(branch, surface, mesh, piece, from, to));
  if (!best.certified && from < to) {
    const int middle = (from + to) / 2;
    BlockSolution halves = improved(branch, surface, mesh, piece, from, middle);
    const BlockSolution second = improved(branch, surface, mesh, piece, middle + 1, to);
    halves.nodes.insert(halves.nodes.end(), second.nodes.begin(), second.nodes.end());
    halves.min_jacobian = std::min(halves.min_jacobian, second.min_jacobian);
    halves.certified = halves.certified && second.certified;
    keep_better(std::move(halves));
  }
  return best;
}

}  // namespace

std::vector<double> stations(const Branch& branch, double s0, double s1, double block_length, int at_least) {
  constexpr int kSamples = 400;
  std::vector<double> blocks_before(kSamples + 1, 0.0);
  AxisPoint before = axis_point(branch, s0);
  for (int i = 1; i <= kSamples; ++i) {
    const AxisPoint p = axis_point(branch, s0 + (s1 - s0) * i / kSamples);
    const double turn = angle_between(before.tangent, p.tangent);
    const double along = (s1 - s0) / kSamples / (block_length * 0.5 * (p.radius + before.radius));
    blocks_before[i] = blocks_before[i - 1] + std::max(along, turn / 0.6);
    before = p;
  }
  const int count = std::max(at_least, static_cast<int>(std::lround(blocks_before.back())));
  std::vector<double> s{s0};
  for (const auto& [i, part] : equal_shares(blocks_before, count)) {
    s.push_back(s0 + (s1 - s0) * (static_cast<double>(i) + part) / kSamples);
  }
  s.push_back(s1);
  return s;
}

void fill_nodes(const ImplicitSurface& surface, BranchPiece& piece) {
  const auto around = [&](int layer) {
    return surface.part({{piece.branch, piece.stations[layer], piece.stations[layer + 1]}});
  };
  const std::vector<double> gauss = family_nodes(NodeFamily::gauss_lobatto, kBlockDegree);
  const int layers = static_cast<int>(piece.stations.size()) - 1;
  // section by section: the last of a layer is the first of the next
  std::vector<std::vector<Vec3>> sections(piece.frames.size(), std::vector<Vec3>(5 * kLine * kLine));
  std::shared_ptr<const ImplicitSurface> part = around(0);
  for (std::size_t s = 0; s < piece.frames.size(); ++s) {
    if (s > 0 && (s - 1) % kBlockDegree == 0) {
      part = around(static_cast<int>(s - 1) / kBlockDegree);
    }
    for (int quad = 0; quad < 5; ++quad) {
      for (int at = 0; at < kLine * kLine; ++at) {
        sections[s][quad * kLine * kLine + at] =
            place_section_point(*part, piece.frames[s], quad, gauss[at % kLine], gauss[at / kLine]);
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

bool halve_rough_layers(const Branch& branch, const ImplicitSurface& surface, BranchPiece& piece) {
  std::vector<double> halved;
  for (int layer = 0; layer + 1 < static_cast<int>(piece.stations.size()); ++layer) {
    halved.push_back(piece.stations[layer]);
    if (is_rough(branch, surface, piece, layer)) {
      halved.push_back(0.5 * (piece.stations[layer] + piece.stations[layer + 1]));
    }
  }
  halved.push_back(piece.stations.back());
  const bool any = halved.size() > piece.stations.size();
  piece.stations = std::move(halved);
  return any;
}

void optimise_weak_layers(const Branch& branch, const ImplicitSurface& surface, const MeshDivision& mesh, double good,
                          BranchPiece& piece) {
  const int layers = static_cast<int>(piece.stations.size()) - 1;
  std::vector<char> weak(layers);
  for (int layer = 0; layer < layers; ++layer) {
    const BlockSolution judged = judge_blocks(nodes_of(piece, layer, layer), mesh);
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
    const BlockSolution after = improved(branch, surface, mesh, piece, from, to);
    std::copy(after.nodes.begin(), after.nodes.end(),
              piece.nodes.begin() + static_cast<std::ptrdiff_t>(5) * from * kBlockNodes);
    first = last;
  }
}

}  // namespace vasohex
