#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/grid/manifold.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "dealii/dealii_grid.h"
#include "dealii/grid_data.h"
#include "vasohex/core/error.h"

namespace vasohex {
namespace {

using dealii::Point;

/// A coarse cell as a chart: its reference cube.
class CellChart final : public dealii::ChartManifold<3, 3, 3> {
 public:
  CellChart(std::shared_ptr<const DealiiGrid::Data> data, int element) : data_(std::move(data)), element_(element) {}

  std::unique_ptr<dealii::Manifold<3, 3>> clone() const override { return std::make_unique<CellChart>(*this); }

  /// Newton's method from the nearest node; the point must lie in the cell.
  Point<3> pull_back(const Point<3>& space_point) const override {
    const HexMesh& mesh = data_->cells.mesh();
    const Vec3 x(space_point[0], space_point[1], space_point[2]);
    const int n = mesh.order + 1, per_element = mesh.nodes_per_element();
    const int* ids = &mesh.elements[static_cast<std::size_t>(element_) * per_element];
    Vec3 r = Vec3::Constant(0.5);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < per_element; ++i) {
      const double distance = (mesh.nodes[ids[i]] - x).squaredNorm();
      if (distance < least) {
        least = distance;
        const std::vector<double>& at = data_->cells.nodes_1d();
        r = Vec3(at[i % n], at[i / n % n], at[i / n / n]);
      }
    }
    for (int iteration = 0; iteration < 50; ++iteration) {
      Eigen::Matrix3d jacobian;
      const Vec3 off = x - data_->cells.point(element_, r, jacobian);
      Vec3 step = jacobian.inverse() * off;
      if (!(step.norm() < 0.5)) {
        step *= 0.5 / step.norm();
      }
      r += step;
      if (step.norm() < 1e-13) {
        return {r.x(), r.y(), r.z()};
      }
    }
    throw Error(ErrorCode::bad_input, "a point that deal.II refines at does not lie in coarse cell " +
                                          std::to_string(element_) + "; attach the manifolds before any refinement");
  }

  Point<3> push_forward(const Point<3>& chart_point) const override {
    Eigen::Matrix3d jacobian;
    const Vec3 x = data_->cells.point(element_, Vec3(chart_point[0], chart_point[1], chart_point[2]), jacobian);
    return {x.x(), x.y(), x.z()};
  }

  dealii::DerivativeForm<1, 3, 3> push_forward_gradient(const Point<3>& chart_point) const override {
    Eigen::Matrix3d jacobian;
    data_->cells.point(element_, Vec3(chart_point[0], chart_point[1], chart_point[2]), jacobian);
    dealii::DerivativeForm<1, 3, 3> form;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        form[i][j] = jacobian(i, j);
      }
    }
    return form;
  }

 private:
  std::shared_ptr<const DealiiGrid::Data> data_;
  int element_;
};

}  // namespace

void DealiiGrid::attach_manifolds(dealii::Triangulation<3, 3>& triangulation) const {
  if (dynamic_cast<const dealii::parallel::fullydistributed::Triangulation<3, 3>*>(&triangulation)) {
    throw Error(ErrorCode::bad_input, "manifolds are for refinement, which parallel::fullydistributed does not have");
  }
  for (const auto& cell : triangulation.cell_iterators_on_level(0)) {
    const auto id = static_cast<dealii::types::manifold_id>(cell->index());
    triangulation.set_manifold(id, CellChart(data_, cell->index()));
    // a face takes the chart of either of its cells: their polynomials are the same there
    cell->set_all_manifold_ids(id);
  }
}

}  // namespace vasohex
