#pragma once
/// \file Polynomial blocks between fixed cross-sections and a wall, moved until they are valid and well shaped.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "vasohex/blocks/cross_section.h"
#include "vasohex/core/vec3.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// Degree of the blocks' polynomials; their control points are the values at the Gauss-Lobatto nodes.
inline constexpr int kBlockDegree = 4;
inline constexpr int kBlockNodes = (kBlockDegree + 1) * (kBlockDegree + 1) * (kBlockDegree + 1);

/// The mesh that blocks are for: `elements` per block edge, equal parts, of this order. Order 0: the blocks
/// themselves.
struct MeshDivision {
  int order = 0;
  int elements = 0;
};

/// Blocks to optimise. Faces of one block are wall unless they are listed in `sections`.
struct BlockProblem {
  /// A face that stays a cross-section. On face 4 or 5 (k = 0 or 1) the quad's (u, v) are the block's (i, j).
  struct Section {
    int block = 0;
    int face = 5;
    int quad = 0;
    SectionFrame frame;
    bool slides = false;  ///< nothing is behind it: its nodes move in its plane, those of the rim along the rim
  };
  /// Where the rays that place a block's wall nodes at the start come from: the nearest point of `axis`; from
  /// `centre` where blocks of several axes meet or the axis is empty.
  struct Aim {
    std::vector<Vec3> axis;
    Vec3 centre = Vec3::Zero();
  };
  const ImplicitSurface* surface = nullptr;
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 8>> blocks;
  std::vector<Section> sections;
  std::vector<Aim> aims;
  std::vector<int> block_aim;  ///< [blocks]
  MeshDivision mesh;           ///< what solutions are judged by
  /// While blocks are folded, their wall may move to the other side of a gap between vessels. That unfolds some, and
  /// lays others through the gap onto the wall of the next vessel.
  bool may_change_sides = false;
};

struct BlockSolution {
  std::vector<Vec3> nodes;  ///< [blocks][kBlockNodes] control points, i fastest; shared ones are equal
  /// Least scaled Jacobian of a mesh whose wall is projected: of the elements of problem.mesh where they differ from
  /// the blocks. Never far above that of the blocks themselves and of straight-sided elements.
  double min_jacobian = -1;
  bool certified = false;  ///< every block's Jacobian determinant is positive everywhere (Bernstein bound)

  bool is_better_than(const BlockSolution& other) const {
    return certified != other.certified ? certified : min_jacobian > other.min_jacobian;
  }
};

/// The recipe of docs/design.md: untangle at degree 2, then degrees 2, 3, 4 with rising weight on the worst scaled
/// Jacobian, wall nodes kept on the surface, the wall's distance to the surface punished; then certify.
/// Deterministic.
BlockSolution optimise_blocks(const BlockProblem& problem);

/// The same, or nothing as soon as it looks hopeless: blocks that are still folded, or nearly, when others are not.
std::optional<BlockSolution> try_blocks(const BlockProblem& problem);

/// Blocks that are weak, but not folded, once more with the wall projected as a mesh's will be, until their least
/// scaled Jacobian is `goal` or no longer rises: dearer than a try of other blocks. Returns the best, judged closely.
/// `quick`: the first round looks at half as many samples a direction. It may leave edges whose parameter almost stops.
BlockSolution refine_blocks(const BlockProblem& problem, BlockSolution start, double goal, bool quick);

/// How folded the blocks are before anything moves: a good guess at which of several arrangements will turn out well.
/// With straight edges between the vertices as placed: for a first choice among many.
double straight_energy(const BlockProblem& problem);
/// With the wall nodes on the surface: dearer by far, and better.
double placed_energy(const BlockProblem& problem);

/// Below the blocks' degree a mesh interpolates them, and its elements are worse. A last stage for problem.mesh: the
/// energy sees its elements, the unknowns stay the blocks' control points. Returns `start`, judged by that mesh,
/// where that does not pay (order and number of elements so high that the mesh is as good as its blocks), or where
/// it is not better, or no longer certified.
BlockSolution fit_to_mesh(const BlockProblem& problem, BlockSolution start);

/// Control points [blocks][kBlockNodes] judged as they are: min_jacobian and certificate.
BlockSolution judge_blocks(std::vector<Vec3> nodes, const MeshDivision& mesh);

/// The least scaled Jacobian of blocks alone, on an equispaced lattice of 9^3 points each.
double least_jacobian(const std::vector<Vec3>& nodes);

}  // namespace vasohex
