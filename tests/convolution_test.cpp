#include "vasohex/surface/convolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "vasohex/surface/cone_lanes_isa.h"
#include "vasohex/surface/cone_tree.h"
#include "vasohex/surface/project.h"

namespace vasohex {
namespace {

using std::numbers::pi;

// ---- networks by hand

/// A branch along curve(t), t in [0, length], with radius(t), in `parts` samples. The parameter is the arc length.
Branch curve_branch(int from, int to, double length, int parts, const std::function<Vec3(double)>& curve,
                    const std::function<double(double)>& radius) {
  Branch branch;
  branch.nodes = {from, to};
  for (int k = 0; k <= parts; ++k) {
    const double t = length * k / parts, h = 1e-4 * length / parts;
    branch.arc.push_back(t);
    branch.points.push_back(curve(t));
    branch.tangents.push_back((curve(t + h) - curve(t - h)).normalized());
    branch.radii.push_back(radius(t));
  }
  return branch;
}

Branch straight_branch(int from, int to, const Vec3& a, const Vec3& b, double first_radius, double last_radius,
                       int parts = 20) {
  const double length = (b - a).norm();
  Branch branch = curve_branch(
      from, to, length, parts, [=](double t) { return Vec3(a + t / length * (b - a)); },
      [=](double t) { return first_radius + t / length * (last_radius - first_radius); });
  branch.tangents.assign(branch.points.size(), (b - a) / length);  // to the last digit
  return branch;
}

/// Nodes from the branches that meet there.
Network network_of(std::vector<Branch> branches) {
  Network network;
  network.branches = std::move(branches);
  for (const Branch& branch : network.branches) {
    for (int side = 0; side < 2; ++side) {
      const std::size_t at = branch.nodes[side];
      network.nodes.resize(std::max(network.nodes.size(), at + 1));
      NetworkNode& node = network.nodes[at];
      ++node.degree;
      node.position = side == 0 ? branch.points.front() : branch.points.back();
      node.radius = std::max(node.radius, side == 0 ? branch.radii.front() : branch.radii.back());
    }
    network.nodes[branch.nodes[0]].seam = branch.nodes[0] == branch.nodes[1];
  }
  return network;
}

Network tube(double length, double slope) {
  return network_of({straight_branch(0, 1, {0, 0, 0}, {0, 0, length}, 1, 1 + slope * length)});
}

Network torus(double bend) {
  return network_of({curve_branch(
      0, 0, 2 * pi * bend, static_cast<int>(2 * pi * bend / 0.3),
      [=](double t) { return Vec3(bend * std::cos(t / bend), bend * std::sin(t / bend), 0); },
      [](double) { return 1.0; })});
}

/// Radius of the cylinder `a`, rise per turn `pitch`; its bend radius is a + (pitch / 2 pi)^2 / a.
Network helix(double a, double pitch, double turns, double spacing = 0.3) {
  const double c = pitch / (2 * pi), w = 1 / std::hypot(a, c), length = turns * 2 * pi / w;
  return network_of({curve_branch(
      0, 1, length, static_cast<int>(length / spacing),
      [=](double t) { return Vec3(a * std::cos(w * t), a * std::sin(w * t), c * w * t); },
      [](double) { return 1.0; })});
}

/// Straight branches of given directions and radii that meet at the origin.
Network star(const std::vector<Vec3>& directions, const std::vector<double>& radii, double length, int parts = 20) {
  std::vector<Branch> branches;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    branches.push_back(straight_branch(0, static_cast<int>(i) + 1, Vec3::Zero(), length * directions[i].normalized(),
                                       radii[i], radii[i], parts));
  }
  return network_of(branches);
}

const std::vector<Vec3> y_directions = {{0.1, 0, -1}, {0.6, 0.1, 1}, {-0.7, 0.3, 1}};

/// A network with a bent branch, a junction, a taper: nothing special about it.
Network sample_network() {
  std::vector<Branch> branches = star(y_directions, {1, 0.8, 0.7}, 12).branches;
  const Branch& first = branches[1];
  const Vec3 start = first.points.back(), along = first.tangents.back(), side = along.unitOrthogonal();
  branches.push_back(curve_branch(
      2, 4, 9, 30,
      [=](double t) {
        return Vec3(start + 3 * std::sin(t / 3) * along + 3 * (1 - std::cos(t / 3)) * side);  // bend radius 3
      },
      [](double t) { return 0.8 - 0.02 * t; }));
  return network_of(branches);
}

// ---- the formula, by brute force

struct Ray {
  Vec3 start, end;
  double first_radius, last_radius;
};

double cone_field(const Ray& ray, const Vec3& x, int steps = 20000) {
  // Simpson's rule over all of the segment; the integrand is C2
  const double length = (ray.end - ray.start).norm();
  double sum = 0;
  for (int k = 0; k <= steps; ++k) {
    const double u = static_cast<double>(k) / steps;
    const double r = ray.first_radius + u * (ray.last_radius - ray.first_radius);
    const double v = 1 - (x - ray.start - u * (ray.end - ray.start)).squaredNorm() / (2.25 * r * r);
    sum += v > 0 ? (k == 0 || k == steps ? 1 : k % 2 == 1 ? 4 : 2) * v * v * v / r : 0;
  }
  return sum * length / steps / 3;
}

/// Normalised such that an infinite cone of this slope is 1 on its surface.
double normal_field(const Ray& ray, const Vec3& x) {
  const double slope = (ray.last_radius - ray.first_radius) / (ray.end - ray.start).norm();
  const double reach = 1.5 / (1 - 1.5 * std::abs(slope));
  static double known_slope = -1, one = 0;
  if (slope != known_slope) {
    one = cone_field({{0, 0, -reach}, {0, 0, reach}, 1 - slope * reach, 1 + slope * reach}, {1, 0, 0}, 200000);
    known_slope = slope;
  }
  return cone_field(ray, x) / one;
}

double level_of(double field) {
  const double q = 2.25 - 1.25 * std::pow(field, 1 / 3.5);
  if (q >= 0.1) {
    return std::sqrt(q) - 1;
  }
  const double root = std::sqrt(0.1), d = q - 0.1;
  return root + d / (2 * root) - d * d / (8 * root * root * root) - 1;
}

double smooth(double x) { return x <= 0 ? 0 : x >= 1 ? 1 : x * x * x * (10 - 15 * x + 6 * x * x); }

/// How far x lies beyond the plane of an end, in radii there.
double beyond_end(const Branch& branch, bool last, const Vec3& x) {
  const Vec3 end = last ? branch.points.back() : branch.points.front();
  const Vec3 outward = last ? branch.tangents.back() : Vec3(-branch.tangents.front());
  return (x - end).dot(outward) / (last ? branch.radii.back() : branch.radii.front());
}

/// A straight branch with free ends: prolonged by 1.5 radii, faded within .25 radii beyond its end.
Ray prolonged(const Branch& branch, bool first, bool last) {
  Ray ray{branch.points.front(), branch.points.back(), branch.radii.front(), branch.radii.back()};
  const Vec3 u = (ray.end - ray.start).normalized();
  const double slope = (ray.last_radius - ray.first_radius) / (ray.end - ray.start).norm();
  if (first) {
    ray.start -= 1.5 * branch.radii.front() * u;
    ray.first_radius -= 1.5 * branch.radii.front() * slope;
  }
  if (last) {
    ray.end += 1.5 * branch.radii.back() * u;
    ray.last_radius += 1.5 * branch.radii.back() * slope;
  }
  return ray;
}

double branch_field(const Branch& branch, bool first, bool last, const Vec3& x) {
  double field = normal_field(prolonged(branch, first, last), x);
  field *= first ? 1 - smooth(beyond_end(branch, false, x) / 0.25) : 1;
  field *= last ? 1 - smooth(beyond_end(branch, true, x) / 0.25) : 1;
  return field;
}

TEST(Convolution, MatchesQuadratureOnCones) {
  for (const double slope : {0.0, 0.1, -0.1, 0.3}) {
    const Network network = tube(6, slope);
    const auto surface = make_convolution_surface(network, {0});
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 60; ++i) {
      const double z = -1 + 8 * unit(random), d = (0.1 + 1.3 * unit(random)) * (1 + slope * z);
      const Vec3 x(d, 0, z);
      const double field = branch_field(network.branches[0], true, true, x);
      if (field > 1e-6) {
        EXPECT_NEAR(surface->value(x), level_of(field), slope == 0 ? 1e-9 : 1e-5) << slope << ' ' << x.transpose();
      }
    }
  }
}

