/// \file vasohex_stokes: steady Stokes flow through a vascular network, on vasohex's mesh of it.

#include "stokes.h"
// deal.II's wide vectors come first

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/fe/mapping_q_cache.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "boundary_conditions.h"
#include "dealii/dealii_grid.h"
#include "flow_figures.h"
#include "input.h"
#include "option_checks.h"
#include "vasohex/block_file.h"
#include "vasohex/core/atomic_file.h"
#include "vasohex/core/text_lines.h"
#include "write_flow.h"

namespace {

using namespace vasohex;
using cli::usage;

struct Arguments {
  cli::Input input;
  std::string output;
  SkeletonMeshOptions mesh;
  int refine = 0;
  stokes::StokesOptions solver;
  stokes::BoundaryConditions conditions;
  std::vector<std::string> flows, resistances;
  double density = 1060;
};

/// NAME=NUMBER
std::map<std::string, double> by_name(const std::string& option, const std::vector<std::string>& texts) {
  std::map<std::string, double> result;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    std::size_t end = 0;
    double value = NAN;
    try {
      value = std::stod(text.substr(equals + 1), &end);
    } catch (const std::exception&) {
    }
    if (equals == std::string::npos || equals == 0 || equals + 1 + end != text.size() || !std::isfinite(value)) {
      usage(option + " " + text + ": must be NAME=NUMBER, as inlet=250");
    }
    result[text.substr(0, equals)] = value;
  }
  return result;
}

Arguments read_arguments(CLI::App& app, int argc, char** argv) {
  Arguments a;
  std::optional<int> degree;
  a.conditions.viscosity = .0035;
  a.mesh.mesh.order = 2;
  a.input.add_to(app);
  app.get_option("INPUT")->description(app.get_option("INPUT")->get_description() + ", or block file (.json)");
  app.add_option("-o,--output", a.output, "Folder for flow.vtu, wall.vtu and flow.json; made if it is not there")
      ->required();
  app.add_option("-p,--order", a.mesh.mesh.order, "Order of the elements' geometry")
      ->check(CLI::Range(1, 6))
      ->capture_default_str();
  app.add_option("-k,--degree", degree, "Degree of velocities; pressures have one less [the order, at least 2]")
      ->check(CLI::Range(2, 6));
  app.add_option("-n,--elements", a.mesh.grading.elements, "Elements per block edge")
      ->check(cli::whole_number(1))
      ->capture_default_str();
  app.add_option("--radial", a.mesh.grading.radial, "Elements from the core to the wall")
      ->check(cli::whole_number(1));
  app.add_option("--axial", a.mesh.grading.axial, "Elements along each block of a vessel")
      ->check(cli::whole_number(1));
  app.add_option("--refine", a.refine, "Halve all elements so many times, in parallel")
      ->check(CLI::Range(0, 6))
      ->capture_default_str();
  cli::Input::add_repair(app, a.mesh);
  app.add_option("--flow-rate", a.conditions.flow_rate,
                 "Into the only inlet, length unit^3 / s [1 Pa of wall shear stress]");
  app.add_option("--flow", a.flows, "NAME=Q: flow into one end, length unit^3 / s; for several inlets, once each");
  app.add_option("--resistance", a.resistances, "NAME=R: pressure over flow at one outlet, Pa s / length unit^3 [0]");
  app.add_option("--viscosity", a.conditions.viscosity, "Pa s")->check(cli::positive_number())->capture_default_str();
  app.add_option("--density", a.density, "kg / m^3, for the Reynolds number alone")
      ->check(cli::positive_number())
      ->capture_default_str();
  app.add_option("--tolerance", a.solver.tolerance, "Of the residual, relative to the start")
      ->check(CLI::Range(1e-13, 1e-1))
      ->capture_default_str();
  app.parse(argc, argv);
  a.solver.degree = degree.value_or(std::max(2, a.mesh.mesh.order));
  a.conditions.flows = by_name("--flow", a.flows);
  a.conditions.resistances = by_name("--resistance", a.resistances);
  for (const auto& [name, r] : a.conditions.resistances) {
    if (r < 0) {
      usage("--resistance " + name + ": must not be negative");
    }
  }
  return a;
}

