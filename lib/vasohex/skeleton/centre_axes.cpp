#include "vasohex/skeleton/centre_axes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "vasohex/core/parallel.h"
#include "vasohex/skeleton/axis_path.h"
#include "vasohex/skeleton/axis_section.h"
#include "vasohex/skeleton/place_junctions.h"

namespace vasohex {
namespace {

constexpr int kPasses = 4;
constexpr double kSpacing = 0.4;        ///< of sections, in local widths
constexpr double kLeastOwn = 0.8;       ///< part of the way around a section that has to be the vessel's own wall
constexpr double kFarthest = 1.0;       ///< that a section moves the axis, in local widths
constexpr double kNearEnd = 0.5;        ///< radii: no sections nearer to a SurfaceEnd, they would cut the rim
constexpr double kResultSpacing = 0.5;  ///< radii

/// Moves the inner stations of a path to their sections.
void move_to_sections(Path& path, const std::array<double, 2>& end_radii, const PartedLumen& lumen, int vessel) {
  Path moved = path;
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Station& at = path[i];
    moved[i].radius = 0;
    if ((at.point - path.front().point).norm() < kNearEnd * end_radii[0] ||
        (at.point - path.back().point).norm() < kNearEnd * end_radii[1]) {
      continue;
    }
    const auto section = section_of(lumen, vessel, at.point, direction_at(path, i));
    if (section && section->own > kLeastOwn && section->area > 0 &&
        (section->centre - at.point).norm() < kFarthest * at.width) {
      moved[i].point = section->centre;
      moved[i].radius = std::sqrt(section->area / std::numbers::pi);
    }
  }
  path = std::move(moved);
}

CentredAxes result_of(const VesselGraph& graph, const std::vector<SurfaceEnd>& ends, JunctionLayout layout,
                      std::vector<Path> paths) {
  std::vector<int> number(layout.nodes.size(), -1);
  CentredAxes result;
  const auto add = [&](const std::array<int, 2>& nodes, const Path& path) {
    CentredAxis axis;
    for (const bool back : {false, true}) {
      const int node = nodes[back];
      if (number[node] < 0) {
        number[node] = static_cast<int>(result.nodes.size());
        result.nodes.push_back({layout.nodes[node].point, layout.nodes[node].radius});
        result.end_of.push_back(node < static_cast<int>(graph.nodes.size()) ? graph.nodes[node].end : -1);
      }
      axis.nodes[back] = number[node];
      AxisSample& sample = result.nodes[number[node]];
      sample.radius = std::max(sample.radius, back ? path.back().radius : path.front().radius);
    }
    for (const Station& s : resample(path, kResultSpacing, [](const Station& s) { return s.radius; })) {
      axis.samples.push_back({s.point, s.radius});
    }
    result.axes.push_back(std::move(axis));
  };
  for (std::size_t v = 0; v < paths.size(); ++v) {
    if (layout.vessels[v][0] >= 0) {
      std::array<double, 2> radii{};
      for (const bool back : {false, true}) {
        const int end = graph.nodes[graph.vessels[v].nodes[back]].end;
        radii[back] = end < 0 ? 0 : ends[end].radius;
      }
      fill_radii(paths[v], radii);
      add(layout.vessels[v], paths[v]);
    }
  }
  for (const JunctionLink& link : layout.links) {
    Path path{layout.nodes[link.nodes[0]]};
    path.insert(path.end(), link.path.begin(), link.path.end());
    path.push_back(layout.nodes[link.nodes[1]]);
    add(link.nodes, path);
  }
  return result;
}

}  // namespace

CentredAxes centre_axes(const VesselGraph& graph, const ClosedLumen& lumen, const std::vector<int>& vessel_of,
                        const std::vector<SurfaceEnd>& ends, const Run& run) {
  const std::size_t n = graph.vessels.size();
  const PartedLumen parted = parted_lumen(lumen, vessel_of, n);
  const auto end_radius = [&](int node) {
    return graph.nodes[node].end < 0 ? 0 : ends[graph.nodes[node].end].radius;
  };
  std::vector<Station> nodes;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    nodes.push_back({graph.nodes[i].position, graph.nodes[i].width, end_radius(static_cast<int>(i))});
  }
  std::vector<Path> paths(n);
  for (std::size_t v = 0; v < n; ++v) {
    for (std::size_t i = 0; i < graph.vessels[v].points.size(); ++i) {
      paths[v].push_back({graph.vessels[v].points[i], graph.vessels[v].widths[i], 0});
    }
  }

  JunctionLayout layout;
  for (int pass = 0; pass < kPasses; ++pass) {
    run.progress("centre axes", static_cast<double>(pass) / kPasses);
    parallel_for(run, n, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const auto [a, b] = graph.vessels[v].nodes;
        paths[v] = resample(paths[v], kSpacing, [](const Station& s) { return s.width; });
        move_to_sections(paths[v], {end_radius(a), end_radius(b)}, parted, static_cast<int>(v));
      }
    });
    layout = place_junctions(graph, parted, paths, nodes, ends);
    std::copy_n(layout.nodes.begin(), nodes.size(), nodes.begin());
    for (std::size_t v = 0; v < n; ++v) {
      if (layout.vessels[v][0] < 0) {
        continue;
      }
      std::array<Station, 2> at;
      std::array<std::optional<Vec3>, 2> inward;
      for (const bool back : {false, true}) {
        const int end = graph.nodes[graph.vessels[v].nodes[back]].end;
        at[back] = layout.nodes[layout.vessels[v][back]];
        at[back].radius = 0;
        inward[back] = end < 0 ? layout.inward[v][back] : Vec3(-ends[end].normal);
      }
      paths[v] = joined(paths[v], at[0], inward[0], at[1], inward[1], kSpacing);
    }
  }
  return result_of(graph, ends, layout, std::move(paths));
}

}  // namespace vasohex
