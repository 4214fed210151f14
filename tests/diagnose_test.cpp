#include "vasohex/skeleton/diagnose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gallery.h"
#include "vasohex/quality/quality_report.h"
#include "vasohex/skeleton/build_network.h"
#include "vasohex/skeleton/repair.h"
#include "vasohex/vasohex.h"

namespace vasohex {
namespace {

using gallery::both;
using gallery::curve;
using gallery::star;

constexpr double kPi = std::numbers::pi;

/// A straight tube of `length` through `middle`.
Skeleton straight(const Vec3& middle, const Vec3& direction, double length, double radius) {
  return curve([=](double t) -> Vec3 { return middle + (t - 0.5) * length * direction.normalized(); }, radius,
               static_cast<int>(std::max(1.0, length / radius)), false);
}

/// Two tubes of radii 1 and .5 whose axes cross at right angles, `distance` apart.
Skeleton crossing(double distance) {
  return both(straight(Vec3::Zero(), Vec3::UnitX(), 20, 1), straight(Vec3::Zero(), Vec3::UnitY(), 20, .5),
              Vec3(0, 0, distance));
}

std::vector<Finding> findings_of(const Skeleton& s) { return diagnose(build_network(s)); }

int count(const std::vector<Finding>& findings, FindingKind kind) {
  return static_cast<int>(
      std::count_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.kind == kind; }));
}

std::string listed(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) {
    text += std::string(name_of(f.severity)) + ": " + f.text + "\n";
  }
  return text;
}

