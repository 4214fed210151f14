#include "vasohex/surface/smooth_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "vasohex/core/box_nodes.h"
#include "vasohex/core/parallel.h"
#include "vasohex/surface/creases.h"
#include "vasohex/surface/point_jets.h"
#include "vasohex/surface/project.h"
#include "vasohex/surface/refine_triangles.h"
#include "vasohex/surface/surface_ends.h"
#include "vasohex/surface/triangle_surface.h"

namespace vasohex {
namespace {

constexpr double kBall = 1.6;     // radius of a ball over the longest edge at its point
constexpr double kSparse = 0.05;  // sum of weights below which curved triangles mix in

/// Balls in a tree of boxes, depth first.
class BallTree {
 public:
  /// \param balls which of the centres have one
  BallTree(const std::vector<Vec3>& centres, const std::vector<double>& radii, std::vector<int> balls)
      : balls_(std::move(balls)) {
    if (!balls_.empty()) {
      build(centres, radii, 0, static_cast<int>(balls_.size()));
    }
  }

  /// Calls visit(ball) for all whose boxes hold x, in a fixed order.
  template <class Visit>
  void for_each_near(const Vec3& x, Visit&& visit) const {
    for_each_item_near(nodes_, x, [&](int i) { visit(balls_[i]); });
  }

 private:
  struct Node {
    std::array<double, 3> min{}, max{};
    int skip = 0, first = 0, count = 0;
  };
  void build(const std::vector<Vec3>& centres, const std::vector<double>& radii, int begin, int end) {
    const std::size_t at = nodes_.size();
    Box reach, middles;
    for (int i = begin; i < end; ++i) {
      const Vec3 r = Vec3::Constant(radii[balls_[i]]);
      reach.add(centres[balls_[i]] - r);
      reach.add(centres[balls_[i]] + r);
      middles.add(centres[balls_[i]]);
    }
    nodes_.emplace_back();
    for (int d = 0; d < 3; ++d) {
      nodes_[at].min[d] = reach.min[d];
      nodes_[at].max[d] = reach.max[d];
    }
    if (end - begin <= 4) {
      nodes_[at].first = begin;
      nodes_[at].count = end - begin;
    } else {
      int axis = 0;
      (middles.max - middles.min).maxCoeff(&axis);
      const int middle = begin + (end - begin) / 2;
      std::nth_element(balls_.begin() + begin, balls_.begin() + middle, balls_.begin() + end, [&](int a, int b) {
        return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
      });
      std::sort(balls_.begin() + begin, balls_.begin() + middle);
      std::sort(balls_.begin() + middle, balls_.begin() + end);
      build(centres, radii, begin, middle);
      build(centres, radii, middle, end);
    }
    nodes_[at].skip = static_cast<int>(nodes_.size());
  }
  std::vector<int> balls_;
  std::vector<Node> nodes_;
};

class JetSurface final : public ImplicitSurface {
 public:
  JetSurface(PreparedSurface refined, const Network& network, const SmoothOptions& options, const Run& run,
             SmoothReport& report)
      : facets_(std::move(refined), network),
        creases_(find_creases(facets_.prepared().surface, [&](const Vec3& x) { return facets_.radius(x); })) {
    const TriSurface& s = facets_.prepared().surface;
    const int n = static_cast<int>(s.points.size());
    report.points = n;
    std::vector<char> on_crease(n);
    for (int p = 0; p < n; ++p) {
      on_crease[p] = creases_.at(p);
      report.creased += on_crease[p];
    }
    const PointJets fits(s, facets_.point_normals(), on_crease);
    std::vector<double> longest(n);
    for (int p = 0; p < n; ++p) {
      longest[p] = fits.longest_edge(p);
    }
    std::vector<Jet> jets(n);
    std::vector<double> balls(n, 0);
    std::vector<char> capped(n, 0);
    std::vector<double> widest(n);
    std::vector<int> all(n);
    std::iota(all.begin(), all.end(), 0);
    const double longest_of_all = n > 0 ? *std::max_element(longest.begin(), longest.end()) : 0;
    for (int p = 0; p < n; ++p) {
      // found from points with edges twice as long, too; creases from wherever a ball may reach
      widest[p] = on_crease[p] ? kBall * longest_of_all + longest[p] : 2.5 * kBall * longest[p];
    }
    const BallTree around(s.points, widest, all);
    parallel_for(run, n, 1024, [&](std::size_t begin, std::size_t end) {
      PointJets::Space space;
      std::vector<int> members;
      for (int p = static_cast<int>(begin); p < static_cast<int>(end); ++p) {
        jets[p] = fits.fit(p, options.rings, space);
        balls[p] = kBall * longest[p];
        members.clear();
        around.for_each_near(s.points[p], [&](int q) { members.push_back(q); });
        balls[p] = std::min(balls[p], distance_to_crease(s, p, members));
        const double gap = gap_to_next_sheet(s, fits, p, balls[p], longest, members);
        if (gap < balls[p]) {
          balls[p] = gap;
          capped[p] = 1;
        }
      }
    });
    const auto has_jet = [&](int p) { return jets[p].degree > 0 && balls[p] > 0; };
    std::vector<int> with_jet;
    for (int p = 0; p < n; ++p) {
      ++report.degrees[jets[p].degree];
      report.capped += capped[p];
      const bool covers = jets[p].degree > 0 && balls[p] > 0.75 * longest[p];
      report.curved += !covers;
      report.flat += facets_.point_normals()[p].isZero();
      if (has_jet(p)) {
        with_jet.push_back(p);
      }
    }
    for (std::size_t h = 0; h < creases_.normals.size(); ++h) {
      const int p = s.triangles[h / 3][h % 3];
      if (has_jet(p)) {
        creases_.normals[h] = jets[p].normal();
      }
    }
    balls_ = BallTree(s.points, balls, with_jet);
    jets_ = std::move(jets);
    radii_ = std::move(balls);
    if (options.interpolate) {
      std::vector<double> shift(n, 0);
      parallel_for(run, n, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
          if (radii_[p] > 0 && jets_[p].degree > 0) {
            shift[p] = value(s.points[p]);
          }
        }
      });
      for (int p = 0; p < n; ++p) {
        jets_[p].c[0] += shift[p];
      }
    }
  }

