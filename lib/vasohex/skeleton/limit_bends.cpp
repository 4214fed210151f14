#include "vasohex/skeleton/limit_bends.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace vasohex {
namespace {

constexpr double kTooSharp = 0.95;  // curvature times radius from which a curve is looked after,
constexpr double kSharp = 0.9;      // then none is left above this,
constexpr double kAimedAt = 0.86;   // for which this is aimed at
constexpr double kSpacing = 0.25;   // of the beads, in radii
constexpr double kFarthest = 4;     // displacement at most, in radii
constexpr double kSmoothedOver = 0.3;  // in radii, at the end
constexpr int kSmoothedBeside = 3;     // beads that did not move, on each side
constexpr int kPasses = 3;  // points come nearer to each other, and with them their radii
constexpr int kSweeps = 5000;
constexpr int kSweepsBetweenThinning = 20;

/// A point of the curve that moves.
struct Bead {
  Vec3 position, origin;
  double place = 0;  ///< knots of the original curve passed so far
  double radius = 0;
  double moved = 0;  ///< farthest from the origin, in radii, of this one and of beads that became one with it
  bool fixed = false;
};

struct String {
  std::vector<Bead> beads;
  bool closed = false;

  int count() const { return static_cast<int>(beads.size()); }
  bool is_inside(int j) const { return closed || (j > 0 && j + 1 < count()); }
  Bead& at(int j) { return beads[(j + count()) % count()]; }
  const Bead& at(int j) const { return beads[(j + count()) % count()]; }
  /// Curvature times radius at a bead.
  double bend(int j) const {
    if (!is_inside(j)) {
      return 0;
    }
    const Vec3 a = at(j).position - at(j - 1).position, b = at(j + 1).position - at(j).position;
    return 2 * angle_between(a, b) / (a.norm() + b.norm()) * at(j).radius;
  }
};

/// Largest curvature times radius, at nine places of each piece.
double sharpest(const SpaceSpline& curve, const std::vector<double>& radii) {
  constexpr int steps = 8;
  double largest = 0;
  for (std::size_t k = 0; k + 1 < curve.t.size(); ++k) {
    for (int i = 0; i <= steps; ++i) {
      const double u = static_cast<double>(i) / steps;
      const double radius = (1 - u) * radii[k] + u * radii[k + 1];
      largest = std::max(largest, radius * curvature(curve.at(k, curve.t[k] + u * (curve.t[k + 1] - curve.t[k]))));
    }
  }
  return largest;
}

String beads_along(const SpaceSpline& curve, const std::vector<double>& radii, const std::vector<bool>& fixed,
                   bool closed) {
  String string;
  string.closed = closed;
  const auto add = [&](std::size_t k, double u) {
    Bead bead;
    bead.position = u == 0 ? curve.points[k] : curve.at(k, curve.t[k] + u * (curve.t[k + 1] - curve.t[k])).position;
    bead.origin = bead.position;
    bead.place = static_cast<double>(k) + u;
    bead.radius = u == 0 ? radii[k] : (1 - u) * radii[k] + u * radii[k + 1];
    bead.fixed = u == 0 && fixed[k];
    string.beads.push_back(bead);
  };
  const std::size_t pieces = curve.t.size() - 1;
  for (std::size_t k = 0; k < pieces; ++k) {
    const double spacing = kSpacing * std::min(radii[k], radii[k + 1]);
    const int count = std::max(1, static_cast<int>(std::ceil((curve.t[k + 1] - curve.t[k]) / spacing * (1 - 1e-9))));
    for (int i = 0; i < count; ++i) {
      add(k, static_cast<double>(i) / count);
    }
  }
  if (!closed) {
    add(pieces, 0);
  }
  return string;
}

/// Beads that came too near to their neighbours become one with them.
void thin(String& string) {
  std::vector<Bead> kept;
  for (const Bead& bead : string.beads) {
    const bool near =
        !kept.empty() && (bead.position - kept.back().position).norm() < 0.4 * kSpacing * kept.back().radius;
    if (!near || (bead.fixed && kept.back().fixed)) {
      kept.push_back(bead);
      continue;
    }
    const double moved = std::max(bead.moved, kept.back().moved);
    if (bead.fixed) {
      kept.back() = bead;
    }
    kept.back().moved = moved;
  }
  if (!string.closed && kept.size() > 1) {  // the ends are fixed in any case
    kept.back() = string.beads.back();
  }
  string.beads = std::move(kept);
}

/// Beads at bends that are too sharp move towards the middle of their neighbours; the neighbours of fixed ones the
/// other way. Stops when no bend is too sharp.
void relax(String& string) {
  for (int sweep = 0; sweep < kSweeps;) {
    std::vector<int> candidates(string.beads.size());
    for (int j = 0; j < string.count(); ++j) {
      candidates[j] = j;
    }
    bool settled = true;
    for (int i = 0; i < kSweepsBetweenThinning && !candidates.empty(); ++i, ++sweep) {
      std::vector<std::pair<int, Vec3>> moves;
      for (const int j : candidates) {
        const double bend = string.bend(j);
        settled &= bend < kSharp;
        if (bend <= kAimedAt) {
          continue;
        }
        const Vec3 middle = (string.at(j - 1).position + string.at(j + 1).position) / 2;
        const Vec3 move = 0.5 * (1 - kAimedAt / bend) * (middle - string.at(j).position);
        if (!string.at(j).fixed) {
          moves.emplace_back(j, move);
          continue;
        }
        for (const int k : {j - 1, j + 1}) {
          if (!string.at(k).fixed) {
            moves.emplace_back((k + string.count()) % string.count(), -move);
          }
        }
      }
      candidates.clear();
      for (const auto& [j, move] : moves) {
        Bead& bead = string.beads[j];
        bead.position += move;
        bead.moved = std::max(bead.moved, (bead.position - bead.origin).norm() / bead.radius);
        for (int k = j - 2; k <= j + 2; ++k) {
          if (string.closed || (k >= 0 && k < string.count())) {
            candidates.push_back((k + string.count()) % string.count());
          }
        }
      }
      std::sort(candidates.begin(), candidates.end());
      candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    }
    thin(string);
    if (settled) {
      return;
    }
  }
}

/// Lengths along the string.
struct Lengths {
  std::vector<double> beads;  ///< [beads] up to each; of a closed string the whole length too
  std::vector<double> knots;  ///< [knots] up to those of the curve that was
};

Lengths lengths_of(const String& string, std::size_t knots) {
  Lengths lengths{{0}, {}};
  for (int j = 0; j + 1 < string.count() + (string.closed ? 1 : 0); ++j) {
    lengths.beads.push_back(lengths.beads.back() + (string.at(j + 1).position - string.at(j).position).norm());
  }
  std::size_t j = 0;  // of the bead at a knot or before it
  const auto place = [&](std::size_t bead) {
    return bead < string.beads.size() ? string.beads[bead].place : static_cast<double>(knots - 1);
  };
  for (std::size_t k = 0; k < knots; ++k) {
    while (j + 2 < lengths.beads.size() && place(j + 1) <= static_cast<double>(k)) {
      ++j;
    }
    const double u = (static_cast<double>(k) - place(j)) / (place(j + 1) - place(j));
    lengths.knots.push_back(u <= 0   ? lengths.beads[j]
                            : u >= 1 ? lengths.beads[j + 1]
                                     : (1 - u) * lengths.beads[j] + u * lengths.beads[j + 1]);
  }
  return lengths;
}

/// Radii as they are between the knots, wherever those are by now.
void set_radii(String& string, const std::vector<double>& radii) {
  const Lengths lengths = lengths_of(string, radii.size());
  std::size_t k = 0;
  for (int j = 0; j < string.count(); ++j) {
    while (k + 2 < radii.size() && lengths.knots[k + 1] <= lengths.beads[j]) {
      ++k;
    }
    const double u = (lengths.beads[j] - lengths.knots[k]) / (lengths.knots[k + 1] - lengths.knots[k]);
    string.beads[j].radius = (1 - u) * radii[k] + u * radii[k + 1];
  }
}

/// A run of beads that moved.
struct MovedRun {
  double first = 0, last = 0;  ///< places
  LimitedBends::Bend bend;
};

std::vector<MovedRun> runs_of(const String& string, std::size_t knots) {
  std::vector<MovedRun> runs;
  bool open = false;
  for (const Bead& bead : string.beads) {
    if (bead.moved <= 1e-6) {
      open = false;
      continue;
    }
    if (!open) {
      runs.push_back({bead.place, bead.place, {}});
      open = true;
    }
    MovedRun& run = runs.back();
    run.last = bead.place;
    if (bead.moved > run.bend.moved) {
      run.bend = {std::min(static_cast<std::size_t>(std::lround(bead.place)), knots - 1), bead.moved};
    }
  }
  return runs;
}

/// The string along a curve, relaxed; and its runs that moved.
struct Relaxed {
  String string;
  std::vector<MovedRun> runs;
};

Relaxed relaxed(const SpaceSpline& curve, const std::vector<double>& radii, const std::vector<bool>& fixed,
                bool closed) {
  const String before = beads_along(curve, radii, fixed, closed);
  std::vector<MovedRun> left;
  for (;;) {
    Relaxed result{before, {}};
    for (Bead& bead : result.string.beads) {
      bead.fixed |= std::any_of(left.begin(), left.end(), [&](const MovedRun& run) {
        return run.first - 1e-9 < bead.place && bead.place < run.last + 1e-9;
      });
    }
    for (int pass = 0; pass < kPasses; ++pass) {
      relax(result.string);
      set_radii(result.string, radii);
    }
    result.runs = runs_of(result.string, curve.t.size());
    // beads that became one have forgotten where they came from
    for (MovedRun& run : result.runs) {
      for (const Bead& old : before.beads) {
        if (old.place < run.first || old.place > run.last) {
          continue;
        }
        double nearest = std::numeric_limits<double>::infinity();
        for (const Bead& now : result.string.beads) {
          nearest = std::min(nearest, (now.position - old.position).norm());
        }
        if (nearest > run.bend.moved * old.radius) {
          run.bend = {std::min(static_cast<std::size_t>(std::lround(old.place)), curve.t.size() - 1),
                      nearest / old.radius};
        }
      }
    }
    const auto too_far = [](const MovedRun& run) { return run.bend.moved > kFarthest; };
    if (std::none_of(result.runs.begin(), result.runs.end(), too_far)) {
      return result;
    }
    std::copy_if(result.runs.begin(), result.runs.end(), std::back_inserter(left), too_far);
  }
}

}  // namespace

