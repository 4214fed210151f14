#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "errors.h"
#include "vasohex/skeleton/build_network.h"
#include "vasohex/skeleton/label_skeleton.h"
#include "vasohex/skeleton/thinning.h"
#include "vasohex/surface/distance_map.h"
#include "vasohex/surface/project.h"
#include "vasohex/surface/smooth_labels.h"

// What files give is judged by labelmap_oracle.py.

namespace vasohex {
namespace {

/// The voxels whose centres have distance(x) < 0, in a frame turned and moved in space.
LabelVolume voxelised(const std::function<double(const Vec3&)>& distance, const Box& box, const Vec3& spacing) {
  LabelVolume volume;
  volume.spacing = spacing;
  volume.axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  volume.axes.col(2) *= -1;  // left-handed, as some scanners' are
  const Vec3 middle = 0.5 * (box.min + box.max), half = 0.5 * (box.max - box.min);
  const double reach = half.norm();  // the box may be turned
  for (int d = 0; d < 3; ++d) {
    volume.size[d] = static_cast<int>(std::ceil(2 * reach / spacing[d]));
  }
  volume.origin = middle - volume.axes * Vec3::Constant(reach);
  volume.inside.resize(static_cast<std::size_t>(volume.size[0]) * volume.size[1] * volume.size[2]);
  for (std::size_t i = 0; i < volume.inside.size(); ++i) {
    volume.inside[i] = distance(volume.centre(i)) < 0;
  }
  volume.units = "mm";
  return volume;
}

double to_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  return (x - a - std::clamp((x - a).dot(d) / d.squaredNorm(), 0.0, 1.0) * d).norm();
}

/// A flat-ended tube.
double to_tube(const Vec3& x, const Vec3& a, const Vec3& b, double radius) {
  const Vec3 axis = (b - a).normalized();
  const double t = (x - a).dot(axis);
  return std::max({(x - a - t * axis).norm() - radius, -t, t - (b - a).norm()});
}

Box around(const std::vector<Vec3>& points, double margin) {
  Box box;
  for (const Vec3& p : points) {
    box.add(p - Vec3::Constant(margin));
    box.add(p + Vec3::Constant(margin));
  }
  return box;
}

LevelSet level_set_of(const LabelVolume& volume) {
  const LabelVolume crop = cropped(volume, kLevelSetMargin);
  return make_level_set(crop, signed_centre_distances(crop), {});
}

/// Errors of radius, in voxels, and of normals, in degrees, along rays from places inside.
struct Errors {
  double mean = 0, rms = 0, max = 0, normal_rms = 0;
};
Errors errors_of(const LevelSet& level_set, double voxel, int count,
                 const std::function<void(std::mt19937&, Vec3& from, Vec3& normal, double& radius)>& ray) {
  std::mt19937 random(1);
  Errors errors;
  for (int n = 0; n < count; ++n) {
    Vec3 from, normal;
    double radius, value;
    ray(random, from, normal, radius);
    EXPECT_TRUE(level_set.value(from, value, nullptr) && value < 0) << "the middle is outside";
    double inside = 0, outside = 0;
    for (outside = 0.1 * voxel; outside < radius + 3 * voxel; outside += 0.1 * voxel) {
      if (level_set.value(from + outside * normal, value, nullptr) && value > 0) {
        break;
      }
      inside = outside;
    }
    for (int k = 0; k < 40; ++k) {
      const double t = 0.5 * (inside + outside);
      EXPECT_TRUE(level_set.value(from + t * normal, value, nullptr));
      (value < 0 ? inside : outside) = t;
    }
    Vec3 gradient;
    level_set.value(from + inside * normal, value, &gradient);
    const double error = (inside - radius) / voxel;
    const double angle = std::acos(std::min(1.0, gradient.normalized().dot(normal))) * 180 / std::numbers::pi;
    errors.mean += error / count;
    errors.rms += error * error / count;
    errors.max = std::max(errors.max, std::abs(error));
    errors.normal_rms += angle * angle / count;
  }
  errors.rms = std::sqrt(errors.rms);
  errors.normal_rms = std::sqrt(errors.normal_rms);
  return errors;
}

double uniform(std::mt19937& random, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random);
}

