#include "vasohex/skeleton/loops.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <tuple>

#include "vasohex/core/short_text.h"

namespace vasohex {
namespace {

constexpr double kFilled = 1.1;  // times the radius: where tubes are nearer, the smooth surface has no hole
constexpr double kStep = 0.1;    // between samples, of the smallest radius
constexpr double kSearch = 20;   // radii that the way back may be longer than twice the branch
constexpr std::size_t kMostSamples = 4000;  // around a loop: a longer one is not looked at
constexpr std::size_t kSeams = 48;          // places where the two halves of a loop may meet

/// Lengths that differ by rounding alone become the same number.
std::int64_t quantised(double value, double unit) { return std::llround(value / unit * (1 << 20) + 0.3137); }

/// A straight piece of a tube.
struct Piece {
  Vec3 start, along;
  double length2, radius, growth;

  /// Parameter of the axis point next to p.
  double next_to(const Vec3& p) const { return std::clamp((p - start).dot(along) / length2, 0.0, 1.0); }
  bool has(const Vec3& p) const {
    const double u = next_to(p), r = kFilled * (radius + u * growth);
    return (p - start - u * along).squaredNorm() <= r * r;
  }
  /// How far a ball sticks out.
  double outside(const Vec3& p, double ball) const {
    const double u = next_to(p);
    return (p - start - u * along).norm() + ball - (radius + u * growth);
  }
};

void add_pieces(const Branch& branch, std::vector<Piece>& pieces) {
  for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
    const Vec3 along = branch.points[i + 1] - branch.points[i];
    if (along.squaredNorm() > 0) {
      pieces.push_back(
          {branch.points[i], along, along.squaredNorm(), branch.radii[i], branch.radii[i + 1] - branch.radii[i]});
    }
  }
}

/// The tubes of a loop and what they cover.
class Cover {
 public:
  explicit Cover(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {}

  bool has(const Vec3& p) {
    if (pieces_[last_].has(p)) {
      return true;  // as the sample before
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (pieces_[i].has(p)) {
        last_ = i;
        return true;
      }
    }
    return false;
  }

  /// A straight line between two axis points.
  bool has(const Vec3& a, const Vec3& b, double step) {
    if (!has((a + b) / 2)) {
      return false;
    }
    const int n = static_cast<int>(std::ceil((b - a).norm() / step));
    for (int i = 1; i < n; ++i) {
      if (!has(a + (b - a) * (static_cast<double>(i) / n))) {
        return false;
      }
    }
    return true;
  }

 private:
  std::vector<Piece> pieces_;
  std::size_t last_ = 0;
};

/// A cycle of a network.
struct Cycle {
  std::vector<int> branches;  // in order, from nodes[k] to nodes[k + 1]
  std::vector<int> nodes;     // as many
  double length = 0;
};

/// Points around a cycle at equal distances, about `step`; their number is even.
std::vector<Vec3> points_around(const Network& network, const Cycle& cycle, double step) {
  std::vector<Vec3> corners;
  std::vector<double> at;
  double before = 0;
  for (std::size_t k = 0; k < cycle.branches.size(); ++k) {
    const Branch& b = network.branches[cycle.branches[k]];
    const bool forward = b.nodes[0] == cycle.nodes[k];
    for (std::size_t i = k == 0 ? 0 : 1; i < b.points.size(); ++i) {
      const std::size_t j = forward ? i : b.points.size() - 1 - i;
      corners.push_back(b.points[j]);
      at.push_back(before + (forward ? b.arc[j] : b.length() - b.arc[j]));
    }
    before += b.length();
  }
  const std::size_t n = 2 * std::max<std::size_t>(12, static_cast<std::size_t>(std::ceil(cycle.length / step / 2)));
  std::vector<Vec3> points;
  for (std::size_t i = 0, k = 0; i < n; ++i) {
    const double s = cycle.length * static_cast<double>(i) / static_cast<double>(n);
    while (k + 2 < at.size() && at[k + 1] < s) {
      ++k;
    }
    const double u = std::clamp((s - at[k]) / (at[k + 1] - at[k]), 0.0, 1.0);
    points.push_back((1 - u) * corners[k] + u * corners[k + 1]);
  }
  return points;
}

/// Whether a surface bounded by the cycle lies within its tubes. Two kinds are tried: the lines from the middle to
/// the cycle, and the lines between its two halves, which serve long and narrow cycles, with a seam at many places.
bool is_filled(const Network& network, const Cycle& cycle) {
  std::vector<Piece> pieces;
  double smallest = std::numeric_limits<double>::infinity();
  for (const int b : cycle.branches) {
    const Branch& branch = network.branches[b];
    add_pieces(branch, pieces);
    smallest = std::min(smallest, *std::min_element(branch.radii.begin(), branch.radii.end()));
  }
  const double step = kStep * smallest;
  if (pieces.empty() || cycle.length > step * static_cast<double>(kMostSamples)) {
    return false;
  }
  const std::vector<Vec3> around = points_around(network, cycle, step);
  const std::size_t n = around.size();
  Cover cover(std::move(pieces));

  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : around) {
    middle += p / static_cast<double>(n);
  }
  if (cover.has(middle) &&
      std::all_of(around.begin(), around.end(), [&](const Vec3& p) { return cover.has(middle, p, step); })) {
    return true;
  }

