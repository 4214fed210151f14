// Compiled once per instruction set, VASOHEX_ISA names the namespace. The lanes of a vector are cones, as many as a
// register holds; what they contribute is added up in an order that does not depend on how many that is.

#include "vasohex/surface/cone_lanes_isa.h"

namespace vasohex::kernel::VASOHEX_ISA {
namespace {

#if defined(__AVX512F__)
constexpr int kLanes = 8;
#elif defined(__AVX__)
constexpr int kLanes = 4;
#else
constexpr int kLanes = 2;
#endif
typedef double Lanes __attribute__((vector_size(8 * kLanes)));
typedef long long Mask __attribute__((vector_size(8 * kLanes)));

inline Lanes all(double x) { return x - Lanes{}; }
inline Lanes load(const double* from) {
  Lanes lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
inline Lanes square_root(Lanes x) {
  for (int l = 0; l < kLanes; ++l) {
    x[l] = __builtin_sqrt(x[l]);
  }
  return x;
}
inline bool any(Mask m) {
  long long found = 0;
  for (int l = 0; l < kLanes; ++l) {
    found |= m[l];
  }
  return found != 0;
}

constexpr double kReach = 1.5, kReach2 = kReach * kReach;  // kernel_reach of cone_kernel.h

/// Pairs of mirrored Gauss-Legendre points on [0, 1]: exact for degree 7, which slope 0 needs 6 of.
constexpr double kNode[4] = {0.06943184420297371, 0.93056815579702629, 0.33000947820757187, 0.66999052179242813};
constexpr double kWeight[2] = {0.17392742256872693, 0.32607257743127307};

}  // namespace

bool add_cones(const ConeGroup& group, const double* x, GroupSum& sum) {
  double parts[5][kCones] = {};
  bool reached = false;
  for (int first = 0; first < kCones; first += kLanes) {
    const Lanes zero = all(0);
    const auto at = [&](const double* values) { return load(values + first); };
    Lanes w[3], direction[3];
    for (int d = 0; d < 3; ++d) {
      w[d] = x[d] - at(group.start[d]);
      direction[d] = at(group.direction[d]);
    }
    const Lanes length = at(group.length), radius = at(group.radius), slope = at(group.slope);
    const Lanes p = w[0] * direction[0] + w[1] * direction[1] + w[2] * direction[2];
    // v (S r)^2 = c0 + 2 c1 t + c2 t^2. Where it is positive with r > 0, |x - c(t)| - S r(t) < 0: convex in t, so one
    // interval, whatever the sign of c2.
    const Lanes c0 = kReach2 * radius * radius - (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    const Lanes c1 = kReach2 * radius * slope + p;
    const Lanes c2 = kReach2 * slope * slope - 1;
    const Lanes at_end = c0 + (2 * c1 + c2 * length) * length;
    const Mask starts_in = c0 > zero, ends_in = at_end > zero;
    const Mask inside = (c2 < zero) & (c1 > zero) & (c1 + c2 * length < zero);
    const Lanes discriminant = c1 * c1 - c0 * c2;
    Mask reaches = (starts_in & ends_in) | ((starts_in | ends_in | inside) & (discriminant > zero));
    if (!any(reaches)) {
      continue;
    }
    Lanes normal[3];
    for (int d = 0; d < 3; ++d) {
      normal[d] = at(group.end_normal[d]);
    }
    const Lanes inverse_fade = at(group.inverse_fade);
    Lanes beyond = (normal[0] * x[0] + normal[1] * x[1] + normal[2] * x[2] - at(group.end_offset)) * inverse_fade;
    reaches &= beyond < all(1);
    beyond = beyond > zero ? beyond : zero;
    const Lanes present = 1 - beyond * beyond * beyond * (10 + beyond * (6 * beyond - 15));
    const Lanes present_slope = -30 * beyond * beyond * (1 - beyond) * (1 - beyond) * inverse_fade;

    // half the slope of the quadratic where it enters or leaves
    const Lanes root = square_root(discriminant > zero ? discriminant : zero);
    Lanes from = (c1 > zero ? -c0 : root - c1) / (c1 > zero ? c1 + root : c2);
    Lanes to = (c1 < zero ? c0 : -(c1 + root)) / (c1 < zero ? root - c1 : c2);
    from = starts_in ? zero : from;
    to = ends_in ? length : to;
    const auto clamped = [&](Lanes t) {
      t = t < zero ? zero : t;
      return t > length ? length : t;
    };
    from = clamped(from);
    to = clamped(to);
    reaches &= to > from;
    if (!any(reaches)) {
      continue;
    }
    reached = true;
    from = reaches ? from : zero;
    const Lanes h = reaches ? to - from : zero;
    Lanes value = zero, mean = zero, whole = zero, along = zero;
    for (int k = 0; k < 4; ++k) {
      const Lanes t = from + h * kNode[k];
      const Lanes inverse = 1 / (radius + slope * t);
      const Lanes q = c0 + (2 * c1 + c2 * t) * t;
      const Lanes cube = q * inverse * inverse * inverse;
      const Lanes a = kWeight[k / 2] * cube * cube;  // / r: integrand of the gradient
      const Lanes b = a * q;                         // / r: that of F
      const Lanes c = a * inverse;
      value += b * inverse;
      mean += b;
      whole += c;
      along += c * t;
    }
    Lanes curvature[3];
    for (int d = 0; d < 3; ++d) {
      curvature[d] = at(group.curvature[d]);
    }
    const Lanes bend = 1 - (curvature[0] * w[0] + curvature[1] * w[1] + curvature[2] * w[2]);
    const Lanes step = at(group.scale) * h, scale = step * bend * present;
    const Lanes of_bend = step * present * value, of_fade = step * bend * present_slope * value;
    const auto keep = [&](int part, const Lanes& lanes) {
      __builtin_memcpy(parts[part] + first, &lanes, sizeof lanes);
    };
    keep(0, scale * value);
    keep(1, scale * mean);
    for (int d = 0; d < 3; ++d) {
      keep(2 + d, of_fade * normal[d] - 6 * scale * (whole * w[d] - along * direction[d]) - of_bend * curvature[d]);
    }
  }
  if (!reached) {
    return false;
  }
  double total[5];
  for (int part = 0; part < 5; ++part) {
    const double* s = parts[part];
    total[part] = ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
  }
  sum.value += total[0];
  sum.weighted_radius += total[1];
  for (int d = 0; d < 3; ++d) {
    sum.gradient[d] += total[2 + d];
  }
  return true;
}

}  // namespace vasohex::kernel::VASOHEX_ISA
