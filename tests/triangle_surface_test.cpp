#include "vasohex/surface/triangle_surface.h"

#include <gtest/gtest.h>

#include <random>

#include "errors.h"
#include "triangle_shapes.h"
#include "vasohex/surface/project.h"
#include "vasohex/surface/repair_triangles.h"
#include "vasohex/surface/smooth_surface.h"

namespace vasohex {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * (generator_() / 4294967296.0); }
  Vec3 in_box(double half) { return {(*this)(-half, half), (*this)(-half, half), (*this)(-half, half)}; }
  Vec3 on(const TriSurface& s) {
    const auto& t = s.triangles[generator_() % s.triangles.size()];
    double a = (*this)(0, 1), b = (*this)(0, 1);
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    return (1 - a - b) * s.points[t[0]] + a * s.points[t[1]] + b * s.points[t[2]];
  }

 private:
  std::mt19937 generator_;
};

/// Least distance over all triangles, each looked at by its plane and by its edges: other code than the tree's.
double brute_force_distance(const TriSurface& s, const Vec3& x) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& t : s.triangles) {
    const std::array<Vec3, 3> p{s.points[t[0]], s.points[t[1]], s.points[t[2]]};
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    bool above = normal.norm() > 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3 along = p[(k + 1) % 3] - p[k];
      above = above && normal.cross(along).dot(x - p[k]) >= 0;
      const double at = along.norm() > 0 ? std::clamp((x - p[k]).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0;
      best = std::min(best, (x - p[k] - at * along).norm());
    }
    if (above) {
      best = std::min(best, std::abs(normal.normalized().dot(x - p[0])));
    }
  }
  return best;
}

TEST(TriangleTree, AgreesWithBruteForce) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    TriSurface s;
    const int n = 1 + round * 17;
    for (int i = 0; i < 3 * n; ++i) {
      s.points.push_back(i % 3 == 0 ? random.in_box(1)
                                    : Vec3(s.points.back() + random.in_box(round % 2 == 0 ? 0.1 : 1)));
    }
    for (int t = 0; t < n; ++t) {  // every tenth a needle or a point
      s.triangles.push_back({3 * t, t % 10 == 9 ? 3 * t : 3 * t + 1, t % 20 == 19 ? 3 * t : 3 * t + 2});
    }
    const TriangleTree tree(s);
    for (int i = 0; i < 100; ++i) {
      const Vec3 x = i % 2 == 0 ? random.in_box(2) : Vec3(random.on(s) + random.in_box(1e-3));
      const ClosestPoint c = tree.closest(x);
      ASSERT_NEAR(std::sqrt(c.distance2), brute_force_distance(s, x), 1e-12);
      ASSERT_NEAR((x - c.point).norm(), std::sqrt(c.distance2), 1e-12);
      const auto& t = s.triangles[c.triangle];
      ASSERT_NEAR(
          (c.weights[0] * s.points[t[0]] + c.weights[1] * s.points[t[1]] + c.weights[2] * s.points[t[2]] - c.point)
              .norm(),
          0, 1e-12);
      ASSERT_GE(c.weights.minCoeff(), -1e-12);
      ASSERT_EQ(tree.closest(x, 0.999 * std::sqrt(c.distance2)).triangle, -1);
    }
  }
  EXPECT_EQ(TriangleTree().closest(Vec3::Zero()).triangle, -1);
}

/// A torus whose points are pushed out and in at random: edges and points everywhere convex and concave.
TriSurface spiky_torus(Random& random, double height) {
  TriSurface s = TorusShape{}.triangles(20);
  for (Vec3& p : s.points) {
    const Vec3 ring = 3 * Vec3(p.x(), p.y(), 0).normalized();
    p = ring + (1 + random(-height, height)) * (p - ring);
  }
  return s;
}

int sign_errors(const TriangleSurface& surface, const TriSurface& oracle, double box, double clear, Random& random) {
  int errors = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 x = i % 2 == 0 ? random.in_box(box) : Vec3(random.on(oracle) + random.in_box(0.2));
    if (std::sqrt(surface.closest(x).distance2) > clear) {
      errors += (surface.value(x) < 0) != (winding_number(oracle, x) > 0.5);
    }
  }
  return errors;
}