  double value(const Vec3& x) const override {
    Vec3 gradient;
    return value(x, gradient);
  }

  double value(const Vec3& x, Vec3& gradient) const override {
    double sum = 0, weighted = 0;
    Vec3 slope = Vec3::Zero(), weighted_slope = Vec3::Zero();  // of the sums
    balls_.for_each_near(x, [&](int p) {
      const Vec3 away = x - jets_[p].origin;
      const double scale = 1 / (radii_[p] * radii_[p]);
      const double rest = 1 - away.squaredNorm() * scale;
      if (rest <= 0) {
        return;
      }
      const double weight = rest * rest * rest * rest;
      const Vec3 weight_slope = (-8 * rest * rest * rest * scale) * away;
      Vec3 g_slope;
      const double g = jets_[p].value(x, g_slope);
      sum += weight;
      weighted += weight * g;
      slope += weight_slope;
      weighted_slope += weight * g_slope + g * weight_slope;
    });
    if (sum < kSparse) {
      Vec3 g_slope;
      const double g = curved(x, g_slope);
      const double rest = 1 - sum / kSparse;
      const double weight = kSparse * rest * rest * rest * rest;
      const Vec3 weight_slope = -4 * rest * rest * rest * slope;
      sum += weight;
      weighted += weight * g;
      slope += weight_slope;
      weighted_slope += weight * g_slope + g * weight_slope;
    }
    const double f = weighted / sum;
    gradient = (weighted_slope - f * slope) / sum;
    return f;
  }

  double radius(const Vec3& x) const override { return facets_.radius(x); }

 private:
  /// Distance from p to the creases between the points `near`.
  double distance_to_crease(const TriSurface& s, int p, const std::vector<int>& near) const {
    double distance = std::numeric_limits<double>::infinity();
    for (const int q : near) {
      for (const int r : creases_.along[q]) {
        distance = std::min(distance, distance_to_segment(s.points[p], s.points[q], s.points[r]));
      }
    }
    return distance;
  }

