#pragma once
/// \file The blocks of a whole network as curved polynomials, and what bounds them.

#include <array>
#include <string>
#include <vector>

#include "vasohex/blocks/block_kinds.h"
#include "vasohex/blocks/cross_section.h"
#include "vasohex/core/vec3.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// Right-handed hexahedral blocks on [0,1]^3, conforming. Their geometry is the tensor polynomial of degree `degree`
/// through control points at the Gauss-Lobatto nodes; neighbours share those of their faces.
struct BlockStructure {
  struct BoundaryFace {
    int block = 0;
    int face = 0;     ///< as in reference_hex.h
    int surface = 0;  ///< index into `surfaces`; 0 is the wall
  };
  struct Junction {
    int node = 0;             ///< of the network
    int degree = 0;           ///< of the junction
    std::string prototype;    ///< `cube`, `tree of cubes`, or `cubes linked` in a cluster of junctions
    double min_jacobian = 0;  ///< least scaled Jacobian of the cluster: BlockSolution
    bool certified = false;
    int candidates = 0;      ///< assignments tried
    double cpu_seconds = 0;  ///< processor time of the cluster, shared equally among its junctions
  };
  int degree = 0;
  int vertex_count = 0;
  std::vector<std::array<int, 8>> blocks;  ///< vertices, i fastest
  std::vector<Vec3> nodes;                 ///< control points
  std::vector<int> block_nodes;            ///< [blocks][(degree + 1)^3], i fastest
  std::vector<DirectionKinds> kinds;       ///< [blocks]
  std::vector<int> places;                 ///< [blocks] branch of the network, or -1 - node for a junction's blocks
  std::vector<std::vector<Stretch>> regions;  ///< of the network: their surface is what walls of blocks follow
  std::vector<int> block_region;              ///< [blocks]
  std::vector<BoundaryFace> boundary;      ///< every face of one block, once
  std::vector<std::string> surfaces;       ///< `wall`, inlets, outlets
  std::vector<SectionFrame> ends;          ///< of surfaces[1 + i], normal outward
  std::vector<Junction> junctions;
  double min_jacobian = 1;      ///< least scaled Jacobian of all blocks on lattices of 9^3 points
  int certified = 0;            ///< blocks whose Jacobian determinant is proven positive everywhere
  double optimise_seconds = 0;  ///< wall time of the junctions
  std::string units;
};

}  // namespace vasohex