TEST(Labelmap, DistancesAreThoseOfBruteForce) {
  std::mt19937 random(3);
  LabelVolume volume;
  volume.size = {9, 7, 8};
  volume.spacing = {0.47, 0.6, 0.8};
  for (int trial = 0; trial < 5; ++trial) {
    volume.inside.clear();
    for (int i = 0; i < 9 * 7 * 8; ++i) {
      volume.inside.push_back(uniform(random, 0, 1) < 0.1 + 0.2 * trial);
    }
    const std::vector<float> distances = signed_centre_distances(volume);
    for (std::size_t i = 0; i < volume.inside.size(); ++i) {
      double least = 1e9;
      for (std::size_t j = 0; j < volume.inside.size(); ++j) {
        if (volume.inside[i] != volume.inside[j]) {
          least = std::min(least, (volume.centre(i) - volume.centre(j)).norm());
        }
      }
      ASSERT_NEAR(distances[i], volume.inside[i] ? -least : least, 1e-5);
    }
  }
}

TEST(Labelmap, ThinningKeepsTheTopology) {
  // blobs of a random wave: components and tunnels, counted by the Euler number, which thinning knows nothing of
  std::mt19937 random(5);
  int tunnels = 0, components = 0;
  for (int trial = 0; trial < 12; ++trial) {
    LabelVolume volume;
    volume.size = {22, 20, 18};
    volume.spacing = {1, 1, 1.5};
    std::vector<Vec3> waves;
    std::vector<double> phases;
    for (int w = 0; w < 12; ++w) {
      waves.push_back(Vec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)));
      phases.push_back(uniform(random, 0, 7));
    }
    volume.inside.resize(22 * 20 * 18);
    for (std::size_t i = 0; i < volume.inside.size(); ++i) {
      double sum = 0;
      for (std::size_t w = 0; w < waves.size(); ++w) {
        sum += std::cos(waves[w].dot(volume.centre(i)) + phases[w]);
      }
      volume.inside[i] = sum > 0.8;
    }
    const CleanLabels before = clean_labels(volume, 1, 2);
    const std::vector<float> distances = signed_centre_distances(before.volume);
    const std::vector<std::size_t> lines = thin(before.volume, distances, vessel_tips(before.volume, distances, 1));
    LabelVolume thinned = before.volume;
    std::fill(thinned.inside.begin(), thinned.inside.end(), 0);
    for (const std::size_t i : lines) {
      ASSERT_EQ(before.volume.inside[i], 1);
      thinned.inside[i] = 1;
    }
    const CleanLabels after = clean_labels(thinned, 1, 2);
    EXPECT_EQ(after.components, before.components);
    EXPECT_EQ(after.tunnels, before.tunnels);
    EXPECT_TRUE(after.repairs.empty());  // no cavity
    EXPECT_LT(lines.size(), std::count(before.volume.inside.begin(), before.volume.inside.end(), 1) / 4);
    tunnels += before.tunnels;
    components += before.components;
  }
  EXPECT_GT(tunnels, 10);
  EXPECT_GT(components, 24);
}

TEST(Labelmap, EveryVoxelIsOnItsSideOfTheWall) {
  const auto shape = [](const Vec3& x) {
    return std::min(to_segment(x, {0, 0, 0}, {9, 6, 3}) - 1.3, to_segment(x, {9, 6, 3}, {12, -2, 8}) - 0.7);
  };
  const LabelVolume volume = voxelised(shape, around({{0, 0, 0}, {9, 6, 3}, {12, -2, 8}}, 2), {0.47, 0.47, 0.8});
  const LevelSet level_set = level_set_of(volume);
  for (std::size_t i = 0; i < volume.inside.size(); ++i) {
    double value;
    if (level_set.value(volume.centre(i), value, nullptr)) {
      ASSERT_EQ(value < 0, volume.inside[i] == 1);
    } else {
      ASSERT_EQ(volume.inside[i], 0);
    }
  }
}

