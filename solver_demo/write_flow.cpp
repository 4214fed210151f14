#include "write_flow.h"

#include <deal.II/base/data_out_base.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include "flow_figures.h"
#include "vasohex/core/atomic_file.h"

namespace vasohex::stokes {
namespace {

/// Patches whose data end with the coordinates of their points.
template <int dim>
class Pieces : public dealii::DataOutInterface<dim, 3> {
 public:
  using Patch = dealii::DataOutBase::Patch<dim, 3>;
  using Range = std::tuple<unsigned int, unsigned int, std::string,
                           dealii::DataComponentInterpretation::DataComponentInterpretation>;

  std::vector<Patch> patches;
  std::vector<std::string> names;
  std::vector<Range> vectors;

  /// rows x points of data, filled by the caller.
  dealii::Table<2, float>& add(int degree, unsigned int points) {
    Patch& patch = patches.emplace_back();
    patch.patch_index = patches.size() - 1;
    patch.n_subdivisions = degree;
    patch.points_are_available = true;
    patch.reference_cell = dealii::ReferenceCells::get_hypercube<dim>();
    patch.data.reinit(names.size() + 3, points);
    return patch.data;
  }

  const std::vector<Patch>& get_patches() const override { return patches; }
  std::vector<std::string> get_dataset_names() const override { return names; }
  std::vector<Range> get_nonscalar_data_ranges() const override { return vectors; }
};

template <int dim>
std::string write(Pieces<dim>& pieces, const std::string& folder, const std::string& name, MPI_Comm ranks) {
  dealii::DataOutBase::VtkFlags flags;
  flags.write_higher_order_cells = true;
  flags.print_date_and_time = false;
  flags.compression_level = dealii::DataOutBase::VtkFlags::best_speed;
  pieces.set_flags(flags);
  const unsigned int size = dealii::Utilities::MPI::n_mpi_processes(ranks);
  const auto piece = [&](unsigned int rank) {
    return name + (size > 1 ? "_" + dealii::Utilities::int_to_string(rank, 4) : "") + ".vtu";
  };
  AtomicFile file(folder + "/" + piece(dealii::Utilities::MPI::this_mpi_process(ranks)));
  pieces.write_vtu(file.stream());
  file.commit();
  if (size == 1) {
    return folder + "/" + piece(0);
  }
  if (dealii::Utilities::MPI::this_mpi_process(ranks) == 0) {
    std::vector<std::string> all;
    for (unsigned int rank = 0; rank < size; ++rank) {
      all.push_back(piece(rank));
    }
    AtomicFile record(folder + "/" + name + ".pvtu");
    pieces.write_pvtu_record(record.stream(), all);
    record.commit();
  }
  return folder + "/" + name + ".pvtu";
}

constexpr auto vector_part = dealii::DataComponentInterpretation::component_is_part_of_vector;

std::string write_volume(const FlowProblem& problem, const Flow& flow, const std::string& folder) {
  const int k = static_cast<int>(flow.velocity_space->element.degree);
  const dealii::QIterated<3> nodes(dealii::QTrapezoid<1>(), k);
  const unsigned int n = nodes.size();
  dealii::FEValues<3> u_values(*problem.mapping, flow.velocity_space->element, nodes,
                               dealii::update_values | dealii::update_quadrature_points);
  dealii::FEValues<3> p_values(*problem.mapping, flow.pressure_space->element, nodes, dealii::update_values);
  Pieces<3> pieces;
  pieces.names = {"velocity", "velocity", "velocity", "pressure"};
  pieces.vectors = {{0, 2, "velocity", vector_part}};
  std::vector<double> values(n);
  for (const auto& cell : problem.triangulation->active_cell_iterators()) {
    if (!cell->is_locally_owned()) {
      continue;
    }
    dealii::Table<2, float>& data = pieces.add(k, n);
    u_values.reinit(dealii::DoFHandler<3>::active_cell_iterator(*cell, &flow.velocity_space->dofs));
    p_values.reinit(dealii::DoFHandler<3>::active_cell_iterator(*cell, &flow.pressure_space->dofs));
    for (int row = 0; row < 7; ++row) {
      if (row < 3) {
        u_values.get_function_values(flow.velocity.block(row), values);
      } else if (row == 3) {
        p_values.get_function_values(flow.pressure, values);
      }
      for (unsigned int q = 0; q < n; ++q) {
        data(row, q) = row < 4 ? values[q] : u_values.quadrature_point(q)[row - 4];
      }
    }
  }
  return write(pieces, folder, "flow", flow.velocity_space->dofs.get_communicator());
}

std::string write_wall(const FlowProblem& problem, const Flow& flow, const std::string& folder) {
  Pieces<2> pieces;
  pieces.names = {"wall_shear_stress", "wall_shear_stress", "wall_shear_stress", "wall_shear_stress_magnitude"};
  pieces.vectors = {{0, 2, "wall_shear_stress", vector_part}};
  for (const WallFace& face : wall_shear(problem, flow)) {
    dealii::Table<2, float>& data = pieces.add(flow.velocity_space->element.degree, face.points.size());
    for (unsigned int q = 0; q < face.points.size(); ++q) {
      for (int c = 0; c < 3; ++c) {
        data(c, q) = face.shear[q][c];
        data(4 + c, q) = face.points[q][c];
      }
      data(3, q) = face.shear[q].norm();
    }
  }
  return write(pieces, folder, "wall", flow.velocity_space->dofs.get_communicator());
}

}  // namespace

std::vector<std::string> write_flow(const FlowProblem& problem, const Flow& flow, const std::string& folder) {
  return {write_volume(problem, flow, folder), write_wall(problem, flow, folder)};
}

}  // namespace vasohex::stokes
