// How long ranks take to make a grid from a block file, and how much memory:
//   mpirun -n RANKS dealii_scaling forest|parts|whole BLOCKS.json ORDER N
// forest: p4est, blocks refined N times. parts: fully distributed, N elements per block edge, every rank makes its
// own. whole: the same triangulation, but every rank makes the whole mesh first. Prints one line of JSON.

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/mapping_q_cache.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "dealii/dealii_grid.h"
#include "vasohex/core/cpu_time.h"

namespace {

double megabytes(const char* key) {
  std::FILE* file = std::fopen("/proc/self/status", "r");
  char line[256];
  double kilobytes = 0;
  while (file && std::fgets(line, sizeof line, file)) {
    if (std::string(line).starts_with(key)) {
      kilobytes = std::atof(line + std::string(key).size());
    }
  }
  if (file) {
    std::fclose(file);
  }
  return kilobytes / 1024;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace dealii;
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  if (argc != 5) {
    std::fprintf(stderr, "usage: dealii_scaling forest|parts|whole BLOCKS.json ORDER N\n");
    return 2;
  }
  const std::string way = argv[1];
  const int order = std::atoi(argv[3]), n = std::atoi(argv[4]);
  const double start_memory = megabytes("VmRSS:");
  // waiting for other ranks is processor time too, so the collective part is timed apart
  double own_seconds = 0, create_seconds = 0, last = vasohex::thread_cpu_seconds();
  const auto lap = [&last](double& sum) {
    const double now = vasohex::thread_cpu_seconds();
    sum += now - std::exchange(last, now);
  };
  MPI_Barrier(MPI_COMM_WORLD);
  last = vasohex::thread_cpu_seconds();
  const vasohex::BlockFile file = vasohex::read_block_file(argv[2]);
  MappingQCache<3> mapping(order);
  parallel::distributed::Triangulation<3> tree(MPI_COMM_WORLD);
  parallel::fullydistributed::Triangulation<3> parts(MPI_COMM_WORLD);
  const bool forest = way == "forest";
  Triangulation<3>& triangulation = forest ? static_cast<Triangulation<3>&>(tree) : parts;
  vasohex::Grading grading;
  grading.elements = n;
  const vasohex::MeshOptions options{order, vasohex::NodeFamily::gauss_lobatto};
  vasohex::Run run;
  run.threads = 1;
  const vasohex::DealiiGrid grid = forest ? vasohex::DealiiGrid(file)
                                   : way == "parts"
                                       ? vasohex::DealiiGrid(file, grading, options, MPI_COMM_WORLD)
                                       : vasohex::DealiiGrid(vasohex::mesh_blocks(file, grading, options, run).mesh);
  lap(own_seconds);
  grid.create(triangulation);
  if (forest) {
    triangulation.refine_global(n);
  }
  lap(create_seconds);
  grid.map(triangulation, mapping);
  lap(own_seconds);
  const auto own_cpu = Utilities::MPI::min_max_avg(own_seconds, MPI_COMM_WORLD);
  const auto create_cpu = Utilities::MPI::min_max_avg(create_seconds, MPI_COMM_WORLD);
  const auto peak = Utilities::MPI::min_max_avg(megabytes("VmHWM:") - start_memory, MPI_COMM_WORLD);
  const auto own = Utilities::MPI::min_max_avg(
      static_cast<double>(
          dynamic_cast<parallel::TriangulationBase<3>&>(triangulation).n_locally_owned_active_cells()),
      MPI_COMM_WORLD);
  if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0) {
    std::printf(
        "{\"ranks\": %u, \"cells\": %.0f, \"own_max\": %.0f, \"own_cpu\": %.3f, \"create_cpu\": %.3f, \"peak_mb\": "
        "%.1f}\n",
        Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD), own.sum, own.max, own_cpu.max, create_cpu.max, peak.max);
  }
  return 0;
}