TEST(Labelmap, TubesAreRound) {
  for (const Vec3& spacing : {Vec3(1, 1, 1), Vec3(0.47, 0.47, 0.8)}) {
    for (const Vec3& direction : {Vec3(0.3, 0.5, 0.8), Vec3(0.05, 0.02, 1)}) {
      for (const double voxels : {1.0, 2.0, 4.0, 8.0}) {
        const double voxel = spacing.mean(), radius = voxels * voxel;
        const Vec3 axis = direction.normalized(), end = std::max(14 * voxel, 2 * radius) * axis;
        const LabelVolume volume = voxelised([&](const Vec3& x) { return to_tube(x, -end, end, radius); },
                                             around({-end, end}, radius + voxel), spacing);
        const Errors e = errors_of(level_set_of(volume), voxel, 1000,
                                   [&](std::mt19937& random, Vec3& from, Vec3& normal, double& r) {
                                     const double angle = uniform(random, 0, 7);
                                     const Vec3 a = axis.unitOrthogonal();
                                     from = uniform(random, -0.6, 0.6) * end;
                                     normal = std::cos(angle) * a + std::sin(angle) * axis.cross(a);
                                     r = radius;
                                   });
        SCOPED_TRACE(testing::Message() << "radius " << voxels << " voxels of " << spacing.transpose() << " along "
                                        << direction.transpose() << ": mean " << e.mean << ", rms " << e.rms
                                        << ", max " << e.max << " voxels, normals " << e.normal_rms << " degrees");
        EXPECT_LT(std::abs(e.mean), 0.2);
        EXPECT_LT(e.rms, 0.27);
        EXPECT_LT(e.max, 0.6);
        EXPECT_LT(e.normal_rms, voxels < 1.5 ? 16 : 8);
      }
    }
  }
}

TEST(Labelmap, SpheresAndToriAreRound) {
  const Vec3 middle(1.3, 2.2, -0.4);
  for (const double radius : {3.0, 7.0}) {
    const LabelVolume volume = voxelised([&](const Vec3& x) { return (x - middle).norm() - radius; },
                                         around({middle}, radius + 1), Vec3::Ones());
    const Errors e =
        errors_of(level_set_of(volume), 1, 1000, [&](std::mt19937& random, Vec3& from, Vec3& normal, double& r) {
          std::normal_distribution<double> bell;
          from = middle;
          normal = Vec3(bell(random), bell(random), bell(random)).normalized();
          r = radius;
        });
    EXPECT_LT(std::abs(e.mean), 0.1);
    EXPECT_LT(e.rms, 0.15);
    EXPECT_LT(e.normal_rms, 5);
  }
  const auto torus = [&](const Vec3& x) { return std::hypot(std::hypot(x[0], x[1]) - 10, x[2]) - 3; };
  const LabelVolume volume = voxelised(torus, around({{-10, -10, 0}, {10, 10, 0}}, 4), {0.9, 0.9, 1.2});
  const Errors e =
      errors_of(level_set_of(volume), 1, 1000, [&](std::mt19937& random, Vec3& from, Vec3& normal, double& r) {
        const double a = uniform(random, 0, 7), b = uniform(random, 0, 7);
        const Vec3 out(std::cos(a), std::sin(a), 0);
        from = 10 * out;
        normal = std::cos(b) * out + std::sin(b) * Vec3::UnitZ();
        r = 3;
      });
  EXPECT_LT(std::abs(e.mean), 0.1);
  EXPECT_LT(e.rms, 0.15);
  EXPECT_LT(e.normal_rms, 6);
}

TEST(Labelmap, LevelSetsAreTwiceDifferentiable) {
  const LabelVolume volume =
      voxelised([](const Vec3& x) { return x.norm() - 4; }, around({Vec3::Zero()}, 5), {1, 1, 1});
  const LevelSet level_set = level_set_of(volume);
  // along a line through many cells: the gradient is the derivative, and the second derivative does not jump
  const Vec3 from(-4.2, 0.3, 0.7), step = 1e-3 * Vec3(1, 0.3, 0.2).normalized();
  double before = 0;
  for (int n = 0; n < 8000; ++n) {
    const Vec3 x = from + n * step;
    double a, b, c;
    Vec3 gradient;
    ASSERT_TRUE(level_set.value(x - step, a, nullptr) && level_set.value(x, b, &gradient) &&
                level_set.value(x + step, c, nullptr));
    ASSERT_NEAR((c - a) / 2, gradient.dot(step), 1e-9);
    const double second = (a - 2 * b + c) / step.squaredNorm();
    if (n > 0) {
      ASSERT_NEAR(second, before, 0.01);
    }
    before = second;
  }
}

