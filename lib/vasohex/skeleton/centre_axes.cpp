#include "vasohex/skeleton/centre_axes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "vasohex/core/parallel.h"
#include "vasohex/skeleton/plane_section.h"
#include "vasohex/surface/half_edges.h"

namespace vasohex {
namespace {

constexpr int kPasses = 4;
constexpr double kSpacing = 0.4;   ///< of sections, in local widths
constexpr double kLeastOwn = 0.8;  ///< part of the way around a section that has to be the vessel's own wall
constexpr double kFarthest = 1.0;  ///< that a section moves the axis, in local widths
constexpr double kNearEnd = 0.5;   ///< radii: no sections nearer to a SurfaceEnd, they would cut the rim
constexpr double kStay = 0.01;     ///< weight of the place of a junction in the graph, next to 1 of its widest axis
constexpr double kResultSpacing = 0.5;  ///< radii

/// A place on an axis while it is being moved; radius 0: no section counts there.
struct Station {
  Vec3 point = Vec3::Zero();
  double width = 0;
  double radius = 0;
};
using Path = std::vector<Station>;

/// Stations at equal steps of (length / local size), about `spacing` each; first and last stay.
template <class Size>
Path resample(const Path& path, double spacing, Size&& size) {
  std::vector<double> t{0};
  for (std::size_t i = 1; i < path.size(); ++i) {
    t.push_back(t.back() + (path[i].point - path[i - 1].point).norm() * 2 / (size(path[i]) + size(path[i - 1])));
  }
  const int pieces = std::max(1, static_cast<int>(std::lround(t.back() / spacing)));
  Path result{path.front()};
  std::size_t i = 1;
  for (int k = 1; k < pieces; ++k) {
    const double at = t.back() * k / pieces;
    while (i + 1 < path.size() && t[i] < at) {
      ++i;
    }
    const double u = t[i] > t[i - 1] ? std::clamp((at - t[i - 1]) / (t[i] - t[i - 1]), 0.0, 1.0) : 0.0;
    const Station &a = path[i - 1], &b = path[i];
    result.push_back(
        {(1 - u) * a.point + u * b.point, (1 - u) * a.width + u * b.width, (1 - u) * a.radius + u * b.radius});
  }
  result.push_back(path.back());
  return result;
}

/// Direction of a path at station i, seen over about a local width to both sides.
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

double angle_around(const Vec3& centre, const Vec3& normal, const Vec3& a, const Vec3& b) {
  return std::atan2(normal.dot((a - centre).cross(b - centre)), (a - centre).dot(b - centre));
}

/// Centroid and area of a polygon in the plane with `normal`.
std::pair<Vec3, double> centroid_of(const std::vector<Vec3>& polygon, const Vec3& normal) {
  Vec3 sum = Vec3::Zero();
  double twice_area = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const double a = (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]).dot(normal);
    sum += a / 3 * (polygon[0] + polygon[i] + polygon[i + 1]);
    twice_area += a;
  }
  return {twice_area > 0 ? Vec3(sum / twice_area) : polygon[0], twice_area / 2};
}

struct Section {
  Vec3 centre = Vec3::Zero();
  double area = 0;
  double own = 0;  ///< part of the way around that is the vessel's own wall
};

/// The section of a vessel: the loop around the origin, otherwise the nearest, without the wall of others.
std::optional<Section> section_of(const ClosedLumen& lumen, const std::vector<int>& vessel_of, int vessel,
                                  std::span<const int> edges, const Vec3& origin, const Vec3& normal) {
  const std::vector<SectionLoop> loops = plane_section(lumen, origin, normal, edges);
  const SectionLoop* best = nullptr;
  double least = 0;
  for (const SectionLoop& loop : loops) {
    double around = 0, distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < loop.points.size(); ++i) {
      around += angle_around(origin, normal, loop.points[i], loop.points[(i + 1) % loop.points.size()]);
      distance = std::min(distance, (loop.points[i] - origin).norm());
    }
    const double badness = around > std::numbers::pi ? -1 : distance;
    if (best == nullptr || badness < least) {
      best = &loop;
      least = badness;
    }
  }
  if (best == nullptr) {
    return {};
  }
  std::vector<Vec3> own;
  for (std::size_t i = 0; i < best->points.size(); ++i) {
    if (vessel_of[best->nearest[i]] == vessel) {
      own.push_back(best->points[i]);
    }
  }
  if (own.size() < 3) {
    return {};
  }
  Section section;
  std::tie(section.centre, section.area) = centroid_of(own, normal);
  for (std::size_t i = 0; i < best->points.size(); ++i) {
    const std::size_t j = (i + 1) % best->points.size();
    if (vessel_of[best->nearest[i]] == vessel && vessel_of[best->nearest[j]] == vessel) {
      section.own += angle_around(section.centre, normal, best->points[i], best->points[j]) / (2 * std::numbers::pi);
    }
  }
  return section;
}

