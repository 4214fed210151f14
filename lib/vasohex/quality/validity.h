#pragma once
/// \file Certificate that det J > 0 everywhere in curved hexahedra [Johnen, Remacle, Geuzaine 2013].

#include <span>
#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/core/vec3.h"
#include "vasohex/mesh/hex_mesh.h"

namespace vasohex {

enum class ValidityState {
  certified,  ///< det J > 0 on the whole element
  invalid,    ///< a point with det J < 0 was found, or a coordinate is not finite
  undecided,  ///< neither: det J = 0 somewhere to rounding, or subdivision came to its limit
};

struct Validity {
  ValidityState state = ValidityState::undecided;
  /// Lower bound of det J over the element, divided by the magnitude of its mean. > 0 exactly if certified; not
  /// sharp; -infinity if the mean is 0 or a coordinate is not finite.
  double bound = 0;
};

/// Certifies each element, or block: det J, a polynomial of degree 3 * order - 1 per direction, is bounded by its
/// Bernstein coefficients; where these do not decide, the element is subdivided, at most 6 times.
///
/// `elements` is [n][(order + 1)^3] indices into `nodes`, lexicographic, on the nodes of `family`; order 1 to 9, else
/// Error bad_input, as for indices that are not in `nodes`. Coordinates count as exact. Every coefficient is known to
/// an allowance a * L1 * L2 * L3, L_d the largest control vector of dx/du_d, a proven bound of the rounding (2e-14,
/// 1e-13 and 6.5e-13 at orders 1, 3 and 9); `certified` means coefficients above it, `invalid` a value below minus
/// it, so neither is ever wrong. The result is the same to the last bit for any number of threads and any processor.
std::vector<Validity> certify(int order, NodeFamily family, std::span<const Vec3> nodes,
                              std::span<const int> elements, const Run& run = {});

std::vector<Validity> certify(const HexMesh& mesh, const Run& run = {});

}  // namespace vasohex
