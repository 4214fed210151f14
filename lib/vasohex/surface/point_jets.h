#pragma once
/// \file Jets at the points of a triangulation.

#include <vector>

#include "vasohex/surface/jet.h"
#include "vasohex/surface/tri_surface.h"

namespace vasohex {

/// Fits jets to the neighbours of points. Const and thread-safe; the surface must outlive it and stay as it is.
class PointJets {
 public:
  /// \param normals unit, of the points; zero where there is none
  /// \param on_crease [points] 1 where sides of the surface meet that know nothing of each other; empty: nowhere
  PointJets(const TriSurface& surface, std::vector<Vec3> normals, std::vector<char> on_crease = {});

  /// Work space of one thread.
  struct Space {
    std::vector<int> stamp, ring, next;
    std::vector<Vec3> points;
  };

  /// The jet of point p from `rings` rings of neighbours, two more where these are less than 20 points; those whose
  /// normals point the other way are left out, and those behind a crease. Degree 0 without a normal and on a crease.
  Jet fit(int p, int rings, Space& space) const;

  /// Lengths of the edges at point p.
  double longest_edge(int p) const;
  double mean_edge(int p) const;

  const int* neighbours_begin(int p) const { return neighbours_.data() + first_[p]; }
  const int* neighbours_end(int p) const { return neighbours_.data() + first_[p + 1]; }
  const std::vector<Vec3>& normals() const { return normals_; }

 private:
  const TriSurface* surface_;
  std::vector<Vec3> normals_;
  std::vector<char> on_crease_;
  std::vector<int> first_, neighbours_;
};

}  // namespace vasohex
