#pragma once
/// \file How much of a lumen's wall a mesh reaches, and the places where it does not.

#include <vector>

#include "vasohex/core/run.h"
#include "vasohex/mesh/hex_mesh.h"
#include "vasohex/surface/implicit_surface.h"
#include "vasohex/surface/label_volume.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Where a lumen's wall is further from the mesh's than this many local radii, the mesh does not reach it. Two straight
/// elements to a quarter of the circumference are .14 off.
inline constexpr double kReached = 0.15;

/// Distances of points of a lumen's wall to the wall of a mesh, in local radii.
struct WallReach {
  struct Place {
    Vec3 at = Vec3::Zero();  ///< of the lumen's wall, furthest from the mesh
    double distance = 0;     ///< a length
    double radii = 0;        ///< the same over the local radius
    double share = 0;        ///< of all points, that belong to this place
  };
  int points = 0;
  double mean = 0, p99 = 0, max = 0;
  std::vector<Place> unreached;  ///< furthest first
};

/// Points on the triangles, about .3 local radii apart or nearer.
std::vector<Vec3> points_on(const TriSurface& triangles, const ImplicitSurface& surface);

/// Points of the surface between neighbouring voxels of which one is inside; none where the surface is not within a
/// voxel of there, since that part of the segmentation was left out.
std::vector<Vec3> points_on(const LabelVolume& volume, const ImplicitSurface& surface);

/// Measures the points' distances to the mesh's wall, taken as flat between its nodes. Points beyond an end's plane and
/// within three of its radii of its centre do not count. Points further than kReached are one place while they are half
/// a radius apart. Same result for any number of threads.
WallReach measure_reach(const HexMesh& mesh, const std::vector<Vec3>& wall, const std::vector<SurfaceEnd>& ends,
                        const ImplicitSurface& surface, const Run& run = {});

}  // namespace vasohex
