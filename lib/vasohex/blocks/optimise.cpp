#include "vasohex/blocks/optimise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "vasohex/blocks/minimise.h"
#include "vasohex/core/reference_hex.h"
#include "vasohex/quality/validity.h"

namespace vasohex {
namespace {

/// Epsilon of chi from the worst determinant: large while blocks are folded, small once they are not.
double epsilon_for(double min_det) {
  if (min_det > 0.05) {
    return 1e-3;
  }
  const double folded = std::min(0.0, min_det);
  const double epsilon = std::sqrt(1e-5 + 0.04 * folded * folded);
  return min_det <= 0 ? std::max(epsilon, 0.02) : epsilon;
}

/// The kernel's view of blocks that share no nodes, [blocks][(degree + 1)^3].
kernel::DistortionOutput distortion_of(const std::vector<Vec3>& nodes, int degree, const Samples& samples,
                                       const std::vector<double>& inverse_length, double epsilon) {
  std::vector<int> ids(nodes.size());
  std::iota(ids.begin(), ids.end(), 0);
  kernel::DistortionInput in;
  look_at(samples, in);
  in.degree = degree;
  in.blocks = static_cast<int>(inverse_length.size()) / 3;
  in.ids = ids.data();
  in.nodes = nodes.data()->data();
  in.inverse_length = inverse_length.data();
  in.epsilon = epsilon;
  return kernel::distortion(in, nullptr);
}

/// The least scaled Jacobian at samples of blocks, each with its allowance.
double least_at(const std::vector<Vec3>& nodes, const std::vector<Samples>& all) {
  // scaled Jacobians do not depend on the scale, but the kernel's guard against zero lengths does
  std::vector<double> inverse_length;
  for (std::size_t first = 0; first < nodes.size(); first += kBlockNodes) {
    const double size = (nodes[first + kBlockNodes - 1] - nodes[first]).norm();
    inverse_length.insert(inverse_length.end(), 3, size > 0 ? 1 / size : 1.0);
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Samples& samples : all) {
    least = std::min(
        least, distortion_of(nodes, kBlockDegree, samples, inverse_length, 1e-3).min_jacobian + samples.allowance);
  }
  return least;
}

std::vector<double> block_nodes_1d() { return family_nodes(NodeFamily::gauss_lobatto, kBlockDegree); }

/// Every block's certificate.
bool all_certified(const std::vector<Vec3>& nodes) {
  std::vector<int> ids(nodes.size());
  std::iota(ids.begin(), ids.end(), 0);
  Run serial;
  serial.threads = 1;  // junctions are solved side by side
  const std::vector<Validity> validity = certify(kBlockDegree, NodeFamily::gauss_lobatto, nodes, ids, serial);
  return std::all_of(validity.begin(), validity.end(),
                     [](const Validity& v) { return v.state == ValidityState::certified; });
}

/// Per direction of a block, to see a mesh whose wall is projected: fewer miss folds where the wall bends sharply.
constexpr int kMeshSamples = 16;

/// So many are enough to know that blocks are good: where they see kLooksGood, kMeshSamples see .012 less at most.
/// [measured on 231 results for junctions of 3 to 8 branches]
constexpr int kFewSamples = 8;
constexpr double kLooksGood = 0.75;

/// Solvers that take elements with straight sides, and visualisation, use the corners alone. With nothing to hold
/// them, these elements lose what the curved ones gain.
constexpr double kStraightAllowance = 0.1;
constexpr double kCoarseStraightAllowance = 0.2;  ///< where curved elements are large, straight ones are others
constexpr int kStraightElements = 4;              ///< of a block edge: with fewer they are bad however the blocks are

/// How much less than the scaled Jacobian of a coarse mesh that of its blocks may be.
constexpr double kGuardAllowance = 0.4;

/// Elements of the mesh differ from the blocks they are part of.
bool is_coarse(const MeshDivision& mesh) { return mesh_tables(block_nodes_1d(), mesh).has_value(); }

/// Scaled Jacobian above which blocks gain no more by moving. [measured: .75 leaves junctions of three at .78]
constexpr double kJacobianGoal = 0.85;
/// Tries that end below this are seldom mended, which takes as long as all the rest.
constexpr double kHardlyRepaired = -0.5;
/// Scaled Jacobians this much above the least are raised with it.
constexpr double kAimHigher = 0.1;

/// Of refining, each to gain kAimHigher at most.
constexpr int kMostRounds = 8;

/// How many samples blocks are judged by: at first, and before they are kept.
enum class Look { quick, close };

class Optimiser {
 public:
  Optimiser(const BlockProblem& problem)
      : problem_(problem),
        coarse_(is_coarse(problem.mesh)),
        topology_(build_topology(static_cast<int>(problem.vertices.size()), problem.blocks)),
        blocks_(problem, topology_, 2) {}