bool told(const Network& network, const std::string& part) {
  return std::any_of(network.repairs.begin(), network.repairs.end(),
                     [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

// ---------------------------------------------------------------------------------------------------- nothing

TEST(Diagnose, GalleryHasNoErrors) {
  for (const gallery::Shape& shape : gallery::shapes()) {
    for (const Finding& f : findings_of(shape.skeleton)) {
      EXPECT_NE(f.severity, Severity::error) << shape.name << ": " << f.text;
    }
  }
}

TEST(Diagnose, ForksThatPartGiveNothing) {
  for (const double degrees : {15., 20., 30., 60., 120., 180.}) {  // at 15 degrees they part 7.7 radii from the node
    const double a = degrees * kPi / 360;
    const auto f =
        findings_of(star({{-1, 0, 0}, {std::cos(a), std::sin(a), 0}, {std::cos(a), -std::sin(a), 0}}, {1, 1, 1}, 30));
    EXPECT_TRUE(f.empty()) << degrees << "\n" << listed(f);
  }
  for (const double thin : {.08, .2, .5}) {  // thin side branches of a wide vessel
    const auto f = findings_of(star({{-1, 0, 0}, {1, 0, 0}, {.7, 1, 0}}, {1, 1, thin}, 8));
    EXPECT_TRUE(f.empty()) << thin << "\n" << listed(f);
  }
}

// ------------------------------------------------------------------------------------------- overlap and touch

TEST(Diagnose, CrossingTubes) {
  for (const double distance : {.3, .9, 1.2, 1.49}) {
    const auto f = findings_of(crossing(distance));
    ASSERT_EQ(f.size(), 1u) << distance << "\n" << listed(f);
    EXPECT_EQ(f[0].kind, FindingKind::overlap);
    EXPECT_EQ(f[0].severity, Severity::error);
    EXPECT_NEAR(f[0].figure, (1.5 - distance) / .5, 1e-4);
    EXPECT_EQ(f[0].branches, (std::array<int, 2>{0, 1}));
    EXPECT_LT((f[0].at - Vec3(0, 0, distance * 2 / 3)).norm(), 1e-2);
  }
  const auto touch = findings_of(crossing(1.51));
  ASSERT_EQ(touch.size(), 1u);
  EXPECT_EQ(touch[0].kind, FindingKind::touch);
  EXPECT_EQ(touch[0].severity, Severity::warning);
  EXPECT_NEAR(touch[0].figure, .02, 1e-4);
  EXPECT_TRUE(findings_of(crossing(1.53)).empty());
}

TEST(Diagnose, ParallelTubes) {
  for (const double gap : {-.3, .03, .06}) {
    const auto f = findings_of(both(straight(Vec3::Zero(), Vec3::UnitX(), 20, 1),
                                    straight(Vec3::Zero(), Vec3::UnitX(), 20, 1), Vec3(1, 2 + gap, 0)));
    ASSERT_EQ(f.size(), gap < .05 ? 1u : 0u) << gap << "\n" << listed(f);
    if (gap < .05) {
      EXPECT_EQ(f[0].kind, gap < 0 ? FindingKind::overlap : FindingKind::touch);
      EXPECT_NEAR(f[0].figure, std::abs(gap), 1e-6);
    }
  }
}

TEST(Diagnose, EndInAnotherVessel) {
  const Skeleton s = both(straight(Vec3::Zero(), Vec3::UnitX(), 20, 1),
                          straight(Vec3(0, 5.5, 0), Vec3::UnitY(), 10, .5), Vec3::Zero());
  const auto f = findings_of(s);
  ASSERT_EQ(f.size(), 1u) << listed(f);
  EXPECT_EQ(f[0].kind, FindingKind::overlap);
  EXPECT_EQ(f[0].point, 21);
  EXPECT_NE(f[0].cure.find("ends there, at point 21: join it"), std::string::npos) << f[0].cure;
}

TEST(Diagnose, CoilThatTouchesItself) {
  const auto coil = [](double pitch) {
    return curve([=](double t) { return Vec3(4 * std::cos(6 * kPi * t), 4 * std::sin(6 * kPi * t), 3 * pitch * t); },
                 1, 90, false);
  };
  // neighbouring turns are pitch * cos(slope) apart
  const auto distance = [](double pitch) { return pitch * std::cos(std::atan(pitch / (8 * kPi))); };
  EXPECT_TRUE(findings_of(coil(2.2)).empty());
  const auto f = findings_of(coil(1.8));
  ASSERT_EQ(f.size(), 1u) << listed(f);
  EXPECT_EQ(f[0].kind, FindingKind::overlap);
  EXPECT_EQ(f[0].branches, (std::array<int, 2>{0, 0}));
  EXPECT_NEAR(f[0].figure, 2 - distance(1.8), .01);
  EXPECT_EQ(count(findings_of(coil(2.04)), FindingKind::touch), 1);
}

TEST(Diagnose, DaughtersThatMeetAgain) {
  // part at 90 degrees, turn, and run side by side: overlapping far from the fork
  Skeleton s = star({{-1, 0, 0}}, {1}, 6);
  for (const int side : {1, -1}) {
    int before = 0;
    for (int i = 1; i <= 40; ++i) {
      const double x = .5 * i;
      s.points.push_back(Vec3(x, side * (.9 + 2 - 2 * std::cos(kPi * std::min(x, 12.) / 6)), 0));
      s.radii.push_back(1);
      s.segments.push_back({before, static_cast<int>(s.points.size()) - 1});
      before = static_cast<int>(s.points.size()) - 1;
    }
  }
  s.points[0] = Vec3(0, 0, 0);
  const auto f = findings_of(s);
  ASSERT_EQ(count(f, FindingKind::overlap), 1) << listed(f);
  EXPECT_NEAR(f[0].figure, .2, .05);
  EXPECT_GT(f[0].at.x(), 10);
}

TEST(Diagnose, DaughtersThatNeverPart) {
  const double a = 2 * kPi / 180;  // parted only 29 radii away
  const auto f =
      findings_of(star({{-1, 0, 0}, {std::cos(a), std::sin(a), 0}, {std::cos(a), -std::sin(a), 0}}, {1, 1, 1}, 60));
  ASSERT_EQ(f.size(), 1u) << listed(f);
  EXPECT_EQ(f[0].kind, FindingKind::side_by_side);
}

// ------------------------------------------------------------------------------------------------ single vessels

TEST(Diagnose, Hairpin) {
  const auto f = findings_of(curve(
      [](double t) {  // two straight limbs 1.4 apart and a half circle
        const double s = 24 * t - 12, turn = .7 * kPi / 2;
        return std::abs(s) < turn ? Vec3(.7 * std::cos(s / .7), .7 * std::sin(s / .7), 0)
                                  : Vec3(turn - std::abs(s), s > 0 ? .7 : -.7, 0);
      },
      1, 60, false));
  EXPECT_EQ(count(f, FindingKind::hairpin), 1) << listed(f);
  EXPECT_GE(count(f, FindingKind::sharp_bend), 1) << listed(f);
  EXPECT_EQ(count(f, FindingKind::overlap), 0) << listed(f);
}

TEST(Diagnose, BendSharperThanItsRadius) {
  const auto bend = [](double bend_radius) {  // a quarter circle; build_network would soften it
    Network n;
    n.nodes = {{Vec3(bend_radius, 0, 0), 1, 1, 0, false, false, "inlet"},
               {Vec3(0, bend_radius, 0), 1, 1, 1, false, false, "outlet"}};
    Branch b;
    b.nodes = {0, 1};
    for (int i = 0; i <= 40; ++i) {
      const double a = kPi / 2 * i / 40;
      b.points.push_back(Vec3(bend_radius * std::cos(a), bend_radius * std::sin(a), 0));
      b.tangents.push_back(Vec3(-std::sin(a), std::cos(a), 0));
      b.radii.push_back(1);
      b.arc.push_back(bend_radius * a);
    }
    n.branches = {b};
    return diagnose(n);
  };
  EXPECT_TRUE(bend(1.15).empty());
  for (const double radius : {1.05, .8}) {
    const auto f = bend(radius);
    ASSERT_EQ(f.size(), 1u) << listed(f);
    EXPECT_EQ(f[0].kind, FindingKind::sharp_bend);
    EXPECT_EQ(f[0].severity, radius < 1 ? Severity::error : Severity::warning);
    EXPECT_NEAR(f[0].figure, 1 / radius, 1e-3);
  }
}

TEST(Diagnose, ThinBranch) {
  EXPECT_EQ(count(findings_of(star({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}}, {1, 1, .04}, 12)), FindingKind::thin_branch), 0);
  const auto f = findings_of(star({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}}, {1, 1, .02}, 12));
  ASSERT_EQ(count(f, FindingKind::thin_branch), 1) << listed(f);
  EXPECT_LT(f[0].at.norm(), 1e-9);
  EXPECT_NEAR(f[0].figure, 50, 1);
}

TEST(Diagnose, SteepTaper) {
  Skeleton s = straight(Vec3::Zero(), Vec3::UnitX(), 24, 1);
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    s.radii[i] = std::clamp(2 + .7 * s.points[i].x(), 1., 3.);
  }
  const auto f = findings_of(s);
  ASSERT_EQ(f.size(), 1u) << listed(f);
  EXPECT_EQ(f[0].kind, FindingKind::steep_taper);
  EXPECT_NEAR(f[0].figure, .7, .1);
}

