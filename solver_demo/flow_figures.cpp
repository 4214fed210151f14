#include "flow_figures.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <numeric>

namespace vasohex::stokes {
namespace {

using dealii::Utilities::MPI::max;
using dealii::Utilities::MPI::sum;

/// Calls f(face values, shear stress in their points) for each face of the wall on this rank. On a wall at rest only
/// the normal derivative is not zero; its normal part, which is zero for exact flow, is left out.
template <class F>
void for_each_wall_face(const FlowProblem& problem, const Flow& flow, const dealii::Quadrature<2>& points, F&& f) {
  const dealii::DoFHandler<3>& dofs = flow.velocity_space->dofs;
  dealii::FEFaceValues<3> values(*problem.mapping, dofs.get_fe(), points,
                                 dealii::update_gradients | dealii::update_normal_vectors |
                                     dealii::update_quadrature_points | dealii::update_JxW_values);
  std::vector<dealii::Tensor<1, 3>> gradients(points.size()), shear(points.size());
  for (const auto& cell : dofs.active_cell_iterators()) {
    for (unsigned int face = 0; cell->is_locally_owned() && face < 6; ++face) {
      if (!cell->face(face)->at_boundary() || cell->face(face)->boundary_id() != problem.wall_id) {
        continue;
      }
      values.reinit(cell, face);
      for (int c = 0; c < 3; ++c) {
        values.get_function_gradients(flow.velocity.block(c), gradients);
        for (unsigned int q = 0; q < points.size(); ++q) {
          shear[q][c] = -problem.viscosity * (gradients[q] * values.normal_vector(q));
        }
      }
      for (unsigned int q = 0; q < points.size(); ++q) {
        const dealii::Tensor<1, 3> n = values.normal_vector(q);
        shear[q] -= (shear[q] * n) * n;
      }
      f(values, shear);
    }
  }
}

}  // namespace

std::vector<EndFigures> end_figures(const FlowProblem& problem, const Flow& flow) {
  const MPI_Comm ranks = flow.velocity_space->dofs.get_communicator();
  std::vector<EndFigures> figures;
  for (const End& end : problem.ends) {
    const BoundaryWeights of_u(problem, *flow.velocity_space, end.boundary_id);
    const BoundaryWeights of_p(problem, *flow.pressure_space, end.boundary_id);
    double out = 0;
    for (int c = 0; c < 3; ++c) {
      out += end.normal[c] * of_u.integrate(flow.velocity.block(c));
    }
    EndFigures e;
    e.area = sum(std::accumulate(of_p.weights.begin(), of_p.weights.end(), 0.), ranks);
    e.flow = sum(out, ranks);
    e.pressure = sum(of_p.integrate(flow.pressure), ranks) / e.area;
    figures.push_back(e);
  }
  return figures;
}

std::vector<WallFace> wall_shear(const FlowProblem& problem, const Flow& flow) {
  const int k = static_cast<int>(flow.velocity_space->element.degree);
  const dealii::Quadrature<2> nodes(dealii::QIterated<1>(dealii::QTrapezoid<1>(), k));
  std::vector<WallFace> faces;
  for_each_wall_face(problem, flow, nodes, [&](const auto& values, const auto& shear) {
    faces.push_back({values.get_quadrature_points(), shear});
  });
  return faces;
}

ShearFigures shear_figures(const FlowProblem& problem, const Flow& flow) {
  ShearFigures figures;
  const dealii::QGauss<2> points(flow.velocity_space->element.degree + 1);
  for_each_wall_face(problem, flow, points, [&](const auto& values, const auto& shear) {
    for (unsigned int q = 0; q < shear.size(); ++q) {
      const double magnitude = shear[q].norm(), area = values.JxW(q);
      figures.area += area;
      figures.mean += area * magnitude;
      figures.rms += area * magnitude * magnitude;
      figures.max = std::max(figures.max, magnitude);
    }
  });
  const MPI_Comm ranks = flow.velocity_space->dofs.get_communicator();
  figures.area = sum(figures.area, ranks);
  figures.mean = sum(figures.mean, ranks) / figures.area;
  figures.rms = std::sqrt(sum(figures.rms, ranks) / figures.area);
  figures.max = max(figures.max, ranks);
  return figures;
}

}  // namespace vasohex::stokes
