#pragma once
/// \file Internal to blocks/: the places at which the energy looks at blocks, or at a mesh made of them.

#include <optional>
#include <vector>

#include "vasohex/blocks/energy_kernel.h"
#include "vasohex/blocks/optimise.h"
#include "vasohex/core/node_family.h"

namespace vasohex {

/// Values and derivatives of the Lagrange polynomials at the samples of the energy.
struct SampleTables {
  int samples = 0;
  std::vector<double> value, slope;
};

inline SampleTables equispaced_tables(const std::vector<double>& nodes, int samples) {
  const std::vector<double> at = family_nodes(NodeFamily::equispaced, samples - 1);
  return {samples, lagrange_values(nodes, at), lagrange_derivatives(nodes, at)};
}

/// The same for the elements of a mesh that interpolates the blocks: each piece's own samples, as many as its order
/// needs to see its Jacobians. None if the mesh is about as good as the blocks.
std::optional<SampleTables> mesh_tables(const std::vector<double>& nodes, const MeshDivision& mesh);

/// Where the energy looks at Jacobians: at samples of the blocks, or of a mesh made of them.
struct Samples {
  SampleTables tables;
  /// How a mesh's Jacobians differ from those of the blocks, see PolynomialBlocks::projected; empty: not at all.
  std::vector<double> added;
  double allowance = 0;  ///< how much less than elsewhere scaled Jacobians may be here
};

/// Lets the kernel look at the samples, which must outlive it.
inline void look_at(const Samples& samples, kernel::DistortionInput& in) {
  in.samples = samples.tables.samples;
  in.value = samples.tables.value.data();
  in.slope = samples.tables.slope.data();
  in.added = samples.added.empty() ? nullptr : samples.added.data();
}

}  // namespace vasohex