  /// Distance from p to points that no path within the ball joins to it, less what lies between such points.
  /// \param members all points there may be; those further than the gap could be go
  static double gap_to_next_sheet(const TriSurface& s, const PointJets& fits, int p, double ball,
                                  const std::vector<double>& longest, std::vector<int>& members) {
    const double reach = 1.25 * ball;
    members.erase(std::remove_if(members.begin(), members.end(),
                                 [&](int q) { return (s.points[q] - s.points[p]).norm() > reach; }),
                  members.end());
    std::sort(members.begin(), members.end());
    std::vector<char> joined(members.size(), 0);
    const auto index = [&](int q) {
      const auto at = std::lower_bound(members.begin(), members.end(), q);
      return at != members.end() && *at == q ? static_cast<int>(at - members.begin()) : -1;
    };
    std::vector<int> stack;
    const auto join = [&](int q) {
      const int i = index(q);
      if (i >= 0 && !joined[i]) {
        joined[i] = 1;
        stack.push_back(q);
      }
    };
    join(p);
    while (!stack.empty()) {
      const int q = stack.back();
      stack.pop_back();
      for (const int* r = fits.neighbours_begin(q); r != fits.neighbours_end(q); ++r) {
        join(*r);
      }
    }
    double gap = reach;
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (!joined[i]) {
        const double between = longest[members[i]] * longest[members[i]] / 3;
        const double distance2 = (s.points[members[i]] - s.points[p]).squaredNorm();
        gap = std::min(gap, std::sqrt(std::max(distance2 - between, 0.04 * distance2)));
      }
    }
    return gap;
  }

  /// Distance to the curved triangles; beyond rims and without normals, that of the facets. The edges of creases are
  /// straight, or triangles of its two sides would not meet there.
  double curved(const Vec3& x, Vec3& gradient) const {
    const ClosestPoint c = facets_.closest(x);
    bool beyond = false;
    const double flat = facets_.value_from(x, c, gradient, beyond);
    const TriSurface& s = facets_.prepared().surface;
    const auto& t = s.triangles[c.triangle];
    const Vec3* normals = &creases_.normals[3 * static_cast<std::size_t>(c.triangle)];
    const char* creased = &creases_.edges[3 * static_cast<std::size_t>(c.triangle)];
    if (normals[0].isZero() || normals[1].isZero() || normals[2].isZero()) {
      return flat;
    }
    Vec3 normal = Vec3::Zero(), q = Vec3::Zero(), edge_sum = Vec3::Zero(), corner_sum = Vec3::Zero();
    double size = 0;
    for (int k = 0; k < 3; ++k) {
      const int i = t[k], j = t[(k + 1) % 3];
      const Vec3 along = s.points[j] - s.points[i];
      const Vec3 &at_i = normals[k], &at_j = normals[(k + 1) % 3];
      size = std::max(size, along.norm());
      const double bend = creased[k] ? 0 : 1;
      const Vec3 near_i = (2 * s.points[i] + s.points[j] - bend * along.dot(at_i) * at_i) / 3;
      const Vec3 near_j = (2 * s.points[j] + s.points[i] + bend * along.dot(at_j) * at_j) / 3;
      const double a = c.weights[k], b = c.weights[(k + 1) % 3];
      q += a * a * a * s.points[i] + 3 * a * b * (a * near_i + b * near_j);
      edge_sum += near_i + near_j;
      corner_sum += s.points[i];
      normal += a * at_i;
    }
    q += 6 * c.weights[0] * c.weights[1] * c.weights[2] * (edge_sum / 4 - corner_sum / 6);
    normal.normalize();
    if (!normal.allFinite()) {
      return flat;
    }
    const double bulge = std::clamp((q - c.point).dot(normal), -0.25 * size, 0.25 * size);
    if (std::abs(flat) < size) {
      gradient = normal;
    }
    return flat - bulge;
  }

  TriangleSurface facets_;
  Creases creases_;  ///< with the jets' normals; angle-weighted ones where there is no jet
  std::vector<Jet> jets_;
  std::vector<double> radii_;
  BallTree balls_{{}, {}, {}};
};

void measure_deviation(const TriSurface& facets, const ImplicitSurface& surface, const Run& run,
                       SmoothReport& report) {
  const std::size_t n = facets.triangles.size();
  struct Sum {
    double max = 0, sum = 0, area = 0;
    Vec3 place = Vec3::Zero();
  };
  constexpr std::size_t grain = 256;
  std::vector<Sum> sums((n + grain - 1) / grain);
  parallel_for(run, n, grain, [&](std::size_t begin, std::size_t end) {
    Sum& sum = sums[begin / grain];
    for (std::size_t t = begin; t < end; ++t) {
      const Vec3 &a = facets.points[facets.triangles[t][0]], &b = facets.points[facets.triangles[t][1]],
                 &c = facets.points[facets.triangles[t][2]];
      const double area = (b - a).cross(c - a).norm() / 2;
      const double radius = surface.radius((a + b + c) / 3);
      for (const Vec3& x : {Vec3((a + b + c) / 3), Vec3((a + b) / 2), Vec3((b + c) / 2), Vec3((c + a) / 2)}) {
        Vec3 gradient;
        const double value = std::abs(surface.value(x, gradient)), slope = gradient.norm();
        double deviation = value / std::max(slope, 0.1) / radius;
        if (slope < 0.7) {  // at a fold: the first-order distance says little
          const Projection on_wall = project(surface, x);
          deviation = on_wall.converged ? (on_wall.point - x).norm() / radius : deviation;
        }
        sum.sum += area * deviation;
        sum.area += area;
        if (deviation > sum.max) {
          sum.max = deviation;
          sum.place = x;
        }
      }
    }
  });
  Sum total;
  for (const Sum& s : sums) {
    total.sum += s.sum;
    total.area += s.area;
    if (s.max > total.max) {
      total.max = s.max;
      total.place = s.place;
    }
  }
  report.deviation_max = total.max;
  report.deviation_mean = total.area > 0 ? total.sum / total.area : 0;
  report.deviation_place = total.place;
}

}  // namespace

SmoothSurface make_smooth_surface(const PreparedSurface& prepared, const Network& network,
                                  const SmoothOptions& options, const Run& run) {
  PreparedSurface refined = prepared;
  const LocalRadius radius(network);
  refine_triangles(refined.surface, [&](const Vec3& x) { return radius.at(x); });
  refined.rims = open_rims(refined.surface);
  SmoothSurface result;
  result.surface = std::make_unique<JetSurface>(std::move(refined), network, options, run, result.report);
  measure_deviation(prepared.surface, *result.surface, run, result.report);
  return result;
}

}  // namespace vasohex
