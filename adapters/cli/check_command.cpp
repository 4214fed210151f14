#include <cstdio>
#include <memory>

#include "commands.h"
#include "option_checks.h"
#include "report.h"
#ifdef VASOHEX_HAS_GMSH
#include "gmsh/read_msh.h"
#endif

namespace vasohex::cli {
namespace {

struct CheckCommand {
  std::string path, json;
};

void run_check(const CheckCommand& c, Common& common) {
#ifdef VASOHEX_HAS_GMSH
  if (!c.json.empty()) {
    check_outputs({c.path}, {c.json});
  }
  const Run run = common.run();
  const HexMesh mesh = read_msh(c.path, run);
  const QualityReport quality = measure_quality(mesh, run);
  common.end_progress();
  if (!c.json.empty()) {
    nlohmann::ordered_json j;
    j["input"] = c.path;
    j["elements"] = mesh.element_count();
    j["nodes"] = mesh.nodes.size();
    j["order"] = mesh.order;
    j["surfaces"] = mesh.surfaces;
    add_quality(j, quality);
    write_json(j, c.json);
  }
  if (!common.quiet) {
    std::printf("%s: %d hexahedra of order %d, %zu nodes\n%s", c.path.c_str(), mesh.element_count(), mesh.order,
                mesh.nodes.size(), quality_text(quality).c_str());
  }
  if (quality.invalid + quality.undecided > 0) {
    common.exit_code = invalid_elements;
  }
#else
  (void)common;
  throw Error(ErrorCode::bad_input, c.path +
                                        ": this program was built without Gmsh, which reads MSH; configure with "
                                        "-DVASOHEX_GMSH=ON");
#endif
}

}  // namespace

void add_check_command(CLI::App& app, Common& common) {
  CLI::App* command = app.add_subcommand("check", "Quality and certificate of any hexahedral MSH file");
  auto c = std::make_shared<CheckCommand>();
  command->add_option("MESH", c->path, "MSH file of complete hexahedra")->required();
  command->add_option("--json", c->json, "File for the figures");
  common.add_to(*command, [c, &common] { run_check(*c, common); });
}

}  // namespace vasohex::cli
