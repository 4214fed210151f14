#pragma once
/// \file A smooth surface through the points of a triangulated lumen.

#include <array>
#include <memory>

#include "vasohex/core/run.h"
#include "vasohex/skeleton/network.h"
#include "vasohex/surface/implicit_surface.h"
#include "vasohex/surface/prepare_surface.h"

namespace vasohex {

struct SmoothOptions {
  int rings = 3;            ///< of neighbours that a jet is fitted to, at least 2
  bool interpolate = true;  ///< the jets are moved onto the points; false: for noisy points, with 4 or 5 rings
};

/// What the surface is made of, and how far it is from the facets.
struct SmoothReport {
  int points = 0;                ///< after refinement
  std::array<int, 4> degrees{};  ///< [degree] points with a jet of it; [0]: none could be fitted
  int capped = 0;                ///< balls made smaller because another sheet is near
  int creased = 0;               ///< points on creases
  int curved = 0;                ///< points around which curved triangles stand in for jets
  int flat = 0;                  ///< of those, points without a normal: the facets
  double deviation_max = 0;      ///< from the facets, over the local radius
  double deviation_mean = 0;
  Vec3 deviation_place = Vec3::Zero();  ///< where it is largest
};

struct SmoothSurface {
  std::unique_ptr<ImplicitSurface> surface;
  SmoothReport report;
};

/// Cubic jets at the points, blended by a partition of unity (Y. Ohtake et al., Multi-level partition of unity
/// implicits, 2003). value: about the signed distance, a length. C3 where jets are, about a radius of a ball (1.6
/// edges) to both sides of the wall; elsewhere, and where sheets are too near each other for balls, the distance to
/// curved triangles (A. Vlachos et al., Curved PN triangles, 2001), continuous. From a triangulation of a smooth wall
/// the error is of fourth order in the length of its edges. Ends as those of TriangleSurface. Same bits for any
/// number of threads. Throws as LocalRadius.
SmoothSurface make_smooth_surface(const PreparedSurface& prepared, const Network& network,
                                  const SmoothOptions& options = {}, const Run& run = {});

}  // namespace vasohex