  /// Degree 2: the placed nodes, or those of 15 Laplace sweeps if their energy is lower. Returns the energy.
  double place() {
    blocks_.keep_sides(!problem_.may_change_sides);
    blocks_.place();
    EnergyTerms terms = at_blocks(5);
    terms.epsilon = 0.1;
    const Points placed = blocks_.x;
    const Energy start = measure(terms);
    if (start.min_det > 0.02) {
      return start.value;
    }
    blocks_.smooth(15);
    const double smoothed = measure(terms).value;
    if (smoothed < start.value) {
      return smoothed;
    }
    blocks_.x = placed;
    return start.value;
  }

  /// Nothing if the blocks are folded after a few rounds or nearly so after the first stage, and `patient` is false:
  /// that seldom ends well, and takes longest.
  std::optional<BlockSolution> run(bool patient) {
    place();
    untangle(patient ? 12 : 5);
    stage(2, 5, 8, 20);
    if (!patient && least_now(5) < 0.12) {
      return {};
    }
    stage(3, 5, 8, 20);
    stage(kBlockDegree, 7, 16, 40);
    BlockSolution solution = judge();
    const bool worth_repair = patient || solution.min_jacobian > kHardlyRepaired;
    for (int repair = 0; repair < 2 && !solution.certified && worth_repair; ++repair) {
      stage(kBlockDegree, 9, 16, 25);
      BlockSolution next = judge();
      if (next.is_better_than(solution)) {
        solution = std::move(next);
      }
    }
    return solution;
  }

  /// Degree 4, from the nodes of a solution: the least Jacobians of a mesh, its wall projected, are raised while that
  /// gains something.
  BlockSolution refine(const BlockSolution& start, double goal, bool quick) {
    adopt(start.nodes);
    BlockSolution solution = judge(Look::close);
    for (int round = 0; round < kMostRounds && solution.min_jacobian < goal; ++round) {
      raise_mesh(quick && round == 0 ? kFewSamples : kMeshSamples);
      BlockSolution next = judge(Look::close);
      const bool gains = next.min_jacobian > solution.min_jacobian + 0.01;
      if (next.is_better_than(solution)) {
        solution = std::move(next);
      }
      if (!gains) {
        break;
      }
    }
    return solution;
  }

  /// Degree 4, from the nodes of a solution: for the elements of problem.mesh. Aims kAimHigher than it starts.
  BlockSolution fit_to_mesh(const BlockSolution& start) {
    adopt(start.nodes);
    EnergyTerms terms;
    terms.samples = mesh_samples(blocks_.wall_shifts(), kMeshSamples);
    terms.samples.push_back(blocks_alone(7, kGuardAllowance));
    const Energy now = measure(terms);
    terms.power = 16;
    terms.shape_weight = 0.01;
    terms.jacobian_weight = 1;
    terms.jacobian_goal = std::max(now.min_jacobian + kAimHigher, -0.5);
    minimise_here(terms, 120, 3e-4, 24);
    return judge();
  }

  BlockSolution judge_as_is(const std::vector<Vec3>& nodes) {
    adopt(nodes);
    return judge();
  }

  /// Degree 4: part of the way from one solution to another.
  BlockSolution judge_between(const std::vector<Vec3>& from, const std::vector<Vec3>& to, double part) {
    std::vector<Vec3> nodes;
    for (std::size_t i = 0; i < from.size(); ++i) {
      nodes.push_back(from[i] + part * (to[i] - from[i]));
    }
    blocks_.adopt_nodes(nodes);
    return judge();
  }

 private:
  void adopt(const std::vector<Vec3>& nodes) {
    if (blocks_.degree() != kBlockDegree) {
      blocks_ = PolynomialBlocks(problem_, topology_, kBlockDegree);
    }
    blocks_.adopt_nodes(nodes);
  }

  Samples blocks_alone(int samples, double allowance = 0) const {
    return {equispaced_tables(blocks_.nodes_1d(), samples), {}, allowance};
  }

