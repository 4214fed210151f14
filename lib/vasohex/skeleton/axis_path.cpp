#include "vasohex/skeleton/axis_path.h"

#include <limits>

namespace vasohex {

Vec3 direction_at(const Path& path, std::size_t i) {
  const double reach = 0.8 * path[i].width;
  std::size_t a = i, b = i;
  while (a > 0 && (path[a].point - path[i].point).norm() < reach) {
    --a;
  }
  while (b + 1 < path.size() && (path[b].point - path[i].point).norm() < reach) {
    ++b;
  }
  const Vec3 d = path[b].point - path[a].point;
  return d.norm() > 0 ? Vec3(d.normalized()) : Vec3::UnitZ();
}

Path counted(const Path& path, bool from_back) {
  Path result;
  std::copy_if(path.begin(), path.end(), std::back_inserter(result), [](const Station& s) { return s.radius > 0; });
  if (from_back) {
    std::reverse(result.begin(), result.end());
  }
  return result;
}

void bridge(Path& path, const Station& a, const Vec3& da, const Station& b, const Vec3& db, double spacing) {
  const double length = (b.point - a.point).norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / (spacing * std::min(a.width, b.width)))));
  for (int k = 1; k < pieces; ++k) {
    const double u = static_cast<double>(k) / pieces, v = 1 - u;
    path.push_back(
        {(1 + 2 * u) * v * v * a.point + u * u * (3 - 2 * u) * b.point + length * u * v * (v * da - u * db),
         v * a.width + u * b.width, 0});
  }
}

Path joined(const Path& path, const Station& start, const std::optional<Vec3>& start_inward, const Station& goal,
            const std::optional<Vec3>& goal_inward, double spacing) {
  Path stations = counted(path, false);
  if (stations.empty()) {
    stations.assign(path.begin() + 1, path.end() - 1);
  }
  const auto behind = [](const Station& node, const Station& first, const Station& next) {
    const Vec3 d = first.point - node.point;
    return d.dot((next.point - first.point).normalized()) < 0.25 * first.width;
  };
  // the node may have moved along the vessel
  while (stations.size() >= 2 && behind(start, stations[0], stations[1])) {
    stations.erase(stations.begin());
  }
  while (stations.size() >= 2 && behind(goal, stations.back(), stations[stations.size() - 2])) {
    stations.pop_back();
  }
  Path all{start};
  all.insert(all.end(), stations.begin(), stations.end());
  all.push_back(goal);
  const auto tangent = [&](std::size_t i) -> Vec3 {
    const std::size_t a = i > 1 ? i - 1 : i, b = i + 2 < all.size() ? i + 1 : i;
    return a == b ? Vec3((all.back().point - all.front().point).normalized())
                  : Vec3((all[b].point - all[a].point).normalized());
  };
  Path result;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    result.push_back(all[i]);
    const Vec3 chord = (all[i + 1].point - all[i].point).normalized();
    const bool first = i == 0, last = i + 2 == all.size();
    const Vec3 da = first ? start_inward.value_or(chord) : tangent(i);
    const Vec3 db = last ? (goal_inward ? Vec3(-*goal_inward) : chord) : tangent(i + 1);
    bridge(result, all[i], da, all[i + 1], db, spacing);
  }
  result.push_back(all.back());
  return result;
}

void fill_radii(Path& path, const std::array<double, 2>& end_radii) {
  if (end_radii[0] > 0) {
    path.front().radius = end_radii[0];
  }
  if (end_radii[1] > 0) {
    path.back().radius = end_radii[1];
  }
  int before = -1;
  const int n = static_cast<int>(path.size());
  for (int i = 0; i <= n; ++i) {
    if (i < n && path[i].radius <= 0) {
      continue;
    }
    for (int k = before + 1; k < i; ++k) {
      const double u = static_cast<double>(k - before) / (i - before);
      path[k].radius = before < 0 && i == n ? path[k].width
                       : before < 0         ? path[i].radius
                       : i == n             ? path[before].radius
                                            : (1 - u) * path[before].radius + u * path[i].radius;
    }
    before = i;
  }
}

Station station_at(const Path& path, double place) {
  const std::size_t i = std::min(static_cast<std::size_t>(place), path.size() - 2);
  const double u = place - static_cast<double>(i);
  const Station &a = path[i], &b = path[i + 1];
  return {(1 - u) * a.point + u * b.point, (1 - u) * a.width + u * b.width, (1 - u) * a.radius + u * b.radius};
}

Vec3 tangent_at(const Path& path, double place) {
  const std::size_t i = std::min(static_cast<std::size_t>(place), path.size() - 2);
  return (path[i + 1].point - path[i].point).normalized();
}

double length_along(const Path& path, double a, double b) {
  if (b < a) {
    return -length_along(path, b, a);
  }
  double length = 0;
  Vec3 last = station_at(path, a).point;
  for (double k = std::floor(a) + 1; k < b; ++k) {
    const Vec3& next = path[static_cast<std::size_t>(k)].point;
    length += (next - last).norm();
    last = next;
  }
  return length + (station_at(path, b).point - last).norm();
}

double foot_of(const Path& path, const Vec3& x) {
  double foot = 0, near = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vec3 &a = path[i].point, d = path[i + 1].point - a;
    const double s = nearest_on_segment(x, a, path[i + 1].point);
    if (const double distance = (a + s * d - x).norm(); distance < near) {
      foot = static_cast<double>(i) + s;
      near = distance;
    }
  }
  return foot;
}

}  // namespace vasohex
