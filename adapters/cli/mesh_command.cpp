#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "commands.h"
#include "findings.h"
#include "gmsh/write_msh.h"
#include "input.h"
#include "json_point.h"
#include "option_checks.h"
#include "report.h"
#include "vasohex/core/short_text.h"
#include "vasohex/core/text_lines.h"
#include "vasohex/failed_places.h"
#include "vasohex/mesh/layer_heights.h"
#include "vtk/write_vtu.h"

namespace vasohex::cli {
namespace {

struct MeshCommand {
  Input input;
  std::vector<std::string> outputs;
  SkeletonMeshOptions options;
  std::string nodes = "equispaced", json;
  std::optional<int> elements;
  int layers = 0;
  std::optional<std::string> first_layer;
  std::optional<double> growth;
  std::vector<std::string> sheets;
};

/// Elements per block edge where nothing is said. Linear elements cut across the curves of a triangulated lumen as
/// chords: with 6 of them the wall's mean distance is up to .008 radii, with 10 below .005 on all published surfaces.
/// Voxels do not know their wall as well as that.
int default_elements(const MeshCommand& c) {
  const bool is_linear = c.options.mesh.order == 1;
  return is_linear && c.input.has_triangles() ? 10 : c.options.grading.elements;
}

/// `0.02r`: relative to the local radius; `0.1`: in the mesh's unit.
void read_first_layer(const std::string& text, WallLayers& layers) {
  std::size_t end = 0;
  try {
    layers.first_height = std::stod(text, &end);
  } catch (const std::exception&) {
    end = 0;
  }
  layers.relative = text.substr(end) == "r";
  if (end == 0 || !(layers.first_height > 0) || !std::isfinite(layers.first_height) ||
      (end != text.size() && !layers.relative)) {
    usage("--first-layer " + text + ": must be a height > 0, as 0.02r (local radii) or 0.1 (the mesh's unit)");
  }
}

Grading::Request read_sheet(const std::string& text) {
  const std::size_t equals = text.find('=');
  Grading::Request request{text.substr(0, equals), {}, {}};
  try {
    std::size_t end = 0;
    request.count = std::stoi(text.substr(equals + 1), &end);
    if (equals == std::string::npos || equals + 1 + end != text.size()) {
      throw std::invalid_argument(text);
    }
  } catch (const std::exception&) {
    usage("--sheet " + text + ": must be NAME=COUNT, as axial.3=12; `vasohex blocks` lists the names");
  }
  return request;
}

void check_output(const std::string& path, const MeshOptions& mesh) {
  const std::string ext = lower_extension(path);
  if (ext != ".msh" && ext != ".vtu") {
    usage("output " + path + ": unknown extension '" + ext + "', use .msh or .vtu");
  }
  if (mesh.order > (ext == ".msh" ? 9 : 10)) {
    usage("output " + path + ": order " + std::to_string(mesh.order) +
          (ext == ".msh" ? " does not exist in MSH, use at most 9" : " does not exist in VTU, use at most 10"));
  }
  if (mesh.family == NodeFamily::gauss_lobatto && mesh.order >= 3) {
    usage("output " + path + ": Gauss-Lobatto nodes cannot be written there from order 3 on, use --nodes equispaced");
  }
}

void run_mesh(MeshCommand& c, Common& common) {
  const Stopwatch total;
  c.options.mesh.family = c.nodes == "equispaced" ? NodeFamily::equispaced : NodeFamily::gauss_lobatto;
  if (c.layers > 0) {
    WallLayers layers;
    layers.layers = c.layers;
    layers.growth = c.growth.value_or(layers.growth);
    if (c.first_layer) {
      read_first_layer(*c.first_layer, layers);
    }
    c.options.grading.layers = layers;
  } else if (c.first_layer || c.growth) {
    usage(std::string(c.first_layer ? "--first-layer" : "--growth") + ": there are no layers; give --layers too");
  }
  for (const std::string& s : c.sheets) {
    c.options.grading.requests.push_back(read_sheet(s));
  }
  c.options.grading.elements = c.elements.value_or(default_elements(c));
  if (c.outputs.empty()) {
    usage("an output is needed: -o MESH.msh or -o MESH.vtu");
  }
  for (const std::string& output : c.outputs) {
    check_output(output, c.options.mesh);
  }
  std::vector<std::string> files = c.outputs;
  if (!c.json.empty()) {
    files.push_back(c.json);
  }
  check_outputs(c.input.files(), files);
  const Run run = common.run();
  Stopwatch reading;
  const Loaded loaded = load(c.input, run);
  const double read_seconds = reading.seconds();
  SkeletonMesh m = cli::mesh(c.input, loaded, c.options, run);
  const HexMesh& mesh = m.result.mesh;
  Stopwatch certifying;
  const QualityReport quality = measure_quality(mesh, run);
  const double certify_seconds = certifying.seconds();
  Stopwatch writing;
  for (const std::string& output : c.outputs) {
    if (lower_extension(output) == ".msh") {
      write_msh(mesh, output, run);
    } else {
      const CellScalars scalars[]{{"scaled_jacobian", quality.element_scaled_jacobian}};
      write_vtu(mesh, output, scalars, run);
    }
  }
  const double write_seconds = writing.seconds();
  common.end_progress();
  if (!common.quiet) {
    std::fprintf(stderr, "%s", findings_summary(m.findings, c.options.repair).c_str());
  }
  const NetworkCounts counts = count(m.network);
  const std::vector<FailedPlace> failed = failed_places(m.network, m.findings, mesh, quality);
  if (!c.json.empty()) {
    nlohmann::ordered_json j;
    j["vasohex"] = VASOHEX_VERSION;
    j["input"] = c.input.path;
    if (loaded.lumen) {
      j["lumen"] = *loaded.figures;
    }
    j["units"] = mesh.units;
    j["blocks"] = m.blocks.blocks.size();
    j["elements"] = mesh.element_count();
    j["nodes"] = mesh.nodes.size();
    j["order"] = mesh.order;
    j["components"] = counts.components;
    j["loops"] = counts.loops;
    auto& junctions = j["junctions"] = nlohmann::ordered_json::array();
    for (const BlockStructure::Junction& k : m.blocks.junctions) {
      junctions.push_back({{"node", m.network.nodes[k.node].point},
                           {"at", xyz(m.network.nodes[k.node].position)},
                           {"degree", k.degree},
                           {"prototype", k.prototype},
                           {"sj_min", k.min_jacobian},
                           {"certified", k.certified},
                           {"candidates", k.candidates}});
    }
    j["block_certificate"] = {{"certified", m.blocks.certified}, {"scaled_jacobian_min", m.blocks.min_jacobian}};
    add_quality(j, quality, &m.network);
    auto& surfaces = j["surfaces"] = nlohmann::ordered_json::array();
    for (std::size_t s = 0; s < mesh.surfaces.size(); ++s) {
      nlohmann::ordered_json row{{"name", mesh.surfaces[s]}, {"id", s + 1}};
      if (s > 0) {
        const SectionFrame& f = m.blocks.ends[s - 1];
        row["centre"] = xyz(f.origin);
        row["normal"] = xyz(f.normal());
        row["radius"] = f.radius;
      }
      surfaces.push_back(row);
    }
    j["volumes"] = {{{"name", mesh.volume}, {"id", mesh.surfaces.size() + 1}}};
    j["wall_residual_max"] = m.result.wall_residual_max;
    j["unconverged_projections"] = m.result.unconverged;
    if (m.result.unconverged > 0) {
      j["unconverged_at"] = xyz(m.result.unconverged_place);
    }
    const RelaxedWall& relaxed = m.result.relaxed;
    j["wall_relaxed"] = {{"nodes", relaxed.nodes}, {"max", relaxed.largest}};
    if (relaxed.nodes > 0) {
      j["wall_relaxed"]["at"] = xyz(relaxed.place);
    }
    if (loaded.lumen) {
      j["reach"] = reach_json(m.reach);
    }
    if (c.options.grading.layers) {
      j["layers"] = {{"first_kept", first_layer_kept(mesh, *m.surface, *c.options.grading.layers)},
                     {"shrunk_lines", m.result.shrunk_lines}};
    }
    j["repairs"] = m.network.repairs;
    j["findings"] = findings_json(m.findings);
    auto& not_certified = j["not_certified"] = nlohmann::ordered_json::array();
    for (const FailedPlace& f : failed) {
      nlohmann::ordered_json row{
          {f.place < 0 ? "junction" : "branch", f.place < 0 ? m.network.nodes[-1 - f.place].point : f.place},
          {"at", xyz(f.at)},
          {"elements", f.elements},
          {"scaled_jacobian", f.scaled_jacobian},
          {"text", f.text},
          {"reason", f.reason},
          {"cure", f.cure}};
      if (f.finding >= 0) {
        row["finding"] = f.finding;
      }
      not_certified.push_back(row);
    }
    j["seconds"] = {{"read", read_seconds},
                    {"surface", m.seconds["surface"]},
                    {"blocks", m.seconds["blocks"] - m.blocks.optimise_seconds},
                    {"optimise", m.blocks.optimise_seconds},
                    {"mesh", m.seconds["mesh"]},
                    {"certify", certify_seconds},
                    {"write", write_seconds},
                    {"total", total.seconds()}};
    if (loaded.lumen) {
      j["seconds"]["reach"] = m.seconds["reach"];
    }
    write_json(j, c.json);
  }
  if (!common.quiet) {
    for (const std::string& repair : m.network.repairs) {
      std::printf("%s\n", repair.c_str());
    }
    std::printf("%s: %d component(s), %d loop(s), %d junction(s), %d end(s); unit %s\n", c.input.path.c_str(),
                counts.components, counts.loops, counts.junctions, counts.ends,
                mesh.units.empty() ? "not stated" : mesh.units.c_str());
    std::printf("  %zu blocks, %d hexahedra of order %d, %zu nodes\n", m.blocks.blocks.size(), mesh.element_count(),
                mesh.order, mesh.nodes.size());
    std::printf("%s", quality_text(quality).c_str());
    for (const FailedPlace& f : failed) {
      std::printf("  not certified: %s\n    most likely: %s\n    what helps: %s\n", f.text.c_str(), f.reason.c_str(),
                  f.cure.c_str());
    }
    if (m.blocks.certified == static_cast<int>(m.blocks.blocks.size())) {
      std::printf(
          "  all blocks are certified: before projection onto the surface, so is every mesh of order >= %d made "
          "from them\n",
          m.blocks.degree);
    }
    if (m.result.unconverged > 0) {
      std::printf("  warning: %d wall nodes could not be projected onto the surface, first at %s\n",
                  m.result.unconverged, short_text(m.result.unconverged_place).c_str());
    }
    if (m.result.relaxed.nodes > 0) {
      std::printf("  %d wall nodes stay off the surface so that elements do not fold, by up to %.3f radii, at %s\n",
                  m.result.relaxed.nodes, m.result.relaxed.largest, short_text(m.result.relaxed.place).c_str());
    }
    std::printf("%s", reach_text(m.reach).c_str());
    if (loaded.figures->contains("winding_number") && (*loaded.figures)["winding_number"]["contradictions"] > 0) {
      const auto& at = (*loaded.figures)["winding_number"]["at"];
      std::printf(
          "  warning: the winding number contradicts the orientation of the lumen's wall, as at %s: sheets "
          "overlap or are turned\n",
          short_text(Vec3(at[0], at[1], at[2])).c_str());
    }
    if (m.result.shrunk_lines > 0) {
      std::printf("  warning: the layers do not fit on %d lines towards the wall and were made thinner there\n",
                  m.result.shrunk_lines);
    }
    for (const std::string& output : c.outputs) {
      std::printf("  written %s\n", output.c_str());
    }
    std::printf("  %.2f s\n", total.seconds());
  }
  if (quality.invalid + quality.undecided > 0) {
    common.exit_code = invalid_elements;
  }
}

}  // namespace

void add_mesh_command(CLI::App& app, Common& common) {
  CLI::App* command =
      app.add_subcommand("mesh", "Skeleton, surface or labelmap in, certified hexahedra of order p out");
  auto c = std::make_shared<MeshCommand>();
  c->input.add_to(*command);
  command->add_option("-o,--output", c->outputs, "Mesh file: .msh (Gmsh 4.1) or .vtu; may be given several times");
  command->add_option("-p,--order", c->options.mesh.order, "Polynomial order")
      ->check(whole_number(1))
      ->capture_default_str();
  command->add_option("-n,--elements", c->elements, "Elements per block edge")
      ->check(whole_number(1))
      ->default_str("6; linear ones in a triangulated lumen 10");
  command->add_option("--radial", c->options.grading.radial, "Elements from the core to the wall")
      ->check(whole_number(1));
  command->add_option("--axial", c->options.grading.axial, "Elements along each block of a vessel")
      ->check(whole_number(1));
  command->add_option("--core", c->options.grading.core, "Elements across the core: a quarter of the circumference")
      ->check(whole_number(1));
  command->add_option("--sheet", c->sheets, "NAME=COUNT: elements of one sheet of block edges");
  command->add_option("--layers", c->layers, "Layers of elements along the wall; 0: none")
      ->check(whole_number(0))
      ->capture_default_str();
  command
      ->add_option("--first-layer", c->first_layer,
                   "Height of the layer at the wall: 0.02r (local radii) or 0.1 (unit)")
      ->default_str("0.05r");
  command->add_option("--growth", c->growth, "Height of each layer over that before it")
      ->check(positive_number())
      ->default_str("1.2");
  command->add_option("--nodes", c->nodes, "Nodes within an element")
      ->check(CLI::IsMember({"equispaced", "gauss_lobatto"}))
      ->capture_default_str();
  Input::add_repair(*command, c->options);
  command->add_option("--block-length", c->options.blocks.block_length, "Length of a branch's blocks, in local radii")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--json", c->json, "File for the figures");
  common.add_to(*command, [c, &common] { run_mesh(*c, common); });
}

}  // namespace vasohex::cli