TEST(TriangleSurface, SignAgreesWithTheWindingNumber) {
  Random random(2);
  const TriSurface spiky = spiky_torus(random, 0.4);
  EXPECT_EQ(sign_errors(TriangleSurface(prepare_surface(spiky), TorusShape{}.network()), spiky, 4.5, 1e-9, random),
            0);
  // cracked: nothing is shared, every corner moved by up to 3e-3 on its own, and one triangle of fifty is missing
  TriSurface soup;
  for (const auto& t : spiky.triangles) {
    if (random(0, 1) < 0.98) {
      const int first = static_cast<int>(soup.points.size());
      for (const int p : t) {
        soup.points.push_back(spiky.points[p] + random.in_box(3e-3));
      }
      soup.triangles.push_back({first, first + 1, first + 2});
    }
  }
  const PreparedSurface mended = prepare_surface(soup);
  EXPECT_EQ(mended.ends.size(), 0u);
  EXPECT_EQ(mended.components, 1);
  EXPECT_EQ(sign_errors(TriangleSurface(mended, TorusShape{}.network()), mended.surface, 4.5, 1e-9, random), 0);
}

TEST(TriangleSurface, CheckOfTheSignFindsTurnedSheets) {
  PreparedSurface good = prepare_surface(TubeShape{}.triangles(24));
  const SignCheck none = check_sign(TriangleSurface(good, TubeShape{}.network()));
  EXPECT_GE(none.samples, 300);
  EXPECT_EQ(none.contradictions, 0);
  for (std::size_t t = 0; t < good.surface.triangles.size(); t += 20) {
    std::swap(good.surface.triangles[t][1], good.surface.triangles[t][2]);
  }
  EXPECT_GT(check_sign(TriangleSurface(good, TubeShape{}.network()), 2000).contradictions, 10);
}

TEST(TriangleSurface, GoesOnBehindItsEnds) {
  const TubeShape shape;
  const PreparedSurface prepared = prepare_surface(shape.triangles(64));
  const TriangleSurface facets(prepared, shape.network());
  const SmoothSurface smooth = make_smooth_surface(prepared, shape.network());
  for (const ImplicitSurface* s :
       {static_cast<const ImplicitSurface*>(&facets), static_cast<const ImplicitSurface*>(smooth.surface.get())}) {
    for (const double z : {-1.4, -0.7, -0.05, 0.0, 4.0, 8.0, 8.1, 9.4}) {
      for (const double a : {0.0, 0.7, 2.1, 4.0}) {
        const Vec3 out(std::cos(a), std::sin(a), 0), axis(0, 0, z);
        EXPECT_LT(s->value(axis + 0.5 * out), 0) << z;
        EXPECT_GT(s->value(axis + 1.5 * out), 0) << z;
        const auto t = shoot(*s, axis, out, 1.0, 3.0);
        ASSERT_TRUE(t) << z;
        EXPECT_NEAR(*t, 1, 3e-3) << z;
        const Projection p = project(*s, axis + 0.95 * out);
        EXPECT_TRUE(p.converged);
        EXPECT_NEAR(shape.distance(p.point), 0, 3e-3) << z;
      }
    }
    for (const double z : {-30.0, -3.0, -1.7, 9.7, 11.0, 30.0}) {  // closed behind 1.5 radii
      EXPECT_GT(s->value(Vec3(0.1, 0.2, z)), 0) << z;
    }
  }
}

TEST(TriangleSurface, SplinterOnARimDecidesNothing) {
  // Real surfaces that were cut by planes have triangles on their rims so thin that their normals say nothing: here
  // two, one bent inwards, one outwards.
  const TubeShape shape;
  for (const double inwards : {1.0, -1.0}) {
    PreparedSurface prepared = prepare_surface(shape.triangles(64));
    TriSurface& s = prepared.surface;
    for (std::size_t e = 0; e < prepared.rims.size(); ++e) {
      std::vector<int>& rim = prepared.rims[e];
      const int a = rim[0], b = rim[1], added = static_cast<int>(s.points.size());
      const Vec3 middle = 0.5 * (s.points[a] + s.points[b]), &n = prepared.ends[e].normal;
      const Vec3 out = (middle - prepared.ends[e].centre).normalized();
      s.points.push_back(middle - inwards * 5e-3 * out - 1e-3 * n);
      const bool forwards = std::any_of(s.triangles.begin(), s.triangles.end(), [&](const std::array<int, 3>& t) {
        return (t[0] == a && t[1] == b) || (t[1] == a && t[2] == b) || (t[2] == a && t[0] == b);
      });
      s.triangles.push_back(forwards ? std::array{b, a, added} : std::array{a, b, added});
      rim.insert(rim.begin() + 1, added);
    }
    const TriangleSurface facets(prepared, shape.network());
    const SmoothSurface smooth = make_smooth_surface(prepared, shape.network());
    Random random(7);
    for (int i = 0; i < 20000; ++i) {
      const SurfaceEnd& end = prepared.ends[i % prepared.ends.size()];
      const double angle = random(0, 7), r = random(0, 1.8), behind = random(-0.3, 0.3);
      const Vec3 x = end.centre + Vec3(r * std::cos(angle), r * std::sin(angle), 0) + behind * end.normal;
      if (std::abs(r - 1) > 0.1) {
        EXPECT_EQ(facets.value(x) < 0, r < 1) << "r " << r << " behind the end " << behind;
        EXPECT_EQ(smooth.surface->value(x) < 0, r < 1) << "r " << r << " behind the end " << behind;
      }
    }
  }
}

