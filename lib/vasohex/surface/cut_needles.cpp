#include "vasohex/surface/cut_needles.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "vasohex/surface/half_edges.h"

namespace vasohex {
namespace {

constexpr int kRounds = 30;
constexpr double kFlat = 0.003;  // radii by which a flip may change the surface

/// Triangles whose edges can be flipped and divided.
class Triangulation {
 public:
  explicit Triangulation(TriSurface& surface) : surface_(surface), opposite_(pair_half_edges(surface)) {}

  int half_edge_count() const { return static_cast<int>(opposite_.size()); }
  int opposite(int h) const { return opposite_[h]; }
  double length(int h) const { return (point(end_point(surface_, h)) - point(start_point(surface_, h))).norm(); }

  /// How far the two diagonals of the two triangles at the edge pass each other: what a flip changes. 0 at a rim.
  double ridge(int h) const {
    const int o = opposite_[h];
    if (o < 0) {
      return 0;
    }
    const Vec3 &a = point(start_point(surface_, h)), &c = point(tip(h));
    const Vec3 across = (point(end_point(surface_, h)) - a).cross(point(tip(o)) - c);
    return std::abs(across.dot(c - a)) / std::max(across.norm(), 1e-300);
  }

  /// Whether a flip makes the edge Delaunay: the angles opposite sum up to more than 180 degrees, and the diagonals
  /// cross.
  bool wants_flip(int h) const {
    const int o = opposite_[h];
    if (o < 0 || start_point(surface_, h) != end_point(surface_, o)) {
      return false;
    }
    const Vec3 &a = point(start_point(surface_, h)), &b = point(end_point(surface_, h));
    const Vec3 &c = point(tip(h)), &d = point(tip(o));
    const Vec3 normal = (b - a).cross(c - a) + (a - b).cross(d - b);
    return angle_between(a - c, b - c) + angle_between(a - d, b - d) > std::numbers::pi + 1e-3 &&
           normal.dot((a - c).cross(d - c)) > 0 && normal.dot((b - d).cross(c - d)) > 0 && !are_neighbours(h, tip(o));
  }

  void flip(int h) {
    const int o = opposite_[h];
    const int a = start_point(surface_, h), b = end_point(surface_, h), c = tip(h), d = tip(o);
    const int bc = opposite_[next_half_edge(h)], ca = opposite_[previous(h)];
    const int ad = opposite_[next_half_edge(o)], db = opposite_[previous(o)];
    const int t = h / 3, u = o / 3;
    surface_.triangles[t] = {c, a, d};
    surface_.triangles[u] = {d, b, c};
    link(3 * t, ca);
    link(3 * t + 1, ad);
    link(3 * u, db);
    link(3 * u + 1, bc);
    link(3 * t + 2, 3 * u + 2);
  }

  /// Divides the edge in its middle.
  void divide(int h) {
    const int m = static_cast<int>(surface_.points.size());
    surface_.points.push_back(0.5 * (point(start_point(surface_, h)) + point(end_point(surface_, h))));
    const int o = opposite_[h];
    const auto [near_h, far_h] = halve(h, m);
    if (o < 0) {
      opposite_[near_h] = opposite_[far_h] = -1;
      return;
    }
    const auto [near_o, far_o] = halve(o, m);
    link(near_h, far_o);
    link(far_h, near_o);
  }

 private:
  const Vec3& point(int p) const { return surface_.points[p]; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int tip(int h) const { return end_point(surface_, next_half_edge(h)); }
  void link(int g, int h) {
    opposite_[g] = h;
    if (h >= 0) {
      opposite_[h] = g;
    }
  }

  /// Cuts the triangle of h from m on h to its tip. Returns the halves of h, that of its start first.
  std::array<int, 2> halve(int h, int m) {
    const int a = start_point(surface_, h), b = end_point(surface_, h), c = tip(h);
    const int bc = opposite_[next_half_edge(h)], ca = opposite_[previous(h)];
    const int t = h / 3, u = static_cast<int>(surface_.triangles.size());
    surface_.triangles[t] = {a, m, c};
    surface_.triangles.push_back({m, b, c});
    opposite_.resize(opposite_.size() + 3, -1);
    link(3 * t + 2, ca);
    link(3 * u + 1, bc);
    link(3 * t + 1, 3 * u + 2);
    return {3 * t, 3 * u};
  }

  /// Whether an edge leads from the tip of h to point d.
  bool are_neighbours(int h, int d) const {
    for (const bool forward : {true, false}) {
      const int first = previous(h);  // starts at the tip
      for (int at = first;;) {
        if (end_point(surface_, at) == d || start_point(surface_, previous(at)) == d) {
          return true;
        }
        const int across = forward ? opposite_[previous(at)] : opposite_[at];
        if (across < 0) {
          break;
        }
        at = forward ? across : next_half_edge(across);
        if (at == first) {
          return false;
        }
      }
    }
    return false;
  }

  TriSurface& surface_;
  std::vector<int> opposite_;
};

/// The half-edge at which a needle is to be divided: of its long ones, the one that a flip would harm most. -1: not a
/// needle.
int edge_to_divide(const Triangulation& mesh, int t, double radius) {
  const std::array<double, 3> length{mesh.length(3 * t), mesh.length(3 * t + 1), mesh.length(3 * t + 2)};
  const auto [shortest, longest] = std::minmax_element(length.begin(), length.end());
  if (!(*longest > 0.4 * radius && *longest > 3 * *shortest)) {
    return -1;
  }
  int best = 3 * t + static_cast<int>(longest - length.begin());
  for (int k = 0; k < 3; ++k) {
    if (length[k] > 0.7 * *longest && mesh.ridge(3 * t + k) > mesh.ridge(best) + 1e-6 * radius) {
      best = 3 * t + k;
    }
  }
  return best;
}

}  // namespace

void cut_needles(TriSurface& surface, const std::function<double(const Vec3&)>& radius) {
  Triangulation mesh(surface);
  const auto radius_at = [&](int t) { return radius(surface.points[surface.triangles[t][0]]); };
  std::vector<char> touched(surface.triangles.size(), 0);  // needles and what became of them
  for (int round = 0; round < kRounds; ++round) {
    std::vector<int> cuts;
    for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
      if (const int h = edge_to_divide(mesh, t, radius_at(t)); h >= 0) {
        cuts.push_back(h);
      }
    }
    if (cuts.empty()) {
      return;
    }
    const int before = static_cast<int>(surface.triangles.size());
    std::vector<char> divided(before, 0);
    for (const int h : cuts) {
      const int o = mesh.opposite(h);
      if (divided[h / 3] || (o >= 0 && (o / 3 >= before || divided[o / 3]))) {
        continue;
      }
      divided[h / 3] = touched[h / 3] = 1;
      if (o >= 0) {
        divided[o / 3] = touched[o / 3] = 1;
      }
      mesh.divide(h);
    }
    touched.resize(surface.triangles.size(), 1);
    bool flipped = true;
    for (int pass = 0; pass < 10 && flipped; ++pass) {
      flipped = false;
      for (int h = 0; h < mesh.half_edge_count(); ++h) {
        const int o = mesh.opposite(h);
        if (o > h && (touched[h / 3] || touched[o / 3]) && mesh.wants_flip(h) &&
            mesh.ridge(h) < kFlat * radius_at(h / 3)) {
          mesh.flip(h);
          touched[h / 3] = touched[o / 3] = 1;
          flipped = true;
        }
      }
    }
  }
}

}  // namespace vasohex
