#pragma once
/// \file A cleaned, smoothed and resampled network: nodes (ends, junctions) and branches (smooth axes with radii).

#include <array>
#include <string>
#include <vector>

#include "vasohex/core/vec3.h"

namespace vasohex {

/// The axis of a vessel: samples along a C2 curve, dense enough that chords stand for the curve (spacing <= 0.5 r and
/// <= 0.25 / curvature).
struct Branch {
  std::array<int, 2> nodes{};  ///< where it starts and ends; equal for a loop
  std::vector<Vec3> points;    ///< [k >= 2], from nodes[0] to nodes[1], both included
  std::vector<double> radii;   ///< [k] > 0
  std::vector<Vec3> tangents;  ///< [k], unit, along the curve
  std::vector<double> arc;     ///< [k], arc length from the start, arc[0] = 0, increasing
  double length() const { return arc.back(); }
};

/// An end (degree 1), a junction (degree >= 2 branch ends) or the seam of a closed branch without junction (degree 2,
/// one branch that starts and ends here).
struct NetworkNode {
  Vec3 position = Vec3::Zero();
  double radius = 0;
  int degree = 0;     ///< number of branch ends here; a loop counts twice
  int point = -1;     ///< index of the point of the skeleton it stems from
  bool seam = false;  ///< of a closed branch: not a junction
  bool blind = false;  ///< an end where the vessel closes: wall all around, no cap
  std::string name;   ///< of an end: `inlet`, `outlet_1`, ... unique; empty for junctions and blind ends
};

struct Network {
  std::vector<NetworkNode> nodes;
  std::vector<Branch> branches;
  std::string units;
  std::vector<std::string> repairs;  ///< one line each: what was changed in the input, where, why
};

/// A point of a branch at arc length `s` (clamped to [0, length]): cubic Hermite between the samples.
struct AxisPoint {
  Vec3 position = Vec3::Zero();
  Vec3 tangent = Vec3::UnitZ();  ///< unit
  double radius = 0;
};
AxisPoint axis_point(const Branch& branch, double s);

/// Over the length of the branch.
double mean_radius(const Branch& branch);

/// One of the two ends of a branch.
struct BranchEnd {
  int branch = 0;
  int end = 0;  ///< 0: the branch starts here, 1: it ends here
};

/// The branch ends at each node of the network, in the order of the branches.
std::vector<std::vector<BranchEnd>> branch_ends(const Network& network);

}  // namespace vasohex
