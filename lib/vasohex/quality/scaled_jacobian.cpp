#include "vasohex/quality/scaled_jacobian.h"

#include <array>
#include <cmath>

#include "vasohex/core/node_family.h"
#include "vasohex/quality/element_loop.h"

namespace vasohex {

std::vector<double> scaled_jacobian_linear(int order, std::span<const Vec3> nodes, std::span<const int> elements,
                                           const Run& run) {
  const std::size_t count = checked_element_count(order, nodes, elements);
  const std::size_t per_element = nodes_per_hex(order);
  const std::array<int, 3> step{order, order * (order + 1), order * (order + 1) * (order + 1)};
  std::vector<double> result(count);
  for_elements(run, "scaled Jacobian", count, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const int* ids = elements.data() + e * per_element;
      double least = 1;
      bool finite = true;
      for (int c = 0; c < 8; ++c) {
        const int at = (c & 1) * step[0] + (c >> 1 & 1) * step[1] + (c >> 2) * step[2];
        std::array<Vec3, 3> edge;
        for (int d = 0; d < 3; ++d) {
          const bool end_of_edge = c >> d & 1;
          edge[d] = nodes[ids[end_of_edge ? at : at + step[d]]] - nodes[ids[end_of_edge ? at - step[d] : at]];
        }
        const double scale = edge[0].norm() * edge[1].norm() * edge[2].norm();
        finite = finite && std::isfinite(scale);
        least = std::min(least, edge[0].cross(edge[1]).dot(edge[2]) / std::max(scale, 1e-300));
      }
      result[e] = finite ? least : -1;
    }
  });
  return result;
}

std::vector<double> scaled_jacobian(int order, NodeFamily family, std::span<const Vec3> nodes,
                                    std::span<const int> elements, const Run& run) {
  const std::size_t count = checked_element_count(order, nodes, elements);
  const std::size_t per_element = nodes_per_hex(order);
  const std::vector<double> base = family_nodes(family, order);
  const std::vector<double> lattice = family_nodes(NodeFamily::equispaced, 2 * order);
  const std::vector<double> value = lagrange_values(base, lattice), slope = lagrange_derivatives(base, lattice);
  const kernel::JacobianKernel& kernel = kernel::jacobian_kernel();
  const std::size_t lanes = kernel.lanes;
  std::vector<double> result(count);
  const std::size_t grain = order <= 3 ? 64 * kernel::kMaxLanes : kernel::kMaxLanes;
  for_elements(run, "scaled Jacobian", count, grain, [&](std::size_t begin, std::size_t end) {
    KernelScratch scratch(kernel.scratch_bytes(order));
    for (std::size_t e = begin; e < end; e += lanes) {
      const std::size_t used = std::min(lanes, end - e);
      double least[kernel::kMaxLanes];
      kernel.least_scaled_jacobian(
          {order, static_cast<int>(used), nodes.data()->data(), elements.data() + e * per_element}, value.data(),
          slope.data(), scratch.get(), least);
      for (std::size_t l = 0; l < used; ++l) {
        result[e + l] = std::isnan(least[l]) ? -1 : least[l];
      }
    }
  });
  return result;
}

}  // namespace vasohex
