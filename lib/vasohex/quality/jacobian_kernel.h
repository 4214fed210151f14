#pragma once
/// \file Internal to quality/: the inner loops over elements, several elements at a time. This header and its source
/// use nothing of Eigen or the standard library: the source is compiled once per instruction set, and an inline
/// function of a header, compiled for a newer processor, must not leak into the rest. Every version gives the same
/// bits.

namespace vasohex::kernel {

inline constexpr int kMaxOrder = 9;
inline constexpr int kMaxLanes = 8;

/// Up to `lanes` elements of one order; nodes of element e at 3 * elements[e * (order + 1)^3 + ..] in `nodes`.
struct ElementGroup {
  int order;
  int count;  ///< 1 .. lanes
  const double* nodes;
  const int* elements;
};

/// How coordinates become Bernstein control points.
struct BernsteinMatrix {
  const double* high;    ///< [order + 1][order + 1], as a sum of two doubles
  const double* low;     ///< the same shape
  double point_error;    ///< bound of the error of a control point, over the element's extent
  double product_error;  ///< bound of the rounding of det J and its subdivision, over |J1||J2||J3|
};

/// Per element, of det J scaled by one positive constant per element. All are NaN if a coordinate is not finite.
struct DeterminantSummary {
  double least[kMaxLanes];      ///< least Bernstein coefficient
  double corner[kMaxLanes];     ///< least value at the 8 corners
  double mean[kMaxLanes];       ///< mean over the element, volume / 1
  double allowance[kMaxLanes];  ///< bound of the error of every coefficient
};

struct JacobianKernel {
  int lanes;
  /// Bytes of scratch memory, aligned to 64, that the two functions below need.
  unsigned long (*scratch_bytes)(int order);
  /// Bernstein coefficients of det J, degree 3 * order - 1 per direction: the first (3 * order)^3 * lanes doubles of
  /// scratch, i fastest, lanes innermost.
  void (*determinant)(const ElementGroup& group, const BernsteinMatrix& matrix, void* scratch,
                      DeterminantSummary& out);
  /// Least det J / (|J1||J2||J3|) over the lattice of points^3; value and slope: [points][order + 1] Lagrange
  /// polynomials, points = 2 * order + 1. NaN if a coordinate is not finite.
  void (*least_scaled_jacobian)(const ElementGroup& group, const double* value, const double* slope, void* scratch,
                                double out[kMaxLanes]);
};

/// The best for this processor.
const JacobianKernel& jacobian_kernel();

}  // namespace vasohex::kernel
