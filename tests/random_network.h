#pragma once
/// \file Random networks: curved, tapering vessels, some junctions closer to each other than their radii, loops.

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <random>
#include <vector>

#include "vasohex/skeleton/skeleton.h"

namespace vasohex::gallery {

/// Grows vessels from tips, one after the other; each that would touch another vessel is drawn anew.
class RandomNetwork {
 public:
  /// About `junctions` junctions, of 3 or 4 branches. Odd seeds start from a loop, even ones from a single vessel.
  static Skeleton grown(int seed, int junctions) {
    RandomNetwork n(seed, junctions);
    return std::move(n.skeleton_);
  }

 private:
  static constexpr double kStep = 0.5;       ///< between points, in radii
  static constexpr double kNear = 3.0;       ///< vessels may touch within so many radii of the junction they leave
  static constexpr double kGap = 1.15;       ///< least distance of other vessels, over the sum of the radii
  static constexpr double kLeastAngle = 45;  ///< between the branches of a junction
  static constexpr double kLinks = 0.4;      ///< part of the junctions that have another one very near
  struct Tip {
    int point = 0;
    Vec3 direction = Vec3::Zero();
    double radius = 0;
    bool is_link = false;      ///< leads to a junction very near
    std::vector<Vec3> others;  ///< of a link: directions of its junction's other branches
  };
  struct Path {
    std::vector<Vec3> points;
    std::vector<double> radii;
    Vec3 direction = Vec3::Zero();  ///< at its end
  };

  RandomNetwork(int seed, int junctions) : random_(77000 + seed), left_(junctions) {
    if (seed % 2 == 1) {
      start_from_loop();
    } else {
      skeleton_.points.push_back(Vec3::Zero());
      skeleton_.radii.push_back(1);
      tips_.push_back({0, Vec3::UnitZ(), 1, false, {}});
    }
    while (!tips_.empty()) {
      const Tip tip = tips_.front();
      tips_.pop_front();
      grow(tip);
    }
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 any_direction() {
    std::normal_distribution<double> normal;
    const double x = normal(random_), y = normal(random_), z = normal(random_);
    return Vec3(x, y, z).normalized();
  }
  static double degrees_between(const Vec3& a, const Vec3& b) {
    return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * 180 / std::numbers::pi;
  }

  /// A wavy ring with three vessels outward.
  void start_from_loop() {
    const double ring = uniform(8, 11), wave = uniform(0.5, 2.5), phase = uniform(0, 6);
    const int pieces = 60;
    for (int i = 0; i < pieces; ++i) {
      const double a = 2 * std::numbers::pi * i / pieces;
      skeleton_.points.push_back(Vec3(ring * std::cos(a), ring * std::sin(a), wave * std::sin(2 * a + phase)));
      skeleton_.radii.push_back(0.8 + 0.2 * std::cos(a));
      skeleton_.segments.push_back({i, (i + 1) % pieces});
    }
    for (int i = 0; i < 3; ++i) {
      const int at = 20 * i + static_cast<int>(uniform(0, 12));
      const double a = 2 * std::numbers::pi * at / pieces, e = uniform(-0.6, 0.6);
      const Vec3 along(-std::sin(a), std::cos(a), 0);
      const Vec3 outward(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e));
      tips_.push_back({at, outward, skeleton_.radii[at] * uniform(0.6, 1), uniform(0, 1) < kLinks, {along, -along}});
      --left_;
    }
  }

  Path drawn(const Tip& tip, double length) {
    Path path;
    const Vec3 start = skeleton_.points[tip.point];
    const int steps = std::max(2, static_cast<int>(std::ceil(length / (kStep * tip.radius))));
    const double step = length / steps, taper = uniform(0.75, 1);
    Vec3 axis = any_direction(), direction = tip.direction, at = start;
    axis = (axis - axis.dot(direction) * direction).normalized();
    const double curvature = length < 3 * tip.radius ? 0 : uniform(0, 0.25) / tip.radius;
    for (int i = 1; i <= steps; ++i) {
      at += step * direction;
      direction = (direction + curvature * step * axis).normalized();
      axis = (axis - axis.dot(direction) * direction).normalized();
      path.points.push_back(at);
      path.radii.push_back(tip.radius * (1 + (taper - 1) * i / steps));
    }
    path.direction = direction;
    return path;
  }

