#pragma once
/// \file Cross-sections of one vessel of a lumen.

#include <optional>
#include <vector>

#include "vasohex/skeleton/closed_lumen.h"
#include "vasohex/skeleton/vessel_graph.h"

namespace vasohex {

/// A closed lumen of which it is known to which vessel each point belongs.
struct PartedLumen {
  const ClosedLumen& lumen;
  const std::vector<int>& vessel_of;    ///< [points] -1: of none
  std::vector<std::vector<int>> edges;  ///< [vessels] half-edges that start on each
};

PartedLumen parted_lumen(const ClosedLumen& lumen, const std::vector<int>& vessel_of, std::size_t vessels);

struct Section {
  Vec3 centre = Vec3::Zero();
  double area = 0;
  double own = 0;  ///< part of the way around that is the vessel's own wall
};

/// The section of a vessel: the loop around the origin, otherwise the nearest, without the wall of others.
std::optional<Section> section_of(const PartedLumen& lumen, int vessel, const Vec3& origin, const Vec3& normal);

/// The circle that most of a section around the origin lies on, whatever opens out of it: of radius .7 to 1.4 times
/// `radius`, its centre within half of that from the origin, at least .45 of the way around within a tenth of it.
std::optional<Section> circle_of(const PartedLumen& lumen, const std::vector<int>& vessels, const Vec3& origin,
                                 const Vec3& normal, double radius);

}  // namespace vasohex
