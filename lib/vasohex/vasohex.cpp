#include "vasohex/vasohex.h"

#include <chrono>

#include "vasohex/skeleton/own_frame.h"
#include "vasohex/skeleton/repair.h"
#include "vasohex/surface/moved_surface.h"

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
  out.network = options.repair ? build_repaired_network(skeleton, options.network, run)
                               : build_network(skeleton, options.network, run);
  out.findings = diagnose(out.network);
  clear_ends(out.network);
  // The rest is done in the network's own frame: the same to the last bit wherever the network lies.
  const OwnFrame frame = own_frame(out.network);
  const Network network = in_frame(out.network, frame);
  std::unique_ptr<ImplicitSurface> surface = make_convolution_surface(network, options.surface, run);
  lap("surface");
  BlockOptions block_options = options.blocks;
  const Grading& g = options.grading;
  const bool equal_parts = !g.radial && !g.axial && !g.core && !g.layers && g.requests.empty();
  if (block_options.mesh.order == 0 && equal_parts) {
    block_options.mesh = {options.mesh.order, g.elements};
  }
  out.blocks = build_blocks(network, *surface, block_options, run);
  lap("blocks");
  const BlockTopology topology = build_topology(out.blocks.vertex_count, out.blocks.blocks);
  Grading grading = options.grading;
  if (grading.layers && !grading.layers->relative) {
    grading.layers->first_height /= frame.scale;
  }
  out.sheets = grade(out.blocks, topology, grading);
  out.result = generate_mesh(out.blocks, topology, out.sheets, *surface, options.mesh, run);
  for (std::vector<Vec3>* nodes : {&out.blocks.nodes, &out.result.mesh.nodes}) {
    for (Vec3& p : *nodes) {
      p = frame.outward(p);
    }
  }
  for (std::vector<Stretch>& region : out.blocks.regions) {
    for (Stretch& stretch : region) {
      stretch.from *= frame.scale;
      stretch.to *= frame.scale;
    }
  }
  for (SectionFrame& end : out.blocks.ends) {
    end = {frame.outward(end.origin), frame.rotation * end.x, frame.rotation * end.y, frame.scale * end.radius};
  }
  out.surface = std::make_unique<MovedSurface>(std::move(surface), frame);
  lap("mesh");
  return out;
}

}  // namespace vasohex
