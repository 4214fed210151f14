#pragma once
/// \file One rank's part of a mesh, made from the block file without the rest.

#include <cstdint>
#include <vector>

#include "vasohex/block_file.h"

namespace vasohex {

/// The elements of one rank, and those of others that share a vertex with them. The elements of the whole mesh, in
/// their order, are dealt out in contiguous ranges of equal size.
struct MeshPart {
  MeshResult result;              ///< its figures are of all blocks that had to be looked at
  std::vector<std::int64_t> ids;  ///< [elements] index in the whole mesh, ascending
  std::vector<int> owner;         ///< [elements] rank
  std::int64_t total = 0;         ///< elements of the whole mesh
};

/// Rank that owns element `i` of `count`.
constexpr int owner_of(std::int64_t i, std::int64_t count, int ranks) {
  return static_cast<int>(((i + 1) * ranks - 1) / count);
}

/// Makes the blocks that hold this rank's elements, their neighbours, and the neighbours of those: only then every
/// node of a neighbour is made by the same block as in the whole mesh, and the parts fit to the last bit. Throws
/// Error(bad_input) as grade and generate_mesh do, and if there are more ranks than elements.
MeshPart mesh_part(const BlockFile& file, const Grading& grading, const MeshOptions& options, int rank, int ranks,
                   const Run& run = {});

}  // namespace vasohex