  std::vector<std::size_t> seams;
  double before = 0;
  for (const int b : cycle.branches) {
    const double length = network.branches[b].length();
    for (const double s : {before, before + length / 2}) {
      seams.push_back(static_cast<std::size_t>(std::llround(s / cycle.length * static_cast<double>(n) + 1e-6)) % n);
    }
    before += length;
  }
  for (std::size_t i = 0; i < kSeams; ++i) {
    seams.push_back(i * n / (2 * kSeams));
  }
  const std::size_t half = n / 2;
  return std::any_of(seams.begin(), seams.end(), [&](std::size_t seam) {
    for (std::size_t i = 0; i < half; ++i) {
      const std::size_t k = (i + half / 2) % half;  // from the middle on, where a hole is widest
      if (k > 0 && !cover.has(around[(seam + k) % n], around[(seam + n - k) % n], step)) {
        return false;
      }
    }
    return true;
  });
}

/// Searches cycles; lengths are compared as integers, so that rounding decides nothing.
class Search {
 public:
  explicit Search(const Network& network) : network_(network), ends_(branch_ends(network)) {
    for (const Branch& b : network.branches) {
      unit_ += mean_radius(b) / static_cast<double>(network.branches.size());
    }
    for (const Branch& b : network.branches) {
      lengths_.push_back(quantised(b.length(), unit_));
    }
  }

  double unit() const { return unit_; }
  const std::vector<std::vector<BranchEnd>>& ends() const { return ends_; }

  /// The branch and the shortest way back without it; no branches if there is none of a length that matters.
  Cycle through(int branch) const {
    const auto [from, to] = network_.branches[branch].nodes;
    Cycle cycle;
    if (from == to) {
      return {{branch}, {from}, network_.branches[branch].length()};
    }
    if (ends_[from].size() < 2 || ends_[to].size() < 2) {
      return cycle;
    }
    const std::int64_t bound =
        2 * lengths_[branch] +
        quantised(kSearch * std::max(network_.nodes[from].radius, network_.nodes[to].radius), unit_);
    std::map<int, int> by;  // node: branch it was reached by
    using Entry = std::tuple<std::int64_t, int, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    open.push({0, to, -1});
    while (!open.empty() && !by.contains(from)) {
      const auto [distance, node, last] = open.top();
      open.pop();
      if (!by.emplace(node, last).second) {
        continue;
      }
      for (const BranchEnd& end : ends_[node]) {
        const int next = network_.branches[end.branch].nodes[1 - end.end];
        const std::int64_t there = distance + lengths_[end.branch];
        if (end.branch != branch && there <= bound && !by.contains(next)) {
          open.push({there, next, end.branch});
        }
      }
    }
    if (!by.contains(from)) {
      return cycle;
    }
    for (int node = from; node != to;) {  // from `from` back to `to`, then along the branch
      const int b = by[node];
      cycle.branches.push_back(b);
      cycle.nodes.push_back(node);
      cycle.length += network_.branches[b].length();
      const std::array<int, 2>& nodes = network_.branches[b].nodes;
      node = nodes[0] == node ? nodes[1] : nodes[0];
    }
    cycle.branches.push_back(branch);
    cycle.nodes.push_back(to);
    cycle.length += network_.branches[branch].length();
    return cycle;
  }

