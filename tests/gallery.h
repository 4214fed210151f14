#pragma once
/// \file Skeletons that tests run over: one of every kind that matters.

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "vasohex/skeleton/skeleton.h"

namespace vasohex::gallery {

struct Shape {
  std::string name;
  Skeleton skeleton;
  int components = 1;
  int loops = 0;
  int ends = 2;
};

inline Vec3 spherical(double azimuth, double elevation) {
  const double a = azimuth * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
  return {std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)};
}

/// Straight arms from a common point: directions, radii; each `length` long.
inline Skeleton star(const std::vector<Vec3>& directions, const std::vector<double>& radii, double length) {
  Skeleton s;
  s.points.push_back(Vec3::Zero());
  s.radii.push_back(*std::max_element(radii.begin(), radii.end()));
  for (std::size_t a = 0; a < directions.size(); ++a) {
    int before = 0;
    const int steps = static_cast<int>(length / radii[a]);
    for (int i = 1; i <= steps; ++i) {
      s.points.push_back(length * i / steps * directions[a].normalized());
      s.radii.push_back(radii[a]);
      s.segments.push_back({before, static_cast<int>(s.points.size()) - 1});
      before = static_cast<int>(s.points.size()) - 1;
    }
  }
  return s;
}

/// A curve sampled at t = i / pieces, i = 0 ... pieces; closed: the last sample is the first.
inline Skeleton curve(const std::function<Vec3(double)>& at, double radius, int pieces, bool closed) {
  Skeleton s;
  for (int i = 0; i < pieces + (closed ? 0 : 1); ++i) {
    s.points.push_back(at(static_cast<double>(i) / pieces));
    s.radii.push_back(radius);
    if (i > 0) {
      s.segments.push_back({i - 1, i});
    }
  }
  if (closed) {
    s.segments.push_back({pieces - 1, 0});
  }
  return s;
}

inline Skeleton torus(double bend_radius, double radius) {
  return curve(
      [=](double t) {
        return Vec3(bend_radius * std::cos(2 * std::numbers::pi * t),
                    bend_radius * std::sin(2 * std::numbers::pi * t), 0);
      },
      radius, 48, true);
}

inline Skeleton tube(double length, double radius) {
  return curve([=](double t) { return Vec3(0.3 * length * t, 0.8 * length * t, std::sqrt(0.27) * length * t); },
               radius, static_cast<int>(length / radius), false);
}

/// Puts b beside a.
inline Skeleton both(Skeleton a, const Skeleton& b, const Vec3& shift) {
  const int base = static_cast<int>(a.points.size());
  for (const Vec3& p : b.points) {
    a.points.push_back(p + shift);
  }
  a.radii.insert(a.radii.end(), b.radii.begin(), b.radii.end());
  for (const auto& [p, q] : b.segments) {
    a.segments.push_back({p + base, q + base});
  }
  return a;
}

/// From the origin, where the radius is 1, to point 1.
inline Skeleton piece(const Vec3& to, double radius) {
  Skeleton s;
  s.points = {Vec3(0, 0, 0), to};
  s.radii = {1, radius};
  s.segments = {{0, 1}};
  return s;
}

/// A chain of two junctions `gap` apart, four arms in different planes.
inline Skeleton linked(double gap) {
  Skeleton s = piece({gap, 0, 0}, 1);
  const auto arm = [&](int from, const Vec3& direction, double radius) {
    int before = from;
    const Vec3 start = s.points[from];
    for (int i = 1; i <= 6; ++i) {
      s.points.push_back(start + i * direction.normalized());
      s.radii.push_back(radius);
      s.segments.push_back({before, static_cast<int>(s.points.size()) - 1});
      before = static_cast<int>(s.points.size()) - 1;
    }
  };
  arm(0, {-1, 0.2, 0}, 1);
  arm(0, {-0.2, -1, 0.3}, 0.6);
  arm(1, {1, 0.1, 0.1}, 0.9);
  arm(1, {0.3, 0.2, 1}, 0.6);
  return s;
}

/// One vessel with coarse points: two turns that fold it back and forth within some radii.
inline Skeleton spike() {
  Skeleton s;
  s.points = {{8, -26, -6},     {4, -13, -3},     {0, 0, 0},       {-.5, 0, 2.4},
              {-.5, -1.2, 4.7}, {-1.1, 1.2, 3.5}, {7, -7.5, -1.2}, {11, -8, -3.5}};
  s.radii = {.6, .6, 1.2, .6, .6, 1.2, .6, 1.2};
  for (int i = 0; i + 1 < static_cast<int>(s.points.size()); ++i) {
    s.segments.push_back({i, i + 1});
  }
  return s;
}