TEST(TriangleSurface, RadiusIsThatOfTheVessel) {
  const TubeShape shape{8, 0.1};
  const TriangleSurface facets(prepare_surface(shape.triangles(24)), shape.network());
  EXPECT_NEAR(facets.radius({1, 0, 4}), 1.4, 0.15);
  EXPECT_NEAR(facets.radius({0, 0, 0}), 1.0, 1e-6);
  EXPECT_EQ(error_of([&] { TriangleSurface(prepare_surface(shape.triangles(24)), Network()); }),
            "the network has no branch of two points; radii are taken from it");
}

/// Largest distance to the true wall of points on facets, and of the same moved onto the smooth surface.
struct WallError {
  double facets = 0, smooth = 0;
};
template <class Shape>
WallError wall_error(const Shape& shape, const TriSurface& triangles, SmoothOptions options = {}) {
  const SmoothSurface smooth = make_smooth_surface(prepare_surface(triangles), shape.network(), options);
  Random random(3);
  WallError e;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = random.on(triangles);
    const Projection p = project(*smooth.surface, x);
    EXPECT_TRUE(p.converged);
    e.facets = std::max(e.facets, std::abs(shape.distance(x)));
    e.smooth = std::max(e.smooth, std::abs(shape.distance(p.point)));
  }
  return e;
}

template <class Shape>
void expect_fourth_order(const Shape& shape) {
  const WallError coarse = wall_error(shape, shape.triangles(32)), fine = wall_error(shape, shape.triangles(64));
  EXPECT_NEAR(std::log2(coarse.facets / fine.facets), 2, 0.1);
  EXPECT_GT(std::log2(coarse.smooth / fine.smooth), 3.5) << coarse.smooth << " " << fine.smooth;
  EXPECT_LT(fine.smooth, 1e-5);
  EXPECT_LT(wall_error(shape, shape.triangles(16)).smooth, 2e-3);
}

TEST(SmoothSurface, ErrorIsOfFourthOrder) {
  expect_fourth_order(TorusShape{});
  expect_fourth_order(TorusShape{1.6});
  expect_fourth_order(TubeShape{});
  expect_fourth_order(TubeShape{6, 0.15});
}

/// Points of the grid moved along the wall by up to .3 of the edges: irregular triangles, still on the wall.
TriSurface uneven(const TorusShape& shape, int around, Random& random) {
  TriSurface s = shape.triangles(around);
  const double step = 0.3 * 2 * std::numbers::pi / around;
  for (Vec3& p : s.points) {
    const double a = std::atan2(p.y(), p.x()) + random(-step, step) / shape.bend;
    const double b = std::atan2(p.z(), std::hypot(p.x(), p.y()) - shape.bend) + random(-step, step);
    p = Vec3((shape.bend + std::cos(b)) * std::cos(a), (shape.bend + std::cos(b)) * std::sin(a), std::sin(b));
  }
  return s;
}

TEST(SmoothSurface, ErrorIsOfFourthOrderOnUnevenTriangles) {
  Random random(4);
  const TorusShape shape;
  const double coarse = wall_error(shape, uneven(shape, 32, random)).smooth;
  const double fine = wall_error(shape, uneven(shape, 64, random)).smooth;
  EXPECT_GT(std::log2(coarse / fine), 3.3) << coarse << " " << fine;
  EXPECT_LT(fine, 1e-4);
}

