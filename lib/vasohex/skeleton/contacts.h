#pragma once
/// \file Where vessels of a network are nearer to each other than they should be.

#include <array>
#include <string>
#include <vector>

#include "vasohex/skeleton/network.h"

namespace vasohex {

/// Two places of a network whose tubes meet, or nearly so.
struct Meeting {
  std::array<int, 2> branches{};
  std::array<double, 2> arcs{};   ///< along each branch
  std::array<double, 2> radii{};  ///< there
  double gap = 0;                 ///< distance of the axes less both radii, negative: overlap
  /// The gap over the smaller radius.
  double relative() const;
};

/// Where: between the two axes, on the wall of each if they just touch.
Vec3 place_of(const Network& network, const Meeting& meeting);

/// For messages: `the vessel from point 3 to point 7`.
std::string vessel_text(const Network& network, int branch);

/// For messages: `the vessels from point 3 to point 7 and from point 9 to point 12`.
std::string who_meet(const Network& network, const Meeting& meeting);

enum class ContactKind {
  passing,       ///< vessels that meet where no junction explains it: they pass, cross, or one coils onto itself
  hairpin,       ///< a vessel that turns back so sharply that it stays in itself
  side_by_side,  ///< branches of a junction that have not parted 24 radii away from it
};

struct Contact {
  ContactKind kind = ContactKind::passing;
  Meeting worst;                  ///< of a passing one the nearest places, to 1e-3 radii
  std::vector<Meeting> meetings;  ///< pairs of short stretches, all with gap < 0.1 of the smaller radius
};

/// A gap below this part of the smaller radius counts as touching.
constexpr double kTouching = 0.05;

/// All contacts: overlaps, and of passing vessels also gaps below kTouching. Meeting places of the network with each
/// other form a set of pairs; the part of it that hangs together with the pairs (x, x) is what neighbours along a
/// vessel and branches of a junction do by nature. It counts only where it reaches too far along the network. All
/// other parts are passing contacts, one each. O(n log n) for n samples.
std::vector<Contact> find_contacts(const Network& network);

}  // namespace vasohex
