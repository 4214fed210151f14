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

/// Rank of cell `i` of `count` that are dealt out to `ranks` in contiguous ranges of equal size.
inline unsigned int owner_of(std::int64_t i, std::int64_t count, std::int64_t ranks) {
  return static_cast<unsigned int>(((i + 1) * ranks - 1) / count);
}

struct DealiiGrid::Data {
  CoarseCells cells;
  MeshInfo info;
  /// Of one rank's part of a larger grid: coarse cell ids of the elements, ascending. Empty: element e is coarse cell
  /// e.
  std::vector<std::uint64_t> ids;
  std::vector<unsigned int> owner;  ///< of such a part: [elements] rank

  int element_of(std::uint64_t coarse_cell_id) const;

  /// Corners of these elements, numbered anew without gaps, and the elements as deal.II's cells.
  std::pair<std::vector<dealii::Point<3>>, std::vector<dealii::CellData<3>>> corner_cells(
      const std::vector<int>& elements) const;

  /// What this rank knows of a fully distributed triangulation: of a part all elements; of a whole grid its range of
  /// elements and their neighbours.
  dealii::TriangulationDescription::Description<3, 3> description(MPI_Comm communicator) const;
};

}  // namespace vasohex
