// The volume of a lumen and what bounds it, on any number of ranks: mpirun -n 2 dealii_consumer BLOCKS.json

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/mapping_q_cache.h>
#include <deal.II/grid/grid_tools.h>

#include <cstdio>

#include "dealii/dealii_grid.h"

int main(int argc, char** argv) {
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const vasohex::DealiiGrid grid(vasohex::read_block_file(argv[1]));

  dealii::parallel::distributed::Triangulation<3> triangulation(MPI_COMM_WORLD);
  grid.create(triangulation);  // coarse cells: the blocks
  triangulation.refine_global(1);
  dealii::MappingQCache<3> mapping(3);
  grid.map(triangulation, mapping);  // again after every refinement

  const double volume = dealii::GridTools::volume(triangulation, mapping);
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0) {
    std::printf("%llu cells, %g %s^3\n", static_cast<unsigned long long>(triangulation.n_global_active_cells()),
                volume, grid.info().units.c_str());
    for (const vasohex::BoundaryInfo& b : grid.info().boundaries) {
      std::printf("boundary id %u: %s, area %g\n", b.id, b.name.c_str(), b.area);
    }
  }
  return volume > 0 ? 0 : 1;
}
