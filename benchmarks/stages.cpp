// Times every stage on the abdominal aorta at order 3 (about 400 blocks x 6^3 hexahedra), one thread, and in the same run
// what Gmsh takes to build transfinite hexahedra of order 3 in 375 blocks x 6^3. CPU time of the process.

#include <benchmark/benchmark.h>
#include <gmsh.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <map>

#include "gmsh/write_msh.h"
#include "vasohex/blocks/clear_ends.h"
#include "vasohex/quality/quality_report.h"
#include "vasohex/skeleton/own_frame.h"
#include "vasohex/skeleton/read_skeleton.h"
#include "vasohex/vasohex.h"

namespace {

using namespace vasohex;

const Run kSerial = [] {
  Run run;
  run.threads = 1;
  return run;
}();

/// All stages up to the blocks, made once.
struct Aorta {
  Skeleton skeleton = read_skeleton(VASOHEX_MESHES "/abdominal_aorta.json");
  Network network;
  std::unique_ptr<ImplicitSurface> surface;
  BlockStructure blocks;
  BlockTopology topology;
  Aorta() {
    network = build_network(skeleton, {}, kSerial);
    clear_ends(network);
    network = in_frame(network, own_frame(network));
    surface = make_convolution_surface(network, {}, kSerial);
    blocks = build_blocks(network, *surface, {}, kSerial);
    topology = build_topology(blocks.vertex_count, blocks.blocks);
  }
};

const Aorta& aorta() {
  static const Aorta a;
  return a;
}

MeshResult mesh_of_order(int order) {
  const Aorta& a = aorta();
  return generate_mesh(a.blocks, a.topology, grade(a.blocks, a.topology, {}), *a.surface,
                       {order, NodeFamily::equispaced}, kSerial);
}

void network(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(build_network(aorta().skeleton, {}, kSerial));
  }
}
void convolution_surface(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(make_convolution_surface(aorta().network, {}, kSerial));
  }
}
void blocks_and_optimisation(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(build_blocks(aorta().network, *aorta().surface, {}, kSerial));
  }
}
void grading_transfinite_projection(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(mesh_of_order(3).mesh.nodes.data());
  }
  const MeshResult result = mesh_of_order(3);
  state.counters["hexes"] = result.mesh.element_count();
  state.counters["nodes"] = result.mesh.nodes.size();
}
void quality_and_certificate(benchmark::State& state) {
  const HexMesh mesh = mesh_of_order(3).mesh;
  for (auto _ : state) {
    benchmark::DoNotOptimize(measure_quality(mesh, kSerial));
  }
}
void write_msh_file(benchmark::State& state) {
  const HexMesh mesh = mesh_of_order(3).mesh;
  const std::string path = (std::filesystem::temp_directory_path() / "vasohex_stages.msh").string();
  for (auto _ : state) {
    write_msh(mesh, path, kSerial);
  }
  std::remove(path.c_str());
}

/// 5 x 5 x 15 blocks of 6^3 hexahedra that share their faces, order 3.
void gmsh_transfinite_order_3(benchmark::State& state) {
  constexpr int nx = 5, ny = 5, nz = 15, elements = 6;
  namespace geo = gmsh::model::geo;
  for (auto _ : state) {
    gmsh::initialize();
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
    const auto at = [](int i, int j, int k) { return 1 + i + (nx + 1) * (j + (ny + 1) * k); };
    std::map<std::pair<int, int>, int> lines;
    const auto line = [&](int a, int b) {
      const auto [it, is_new] = lines.try_emplace({a, b}, 0);
      if (is_new) {
        it->second = geo::addLine(a, b);
        geo::mesh::setTransfiniteCurve(it->second, elements + 1);
      }
      return it->second;
    };
    std::map<std::array<int, 4>, int> faces;
    const auto face = [&](int a, int b, int c, int d) {  // corners a - b, b - c, d - c, a - d
      const auto [it, is_new] = faces.try_emplace({a, b, c, d}, 0);
      if (is_new) {
        it->second = geo::addPlaneSurface({geo::addCurveLoop({line(a, b), line(b, c), -line(d, c), -line(a, d)})});
        geo::mesh::setTransfiniteSurface(it->second);
        geo::mesh::setRecombine(2, it->second);
      }
      return it->second;
    };
    for (int k = 0; k <= nz; ++k) {
      for (int j = 0; j <= ny; ++j) {
        for (int i = 0; i <= nx; ++i) {
          geo::addPoint(i, j, k, 0, at(i, j, k));
        }
      }
    }
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
          const int a = at(i, j, k), b = at(i + 1, j, k), c = at(i + 1, j + 1, k), d = at(i, j + 1, k);
          const int e = at(i, j, k + 1), f = at(i + 1, j, k + 1), g = at(i + 1, j + 1, k + 1),
                    h = at(i, j + 1, k + 1);
          const int volume =
              geo::addVolume({geo::addSurfaceLoop({face(a, b, c, d), face(e, f, g, h), face(a, b, f, e),
                                                   face(d, c, g, h), face(a, d, h, e), face(b, c, g, f)})});
          geo::mesh::setTransfiniteVolume(volume);
        }
      }
    }
    geo::synchronize();
    gmsh::model::mesh::generate(3);
    gmsh::model::mesh::setOrder(3);
    std::vector<std::size_t> tags;
    std::vector<double> x, u;
    gmsh::model::mesh::getNodes(tags, x, u);
    std::vector<int> types;
    std::vector<std::vector<std::size_t>> element_tags, element_nodes;
    gmsh::model::mesh::getElements(types, element_tags, element_nodes, 3);
    state.counters["nodes"] = tags.size();
    state.counters["hexes"] = element_tags.at(0).size();
    gmsh::finalize();
  }
}

#define STAGE(f) BENCHMARK(f)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()
STAGE(network);
STAGE(convolution_surface);
STAGE(blocks_and_optimisation)->Iterations(3);
STAGE(grading_transfinite_projection);
STAGE(quality_and_certificate)->Iterations(3);
STAGE(write_msh_file)->Iterations(3);
STAGE(gmsh_transfinite_order_3)->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
