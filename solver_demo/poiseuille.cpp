/// \file Errors of Poiseuille flow in vasohex's mesh of a tube, for several orders of geometry, as a Markdown table.
///
/// Flow 1 - y^2 - z^2 along x through a tube of radius 1 and length 4, viscosity 1: pressure falls by 4 per length,
/// wall shear stress is 2. Relative L2 errors; in brackets the order observed from the line before.

#include "stokes.h"
// deal.II's wide vectors come first

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q_cache.h>
#include <deal.II/grid/tria.h>

#include <cmath>
#include <numbers>

#include "boundary_conditions.h"
#include "dealii/dealii_grid.h"
#include "vasohex/vasohex.h"

namespace {

using namespace vasohex;
using namespace vasohex::stokes;

constexpr double length = 4;

HexMesh tube(int order, int elements) {
  Skeleton skeleton;
  skeleton.points = {{0, 0, 0}, {length, 0, 0}};
  skeleton.radii = {1, 1};
  skeleton.segments = {{0, 1}};
  skeleton.names = {{0, "inlet"}, {1, "outlet"}};
  SkeletonMeshOptions options;
  options.mesh = {order, NodeFamily::gauss_lobatto};
  options.grading.elements = elements;
  return mesh_skeleton(skeleton, options).result.mesh;
}

struct Errors {
  double velocity = 0, pressure = 0, shear = 0;
};

Errors measure(const FlowProblem& problem, const Flow& flow) {
  const dealii::QGauss<3> points(flow.velocity_space->element.degree + 3);
  const dealii::QGauss<2> face_points(flow.velocity_space->element.degree + 3);
  dealii::FEValues<3> u(*problem.mapping, flow.velocity_space->element, points,
                        dealii::update_values | dealii::update_quadrature_points | dealii::update_JxW_values);
  dealii::FEValues<3> p(*problem.mapping, flow.pressure_space->element, points, dealii::update_values);
  dealii::FEFaceValues<3> wall(*problem.mapping, flow.velocity_space->element, face_points,
                               dealii::update_gradients | dealii::update_normal_vectors | dealii::update_JxW_values);
  std::vector<double> values(points.size());
  std::vector<dealii::Tensor<1, 3>> gradients(face_points.size());
  Errors error, norm;
  auto p_cell = flow.pressure_space->dofs.begin_active();
  for (const auto& cell : flow.velocity_space->dofs.active_cell_iterators()) {
    u.reinit(cell);
    p.reinit(p_cell++);
    for (int c = 0; c < 4; ++c) {
      if (c < 3) {
        u.get_function_values(flow.velocity.block(c), values);
      } else {
        p.get_function_values(flow.pressure, values);
      }
      for (unsigned int q = 0; q < points.size(); ++q) {
        const dealii::Point<3> x = u.quadrature_point(q);
        const double exact = c == 0 ? 1 - x[1] * x[1] - x[2] * x[2] : c == 3 ? 4 * (length - x[0]) : 0;
        (c < 3 ? error.velocity : error.pressure) += std::pow(values[q] - exact, 2) * u.JxW(q);
        (c < 3 ? norm.velocity : norm.pressure) += exact * exact * u.JxW(q);
      }
    }
    for (unsigned int f = 0; f < 6; ++f) {
      if (cell->face(f)->at_boundary() && cell->face(f)->boundary_id() == problem.wall_id) {
        wall.reinit(cell, f);
        wall.get_function_gradients(flow.velocity.block(0), gradients);
        for (unsigned int q = 0; q < face_points.size(); ++q) {
          error.shear += std::pow(-gradients[q] * wall.normal_vector(q) - 2, 2) * wall.JxW(q);
          norm.shear += 4 * wall.JxW(q);
        }
      }
    }
  }
  return {std::sqrt(error.velocity / norm.velocity), std::sqrt(error.pressure / norm.pressure),
          std::sqrt(error.shear / norm.shear)};
}

void study(int order, int degree, int levels) {
  Errors before;
  for (int level = 0; level < levels; ++level) {
    HexMesh mesh = tube(order, 1 << level);
    BoundaryConditions conditions;
    conditions.flow_rate = std::numbers::pi / 2;
    conditions.viscosity = 1;
    FlowProblem problem;
    problem.ends = flow_ends(mesh, mesh_info(mesh), conditions);
    problem.wall_id = 1;
    problem.viscosity = conditions.viscosity;
    const DealiiGrid grid(std::move(mesh));
    dealii::Triangulation<3> triangulation;
    grid.create(triangulation);
    dealii::MappingQCache<3> mapping(order);
    grid.map(triangulation, mapping);
    problem.triangulation = &triangulation;
    problem.mapping = &mapping;
    StokesOptions options;
    options.degree = degree;
    options.tolerance = 1e-11;
    const Flow flow = solve_stokes(problem, options);
    const Errors e = measure(problem, flow);
    std::printf("| %d | %d | %u | %llu | %d |", order, degree, triangulation.n_active_cells(), flow.dofs,
                flow.iterations);
    for (const auto& [now, old] : {std::pair{e.velocity, before.velocity}, std::pair{e.pressure, before.pressure},
                                   std::pair{e.shear, before.shear}}) {
      if (level == 0) {
        std::printf(" %.1e |", now);
      } else {
        std::printf(" %.1e (%.1f) |", now, std::log2(old / now));
      }
    }
    std::printf("\n");
    std::fflush(stdout);
    before = e;
  }
}

}  // namespace

int main(int argc, char** argv) {
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const int levels = argc > 1 ? std::atoi(argv[1]) : 4;
  if (argc > 2 || levels < 1 || levels > 5) {
    std::fprintf(
        stderr,
        "usage: poiseuille [MESHES]    how many, of 1, 2, 4, .. elements per block edge; 1 to 5, default 4\n");
    return 2;
  }
  std::printf("| order | degree | cells | dofs | iterations | velocity | pressure | wall shear stress |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const auto& [order, degree] : {std::pair{1, 2}, {2, 2}, {3, 3}, {4, 4}, {2, 3}}) {
    study(order, degree, levels);
  }
}