/// Moves the inner stations of a path to their sections.
void move_to_sections(Path& path, const std::array<double, 2>& end_radii, const ClosedLumen& lumen,
                      const std::vector<int>& vessel_of, int vessel, std::span<const int> edges) {
  Path moved = path;
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Station& at = path[i];
    moved[i].radius = 0;
    if ((at.point - path.front().point).norm() < kNearEnd * end_radii[0] ||
        (at.point - path.back().point).norm() < kNearEnd * end_radii[1]) {
      continue;
    }
    const auto section = section_of(lumen, vessel_of, vessel, edges, at.point, direction_at(path, i));
    if (section && section->own > kLeastOwn && section->area > 0 &&
        (section->centre - at.point).norm() < kFarthest * at.width) {
      moved[i].point = section->centre;
      moved[i].radius = std::sqrt(section->area / std::numbers::pi);
    }
  }
  path = std::move(moved);
}

/// The stations with a section, seen from one of the ends of the path.
Path counted(const Path& path, bool from_back) {
  Path result;
  std::copy_if(path.begin(), path.end(), std::back_inserter(result), [](const Station& s) { return s.radius > 0; });
  if (from_back) {
    std::reverse(result.begin(), result.end());
  }
  return result;
}

/// The line along which a vessel comes to a node.
struct Arrival {
  Vec3 point = Vec3::Zero();
  Vec3 outward = Vec3::UnitZ();  ///< unit, away from the node
  double radius = 0;
};

std::optional<Arrival> arrival_of(const Path& path, bool at_back) {
  const Path stations = counted(path, at_back);
  if (stations.size() < 2) {
    return {};
  }
  const Station& first = stations.front();
  std::size_t k = 1;
  while (k + 1 < stations.size() && (stations[k].point - first.point).norm() < first.radius) {
    ++k;
  }
  return Arrival{first.point, (stations[k].point - first.point).normalized(), first.radius};
}

/// The point nearest to the lines of the vessels that meet.
Vec3 meeting_point(const std::vector<Arrival>& arrivals, const Vec3& before, double width) {
  double widest = 0;
  for (const Arrival& a : arrivals) {
    widest = std::max(widest, a.radius);
  }
  Eigen::Matrix3d matrix = kStay * Eigen::Matrix3d::Identity();
  Vec3 right = Vec3::Zero();
  for (const Arrival& a : arrivals) {
    const double w = a.radius * a.radius / (widest * widest);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - a.outward * a.outward.transpose();
    matrix += w * across;
    right += w * across * (a.point - before);
  }
  const Vec3 step = matrix.ldlt().solve(right);
  return before + step * std::min(1.0, 1.5 * std::max(width, widest) / std::max(step.norm(), 1e-300));
}

/// Stations between two, on a cubic Hermite curve; directions unit. Neither end is included.
void bridge(Path& path, const Station& a, const Vec3& da, const Station& b, const Vec3& db) {
  const double length = (b.point - a.point).norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / (kSpacing * std::min(a.width, b.width)))));
  for (int k = 1; k < pieces; ++k) {
    const double u = static_cast<double>(k) / pieces, v = 1 - u;
    path.push_back(
        {(1 + 2 * u) * v * v * a.point + u * u * (3 - 2 * u) * b.point + length * u * v * (v * da - u * db),
         v * a.width + u * b.width, 0});
  }
}

/// The path from node to node through the stations that count, all if none does; in between it goes straight on, at
/// ends along `inward`.
Path joined(const Path& path, const Station& start, const std::optional<Vec3>& start_inward, const Station& goal,
            const std::optional<Vec3>& goal_inward) {
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
    bridge(result, all[i], da, all[i + 1], db);
  }
  result.push_back(all.back());
  return result;
}