bool is_block_file(const std::string& path) {
  if (lower_extension(path) != ".json") {
    return false;
  }
  std::ifstream in(path);
  const nlohmann::json j = nlohmann::json::parse(in, nullptr, false);
  return j.is_object() && j.contains("format") && j["format"].is_string() &&
         j["format"].get<std::string>().starts_with("vasohex-blocks");
}

HexMesh make_mesh(const Arguments& a, int threads) {
  Run run;
  run.threads = threads;
  if (is_block_file(a.input.path)) {
    const cli::Input& i = a.input;
    if (i.files().size() > 1 || !i.units.empty() || i.inlet || i.facets || !i.labels.empty() || a.mesh.repair) {
      usage(i.path + " holds finished blocks: options of skeletons, surfaces and labelmaps do not go with it");
    }
    return with_context(a.input.path, [&] {
      return mesh_blocks(read_block_file(a.input.path), a.mesh.grading, a.mesh.mesh, run).mesh;
    });
  }
  return cli::mesh(a.input, cli::load(a.input, run), a.mesh, run).result.mesh;
}

double metres(const std::string& unit) { return unit == "um" ? 1e-6 : unit == "mm" ? 1e-3 : unit == "cm" ? 1e-2 : 1; }

/// Largest of one end, by mean velocity and diameter; none if the unit is not known.
std::optional<double> reynolds(const Arguments& a, const std::vector<stokes::End>& ends,
                               const std::vector<stokes::EndFigures>& figures, const std::string& unit) {
  if (unit.empty()) {
    return {};
  }
  double most = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const double metre = metres(unit), velocity = std::abs(figures[i].flow) / figures[i].area * metre;
    most = std::max(most, a.density * velocity * 2 * ends[i].radius * metre / a.conditions.viscosity);
  }
  return most;
}