TEST(Labelmap, SurfaceOfALevelSetIsFoundFromAfar) {
  const LabelVolume volume = voxelised(
      [](const Vec3& x) {
        return to_tube(x, {-20, 0, 0}, {20, 0, 0}, 3);
      },
      around({{-20, 0, 0}, {20, 0, 0}}, 4), {1, 1, 1});
  const LabelSkeleton s = extract_skeleton(volume);
  const auto surface = make_level_set_surface(s.level_set, build_network(s.skeleton));
  EXPECT_NEAR(surface->radius({0, 2, 0}), 3, 0.2);
  for (const double distance : {1.0, 4.0, 12.0, 30.0}) {
    Vec3 gradient;
    EXPECT_GT(surface->value(Vec3(1, 0, distance), gradient) * (distance > 3 ? 1 : -1), 0);
    const Projection p = project(*surface, Vec3(1, 0, distance));
    EXPECT_TRUE(p.converged);
    EXPECT_NEAR((p.point - p.point.x() * Vec3::UnitX()).norm(), 3, 0.3);
    EXPECT_LT(std::abs(surface->value(p.point)), 1e-9);
  }
}

struct Counts {
  int ends = 0, junctions = 0, cycles = 0, components = 0;
};
Counts counts_of(const Network& network) {
  Counts counts;
  std::vector<int> group(network.nodes.size());
  for (std::size_t n = 0; n < group.size(); ++n) {
    group[n] = static_cast<int>(n);
    counts.ends += network.nodes[n].degree == 1;
    counts.junctions += network.nodes[n].degree > 2;
  }
  counts.components = static_cast<int>(group.size());
  for (const Branch& branch : network.branches) {
    const int a = group[branch.nodes[0]], b = group[branch.nodes[1]];
    a == b ? ++counts.cycles : --counts.components;
    std::replace(group.begin(), group.end(), a, b);
  }
  return counts;
}

TEST(Labelmap, TubesGiveTheirAxes) {
  for (const Vec3& spacing : {Vec3(1, 1, 1), Vec3(0.47, 0.47, 0.8)}) {
    for (const double voxels : {1.5, 3.0, 6.0}) {
      const double voxel = spacing.mean(), radius = voxels * voxel;
      const Vec3 a(0.2, 0.3, 0.1), axis = Vec3(0.4, -0.5, 0.7).normalized(), b = a + 12 * radius * axis;
      const LabelVolume volume =
          voxelised([&](const Vec3& x) { return to_tube(x, a, b, radius); }, around({a, b}, 2 * radius), spacing);
      const LabelSkeleton s = extract_skeleton(volume);
      SCOPED_TRACE(testing::Message() << "radius " << voxels << " voxels");
      EXPECT_TRUE(s.repairs.empty());
      EXPECT_EQ(s.skeleton.units, "mm");
      const Counts counts = counts_of(build_network(s.skeleton));
      EXPECT_EQ(counts.ends, 2);
      EXPECT_EQ(counts.junctions + counts.cycles, 0);
      for (std::size_t p = 0; p < s.skeleton.points.size(); ++p) {
        EXPECT_LT(to_segment(s.skeleton.points[p], a, b), 0.4 * voxel);
        EXPECT_NEAR(s.skeleton.radii[p], radius, 0.35 * voxel);
      }
      ASSERT_EQ(s.ends.size(), 2u);
      for (std::size_t e = 0; e < 2; ++e) {
        const Vec3 x = s.ends[e].centre;
        EXPECT_EQ(x, s.skeleton.points[s.end_points[e]]);
        const double to_a = (x - a).dot(axis), to_b = (b - x).dot(axis), in = std::min(to_a, to_b);
        EXPECT_GT(in, -0.1 * voxel);
        EXPECT_LT(in, radius + voxel);
        EXPECT_GT(s.ends[e].normal.dot(to_a < to_b ? Vec3(-axis) : axis), 0.97);
        EXPECT_NEAR(s.ends[e].radius, radius, 0.4 * voxel);
      }
    }
  }
}