/// A tube of radius 1 bent at right angles, of strips as long as its halves.
struct MitredTube {
  int around = 32;
  double length = 6;
  TriSurface triangles() const {
    TriSurface s;
    for (int i = 0; i < around; ++i) {
      const double a = 2 * std::numbers::pi * i / around, u = std::cos(a), v = std::sin(a);
      s.points.emplace_back(-length, v, u);
      s.points.emplace_back(u, v, u);
      s.points.emplace_back(u, v, -length);
    }
    for (int i = 0; i < around; ++i) {
      for (int half = 0; half < 2; ++half) {
        const int a = 3 * i + half, b = 3 * ((i + 1) % around) + half;
        s.triangles.push_back({a, b, b + 1});
        s.triangles.push_back({a, b + 1, a + 1});
      }
    }
    return s;
  }
  Network network() const {
    Network network;
    Branch branch;
    branch.points = {Vec3(-length, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, -length)};
    branch.radii = {1, 1, 1};
    network.branches.push_back(branch);
    return network;
  }
  /// Of points near the wall: each half ends at the plane between them.
  double distance(const Vec3& x) const { return (x[0] < x[2] ? x.tail<2>().norm() : x.head<2>().norm()) - 1; }
};

/// The normals at the crease say nothing of the needles there.
TEST(SmoothSurface, NeedlesAreStraightAlongTheirLength) {
  const MitredTube shape;
  const SmoothSurface smooth = make_smooth_surface(prepare_surface(shape.triangles()), shape.network());
  EXPECT_LT(smooth.report.points, 5000);
  double worst = 0;
  for (double along = 2; along < 5.5; along += 0.05) {
    for (double a = 0.01; a < 6.28; a += 0.02) {
      const Projection p = project(*smooth.surface, Vec3(-along, std::cos(a), std::sin(a)));
      EXPECT_TRUE(p.converged);
      worst = std::max(worst, std::abs(shape.distance(p.point)));
    }
  }
  EXPECT_LT(worst, 2.5e-3);  // the facets are 4.8e-3 off
}

/// Where the mitre is sharp both sides keep their shape up to it: blended jets were .3 off.
TEST(SmoothSurface, KeepsCreases) {
  const MitredTube shape;
  const TriSurface triangles = shape.triangles();
  const SmoothSurface smooth = make_smooth_surface(prepare_surface(triangles), shape.network());
  EXPECT_GT(smooth.report.creased, 16);
  double worst = 0;
  for (double off = -0.4; off < 0.401; off += 0.04) {
    for (double a = 0.01; a < 6.28; a += 0.02) {
      const double u = std::cos(a), v = std::sin(a);  // along the strips, from the crease
      const Vec3 x = off < 0 ? Vec3(u + off, v, u) : Vec3(u, v, u - off);
      Vec3 gradient;
      const double value = smooth.surface->value(x, gradient);
      worst = std::max(worst, std::abs(value) / gradient.norm());
    }
  }
  EXPECT_LT(worst, 0.013);  // the facets are 4.8e-3 off
}

/// Coarse triangles turn as much at every edge, rough ones anywhere.
TEST(SmoothSurface, CreasesAreNotWhatIsCoarseOrRough) {
  Random random(6);
  const TubeShape tube;
  for (const int around : {8, 12, 24}) {
    const SmoothReport report = make_smooth_surface(prepare_surface(tube.triangles(around)), tube.network()).report;
    EXPECT_EQ(report.creased, 0) << around;
  }
  const TorusShape torus;
  TriSurface rough = torus.triangles(32);
  for (Vec3& p : rough.points) {
    p += random.in_box(0.06);
  }
  const SmoothReport report = make_smooth_surface(prepare_surface(rough), torus.network()).report;
  EXPECT_EQ(report.creased, 0);
}

TEST(SmoothSurface, NoiseIsSmoothedByMoreRings) {
  Random random(5);
  const TorusShape shape;
  TriSurface noisy = shape.triangles(48);
  for (Vec3& p : noisy.points) {
    p += random.in_box(5e-3);
  }
  const double through = wall_error(shape, noisy).smooth, between = wall_error(shape, noisy, {5, false}).smooth;
  EXPECT_LT(between, 0.75 * through) << through << " " << between;
}

TEST(SmoothSurface, ValueOverGradientIsTheDistance) {
  Random random(6);
  const TorusShape shape;
  const SmoothSurface smooth = make_smooth_surface(prepare_surface(shape.triangles(48)), shape.network());
  for (int i = 0; i < 500; ++i) {
    const Vec3 x = random.on(shape.triangles(48)) + random.in_box(0.15);
    Vec3 gradient;
    const double value = smooth.surface->value(x, gradient);
    const double distance = shape.distance(x);
    EXPECT_NEAR(value / gradient.norm(), distance,
                (std::abs(distance) < 0.1 ? 5e-3 : 1e-2) * (0.02 + std::abs(distance)));
    if (std::abs(distance) > 0.1) {
      continue;  // curved triangles mix in, whose gradient is a normal
    }
    for (int d = 0; d < 3; ++d) {
      constexpr double h = 1e-6;
      const Vec3 step = h * Vec3::Unit(d);
      const double difference = (smooth.surface->value(x + step) - smooth.surface->value(x - step)) / (2 * h);
      EXPECT_NEAR(gradient[d], difference, 1e-6);
    }
  }
}

