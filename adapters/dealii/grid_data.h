#pragma once
/// \file Internal to dealii/: what a DealiiGrid holds.

#include <deal.II/base/mpi.h>
#include <deal.II/grid/tria_description.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "dealii/coarse_cells.h"
#include "dealii/dealii_grid.h"

namespace vasohex {

struct DealiiGrid::Data {
  CoarseCells cells;
  MeshInfo info;
  /// Of one rank's part of a larger grid, by elements: index in the whole, ascending, and rank. Empty: this is the
  /// whole.
  std::vector<std::int64_t> ids;
  std::vector<int> owner;

  int element_of(std::int64_t coarse_cell_id) const;

  /// Corners of these elements, numbered anew without gaps, and the elements as deal.II's cells.
  std::pair<std::vector<dealii::Point<3>>, std::vector<dealii::CellData<3>>> corner_cells(
      const std::vector<int>& elements) const;

  /// What this rank knows of a fully distributed triangulation: of a part all elements; of a whole grid its range of
  /// elements and their neighbours.
  dealii::TriangulationDescription::Description<3, 3> description(MPI_Comm communicator) const;
};

}  // namespace vasohex
