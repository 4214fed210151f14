// Meshes that conform to a given lumen: sections that are not circles, ends cut askew, skeletons that stop short.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gallery.h"
#include "mesh_properties.h"
#include "vasohex/blocks/clear_ends.h"
#include "vasohex/core/reference_hex.h"
#include "vasohex/quality/quality_report.h"
#include "vasohex/skeleton/tie_ends.h"
#include "vasohex/vasohex.h"

namespace vasohex {
namespace {

/// Tubes squeezed along z: ellipses as sections, ends that are not at right angles to the axis.
class Squeezed final : public ImplicitSurface {
 public:
  Squeezed(const Network& network, double factor)
      : round_(make_convolution_surface(network)), factor_(1, 1, 1 / factor) {}
  double value(const Vec3& x) const override { return round_->value(x.cwiseProduct(factor_)); }
  double value(const Vec3& x, Vec3& gradient) const override {
    const double v = round_->value(x.cwiseProduct(factor_), gradient);
    gradient = gradient.cwiseProduct(factor_);
    return v;
  }
  double radius(const Vec3& x) const override { return round_->radius(x.cwiseProduct(factor_)); }

 private:
  std::unique_ptr<ImplicitSurface> round_;
  Vec3 factor_;
};

struct SqueezedCase {
  Skeleton skeleton;
  Lumen lumen;
  std::shared_ptr<const ImplicitSurface> surface;
};

SqueezedCase squeezed(const Skeleton& skeleton, double factor) {
  const Vec3 by(1, 1, factor);
  Network network = build_network(skeleton);
  clear_ends(network);
  SqueezedCase c;
  c.surface = std::make_shared<Squeezed>(network, factor);
  c.lumen.surface = [surface = c.surface](const Network&) { return surface; };
  for (const Branch& branch : network.branches) {
    for (const int end : {0, 1}) {
      if (network.nodes[branch.nodes[end]].degree == 1) {
        const Vec3 outward = end == 0 ? Vec3(-branch.tangents.front()) : branch.tangents.back();
        const Vec3& centre = end == 0 ? branch.points.front() : branch.points.back();
        const double radius = end == 0 ? branch.radii.front() : branch.radii.back();
        c.lumen.ends.push_back({centre.cwiseProduct(by), outward.cwiseQuotient(by).normalized(), radius});
      }
    }
  }
  c.skeleton = skeleton;
  for (Vec3& p : c.skeleton.points) {
    p = p.cwiseProduct(by);
  }
  for (double& r : c.skeleton.radii) {
    r *= std::sqrt(factor);
  }
  return c;
}

/// Nodes of the wall lie on the surface, those of the ends in their planes.
void expect_on_wall_and_ends(const SkeletonMesh& m, const ImplicitSurface& surface) {
  const HexMesh& mesh = m.result.mesh;
  const int n = mesh.order + 1;
  for (const HexMesh::BoundaryFace& face : mesh.boundary) {
    const SectionFrame* end = face.surface > 0 ? &m.blocks.ends[face.surface - 1] : nullptr;
    for (int i = 0; i < n * n * n; ++i) {
      const std::array<int, 3> at{i % n, i / n % n, i / n / n};
      if (at[face.face / 2] != (face.face % 2 == 1 ? mesh.order : 0)) {
        continue;
      }
      const Vec3& x = mesh.nodes[mesh.elements[static_cast<std::size_t>(face.element) * n * n * n + i]];
      if (end) {
        EXPECT_NEAR((x - end->origin).dot(end->normal()), 0, 1e-9);
      } else {
        EXPECT_NEAR(surface.value(x), 0, 1e-7);
      }
    }
  }
}

TEST(Lumen, MayHaveEllipsesForSections) {
  const std::vector<Skeleton> shapes{gallery::tube(8, 1),
                                     gallery::linked(6),
                                     gallery::linked(1.2),
                                     gallery::random_star(3, 1, 30),
                                     gallery::random_star(4, 1, 30),
                                     gallery::random_star(5, 1, 30),
                                     gallery::torus(4, 1),
                                     gallery::ring_with_arms()};
  for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
    SCOPED_TRACE(shape);
    const SqueezedCase c = squeezed(shapes[shape], 1.4);
    SkeletonMeshOptions options;
    options.mesh.order = 3;
    options.grading.elements = 2;
    const SkeletonMesh m = mesh_lumen(c.skeleton, c.lumen, options);
    const HexMesh& mesh = m.result.mesh;
    const QualityReport quality = measure_quality(mesh);
    EXPECT_EQ(quality.certified, mesh.element_count());
    EXPECT_GT(quality.scaled_jacobian.min, 0.6);
    EXPECT_EQ(m.result.unconverged, 0);
    expect_on_wall_and_ends(m, *c.surface);
    for (const SectionFrame& end : m.blocks.ends) {  // in the planes that the lumen is cut by
      EXPECT_TRUE(std::any_of(c.lumen.ends.begin(), c.lumen.ends.end(), [&](const SurfaceEnd& e) {
        return (e.centre - end.origin).norm() < 1e-6 && e.normal.dot(end.normal()) > 1 - 1e-9;
      }));
    }
  }
}

TEST(Lumen, MayBeCutBeforeASideBranchHasLeft) {
  // The cut meets the foot of the branch: its rim has a bump there, and the wall behind it is narrow and leans.
  const auto skeleton = [](double length) {
    Skeleton s;
    s.points = {{-6, 0, 0}, {0, 0, 0}, {0, 0, 5}, {length, 0, 0}};
    s.radii = {1, 1, 0.5, 1};
    s.segments = {{0, 1}, {1, 2}, {1, 3}};
    return s;
  };
  const auto surface = std::make_shared<Squeezed>(build_network(skeleton(6)), 1);
  for (const double length : {0.92, 1.0}) {
    SCOPED_TRACE(length);
    Lumen lumen;
    lumen.surface = [&](const Network&) { return surface; };
    lumen.ends = {{Vec3(-6, 0, 0), -Vec3::UnitX(), 1},
                  {Vec3(0, 0, 5), Vec3::UnitZ(), 0.5},
                  {Vec3(length, 0, 0), Vec3::UnitX(), 1}};
    SkeletonMeshOptions options;
    options.mesh.order = 3;
    options.grading.elements = 3;
    const SkeletonMesh m = mesh_lumen(skeleton(length), lumen, options);
    const QualityReport quality = measure_quality(m.result.mesh);
    EXPECT_EQ(quality.certified, m.result.mesh.element_count());
    EXPECT_GT(quality.scaled_jacobian.min, length < 1 ? 0.4 : 0.7);  // with a rim that stays: .33
    expect_on_wall_and_ends(m, *surface);
  }
}

TEST(TieEnds, ProlongsAndCutsAndNamesTheRest) {
  Skeleton s = gallery::tube(8, 1);
  const Vec3 first = s.points.front(), last = s.points.back();
  const Vec3 along = (last - first).normalized();
  const Vec3 aside = along.unitOrthogonal();
  // one end two radii beyond the skeleton's, one a radius and a half before it, one that no vessel leads to
  const std::vector<SurfaceEnd> ends{{first - 2 * along + 0.3 * aside, (-along + 0.2 * aside).normalized(), 1.1},
                                     {last - 1.5 * along, along, 0.9},
                                     {first + 30 * aside, aside, 1}};
  std::vector<std::string> notes;
  const std::vector<int> points = tie_ends(s, ends, notes);
  ASSERT_EQ(points, (std::vector<int>{0, static_cast<int>(s.points.size()) - 1, -1}));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("not meshed"), std::string::npos) << notes[0];
  Network network = build_network(s);
  face_ends(network, ends, points);
  ASSERT_EQ(network.branches.size(), 1u);
  const Branch& branch = network.branches[0];
  EXPECT_LT((branch.points.front() - ends[0].centre).norm(), 1e-9);
  EXPECT_LT((branch.points.back() - ends[1].centre).norm(), 1e-9);
  EXPECT_GT(branch.tangents.front().dot(-ends[0].normal), 1 - 1e-12);
  EXPECT_GT(branch.tangents.back().dot(ends[1].normal), 1 - 1e-12);
  for (std::size_t i = 1; i < branch.points.size(); ++i) {  // no folds: forward all along
    EXPECT_GT((branch.points[i] - branch.points[i - 1]).dot(along), 0);
  }
}

