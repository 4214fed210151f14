#include "vasohex/mesh/relax_wall.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "vasohex/core/node_family.h"
#include "vasohex/core/parallel.h"
#include "vasohex/quality/scaled_jacobian.h"

namespace vasohex {
namespace {

/// A node may be moved by the elements around it, and these by their neighbours: more passes would reach further than
/// a part of a mesh knows (mesh_part.h).
constexpr int kPasses = 2;
constexpr int kSteps = 4;          // of relaxation, from none to all
constexpr double kEven = 0.05;     // shifts that differ from bilinear ones by less than this part of an element's height
constexpr double kWorthIt = 0.05;  // gain of the scaled Jacobian

class WallRelaxer {
 public:
  WallRelaxer(HexMesh& mesh, const LatticeNumbering& numbering, std::vector<WallShift> shifts)
      : mesh_(mesh),
        numbering_(numbering),
        p_(mesh.order),
        line_(mesh.order + 1),
        family_(family_nodes(mesh.family, mesh.order)),
        shifts_(std::move(shifts)) {
    std::sort(shifts_.begin(), shifts_.end(), [](const WallShift& a, const WallShift& b) { return a.node < b.node; });
    away_.assign(shifts_.size(), Vec3::Zero());
    part_.assign(shifts_.size(), 0);
  }

  RelaxedWall run(const std::vector<int>& wall_face, const ImplicitSurface& surface, const Run& run) {
    std::vector<char> changed(shifts_.size(), 0);
    for (int pass = 0; pass < kPasses; ++pass) {
      std::vector<std::vector<Choice>> chosen(wall_face.size());
      parallel_for(run, wall_face.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          if (wall_face[b] >= 0) {
            chosen[b] = choose(static_cast<int>(b), wall_face[b], pass == 0 ? nullptr : &changed);
          }
        }
      });
      changed.assign(shifts_.size(), 0);
      for (const std::vector<Choice>& of_block : chosen) {
        for (const Choice& c : of_block) {
          for (std::size_t i = 0; i < c.nodes.size(); ++i) {
            const int n = c.nodes[i];
            if (c.part > part_[n]) {
              away_[n] = part_[n] > 0 ? away_[n] : c.away[i];
              part_[n] = c.part;
              changed[n] = 1;
            }
          }
        }
      }
    }
    return move(wall_face, surface);
  }

 private:
  /// The lattice of a block, lines towards the wall along `d`.
  struct Patch {
    std::array<int, 3> size{}, stride{};
    std::vector<int> ids;
    int d = 0, d1 = 0, d2 = 0;
    bool at_end = false;
    int wall() const { return at_end ? size[d] - 1 : 0; }
    int id(int i, int u, int v) const { return ids[i * stride[d] + u * stride[d1] + v * stride[d2]]; }
  };
  /// How far the nodes of one face are to be relaxed.
  struct Choice {
    double part = 0;
    std::vector<int> nodes;  ///< indices of shifts
    std::vector<Vec3> away;  ///< to the bilinear shifts
  };

  Patch patch(int block, int face) const {
    Patch out;
    const auto c = numbering_.intervals(block);
    out.size = {c[0] + 1, c[1] + 1, c[2] + 1};
    out.stride = {1, out.size[0], out.size[0] * out.size[1]};
    numbering_.block_nodes(block, out.ids);
    out.d = face / 2;
    out.d1 = (out.d + 1) % 3;
    out.d2 = (out.d + 2) % 3;
    out.at_end = face % 2 == 1;
    return out;
  }

  int index(int node) const {
    const auto at = std::lower_bound(shifts_.begin(), shifts_.end(), node,
                                     [](const WallShift& s, int n) { return s.node < n; });
    return static_cast<int>(at - shifts_.begin());
  }

  /// Parts of a wall node's move that the nodes of its line follow with, from the start of the block: by length.
  std::vector<double> follow(const Patch& b, int u, int v) const {
    std::vector<double> part(b.size[b.d], 0);
    const int step = b.at_end ? 1 : -1, core = b.at_end ? 0 : b.size[b.d] - 1;
    double length = 0;
    for (int i = core; i != b.wall(); i += step) {
      length += (mesh_.nodes[b.id(i + step, u, v)] - mesh_.nodes[b.id(i, u, v)]).norm();
      part[i + step] = length;
    }
    for (double& l : part) {
      l /= std::max(length, 1e-300);
    }
    return part;
  }

  std::vector<Choice> choose(int block, int face, const std::vector<char>* changed) const {
    std::vector<Choice> chosen;
    const Patch b = patch(block, face);
    for (int v = 0; v + p_ < b.size[b.d2]; v += p_) {
      for (int u = 0; u + p_ < b.size[b.d1]; u += p_) {
        Choice c;
        for (int at = 0; at < line_ * line_; ++at) {
          c.nodes.push_back(index(b.id(b.wall(), u + at % line_, v + at / line_)));
        }
        c.away = to_bilinear(c.nodes);
        if (changed ? std::none_of(c.nodes.begin(), c.nodes.end(), [&](int n) { return (*changed)[n] != 0; })
                    : is_even(b, u, v, c)) {
          continue;
        }
        c.part = part_for(b, u, v, c);
        if (c.part > 0) {
          chosen.push_back(std::move(c));
        }
      }
    }
    return chosen;
  }