// -------------------------------------------------------------------------------- stubs, fragments, junctions

Skeleton with_stub(double length) {
  Skeleton s = straight(Vec3::Zero(), Vec3::UnitX(), 12, 1);
  s.points.push_back(Vec3(0, length, 0));
  s.radii.push_back(.3);
  s.segments.push_back({6, 13});
  return s;
}

TEST(Diagnose, Stub) {
  const auto f = findings_of(with_stub(.6));
  ASSERT_EQ(f.size(), 1u) << listed(f);
  EXPECT_EQ(f[0].kind, FindingKind::stub);
  EXPECT_EQ(f[0].point, 13);
  EXPECT_NEAR(f[0].figure, .6, 1e-9);
  EXPECT_TRUE(findings_of(with_stub(2)).empty());
}

/// A branch of the straight tube that runs along it, `off` away from its axis at the free end, as do graphs of one
/// vessel traced twice.
Skeleton with_buried_branch(double length, double off) {
  Skeleton s = straight(Vec3::Zero(), Vec3::UnitX(), 24, 1);
  const Vec3 from = s.points[6];
  s.points.push_back(from + Vec3(length, off, 0));
  s.radii.push_back(.4);
  s.segments.push_back({6, static_cast<int>(s.points.size()) - 1});
  return s;
}