TEST(TieEnds, LeavesVesselsAloneThatTurnRound) {
  // a hairpin, its legs 4 radii apart: the other leg reaches beyond the plane of the end
  Skeleton s;
  const auto add = [&](double x, double y) {
    s.points.emplace_back(x, y, 0);
    s.radii.push_back(1);
    if (s.points.size() > 1) {
      s.segments.push_back({static_cast<int>(s.points.size()) - 2, static_cast<int>(s.points.size()) - 1});
    }
  };
  for (double x = 0; x < 4; x += 0.4) {
    add(x, 0);
  }
  for (double angle = 0; angle < std::numbers::pi; angle += 0.2) {
    add(4 + 2 * std::sin(angle), 2 - 2 * std::cos(angle));
  }
  for (double x = 4; x > -9; x -= 0.4) {
    add(x, 4);
  }
  const Skeleton before = s;
  std::vector<std::string> notes;
  EXPECT_EQ(tie_ends(s, {{s.points[0], -Vec3::UnitX(), 1}}, notes), std::vector<int>{0});
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    EXPECT_LT((s.points[i] - before.points[i]).norm(), 0.1) << i;
  }
}

/// A tube along x from 0, closed by a half sphere: radius 1.
class TestTube final : public ImplicitSurface {
 public:
  explicit TestTube(double length) : length_(length) {}
  double value(const Vec3& x) const override { return from_axis(x).norm() - 1; }
  double value(const Vec3& x, Vec3& gradient) const override {
    const Vec3 d = from_axis(x);
    gradient = d.norm() > 0 ? Vec3(d.normalized()) : Vec3(Vec3::UnitY());
    return d.norm() - 1;
  }
  double radius(const Vec3&) const override { return 1; }

