#pragma once
/// \file The whole way from a skeleton, or a lumen and its skeleton, to a mesh, stage by stage.

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "vasohex/blocks/build_blocks.h"
#include "vasohex/grading/sheets.h"
#include "vasohex/mesh/generate_mesh.h"
#include "vasohex/mesh/wall_reach.h"
#include "vasohex/skeleton/build_network.h"
#include "vasohex/skeleton/diagnose.h"
#include "vasohex/surface/convolution.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

struct SkeletonMeshOptions {
  NetworkOptions network;
  bool repair = false;  ///< as build_repaired_network: vessels that overlap are parted, stray pieces left out
  ConvolutionOptions surface;
  BlockOptions blocks;
  Grading grading;
  MeshOptions mesh;
};

/// What each stage made, for whoever wants more than the mesh.
struct SkeletonMesh {
  Network network;
  std::vector<Finding> findings;  ///< what diagnose says of the network that was meshed
  std::shared_ptr<const ImplicitSurface> surface;
  BlockStructure blocks;
  Sheets sheets;
  MeshResult result;
  WallReach reach;  ///< of a given lumen's wall
  std::map<std::string, double> seconds;  ///< wall time of `surface`, `blocks`, `mesh`; of a given lumen `reach`
};

/// Cleans and smooths the skeleton, wraps it in a convolution surface, builds and optimises blocks, grades and
/// meshes. The mesh may hold invalid elements: measure_quality tells. Errors as of the stages.
SkeletonMesh mesh_skeleton(const Skeleton& skeleton, const SkeletonMeshOptions& options = {}, const Run& run = {});

/// A lumen that a mesh conforms to.
struct Lumen {
  std::vector<SurfaceEnd> ends;
  /// Makes its surface; the network tells where the axes are and how wide the vessels are around them.
  std::function<std::shared_ptr<const ImplicitSurface>(const Network& network)> surface;
  /// Points spread over its wall, given its surface; if there are such, SkeletonMesh::reach is measured by them.
  std::function<std::vector<Vec3>(const ImplicitSurface& surface)> wall;
};

/// The same for a given lumen: the skeleton, led to the lumen's ends (tie_ends), says how the vessels run, and the
/// blocks conform to the lumen's surface. options.surface and options.repair are not used.
SkeletonMesh mesh_lumen(const Skeleton& skeleton, const Lumen& lumen, const SkeletonMeshOptions& options = {},
                        const Run& run = {});

}  // namespace vasohex
