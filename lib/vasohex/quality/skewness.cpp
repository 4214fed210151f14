#include "vasohex/quality/skewness.h"

#include <array>
#include <cmath>
#include <numbers>

#include "vasohex/core/reference_hex.h"
#include "vasohex/quality/element_loop.h"

namespace vasohex {

std::vector<double> skewness(int order, std::span<const Vec3> nodes, std::span<const int> elements, const Run& run) {
  const std::size_t count = checked_element_count(order, nodes, elements);
  const std::size_t per_element = nodes_per_hex(order);
  const std::array<int, 3> step{order, order * (order + 1), order * (order + 1) * (order + 1)};
  std::vector<double> result(count);
  for_elements(run, "skewness", count, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const int* ids = elements.data() + e * per_element;
      std::array<Vec3, 8> x;
      for (int c = 0; c < 8; ++c) {
        x[c] = nodes[ids[(c & 1) * step[0] + (c >> 1 & 1) * step[1] + (c >> 2) * step[2]]];
      }
      // |sine| of the angle's distance from 90 degrees: one arcsine per element
      double worst = 0;
      for (int f = 0; f < 6; ++f) {
        const std::array<int, 4> corners = hex_face(f);
        for (int c = 0; c < 4; ++c) {
          const Vec3 u = x[corners[c ^ 1]] - x[corners[c]], v = x[corners[c ^ 2]] - x[corners[c]];
          const double length = u.norm() * v.norm();
          const double cosine = std::abs(u.dot(v)) / length;
          worst = cosine <= 1 ? std::max(worst, cosine) : 1;  // not a number: no length, or not finite
        }
      }
      result[e] = std::asin(worst) * 2 / std::numbers::pi;
    }
  });
  return result;
}

}  // namespace vasohex
