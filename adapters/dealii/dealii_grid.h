#pragma once
/// \file Meshes and blocks as grids of deal.II: any of its triangulations, with the curved geometry at every level.

#include <deal.II/base/config.h>

#include <memory>

#include "dealii/mesh_info.h"
#include "vasohex/block_file.h"
#include "vasohex/blocks/block_structure.h"
#include "vasohex/mesh/hex_mesh.h"
#include "vasohex/surface/implicit_surface.h"

DEAL_II_NAMESPACE_OPEN
template <int, int>
class Triangulation;
template <int, int>
class MappingQCache;
DEAL_II_NAMESPACE_CLOSE

namespace vasohex {

/// The coarse cells of a grid and their geometry: one polynomial each, of any degree. Boundary ids are those of
/// info(); the material id of all cells is info().material_id. Cheap to copy.
///
///     vasohex::DealiiGrid grid(mesh);
///     dealii::parallel::distributed::Triangulation<3> triangulation(MPI_COMM_WORLD);
///     grid.create(triangulation);
///     triangulation.refine_global(1);
///     dealii::MappingQCache<3> mapping(2);
///     grid.map(triangulation, mapping);  // again after every refinement
class DealiiGrid {
 public:
  /// The elements of the mesh become the coarse cells, in their order. Throws Error(bad_input) for an element whose
  /// Jacobian determinant is negative in its middle: deal.II takes mirrored cells silently.
  explicit DealiiGrid(HexMesh mesh);

  /// The blocks become the coarse cells, with their polynomials of degree blocks.degree. With a surface, the points
  /// of the wall are projected onto it in map(), at every level, as generate_mesh does; blocks and surface must be in
  /// the same frame.
  explicit DealiiGrid(const BlockStructure& blocks, std::shared_ptr<const ImplicitSurface> surface = nullptr);

  /// The blocks of a block file, projected onto the surface of its network: for p4est, which refines each rank's own
  /// part of them.
  explicit DealiiGrid(const BlockFile& file);

  /// One rank's part of the mesh that mesh_blocks would make, and its neighbours: for parallel::fullydistributed,
  /// where no rank holds more. Equal on all ranks: file, grading, options. No communication. info() is that of the
  /// blocks.
  DealiiGrid(const BlockFile& file, const Grading& grading, const MeshOptions& options, MPI_Comm communicator);

  /// Fills an empty triangulation: dealii::Triangulation, parallel::shared, parallel::distributed (p4est) or
  /// parallel::fullydistributed; for the last one the cells are dealt out to the ranks in contiguous ranges.
  void create(dealii::Triangulation<3, 3>& triangulation) const;

  /// Makes the mapping follow the true geometry: support points of every cell on every level that this rank knows
  /// come from the coarse cells' polynomials, not from the parent. The triangulation's vertices are moved to their
  /// places too, so that mappings of degree 1 are right. To be called after create() and after every refinement.
  void map(dealii::Triangulation<3, 3>& triangulation, dealii::MappingQCache<3, 3>& mapping) const;

  /// Attaches a manifold to each coarse cell (manifold id: its index), so that refinement itself puts new points onto
  /// the coarse cells' polynomials (without projection). map() does not need it; dealii::MappingQ does. Throws
  /// Error(bad_input) for parallel::fullydistributed, whose cells cannot be refined.
  void attach_manifolds(dealii::Triangulation<3, 3>& triangulation) const;

  const MeshInfo& info() const;

  struct Data;  ///< the coarse cells; internal
  explicit DealiiGrid(Data data);

 private:
  std::shared_ptr<const Data> data_;
};

}  // namespace vasohex
