// The sum factorisation kernels of wide_vectors.h, for degrees up to 5, slower ones above: what deal.II's library has
// for its own width only. Those of faces and of hanging nodes are called by none of our loops, but referred to.

#define FE_EVAL_FACTORY_DEGREE_MAX 5  // each degree takes half a minute to compile
#include "wide_vectors.h"

#include <deal.II/matrix_free/evaluation_template_face_factory.templates.h>
#undef dealii_matrix_free_evaluation_template_factory_templates_h  // deal.II 9.4 guards two headers by one name
#include <deal.II/matrix_free/evaluation_template_factory.templates.h>
#include <deal.II/matrix_free/evaluation_template_factory_hanging_nodes.templates.h>

DEAL_II_NAMESPACE_OPEN

using vasohex::stokes::Wide;

template struct internal::FEEvaluationFactory<3, Wide<float>>;
template struct internal::FEEvaluationFactory<3, Wide<double>>;
template void internal::FEFaceEvaluationFactory<3, Wide<double>>::evaluate(
    unsigned int, EvaluationFlags::EvaluationFlags, const Wide<double>*,
    FEEvaluationData<3, Wide<double>, true>&);
template struct internal::FEEvaluationHangingNodesFactory<3, float, Wide<float>>;
template struct internal::FEEvaluationHangingNodesFactory<3, double, Wide<double>>;

DEAL_II_NAMESPACE_CLOSE