TEST(Diagnose, BranchesThatEndInAnotherAreStubsHoweverLong) {
  for (const double length : {3., 6., 15.}) {
    const Skeleton s = with_buried_branch(length, .5);
    const auto f = findings_of(s);
    ASSERT_EQ(count(f, FindingKind::stub), 1) << length << "\n" << listed(f);
    const auto stub =
        *std::find_if(f.begin(), f.end(), [](const Finding& x) { return x.kind == FindingKind::stub; });
    EXPECT_EQ(stub.point, static_cast<int>(s.points.size()) - 1);
    EXPECT_NEAR(stub.figure, std::hypot(length, .5), .01 * length);
    const Network n = build_repaired_network(s);
    EXPECT_EQ(n.branches.size(), 1u);
    EXPECT_TRUE(told(n, "left out: "));
    EXPECT_EQ(build_network(s).branches.size(), 3u);  // only who asks for repair loses an end
    Skeleton named = s;
    named.names[stub.point] = "biopsy";
    EXPECT_EQ(build_repaired_network(named).branches.size(), 3u);
    // an end that sticks out is none
    EXPECT_EQ(count(findings_of(with_buried_branch(length, 1.5)), FindingKind::stub), 0) << length;
  }
}

TEST(Diagnose, OfBranchesInEachOtherTheNarrowerIsTheStub) {
  // both end at the same distance, each inside the other; the numbers of the points must not matter
  for (const bool first : {true, false}) {
    Skeleton s = straight(Vec3::Zero(), Vec3::UnitX(), 12, 1);
    const Vec3 fork = s.points.back();
    const int at = static_cast<int>(s.points.size()) - 1;
    for (const double side : {.15, -.15}) {
      s.points.push_back(fork + Vec3(8, side, 0));
      s.radii.push_back((side > 0) == first ? .5 : .9);
      s.segments.push_back({at, static_cast<int>(s.points.size()) - 1});
    }
    const auto f = findings_of(s);
    ASSERT_EQ(count(f, FindingKind::stub), 1) << listed(f);
    const auto stub =
        *std::find_if(f.begin(), f.end(), [](const Finding& x) { return x.kind == FindingKind::stub; });
    EXPECT_EQ(stub.point, first ? at + 1 : at + 2);
    EXPECT_EQ(build_repaired_network(s).branches.size(), 1u);
  }
}

/// A tube of radius 1 along x from -12 to 12; from its point at -6 a branch rises and comes back down to a fork of
/// radius .4 that is `off` away from the axis at x = 0.
Skeleton with_fork_inside(double off) {
  Skeleton s = straight(Vec3::Zero(), Vec3::UnitX(), 24, 1);
  const int first = static_cast<int>(s.points.size());
  for (const Vec3& p : {Vec3(-3, 1.2, 0), Vec3(0, off, 0), Vec3(4, 5, 1), Vec3(4, 5, -3)}) {
    s.points.push_back(p);
    s.radii.push_back(.4);
  }
  s.segments.insert(s.segments.end(),
                    {{6, first}, {first, first + 1}, {first + 1, first + 2}, {first + 1, first + 3}});
  return s;
}

TEST(Diagnose, NodesInVesselsThatTheyAreNotJoinedTo) {
  for (const double off : {.2, .6}) {
    const Skeleton s = with_fork_inside(off);
    const int fork = static_cast<int>(s.points.size()) - 3;
    const auto all = findings_of(s);
    ASSERT_EQ(count(all, FindingKind::unjoined), 1) << off << "\n" << listed(all);
    const auto f =
        *std::find_if(all.begin(), all.end(), [](const Finding& x) { return x.kind == FindingKind::unjoined; });
    EXPECT_EQ(f.point, fork);
    EXPECT_NEAR(f.figure, off, .05);
    EXPECT_EQ(f.at, s.points[fork]);
    // the cure
    Skeleton joined = s;
    const int at = 12;
    for (auto& [a, b] : joined.segments) {
      a = a == fork ? at : a;
      b = b == fork ? at : b;
    }
    EXPECT_EQ(s.points[at].x(), 0);
    EXPECT_EQ(count(findings_of(joined), FindingKind::unjoined), 0);
  }
  const auto outside = findings_of(with_fork_inside(1.2));
  EXPECT_EQ(count(outside, FindingKind::unjoined), 0) << listed(outside);
  for (const gallery::Shape& shape : gallery::shapes()) {
    EXPECT_EQ(count(findings_of(shape.skeleton), FindingKind::unjoined), 0) << shape.name;
  }
}

