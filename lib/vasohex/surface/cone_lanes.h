#pragma once
/// \file The inner loop of the convolution surface: several cones of one piece at a point at once. This header and
/// its source know neither Eigen nor the standard library, as those of energy_kernel.h and for the same reason.

namespace vasohex::kernel {

inline constexpr int kCones = 8;  ///< of a group

/// Cones of one piece (ConeSegment), side by side. Those not used have length 0 and radius 1.
struct ConeGroup {
  double start[3][kCones] = {}, direction[3][kCones] = {}, curvature[3][kCones] = {};
  double length[kCones] = {}, radius[kCones] = {}, slope[kCones] = {}, scale[kCones] = {};
  double end_normal[3][kCones] = {}, end_offset[kCones] = {};
  double inverse_fade[kCones] = {};  ///< 1 / end_fade; 0: no end near
  int piece = 0;
};

/// What a group contributes at a point.
struct GroupSum {
  double value = 0;            ///< F
  double weighted_radius = 0;  ///< the same integral with the integrand times r(t): / value = mean radius
  double gradient[3] = {};     ///< of F
};

/// Adds up the cones of the group at x; false where none reaches it. The same to the last bit for every instruction
/// set.
bool add_cones(const ConeGroup& group, const double* x, GroupSum& sum);

}  // namespace vasohex::kernel