TEST(Labelmap, JunctionsAndCyclesAreThoseOfTheLumen) {
  // a trunk with two side branches that a third one links; and a ring of its own
  const std::vector<std::array<Vec3, 2>> tubes = {{Vec3(0, 0, 0), Vec3(60, 0, 0)},
                                                  {Vec3(20, 0, 0), Vec3(28, 48, 12.8)},
                                                  {Vec3(40, 0, 0), Vec3(45, 25, -6)},
                                                  {Vec3(24, 24, 6.4), Vec3(45, 25, -6)},
                                                  {Vec3(45, 25, -6), Vec3(60, 50, 0)}};
  const std::vector<double> radii = {5, 2.5, 2.5, 2.5, 2};
  const auto shape = [&](const Vec3& x) {
    double least = std::hypot(std::hypot(x[0] - 20, x[2] - 30) - 12, x[1]) - 3;
    for (std::size_t t = 0; t < tubes.size(); ++t) {
      least = std::min(least, to_segment(x, tubes[t][0], tubes[t][1]) - radii[t]);
    }
    return least;
  };
  LabelVolume volume = voxelised(shape, around({{0, 0, 0}, {60, 50, 45}}, 8), {1, 1, 1.3});
  // dirt: a cavity, a fragment
  const auto voxel_at = [&](const Vec3& x) {
    const Vec3 v = volume.to_local(x).cwiseQuotient(volume.spacing);
    return volume.index(static_cast<int>(std::lround(v[0])), static_cast<int>(std::lround(v[1])),
                        static_cast<int>(std::lround(v[2])));
  };
  volume.inside[voxel_at({10, 0, 0})] = 0;
  volume.inside[voxel_at({10, 40, 40})] = 1;
  const LabelSkeleton s = extract_skeleton(volume);
  EXPECT_EQ(s.components, 2);
  EXPECT_EQ(s.tunnels, 2);
  ASSERT_EQ(s.repairs.size(), 2u) << s.repairs.back();
  EXPECT_NE(s.repairs[0].find("cavity of 1 voxel at"), std::string::npos);
  EXPECT_NE(s.repairs[1].find("fragment of 1 voxel at"), std::string::npos);
  const Counts counts = counts_of(build_network(s.skeleton));
  EXPECT_EQ(counts.components, 2);
  EXPECT_EQ(counts.cycles, 2);
  EXPECT_EQ(counts.ends, 4);
  EXPECT_EQ(counts.junctions, 4);
  double value;
  for (const Vec3& p : s.skeleton.points) {
    EXPECT_TRUE(s.level_set->value(p, value, nullptr) && value < 0);
  }
}

TEST(Labelmap, HolesNarrowerThanVoxelsTellAreFilled) {
  // beside a long tube lies a second one, at a gap: alone; joined at one place; joined at two, with a hole between
  const auto tunnels_of = [](double gap, int joints, double least_hole, LabelSkeleton* found = nullptr) {
    const double middle = 2.5 + 0.5 * gap;
    const LabelVolume volume = voxelised(
        [&](const Vec3& x) {
          double least = std::min(to_segment(x, {0, -middle, 0}, {36, -middle, 0}) - 2.5,
                                  to_segment(x, {4, middle, 0}, {32, middle, 0}) - 2.5);
          for (int j = 0; j < joints; ++j) {
            least = std::min(least, (x - Vec3(12 + 12 * j, 0, 0)).norm() - 2 - 0.5 * gap);
          }
          return least;
        },
        around({{0, -middle, 0}, {36, middle, 0}}, 6), {1, 1, 1.2});
    LabelSkeletonOptions options;
    options.least_hole = least_hole;
    LabelSkeleton s = extract_skeleton(volume, options);
    const int tunnels = s.tunnels;
    EXPECT_EQ(s.components, joints == 0 ? 2 : 1);
    if (found) {
      *found = std::move(s);
    }
    return tunnels;
  };
  LabelSkeleton s;
  for (const int joints : {0, 1}) {
    EXPECT_EQ(tunnels_of(1.5, joints, 2, &s), 0);
    EXPECT_TRUE(s.repairs.empty());
  }
  EXPECT_EQ(tunnels_of(1.5, 2, 0), 1);
  EXPECT_EQ(tunnels_of(1.5, 2, 2, &s), 0);
  ASSERT_EQ(s.repairs.size(), 1u);
  EXPECT_NE(s.repairs[0].find("hole narrower than"), std::string::npos);
  EXPECT_EQ(counts_of(build_network(s.skeleton)).cycles, 0);
  EXPECT_EQ(tunnels_of(5, 2, 2, &s), 1);
  EXPECT_TRUE(s.repairs.empty());
}