TEST(Convolution, MatchesQuadratureAtAJunction) {
  const std::vector<double> radii = {1, 1, 0.9};
  const std::vector<Vec3> directions = {{0, 0, -1}, {0.27, 0, 1}, {-0.27, 0.05, 1}};  // two at 31 degrees
  const Network network = star(directions, radii, 14);
  const auto surface = make_convolution_surface(network, {0});
  // how far the tubes overlap: along each, and from the node
  double overlap = 1;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i != j) {
        const double cosine = directions[i].normalized().dot(directions[j].normalized());
        const double along = (radii[j] + radii[i] * cosine) / std::sqrt(1 - cosine * cosine);
        overlap = std::max(overlap, cosine < 0 ? std::min(along, radii[j]) : along);
        overlap = std::max(overlap, (radii[i] + radii[j]) / std::sqrt(2 - 2 * cosine));
      }
    }
  }
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  int blended = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 u(unit(random), unit(random), unit(random));
    // every other point where the two are parting
    const Vec3 x = i % 2 == 0 ? Vec3(2 * u[0], u[1], 6 * u[2]) : Vec3(0.3 * u[0], 0.3 * u[1], 5 + 0.6 * u[2]);
    const double weight = 1 - smooth((x.norm() - overlap - 1) / 2);
    double sum = 0, greatest = 0;
    int reached = 0;
    for (const Branch& branch : network.branches) {
      const double field = branch_field(branch, false, true, x);
      sum += field;
      greatest = std::max(greatest, field);
      reached += field > 0;
    }
    if (greatest > 1e-6) {
      blended += reached > 1 && weight < 1;
      EXPECT_NEAR(surface->value(x), level_of((1 - weight) * greatest + weight * sum), 1e-9) << x.transpose();
    }
  }
  EXPECT_GT(blended, 0);
}