TEST(Diagnose, StrayPieces) {
  const Skeleton tube = straight(Vec3::Zero(), Vec3::UnitX(), 30, 1);
  const auto tiny = findings_of(both(tube, straight(Vec3::Zero(), Vec3::UnitX(), .3, .3), Vec3(0, 5, 0)));
  ASSERT_EQ(tiny.size(), 1u) << listed(tiny);
  EXPECT_EQ(tiny[0].kind, FindingKind::fragment);
  EXPECT_EQ(tiny[0].severity, Severity::warning);
  const auto inner = findings_of(both(tube, straight(Vec3::Zero(), Vec3::UnitX(), 6, .3), Vec3(1, .2, 0)));
  ASSERT_EQ(inner.size(), 1u) << listed(inner);
  EXPECT_EQ(inner[0].kind, FindingKind::fragment);
  EXPECT_EQ(inner[0].severity, Severity::error);
}

TEST(Diagnose, NearJunctions) {
  Skeleton s = straight(Vec3::Zero(), Vec3::UnitX(), 12, 1);
  s.points.push_back(Vec3(-.4, 5, 0));
  s.points.push_back(Vec3(.4, -5, 0));
  s.radii.insert(s.radii.end(), 2, 1);
  s.points[6].x() = -.4;
  s.points[7].x() = .4;
  s.segments.insert(s.segments.end(), {{6, 13}, {7, 14}});
  const auto f = findings_of(s);
  ASSERT_EQ(f.size(), 1u) << listed(f);
  EXPECT_EQ(f[0].kind, FindingKind::near_junctions);
  EXPECT_NEAR(f[0].figure, .8, .01);
}

// ---------------------------------------------------------------------------------------------------- repair

TEST(Repair, NothingToDo) {
  for (const gallery::Shape& shape : gallery::shapes()) {
    const Network plain = build_network(shape.skeleton), same = build_repaired_network(shape.skeleton);
    EXPECT_EQ(same.repairs, plain.repairs) << shape.name;
    for (std::size_t b = 0; b < plain.branches.size(); ++b) {
      EXPECT_EQ(same.branches[b].points, plain.branches[b].points);
      EXPECT_EQ(same.branches[b].radii, plain.branches[b].radii);
    }
  }
}

TEST(Repair, CrossingTubes) {
  for (const double distance : {1.51, 1.2, .9, .5, .2}) {
    const Network before = build_network(crossing(distance)), after = build_repaired_network(crossing(distance));
    const auto left = diagnose(after);
    EXPECT_TRUE(left.empty()) << distance << "\n" << listed(left);
    EXPECT_TRUE(told(after, "thinner there by up to"));
    EXPECT_EQ(told(after, "moved apart by"), distance < .6) << distance;
    for (std::size_t b = 0; b < 2; ++b) {
      const Branch &old = before.branches[b], &now = after.branches[b];
      for (std::size_t i = 0; i < now.points.size(); ++i) {
        double nearest = 1e9;
        for (std::size_t k = 0; k + 1 < old.points.size(); ++k) {
          const Vec3 u = old.points[k + 1] - old.points[k];
          const double t = std::clamp((now.points[i] - old.points[k]).dot(u) / u.squaredNorm(), 0., 1.);
          nearest = std::min(nearest, (old.points[k] + t * u - now.points[i]).norm());
        }
        EXPECT_LE(nearest, .5 * old.radii[0] * (1 + 1e-9));
        EXPECT_GE(now.radii[i], .4 * old.radii[0] * (1 - 1e-9));
        if (i > 0) {
          const double step = now.arc[i] - now.arc[i - 1];
          EXPECT_LE(step, .5 * std::min(now.radii[i], now.radii[i - 1]) * (1 + 1e-9));
          EXPECT_LE(std::abs(now.radii[i] - now.radii[i - 1]), .6 * step);
          EXPECT_GE((now.points[i] - now.points[i - 1]).norm(), .98 * step);
          EXPECT_GT(now.tangents[i].dot(now.points[i] - now.points[i - 1]), .98 * step);
        }
      }
      EXPECT_EQ(now.points.front(), old.points.front());
      EXPECT_EQ(now.radii.back(), old.radii.back());
    }
  }
}

