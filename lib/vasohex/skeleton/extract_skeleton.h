#pragma once
/// \file From a triangulated lumen to its skeleton, by contraction of the surface.

#include <string>
#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/skeleton/skeleton.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

struct ExtractOptions {
  /// Edges of the surface that is contracted, in local radii. Smaller: finer detail, longer time.
  double edge = 0.35;
};

struct Extraction {
  Skeleton skeleton;
  std::vector<int> end_points;     ///< [ends] index of Skeleton::points; -1: its piece of the lumen has no vessel
  std::vector<std::string> notes;  ///< one line each: openings closed, dead ends, pieces left out, lost holes
};

/// The skeleton of a lumen: mean curvature flow to curves [Au et al. 2008], collapsed to a graph, and moved to the
/// centroids of the cross-sections.
///
/// - The surface: consistently oriented, every edge with one or two triangles; rims are closed. Pieces become
///   components of the skeleton.
/// - One point of one segment for each SurfaceEnd, at its centre, with its radius; the axis runs along its normal
/// there.
/// - Radii are those of discs with the area of the cross-section; of a junction that of the widest vessel.
/// - Points are about half a radius apart.
/// - As many independent cycles as the closed surface has holes (its genus). A note tells if one was lost: under the
///   flow, holes of a radius below about .4 of the radius of the vessel around them close.
/// - Dead ends without a SurfaceEnd stay if they reach out of the vessel they branch off by more than 1.5 of its radii
///   (4 if their tip is thinner than .3 of it) and their own radius: bumps of the wall are no vessels. Longer ones
///   than their own radius that do not stay, and those that do, are noted.
///
/// Deterministic, the same for any number of threads. Commutes with scaling and rigid motion up to some hundredths of
/// a radius: which of several equally short edges is collapsed first is a matter of rounding. Throws Error
/// (bad_input) if the surface is not as above, an end is not on it, an option is out of range, or no vessel is found.
Extraction extract_skeleton(const TriSurface& surface, const std::vector<SurfaceEnd>& ends,
                            const ExtractOptions& options = {}, const Run& run = {});

}  // namespace vasohex