  /// How much the lumen changes without a branch of the cycle: what of it the others do not cover, and the bends that
  /// remain where it leaves two branches behind.
  double change_without(const Cycle& cycle, int branch) const {
    std::set<int> others(cycle.branches.begin(), cycle.branches.end());
    for (const int node : cycle.nodes) {
      for (const BranchEnd& end : ends_[node]) {
        others.insert(end.branch);
      }
    }
    others.erase(branch);
    std::vector<Piece> pieces;
    for (const int b : others) {
      add_pieces(network_.branches[b], pieces);
    }
    const Branch& own = network_.branches[branch];
    double sum = 0;
    for (std::size_t i = 0; i < own.points.size(); ++i) {
      double outside = own.radii[i];
      for (const Piece& piece : pieces) {
        outside = std::min(outside, piece.outside(own.points[i], own.radii[i]));
      }
      const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, own.arc.size() - 1);
      sum += std::max(outside, 0.0) * own.radii[i] * (own.arc[after] - own.arc[before]) / 2;
    }
    for (const int node : {own.nodes[0], own.nodes[1]}) {
      std::vector<Vec3> away;
      for (const BranchEnd& end : ends_[node]) {
        const Branch& b = network_.branches[end.branch];
        if (end.branch != branch) {
          away.push_back(end.end == 0 ? b.tangents.front() : (-b.tangents.back()).eval());
        }
      }
      if (away.size() == 2) {
        sum += 0.5 * (1 + away[0].dot(away[1])) * std::pow(network_.nodes[node].radius, 3);
      }
    }
    return sum;
  }

 private:
  const Network& network_;
  std::vector<std::vector<BranchEnd>> ends_;
  std::vector<std::int64_t> lengths_;
  double unit_ = 0;
};

std::string description(const Network& network, const Cycle& cycle, int leave_out) {
  const auto place = [&](int node) {
    return "point " + std::to_string(network.nodes[node].point) + " " + short_text(network.nodes[node].position);
  };
  double radius = 0;
  std::string points;
  for (std::size_t k = 0; k < cycle.branches.size(); ++k) {
    const Branch& b = network.branches[cycle.branches[k]];
    radius += mean_radius(b) * b.length() / cycle.length;
    points += (k == 0 ? "" : ", ") + std::to_string(network.nodes[cycle.nodes[k]].point);
  }
  const Branch& out = network.branches[leave_out];
  const std::size_t count = cycle.branches.size();
  return "the loop of " + std::to_string(count) + (count == 1 ? " branch" : " branches") + " through " +
         (count == 1 ? "point " : "points ") + points + ", length " + short_text(cycle.length) + ", radius " +
         short_text(radius) + ", is filled by its own tubes: the branch from " + place(out.nodes[0]) + " to " +
         place(out.nodes[1]) + ", length " + short_text(out.length()) + ", radius " + short_text(mean_radius(out)) +
         ", dropped";
}

}  // namespace

std::vector<FilledLoop> filled_loops(const Network& network) {
  const Search search(network);
  std::map<std::vector<int>, Cycle> cycles;  // by their branches, ascending
  for (int b = 0; b < static_cast<int>(network.branches.size()); ++b) {
    Cycle cycle = search.through(b);
    if (!cycle.branches.empty()) {
      std::vector<int> key = cycle.branches;
      std::sort(key.begin(), key.end());
      cycles.emplace(std::move(key), std::move(cycle));
    }
  }
  std::vector<const Cycle*> filled;
  for (const auto& [key, cycle] : cycles) {
    if (is_filled(network, cycle)) {
      filled.push_back(&cycle);
    }
  }
  std::stable_sort(filled.begin(), filled.end(), [&](const Cycle* a, const Cycle* b) {
    return quantised(a->length, search.unit()) < quantised(b->length, search.unit());
  });
  std::vector<FilledLoop> loops;
  std::set<int> touched;
  for (const Cycle* cycle : filled) {
    if (std::any_of(cycle->nodes.begin(), cycle->nodes.end(), [&](int n) { return touched.contains(n); })) {
      continue;  // without the other loop's branch it may be another one
    }
    touched.insert(cycle->nodes.begin(), cycle->nodes.end());
    std::tuple<std::int64_t, std::int64_t, int> least{std::numeric_limits<std::int64_t>::max(), 0, -1};
    const double volume = std::pow(search.unit(), 3);
    for (const int b : cycle->branches) {
      const Branch& branch = network.branches[b];
      least = std::min(least, {quantised(search.change_without(*cycle, b), volume),
                               quantised(mean_radius(branch), search.unit()), b});
    }
    const int out = std::get<2>(least);
    loops.push_back({cycle->branches, out, description(network, *cycle, out)});
  }
  return loops;
}

}  // namespace vasohex
