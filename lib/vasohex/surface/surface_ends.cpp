#include "vasohex/surface/surface_ends.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <set>

#include "vasohex/core/short_text.h"
#include "vasohex/surface/half_edges.h"

namespace vasohex {
namespace {

/// A flat loop: middle, unit normal about which it turns counter-clockwise, radius of the disc of its area.
struct Disc {
  Vec3 centre = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  double radius = 0;
  double perimeter = 0;
  double off_plane = 0;  ///< largest distance of a point to the plane
};

Disc disc_of(const TriSurface& surface, const std::vector<int>& loop) {
  Disc disc;
  Vec3 mean = Vec3::Zero(), area = Vec3::Zero();
  for (const int p : loop) {
    mean += surface.points[p] / static_cast<double>(loop.size());
  }
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 a = surface.points[loop[i]] - mean, b = surface.points[loop[(i + 1) % loop.size()]] - mean;
    area += 0.5 * a.cross(b);
    disc.perimeter += (a - b).norm();
  }
  disc.radius = std::sqrt(area.norm() / std::numbers::pi);
  disc.normal = area.norm() > 0 ? Vec3(area.normalized()) : Vec3::UnitZ();
  Vec3 centroid = Vec3::Zero();
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 a = surface.points[loop[i]] - mean, b = surface.points[loop[(i + 1) % loop.size()]] - mean;
    centroid += 0.5 * a.cross(b).dot(disc.normal) * (a + b) / 3;
  }
  disc.centre = mean + (area.norm() > 0 ? Vec3(centroid / area.norm()) : Vec3::Zero());
  disc.centre -= disc.normal.dot(disc.centre - mean) * disc.normal;
  for (const int p : loop) {
    disc.off_plane = std::max(disc.off_plane, std::abs(disc.normal.dot(surface.points[p] - disc.centre)));
  }
  return disc;
}

/// Start points of a rim's half-edges, in the order that a cap would have: against the wall's.
std::vector<int> cap_order(const TriSurface& surface, const std::vector<int>& rim) {
  std::vector<int> points;
  for (const int h : rim) {
    points.push_back(start_point(surface, h));
  }
  std::reverse(points.begin(), points.end());
  return points;
}

/// How steeply the wall at these of its half-edges meets a plane of normal n: 1 if it comes along -n, 0 within it.
double steepness(const TriSurface& surface, const std::vector<int>& half_edges, const Vec3& n) {
  double sum = 0, length = 0;
  for (const int h : half_edges) {
    const Vec3 along = surface.points[end_point(surface, h)] - surface.points[start_point(surface, h)];
    const Vec3 out = along.cross(area_normal(surface, h / 3));
    if (out.norm() > 0) {
      sum += along.norm() * n.dot(out.normalized());
      length += along.norm();
    }
  }
  return length > 0 ? sum / length : 0;
}

constexpr std::size_t kFewest = 6;  // edges of an end or a cap
constexpr double kSteep = 0.5;
constexpr double kAlike = 0.9;      // cosine: triangles of one cap, against the first one's normal
constexpr double kBulge = 0.15;     // of the radius: a cap that is a flat cone (with a point in the middle) counts
constexpr double kOffPlane = 0.15;  // of the radius: a cap's rim, bevelled by a grid
constexpr double kNarrow = 0.45;  // width over length: the sides of tubes with few facets are strips as flat as caps

bool is_end(const TriSurface& surface, const std::vector<int>& rim) {
  const Disc disc = disc_of(surface, cap_order(surface, rim));
  return rim.size() >= kFewest && disc.radius > 0 && steepness(surface, rim, disc.normal) > kSteep;
}

/// How wide what points enclose is, over how long: 1 of a circle.
double width_over_length(const std::vector<Vec3>& points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) {
    mean += p / static_cast<double>(points.size());
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) {
    covariance += (p - mean) * (p - mean).transpose();
  }
  const Vec3 spread =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly).eigenvalues();
  return std::sqrt(spread[1] / spread[2]);
}

