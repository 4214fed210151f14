#include "vasohex/blocks/optimise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "vasohex/blocks/polynomial_blocks.h"
#include "vasohex/blocks/preconditioner.h"
#include "vasohex/core/reference_hex.h"
#include "vasohex/quality/validity.h"

namespace vasohex {
namespace {

double dot(const Points& a, const Points& b) { return (a.array() * b.array()).sum(); }
double largest_row(const Points& a) { return std::sqrt(a.rowwise().squaredNorm().maxCoeff()); }

/// The last steps of L-BFGS and the changes of the gradient along them, oldest first.
class StepMemory {
 public:
  struct Step {
    Points move, change;
    double curvature = 0;  ///< move . change
    double alpha = 0;      ///< of the loop over the steps that is under way
  };

  bool empty() const { return count_ == 0; }
  void clear() { count_ = 0; }
  /// Takes the step from x to y in if it goes uphill in the gradient; null if not.
  const Step* add(const Points& x, const Points& y, const Points& gradient_x, const Points& gradient_y) {
    Step& s = step(count_);  // one slot more than steps: a step that is not taken leaves the others alone
    s.move = y - x;
    s.change = gradient_y - gradient_x;
    s.curvature = dot(s.move, s.change);
    if (!(s.curvature > 1e-14 * s.move.norm() * s.change.norm())) {
      return nullptr;
    }
    if (count_ == kMemory) {
      first_ = (first_ + 1) % kSlots;
    } else {
      ++count_;
    }
    return &s;
  }
  /// The loops before and after the initial Hessian's inverse is applied.
  void before(Points& p) {
    for (int i = count_; i-- > 0;) {
      Step& s = step(i);
      s.alpha = dot(s.move, p) / s.curvature;
      p -= s.alpha * s.change;
    }
  }
  void after(Points& p) {
    for (int i = 0; i < count_; ++i) {
      Step& s = step(i);
      p += (s.alpha - dot(s.change, p) / s.curvature) * s.move;
    }
  }

 private:
  static constexpr int kMemory = 10;
  static constexpr int kSlots = kMemory + 1;
  Step& step(int i) { return steps_[(first_ + i) % kSlots]; }

  std::array<Step, kSlots> steps_;
  int first_ = 0, count_ = 0;
};

/// L-BFGS with memory 10 [Nocedal & Wright, alg. 7.4] in the tangent space of the wall; every trial is retracted.
/// Stops when the energy falls by less than `tolerance` (relative) four times in a row. With `patience` > 0 it ends
/// at the iterate of the greatest least scaled Jacobian, which swings while the energy falls, and stops when that has
/// not risen by .002 for so many iterations.
void minimise(PolynomialBlocks& blocks, Preconditioner& preconditioner, const EnergyTerms& terms, int iterations,
              double tolerance, int patience) {
  const double longest_step = 0.15 * blocks.mean_length();
  // above degree 2 the blocks come from a lower degree and have not far to go
  const double first_step = (blocks.degree() == 2 ? 0.1 : 0.01) * blocks.mean_length();
  Points gradient, trial, trial_gradient, p, other;
  blocks.retract(blocks.x);
  Energy e = blocks.energy(blocks.x, terms, &gradient);
  StepMemory memory;
  Points best = blocks.x;
  double best_quality = e.quality(), mark = best_quality;
  double scale = 1;
  int stalls = 0, idle = 0;
  for (int done = 0; done < iterations; ++done) {
    other = -gradient;
    memory.before(other);
    preconditioner.apply(other, p);
    blocks.make_tangential(p);
    p *= memory.empty() ? first_step / std::max(1e-300, largest_row(p)) : scale;
    memory.after(p);
    const double slope = dot(gradient, p);
    if (!(slope < 0)) {
      if (memory.empty()) {
        break;
      }
      memory.clear();
      continue;
    }
    double step = std::min(1.0, longest_step / largest_row(p));
    const Points normals = blocks.normals();
    bool accepted = false;
    Energy next;
    for (int trials = 0; trials < 12 && !accepted; ++trials) {
      trial = blocks.x + step * p;
      blocks.retract(trial);
      next = blocks.energy(trial, terms, &trial_gradient);
      accepted = std::isfinite(next.value) && next.value < e.value + 1e-4 * step * slope;
      if (!accepted) {
        // to the least of the parabola through both values
        const double rise = next.value - e.value - step * slope;
        step *= std::isfinite(rise) ? std::clamp(-0.5 * step * slope / rise, 0.1, 0.5) : 0.1;
      }
    }
    if (!accepted) {
      blocks.set_normals(normals);
      if (memory.empty()) {
        break;
      }
      memory.clear();
      continue;
    }
    const StepMemory::Step* last = memory.add(blocks.x, trial, gradient, trial_gradient);
    if (last && (done <= 3 || done % 4 == 0)) {  // the scale changes slowly, and costs an application
      preconditioner.apply(last->change, other);
      blocks.make_tangential(other);
      scale = last->curvature / std::max(1e-300, dot(last->change, other));
    }
    stalls = e.value - next.value < tolerance * std::abs(e.value) ? stalls + 1 : 0;
    std::swap(blocks.x, trial);
    std::swap(gradient, trial_gradient);
    e = next;
    if (patience > 0) {
      if (e.quality() > best_quality) {
        best_quality = e.quality();
        best = blocks.x;
      }
      idle = e.quality() > mark + 0.002 ? 0 : idle + 1;
      mark = idle == 0 ? e.quality() : mark;
    }
    if (stalls > 3 || (patience > 0 && idle >= patience)) {
      break;
    }
  }
  if (patience > 0) {
    blocks.x = best;
  }
}

/// Epsilon of chi from the worst determinant: large while blocks are folded, small once they are not.
double epsilon_for(double min_det) {
  if (min_det > 0.05) {
    return 1e-3;
  }
  const double folded = std::min(0.0, min_det);
  const double epsilon = std::sqrt(1e-5 + 0.04 * folded * folded);
  return min_det <= 0 ? std::max(epsilon, 0.02) : epsilon;
}

class Optimiser {
 public:
  Optimiser(const BlockProblem& problem)
      : problem_(problem),
        topology_(build_topology(static_cast<int>(problem.vertices.size()), problem.blocks)),
        blocks_(problem, topology_, 2) {}

