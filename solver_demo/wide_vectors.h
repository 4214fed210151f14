#pragma once
/// \file deal.II's cell loops with the widest vector instructions of this compilation, whatever its library was built
/// for. To be included before any other header of deal.II.
///
/// Debian's deal.II has VectorizedArray<double, 1> only. Its headers hold the wider types behind one macro, which also
/// sets the default width. numbers.h, which fixes that default, is included first, by config.h; the macro is changed
/// after it. So all default types stay those of the library, and the wide ones, which are named nowhere in it, are
/// instantiated in wide_kernels.cpp and wide_loops.cpp.

#include <deal.II/base/config.h>

#undef DEAL_II_VECTORIZATION_WIDTH_IN_BITS
#if defined(__AVX512F__)
#define DEAL_II_VECTORIZATION_WIDTH_IN_BITS 512
#elif defined(__AVX__)
#define DEAL_II_VECTORIZATION_WIDTH_IN_BITS 256
#elif defined(__SSE2__)
#define DEAL_II_VECTORIZATION_WIDTH_IN_BITS 128
#else
#define DEAL_II_VECTORIZATION_WIDTH_IN_BITS 0
#endif

#include <deal.II/base/vectorization.h>
#include <deal.II/lac/la_parallel_block_vector.h>
#include <deal.II/matrix_free/fe_evaluation.h>
#include <deal.II/matrix_free/matrix_free.h>

namespace vasohex::stokes {

template <class Number>
inline constexpr int lanes =
    DEAL_II_VECTORIZATION_WIDTH_IN_BITS == 0 ? 1 : DEAL_II_VECTORIZATION_WIDTH_IN_BITS / (8 * sizeof(Number));

template <class Number>
using Wide = dealii::VectorizedArray<Number, lanes<Number>>;

template <class Number>
using Cells = dealii::MatrixFree<3, Number, Wide<Number>>;

/// `components` scalar fields on one cell per lane; degree and quadrature are those of the Cells.
template <int components, class Number>
using CellValues = dealii::FEEvaluation<3, -1, 0, components, Number, Wide<Number>>;

template <class Number>
using Vector = dealii::LinearAlgebra::distributed::Vector<Number>;

/// One block per component.
template <class Number>
using Blocks = dealii::LinearAlgebra::distributed::BlockVector<Number>;

}  // namespace vasohex::stokes
