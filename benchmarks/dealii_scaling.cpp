// How long ranks take to make a grid from a block file, and how much memory:
//   mpirun -n RANKS dealii_scaling forest|parts|whole BLOCKS.json ORDER N
// forest: p4est, blocks refined N times. parts: fully distributed, N elements per block edge, every rank makes its
// own. whole: the same triangulation, but every rank makes the whole mesh first. Prints one line of JSON.

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/mapping_q_cache.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

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
  const bool forest = way == "forest";
  const int order = std::atoi(argv[3]), n = std::atoi(argv[4]);
  const double start_memory = megabytes("VmRSS:");
  MPI_Barrier(MPI_COMM_WORLD);
  const auto start = std::chrono::steady_clock::now();
  const double cpu_start = vasohex::thread_cpu_seconds();
  const vasohex::BlockFile file = vasohex::read_block_file(argv[2]);
  MappingQCache<3> mapping(order);
  parallel::distributed::Triangulation<3> tree(MPI_COMM_WORLD);
  parallel::fullydistributed::Triangulation<3> parts(MPI_COMM_WORLD);
  Triangulation<3>& triangulation = forest ? static_cast<Triangulation<3>&>(tree) : parts;
  if (forest) {
    const vasohex::DealiiGrid grid(file);
    grid.create(tree);
    tree.refine_global(n);
    grid.map(tree, mapping);
  } else {
    vasohex::Grading grading;
    grading.elements = n;
    const vasohex::MeshOptions options{order, vasohex::NodeFamily::gauss_lobatto};
    vasohex::Run run;
    run.threads = 1;
    const vasohex::DealiiGrid grid =
        way == "parts" ? vasohex::DealiiGrid(file, grading, options, MPI_COMM_WORLD)
                       : vasohex::DealiiGrid(vasohex::mesh_blocks(file, grading, options, run).mesh);
    grid.create(parts);
    grid.map(parts, mapping);
  }
  const double cpu = vasohex::thread_cpu_seconds() - cpu_start;
  MPI_Barrier(MPI_COMM_WORLD);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto cpu_of_all = Utilities::MPI::min_max_avg(cpu, MPI_COMM_WORLD);
  const auto peak = Utilities::MPI::min_max_avg(megabytes("VmHWM:") - start_memory, MPI_COMM_WORLD);
  const auto now = Utilities::MPI::min_max_avg(megabytes("VmRSS:") - start_memory, MPI_COMM_WORLD);
  const auto own = Utilities::MPI::min_max_avg(
      static_cast<double>(
          dynamic_cast<parallel::TriangulationBase<3>&>(triangulation).n_locally_owned_active_cells()),
      MPI_COMM_WORLD);
  if (Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0) {
    std::printf(
        "{\"ranks\": %u, \"cells\": %.0f, \"own_max\": %.0f, \"cpu_max\": %.3f, \"cpu_sum\": %.3f, \"wall\": %.3f, "
        "\"peak_mb_max\": %.1f, \"peak_mb_min\": %.1f, \"rest_mb_max\": %.1f}\n",
        Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD), own.sum, own.max, cpu_of_all.max, cpu_of_all.sum, wall,
        peak.max, peak.min, now.max);
  }
  return 0;
}