/// Many vessels without a common node: what the tree of boxes leaves out is zero.
TEST(Convolution, CullingIsExact) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Branch> branches;
  for (int b = 0; b < 60; ++b) {
    const Vec3 a = 20 * Vec3(unit(random), unit(random), unit(random));
    const double r = std::exp2(1.5 * unit(random));
    const Vec3 d = Vec3(unit(random), unit(random), unit(random)).normalized() * r * (8 + 2 * unit(random));
    branches.push_back(straight_branch(2 * b, 2 * b + 1, a, a + d, r, r));
  }
  const Network network = network_of(branches);
  const auto surface = make_convolution_surface(network, {0});
  int outside = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = 25 * Vec3(unit(random), unit(random), unit(random));
    double field = 0, ratio = std::numeric_limits<double>::infinity(), radius = 0;
    for (const Branch& branch : network.branches) {
      const Ray ray = prolonged(branch, true, true);
      const Vec3 along = ray.end - ray.start;
      const double u = std::clamp((x - ray.start).dot(along) / along.squaredNorm(), 0.0, 1.0);
      double distance = (x - ray.start - u * along).norm() / ray.first_radius;
      if (distance < 1.5) {
        field = std::max(field, branch_field(branch, true, true, x));
      }
      for (const bool last : {false, true}) {
        const double beyond = beyond_end(branch, last, x) - 0.25;
        distance = beyond >= 0 ? std::max(distance, 1.5 + beyond) : distance;
      }
      if (distance < ratio) {
        ratio = distance;
        radius = ray.first_radius;
      }
    }
    if (field > 1e-5) {
      EXPECT_NEAR(surface->value(x), level_of(field), 1e-9);
    } else if (field == 0) {
      ++outside;
      EXPECT_NEAR(surface->value(x), ratio - 1, 1e-12 * ratio);
      EXPECT_NEAR(surface->radius(x), radius, 1e-12 * radius);
    }
  }
  EXPECT_GT(outside, 50);
}

