#include "vasohex/blocks/samples.h"

namespace vasohex {

std::optional<SampleTables> mesh_tables(const std::vector<double>& nodes, const MeshDivision& mesh) {
  const int p = mesh.order, pieces = mesh.elements;
  // At order 1 both ends of a piece, with its difference quotient: the corners of the elements, where they are worst.
  // Above, as many samples as elements are measured at: fewer miss folds.
  const int of_piece = p == 1 ? 2 : 2 * p + 1;
  // With more samples the elements are so small that the stage loses more in the blocks than the mesh gains.
  if (p < 1 || p >= kBlockDegree || pieces < 1 || pieces * of_piece > kernel::kMostSamples) {
    return {};
  }
  const int n = static_cast<int>(nodes.size());
  const std::vector<double> own = family_nodes(NodeFamily::equispaced, p);
  const std::vector<double> at = family_nodes(NodeFamily::equispaced, of_piece - 1);
  const std::vector<double> own_values = lagrange_values(own, at), own_slopes = lagrange_derivatives(own, at);
  SampleTables tables;
  tables.samples = pieces * of_piece;
  for (int piece = 0; piece < pieces; ++piece) {
    std::vector<double> at_nodes;
    for (const double t : own) {
      at_nodes.push_back((piece + t) / pieces);
    }
    const std::vector<double> block_values = lagrange_values(nodes, at_nodes);
    for (int s = 0; s < of_piece; ++s) {
      for (int i = 0; i < n; ++i) {
        double value = 0, slope = 0;
        for (int k = 0; k <= p; ++k) {
          value += own_values[s * (p + 1) + k] * block_values[k * n + i];
          slope += pieces * own_slopes[s * (p + 1) + k] * block_values[k * n + i];
        }
        tables.value.push_back(value);
        tables.slope.push_back(slope);
      }
    }
  }
  return tables;
}

}  // namespace vasohex