/// Two junctions just over a radius apart; a branch of each runs beside the other's for some radii.
inline Skeleton two_pairs_side_by_side() {
  Skeleton s;
  s.points = {{0, 0, 0},        {0, -.9, .9}, {7, -8, -6},    {1, -.9, 3},   {1, -.9, 12},
              {-4.4, 5.3, -.9}, {-12, 9, -4}, {-4, 4.4, 1.8}, {-4.5, 5.5, 8}};
  s.radii = {1, 1, 1, 1.2, 1, .9, .9, 1.2, .9};
  s.segments = {{0, 1}, {0, 2}, {1, 3}, {3, 4}, {0, 5}, {5, 6}, {1, 7}, {7, 8}};
  return s;
}

/// A ring with two arms: one loop, two junctions, two branches between them.
inline Skeleton ring_with_arms() {
  Skeleton s = torus(6, 1);
  for (const int side : {1, -1}) {
    int before = side == 1 ? 0 : 24;
    for (int i = 1; i <= 6; ++i) {
      s.points.push_back(Vec3(side * (6 + i), 0, 0.1 * i));
      s.radii.push_back(0.8);
      s.segments.push_back({before, static_cast<int>(s.points.size()) - 1});
      before = static_cast<int>(s.points.size()) - 1;
    }
  }
  return s;
}