/// Peak of each rank, GiB.
std::vector<double> peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, usage.ru_maxrss / 1048576.);
}

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void run(Arguments& a, bool talk) {
  const double start = now();
  const unsigned int ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  HexMesh mesh = make_mesh(a, ranks > 1 ? 1 : 0);
  const MeshInfo info = mesh_info(mesh);
  stokes::FlowProblem problem;
  problem.ends = with_context(a.input.path, [&] { return stokes::flow_ends(mesh, info, a.conditions); });
  problem.wall_id = 1;
  problem.viscosity = a.conditions.viscosity;
  const int order = mesh.order;
  std::filesystem::create_directories(a.output);
  const double meshed = now();
  dealii::parallel::distributed::Triangulation<3> triangulation(MPI_COMM_WORLD);
  dealii::MappingQCache<3> mapping(order);
  {
    const DealiiGrid grid(std::move(mesh));
    grid.create(triangulation);
    triangulation.refine_global(a.refine);
    grid.map(triangulation, mapping);
  }
  problem.triangulation = &triangulation;
  problem.mapping = &mapping;
  const double gridded = now();
  if (talk) {
    std::printf("%s: %llu hexahedra of order %d; velocity Q%d, pressure Q%d, %u rank(s)\n", a.input.path.c_str(),
                static_cast<unsigned long long>(triangulation.n_global_active_cells()), order, a.solver.degree,
                a.solver.degree - 1, ranks);
    std::fflush(stdout);
    a.solver.on_iteration = [](int iteration, double residual) {
      std::printf(isatty(1) ? "\r  iteration %3d   residual %.1e  " : "  iteration %3d   residual %.1e\n", iteration,
                  residual);
      std::fflush(stdout);
    };
  }
  const stokes::Flow flow = stokes::solve_stokes(problem, a.solver);
  if (!flow.converged) {
    char text[200];
    std::snprintf(text, sizeof text, "no convergence in %d iterations: the residual is %.1e of that at the start; %s",
                  flow.iterations, flow.residual, "nothing is written");
    throw Error(ErrorCode::internal, text);
  }
  const double solved = now();
  const std::vector<stokes::EndFigures> figures = stokes::end_figures(problem, flow);
  const stokes::ShearFigures shear = stokes::shear_figures(problem, flow);
  const std::vector<std::string> files = stokes::write_flow(problem, flow, a.output);
  const std::vector<double> memory = peak_memory();
  const double setup_cpu = dealii::Utilities::MPI::sum(flow.setup_cpu_seconds, MPI_COMM_WORLD);
  const double solve_cpu = dealii::Utilities::MPI::sum(flow.solve_cpu_seconds, MPI_COMM_WORLD);
  const std::optional<double> re = reynolds(a, problem.ends, figures, info.units);

  nlohmann::ordered_json j;
  j["input"] = a.input.path;
  j["units"] = info.units;
  j["elements"] = triangulation.n_global_active_cells();
  j["order"] = order;
  j["degree"] = a.solver.degree;
  j["dofs"] = flow.dofs;
  j["ranks"] = ranks;
  j["vector_lanes"] = {{"double", stokes::lanes<double>}, {"float", stokes::lanes<float>}};
  j["viscosity"] = problem.viscosity;
  j["density"] = a.density;
  j["reynolds_max"] = re ? nlohmann::ordered_json(*re) : nlohmann::ordered_json(nullptr);
  j["iterations"] = flow.iterations;
  j["residual"] = flow.residual;
  j["converged"] = flow.converged;
  double sum = 0, in = 0;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const stokes::EndFigures& e = figures[i];
    sum += e.flow;
    in += std::max(0., -e.flow);
    j["ends"].push_back(
        {{"name", problem.ends[i].name}, {"area", e.area}, {"flow_out", e.flow}, {"pressure", e.pressure}});
  }
  j["flow_imbalance"] = sum / in;
  j["wall_shear_stress"] = {{"area", shear.area}, {"mean", shear.mean}, {"rms", shear.rms}, {"max", shear.max}};
  j["memory_gib"] = memory;  // of each rank
  j["seconds"] = {{"mesh", meshed - start},      {"grid", gridded - meshed}, {"setup", flow.setup_seconds},
                  {"solve", flow.solve_seconds}, {"write", now() - solved},  {"total", now() - start}};
  j["cpu_seconds"] = {{"setup", setup_cpu}, {"solve", solve_cpu}};  // of all ranks
  if (!talk) {
    return;
  }
  AtomicFile file(a.output + "/flow.json");
  file.stream() << j.dump(2) << '\n';
  file.commit();
  const char* unit = info.units.empty() ? "unit" : info.units.c_str();
  std::printf("\n  %llu dofs, %d iterations, residual %.1e; Reynolds number %s\n", flow.dofs, flow.iterations,
              flow.residual, re ? std::to_string(*re).c_str() : "unknown: the input states no unit");
  std::printf("  %-14s %12s %14s %14s\n", "end", (std::string("area ") + unit + "2").c_str(),
              (std::string("out ") + unit + "3/s").c_str(), "pressure Pa");
  for (std::size_t i = 0; i < figures.size(); ++i) {
    std::printf("  %-14s %12.6g %14.7g %14.7g\n", problem.ends[i].name.c_str(), figures[i].area, figures[i].flow,
                figures[i].pressure);
  }
  std::printf("  flow out - in: %.1e of the inflow\n", sum / in);
  std::printf("  wall shear stress: mean %.5g, max %.5g Pa\n", shear.mean, shear.max);
  std::printf("  setup %.1f s, solution %.1f s, total %.1f s; CPU %.1f and %.1f s; %.2f GiB\n", flow.setup_seconds,
              flow.solve_seconds, now() - start, setup_cpu, solve_cpu,
              std::accumulate(memory.begin(), memory.end(), 0.));
  for (const std::string& f : files) {
    std::printf("  written %s\n", f.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool talk = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  CLI::App app{
      "Steady Stokes flow through a vascular network, on vasohex's curved hexahedra.\n"
      "Exit status: 0 done, 1 internal error or no convergence, 2 bad input or usage."};
  const auto complain = [&](const std::string& text, int code) {
    if (talk) {
      std::fprintf(stderr, "vasohex_stokes: %s\n", text.c_str());
    }
    return code;
  };
  try {
    Arguments arguments = read_arguments(app, argc, argv);
    run(arguments, talk);
    return 0;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) {
      return talk ? app.exit(e) : 0;
    }
    return complain(std::string(e.what()) + "; see vasohex_stokes --help", 2);
  } catch (const Error& e) {
    return complain(e.what(), e.code() == ErrorCode::internal ? 1 : 2);
  } catch (const std::exception& e) {
    return complain(std::string("internal error: ") + e.what(), 1);
  }
}
