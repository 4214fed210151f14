#pragma once
/// \file The cube prototype of a junction [Bošnjak & Fries]: an inner cube, six frusta around it; a branch replaces
/// the frustum of its side by five blocks that end in an O-grid. Junctions close to each other are linked cube to
/// cube.

#include <array>
#include <string>
#include <vector>

#include "vasohex/blocks/arm_axis.h"
#include "vasohex/blocks/block_kinds.h"
#include "vasohex/blocks/optimise.h"
#include "vasohex/skeleton/network.h"

namespace vasohex {

/// A branch at a junction: it either ends in a cap, a cross-section `cap` away along its axis, or leads to another
/// hub.
struct Arm {
  int branch = 0;
  int end = 0;                     ///< 0: the branch starts at the hub, 1: it ends there
  int link = -1;                   ///< hub of the same cluster at the other end, or -1
  double cap = 0;                  ///< arc length from the hub to the cap; of a link: the branch's length
  bool at_end = false;             ///< the cap is an end of the network
  Vec3 direction = Vec3::UnitX();  ///< unit, from the hub along the axis
  double radius = 1;               ///< of the branch at the cap
  ArmAxis axis;                    ///< from the hub to the cap, or to the other hub
  SectionFrame section;            ///< at the cap, normal away from the hub; its turn is chosen by the cube
};

/// One junction.
struct Hub {
  int node = 0;  ///< of the network
  Vec3 centre = Vec3::Zero();  ///< of its cube: the node, or further on if branches run side by side from there
  std::vector<Arm> arms;
};

/// Where an arm leads: from the start of its axis to 2.5 radii further on, or to its end.
Vec3 direction_of(const Arm& arm);

/// Distance from a junction's centre at which arm i is free of the others: max(0.3 r_i, max_j t_ij) + 0.5 r_i,
/// t_ij = (r_j + r_i cos) / sin of the angle between them (at most r_j beyond a right angle), radii widened by the
/// blend.
double cap_distance(const std::vector<Vec3>& directions, const std::vector<double>& radii, int i);

/// Which face of the cube each arm takes (faces as in reference_hex.h), and the cube's turn.
struct CubeAssignment {
  std::vector<int> face;  ///< [arms]
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double cost = 0;  ///< sum of squared angles between faces and arms + the largest squared
};

/// The best assignments of 1 to 6 arms, best first, at most `count`; those that a rotation of the cube or a symmetry
/// of the arms maps onto each other count once.
std::vector<CubeAssignment> cube_assignments(const std::vector<Vec3>& directions, int count);

/// A cluster of linked hubs as a problem for the optimiser, and what its blocks are.
struct ClusterBlocks {
  struct Cap {
    int hub = 0, arm = 0;
    SectionFrame frame;           ///< turned to the cube
    std::array<int, 4> inner{};   ///< local vertices in0..in3 of the section
    std::array<int, 4> outer{};   ///< ou0..ou3
    std::array<int, 5> blocks{};  ///< whose face 5 (k = 1) is quad 0..4 of the section
  };
  BlockProblem problem;
  std::vector<DirectionKinds> kinds;  ///< [blocks]
  std::vector<int> block_hub;         ///< [blocks] hub it belongs to
  std::vector<Cap> caps;
};

/// \param assignments one per hub.
ClusterBlocks cluster_blocks(const ImplicitSurface& surface, const std::vector<Hub>& hubs,
                             const std::vector<CubeAssignment>& assignments);

}  // namespace vasohex
