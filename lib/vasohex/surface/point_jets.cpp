#include "vasohex/surface/point_jets.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace vasohex {

PointJets::PointJets(const TriSurface& surface, std::vector<Vec3> normals, std::vector<char> on_crease)
    : surface_(&surface),
      normals_(std::move(normals)),
      on_crease_(std::move(on_crease)),
      first_(surface.points.size() + 1, 0) {
  on_crease_.resize(surface.points.size(), 0);
  std::vector<std::array<int, 2>> pairs;
  pairs.reserve(6 * surface.triangles.size());
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) {
      pairs.push_back({t[k], t[(k + 1) % 3]});
      pairs.push_back({t[(k + 1) % 3], t[k]});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (const auto& [a, b] : pairs) {
    ++first_[a + 1];
    neighbours_.push_back(b);
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

double PointJets::longest_edge(int p) const {
  double longest = 0;
  for (const int* q = neighbours_begin(p); q != neighbours_end(p); ++q) {
    longest = std::max(longest, (surface_->points[*q] - surface_->points[p]).norm());
  }
  return longest;
}

double PointJets::mean_edge(int p) const {
  double sum = 0;
  for (const int* q = neighbours_begin(p); q != neighbours_end(p); ++q) {
    sum += (surface_->points[*q] - surface_->points[p]).norm();
  }
  const auto count = neighbours_end(p) - neighbours_begin(p);
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

Jet PointJets::fit(int p, int rings, Space& space) const {
  const double size = mean_edge(p);
  if (normals_[p].isZero() || !(size > 0) || on_crease_[p]) {
    return {};
  }
  space.stamp.resize(surface_->points.size(), -1);
  space.points.assign(1, surface_->points[p]);
  space.stamp[p] = p;
  space.ring.assign(1, p);
  for (int depth = 0; depth < rings || (space.points.size() < 20 && depth < rings + 2); ++depth) {
    space.next.clear();
    for (const int q : space.ring) {
      for (const int* r = neighbours_begin(q); r != neighbours_end(q); ++r) {
        if (space.stamp[*r] == p) {
          continue;
        }
        space.stamp[*r] = p;
        if (on_crease_[*r]) {
          space.points.push_back(surface_->points[*r]);
        } else if (normals_[*r].dot(normals_[p]) > 0) {
          space.points.push_back(surface_->points[*r]);
          space.next.push_back(*r);
        }
      }
    }
    space.ring.swap(space.next);
  }
  return fit_jet(surface_->points[p], normals_[p], size, space.points);
}

}  // namespace vasohex