  /// Whether the path keeps away from all vessels but those of the junction at `start`, which has radius `radius`.
  bool is_free(const Path& path, const Vec3& start, double radius) const {
    for (std::size_t i = 0; i < path.points.size(); ++i) {
      const bool near = (path.points[i] - start).norm() < kNear * radius;
      for (std::size_t j = 0; j < skeleton_.points.size(); ++j) {
        const Vec3& other = skeleton_.points[j];
        if (near && (other - start).norm() < (kNear + 1) * radius) {
          continue;
        }
        if ((path.points[i] - other).norm() < kGap * (path.radii[i] + skeleton_.radii[j])) {
          return false;
        }
      }
    }
    return true;
  }

  int add(const Tip& tip, const Path& path) {
    int before = tip.point;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
      skeleton_.points.push_back(path.points[i]);
      skeleton_.radii.push_back(path.radii[i]);
      skeleton_.segments.push_back({before, static_cast<int>(skeleton_.points.size()) - 1});
      before = static_cast<int>(skeleton_.points.size()) - 1;
    }
    return before;
  }

  void grow(const Tip& tip) {
    const double at_start = std::max(skeleton_.radii[tip.point], tip.radius);
    const bool is_link = tip.is_link && left_ > 0;
    for (int attempt = 0; attempt < 60; ++attempt) {
      const double length =
          is_link ? at_start * uniform(0.5, 1.2) : tip.radius * std::pow(0.985, attempt) * uniform(7, 13);
      const Path path = drawn(tip, length);
      if (is_free(path, skeleton_.points[tip.point], at_start)) {
        const int end = add(tip, path);
        if (left_ > 0) {
          fork(end, path, is_link ? tip.others : std::vector<Vec3>{});
        }
        return;
      }
    }
  }

  /// Two or three tips at the end of a path, away from each other and from `others`.
  void fork(int end, const Path& path, const std::vector<Vec3>& others) {
    const double radius = path.radii.back();
    const std::size_t wanted = uniform(0, 1) < 0.8 ? 2 : 3;
    for (int attempt = 0; attempt < 500; ++attempt) {
      std::vector<Vec3> taken = others;
      taken.push_back(-path.direction);
      std::vector<Tip> children;
      while (children.size() < wanted) {
        const Vec3 d = any_direction();
        const Tip child{end, d, radius * uniform(0.55, 0.95), false, {}};
        Path probe;
        for (int i = 1; i <= 8; ++i) {
          probe.points.push_back(skeleton_.points[end] + 0.5 * i * radius * d);
          probe.radii.push_back(child.radius);
        }
        if (d.dot(path.direction) < 0 || !is_free(probe, skeleton_.points[end], radius) ||
            std::any_of(taken.begin(), taken.end(),
                        [&](const Vec3& t) { return degrees_between(t, d) < kLeastAngle; })) {
          break;
        }
        taken.push_back(d);
        children.push_back(child);
      }
      if (children.size() == wanted) {
        if (others.empty() && uniform(0, 1) < kLinks) {  // not two links in a row: vessels would cross
          children[0].is_link = true;
          children[0].others.push_back(-path.direction);
          for (std::size_t c = 1; c < wanted; ++c) {
            children[0].others.push_back(children[c].direction);
          }
        }
        tips_.insert(tips_.end(), children.begin(), children.end());
        --left_;
        return;
      }
    }
  }

  std::mt19937 random_;
  int left_;  ///< junctions to be made
  Skeleton skeleton_;
  std::deque<Tip> tips_;
};

}  // namespace vasohex::gallery
