// The cell loops of wide_vectors.h: what deal.II's library has for its own width only.

#include "wide_vectors.h"

#include <deal.II/matrix_free/mapping_info.templates.h>
#include <deal.II/matrix_free/mapping_info_storage.templates.h>
#include <deal.II/matrix_free/matrix_free.templates.h>
#include <deal.II/matrix_free/shape_info.templates.h>

DEAL_II_NAMESPACE_OPEN

#define VASOHEX_INSTANTIATE(Number)                                                                               \
  template class MatrixFree<3, Number, vasohex::stokes::Wide<Number>>;                                            \
  template void MatrixFree<3, Number, vasohex::stokes::Wide<Number>>::internal_reinit(                            \
      const std::shared_ptr<hp::MappingCollection<3>>&, const std::vector<const DoFHandler<3>*>&,                 \
      const std::vector<const AffineConstraints<double>*>&, const std::vector<IndexSet>&,                         \
      const std::vector<hp::QCollection<3>>&, const AdditionalData&)

VASOHEX_INSTANTIATE(float);
VASOHEX_INSTANTIATE(double);

DEAL_II_NAMESPACE_CLOSE
