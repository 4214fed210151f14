#include "vasohex/blocks/arm_axis.h"

#include <algorithm>
#include <cmath>

namespace vasohex {
namespace {

/// Unit directions at the points: means of those of the pieces beside them.
std::vector<Vec3> tangents(const ArmAxis& axis) {
  const std::size_t n = axis.points.size();
  std::vector<Vec3> t(n);
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 sum = Vec3::Zero();
    if (i > 0) {
      sum += (axis.points[i] - axis.points[i - 1]).normalized();
    }
    if (i + 1 < n) {
      sum += (axis.points[i + 1] - axis.points[i]).normalized();
    }
    t[i] = sum.norm() > 1e-9 ? Vec3(sum.normalized()) : (i > 0 ? t[i - 1] : Vec3(Vec3::UnitX()));
  }
  return t;
}

}  // namespace

ArmPoint arm_point(const ArmAxis& axis, double s) {
  s = std::max(s, 0.0);
  for (std::size_t i = 0; i + 1 < axis.points.size(); ++i) {
    const double piece = (axis.points[i + 1] - axis.points[i]).norm();
    if (s <= piece && piece > 0) {
      const double t = s / piece;
      return {(1 - t) * axis.points[i] + t * axis.points[i + 1], (1 - t) * axis.radii[i] + t * axis.radii[i + 1]};
    }
    s -= piece;
  }
  return {axis.points.back(), axis.radii.back()};
}

double length_of(const ArmAxis& axis) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < axis.points.size(); ++i) {
    length += (axis.points[i + 1] - axis.points[i]).norm();
  }
  return length;
}

ArmAxis reversed(ArmAxis axis) {
  std::reverse(axis.points.begin(), axis.points.end());
  std::reverse(axis.radii.begin(), axis.radii.end());
  return axis;
}

ArmPoint middle_of(const std::vector<ArmPoint>& places) {
  ArmPoint middle;
  double radii = 0;
  for (const ArmPoint& p : places) {
    middle.position += p.radius * p.position;
    middle.radius = std::max(middle.radius, p.radius);
    radii += p.radius;
  }
  middle.position /= radii;
  return middle;
}

double parting_length(const ArmAxis& a, const ArmAxis& b) {
  const double longest = std::min(length_of(a), length_of(b));
  const double step = 0.1 * std::min(a.radii.front(), b.radii.front());
  for (double s = 0; s < longest; s += step) {
    const ArmPoint p = arm_point(a, s), q = arm_point(b, s);
    if ((p.position - q.position).norm() > p.radius + q.radius) {
      return s;
    }
  }
  return longest;
}

std::vector<SectionFrame> transported_frames(const ArmAxis& axis) {
  const std::vector<Vec3> t = tangents(axis);
  std::vector<SectionFrame> frames;
  Vec3 x = t.front().unitOrthogonal();
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (i > 0) {
      x = Eigen::Quaterniond::FromTwoVectors(t[i - 1], t[i]) * x;
      x = (x - t[i].dot(x) * t[i]).normalized();
    }
    SectionFrame f;
    f.origin = axis.points[i];
    f.x = x;
    f.y = t[i].cross(x);
    f.radius = axis.radii[i];
    frames.push_back(f);
  }
  return frames;
}

std::vector<int> layer_places(const ArmAxis& axis, const std::vector<double>& widths, bool cube_at_end) {
  constexpr double kCube = 0.4;  // what a cube takes up, in layers
  const std::vector<Vec3> t = tangents(axis);
  std::vector<double> before{0};
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double along = (axis.points[i] - axis.points[i - 1]).norm() / (widths[i] + widths[i - 1]);
    const double turn = angle_between(t[i - 1], t[i]);
    before.push_back(before.back() + std::max(along, turn / 0.7));
  }
  const double first = kCube, last = before.back() - (cube_at_end ? kCube : 0.0);
  const int layers = static_cast<int>(std::lround(last - first - 0.4));
  std::vector<int> places;
  for (int layer = 1; layer < layers; ++layer) {
    const double wanted = first + (last - first) * layer / layers;
    const auto at = std::lower_bound(before.begin(), before.end(), wanted);
    places.push_back(static_cast<int>(at - before.begin()));
  }
  return places;
}

}  // namespace vasohex