/// Radii where no section counts: between the nearest ones.
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

}  // namespace

CentredAxes centre_axes(const VesselGraph& graph, const ClosedLumen& lumen, const std::vector<int>& vessel_of,
                        const std::vector<SurfaceEnd>& ends, const Run& run) {
  const std::size_t n = graph.vessels.size();
  std::vector<std::vector<int>> edges(n);  // half-edges that start on each vessel
  for (int h = 0; h < static_cast<int>(lumen.opposite.size()); ++h) {
    if (const int v = vessel_of[start_point(lumen.surface, h)]; v >= 0) {
      edges[v].push_back(h);
    }
  }

  std::vector<Station> nodes;
  for (const VesselNode& node : graph.nodes) {
    nodes.push_back({node.position, node.width, 0});
  }
  std::vector<Path> paths(n);
  for (std::size_t v = 0; v < n; ++v) {
    for (std::size_t i = 0; i < graph.vessels[v].points.size(); ++i) {
      paths[v].push_back({graph.vessels[v].points[i], graph.vessels[v].widths[i], 0});
    }
  }
  const auto end_radius = [&](int node) {
    return graph.nodes[node].end < 0 ? 0 : ends[graph.nodes[node].end].radius;
  };
  const auto inward = [&](int node) {
    return graph.nodes[node].end < 0 ? std::optional<Vec3>() : Vec3(-ends[graph.nodes[node].end].normal);
  };

  for (int pass = 0; pass < kPasses; ++pass) {
    run.progress("centre axes", static_cast<double>(pass) / kPasses);
    parallel_for(run, n, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const auto [a, b] = graph.vessels[v].nodes;
        paths[v] = resample(paths[v], kSpacing, [](const Station& s) { return s.width; });
        move_to_sections(paths[v], {end_radius(a), end_radius(b)}, lumen, vessel_of, static_cast<int>(v), edges[v]);
      }
    });
    std::vector<std::vector<Arrival>> arrivals(nodes.size());
    for (std::size_t v = 0; v < n; ++v) {
      for (const bool back : {false, true}) {
        if (const auto arrival = arrival_of(paths[v], back)) {
          arrivals[graph.vessels[v].nodes[back]].push_back(*arrival);
        }
      }
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const VesselNode& node = graph.nodes[i];
      if (node.dead_end && arrivals[i].size() == 1) {
        const Arrival& a = arrivals[i][0];
        nodes[i].point = a.point - (a.point - nodes[i].point).norm() * a.outward;
      } else if (node.end < 0 && arrivals[i].size() >= 2) {
        nodes[i].point = meeting_point(arrivals[i], node.position, node.width);
      }
      nodes[i].radius = std::max(end_radius(static_cast<int>(i)), 0.0);
      for (const Arrival& a : arrivals[i]) {
        nodes[i].radius = node.end < 0 ? std::max(nodes[i].radius, a.radius) : nodes[i].radius;
      }
    }
    for (std::size_t v = 0; v < n; ++v) {
      const auto [a, b] = graph.vessels[v].nodes;
      Station start = nodes[a], goal = nodes[b];
      start.radius = goal.radius = 0;
      paths[v] = joined(paths[v], start, inward(a), goal, inward(b));
    }
  }

  CentredAxes result;
  for (std::size_t v = 0; v < n; ++v) {
    const auto [a, b] = graph.vessels[v].nodes;
    fill_radii(paths[v], {end_radius(a), end_radius(b)});
    for (const bool back : {false, true}) {
      Station& node = nodes[graph.vessels[v].nodes[back]];
      node.radius = std::max(node.radius, back ? paths[v].back().radius : paths[v].front().radius);
    }
    std::vector<AxisSample> axis;
    for (const Station& s : resample(paths[v], kResultSpacing, [](const Station& s) { return s.radius; })) {
      axis.push_back({s.point, s.radius});
    }
    result.axes.push_back(std::move(axis));
  }
  for (const Station& node : nodes) {
    result.nodes.push_back({node.point, node.radius});
  }
  return result;
}

}  // namespace vasohex