/// Arms in random directions at least `least` degrees apart, radii between 2/3 and 4/3.
inline Skeleton random_star(int arms, int seed, double least) {
  std::mt19937 random(1000 * arms + seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> directions;
  for (int tries = 0; static_cast<int>(directions.size()) < arms; ++tries) {
    if (tries > 2000) {
      directions.clear();
      tries = 0;
    }
    Vec3 d(normal(random), normal(random), normal(random));
    d.normalize();
    bool free = true;
    for (const Vec3& e : directions) {
      free = free && d.dot(e) < std::cos(least * std::numbers::pi / 180);
    }
    if (free) {
      directions.push_back(d);
    }
  }
  std::vector<double> radii;
  for (int a = 0; a < arms; ++a) {
    radii.push_back(std::pow(2.0, uniform(random)) / 1.5);
  }
  return star(directions, radii, 9);
}

/// Adds a straight arm from a point of the skeleton.
inline void add_arm(Skeleton& s, int from, const Vec3& direction, double radius, double length) {
  const Vec3 start = s.points[from];
  const int steps = static_cast<int>(std::ceil(length / radius));
  int before = from;
  for (int i = 1; i <= steps; ++i) {
    s.points.push_back(start + length * i / steps * direction.normalized());
    s.radii.push_back(radius);
    s.segments.push_back({before, static_cast<int>(s.points.size()) - 1});
    before = static_cast<int>(s.points.size()) - 1;
  }
}

/// A vessel of radius 1 that divides into two, `angle` degrees apart; the vessel comes `lift` degrees out of their
/// plane.
inline Skeleton fork(double angle, double left, double right, double lift) {
  return star({spherical(180, lift), spherical(angle / 2, 0), spherical(-angle / 2, 0)}, {1, left, right}, 12);
}

/// A fork of `angle` degrees whose one daughter divides 8 radii on, before the two have parted: its side branch, at a
/// right angle, leaves on the other side. All radii 1.
inline Skeleton fork_that_divides(double angle) {
  const Vec3 direction = spherical(angle, 0);
  Skeleton s = piece({8, 0, 0}, 1);
  add_arm(s, 0, -Vec3::UnitX(), 1, 8);
  add_arm(s, 0, direction, 1, 4 / std::sin(angle * std::numbers::pi / 180));
  add_arm(s, 1, Vec3::UnitX(), 1, 10);
  add_arm(s, 1, -Vec3::UnitY(), 1, 8);
  return s;
}

/// Two junctions `gap` apart along x, each with two arms of radius 1, 60 degrees off the axis, in planes that are
/// `twist` degrees apart.
inline Skeleton dumbbell(double gap, double twist) {
  Skeleton s = piece({gap, 0, 0}, 1);
  const double t = twist * std::numbers::pi / 180;
  const Vec3 y = Vec3::UnitY(), turned(0, std::cos(t), std::sin(t));
  for (const double side : {1.0, -1.0}) {
    add_arm(s, 0, Vec3(-0.5, 0, 0) + side * std::sqrt(0.75) * y, 1, 7);
    add_arm(s, 1, Vec3(0.5, 0, 0) + side * std::sqrt(0.75) * turned, 1, 7);
  }
  return s;
}

/// A vessel of radius 1 along x with two side branches of radius .6, `gap` apart and `twist` degrees about the
/// vessel; both lean outward by 27 degrees.
inline Skeleton two_side_branches(double gap, double twist) {
  Skeleton s = piece({gap, 0, 0}, 1);
  const double t = twist * std::numbers::pi / 180;
  add_arm(s, 0, {-1, 0, 0}, 1, 7);
  add_arm(s, 1, {1, 0, 0}, 1, 7);
  add_arm(s, 0, {-0.5, 1, 0}, 0.6, 7);
  add_arm(s, 1, Vec3(0.5, std::cos(t), std::sin(t)), 0.6, 7);
  return s;
}

/// A vessel of radius 1 along x whose side branch along y, radius .55, divides after `length` into two of radius .4,
/// 45 degrees to each side, in a plane `twist` degrees about y.
inline Skeleton forked_stub(double length, double twist) {
  Skeleton s = piece({0, length, 0}, 0.55);
  const double t = twist * std::numbers::pi / 180;
  const Vec3 aside(std::cos(t), 0, std::sin(t));
  for (const double side : {1.0, -1.0}) {
    add_arm(s, 0, side * Vec3::UnitX(), 1, 7);
    add_arm(s, 1, Vec3::UnitY() + side * aside, 0.4, 7);
  }
  return s;
}

/// A vessel of radius 1 in the plane z = 0: straight along x for `legs`, round to the left by `degrees`, straight for
/// `legs`.
struct Bend {
  Skeleton skeleton;
  int begin = 0;   ///< point where the arc begins
  int middle = 0;  ///< point in its middle
};
inline Bend bend(double bend_radius, double degrees, double legs) {
  Bend b;
  const double angle = degrees * std::numbers::pi / 180;
  const int straight = static_cast<int>(std::ceil(2 * legs)),
            round = 2 * static_cast<int>(std::ceil(angle * bend_radius));
  const auto add = [&](const Vec3& p) {
    const int n = static_cast<int>(b.skeleton.points.size());
    b.skeleton.points.push_back(p);
    b.skeleton.radii.push_back(1);
    if (n > 0) {
      b.skeleton.segments.push_back({n - 1, n});
    }
  };
  for (int i = -straight; i < 0; ++i) {
    add(Vec3(legs * i / straight, 0, 0));
  }
  for (int i = 0; i <= round; ++i) {
    const double a = angle * i / round;
    add(bend_radius * Vec3(std::sin(a), 1 - std::cos(a), 0));
  }
  const Vec3 last = b.skeleton.points.back(), ahead(std::cos(angle), std::sin(angle), 0);
  for (int i = 1; i <= straight; ++i) {
    add(last + legs * i / straight * ahead);
  }
  b.begin = straight;
  b.middle = straight + round / 2;
  return b;
}

inline std::vector<Shape> shapes() {
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  std::vector<Shape> all;
  all.push_back({"tube", tube(8, 1), 1, 0, 2});
  all.push_back({"torus", torus(4, 1), 1, 1, 0});
  all.push_back({"helix", curve([](double t) { return Vec3(3 * std::cos(9 * t), 3 * std::sin(9 * t), 12 * t); }, 1,
                                40, false)});
  all.push_back({"taper", [] {
                   Skeleton s = tube(10, 1);
                   for (std::size_t i = 0; i < s.radii.size(); ++i) {
                     s.radii[i] = 1.4 - 0.08 * i;
                   }
                   return s;
                 }()});
  all.push_back({"bend", star({spherical(0, 0), spherical(130, 0)}, {1, 1}, 6)});
  all.push_back({"Y 120", star({spherical(0, 0), spherical(120, 0), spherical(240, 0)}, {1, 1, 1}, 6), 1, 0, 3});
  all.push_back({"iliac", star({-y, spherical(65, 0), spherical(115, 0)}, {1, 0.75, 0.75}, 6), 1, 0, 3});
  all.push_back({"T thin", star({x, -x, y}, {1, 1, 0.25}, 5), 1, 0, 3});
  all.push_back({"trifurcation",
                 star({-z, spherical(0, 50), spherical(120, 50), spherical(240, 50)}, {1.2, 0.8, 0.8, 0.8}, 6), 1, 0,
                 4});
  all.push_back({"cross", star({x, y, -x, -y}, {1, 1, 1, 1}, 5), 1, 0, 4});
  all.push_back({"six axes", star({x, -x, y, -y, z, -z}, {1, 1, 1, 1, 1, 1}, 5), 1, 0, 6});
  all.push_back({"linked 1.2 r", linked(1.2), 1, 0, 4});
  all.push_back({"linked 2.5 r", linked(2.5), 1, 0, 4});
  all.push_back({"apart 6 r", linked(6), 1, 0, 4});
  all.push_back({"ring with arms", ring_with_arms(), 1, 1, 2});
  all.push_back({"tube and torus", both(tube(8, 1), torus(4, 1), Vec3(20, 0, 0)), 2, 1, 2});
  return all;
}

}  // namespace vasohex::gallery
