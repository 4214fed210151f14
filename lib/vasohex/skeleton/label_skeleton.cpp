#include "vasohex/skeleton/label_skeleton.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vasohex/core/parallel.h"
#include "vasohex/skeleton/axis_steps.h"
#include "vasohex/skeleton/lumen_section.h"
#include "vasohex/skeleton/narrow_holes.h"
#include "vasohex/skeleton/smooth_path.h"
#include "vasohex/skeleton/thinning.h"
#include "vasohex/skeleton/voxel_graph.h"
#include "vasohex/surface/distance_map.h"
#include "vasohex/surface/smooth_labels.h"

namespace vasohex {
namespace {

constexpr double kLeastTip = 1.0;  // what sticks out by more than this many radii of the lumen may be a vessel
constexpr double kSpacing = 0.4;   // radii between points
constexpr int kCentrings = 8;
constexpr double kWholeSection = 0.9;  // radius of an end's section over that of its vessel

/// The middle line between two nodes, both included.
struct Line {
  std::array<int, 2> nodes{};
  std::array<bool, 2> free{};  ///< whether it ends there
  std::vector<Vec3> points;
  std::vector<double> radii;
};

struct Node {
  Vec3 position;
  double radius = 0;  ///< of the inscribed ball
  int degree = 0;
};

/// Position and radius at arc length s of a polyline.
struct Place {
  Vec3 position;
  double radius;
};
Place place_at(const Line& line, const std::vector<double>& arc, double s) {
  std::size_t k = 1;
  while (k + 1 < arc.size() && arc[k] < s) {
    ++k;
  }
  const double t = std::clamp((s - arc[k - 1]) / (arc[k] - arc[k - 1]), 0.0, 1.0);
  return {(1 - t) * line.points[k - 1] + t * line.points[k], (1 - t) * line.radii[k - 1] + t * line.radii[k]};
}

/// Points moved towards the middle of their neighbours, ends fixed.
void smooth(std::vector<Vec3>& points, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<Vec3> moved = points;
    for (std::size_t k = 1; k + 1 < points.size(); ++k) {
      moved[k] = 0.25 * points[k - 1] + 0.5 * points[k] + 0.25 * points[k + 1];
    }
    points.swap(moved);
  }
}

/// The same line with points kSpacing radii apart, at least `least`.
Line resampled(const Line& line, double least) {
  Line result = line;
  const std::vector<double> arc = polyline_length(line.points, false);
  // steps proportional to the spacing wanted, so that none is left over at the end
  std::vector<double> steps{0};
  for (std::size_t k = 1; k < arc.size(); ++k) {
    const double wanted = std::max(least, kSpacing * 0.5 * (line.radii[k - 1] + line.radii[k]));
    steps.push_back(steps.back() + (arc[k] - arc[k - 1]) / wanted);
  }
  const int count = std::max(1, static_cast<int>(std::lround(steps.back())));
  result.points.clear();
  result.radii.clear();
  std::size_t k = 1;
  for (int i = 0; i <= count; ++i) {
    const double wanted = steps.back() * i / count;
    while (k + 1 < steps.size() && steps[k] < wanted) {
      ++k;
    }
    const double t = std::clamp((wanted - steps[k - 1]) / (steps[k] - steps[k - 1]), 0.0, 1.0);
    result.points.push_back((1 - t) * line.points[k - 1] + t * line.points[k]);
    result.radii.push_back((1 - t) * line.radii[k - 1] + t * line.radii[k]);
  }
  return result;
}

Vec3 tangent_at(const std::vector<Vec3>& points, std::size_t k) {
  const std::size_t a = k > 1 ? k - 2 : 0, b = std::min(k + 2, points.size() - 1);
  return (points[b] - points[a]).normalized();
}

/// Radii where `measured`, in between by interpolation, all averaged (as areas) over some points: the wall of a thin
/// vessel waves with the voxels.
void smooth_radii(const std::vector<bool>& measured, double otherwise, std::vector<double>& radii) {
  constexpr int passes = 6;
  std::vector<std::size_t> known;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    if (measured[k]) {
      known.push_back(k);
    }
  }
  if (known.empty()) {
    std::fill(radii.begin(), radii.end(), otherwise);
    return;
  }
  std::size_t next = 0;
  for (std::size_t k = 0; k < radii.size(); ++k) {
    while (next < known.size() && known[next] < k) {
      ++next;
    }
    const std::size_t b = known[std::min(next, known.size() - 1)], a = next > 0 ? known[next - 1] : b;
    const double t = b > a ? std::clamp((static_cast<double>(k) - a) / static_cast<double>(b - a), 0.0, 1.0) : 0;
    radii[k] = (1 - t) * radii[a] + t * radii[b];
  }
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<double> before = radii;
    for (std::size_t k = 0; k < radii.size(); ++k) {
      const double left = before[k > 0 ? k - 1 : 0], right = before[std::min(k + 1, radii.size() - 1)];
      radii[k] = std::sqrt(0.25 * left * left + 0.5 * before[k] * before[k] + 0.25 * right * right);
    }
  }
}

