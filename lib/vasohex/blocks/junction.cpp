#include "vasohex/blocks/junction.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "vasohex/core/reference_hex.h"
#include "vasohex/surface/project.h"

namespace vasohex {
namespace {

using Face6 = std::array<int, 6>;

Vec3 face_normal(int face) {
  Vec3 n = Vec3::Zero();
  n[face / 2] = face % 2 == 1 ? 1 : -1;
  return n;
}

/// The 24 rotations of the cube as permutations of its faces.
std::vector<Face6> cube_rotations() {
  std::vector<Face6> rotations;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
      for (int d = 0; d < 3; ++d) {
        m(axes[d], d) = (signs >> d) & 1 ? -1 : 1;
      }
      if (m.determinant() < 0) {
        continue;
      }
      Face6 image{};
      for (int f = 0; f < 6; ++f) {
        image[f] = 2 * axes[f / 2] + ((f % 2) ^ ((signs >> (f / 2)) & 1));
      }
      rotations.push_back(image);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return rotations;
}

/// Corners of a face, counter-clockwise seen from outside.
std::array<int, 4> face_ring(int face) {
  const auto c = hex_face(face);
  return {c[0], c[1], c[3], c[2]};
}

/// Vertices and blocks of one problem while it grows.
struct Builder {
  const ImplicitSurface& surface;
  ClusterBlocks out;