/// The longest of the loops that half-edges form, whose triangles remain if what lies on their other side goes.
std::vector<int> longest_loop(std::vector<int> opposite, const std::vector<int>& half_edges) {
  for (const int h : half_edges) {
    opposite[h] = -1;
  }
  std::vector<char> seen(opposite.size(), 0);
  std::vector<int> longest;
  for (const int start : half_edges) {
    std::vector<int> loop;
    for (int h = start; !seen[h];) {
      seen[h] = 1;
      loop.push_back(h);
      h = next_half_edge(h);  // around the point where h ends
      while (opposite[h] >= 0) {
        h = next_half_edge(opposite[h]);
      }
    }
    if (loop.size() > longest.size()) {
      longest = std::move(loop);
    }
  }
  return longest;
}

/// The triangles that a region surrounds: reached from those half-edges of its outline that are not in its rim. None
/// if they are more than `most`: the region then has several rims.
std::vector<int> enclosed_triangles(const std::vector<int>& opposite, const std::vector<int>& outline,
                                    const std::vector<int>& rim, const std::function<bool(int)>& in_region,
                                    std::size_t most) {
  const std::set<int> in_rim(rim.begin(), rim.end());
  std::set<int> found;
  std::vector<int> stack;
  const auto reach = [&](int half_edge) {
    const int t = half_edge / 3;
    if (half_edge >= 0 && !in_region(t) && found.insert(t).second) {
      stack.push_back(t);
    }
  };
  for (const int h : outline) {
    if (!in_rim.contains(h)) {
      reach(h);
    }
  }
  while (!stack.empty() && found.size() <= most) {
    const int t = stack.back();
    stack.pop_back();
    for (int h = 3 * t; h < 3 * t + 3; ++h) {
      reach(opposite[h]);
    }
  }
  return found.size() <= most ? std::vector<int>(found.begin(), found.end()) : std::vector<int>();
}

}  // namespace