/// Moves points to the middle of their sections. In the balls of junctions, where a section has no middle, the line
/// runs straight to the node.
void centre(const LevelSet& level_set, const std::vector<Node>& nodes, Line& line) {
  const std::size_t last = line.points.size() - 1;
  // points in balls of junctions
  std::vector<bool> bound(line.points.size(), false);
  std::size_t first_free = 0, last_free = last;
  for (int side = 0; side < 2; ++side) {
    if (line.free[side]) {
      continue;
    }
    const Node& node = nodes[line.nodes[side]];
    std::size_t k = 0;
    while (k <= last && (line.points[side == 0 ? k : last - k] - node.position).norm() < node.radius) {
      bound[side == 0 ? k : last - k] = true;
      ++k;
    }
    (side == 0 ? first_free : last_free) = side == 0 ? k : last - std::min(k, last);
  }
  const double voxel = level_set.lattice().spacing.mean();
  const auto straight = [&](std::size_t from, std::size_t to) {  // the points between two that stay
    for (std::size_t k = from + 1; k < to; ++k) {
      const double t = static_cast<double>(k - from) / static_cast<double>(to - from);
      line.points[k] = (1 - t) * line.points[from] + t * line.points[to];
    }
  };
  std::vector<bool> measured(line.points.size(), false), whole = measured;
  if (first_free > last_free || first_free > last) {  // all in the balls that fill junctions
    for (std::size_t k = 0; k <= last; ++k) {
      line.radii[k] = inscribed_radius(level_set, line.points[k], 2 * line.radii[k] + voxel);
      measured[k] = line.radii[k] > 0;
    }
    smooth_radii(measured, 0.5 * voxel, line.radii);
    return;
  }
  for (int pass = 0; pass <= kCentrings; ++pass) {
    std::vector<Vec3> moved = line.points;
    for (std::size_t k = 0; k <= last; ++k) {
      if (bound[k]) {
        continue;
      }
      const Vec3 tangent = tangent_at(line.points, k);
      const auto section = measure_section(level_set, line.points[k], tangent, 3 * line.radii[k] + voxel);
      measured[k] = section.has_value();
      whole[k] = section && !section->open;
      if (!section) {
        moved[k] = deepest_near(level_set, line.points[k], 0.25 * voxel, 2 * voxel);
        continue;
      }
      line.radii[k] = std::max(section->radius, 0.25 * voxel);
      const double longest = 0.5 * line.radii[k];
      const Vec3 shift = section->shift - tangent * tangent.dot(section->shift);
      moved[k] += shift.norm() > longest ? Vec3(shift.normalized() * longest) : shift;
    }
    if (pass == kCentrings) {
      break;  // the last pass only measures
    }
    line.points = moved;
    smooth(line.points, 1);
    if (!line.free[0] && first_free > 0) {
      straight(0, first_free);
    }
    if (!line.free[1] && last_free < last) {
      straight(last_free, last);
    }
  }
  // a branch has its own radius up to the node; where another one is open to it, it cannot be measured
  const bool any_whole = std::find(whole.begin(), whole.end(), true) != whole.end();
  smooth_radii(any_whole ? whole : measured, 0.5 * voxel, line.radii);
  // centres of thin sections are as uncertain as the voxels are large
  std::vector<Vec3> smoother = line.points;
  smooth(smoother, 3);
  for (std::size_t k = 0; k <= last; ++k) {
    const double share = std::clamp(3 - line.radii[k] / voxel, 0.0, 1.0);
    line.points[k] += share * (smoother[k] - line.points[k]);
  }
}

