#pragma once
/// \file The facets of a triangulated lumen as an implicit surface.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "vasohex/skeleton/network.h"
#include "vasohex/surface/implicit_surface.h"
#include "vasohex/surface/local_radius.h"
#include "vasohex/surface/prepare_surface.h"
#include "vasohex/surface/triangle_tree.h"

namespace vasohex {

/// value: the signed distance to the nearest facet, a length; |gradient| = 1. The sign is that of the angle-weighted
/// pseudonormal (J. A. Bærentzen, H. Aanæs, 2005). Beyond the rim of an end the wall goes on straight for 1.5 radii
/// of the end, and is closed there by a plane: the cap plane itself is the caller's.
class TriangleSurface final : public ImplicitSurface {
 public:
  /// Vessel radii are those of the network. Throws as LocalRadius.
  TriangleSurface(PreparedSurface prepared, const Network& network);

  double value(const Vec3& x) const override;
  double value(const Vec3& x, Vec3& gradient) const override;
  double radius(const Vec3& x) const override { return radius_.at(x); }

  /// The closest point of the facets.
  ClosestPoint closest(const Vec3& x) const { return tree_.closest(x); }
  /// The value at x, whose closest point is `c`; `beyond`: whether the closest point is on the rim of an end.
  double value_from(const Vec3& x, const ClosestPoint& c, Vec3& gradient, bool& beyond) const;

  const PreparedSurface& prepared() const { return prepared_; }
  /// Unit, angle-weighted [points]; zero for a point of triangles without area.
  const std::vector<Vec3>& point_normals() const { return point_normals_; }

 private:
  PreparedSurface prepared_;
  LocalRadius radius_;
  TriangleTree tree_;
  std::vector<Vec3> normals_, point_normals_, edge_normals_;  ///< edge normals [3 triangles], by half-edge
  std::vector<int> rim_of_edge_, rim_of_point_;               ///< the end; -1: none
  std::vector<Vec3> rim_normals_;                             ///< [points] of the wall along an end's rim
};

/// Angle-weighted normals of the points, unit; zero for points of triangles without area only.
std::vector<Vec3> angle_weighted_normals(const TriSurface& surface);

/// The sign compared with the winding number of the triangles, their openings closed by fans.
struct SignCheck {
  int samples = 0;
  int contradictions = 0;
  Vec3 place = Vec3::Zero();  ///< of the first contradiction
};

/// Looks on both sides of up to `triangles` triangles spread over the surface, a quarter of the local radius or of
/// the triangle's size away, whichever is less. A contradiction: sheets that overlap or are turned.
SignCheck check_sign(const TriangleSurface& surface, int triangles = 200);

}  // namespace vasohex
