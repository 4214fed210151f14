#include "inflow.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/sparse_direct.h>
#include <deal.II/lac/sparse_matrix.h>
#include <deal.II/lac/vector.h>

#include <map>

#include "vasohex/core/error.h"

namespace vasohex::stokes {
namespace {

using Index = dealii::types::global_dof_index;

/// Of one face: its shape functions, their stiffness in the plane (row by row), their integrals.
struct FaceSystem {
  std::vector<Index> dofs;
  std::vector<double> stiffness, load;
  std::vector<char> on_wall;

  template <class Archive>
  void serialize(Archive& archive, unsigned int) {
    archive& dofs& stiffness& load& on_wall;
  }
};

std::vector<FaceSystem> face_systems(const FlowProblem& problem, const Space& space, unsigned int boundary_id) {
  std::vector<FaceSystem> systems;
  dealii::FEFaceValues<3> face(
      *problem.mapping, space.element, dealii::QGauss<2>(space.element.degree + 2),
      dealii::update_values | dealii::update_gradients | dealii::update_JxW_values | dealii::update_normal_vectors);
  std::vector<Index> all(space.element.dofs_per_cell);
  for (const auto& cell : space.dofs.active_cell_iterators()) {
    for (unsigned int f = 0; cell->is_locally_owned() && f < 6; ++f) {
      if (!cell->face(f)->at_boundary() || cell->face(f)->boundary_id() != boundary_id) {
        continue;
      }
      face.reinit(cell, f);
      cell->get_dof_indices(all);
      std::vector<unsigned int> on_face;
      FaceSystem s;
      for (unsigned int i = 0; i < all.size(); ++i) {
        if (space.element.has_support_on_face(i, f)) {
          on_face.push_back(i);
          s.dofs.push_back(all[i]);
          s.on_wall.push_back(space.wall.is_constrained(all[i]));
        }
      }
      const std::size_t n = on_face.size();
      s.stiffness.assign(n * n, 0);
      s.load.assign(n, 0);
      for (unsigned int q = 0; q < face.n_quadrature_points; ++q) {
        const dealii::Tensor<1, 3> normal = face.normal_vector(q);
        std::vector<dealii::Tensor<1, 3>> gradient;
        for (std::size_t i = 0; i < n; ++i) {
          const dealii::Tensor<1, 3> g = face.shape_grad(on_face[i], q);
          gradient.push_back(g - (g * normal) * normal);
          s.load[i] += face.shape_value(on_face[i], q) * face.JxW(q);
        }
        for (std::size_t i = 0; i < n * n; ++i) {
          s.stiffness[i] += gradient[i / n] * gradient[i % n] * face.JxW(q);
        }
      }
      systems.push_back(std::move(s));
    }
  }
  return systems;
}

/// w at the nodes of one end, and its integral. Every rank solves the small system of all faces.
std::pair<std::map<Index, double>, double> section_profile(const FlowProblem& problem, const Space& space,
                                                           unsigned int boundary_id) {
  const auto systems =
      dealii::Utilities::MPI::all_gather(space.dofs.get_communicator(), face_systems(problem, space, boundary_id));
  std::map<Index, double> profile;
  for (const auto& of_rank : systems) {
    for (const FaceSystem& s : of_rank) {
      for (std::size_t i = 0; i < s.dofs.size(); ++i) {
        if (!s.on_wall[i]) {
          profile.emplace(s.dofs[i], 0.);
        }
      }
    }
  }
  std::map<Index, int> row;
  for (const auto& [dof, value] : profile) {
    row.emplace(dof, static_cast<int>(row.size()));
  }
  dealii::DynamicSparsityPattern entries(row.size());
  const auto for_each_entry = [&](auto&& f) {
    for (const auto& of_rank : systems) {
      for (const FaceSystem& s : of_rank) {
        const std::size_t n = s.dofs.size();
        for (std::size_t ij = 0; ij < n * n; ++ij) {
          if (!s.on_wall[ij / n] && !s.on_wall[ij % n]) {
            f(row.at(s.dofs[ij / n]), row.at(s.dofs[ij % n]), s.stiffness[ij]);
          }
        }
      }
    }
  };
  for_each_entry([&](int i, int j, double) { entries.add(i, j); });
  dealii::SparsityPattern pattern;
  pattern.copy_from(entries);
  dealii::SparseMatrix<double> matrix(pattern);
  for_each_entry([&](int i, int j, double value) { matrix.add(i, j, value); });
  dealii::Vector<double> load(row.size());
  for (const auto& of_rank : systems) {
    for (const FaceSystem& s : of_rank) {
      for (std::size_t i = 0; i < s.dofs.size(); ++i) {
        if (!s.on_wall[i]) {
          load[row.at(s.dofs[i])] += s.load[i];
        }
      }
    }
  }
  if (row.empty()) {
    return {profile, 0};
  }
  dealii::Vector<double> w = load;
  dealii::SparseDirectUMFPACK solver;
  solver.solve(matrix, w);
  for (auto& [dof, value] : profile) {
    value = w[row.at(dof)];
  }
  return {profile, w * load};
}

}  // namespace

void set_inflow(const FlowProblem& problem, const Space& space, Blocks<double>& velocity) {
  for (const End& end : problem.ends) {
    if (!end.flow) {
      continue;
    }
    const auto [profile, integral] = section_profile(problem, space, end.boundary_id);
    if (!(integral > 0)) {
      throw Error(ErrorCode::bad_input,
                  "end " + end.name + ": no profile is possible, all its nodes are on the wall");
    }
    for (const auto& [dof, w] : profile) {
      if (space.dofs.locally_owned_dofs().is_element(dof)) {
        for (int c = 0; c < 3; ++c) {
          velocity.block(c)[dof] = -*end.flow / integral * w * end.normal[c];
        }
      }
    }
  }
}

}  // namespace vasohex::stokes
