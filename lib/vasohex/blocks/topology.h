#pragma once
/// \file Which edges and faces hexahedral blocks share, and how lattices of nodes on them are numbered.

#include <array>
#include <vector>

namespace vasohex {

/// Edges and faces of conforming hexahedra, each once. An edge is known by its two vertices, a face by its four.
struct BlockTopology {
  struct EdgeUse {
    int edge = 0;
    bool reversed = false;  ///< the block's edge runs from the greater vertex to the lesser
  };
  /// How the axes (a, b) of a block's face lie in the face's own: first mirror, then swap.
  struct FaceUse {
    int face = 0;
    bool mirror_a = false, mirror_b = false, swapped = false;
  };
  int vertex_count = 0;
  std::vector<std::array<int, 8>> blocks;  ///< vertices, numbered as in reference_hex.h
  std::vector<std::array<int, 2>> edges;   ///< vertices, ascending
  /// Vertices at (0,0), (1,0), (0,1), (1,1) of the face's own axes: it starts at the least vertex, its first axis
  /// leads to the lesser neighbour.
  std::vector<std::array<int, 4>> faces;
  std::vector<std::array<int, 2>> face_edges;  ///< edges along the first and the second axis
  std::vector<std::array<EdgeUse, 12>> block_edges;
  std::vector<std::array<FaceUse, 6>> block_faces;
  std::vector<int> face_block_count;  ///< 1 on the boundary, 2 inside
};

/// Throws Error(internal) if three blocks share a face: the blocks then conform nowhere.
BlockTopology build_topology(int vertex_count, const std::vector<std::array<int, 8>>& blocks);

/// Numbers of lattice nodes: every edge is cut into intervals, opposite edges of a block into equally many. Nodes are
/// owned by vertices, edges, faces, blocks, in this order, and numbered by offset: no search, no tolerance.
class LatticeNumbering {
 public:
  /// \param edge_intervals [edges], >= 1, equal on opposite edges of every block.
  LatticeNumbering(const BlockTopology& topology, std::vector<int> edge_intervals);

  int node_count() const { return node_count_; }
  /// Intervals of block b along i, j, k.
  std::array<int, 3> intervals(int block) const;
  /// Node numbers of the block's lattice, lexicographic, i fastest: [(n0+1) (n1+1) (n2+1)].
  void block_nodes(int block, std::vector<int>& ids) const;

 private:
  const BlockTopology* topology_;
  std::vector<int> edge_intervals_;
  std::vector<int> edge_offset_, face_offset_, block_offset_;
  int node_count_ = 0;
};

}  // namespace vasohex
