#pragma once
/// \file Internal to blocks/: the minimiser of the blocks' energy.

#include "vasohex/blocks/polynomial_blocks.h"
#include "vasohex/blocks/preconditioner.h"

namespace vasohex {

/// L-BFGS with memory 10 [Nocedal & Wright, alg. 7.4] in the tangent space of the wall; every trial is retracted.
/// Stops when the energy falls by less than `tolerance` (relative) four times in a row. With `patience` > 0 it ends
/// at the iterate of the greatest least scaled Jacobian, which swings while the energy falls, and stops when that has
/// not risen by .002 for so many iterations.
void minimise(PolynomialBlocks& blocks, Preconditioner& preconditioner, const EnergyTerms& terms, int iterations,
              double tolerance, int patience);

}  // namespace vasohex