/// Cuts a line at its free end (the last point) where the vessel's section is whole; the plane there. The last two
/// radii, where the line turns to the farthest corner of the blunt end, are traced anew.
SurfaceEnd cut_end(const LevelSet& level_set, Line& line) {
  const std::vector<double> arc = polyline_length(line.points, false);
  const double length = arc.back();
  std::vector<double> radii(line.radii.begin() + static_cast<std::ptrdiff_t>(line.radii.size() / 2),
                            line.radii.end());
  std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2), radii.end());
  double radius = radii[radii.size() / 2];
  radius = place_at(line, arc, std::max(length - 2 * radius, 0.5 * length)).radius;
  const double near = std::max(length - 2 * radius, 0.5 * length), far = std::max(near - 1.5 * radius, 0.0);
  Vec3 x = place_at(line, arc, near).position;
  Vec3 normal = (x - place_at(line, arc, far).position).normalized();
  double here = place_at(line, arc, near).radius;
  std::size_t keep = 1;
  while (keep < arc.size() && arc[keep] < near - 0.5 * kSpacing * radius) {
    ++keep;
  }
  line.points.resize(keep);
  line.radii.resize(keep);
  line.points.push_back(x);
  line.radii.push_back(here);
  double traced = 0;
  for (double step = kSpacing * radius; step > 0.05 * radius && traced < 4 * radius;) {
    Vec3 next = x + step * normal;
    const auto section = measure_section(level_set, next, normal, 3 * radius);
    if (!section || section->radius < kWholeSection * radius) {
      step *= 0.5;
      continue;
    }
    const double longest = 0.25 * step;  // bends of less than about a radius are none
    next += section->shift.norm() > longest ? Vec3(section->shift.normalized() * longest) : section->shift;
    normal = (normal + 0.5 * (next - x).normalized()).normalized();
    x = next;
    here = section->radius;
    traced += step;
    line.points.push_back(x);
    line.radii.push_back(here);
  }
  return {x, normal, here};
}

int cycles_of(const VoxelGraph& graph) {
  std::vector<int> up(graph.nodes.size());
  std::iota(up.begin(), up.end(), 0);
  const auto top = [&](int i) {
    while (up[i] != i) {
      i = up[i] = up[up[i]];
    }
    return i;
  };
  int cycles = 0;
  for (const VoxelChain& chain : graph.chains) {
    const int a = top(chain.nodes[0]), b = top(chain.nodes[1]);
    cycles += a == b;
    up[a] = b;
  }
  return cycles;
}

Line line_of(const LabelVolume& volume, const std::vector<float>& distances, const VoxelChain& chain) {
  Line line;
  line.nodes = chain.nodes;
  const double half = 0.5 * volume.spacing.minCoeff();
  for (const std::size_t v : chain.voxels) {
    line.points.push_back(volume.centre(v));
    line.radii.push_back(-distances[v] - half + 0.25 * half);
  }
  return line;
}

void append(const Line& line, std::vector<int>& point_of, const std::vector<Node>& nodes, Skeleton& skeleton) {
  const auto point = [&](const Vec3& position, double radius) {
    skeleton.points.push_back(position);
    skeleton.radii.push_back(radius);
    return static_cast<int>(skeleton.points.size()) - 1;
  };
  const auto node = [&](int side) {
    int& p = point_of[line.nodes[side]];
    if (p < 0) {
      const Node& n = nodes[line.nodes[side]];
      p = line.free[side] ? point(side == 0 ? line.points.front() : line.points.back(),
                                  side == 0 ? line.radii.front() : line.radii.back())
                          : point(n.position, n.radius);
    }
    return p;
  };
  int before = node(0);
  for (std::size_t k = 1; k + 1 < line.points.size(); ++k) {
    const int p = point(line.points[k], line.radii[k]);
    skeleton.segments.push_back({before, p});
    before = p;
  }
  skeleton.segments.push_back({before, node(1)});
}

}  // namespace