TEST(Convolution, TheCubatureOfAConeSegment) {
  const ConeSegment segment = cone_segment({0.1, 0.2, 0.3}, 1, {0.3, 0.4, 0.55}, 1.15, 0);
  const Vec3 x(0.9, 0.1, 0.4);
  const ConeTree tree({segment});
  kernel::GroupSum sum;
  tree.for_each_sum(x, [&](int, const kernel::GroupSum& found) { sum = found; });
  EXPECT_NEAR(sum.value, normal_field({{0.1, 0.2, 0.3}, {0.3, 0.4, 0.55}, 1, 1.15}, x), 1e-5 * sum.value);
  EXPECT_GT(sum.weighted_radius / sum.value, 1);
  EXPECT_LT(sum.weighted_radius / sum.value, 1.15);
  tree.for_each_sum({5, 5, 5}, [&](int, const kernel::GroupSum&) { ADD_FAILURE() << "out of reach"; });
}

TEST(Convolution, ConesAreTheSameForEveryInstructionSet) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(-1, 1);
  kernel::ConeGroup group;
  for (int i = 0; i < kernel::kCones; ++i) {
    const Vec3 start(0.4 * i, 0.1 * part(random), 0.1 * part(random));
    const ConeSegment segment = cone_segment(start, 1, start + Vec3(0.4, 0, 0.1), 1 + 0.2 * part(random), 0);
    for (int d = 0; d < 3; ++d) {
      group.start[d][i] = segment.start[d];
      group.direction[d][i] = segment.direction[d];
      group.curvature[d][i] = 0.1 * part(random);
      group.end_normal[d][i] = d == 0;
    }
    group.length[i] = segment.length;
    group.radius[i] = segment.radius;
    group.slope[i] = segment.slope;
    group.scale[i] = segment.scale;
    group.end_offset[i] = 2.5;
    group.inverse_fade[i] = i % 2 == 0 ? 4 : 0;
  }
  int reached = 0;
  for (int k = 0; k < 200; ++k) {
    const Vec3 x(1.6 + 3 * part(random), 2 * part(random), 2 * part(random));
    kernel::GroupSum best, plain;
    const bool reaches = kernel::add_cones(group, x.data(), best);
    EXPECT_EQ(reaches, kernel::baseline::add_cones(group, x.data(), plain));
    EXPECT_EQ(best.value, plain.value);
    EXPECT_EQ(best.weighted_radius, plain.weighted_radius);
    EXPECT_TRUE(std::equal(best.gradient, best.gradient + 3, plain.gradient));
    reached += reaches;
  }
  EXPECT_GT(reached, 50);
  EXPECT_LT(reached, 190);
}

TEST(Convolution, GradientIsTheDerivative) {
  const auto surface = make_convolution_surface(sample_network());
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 x = 5 * Vec3(unit(random), 0.4 * unit(random), unit(random));
    Vec3 gradient, difference;
    const double value = surface->value(x, gradient);
    EXPECT_EQ(value, surface->value(x));
    constexpr double h = 1e-5;
    double jump = 0;
    for (int d = 0; d < 3; ++d) {
      Vec3 above, below;
      difference[d] =
          (surface->value(x + h * Vec3::Unit(d), above) - surface->value(x - h * Vec3::Unit(d), below)) / (2 * h);
      jump = std::max(jump, (above - below).norm());
    }
    if (jump < 1e-2) {  // not across a crease between separate vessels
      EXPECT_LT((gradient - difference).norm(), 1e-5 * (1 + gradient.norm())) << x.transpose();
    }
  }
}