  /// Degree 2: the placed nodes, or those of 15 Laplace sweeps if their energy is lower. Returns the energy.
  double place() {
    blocks_.place();
    EnergyTerms terms;
    terms.tables = equispaced_tables(blocks_.nodes_1d(), 5);
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
    for (int repair = 0; repair < 2 && !solution.certified; ++repair) {
      stage(kBlockDegree, 9, 16, 25);
      BlockSolution next = judge();
      if (next.is_better_than(solution)) {
        solution = std::move(next);
      }
    }
    return solution;
  }

  /// Degree 4, from the nodes of a solution.
  BlockSolution fit_to_mesh(const std::vector<Vec3>& nodes, const SampleTables& tables) {
    blocks_ = PolynomialBlocks(problem_, topology_, kBlockDegree);
    blocks_.adopt_nodes(nodes);
    EnergyTerms terms;
    terms.tables = tables;
    terms.guard = equispaced_tables(blocks_.nodes_1d(), 7);
    const Energy now = measure(terms);
    terms.power = 16;
    terms.shape_weight = 0.01;
    terms.jacobian_weight = 1;
    terms.jacobian_goal = std::max(now.min_jacobian + 0.1, -0.5);
    minimise_here(terms, 40, 3e-4, 8);
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
  BlockSolution judge() {
    blocks_.land();
    return judge_blocks(blocks_.block_nodes(), problem_.mesh);
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

  double least_now(int samples) {
    EnergyTerms terms;
    terms.tables = equispaced_tables(blocks_.nodes_1d(), samples);
    return measure(terms).min_jacobian;
  }

  /// Degree 2, until det T > .02.
  void untangle(int rounds) {
    EnergyTerms terms;
    terms.tables = equispaced_tables(blocks_.nodes_1d(), 5);
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
  }

  /// Lifts the blocks to `degree`, unfolds what that folded, then raises the worst scaled Jacobians.
  void stage(int degree, int samples, int power, int iterations) {
    if (degree > blocks_.degree()) {
      blocks_ = blocks_.elevated(degree);
      preconditioner_.reset();
    }
    EnergyTerms terms;
    terms.tables = equispaced_tables(blocks_.nodes_1d(), samples);
    Energy now = measure(terms);
    for (int round = 0; round < 4 && now.min_det < 0.01; ++round) {
      terms.epsilon = std::sqrt(1e-4 + 0.04 * now.min_det * now.min_det);
      minimise_here(terms, 20, 3e-4);
      now = measure(terms);
    }
    const double folded = std::min(0.0, now.min_det);
    terms.epsilon = now.min_det > 0.01 ? 1e-3 : std::sqrt(1e-4 + 0.04 * folded * folded);
    terms.shape_weight = 0.02;
    terms.jacobian_weight = 1;
    terms.power = power;
    terms.jacobian_goal = std::min(0.75, std::max(now.min_jacobian + 0.1, -0.5));
    minimise_here(terms, iterations, 3e-4, degree == kBlockDegree ? 8 : 0);
  }

  const BlockProblem& problem_;
  BlockTopology topology_;
  PolynomialBlocks blocks_;
  std::optional<Preconditioner> preconditioner_;  ///< of the blocks' degree and target lengths, while they last
};

/// The kernel's view of blocks that share no nodes, [blocks][(degree + 1)^3].
kernel::DistortionOutput distortion_of(const std::vector<Vec3>& nodes, int degree, const SampleTables& tables,
                                       const std::vector<double>& inverse_length, double epsilon) {
  std::vector<int> ids(nodes.size());
  std::iota(ids.begin(), ids.end(), 0);
  kernel::DistortionInput in;
  in.degree = degree;
  in.samples = tables.samples;
  in.value = tables.value.data();
  in.slope = tables.slope.data();
  in.blocks = static_cast<int>(inverse_length.size()) / 3;
  in.ids = ids.data();
  in.nodes = nodes.data()->data();
  in.inverse_length = inverse_length.data();
  in.epsilon = epsilon;
  return kernel::distortion(in, nullptr);
}

/// The least scaled Jacobian at samples of blocks.
double least_at(const std::vector<Vec3>& nodes, const SampleTables& tables) {
  // scaled Jacobians do not depend on the scale, but the kernel's guard against zero lengths does
  std::vector<double> inverse_length;
  for (std::size_t first = 0; first < nodes.size(); first += kBlockNodes) {
    const double size = (nodes[first + kBlockNodes - 1] - nodes[first]).norm();
    inverse_length.insert(inverse_length.end(), 3, size > 0 ? 1 / size : 1.0);
  }
  return distortion_of(nodes, kBlockDegree, tables, inverse_length, 1e-3).min_jacobian;
}

std::vector<double> block_nodes_1d() { return family_nodes(NodeFamily::gauss_lobatto, kBlockDegree); }

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
  return distortion_of(nodes, kDegree, equispaced_tables(halves, 5), inverse_length, 0.1).energy;
}

double placed_energy(const BlockProblem& problem) { return Optimiser(problem).place(); }

double least_jacobian(const std::vector<Vec3>& nodes) { return least_at(nodes, equispaced_tables(block_nodes_1d(), 9)); }

BlockSolution judge_blocks(std::vector<Vec3> nodes, const MeshDivision& mesh) {
  BlockSolution s;
  const double of_blocks = least_jacobian(nodes);
  const auto tables = mesh_tables(block_nodes_1d(), mesh);
  s.min_jacobian = tables ? least_at(nodes, *tables) : of_blocks;
  s.certified = of_blocks > 0;
  if (s.certified) {
    std::vector<int> ids(nodes.size());
    std::iota(ids.begin(), ids.end(), 0);
    Run serial;
    serial.threads = 1;  // junctions are solved side by side
    for (const Validity& v : certify(kBlockDegree, NodeFamily::gauss_lobatto, nodes, ids, serial)) {
      s.certified = s.certified && v.state == ValidityState::certified;
    }
  }
  s.nodes = std::move(nodes);
  return s;
}

BlockSolution fit_to_mesh(const BlockProblem& problem, BlockSolution start) {
  const auto tables = mesh_tables(block_nodes_1d(), problem.mesh);
  if (!tables) {
    return start;
  }
  start.min_jacobian = least_at(start.nodes, *tables);
  if (!start.certified) {
    return start;
  }
  Optimiser optimiser(problem);
  BlockSolution fitted = optimiser.fit_to_mesh(start.nodes, *tables);
  for (double part = 0.5; part > 0.2 && !fitted.certified; part *= 0.5) {
    fitted = optimiser.judge_between(start.nodes, fitted.nodes, part);
  }
  return fitted.is_better_than(start) ? fitted : start;
}

BlockSolution optimise_blocks(const BlockProblem& problem) { return *Optimiser(problem).run(true); }

std::optional<BlockSolution> try_blocks(const BlockProblem& problem) { return Optimiser(problem).run(false); }

}  // namespace vasohex