TEST(Repair, CrossingTubesAreCertified) {
  SkeletonMeshOptions options;
  options.repair = true;
  options.grading.elements = 2;
  options.mesh.order = 2;
  for (const double distance : {1.4, 1.2, .9, .6, .3}) {
    const SkeletonMesh m = mesh_skeleton(crossing(distance), options);
    EXPECT_TRUE(m.findings.empty());
    EXPECT_EQ(measure_quality(m.result.mesh).certified, m.result.mesh.element_count()) << distance;
  }
}

TEST(Repair, LeavesWhatIsBeyondItsBounds) {
  // the same axis: no bound allows to part them
  const Skeleton s =
      both(straight(Vec3::Zero(), Vec3::UnitX(), 20, 1), straight(Vec3::Zero(), Vec3::UnitX(), 20, 1), Vec3(7, 0, 0));
  const Network before = build_network(s), after = build_repaired_network(s);
  EXPECT_TRUE(told(after, "left as they are"));
  EXPECT_EQ(after.branches[0].points, before.branches[0].points);
  EXPECT_EQ(after.branches[1].radii, before.branches[1].radii);
  EXPECT_EQ(count(diagnose(after), FindingKind::overlap), 1);
}

TEST(Repair, LeavesOutStubsAndStrayPieces) {
  const Skeleton s = both(with_stub(.6), straight(Vec3::Zero(), Vec3::UnitX(), .3, .3), Vec3(0, 5, 0));
  const Network n = build_repaired_network(s);
  EXPECT_EQ(n.branches.size(), 1u);
  EXPECT_EQ(n.nodes.size(), 2u);
  EXPECT_EQ(std::count_if(n.repairs.begin(), n.repairs.end(),
                          [](const std::string& line) { return line.starts_with("left out: "); }),
            2);
  EXPECT_TRUE(diagnose(n).empty());
  Skeleton named = s;  // whoever names an end wants it
  named.names[13] = "biopsy";
  EXPECT_EQ(build_repaired_network(named).branches.size(), 3u);
}

TEST(Repair, CommutesWithScalingAndRigidMotion) {
  const Skeleton s = both(crossing(.8), crossing(.3), Vec3(0, 6, 9));
  const Network plain = build_repaired_network(s);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (const double scale : {1e-3, 1., 25.4}) {
    Skeleton moved = s;
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      moved.points[i] = scale * (turn * s.points[i] + Vec3(3, -8, 5));
      moved.radii[i] = scale * s.radii[i];
    }
    const auto was = findings_of(s), is = findings_of(moved);
    ASSERT_EQ(is.size(), was.size());
    for (std::size_t i = 0; i < is.size(); ++i) {
      EXPECT_EQ(is[i].kind, was[i].kind);
      EXPECT_NEAR(is[i].figure, was[i].figure, 1e-3);
    }
    const Network n = build_repaired_network(moved);
    ASSERT_EQ(n.branches.size(), plain.branches.size());
    for (std::size_t b = 0; b < n.branches.size(); ++b) {
      ASSERT_EQ(n.branches[b].points.size(), plain.branches[b].points.size());
      for (std::size_t i = 0; i < n.branches[b].points.size(); ++i) {
        EXPECT_LT((n.branches[b].points[i] - scale * (turn * plain.branches[b].points[i] + Vec3(3, -8, 5))).norm(),
                  1e-3 * scale);
        EXPECT_NEAR(n.branches[b].radii[i], scale * plain.branches[b].radii[i], 1e-3 * scale);
      }
    }
  }
}

TEST(Repair, SameTwice) {
  const Network a = build_repaired_network(crossing(.3)), b = build_repaired_network(crossing(.3));
  EXPECT_EQ(a.repairs, b.repairs);
  for (std::size_t k = 0; k < a.branches.size(); ++k) {
    EXPECT_EQ(a.branches[k].points, b.branches[k].points);
    EXPECT_EQ(a.branches[k].radii, b.branches[k].radii);
  }
}

}  // namespace
}  // namespace vasohex
