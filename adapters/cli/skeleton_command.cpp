#include <cstdio>
#include <memory>

#include "commands.h"
#include "input.h"
#include "option_checks.h"
#include "vasohex/core/text_lines.h"
#include "vasohex/skeleton/write_skeleton.h"
#include "vtk/write_vtp.h"

namespace vasohex::cli {
namespace {

struct SkeletonCommand {
  Input input;
  std::vector<std::string> outputs;
};

void run_skeleton(const SkeletonCommand& c, Common& common) {
  if (c.outputs.empty()) {
    usage("an output is needed: -o SKELETON.json, -o SKELETON.swc or -o SKELETON.vtp");
  }
  for (const std::string& output : c.outputs) {
    const std::string ext = lower_extension(output);
    if (ext != ".json" && ext != ".swc" && ext != ".vtp") {
      usage("output " + output + ": unknown extension '" + ext + "', use .json, .swc or .vtp");
    }
  }
  check_outputs(c.input.files(), c.outputs);
  const Stopwatch total;
  const Loaded loaded = load(c.input, common.run());
  for (const std::string& output : c.outputs) {
    if (lower_extension(output) == ".vtp") {
      write_vtp(loaded.skeleton, output);
    } else {
      write_skeleton(output, loaded.skeleton);
    }
  }
  common.end_progress();
  if (!common.quiet) {
    for (const std::string& repair : loaded.repairs) {
      std::printf("%s\n", repair.c_str());
    }
    std::printf("%s: %zu points, %zu segments\n", c.input.path.c_str(), loaded.skeleton.points.size(),
                loaded.skeleton.segments.size());
    for (const std::string& output : c.outputs) {
      std::printf("  written %s\n", output.c_str());
    }
    std::printf("  %.2f s\n", total.seconds());
  }
}

}  // namespace

void add_skeleton_command(CLI::App& app, Common& common) {
  CLI::App* command = app.add_subcommand("skeleton", "Surface or labelmap in, its skeleton with radii out");
  auto c = std::make_shared<SkeletonCommand>();
  c->input.add_to(*command);
  command->add_option("-o,--output", c->outputs, "Skeleton file: .json, .swc or .vtp; may be given several times");
  common.add_to(*command, [c, &common] { run_skeleton(*c, common); });
}

}  // namespace vasohex::cli