/// The greatest change of the second difference quotient over a step, along a path, where vessels reach.
double second_derivative_jump(const ImplicitSurface& surface, const std::function<Vec3(double)>& path, double h) {
  double jump = 0, before = 0;
  for (double t = 0; t < 1; t += h) {
    const double second =
        (surface.value(path(t - h)) - 2 * surface.value(path(t)) + surface.value(path(t + h))) / (h * h);
    if (t > 0 && surface.value(path(t)) < 0.4) {
      jump = std::max(jump, std::abs(second - before));
    }
    before = second;
  }
  return jump;
}

TEST(Convolution, SecondDerivativesAreContinuous) {
  // along the wall of a bend, over joints of segments and cuts; across junctions, also two that are close
  const auto bend = make_convolution_surface(helix(2, 4, 2));
  const auto y = make_convolution_surface(star(y_directions, {1, 0.8, 0.7}, 12));
  const Vec3 second(0, 0, 0.8);
  const auto pair = make_convolution_surface(network_of(
      {straight_branch(0, 1, {0, 0, 0}, second, 1, 1, 4), straight_branch(0, 2, {0, 0, 0}, {0, 0, -10}, 1, 1),
       straight_branch(0, 3, {0, 0, 0}, {10, 0, 1}, 0.6, 0.6), straight_branch(1, 4, second, {0, 0, 10}, 0.9, 0.9),
       straight_branch(1, 5, second, {-9, 3, 2}, 0.7, 0.7)}));
  const double c = 4 / (2 * pi), w = 1 / std::hypot(2, c);
  const auto along_bend = [&](double u) {
    const double t = w * (4 + 6 * u);
    return Vec3(2.95 * std::cos(t), 2.95 * std::sin(t), c * t + 0.2);
  };
  const auto across_y = [&](double u) { return Vec3(-2 + 4 * u, 0.85, -1 + 2 * u); };
  const auto across_pair = [&](double u) { return Vec3(-3 + 6 * u, 0.9, 0.5 + 0.4 * u); };
  for (const auto& [surface, path] : std::vector<std::pair<const ImplicitSurface*, std::function<Vec3(double)>>>{
           {bend.get(), along_bend}, {y.get(), across_y}, {pair.get(), across_pair}}) {
    const double coarse = second_derivative_jump(*surface, path, 1e-3);
    const double fine = second_derivative_jump(*surface, path, 2.5e-4);
    EXPECT_LT(fine, 0.5 * coarse) << path(0).transpose();
  }
}

/// |distance from the axis to the surface / radius - 1|: the greatest of 16 rays, at the 95th percentile of the
/// samples.
double worst_ray_95(const Network& network, const ConvolutionOptions& options, double from_junctions = 0) {
  const auto surface = make_convolution_surface(network, options);
  std::vector<double> worst;
  for (const Branch& branch : network.branches) {
    for (double s = 0; s <= branch.length(); s += 0.13) {
      if ((network.nodes[branch.nodes[0]].degree > 2 && s < from_junctions) ||
          (network.nodes[branch.nodes[1]].degree > 2 && s > branch.length() - from_junctions)) {
        continue;
      }
      const AxisPoint at = axis_point(branch, s);
      const Vec3 e = at.tangent.unitOrthogonal(), f = at.tangent.cross(e);
      double most = 0;
      for (int k = 0; k < 16; ++k) {
        const double angle = 2 * pi * k / 16;
        const std::optional<double> t =
            shoot(*surface, at.position, std::cos(angle) * e + std::sin(angle) * f, at.radius, 3 * at.radius);
        most = std::max(most, t ? std::abs(*t / at.radius - 1) : 1.0);
      }
      worst.push_back(most);
    }
  }
  std::sort(worst.begin(), worst.end());
  return worst[static_cast<std::size_t>(0.95 * (worst.size() - 1))];
}