LimitedBends limit_bends(const SpaceSpline& curve, const std::vector<double>& radii, const std::vector<bool>& fixed,
                         bool closed) {
  LimitedBends result{curve, curve.t, {}};
  if (sharpest(curve, radii) <= kTooSharp) {
    return result;
  }
  const auto [string, runs] = relaxed(curve, radii, fixed, closed);
  const int n = string.count();
  const Lengths lengths = lengths_of(string, curve.t.size());
  KnotData data{lengths.beads, Eigen::MatrixXd(n, 3), closed};
  for (int j = 0; j < n; ++j) {
    data.values.row(j) = string.beads[j].position.transpose();
  }
  // Beads that moved lie on the curve to some per cent of a radius; so do as many as `beside` them on each side
  const auto curve_along = [&](int beside) {
    std::vector<double> compliance(n, 0.0);
    for (int j = 0; j < n; ++j) {
      bool moved = false;
      for (int k = j - beside; k <= j + beside; ++k) {
        moved |= (closed || (k >= 0 && k < n)) && string.at(k + n).moved > 0;
      }
      const Bead& bead = string.beads[j];
      compliance[j] = bead.fixed || !moved ? 0 : std::pow(kSmoothedOver * bead.radius, 3);
    }
    return spline_through(data, smooth(data, compliance));
  };
  result.spline = curve_along(0);
  std::vector<double> bead_radii;
  for (int j = 0; j < n + (closed ? 1 : 0); ++j) {
    bead_radii.push_back(string.at(j).radius);
  }
  if (sharpest(result.spline, bead_radii) > 1) {
    result.spline = curve_along(kSmoothedBeside);  // it may bend sharply where it leaves the last one that moved
  }
  for (int j = 0; j < n; ++j) {
    if (string.beads[j].fixed) {
      result.spline.points[j] = string.beads[j].position;  // to the last bit
    }
  }
  result.t = lengths.knots;
  for (const MovedRun& run : runs) {
    result.rounded.push_back(run.bend);
  }
  return result;
}

void limit_bends(std::vector<Vec3>& points, std::vector<double>& radii) {
  SpaceSpline line{{0}, points, std::vector<Vec3>(points.size(), Vec3::Zero())};
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    line.t.push_back(line.t.back() + (points[i + 1] - points[i]).norm());
  }
  std::vector<bool> fixed(points.size(), false);
  fixed.front() = fixed.back() = true;
  const Relaxed result = relaxed(line, radii, fixed, false);
  points.clear();
  radii.clear();
  for (const Bead& bead : result.string.beads) {
    points.push_back(bead.position);
    radii.push_back(bead.radius);
  }
}

}  // namespace vasohex