TEST(Labelmap, VesselsThatTouchByAnEdgeOrACornerAreJoined) {
  for (const bool by_corner : {false, true}) {
    // two straight vessels of 4 x 4 voxels, between them one voxel or two
    LabelVolume volume;
    volume.size = {50, 40, 40};
    volume.spacing = {0.5, 0.5, 0.6};
    volume.inside.assign(static_cast<std::size_t>(50) * 40 * 40, 0);
    for (int along = 5; along < 45; ++along) {
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) {
          volume.inside[volume.index(along, 14 + a, 14 + b)] = 1;
          volume.inside[volume.index(along, 19 + a, 19 + b)] = 1;
        }
      }
    }
    if (by_corner) {
      volume.inside[volume.index(25, 18, 17)] = volume.inside[volume.index(26, 19, 18)] = 1;
    } else {
      volume.inside[volume.index(25, 18, 18)] = 1;
    }
    const LabelSkeleton found = extract_skeleton(volume);
    EXPECT_EQ(found.components, 1);
    EXPECT_EQ(found.ends.size(), 4u);
    EXPECT_TRUE(std::any_of(found.repairs.begin(), found.repairs.end(), [](const std::string& line) {
      return line.find("touch at") != std::string::npos;
    }));
    for (const auto& [a, b] : found.skeleton.segments) {
      const Vec3 from = found.skeleton.points[a], to = found.skeleton.points[b];
      // room for the blocks of a junction all along
      for (double t = 0; t < 1; t += 0.25) {
        const Vec3 at = (1 - t) * from + t * to, along = (to - from).normalized();
        for (double angle = 0; angle < 6; angle += 0.5) {
          const Vec3 side = along.unitOrthogonal();
          const Vec3 round = std::cos(angle) * side + std::sin(angle) * along.cross(side);
          double value = 1;
          EXPECT_TRUE(found.level_set->value(at + 0.3 * round, value, nullptr));
          EXPECT_LT(value, 0) << at.transpose();
        }
      }
    }
  }
}

TEST(Labelmap, ResultsDoNotDependOnThreads) {
  const auto shape = [](const Vec3& x) {
    return std::min(to_segment(x, {0, 0, 0}, {20, 6, 3}) - 3, to_segment(x, {9, 3, 1}, {12, -12, 8}) - 2);
  };
  const LabelVolume volume = voxelised(shape, around({{0, 0, 0}, {20, 6, 3}, {12, -12, 8}}, 4), {1, 1, 1.2});
  vasohex::Run one, three;
  one.threads = 1;
  three.threads = 3;
  const LabelSkeleton a = extract_skeleton(volume, {}, one), b = extract_skeleton(volume, {}, three);
  EXPECT_EQ(a.skeleton.points, b.skeleton.points);
  EXPECT_EQ(a.skeleton.radii, b.skeleton.radii);
  EXPECT_EQ(a.skeleton.segments, b.skeleton.segments);
}

TEST(Labelmap, SaysWhatIsWrong) {
  LabelVolume volume;
  volume.size = {3, 3, 3};
  volume.inside.assign(27, 0);
  const auto error = [&] { return error_of([&] { extract_skeleton(volume); }); };
  EXPECT_NE(error().find("no voxel is in the lumen"), std::string::npos);
  volume.inside.assign(27, 1);
  EXPECT_NE(error().find("no vessel"), std::string::npos);  // a cube is not longer than wide
  volume.inside.pop_back();
  EXPECT_NE(error().find("26 labels"), std::string::npos);
  volume.inside.assign(27, 1);
  volume.spacing[1] = 0;
  EXPECT_NE(error().find("spacing 0 along j"), std::string::npos);
  volume.spacing[1] = 1;
  volume.axes(0, 1) = 0.5;
  EXPECT_NE(error().find("right angles"), std::string::npos);
  volume.axes.setIdentity();
  volume.origin[0] = std::nan("");
  EXPECT_NE(error().find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace vasohex
