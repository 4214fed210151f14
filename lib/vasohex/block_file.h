#pragma once
/// \file The block file: a few numbers from which any mesh of a network can be made anywhere.

#include <string>

#include "vasohex/vasohex.h"

namespace vasohex {

/// What meshes of a skeleton's network are made of, whatever their order, grading and nodes.
struct BlockFile {
  Network network;  ///< without its repairs; the surface is that of this network
  ConvolutionOptions surface;
  BlockStructure blocks;
  Grading grading;  ///< unless another one is asked for
};

/// Of a mesh that was made: of its network, blocks and options.
BlockFile block_file(const SkeletonMesh& mesh, const SkeletonMeshOptions& options);

/// Writes JSON; every number reads back to the same bits. Durations (optimise_seconds, cpu_seconds) and the network's
/// repairs are left out, so equal inputs give equal bytes. The file is complete or not there. Error bad_input if it
/// cannot be written, or a law is the user's own function.
void write_block_file(const BlockFile& file, const std::string& path);

/// Error bad_input that names file, place, what is wrong and what would be right: not JSON, another format, missing
/// or wrong values, blocks that do not conform, a boundary that is not theirs.
BlockFile read_block_file(const std::string& path);

/// The surface of the network, in the frame of the file.
std::unique_ptr<ImplicitSurface> make_surface(const BlockFile& file, const Run& run = {});

/// The mesh of the blocks, as mesh_skeleton makes it: to rounding (1e-13 radii), since the blocks were moved out of
/// the network's own frame and back.
MeshResult mesh_blocks(const BlockFile& file, const Grading& grading, const MeshOptions& options,
                       const Run& run = {});

}  // namespace vasohex