  EnergyTerms at_blocks(int samples) const {
    EnergyTerms terms;
    terms.samples = {blocks_alone(samples)};
    return terms;
  }

  /// Of a mesh whose wall is shifted: the elements of problem.mesh, or where these are as good as the blocks
  /// `samples` per direction; and its elements with straight sides, where those are others.
  std::vector<Samples> mesh_samples(const std::vector<Vec3>& shifts, int samples) const {
    const MeshDivision& mesh = problem_.mesh;
    std::vector<Samples> all{blocks_.projected(shifts, [&](const std::vector<double>& nodes) {
      return mesh_tables(nodes, mesh).value_or(equispaced_tables(nodes, samples));
    })};
    if (mesh.order != 1) {
      const MeshDivision straight{1, kStraightElements};
      all.push_back(
          blocks_.projected(shifts, [&](const std::vector<double>& nodes) { return *mesh_tables(nodes, straight); }));
      all.back().allowance = coarse_ ? kCoarseStraightAllowance : kStraightAllowance;
    }
    return all;
  }

  /// By the mesh that will be made of the blocks, its wall on the surface; and by the blocks, which may lean on that
  /// projection, but not much: where it is large it is known least.
  BlockSolution judge(Look look = Look::quick) {
    blocks_.land();
    BlockSolution s;
    s.nodes = blocks_.block_nodes();
    const double of_blocks = least_jacobian(s.nodes);
    const std::vector<Vec3> shifts = blocks_.wall_shifts();
    double of_mesh = least_at(s.nodes, mesh_samples(shifts, kFewSamples));
    if (look == Look::close && of_mesh < kLooksGood && !coarse_) {
      of_mesh = least_at(s.nodes, mesh_samples(shifts, kMeshSamples));
    }
    s.min_jacobian = std::min(of_mesh, of_blocks + (coarse_ ? kGuardAllowance : 0.1));
    s.certified = of_blocks > 0 && all_certified(s.nodes);
    return s;
  }

  /// Degree 4, from nodes on the wall: raises the least Jacobians of a mesh, its wall projected as it is now.
  void raise_mesh(int samples) {
    constexpr double kShapeWeight = 0.08;  // with less, edges whose parameter almost stops fold at order 2
    constexpr double kWallWeights = 16;    // the less the wall is projected, the longer the projection stays as it is
    EnergyTerms terms;
    terms.samples = mesh_samples(blocks_.wall_shifts(), samples);
    terms.wall_weight = kWallWeights * kWallWeight;
    raise_least(terms, measure(terms), kShapeWeight, 16, 60, 16);
  }

  Energy measure(const EnergyTerms& terms) {
    blocks_.retract(blocks_.x);
    return blocks_.energy(blocks_.x, terms, nullptr);
  }

  void minimise_here(const EnergyTerms& terms, int iterations, double tolerance, int patience = 0) {
    if (!preconditioner_) {
      preconditioner_.emplace(blocks_, problem_, topology_);
    }
    minimise(blocks_, *preconditioner_, terms, iterations, tolerance, patience);
  }

  void update_lengths() {
    blocks_.update_lengths();
    preconditioner_.reset();
  }

  double least_now(int samples) { return measure(at_blocks(samples)).min_jacobian; }

  /// Degree 2, until det T > .02.
  void untangle(int rounds) {
    EnergyTerms terms = at_blocks(5);
    for (int round = 0; round < rounds; ++round) {
      const double min_det = measure(terms).min_det;
      if (min_det > 0.02 && round >= 1) {
        break;
      }
      terms.epsilon = epsilon_for(min_det);
      if (round == 2 || round == 4 || round == 7) {
        update_lengths();
      }
      minimise_here(terms, 25, 1e-4);
    }
    update_lengths();
    blocks_.keep_sides(true);
  }

  /// Lifts the blocks to `degree`, unfolds what that folded, then raises the worst scaled Jacobians.
  void stage(int degree, int samples, int power, int iterations) {
    if (degree > blocks_.degree()) {
      blocks_ = blocks_.elevated(degree);
      preconditioner_.reset();
    }
    EnergyTerms terms = at_blocks(samples);
    Energy now = measure(terms);
    for (int round = 0; round < 4 && now.min_det < 0.01; ++round) {
      terms.epsilon = std::sqrt(1e-4 + 0.04 * now.min_det * now.min_det);
      minimise_here(terms, 20, 3e-4);
      now = measure(terms);
    }
    raise_least(terms, now, 0.02, power, iterations, degree == kBlockDegree ? 8 : 0);
  }