void drop_caps(TriSurface& surface, std::vector<std::string>& repairs) {
  const int n = static_cast<int>(surface.triangles.size());
  const std::vector<int> opposite = pair_half_edges(surface);
  std::vector<Vec3> normal(n);
  std::vector<double> area(n);
  for (int t = 0; t < n; ++t) {
    normal[t] = area_normal(surface, t);
    area[t] = normal[t].norm() / 2;
    normal[t] = area[t] > 0 ? Vec3(normal[t].normalized()) : Vec3::Zero();
  }
  std::vector<int> seeds(n);
  std::iota(seeds.begin(), seeds.end(), 0);
  std::stable_sort(seeds.begin(), seeds.end(), [&](int a, int b) { return area[a] > area[b]; });

  std::vector<int> region(n, -1), members;
  std::vector<char> seen(n, 0), gone(n, 0);
  std::vector<std::string> caps;
  for (int id = 0; id < n; ++id) {
    if (seen[seeds[id]]) {
      continue;
    }
    // the flat region around the seed; then around the plane of what was found, for a cap that is a flat cone
    Vec3 n0 = normal[seeds[id]], p0 = surface.points[surface.triangles[seeds[id]][0]];
    double known = 0;
    for (std::size_t last = 0;; last = members.size()) {
      if (last > 0) {
        for (const int t : members) {
          region[t] = -1;
        }
      }
      members.assign(1, seeds[id]);
      region[seeds[id]] = id;
      double total = area[seeds[id]];
      for (std::size_t m = 0; m < members.size(); ++m) {
        for (int h = 3 * members[m]; h < 3 * members[m] + 3; ++h) {
          const int t = opposite[h] < 0 ? -1 : opposite[h] / 3;
          if (t < 0 || region[t] == id || gone[t] || (area[t] > 0 && normal[t].dot(n0) < kAlike)) {
            continue;
          }
          const double tip = std::abs(n0.dot(surface.points[end_point(surface, next_half_edge(opposite[h]))] - p0));
          if (tip <= kBulge * std::sqrt(std::max(known, total + area[t]) / std::numbers::pi)) {
            region[t] = id;
            seen[t] = seen[t] || normal[t].dot(normal[seeds[id]]) > 0.98;  // not a better seed
            members.push_back(t);
            total += area[t];
          }
        }
      }
      if (members.size() <= last) {
        break;
      }
      n0 = p0 = Vec3::Zero();
      for (const int t : members) {
        n0 += area[t] * normal[t];
        for (const int p : surface.triangles[t]) {
          p0 += area[t] / (3 * total) * surface.points[p];
        }
      }
      n0.normalize();
      known = total;
    }
    // its outline, as half-edges of the wall
    std::vector<int> outline;
    bool open = false;
    for (const int t : members) {
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        if (opposite[h] < 0) {
          open = true;
        } else if (region[opposite[h] / 3] != id) {
          outline.push_back(opposite[h]);
        }
      }
    }
    if (open || outline.size() < kFewest) {
      continue;
    }
    double fold = 0;
    bool crease = true;
    for (const int h : outline) {
      const double cosine = n0.dot(normal[h / 3]);
      crease = crease && cosine < kAlike;
      fold += std::acos(std::clamp(cosine, -1.0, 1.0)) / static_cast<double>(outline.size());
    }
    if (!crease || fold < std::numbers::pi / 4 || steepness(surface, outline, n0) < kSteep) {
      continue;
    }
    // one loop around it, round; what lies within (slivers that a grid leaves in a cap askew) goes with it
    const std::vector<int> loop = longest_loop(opposite, outline);
    const std::vector<int> islands = enclosed_triangles(
        opposite, outline, loop, [&](int t) { return region[t] == id; }, members.size() / 10);
    if (islands.empty() && loop.size() != outline.size()) {
      continue;
    }
    for (const int t : islands) {
      region[t] = id;
      members.push_back(t);
      known += area[t];
    }
    const std::vector<int> rim = cap_order(surface, loop);
    const Disc disc = disc_of(surface, rim);
    std::vector<Vec3> around;
    for (const int p : rim) {
      around.push_back(surface.points[p]);
    }
    const double round = 4 * std::numbers::pi * known / (disc.perimeter * disc.perimeter);
    if (round < 0.3 || width_over_length(around) < kNarrow || disc.off_plane > kOffPlane * disc.radius) {
      continue;
    }
    for (const int t : members) {
      gone[t] = 1;
    }
    caps.push_back("flat cap at " + short_text(disc.centre) + ", radius " + short_text(disc.radius) + ": " +
                   std::to_string(members.size()) + " triangles dropped, the plane is kept as an end");
  }
  if (!caps.empty()) {
    std::size_t kept = 0;
    for (int t = 0; t < n; ++t) {
      if (!gone[t]) {
        surface.triangles[kept++] = surface.triangles[t];
      }
    }
    surface.triangles.resize(kept);
    repairs.insert(repairs.end(), caps.begin(), caps.end());
  }
}

void close_holes(TriSurface& surface, std::vector<std::string>& repairs) {
  for (const auto& rim : rim_loops(pair_half_edges(surface))) {
    if (is_end(surface, rim)) {
      continue;
    }
    const std::vector<int> loop = cap_order(surface, rim);
    const Disc disc = disc_of(surface, loop);
    if (loop.size() <= 3) {
      if (loop.size() == 3) {
        surface.triangles.push_back({loop[0], loop[1], loop[2]});
      }
    } else {
      const int middle = static_cast<int>(surface.points.size());
      surface.points.push_back(disc.centre);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        surface.triangles.push_back({middle, loop[i], loop[(i + 1) % loop.size()]});
      }
    }
    repairs.push_back("hole of " + std::to_string(loop.size()) + " edges in the wall closed at " +
                      short_text(disc.centre) + ", radius " + short_text(disc.radius));
  }
}

std::vector<std::vector<int>> open_rims(const TriSurface& surface) {
  std::vector<std::vector<int>> rims;
  for (const auto& rim : rim_loops(pair_half_edges(surface))) {
    rims.push_back(cap_order(surface, rim));
    std::rotate(rims.back().begin(), std::min_element(rims.back().begin(), rims.back().end()), rims.back().end());
  }
  std::sort(rims.begin(), rims.end());
  return rims;
}

SurfaceEnd rim_end(const TriSurface& surface, const std::vector<int>& rim) {
  const Disc disc = disc_of(surface, rim);
  return {disc.centre, disc.normal, disc.radius};
}

}  // namespace vasohex
