#include "vasohex/blocks/minimise.h"

#include <algorithm>
#include <array>
#include <cmath>

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

}  // namespace

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

}  // namespace vasohex
