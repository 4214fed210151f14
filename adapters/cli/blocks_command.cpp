#include <cstdio>
#include <memory>

#include "commands.h"
#include "findings.h"
#include "input.h"
#include "option_checks.h"
#include "report.h"
#include "vasohex/block_file.h"
#include "vasohex/core/text_lines.h"
#include "vtk/write_vtu.h"

namespace vasohex::cli {
namespace {

struct BlocksCommand {
  Input input;
  SkeletonMeshOptions options;
  std::vector<std::string> outputs;
};

void run_blocks(BlocksCommand& c, Common& common) {
  if (c.outputs.empty()) {
    usage("an output is needed: -o BLOCKS.vtu or -o BLOCKS.json");
  }
  for (const std::string& output : c.outputs) {
    const std::string ext = lower_extension(output);
    if (ext != ".json" && ext != ".vtu") {
      usage("output " + output + ": unknown extension '" + ext + "', use .vtu or .json");
    }
    if (ext == ".json" && c.input.has_lumen()) {
      usage("output " + output + ": a block file has no surface but the network's, which a given lumen is not; use .vtu");
    }
  }
  check_outputs(c.input.files(), c.outputs);
  const Run run = common.run();
  const Loaded loaded = load(c.input, run);
  // one element of the blocks' own degree each: what a viewer can show of them
  c.options.grading.elements = 1;
  c.options.mesh.order = 4;
  const SkeletonMesh m = mesh(c.input, loaded, c.options, run);
  common.end_progress();
  if (!common.quiet) {
    std::fprintf(stderr, "%s", findings_summary(m.findings, c.options.repair).c_str());
  }
  for (const std::string& output : c.outputs) {
    if (lower_extension(output) == ".json") {
      BlockFile file = block_file(m, c.options);
      file.grading = {};
      write_block_file(file, output);
    } else {
      const std::vector<double> quality = measure_quality(m.result.mesh, run).element_scaled_jacobian;
      const CellScalars scalars[]{{"scaled_jacobian", quality}};
      write_vtu(m.result.mesh, output, scalars, run);
    }
  }
  const int count = static_cast<int>(m.blocks.blocks.size());
  if (!common.quiet) {
    for (const std::string& repair : m.network.repairs) {
      std::printf("%s\n", repair.c_str());
    }
    std::printf("%s: %d blocks of degree %d, %d certified, least scaled Jacobian %.3f\n", c.input.path.c_str(), count,
                m.blocks.degree, m.blocks.certified, m.blocks.min_jacobian);
    std::printf("  sheets:");
    for (const Sheet& s : m.sheets.sheets) {
      std::printf(" %s", s.name.c_str());
    }
    std::printf("\n");
    for (const BlockStructure::Junction& k : m.blocks.junctions) {
      std::printf("  junction at point %d: %d branches, %s, least scaled Jacobian %.3f, %s\n",
                  m.network.nodes[k.node].point, k.degree, k.prototype.c_str(), k.min_jacobian,
                  k.certified ? "certified" : "not certified");
    }
    for (const std::string& output : c.outputs) {
      std::printf("  written %s\n", output.c_str());
    }
  }
  if (m.blocks.certified < count) {
    common.exit_code = invalid_elements;
  }
}

}  // namespace

void add_blocks_command(CLI::App& app, Common& common) {
  CLI::App* command = app.add_subcommand("blocks", "The block structure of a skeleton's network");
  auto c = std::make_shared<BlocksCommand>();
  c->input.add_to(*command);
  command->add_option("-o,--output", c->outputs,
                      "Block file: .vtu (to look at) or .json; may be given several times");
  Input::add_repair(*command, c->options);
  command->add_option("--block-length", c->options.blocks.block_length, "Length of a branch's blocks, in local radii")
      ->check(positive_number())
      ->capture_default_str();
  common.add_to(*command, [c, &common] { run_blocks(*c, common); });
}

}  // namespace vasohex::cli