TEST(Convolution, KeepsTheRadius) {
  EXPECT_LT(worst_ray_95(tube(10, 0), {0}), 1e-9);
  EXPECT_LT(worst_ray_95(tube(10, 0), {}), 1e-9);
  EXPECT_LT(worst_ray_95(tube(10, 0.1), {}), 1e-3);
  EXPECT_LT(worst_ray_95(tube(10, 0.3), {}), 2e-3);
  EXPECT_LT(worst_ray_95(tube(2.5, -0.3), {}), 2e-3);
  EXPECT_LT(worst_ray_95(torus(3), {}), 1e-3);
  EXPECT_LT(worst_ray_95(torus(1.5), {}), 4e-3);
  EXPECT_LT(worst_ray_95(helix(3, 4, 2), {}), 2e-3);
  EXPECT_LT(worst_ray_95(helix(1.5, 3, 2), {}), 1e-2);
  EXPECT_LT(worst_ray_95(sample_network(), {}, 4), 1e-2);
}

TEST(Convolution, CalibrationPays) {
  EXPECT_LT(5 * worst_ray_95(torus(1.5), {}), worst_ray_95(torus(1.5), {0}));
  EXPECT_LT(worst_ray_95(torus(1.5), {0}), 0.02);
}

TEST(Convolution, SeparateVesselsStaySeparate) {
  const Branch thick = straight_branch(0, 1, {0, 0, -6}, {0, 0, 6}, 1, 1);
  const auto alone = make_convolution_surface(network_of({thick}));
  const double x = 1 + 0.02 + 0.2;
  for (const Vec3& along : {Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(0, 1, 1)}) {
    const Branch thin = straight_branch(2, 3, Vec3(x, 0, 0) - 4 * along, Vec3(x, 0, 0) + 4 * along, 0.2, 0.2, 60);
    const auto both = make_convolution_surface(network_of({thick, thin}));
    for (int k = 0; k < 33; ++k) {
      const double angle = 0.02 * (k - 16);
      for (const double z : {-0.3, 0.0, 0.1}) {
        const Vec3 direction(std::cos(angle), std::sin(angle), 0);
        const auto a = shoot(*alone, {0, 0, z}, direction, 0.2, 2), b = shoot(*both, {0, 0, z}, direction, 0.2, 2);
        ASSERT_TRUE(a && b);
        EXPECT_NEAR(*a, *b, 1e-9);
      }
    }
    const auto across = shoot(*both, {x, 0, 0}, {-1, 0, 0}, 0.2, 1);
    ASSERT_TRUE(across);
    EXPECT_NEAR(*across, 0.2, 1e-6);
  }
}

/// Greatest turn of the wall's normal per length, between the hits of rays a degree apart in the plane z = 0.
double sharpest_turn(const ImplicitSurface& surface, const Vec3& origin, double from, double to) {
  double sharpest = 0;
  Vec3 before = Vec3::Zero(), normal_before = Vec3::Zero();
  for (double degrees = from; degrees <= to; degrees += 1) {
    const Vec3 direction(std::cos(degrees * pi / 180), std::sin(degrees * pi / 180), 0);
    const auto hit = shoot(surface, origin, direction, 0.5, 6);
    if (!hit) {
      return 1e9;
    }
    Vec3 normal;
    surface.value(origin + *hit * direction, normal);
    normal.normalize();
    if (degrees > from) {
      sharpest = std::max(sharpest, (normal - normal_before).norm() / (origin + *hit * direction - before).norm());
    }
    before = origin + *hit * direction;
    normal_before = normal;
  }
  return sharpest;
}

TEST(Convolution, ArmsOfNearJunctionsPartInARoundedCrotch) {
  // arms 60 degrees apart, of nodes half a radius apart: where they part the wall is round as in any fork, no crease
  const Vec3 second(0.5, 0, 0), aside(0, 9, 0), ahead(5, 0, 0);
  const auto dumbbell = make_convolution_surface(network_of(
      {straight_branch(0, 1, {0, 0, 0}, second, 1, 1, 4), straight_branch(0, 2, {0, 0, 0}, aside - ahead, 1, 1),
       straight_branch(0, 3, {0, 0, 0}, -aside - ahead, 1, 1),
       straight_branch(1, 4, second, second + aside + ahead, 1, 1),
       straight_branch(1, 5, second, second - aside + ahead, 1, 1)}));
  EXPECT_LT(sharpest_turn(*dumbbell, {0.25, 0.5, 0}, 75, 105), 10);
}

