#pragma once
/// \file The O-grid: a disc in five quads (a core square and four around it), and its place on the axis of a vessel.
///
///        ou1 ----------- ou0         corners at 45, 135, 225, 315 degrees of the frame's X axis;
///         | \    1     / |           quad 0: the core, (u, v) = (0,0) at in0, u to in1, v to in3;
///         |  in1 --- in0 |           quad 1 + j: u from in_j out to ou_j, v on to corner j + 1.
///         | 2 |   0   | 4|           Seen against the frame's normal X x Y all quads turn counter-clockwise.
///         |  in2 --- in3 |
///         | /    3     \ |
///        ou2 ----------- ou3

#include <array>

#include "vasohex/core/vec3.h"
#include "vasohex/surface/implicit_surface.h"

namespace vasohex {

/// Where a cross-section lies. X, Y and normal are right-handed and orthonormal.
struct SectionFrame {
  Vec3 origin = Vec3::Zero();
  Vec3 x = Vec3::UnitX();
  Vec3 y = Vec3::UnitY();
  double radius = 1;  ///< of the vessel here: where to look for the wall

  Vec3 normal() const { return x.cross(y); }
};

/// The same frame, turned by `angle` (radians) about its normal.
SectionFrame turned(const SectionFrame& frame, double angle);

/// Point (u, v) of a quad of the O-grid in the unit disc. The wall is at radius 1.
Eigen::Vector2d section_point(int quad, double u, double v);

/// The same point in space: in the frame's plane, the O-grid stretched so that its rim lies on the surface, found by
/// rays from the frame's origin. Where a ray finds no wall before 3 radii the frame's radius stands in.
Vec3 place_section_point(const ImplicitSurface& surface, const SectionFrame& frame, int quad, double u, double v);

}  // namespace vasohex