  /// Raises the worst scaled Jacobians, now as in `now`, at the samples of the terms.
  void raise_least(EnergyTerms& terms, const Energy& now, double shape_weight, int power, int iterations,
                   int patience) {
    const double folded = std::min(0.0, now.min_det);
    terms.epsilon = now.min_det > 0.01 ? 1e-3 : std::sqrt(1e-4 + 0.04 * folded * folded);
    terms.shape_weight = shape_weight;
    terms.jacobian_weight = 1;
    terms.power = power;
    terms.jacobian_goal = std::clamp(now.min_jacobian + kAimHigher, -0.5, kJacobianGoal);
    minimise_here(terms, iterations, 3e-4, patience);
  }

  const BlockProblem& problem_;
  bool coarse_;  ///< problem.mesh
  BlockTopology topology_;
  PolynomialBlocks blocks_;
  std::optional<Preconditioner> preconditioner_;  ///< of the blocks' degree and target lengths, while they last
};

}  // namespace

double straight_energy(const BlockProblem& problem) {
  constexpr int kDegree = 2;  // the least that the kernel knows
  const std::vector<double> halves = family_nodes(NodeFamily::gauss_lobatto, kDegree);
  std::vector<Vec3> nodes;
  std::vector<double> inverse_length;
  for (const std::array<int, 8>& block : problem.blocks) {
    for (int at = 0; at < 27; ++at) {
      nodes.push_back(trilinear(problem.vertices, block, {halves[at % 3], halves[at / 3 % 3], halves[at / 9]}));
    }
    for (int d = 0; d < 3; ++d) {
      double length = 0;
      for (int e = 4 * d; e < 4 * d + 4; ++e) {
        const auto [from, to] = hex_edge(e);
        length += 0.25 * (problem.vertices[block[to]] - problem.vertices[block[from]]).norm();
      }
      inverse_length.push_back(1 / length);
    }
  }
  return distortion_of(nodes, kDegree, {equispaced_tables(halves, 5), {}, 0}, inverse_length, 0.1).energy;
}

double placed_energy(const BlockProblem& problem) { return Optimiser(problem).place(); }

double least_jacobian(const std::vector<Vec3>& nodes) {
  return least_at(nodes, {{equispaced_tables(block_nodes_1d(), 9), {}, 0}});
}

BlockSolution judge_blocks(std::vector<Vec3> nodes, const MeshDivision& mesh) {
  BlockSolution s;
  const double of_blocks = least_jacobian(nodes);
  const auto tables = mesh_tables(block_nodes_1d(), mesh);
  s.min_jacobian = tables ? least_at(nodes, {{*tables, {}, 0}}) : of_blocks;
  s.certified = of_blocks > 0 && all_certified(nodes);
  s.nodes = std::move(nodes);
  return s;
}

BlockSolution fit_to_mesh(const BlockProblem& problem, BlockSolution start) {
  if (!is_coarse(problem.mesh)) {
    return start;
  }
  Optimiser optimiser(problem);
  start = optimiser.judge_as_is(start.nodes);
  if (!start.certified) {
    return start;
  }
  BlockSolution fitted = optimiser.fit_to_mesh(start);
  // the aim of a bad start is soon left behind
  for (double from = start.min_jacobian; fitted.certified && fitted.min_jacobian > from + kAimHigher;) {
    BlockSolution next = optimiser.fit_to_mesh(fitted);
    from = fitted.min_jacobian;
    if (next.is_better_than(fitted)) {
      fitted = std::move(next);
    }
  }
  for (double part = 0.5; part > 0.2 && !fitted.certified; part *= 0.5) {
    fitted = optimiser.judge_between(start.nodes, fitted.nodes, part);
  }
  return fitted.is_better_than(start) ? fitted : start;
}

BlockSolution refine_blocks(const BlockProblem& problem, BlockSolution start, double goal, bool quick) {
  if (!(start.min_jacobian > 0 && start.min_jacobian < kLooksGood)) {
    return start;
  }
  return Optimiser(problem).refine(start, goal, quick);
}

BlockSolution optimise_blocks(const BlockProblem& problem) { return *Optimiser(problem).run(true); }

std::optional<BlockSolution> try_blocks(const BlockProblem& problem) { return Optimiser(problem).run(false); }

}  // namespace vasohex