TEST(Convolution, NarrowForksPartInARoundedCrotch) {
  for (const double degrees : {5.0, 8.0, 12.0, 20.0}) {
    const double half = degrees / 2 * pi / 180, parting = 1 / std::sin(half), length = 2 * parting;
    const Vec3 up(length * std::cos(half), length * std::sin(half), 0), down(up.x(), -up.y(), 0);
    const auto fork = make_convolution_surface(
        network_of({straight_branch(1, 0, {-8, 0, 0}, {0, 0, 0}, 1, 1), straight_branch(0, 2, {0, 0, 0}, up, 1, 1),
                    straight_branch(0, 3, {0, 0, 0}, down, 1, 1)}));
    // in the middle: where the tubes are .04 apart a crotch fills that; where they are .6 apart it is outside
    EXPECT_LT(fork->value({1.02 / std::tan(half), 0, 0}), 0) << degrees;
    EXPECT_GT(fork->value({1.3 / std::tan(half), 0, 0}), 0) << degrees;
  }
}

TEST(Convolution, SideBranchesOfOneTrunkStaySeparate) {
  // a tenth of a radius between them: the middle lies outside both as soon as the trunk is left behind
  const double x = 0.525;
  const auto trunk = make_convolution_surface(network_of(
      {straight_branch(0, 1, {-x, 0, 0}, {x, 0, 0}, 1, 1, 8), straight_branch(2, 0, {-8, 0, 0}, {-x, 0, 0}, 1, 1),
       straight_branch(1, 3, {x, 0, 0}, {8, 0, 0}, 1, 1), straight_branch(0, 4, {-x, 0, 0}, {-x, 8, 0}, 0.5, 0.5),
       straight_branch(1, 5, {x, 0, 0}, {x, 8, 0}, 0.5, 0.5)}));
  for (double y = 1.5; y < 6; y += 0.1) {
    EXPECT_GT(trunk->value({0, y, 0}), 0.01) << y;
  }
}

TEST(Convolution, TheTurnsOfACoilStaySeparate) {
  const Network coil = helix(1.5, 2.3, 4);
  EXPECT_LT(worst_ray_95(coil, {}), 0.03);
  const auto surface = make_convolution_surface(coil);
  for (double turn = 1; turn < 3; turn += 0.05) {
    const double angle = 2 * pi * turn;
    EXPECT_GT(surface->value({1.5 * std::cos(angle), 1.5 * std::sin(angle), 2.3 * (turn + 0.5)}), 0) << turn;
  }
}

TEST(Convolution, InvariantUnderMotionAndScaling) {
  const Network network = sample_network();
  const auto surface = make_convolution_surface(network);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  const Vec3 shift(3, -5, 8);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto image = [&](const Vec3& x) { return Vec3(scale * (turn * x + shift)); };
    Network moved = network;
    for (NetworkNode& node : moved.nodes) {
      node.position = image(node.position);
      node.radius *= scale;
    }
    for (Branch& branch : moved.branches) {
      for (std::size_t k = 0; k < branch.points.size(); ++k) {
        branch.points[k] = image(branch.points[k]);
        branch.radii[k] *= scale;
        branch.tangents[k] = turn * branch.tangents[k];
        branch.arc[k] *= scale;
      }
    }
    const auto other = make_convolution_surface(moved);
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 300; ++i) {
      const Vec3 x = 6 * Vec3(unit(random), 0.4 * unit(random), unit(random));
      Vec3 a, b;
      EXPECT_NEAR(surface->value(x, a), other->value(image(x), b), 1e-10);
      EXPECT_LT((turn * a - scale * b).norm(), 1e-8 * (1 + a.norm()));
      EXPECT_NEAR(surface->radius(x), other->radius(image(x)) / scale, 1e-10);
    }
  }
}

