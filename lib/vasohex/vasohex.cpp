#include "vasohex/vasohex.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "vasohex/blocks/clear_ends.h"
#include "vasohex/blocks/move_blocks.h"
#include "vasohex/core/short_text.h"
#include "vasohex/mesh/move_mesh.h"
#include "vasohex/skeleton/own_frame.h"
#include "vasohex/skeleton/repair.h"
#include "vasohex/skeleton/tie_ends.h"
#include "vasohex/surface/moved_surface.h"
#include "vasohex/surface/project.h"

namespace vasohex {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Blocks and mesh of a network that lies in `frame`, and their way out of it.
void mesh_network(const Network& network, const OwnFrame& frame, const ImplicitSurface& surface,
                  const SkeletonMeshOptions& options, const Run& run, SkeletonMesh& out) {
  const Clock::time_point start = Clock::now();
  BlockOptions block_options = options.blocks;
  const Grading& g = options.grading;
  const bool equal_parts = !g.radial && !g.axial && !g.core && !g.layers && g.requests.empty();
  if (block_options.mesh.order == 0 && equal_parts) {
    block_options.mesh = {options.mesh.order, g.elements};
  }
  out.blocks = build_blocks(network, surface, block_options, run);
  out.seconds["blocks"] = seconds_since(start);
  const Clock::time_point meshing = Clock::now();
  const BlockTopology topology = build_topology(out.blocks.vertex_count, out.blocks.blocks);
  out.sheets = grade(out.blocks, topology, in_frame(options.grading, frame));
  out.result = generate_mesh(out.blocks, topology, out.sheets, surface, options.mesh, run);
  move_outward(out.blocks, frame);
  move_outward(out.result, frame);
  out.seconds["mesh"] = seconds_since(meshing);
}

/// Points of the network's ends where the lumen has none and its wall closes ahead: not more than 2.5 radii away.
std::set<int> blind_ends(const Network& network, const ImplicitSurface& surface, const std::vector<int>& tied,
                         std::vector<std::string>& notes) {
  std::set<int> blind;
  for (const Branch& branch : network.branches) {
    for (int side = 0; side < 2; ++side) {
      const NetworkNode& node = network.nodes[branch.nodes[side]];
      if (node.degree != 1 || std::find(tied.begin(), tied.end(), node.point) != tied.end()) {
        continue;
      }
      const Vec3 ahead = side == 0 ? Vec3(-branch.tangents.front()) : branch.tangents.back();
      const bool closes = shoot(surface, node.position, ahead, node.radius, 2.5 * node.radius).has_value();
      const std::string place = "point " + std::to_string(node.point) + " " + short_text(node.position);
      notes.push_back(
          "note: the skeleton ends at " + place + ", where the lumen has no end: " +
          (closes ? "the vessel closes there, which is meshed without a cap" : "the mesh ends there in a flat cap"));
      if (closes) {
        blind.insert(node.point);
      }
    }
  }
  return blind;
}

}  // namespace

SkeletonMesh mesh_skeleton(const Skeleton& skeleton, const SkeletonMeshOptions& options, const Run& run) {
  const Clock::time_point start = Clock::now();
  SkeletonMesh out;
  out.network = options.repair ? build_repaired_network(skeleton, options.network, run)
                               : build_network(skeleton, options.network, run);
  out.findings = diagnose(out.network);
  clear_ends(out.network);
  // The rest is done in the network's own frame: the same to the last bit wherever the network lies.
  const OwnFrame frame = own_frame(out.network);
  const Network network = in_frame(out.network, frame);
  const std::shared_ptr<const ImplicitSurface> surface = make_convolution_surface(network, options.surface, run);
  out.surface = std::make_shared<MovedSurface>(surface, frame);
  out.seconds["surface"] = seconds_since(start);
  mesh_network(network, frame, *surface, options, run, out);
  return out;
}

SkeletonMesh mesh_lumen(const Skeleton& skeleton, const Lumen& lumen, const SkeletonMeshOptions& options,
                        const Run& run) {
  const Clock::time_point start = Clock::now();
  SkeletonMesh out;
  Skeleton tied = skeleton;
  std::vector<std::string> notes;
  const std::vector<int> end_points = tie_ends(tied, lumen.ends, notes);
  out.network = build_network(tied, options.network, run);
  out.surface = lumen.surface(out.network);
  NetworkOptions network_options = options.network;
  network_options.blind = blind_ends(out.network, *out.surface, end_points, notes);
  if (!network_options.blind.empty()) {
    out.network = build_network(tied, network_options, run);
  }
  out.network.repairs.insert(out.network.repairs.begin(), notes.begin(), notes.end());
  face_ends(out.network, lumen.ends, end_points);
  out.findings = diagnose(out.network);
  std::erase_if(out.findings, [&](const Finding& f) {  // where the lumen is cut, a vessel ends
    return f.kind == FindingKind::stub &&
           std::find(end_points.begin(), end_points.end(), f.point) != end_points.end();
  });
  const OwnFrame frame = own_frame(out.network);
  const MovedSurface surface(out.surface, frame.inverse());
  out.seconds["surface"] = seconds_since(start);
  mesh_network(in_frame(out.network, frame), frame, surface, options, run, out);
  if (lumen.wall) {
    const Clock::time_point measuring = Clock::now();
    out.reach = measure_reach(out.result.mesh, lumen.wall(*out.surface), lumen.ends, *out.surface, run);
    out.seconds["reach"] = seconds_since(measuring);
  }
  return out;
}

}  // namespace vasohex
