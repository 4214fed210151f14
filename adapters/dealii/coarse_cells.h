#pragma once
/// \file Internal to dealii/: coarse cells as polynomials, and points of their descendants. Knows no deal.II.

#include <array>
#include <map>
#include <memory>
#include <vector>

#include "dealii/mesh_info.h"
#include "vasohex/blocks/block_structure.h"
#include "vasohex/mesh/hex_mesh.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// The cube of a descendant within its coarse cell's [0,1]^3.
struct SubCube {
  std::array<double, 3> low{0, 0, 0};
  double size = 1;
};

/// The elements of `mesh`, and what surface the points of their walls are projected onto, if any.
class CoarseCells {
 public:
  /// Throws Error(bad_input) for an element whose Jacobian determinant is negative in its middle.
  explicit CoarseCells(HexMesh mesh);
  CoarseCells(const BlockStructure& blocks, std::shared_ptr<const ImplicitSurface> surface);

  const HexMesh& mesh() const { return mesh_; }
  const std::vector<double>& nodes_1d() const { return nodes_1d_; }

  /// Projections of one element's wall that are known already, by place on the wall: cells on top of each other need
  /// the same ones.
  using WallShifts = std::map<std::array<double, 2>, Vec3>;

  /// The (order + 1)^3 Gauss-Lobatto points of a descendant, lexicographic.
  std::vector<Vec3> points(int element, const SubCube& cube, int order, WallShifts& known) const;

  /// A point of the polynomial, without projection; `jacobian` receives its derivatives as columns.
  Vec3 point(int element, const Vec3& reference, Eigen::Matrix3d& jacobian) const;

 private:
  /// How the wall of an element is to be projected.
  struct Wall {
    int face = -1;  ///< of the element; -1: it has none
    const ImplicitSurface* surface = nullptr;
    std::array<int, 6> end{};  ///< by face: 1 + index of the end's plane; 0: no end
  };
  /// Points along each direction, and the Lagrange polynomials there.
  struct Places {
    std::array<std::vector<double>, 3> t, values;
  };
  /// The shift of the wall onto the surface fades linearly along the lines that lead there.
  void shift_towards_wall(int element, const Places& at, WallShifts& known, std::vector<Vec3>& points) const;

  HexMesh mesh_;
  std::vector<double> nodes_1d_;
  std::vector<Wall> walls_;  ///< [elements], or empty: nothing is projected
  std::vector<Vec3> plane_normals_;
  std::shared_ptr<const ImplicitSurface> surface_;
  std::vector<std::shared_ptr<const ImplicitSurface>> parts_;  ///< of the surface, by region of the blocks
};

/// The blocks as a mesh: one element each, of the blocks' own degree, with Gauss-Lobatto nodes.
HexMesh block_mesh(const BlockStructure& blocks);

}  // namespace vasohex