TEST(Convolution, IndependentOfTheSampling) {
  const auto coarse = make_convolution_surface(star(y_directions, {1, 0.8, 0.7}, 12, 30));
  const auto fine = make_convolution_surface(star(y_directions, {1, 0.8, 0.7}, 12, 113));
  const auto coarse_bend = make_convolution_surface(helix(3, 4, 1, 0.5)),
             fine_bend = make_convolution_surface(helix(3, 4, 1, 0.11));
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = 4 * Vec3(unit(random), 0.4 * unit(random), unit(random));
    EXPECT_NEAR(coarse->value(x), fine->value(x), 1e-9);
    const Vec3 y = Vec3(4.5 * unit(random), 4.5 * unit(random), 4 * unit(random));
    EXPECT_NEAR(coarse_bend->value(y), fine_bend->value(y), 1e-3);
  }
}

TEST(Convolution, NodesOfDegreeTwoAndSeamsCannotBeSeen) {
  // the same straight tube in one branch and in three, the middle one short
  const Network whole = network_of({straight_branch(0, 1, {0, 0, 0}, {0, 0, 12}, 1, 1)});
  const Network parts = network_of({straight_branch(0, 1, {0, 0, 0}, {0, 0, 5}, 1, 1),
                                    straight_branch(1, 2, {0, 0, 5}, {0, 0, 6}, 1, 1),
                                    straight_branch(3, 2, {0, 0, 12}, {0, 0, 6}, 1, 1)});
  const auto a = make_convolution_surface(whole), b = make_convolution_surface(parts);
  for (double z = -1; z < 13; z += 0.17) {
    EXPECT_NEAR(a->value({1.1, 0, z}), b->value({1.1, 0, z}), 1e-9) << z;
  }
  const auto ring = make_convolution_surface(torus(3));
  for (const double z : {-0.6, 0.0, 0.6}) {
    EXPECT_NEAR(ring->value({3.2, 0.7, z}), ring->value({-3.2, 0.7, z}), 2e-4);
  }
}

TEST(Convolution, SameBytesForAnyNumberOfThreads) {
  const Network network = sample_network();
  const auto one = make_convolution_surface(network, {}, vasohex::Run{1, {}, {}});
  const auto four = make_convolution_surface(network, {}, vasohex::Run{4, {}, {}});
  for (int i = 0; i < 200; ++i) {
    const Vec3 x(0.9 + 0.001 * i, 0.1, -6 + 0.07 * i);
    EXPECT_EQ(one->value(x), four->value(x));
  }
}

TEST(Convolution, RefusesWhatHasNoSurface) {
  EXPECT_THROW(make_convolution_surface(Network{}), Error);
  for (const double radius : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    Network network = tube(5, 0);
    network.branches[0].radii[3] = radius;
    try {
      make_convolution_surface(network);
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::bad_input);
      EXPECT_NE(std::string(e.what()).find("branch 0"), std::string::npos);
      EXPECT_NE(std::string(e.what()).find("point 3"), std::string::npos);
    }
  }
  Network backwards = tube(5, 0);
  backwards.branches[0].arc[2] = backwards.branches[0].arc[1];
  EXPECT_THROW(make_convolution_surface(backwards), Error);
}

TEST(Convolution, ProjectionConverges) {
  const auto surface = make_convolution_surface(star(y_directions, {1, 0.8, 0.7}, 12));
  std::mt19937 random(10);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 500; ++i) {
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    const std::optional<double> t = shoot(*surface, Vec3::Zero(), direction, 0.7, 20);
    if (!t) {
      continue;  // down a branch, out of its end at most
    }
    const Projection found = project(*surface, *t * direction + 0.1 * surface->radius(*t * direction) * direction);
    EXPECT_TRUE(found.converged);
    EXPECT_LT(std::abs(surface->value(found.point)), 1e-9);
  }
}

}  // namespace
}  // namespace vasohex
