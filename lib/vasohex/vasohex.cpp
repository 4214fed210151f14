#include "vasohex/vasohex.h"

#include <chrono>

namespace vasohex {

SkeletonMesh mesh_skeleton(const Skeleton& skeleton, const SkeletonMeshOptions& options, const Run& run) {
  using Clock = std::chrono::steady_clock;
  SkeletonMesh out;
  auto before = Clock::now();
  const auto lap = [&](const char* stage) {
    const auto now = Clock::now();
    out.seconds[stage] = std::chrono::duration<double>(now - before).count();
    before = now;
  };
  out.network = build_network(skeleton, options.network, run);
  clear_ends(out.network);
  out.surface = make_convolution_surface(out.network, options.surface, run);
  lap("surface");
  out.blocks = build_blocks(out.network, *out.surface, options.blocks, run);
  lap("blocks");
  const BlockTopology topology = build_topology(out.blocks.vertex_count, out.blocks.blocks);
  out.sheets = grade(out.blocks, topology, options.grading);
  out.result = generate_mesh(out.blocks, topology, out.sheets, *out.surface, options.mesh, run);
  lap("mesh");
  return out;
}

}  // namespace vasohex
