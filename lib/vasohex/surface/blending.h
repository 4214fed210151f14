#pragma once
/// \file Which parts of a network blend with each other, and where: vessels that only pass stay separate.
///
/// Branches are cut into pieces, so that one which comes near itself does not merge with itself. Pieces that meet at
/// a node or at a cut form a joint: they blend around it with a weight w of 1 within a ball, falling to 0 in a shell
/// around it. Junctions so near each other that their balls meet form one joint: all their pieces blend around all
/// their nodes. With F_c the fields of the pieces, the field of the network is
///     max over joints of ((1 - w) max_c F_c + w sum_c F_c),   c: the pieces of the joint,
/// and F_c of pieces in no joint. The sum counts two pieces that meet at no node (side branches of one trunk, from
/// junctions close to each other) only where others of the joint are, since beyond the trunk they are separate vessels,
/// and where their tubes have not parted yet: around their own ball, or their union would have a crease that no block
/// can follow.
/// Blending within one joint at a time: a piece that belongs to two must not make the vessels of one merge with those
/// of the other.

#include <array>
#include <vector>

#include "vasohex/core/vec3.h"
#include "vasohex/skeleton/network.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// Weight 1 up to `inner`, 0 from `outer` on, a quintic (C2) step between.
struct BlendBall {
  Vec3 center = Vec3::Zero();
  double inner = 0, outer = 0;
};

/// A weight in [0, 1] and its gradient.
struct BlendWeight {
  double value = 0;
  Vec3 gradient = Vec3::Zero();
};

/// Where two pieces of a joint that meet at no node have not parted yet.
struct SiblingBall {
  std::array<int, 2> pieces{};  ///< ascending
  BlendBall ball;
};

struct Blending {
  std::vector<BlendBall> node_balls;      ///< [node]; inner = outer = 0 at ends
  std::vector<std::vector<double>> cuts;  ///< [branch]: arc lengths where it is cut, ascending, ends not included
  std::vector<int> first_piece;           ///< [branch]: its pieces are first_piece + 0 ... cuts.size(), in order
  std::vector<std::vector<BlendBall>> joints;  ///< [joint]: the balls around its nodes, then those of its siblings
  std::vector<std::vector<SiblingBall>> siblings;  ///< [joint]
  std::vector<std::vector<int>> joints_of;     ///< [piece]: the joints it belongs to, ascending
  std::vector<std::vector<int>> pieces_of;     ///< [joint]: its pieces, ascending
  std::vector<std::array<int, 2>> nodes_of;    ///< [piece]: nodes of the network where it starts and ends; -1: a cut
  std::vector<std::array<double, 2>> arcs;     ///< [piece]: arc lengths of its branch where it starts and ends
  std::vector<std::array<int, 2>> joints_at;   ///< [piece]: joints at its start and end, or -1

  /// Whether both pieces lie in the joint and meet at no node, nor at a cut.
  bool are_siblings(int joint, int piece, int other) const;

  /// The pieces that make the surface around the stretches, ascending: those that they run along, and all of a joint
  /// whose inner ball they reach.
  std::vector<int> pieces_around(const std::vector<Stretch>& stretches) const;

  /// 1 - product over the balls of a joint of (1 - weight).
  BlendWeight weight(int joint, const Vec3& x) const;

  /// The same over the balls of two siblings of a joint.
  BlendWeight sibling_weight(int joint, int piece, int other, const Vec3& x) const;
};

/// Pieces and joints of a network. Around a node with largest radius r the inner ball has radius R1 = max(t, r) + r
/// and the outer one R1 + 2 r; t is how far from the node two of its tubes still overlap (at most 40 r).
Blending make_blending(const Network& network);

}  // namespace vasohex