 private:
  Vec3 from_axis(const Vec3& x) const { return x - std::min(x.x(), length_) * Vec3::UnitX(); }
  double length_;
};

Skeleton straight_skeleton() {
  Skeleton s;
  for (int i = 0; i <= 8; ++i) {
    s.points.emplace_back(i, 0, 0);
    s.radii.push_back(1);
    if (i > 0) {
      s.segments.push_back({i - 1, i});
    }
  }
  return s;
}

TEST(Lumen, MayCloseWithoutAnEnd) {
  Lumen lumen;
  lumen.ends = {{Vec3::Zero(), -Vec3::UnitX(), 1}};
  lumen.surface = [](const Network&) { return std::make_shared<TestTube>(8); };
  SkeletonMeshOptions options;
  options.mesh.order = 3;
  options.grading.elements = 2;
  const SkeletonMesh m = mesh_lumen(straight_skeleton(), lumen, options);
  const QualityReport quality = measure_quality(m.result.mesh);
  EXPECT_EQ(quality.certified, m.result.mesh.element_count());
  EXPECT_GT(quality.scaled_jacobian.min, 0.5);
  EXPECT_EQ(m.result.mesh.surfaces, (std::vector<std::string>{"wall", "inlet"}));
  double furthest = 0;
  for (const Vec3& p : m.result.mesh.nodes) {
    furthest = std::max(furthest, p.x());
  }
  EXPECT_NEAR(furthest, 9, 0.01);  // the wall of the half sphere is reached
}