LabelSkeleton extract_skeleton(const LabelVolume& given, const LabelSkeletonOptions& options, const Run& run) {
  check(given);
  LabelSkeleton result;
  const double least_hole = options.least_hole * given.spacing.mean();
  CleanLabels clean =
      clean_labels(least_hole > 0 ? without_narrow_holes(given, least_hole, result.repairs, run) : given,
                   options.least_voxels, kLevelSetMargin);
  const LabelVolume& volume = clean.volume;
  result.components = clean.components;
  result.tunnels = clean.tunnels;
  result.repairs.insert(result.repairs.end(), clean.repairs.begin(), clean.repairs.end());
  run.progress("skeleton", 0);
  std::vector<float> distances = signed_centre_distances(volume, run);
  run.progress("skeleton", 0.2);
  VoxelGraph graph = voxel_graph(volume, thin(volume, distances, vessel_tips(volume, distances, kLeastTip)));
  prune(volume, distances, options.least_branch, graph, result.repairs);
  if (graph.chains.empty()) {
    throw Error(ErrorCode::bad_input, "no vessel found in the segmentation: nothing in it is longer than wide");
  }
  std::vector<AxisStep> axis;
  std::vector<Line> lines;
  for (const VoxelChain& chain : graph.chains) {
    lines.push_back(line_of(volume, distances, chain));
    add_axis_steps(volume, chain.voxels, lines.back().radii, axis, result.repairs);
  }
  std::vector<double> depth;
  for (const std::size_t v : graph.nodes) {
    depth.push_back(-distances[v]);
  }
  result.level_set = std::make_shared<const LevelSet>(make_level_set(volume, std::move(distances), axis, {}, run));
  const LevelSet& level_set = *result.level_set;

  const double voxel = volume.spacing.mean();
  std::vector<Node> nodes;
  for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
    nodes.push_back({volume.centre(graph.nodes[n]), depth[n], 0});
  }
  for (const Line& line : lines) {
    ++nodes[line.nodes[0]].degree;
    ++nodes[line.nodes[1]].degree;
  }
  for (Node& node : nodes) {
    if (node.degree > 2) {
      node.position = deepest_near(level_set, node.position, 0.25 * voxel, std::max(voxel, 0.5 * node.radius));
    }
    node.radius = std::max(inscribed_radius(level_set, node.position, 2 * node.radius + voxel), 0.25 * voxel);
  }
  std::vector<std::vector<SurfaceEnd>> ends(lines.size());
  parallel_for(run, lines.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l) {
      Line& line = lines[l];
      line.free = {nodes[line.nodes[0]].degree == 1, nodes[line.nodes[1]].degree == 1};
      smooth(line.points, 3);
      line.points.front() = nodes[line.nodes[0]].position;
      line.points.back() = nodes[line.nodes[1]].position;
      line = resampled(line, voxel);
      centre(level_set, nodes, line);
      for (int side = 0; side < 2; ++side) {
        if (line.free[side]) {
          const auto turn = [&] {
            if (side == 0) {
              std::reverse(line.points.begin(), line.points.end());
              std::reverse(line.radii.begin(), line.radii.end());
            }
          };
          turn();
          ends[l].push_back(cut_end(level_set, line));
          turn();
        }
      }
      line = resampled(line, voxel);
    }
  });
  std::vector<int> point_of(nodes.size(), -1);
  for (std::size_t l = 0; l < lines.size(); ++l) {
    append(lines[l], point_of, nodes, result.skeleton);
    std::size_t next = 0;
    for (int side = 0; side < 2; ++side) {
      if (lines[l].free[side]) {
        result.ends.push_back(ends[l][next++]);
        result.end_points.push_back(point_of[lines[l].nodes[side]]);
      }
    }
  }
  if (const int closed = result.tunnels - cycles_of(graph); closed > 0) {
    result.repairs.push_back(std::to_string(closed) + " holes of about one voxel have no cycle");
  }
  result.skeleton.units = volume.units;
  return result;
}

}  // namespace vasohex