  int vertex(const Vec3& p) {
    out.problem.vertices.push_back(p);
    return static_cast<int>(out.problem.vertices.size()) - 1;
  }
  /// The block from quad `low` to quad `high`, both cyclic, counter-clockwise seen from `high`.
  int block(const std::array<int, 4>& low, const std::array<int, 4>& high, int aim, int hub,
            const DirectionKinds& kinds) {
    out.problem.blocks.push_back({low[0], low[1], low[3], low[2], high[0], high[1], high[3], high[2]});
    out.problem.block_aim.push_back(aim);
    out.kinds.push_back(kinds);
    out.block_hub.push_back(hub);
    return static_cast<int>(out.problem.blocks.size()) - 1;
  }
  /// Five blocks between two O-grids of vertices; returns the core's number, the others follow.
  int o_grid(const std::array<int, 4>& in0, const std::array<int, 4>& out0, const std::array<int, 4>& in1,
             const std::array<int, 4>& out1, int aim, int hub) {
    const int core = block(in0, in1, aim, hub, kCoreBlock);
    for (int j = 0; j < 4; ++j) {
      const int n = (j + 1) % 4;
      block({in0[j], out0[j], out0[n], in0[n]}, {in1[j], out1[j], out1[n], in1[n]}, aim, hub, kOuterBlock);
    }
    return core;
  }
  Vec3 wall_from(const Vec3& origin, const Vec3& direction, double radius) const {
    const double t = shoot(surface, origin, direction, radius, 20 * radius).value_or(radius);
    return origin + t * direction;
  }
};

/// A cube's vertices and what lies at its faces.
struct Cube {
  std::array<int, 8> inner{}, outer{};
  Face6 arm{-1, -1, -1, -1, -1, -1};
};

Cube place_cube(Builder& builder, const std::vector<Hub>& hubs, int h, const CubeAssignment& assignment) {
  const Hub& hub = hubs[h];
  Cube cube;
  double mean_radius = 0;
  for (std::size_t a = 0; a < hub.arms.size(); ++a) {
    cube.arm[assignment.face[a]] = static_cast<int>(a);
    mean_radius += hub.arms[a].radius / hub.arms.size();
  }
  std::array<Vec3, 6> direction;
  std::array<double, 6> radius;
  for (int f = 0; f < 6; ++f) {
    const bool taken = cube.arm[f] >= 0;
    direction[f] = taken ? hub.arms[cube.arm[f]].direction : assignment.rotation * face_normal(f);
    radius[f] = taken ? hub.arms[cube.arm[f]].radius : mean_radius;
  }
  for (int f = 0; f < 6; ++f) {
    if (cube.arm[f] >= 0) {
      continue;
    }
    // faces on the wall lean away from the arms beside them
    const Vec3 n = assignment.rotation * face_normal(f);
    Vec3 lean = Vec3::Zero();
    for (int g = 0; g < 6; ++g) {
      if (cube.arm[g] >= 0) {
        lean += (g == (f ^ 1) ? 0.5 : std::max(0.0, direction[g].dot(n))) * direction[g];
      }
    }
    direction[f] = (n - 0.6 * lean).normalized();
  }
  for (int c = 0; c < 8; ++c) {
    Vec3 aim = Vec3::Zero(), aside = Vec3::Zero();
    int link = -1;
    for (int d = 0; d < 3; ++d) {
      const int f = 2 * d + ((c >> d) & 1);
      aim += direction[f] / radius[f];
      if (cube.arm[f] >= 0 && hub.arms[cube.arm[f]].link >= 0) {
        link = f;
      } else {
        aside += direction[f] / radius[f];
      }
    }
    if (aim.norm() < 1e-6 / mean_radius) {
      aim = assignment.rotation * Vec3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
    }
    aim.normalize();
    Vec3 wall = builder.wall_from(hub.centre, aim, mean_radius);
    if (link >= 0) {
      // not beyond the middle between two linked hubs
      const Arm& arm = hub.arms[cube.arm[link]];
      const double limit = 0.35 * (hubs[arm.link].centre - hub.centre).norm();
      const Vec3 across = aside - arm.direction.dot(aside) * arm.direction;
      if ((wall - hub.centre).dot(arm.direction) > limit && across.norm() > 1e-3 / mean_radius) {
        wall = builder.wall_from(hub.centre + limit * arm.direction, across.normalized(), mean_radius);
      }
    }
    cube.outer[c] = builder.vertex(wall);
    cube.inner[c] = builder.vertex(hub.centre + 0.5 * (wall - hub.centre));
  }
  return cube;
}

/// Angle about the arm's axis, at its start, that turns the corners of a section in `frame` nearest to those of the
/// cube's face.
double turn_to_cube(const Builder& builder, const Hub& hub, const SectionFrame& frame, const std::array<int, 4>& ring,
                    const Cube& cube) {
  Vec3 middle = Vec3::Zero();
  for (const int c : ring) {
    middle += 0.25 * builder.out.problem.vertices[cube.outer[c]];
  }
  // of a lone cube the corners are seen from its centre, of a linked one, which may lie beside it, from their middle
  const bool linked = std::any_of(hub.arms.begin(), hub.arms.end(), [](const Arm& a) { return a.link >= 0; });
  const Vec3 from = linked ? middle : hub.centre;
  double c_sum = 0, s_sum = 0;
  for (int j = 0; j < 4; ++j) {
    const Vec3 t = builder.out.problem.vertices[cube.outer[ring[j]]] - from;
    const double angle = std::atan2(t.dot(frame.y), t.dot(frame.x)) - (2 * j + 1) * std::numbers::pi / 4;
    c_sum += std::cos(angle);
    s_sum += std::sin(angle);
  }
  return std::atan2(s_sum, c_sum);
}

/// How far the wall is from each point of an arm's axis: its own radius, or more as long as it is within arms of its
/// hubs that are much wider. A thin vessel's blocks start in the middle of the wide one that it leaves, as wide as
/// that.
std::vector<double> widths_along(const std::vector<Hub>& hubs, int h, int a) {
  constexpr double kMuchWider = 6;  // below, layers as short as the arm asks for are as good or better
  const Arm& arm = hubs[h].arms[a];
  std::vector<double> widths = arm.axis.radii;
  for (const int hub : {h, arm.link}) {
    for (std::size_t b = 0; hub >= 0 && b < hubs[hub].arms.size(); ++b) {
      const Arm& other = hubs[hub].arms[b];
      for (std::size_t i = 0; i < widths.size() && other.radius > kMuchWider * arm.radius; ++i) {
        for (std::size_t k = 0; k + 1 < other.axis.points.size(); ++k) {
          const Vec3 &from = other.axis.points[k], &to = other.axis.points[k + 1];
          const double t = nearest_on_segment(arm.axis.points[i], from, to);
          const double radius = (1 - t) * other.axis.radii[k] + t * other.axis.radii[k + 1];
          widths[i] = std::max(widths[i], radius - (from + t * (to - from) - arm.axis.points[i]).norm());
        }
      }
    }
  }
  return widths;
}

/// The corners of an O-grid, as vertices.
struct SectionCorners {
  std::array<int, 4> inner{}, outer{};
};

SectionCorners place_corners(Builder& builder, const SectionFrame& frame) {
  SectionCorners corners;
  for (int j = 0; j < 4; ++j) {
    corners.inner[j] = builder.vertex(place_section_point(builder.surface, frame, 1 + j, 0, 0));
    corners.outer[j] = builder.vertex(place_section_point(builder.surface, frame, 1 + j, 1, 0));
  }
  return corners;
}

/// Layers of five blocks from the corners `low` at the start of the axis to `high` at its end. Between, the corners
/// go over from ones to the others as seen from the frames, which turn evenly by `turn` to the first and `turn_end` to
/// the last. Returns the number of the last layer's core block.
int add_layers(Builder& builder, const std::vector<SectionFrame>& frames, double turn, double turn_end,
               const std::vector<int>& places, SectionCorners low, const SectionCorners& high, int aim, int hub) {
  const auto& vertices = builder.out.problem.vertices;
  const auto seen_from = [&](const SectionFrame& frame, int vertex) {
    const Vec3 d = vertices[vertex] - frame.origin;
    return Vec3(frame.x.dot(d), frame.y.dot(d), frame.normal().dot(d));
  };
  const SectionFrame start = turned(frames.front(), turn), end = turned(frames.back(), turn_end);
  const SectionCorners first = low;
  for (const int place : places) {
    const double part = static_cast<double>(place) / static_cast<double>(frames.size() - 1);
    const SectionFrame here = turned(frames[place], (1 - part) * turn + part * turn_end);
    const auto between = [&](int a, int b) {
      const Vec3 p = (1 - part) * seen_from(start, a) + part * seen_from(end, b);
      return builder.vertex(here.origin + p.x() * here.x + p.y() * here.y);
    };
    SectionCorners next;
    for (int j = 0; j < 4; ++j) {
      next.inner[j] = between(first.inner[j], high.inner[j]);
      next.outer[j] = between(first.outer[j], high.outer[j]);
    }
    builder.o_grid(low.inner, low.outer, next.inner, next.outer, aim, hub);
    low = next;
  }
  return builder.o_grid(low.inner, low.outer, high.inner, high.outer, aim, hub);
}

void add_cap(Builder& builder, const std::vector<Hub>& hubs, int h, int a, const Cube& cube, int face, int aim) {
  const Arm& arm = hubs[h].arms[a];
  const auto ring = face_ring(face);
  ClusterBlocks::Cap cap;
  cap.hub = h;
  cap.arm = a;
  const std::vector<SectionFrame> frames = transported_frames(arm.axis);
  const double turn = turn_to_cube(builder, hubs[h], frames.front(), ring, cube);
  // the cap's own plane, with the frame that arrives there
  const Vec3 arrived = turned(frames.back(), turn).x;
  cap.frame = turned(arm.section, std::atan2(arrived.dot(arm.section.y), arrived.dot(arm.section.x)));
  SectionCorners low;
  for (int j = 0; j < 4; ++j) {
    low.inner[j] = cube.inner[ring[j]];
    low.outer[j] = cube.outer[ring[j]];
  }
  const SectionCorners high = place_corners(builder, cap.frame);
  cap.inner = high.inner;
  cap.outer = high.outer;
  const std::vector<int> places = layer_places(arm.axis, widths_along(hubs, h, a), false);
  const int core = add_layers(builder, frames, turn, turn, places, low, high, aim, h);
  for (int q = 0; q < 5; ++q) {
    cap.blocks[q] = core + q;
    builder.out.problem.sections.push_back({core + q, 5, q, cap.frame, arm.at_end});
  }
  builder.out.caps.push_back(cap);
}

/// Joins face `fa` of cube A to face `fb` of cube B along a link by 5 blocks per layer, at the best of 4 offsets.
void add_link(Builder& builder, const std::vector<Hub>& hubs, int hub, int index, const Cube& a, int fa, const Cube& b,
              int fb, int aim) {
  const Arm& arm = hubs[hub].arms[index];
  const auto ring_a = face_ring(fa), ring_b = face_ring(fb);
  const std::vector<SectionFrame> frames = transported_frames(arm.axis);
  const double turn_a = turn_to_cube(builder, hubs[hub], frames.front(), ring_a, a);
  // seen along the link B's ring runs backwards
  const std::array<int, 4> backwards{ring_b[0], ring_b[3], ring_b[2], ring_b[1]};
  const double turn_b = turn_to_cube(builder, hubs[arm.link], frames.back(), backwards, b);
  constexpr double kQuarter = std::numbers::pi / 2;
  // ties (45 degrees exactly) must not be decided by rounding
  const int offset = static_cast<int>(std::floor((turn_a - turn_b) / kQuarter + 0.5 + 1e-6));
  const double twist = turn_b + offset * kQuarter - turn_a;
  SectionCorners low, end;
  for (int j = 0; j < 4; ++j) {
    const int partner = backwards[((j + offset) % 4 + 4) % 4];
    low.inner[j] = a.inner[ring_a[j]];
    low.outer[j] = a.outer[ring_a[j]];
    end.inner[j] = b.inner[partner];
    end.outer[j] = b.outer[partner];
  }
  const std::vector<int> places = layer_places(arm.axis, widths_along(hubs, hub, index), true);
  add_layers(builder, frames, turn_a, turn_a + twist, places, low, end, aim, hub);
}

}  // namespace

Vec3 direction_of(const Arm& arm) {
  const Vec3 away = arm_point(arm.axis, 2.5 * arm.radius).position - arm.axis.points.front();
  return away.norm() > 0 ? Vec3(away.normalized()) : arm.section.normal();
}

double cap_distance(const std::vector<Vec3>& directions, const std::vector<double>& radii, int i) {
  const double least = *std::min_element(radii.begin(), radii.end());
  const double blend = 0.16 * least;  // how far the smooth blend of the surface fills the crotch
  double t = 0.3 * radii[i];
  for (std::size_t j = 0; j < directions.size(); ++j) {
    if (static_cast<int>(j) == i) {
      continue;
    }
    const double ri = radii[i] + blend, rj = radii[j] + blend;
    const double cosine = directions[i].dot(directions[j]);
    const double sine = std::sqrt(std::max(1e-4, 1 - cosine * cosine));
    const double apart = (rj + ri * cosine) / sine;
    t = std::max(t, cosine < 0 ? std::min(apart, rj) : apart);
  }
  return t + 0.5 * radii[i];
}

std::vector<CubeAssignment> cube_assignments(const std::vector<Vec3>& directions, int count) {
  static const std::vector<Face6> rotations = cube_rotations();
  const std::size_t arms = directions.size();
  std::vector<CubeAssignment> all;
  std::set<std::vector<int>> seen;
  std::vector<int> chosen(arms);
  std::function<void(std::size_t, int)> choose = [&](std::size_t arm, int used) {
    if (arm == arms) {
      std::vector<int> canonical;
      for (const Face6& rotation : rotations) {
        std::vector<int> image(arms);
        for (std::size_t a = 0; a < arms; ++a) {
          image[a] = rotation[chosen[a]];
        }
        if (canonical.empty() || image < canonical) {
          canonical = image;
        }
      }
      if (!seen.insert(canonical).second) {
        return;
      }
      // the rotation that turns the faces best towards the arms [Kabsch 1976]
      Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
      for (std::size_t a = 0; a < arms; ++a) {
        h += face_normal(canonical[a]) * directions[a].transpose();
      }
      const Eigen::JacobiSVD<Eigen::Matrix3d> svd(h, Eigen::ComputeFullU | Eigen::ComputeFullV);
      Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
      mirror(2, 2) = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
      CubeAssignment c;
      c.face = canonical;
      c.rotation = svd.matrixV() * mirror * svd.matrixU().transpose();
      double largest = 0;
      for (std::size_t a = 0; a < arms; ++a) {
        const double angle = angle_between(c.rotation * face_normal(canonical[a]), directions[a]);
        c.cost += angle * angle;
        largest = std::max(largest, angle);
      }
      c.cost += largest * largest;
      all.push_back(c);
      return;
    }
    for (int f = 0; f < 6; ++f) {
      if (!((used >> f) & 1)) {
        chosen[arm] = f;
        choose(arm + 1, used | (1 << f));
      }
    }
  };
  choose(0, 0);
  // costs that differ by rounding only must not decide the order: symmetric arms would be meshed differently when
  // turned
  std::stable_sort(all.begin(), all.end(), [](const CubeAssignment& a, const CubeAssignment& b) {
    return std::llround(a.cost * 1e6) < std::llround(b.cost * 1e6);
  });
  std::vector<CubeAssignment> best;
  for (const CubeAssignment& c : all) {
    if (static_cast<int>(best.size()) < count && (best.empty() || c.cost > best.back().cost + 2e-6)) {
      best.push_back(c);
    }
  }
  return best;
}

ClusterBlocks cluster_blocks(const ImplicitSurface& surface, const std::vector<Hub>& hubs,
                             const std::vector<CubeAssignment>& assignments) {
  Builder builder{surface, {}};
  builder.out.problem.surface = &surface;
  std::vector<BlockProblem::Aim>& aims = builder.out.problem.aims;
  for (const Hub& hub : hubs) {
    aims.push_back({{}, hub.centre});
  }
  std::vector<Cube> cubes;
  for (std::size_t h = 0; h < hubs.size(); ++h) {
    cubes.push_back(place_cube(builder, hubs, static_cast<int>(h), assignments[h]));
  }
  for (int h = 0; h < static_cast<int>(hubs.size()); ++h) {
    const Cube& cube = cubes[h];
    const auto& I = cube.inner;
    builder.block({I[0], I[1], I[3], I[2]}, {I[4], I[5], I[7], I[6]}, h, h,
                  {DirectionKind::core, DirectionKind::core, DirectionKind::core});
    for (int f = 0; f < 6; ++f) {
      const auto ring = face_ring(f);
      const int a = cube.arm[f];
      if (a < 0) {
        std::array<int, 4> low{}, high{};
        for (int j = 0; j < 4; ++j) {
          low[j] = cube.inner[ring[j]];
          high[j] = cube.outer[ring[j]];
        }
        builder.block(low, high, h, h, {DirectionKind::core, DirectionKind::core, DirectionKind::radial});
        continue;
      }
      const Arm& arm = hubs[h].arms[a];
      if (arm.link < 0) {
        aims.push_back({arm.axis.points, hubs[h].centre});
        add_cap(builder, hubs, h, a, cube, f, static_cast<int>(aims.size()) - 1);
      } else if (arm.end == 0) {  // each link once, from the hub where its branch starts
        const auto& others = hubs[arm.link].arms;
        const auto back = std::find_if(others.begin(), others.end(),
                                       [&](const Arm& o) { return o.branch == arm.branch && o.end == 1; });
        const int face = assignments[arm.link].face[back - others.begin()];
        aims.push_back({arm.axis.points, 0.5 * (hubs[h].centre + hubs[arm.link].centre)});
        add_link(builder, hubs, h, a, cube, f, cubes[arm.link], face, static_cast<int>(aims.size()) - 1);
      }
    }
  }
  return std::move(builder.out);
}

}  // namespace vasohex