  std::vector<Vec3> to_bilinear(const std::vector<int>& nodes) const {
    std::vector<Vec3> away;
    const auto shift = [&](int u, int v) -> const Vec3& { return shifts_[nodes[u + line_ * v]].shift; };
    for (int v = 0; v < line_; ++v) {
      for (int u = 0; u < line_; ++u) {
        const double s = family_[u], t = family_[v];
        const Vec3 between = (1 - t) * ((1 - s) * shift(0, 0) + s * shift(p_, 0)) +
                             t * ((1 - s) * shift(0, p_) + s * shift(p_, p_));
        const bool corner = (u == 0 || u == p_) && (v == 0 || v == p_);
        away.push_back(corner ? Vec3(Vec3::Zero()) : Vec3(between - shift(u, v)));
      }
    }
    return away;
  }

  bool is_even(const Patch& b, int u, int v, const Choice& c) const {
    double largest = 0, height2 = std::numeric_limits<double>::infinity();
    for (const Vec3& a : c.away) {
      largest = std::max(largest, a.squaredNorm());
    }
    const int below = b.at_end ? b.wall() - p_ : p_;
    for (const int dv : {0, p_}) {
      for (const int du : {0, p_}) {
        const Vec3 up = mesh_.nodes[b.id(b.wall(), u + du, v + dv)] - mesh_.nodes[b.id(below, u + du, v + dv)];
        height2 = std::min(height2, up.squaredNorm());
      }
    }
    return largest < kEven * kEven * height2;
  }

  /// The least part that makes the elements behind the face good; 0 where nothing is won.
  double part_for(const Patch& b, int u, int v, const Choice& c) const {
    // the column of elements, once for each part; axes as in the block
    std::array<int, 3> size{line_, line_, line_}, stride{};
    size[b.d] = b.size[b.d];
    stride = {1, size[0], size[0] * size[1]};
    const int per_copy = size[0] * size[1] * size[2], layers = (b.size[b.d] - 1) / p_;
    std::vector<Vec3> nodes(static_cast<std::size_t>(kSteps + 1) * per_copy);
    for (int at = 0; at < line_ * line_; ++at) {
      const int du = at % line_, dv = at / line_;
      const std::vector<double> along = follow(b, u + du, v + dv);
      for (int i = 0; i < size[b.d]; ++i) {
        const Vec3& x = mesh_.nodes[b.id(i, u + du, v + dv)];
        for (int step = 0; step <= kSteps; ++step) {
          const double part = std::max(part_[c.nodes[at]], static_cast<double>(step) / kSteps);
          nodes[static_cast<std::size_t>(step) * per_copy + i * stride[b.d] + du * stride[b.d1] + dv * stride[b.d2]] =
              x + along[i] * part * c.away[at];
        }
      }
    }
    std::vector<int> elements;
    for (int step = 0; step <= kSteps; ++step) {
      for (int layer = 0; layer < layers; ++layer) {
        for (int at = 0; at < line_ * line_ * line_; ++at) {
          std::array<int, 3> ijk{at % line_, at / line_ % line_, at / line_ / line_};
          ijk[b.d] += layer * p_;
          elements.push_back(step * per_copy + ijk[0] + stride[1] * ijk[1] + stride[2] * ijk[2]);
        }
      }
    }
    Run serial;
    serial.threads = 1;
    const std::vector<double> quality = scaled_jacobian(p_, mesh_.family, nodes, elements, serial);
    std::array<double, kSteps + 1> least{};
    for (int step = 0; step <= kSteps; ++step) {
      const auto first = quality.begin() + static_cast<std::ptrdiff_t>(step) * layers;
      least[step] = *std::min_element(first, first + layers);
    }
    const double best = *std::max_element(least.begin(), least.end());
    if (least[0] >= kWeakOnWall || best < least[0] + kWorthIt) {
      return 0;
    }
    int step = 0;
    while (least[step] < std::min(kWeakOnWall, best)) {
      ++step;
    }
    return static_cast<double>(step) / kSteps;
  }

  RelaxedWall move(const std::vector<int>& wall_face, const ImplicitSurface& surface) {
    RelaxedWall result;
    std::vector<char> done(shifts_.size(), 0);
    if (std::none_of(part_.begin(), part_.end(), [](double part) { return part > 0; })) {
      return result;
    }
    for (std::size_t block = 0; block < wall_face.size(); ++block) {
      if (wall_face[block] < 0) {
        continue;
      }
      const Patch b = patch(static_cast<int>(block), wall_face[block]);
      for (int v = 0; v < b.size[b.d2]; ++v) {
        for (int u = 0; u < b.size[b.d1]; ++u) {
          const int n = index(b.id(b.wall(), u, v));
          if (part_[n] == 0 || done[n]) {
            continue;
          }
          done[n] = 1;
          const Vec3 by = part_[n] * away_[n];
          const std::vector<double> along = follow(b, u, v);
          for (int i = 0; i < b.size[b.d]; ++i) {
            mesh_.nodes[b.id(i, u, v)] += along[i] * by;
          }
          ++result.nodes;
          const Vec3& at = mesh_.nodes[b.id(b.wall(), u, v)];
          if (const double radii = by.norm() / surface.radius(at); radii > result.largest) {
            result.largest = radii;
            result.place = at;
          }
        }
      }
    }
    return result;
  }

  HexMesh& mesh_;
  const LatticeNumbering& numbering_;
  int p_, line_;
  std::vector<double> family_;
  std::vector<WallShift> shifts_;
  std::vector<Vec3> away_;    ///< [shifts]
  std::vector<double> part_;  ///< [shifts] of `away` that is gone
};

}  // namespace

RelaxedWall relax_wall(HexMesh& mesh, const LatticeNumbering& numbering, const std::vector<int>& wall_face,
                       std::vector<WallShift> shifts, const ImplicitSurface& surface, const Run& run) {
  return mesh.order > 1 ? WallRelaxer(mesh, numbering, std::move(shifts)).run(wall_face, surface, run) : RelaxedWall{};
}

}  // namespace vasohex
