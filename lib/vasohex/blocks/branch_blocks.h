#pragma once
/// \file The blocks of one branch: stations along its axis, frames, control points.

#include <vector>

#include "vasohex/blocks/cross_section.h"
#include "vasohex/blocks/optimise.h"
#include "vasohex/skeleton/network.h"

namespace vasohex {

/// Blocks of one branch between its caps or ends, before they have global vertices.
struct BranchPiece {
  int branch = 0;
  bool closed = false;
  std::vector<double> stations;
  int quarter_turns = 0;             ///< corner j at the end is corner j + quarter_turns of what lies there
  std::vector<SectionFrame> frames;  ///< [kBlockDegree * blocks + 1] at the Gauss-Lobatto points of the stations
  std::vector<Vec3> nodes;           ///< [5 blocks][kLine^3], quad by quad, station by station
};

/// Where blocks of the branch between arc lengths s0 and s1 meet: about block_length radii apart, closer in bends.
std::vector<double> stations(const Branch& branch, double s0, double s1, double block_length, int at_least);

/// Frames along the piece: transported without rotation, turned so that the corners meet those of `first` and `last`
/// (frames of what lies at the ends, seen along the branch; null: nothing), the least turn spread evenly.
void place_frames(const Branch& branch, const SectionFrame* first, const SectionFrame* last, BranchPiece& piece);

/// The control points of the piece's blocks, from its frames.
void fill_nodes(const ImplicitSurface& surface, BranchPiece& piece);

/// Where vessels are not round: a station more within each layer of at least a radius whose wall the surface leaves by
/// more than a twentieth of the local radius. True if there are any: frames and control points are to be made anew.
bool halve_rough_layers(const Branch& branch, const ImplicitSurface& surface, BranchPiece& piece);

/// Improves runs of layers whose blocks are weak (not certified, or of a scaled Jacobian below `good` in the mesh asked
/// for), with the cross-sections around them fixed; where that does not make them valid, in shorter runs.
void optimise_weak_layers(const Branch& branch, const ImplicitSurface& surface, const MeshDivision& mesh, double good,
                          BranchPiece& piece);

}  // namespace vasohex