/// Two tubes side by side: the wall of each stays where it is, however near the other.
TEST(SmoothSurface, KeepsSheetsApart) {
  const TubeShape shape;
  const TriSurface one = shape.triangles(48);
  for (const double gap : {0.5, 0.1, 0.02}) {
    TriSurface both = one;
    const int n = static_cast<int>(one.points.size());
    for (const Vec3& p : one.points) {
      both.points.push_back(p + Vec3(2 + gap, 0, 0.03));
    }
    for (const auto& t : one.triangles) {
      both.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    }
    const SmoothSurface smooth = make_smooth_surface(prepare_surface(both), shape.network());
    EXPECT_EQ(smooth.report.capped > 0, gap < 0.3);
    double worst = 0;
    for (int i = 0; i < 400; ++i) {
      const double a = (i / 20 - 10) * 0.06, z = 2 + 0.2 * (i % 20);
      const Vec3 wall(std::cos(a), std::sin(a), z);
      const Projection p = project(*smooth.surface, wall - 0.3 * gap * Vec3(std::cos(a), std::sin(a), 0));
      EXPECT_TRUE(p.converged);
      worst = std::max(worst, std::abs(shape.distance(p.point)));
    }
    EXPECT_LT(worst, 1e-3) << gap;
    const double middle = smooth.surface->value(Vec3(1 + gap / 2, 0, 4));
    EXPECT_NEAR(middle, gap / 2, 0.3 * gap) << gap;
  }
}

TEST(SmoothSurface, ReportsHowFarItIsFromTheFacets) {
  const TubeShape shape;
  const SmoothReport report = make_smooth_surface(prepare_surface(shape.triangles(32)), shape.network()).report;
  const double sagitta = 1 - std::cos(std::numbers::pi / 32);
  EXPECT_NEAR(report.deviation_max, sagitta, 0.05 * sagitta);
  EXPECT_GT(report.deviation_mean, 0.5 * sagitta);
  EXPECT_EQ(report.points, report.degrees[3]);
  EXPECT_EQ(report.curved, 0);
}

TEST(SmoothSurface, SameBitsForAnyNumberOfThreads) {
  const TorusShape shape;
  vasohex::Run one, three;
  one.threads = 1;
  three.threads = 3;
  const PreparedSurface prepared = prepare_surface(shape.triangles(32));
  const SmoothSurface a = make_smooth_surface(prepared, shape.network(), {}, one);
  const SmoothSurface b = make_smooth_surface(prepared, shape.network(), {}, three);
  Random random(7);
  for (int i = 0; i < 500; ++i) {
    const Vec3 x = random.on(prepared.surface) + random.in_box(0.3);
    EXPECT_EQ(a.surface->value(x), b.surface->value(x));
  }
  EXPECT_EQ(a.report.deviation_max, b.report.deviation_max);
  EXPECT_EQ(a.report.deviation_mean, b.report.deviation_mean);
}

TEST(SmoothSurface, CommutesWithMotion) {
  const TubeShape shape;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.9, Vec3(2, -1, 3).normalized()).toRotationMatrix();
  const auto move = [&](const Vec3& p) { return Vec3(10 * (turn * p) + Vec3(3, 4, 5)); };
  TriSurface moved = shape.triangles(24);
  Network network = shape.network();
  for (Vec3& p : moved.points) {
    p = move(p);
  }
  for (std::size_t i = 0; i < network.branches[0].points.size(); ++i) {
    network.branches[0].points[i] = move(network.branches[0].points[i]);
    network.branches[0].radii[i] *= 10;
  }
  const SmoothSurface a = make_smooth_surface(prepare_surface(shape.triangles(24)), shape.network());
  const SmoothSurface b = make_smooth_surface(prepare_surface(moved), network);
  Random random(8);
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = random.on(shape.triangles(24)) + random.in_box(0.3);
    EXPECT_NEAR(10 * a.surface->value(x), b.surface->value(move(x)), 1e-9);
  }
}

}  // namespace
}  // namespace vasohex