/// A round tube along x, wider than 1 by profile(x, slope).
class WidenedTube final : public ImplicitSurface {
 public:
  using Profile = double (*)(double x, double& slope);
  explicit WidenedTube(Profile profile) : profile_(profile) {}
  double value(const Vec3& x) const override {
    Vec3 gradient;
    return value(x, gradient);
  }
  double value(const Vec3& x, Vec3& gradient) const override {
    const Vec3 across(0, x.y(), x.z());
    double slope = 0;
    const double wider = profile_(x.x(), slope);
    gradient = across.norm() > 0 ? Vec3(across.normalized()) : Vec3(Vec3::UnitY());
    gradient.x() = -slope;
    return across.norm() - 1 - wider;
  }
  double radius(const Vec3&) const override { return 1; }

 private:
  Profile profile_;
};

/// A ridge all around, narrower than an element: .24 high and as wide.
constexpr double kRidgeAt = 4.22;
double ridge(double x, double& slope) {
  const double off = x - kRidgeAt, high = std::max(0.0, 0.24 - 2 * std::abs(off));
  slope = high > 0 ? (off > 0 ? -2 : 2) : 0;
  return high;
}

/// Half as wide again at x = 4.
double bulge(double x, double& slope) {
  const double off = (x - 4) / 0.35, high = 0.5 * std::exp(-off * off);
  slope = -high * 2 * off / 0.35;
  return high;
}

Lumen open_tube(std::shared_ptr<const ImplicitSurface> surface) {
  Lumen lumen;
  lumen.ends = {{Vec3::Zero(), -Vec3::UnitX(), 1}, {Vec3(8, 0, 0), Vec3::UnitX(), 1}};
  lumen.surface = [surface = std::move(surface)](const Network&) { return surface; };
  return lumen;
}

TEST(Lumen, LayersAreShorterWhereTheWallBulges) {
  SkeletonMeshOptions options;
  options.mesh.order = 2;
  options.grading.elements = 3;
  const SkeletonMesh m = mesh_lumen(straight_skeleton(), open_tube(std::make_shared<WidenedTube>(bulge)), options);
  const QualityReport quality = measure_quality(m.result.mesh);
  EXPECT_EQ(quality.certified, m.result.mesh.element_count());
  EXPECT_GT(quality.scaled_jacobian.min, 0.4);
  int shorter = 0;
  for (const std::vector<Stretch>& region : m.blocks.regions) {
    ASSERT_EQ(region.size(), 1u);
    const double middle = 0.5 * (region[0].from + region[0].to);
    if (region[0].to - region[0].from < 1.5) {
      ++shorter;
      EXPECT_LT(std::abs(middle - 4), 2) << "a layer of " << options.blocks.block_length << " radii would do";
    }
  }
  EXPECT_GE(shorter, 2);
}

TEST(Lumen, ElementsDoNotFoldAtCreases) {
  const auto surface = std::make_shared<WidenedTube>(ridge);
  for (const int order : {4, 5}) {
    SCOPED_TRACE(order);
    SkeletonMeshOptions options;
    options.mesh.order = order;
    options.grading.elements = 3;
    const SkeletonMesh m = mesh_lumen(straight_skeleton(), open_tube(surface), options);
    const HexMesh& mesh = m.result.mesh;
    const QualityReport quality = measure_quality(mesh);
    EXPECT_EQ(quality.certified, mesh.element_count());
    EXPECT_GT(quality.scaled_jacobian.min, 0.45);
    EXPECT_EQ(m.result.unconverged, 0);
    EXPECT_GT(m.result.relaxed.nodes, 0);
    EXPECT_LT(m.result.relaxed.largest, 0.24);
    EXPECT_LT(std::abs(m.result.relaxed.place.x() - kRidgeAt), 0.7);
    // only there, and corners of elements lie on the surface everywhere
    const int n = order + 1;
    int off = 0;
    for (const HexMesh::BoundaryFace& face : mesh.boundary) {
      for (int at = 0; face.surface == 0 && at < n * n; ++at) {
        const Vec3& x = mesh.nodes[mesh.elements[static_cast<std::size_t>(face.element) * n * n * n +
                                                 hex_face_point(face.face, at % n, at / n, {n, n, n})]];
        const bool corner = (at % n == 0 || at % n == order) && (at / n == 0 || at / n == order);
        const double distance = std::abs(surface->value(x));
        off += distance > 1e-6;
        EXPECT_LT(distance, corner || std::abs(x.x() - kRidgeAt) > 0.7 ? 1e-7 : 0.24);
      }
    }
    EXPECT_GT(off, 0);
    vasohex::Run three;
    three.threads = 3;
    EXPECT_EQ(mesh_lumen(straight_skeleton(), open_tube(surface), options, three).result.mesh.nodes, mesh.nodes);
  }
}

TEST(Lumen, SmoothWallsAreLeftAlone) {
  for (const Skeleton& skeleton : {gallery::linked(2), gallery::random_star(3, 2, 30)}) {
    SkeletonMeshOptions options;
    options.mesh.order = 3;
    options.grading.elements = 2;
    EXPECT_EQ(mesh_skeleton(skeleton, options).result.relaxed.nodes, 0);
  }
}

TEST(WallReach, NamesThePlacesThatAreNotReached) {
  Lumen lumen = open_tube(std::make_shared<TestTube>(100));
  const auto on_wall = [](double x, double angle, double off) {
    return Vec3(x, (1 + off) * std::cos(angle), (1 + off) * std::sin(angle));
  };
  lumen.wall = [&](const ImplicitSurface&) {
    std::vector<Vec3> points;
    for (double x = -2; x < 10; x += 0.1) {  // beyond the ends, too
      for (double a = 0; a < 6.28; a += 0.1) {
        const double dent = std::exp(-8 * (x - 3) * (x - 3)) * (a > 1 && a < 1.6 ? 1 : 0);
        const double bulge = std::abs(x - 6) < 0.3 && a > 4 && a < 4.6 ? 0.2 : 0;
        points.push_back(on_wall(x, a, bulge - 0.4 * dent));
      }
    }
    return points;
  };
  SkeletonMeshOptions options;
  options.mesh.order = 3;
  options.grading.elements = 2;
  const WallReach reach = mesh_lumen(straight_skeleton(), lumen, options).reach;
  ASSERT_EQ(reach.unreached.size(), 2u);
  EXPECT_NEAR(reach.unreached[0].radii, 0.4, 0.02);
  EXPECT_NEAR(reach.unreached[0].distance, 0.4, 0.02);
  EXPECT_NEAR(reach.unreached[0].at.x(), 3, 0.11);
  EXPECT_NEAR(reach.unreached[1].radii, 0.2, 0.02);
  EXPECT_LT(std::abs(reach.unreached[1].at.x() - 6), 0.31);
  EXPECT_NEAR(reach.max, reach.unreached[0].radii, 1e-12);
  EXPECT_NEAR(reach.points, 80 * 63, 2 * 63);
  EXPECT_GT(reach.p99, 0.05);
  EXPECT_LT(reach.p99, 0.3);
  EXPECT_LT(reach.mean, 0.02);
}

TEST(WallReach, PointsLieOnTheTrianglesAllOverThem) {
  TriSurface s;
  s.points = {Vec3(0, 0, 0), Vec3(6, 0, 0), Vec3(0, 0.2, 0)};
  s.triangles = {{0, 1, 2}};
  const std::vector<Vec3> points = points_on(s, TestTube(1));
  for (double x = 0.2; x < 5.8; x += 0.1) {
    const Vec3 middle(x, 0.1 * (1 - x / 6), 0);
    EXPECT_LT((*std::min_element(points.begin(), points.end(),
                                 [&](const Vec3& a, const Vec3& b) {
                                   return (a - middle).squaredNorm() < (b - middle).squaredNorm();
                                 }) -
               middle)
                  .norm(),
              0.3);
  }
  for (const Vec3& p : points) {
    EXPECT_TRUE(p.z() == 0 && p.y() > 0 && p.x() > 0 && p.x() / 6 + p.y() / 0.2 < 1);
  }
}

}  // namespace
}  // namespace vasohex
