#include "vasohex/mesh/relax_wall.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "vasohex/core/node_family.h"
#include "vasohex/core/parallel.h"
#include "vasohex/quality/scaled_jacobian.h"

namespace vasohex {
namespace {

constexpr int kPasses = 5;  // a node is moved by the elements around it, and these by their neighbours
constexpr int kSweeps = 4;  // of smoothing
constexpr int kSteps = 10;  // of relaxation: from the shifts to bilinear ones, from these to none, to a smooth wall
static_assert(kRelaxReach == 2 * kPasses + kSweeps);
constexpr double kEven = 0.05;     // shifts that differ by less than this part of an element's height
constexpr double kUneven = 0.1;    // part of its edge that a node is off its even place
constexpr double kWorthIt = 0.05;  // gain of the scaled Jacobian

/// Shifts are relaxed in three stages: level 0 to 1 leads them to the bilinear ones, 1 to 2 these to nothing, 2 to 3
/// to a wall smoother than that of the blocks. Besides, nodes may be centred: moved along the wall to even parts of
/// their edges.
class WallRelaxer {
 public:
  WallRelaxer(HexMesh& mesh, const LatticeNumbering& numbering, const std::vector<int>& wall_face,
              std::vector<WallShift> shifts, double centred_below)
      : mesh_(mesh),
        centred_below_(centred_below),
        numbering_(numbering),
        wall_face_(wall_face),
        p_(mesh.order),
        line_(mesh.order + 1),
        family_(family_nodes(mesh.family, mesh.order)),
        shifts_(std::move(shifts)) {
    shift_of_.assign(mesh.nodes.size(), -1);
    for (std::size_t i = 0; i < shifts_.size(); ++i) {
      shift_of_[shifts_[i].node] = static_cast<int>(i);
    }
    state_.assign(shifts_.size(), {});
    bilinear_.assign(shifts_.size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
    for_faces([&](const Patch& b, int u, int v) { add_bilinear(face_nodes(b, u, v)); });
    centring_.assign(shifts_.size(), Vec3::Zero());
    if (p_ > 1) {
      for_faces([&](const Patch& b, int u, int v) { add_centring(face_nodes(b, u, v)); });
    }
  }

  RelaxedWall run(const ImplicitSurface& surface, const Run& run) {
    std::vector<char> changed(shifts_.size(), 1);
    bool any_changed = true;
    for (int pass = 0; pass < kPasses && any_changed; ++pass) {
      std::vector<std::vector<Choice>> chosen(wall_face_.size());
      parallel_for(run, wall_face_.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          if (wall_face_[b] >= 0) {
            chosen[b] = choose(static_cast<int>(b), changed);
          }
        }
      });
      changed.assign(shifts_.size(), 0);
      any_changed = false;
      for (const std::vector<Choice>& of_block : chosen) {
        for (const Choice& c : of_block) {
          for (const int n : c.nodes) {
            const State state = further(state_[n], c.state);
            if (state.level > state_[n].level || state.centred > state_[n].centred) {
              state_[n] = state;
              changed[n] = 1;
              any_changed = true;
            }
          }
        }
      }
    }
    return move(surface);
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
  /// How far a node is relaxed.
  struct State {
    double level = 0;
    bool centred = false;
  };
  static State further(const State& a, const State& b) {
    return {std::max(a.level, b.level), a.centred || b.centred};
  }
  /// How far the nodes of one face are to be.
  struct Choice {
    State state;
    std::vector<int> nodes;  ///< indices of shifts
  };

  /// Least scaled Jacobians of some elements.
  struct Quality {
    double curved = 1, straight = 1;
    double least() const { return std::min(curved, straight); }
  };

  Patch patch(int block) const {
    Patch out;
    const int face = wall_face_[block];
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

  /// Calls visit(patch, u, v) with the first node of each element's face on the wall.
  template <class Visit>
  void for_faces(Visit&& visit) const {
    for (int block = 0; block < static_cast<int>(wall_face_.size()); ++block) {
      if (wall_face_[block] >= 0) {
        for_faces_of(patch(block), visit);
      }
    }
  }
  template <class Visit>
  void for_faces_of(const Patch& b, Visit&& visit) const {
    for (int v = 0; v + p_ < b.size[b.d2]; v += p_) {
      for (int u = 0; u + p_ < b.size[b.d1]; u += p_) {
        visit(b, u, v);
      }
    }
  }

  std::vector<int> face_nodes(const Patch& b, int u, int v) const {
    std::vector<int> nodes;
    for (int at = 0; at < line_ * line_; ++at) {
      nodes.push_back(shift_of_[b.id(b.wall(), u + at % line_, v + at / line_)]);
    }
    return nodes;
  }

  /// Between what of(shift) is at the corners of a face.
  template <class Of>
  Vec3 bilinear_at(const std::vector<int>& nodes, int u, int v, const Of& of) const {
    const double s = family_[u], t = family_[v];
    return (1 - t) * ((1 - s) * of(nodes[0]) + s * of(nodes[p_])) +
           t * ((1 - s) * of(nodes[line_ * p_]) + s * of(nodes[line_ * line_ - 1]));
  }

  /// Faces that share an edge agree on it: there it is a matter of the edge's ends. The first one says.
  void add_bilinear(const std::vector<int>& nodes) {
    const auto shift = [&](int n) -> const Vec3& { return shifts_[n].shift; };
    for (int v = 0; v < line_; ++v) {
      for (int u = 0; u < line_; ++u) {
        Vec3& out = bilinear_[nodes[u + line_ * v]];
        if (out.allFinite()) {
          continue;
        }
        const bool corner = (u == 0 || u == p_) && (v == 0 || v == p_);
        out = corner ? shift(nodes[u + line_ * v]) : bilinear_at(nodes, u, v, shift);
      }
    }
  }

  /// Along the edges of a face, to where their nodes lie evenly: where the parameter of a block's edge almost stops,
  /// an element of low order folds. Within the face, in between.
  void add_centring(const std::vector<int>& nodes) {
    const auto at = [&](int n) -> Vec3 { return mesh_.nodes[shifts_[n].node] - shifts_[n].shift + bilinear_[n]; };
    const auto along_edge = [&](int first, int step) {
      const Vec3 from = at(nodes[first]), chord = at(nodes[first + step * p_]) - from;
      for (int i = 1; i < p_; ++i) {
        const int n = nodes[first + step * i];
        const double off = family_[i] - (at(n) - from).dot(chord) / chord.squaredNorm();
        centring_[n] = std::abs(off) > kUneven ? Vec3(off * chord) : Vec3::Zero();
      }
    };
    along_edge(0, 1);
    along_edge(line_ * p_, 1);
    along_edge(0, line_);
    along_edge(p_, line_);
    for (int v = 1; v < p_; ++v) {
      for (int u = 1; u < p_; ++u) {
        const auto on = [&](int i, int j) -> const Vec3& { return centring_[nodes[i + line_ * j]]; };
        const double s = family_[u], t = family_[v];
        centring_[nodes[u + line_ * v]] = (1 - t) * on(u, 0) + t * on(u, p_) + (1 - s) * on(0, v) + s * on(p_, v);
      }
    }
  }

  /// From the blocks' wall to a smoother one: Laplace sweeps of the elements' corners, bilinear in between. Rims
  /// stay.
  std::vector<Vec3> smoothing() const {
    std::map<std::array<int, 2>, int> faces_of_edge;
    for_faces([&](const Patch& b, int u, int v) {
      const std::vector<int> nodes = face_nodes(b, u, v);
      const std::array<int, 4> ring{nodes[0], nodes[p_], nodes[line_ * line_ - 1], nodes[line_ * p_]};
      for (int i = 0; i < 4; ++i) {
        ++faces_of_edge[{std::min(ring[i], ring[(i + 1) % 4]), std::max(ring[i], ring[(i + 1) % 4])}];
      }
    });
    std::vector<char> fixed(shifts_.size(), 0);
    std::vector<int> neighbours(shifts_.size(), 0);
    for (const auto& [edge, faces] : faces_of_edge) {
      for (const int n : edge) {
        fixed[n] |= faces == 1;
        ++neighbours[n];
      }
    }
    std::vector<Vec3> at;
    for (const WallShift& s : shifts_) {
      at.push_back(mesh_.nodes[s.node] - s.shift);
    }
    std::vector<Vec3> smoothed = at;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      std::vector<Vec3> sum(shifts_.size(), Vec3::Zero());
      for (const auto& [edge, faces] : faces_of_edge) {
        sum[edge[0]] += smoothed[edge[1]];
        sum[edge[1]] += smoothed[edge[0]];
      }
      for (std::size_t n = 0; n < at.size(); ++n) {
        if (neighbours[n] > 0 && !fixed[n]) {
          smoothed[n] = 0.5 * (smoothed[n] + sum[n] / neighbours[n]);
        }
      }
    }
    const auto moved = [&](int n) -> Vec3 { return smoothed[n] - at[n]; };
    std::vector<Vec3> all(shifts_.size(), Vec3::Zero());
    for_faces([&](const Patch& b, int u, int v) {
      const std::vector<int> nodes = face_nodes(b, u, v);
      for (int i = 0; i < line_ * line_; ++i) {
        all[nodes[i]] = bilinear_at(nodes, i % line_, i / line_, moved);
      }
    });
    return all;
  }

  /// What is added to a wall node.
  Vec3 move_of(int n, const State& state) const {
    const Vec3 &shift = shifts_[n].shift, &bilinear = bilinear_[n];
    const Vec3 along = state.centred ? centring_[n] : Vec3(Vec3::Zero());
    if (state.level <= 1) {
      return state.level * (bilinear - shift) + along;
    }
    if (state.level <= 2) {
      return (2 - state.level) * bilinear - shift + along;
    }
    std::call_once(smoothed_, [&] { smoothing_ = smoothing(); });  // few meshes need it
    return (state.level - 2) * smoothing_[n] - shift + along;
  }

  /// Part of a wall node's move that node i of its line follows with.
  double follow(const Patch& b, int n, int i) const { return (*shifts_[n].fade)[b.at_end ? i : b.size[b.d] - 1 - i]; }

  std::vector<Choice> choose(int block, const std::vector<char>& changed) const {
    std::vector<Choice> chosen;
    for_faces_of(patch(block), [&](const Patch& b, int u, int v) {
      Choice c{{}, face_nodes(b, u, v)};
      if (std::any_of(c.nodes.begin(), c.nodes.end(), [&](int n) { return changed[n] != 0; }) &&
          (!is_even(b, u, v, c.nodes) || is_uneven(c.nodes))) {
        c.state = state_for(b, u, v, c.nodes);
        if (c.state.level > 0 || c.state.centred) {
          chosen.push_back(std::move(c));
        }
      }
    });
    return chosen;
  }

  /// The nodes of a face are moved alike: its elements keep their shape.
  bool is_even(const Patch& b, int u, int v, const std::vector<int>& nodes) const {
    double largest = 0, height2 = std::numeric_limits<double>::infinity();
    const auto moved = [&](int n) -> Vec3 { return shifts_[n].shift + move_of(n, state_[n]); };
    for (const int n : nodes) {
      largest = std::max(largest, (moved(n) - moved(nodes[0])).squaredNorm());
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

  /// Nodes of the face's edges are far from their even parts.
  bool is_uneven(const std::vector<int>& nodes) const {
    return std::any_of(nodes.begin(), nodes.end(), [&](int n) { return !centring_[n].isZero(0); });
  }

  /// Whether harms(before, after) holds for the qualities of elements behind a face around one, with its nodes at
  /// `state`.
  template <class Harms>
  bool harms_others(const Patch& b, int u, int v, const std::vector<int>& nodes, const State& state,
                    const Harms& harms) const {
    const auto raised = [&](int n) {
      return std::find(nodes.begin(), nodes.end(), n) != nodes.end() ? further(state, state_[n]) : state_[n];
    };
    for (int v1 = std::max(0, v - p_); v1 <= v + p_ && v1 + p_ < b.size[b.d2]; v1 += p_) {
      for (int u1 = std::max(0, u - p_); u1 <= u + p_ && u1 + p_ < b.size[b.d1]; u1 += p_) {
        const Column beside = column_of(b, u1, v1, face_nodes(b, u1, v1));
        if (harms(quality(beside, {}), quality_with(beside, raised))) {
          return true;
        }
      }
    }
    return false;
  }
  static bool folds(const Quality& before, const Quality& after) {
    return after.least() < std::min(0.0, before.least());
  }

  /// The least that makes the elements behind the face good; nothing where nothing is won.
  State state_for(const Patch& b, int u, int v, const std::vector<int>& nodes) const {
    const Column column = column_of(b, u, v, nodes);
    Quality now = quality(column, {});
    State state;
    if (now.curved < centred_below_ && is_uneven(nodes)) {
      const Quality then = quality(column, {0, true});
      if (then.curved > now.curved + kWorthIt && !harms_others(b, u, v, nodes, {0, true}, folds)) {
        state.centred = true;
        now = then;
      }
    }
    if (centred_below_ <= 0 && is_even(b, u, v, nodes)) {
      return state;  // its shifts are not what is wrong
    }
    if (now.curved < kWeakOnWall && p_ > 1) {
      double best = now.curved;
      for (int step = 1; step <= kSteps && best < kWeakOnWall; ++step) {
        const double at = static_cast<double>(step) / kSteps, then = quality(column, {at, state.centred}).curved;
        if (then >= std::min(kWeakOnWall, best + kWorthIt)) {
          state.level = at;
          best = then;
        }
      }
      now = state.level > 0 ? quality(column, state) : now;
    }
    const bool only_straight = now.curved >= kWeakOnWall;
    for (int step = 1; step <= 2 * kSteps && now.least() < kFoldedOnWall; ++step) {
      const State at{1 + static_cast<double>(step) / kSteps, state.centred};
      if (at.level > 2 && harms_others(b, u, v, nodes, at, folds)) {
        break;
      }
      const Quality then = quality(column, at);
      const double gain = then.least() - now.least();
      const auto weakens = [&](const Quality& before, const Quality& after) {
        return after.curved < std::min(kWeakOnWall, before.curved) - gain;
      };
      if (then.least() >= std::min(kFoldedOnWall, now.least() + kWorthIt) &&
          !(only_straight && harms_others(b, u, v, nodes, at, weakens))) {
        state = at;
        now = then;
      }
    }
    return state;
  }

  /// The elements between a face on the wall and the core; axes as in the block.
  struct Column {
    std::vector<Vec3> nodes;
    std::vector<double> follow;  ///< [nodes]
    std::vector<int> wall;       ///< [nodes] index of the shift of its line
    std::vector<int> elements;
  };

  Column column_of(const Patch& b, int u, int v, const std::vector<int>& nodes) const {
    std::array<int, 3> size{line_, line_, line_};
    size[b.d] = b.size[b.d];
    const std::array<int, 3> stride{1, size[0], size[0] * size[1]};
    Column column;
    const std::size_t count = static_cast<std::size_t>(size[0]) * size[1] * size[2];
    column.nodes.resize(count);
    column.follow.resize(count);
    column.wall.resize(count);
    for (int at = 0; at < line_ * line_; ++at) {
      const int du = at % line_, dv = at / line_;
      for (int i = 0; i < size[b.d]; ++i) {
        const int k = i * stride[b.d] + du * stride[b.d1] + dv * stride[b.d2];
        column.nodes[k] = mesh_.nodes[b.id(i, u + du, v + dv)];
        column.follow[k] = follow(b, nodes[at], i);
        column.wall[k] = nodes[at];
      }
    }
    for (int layer = 0; layer + p_ < size[b.d]; layer += p_) {
      for (int at = 0; at < line_ * line_ * line_; ++at) {
        std::array<int, 3> ijk{at % line_, at / line_ % line_, at / line_ / line_};
        ijk[b.d] += layer;
        column.elements.push_back(ijk[0] + stride[1] * ijk[1] + stride[2] * ijk[2]);
      }
    }
    return column;
  }

  /// Of the worst element of a column whose wall nodes are relaxed at least so far.
  Quality quality(const Column& column, const State& state) const {
    return quality_with(column, [&](int n) { return further(state, state_[n]); });
  }
  template <class StateOf>
  Quality quality_with(const Column& column, const StateOf& state_of) const {
    std::vector<Vec3> nodes = column.nodes;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const int n = column.wall[k];
      nodes[k] += column.follow[k] * move_of(n, state_of(n));
    }
    Run serial;
    serial.threads = 1;
    const auto least = [](const std::vector<double>& all) { return *std::min_element(all.begin(), all.end()); };
    return {least(scaled_jacobian(p_, mesh_.family, nodes, column.elements, serial)),
            least(scaled_jacobian_linear(p_, nodes, column.elements, serial))};
  }

  RelaxedWall move(const ImplicitSurface& surface) {
    RelaxedWall result;
    std::vector<char> done(shifts_.size(), 0);
    if (std::none_of(state_.begin(), state_.end(), [](const State& s) { return s.level > 0 || s.centred; })) {
      return result;
    }
    for (std::size_t block = 0; block < wall_face_.size(); ++block) {
      if (wall_face_[block] < 0) {
        continue;
      }
      const Patch b = patch(static_cast<int>(block));
      for (int v = 0; v < b.size[b.d2]; ++v) {
        for (int u = 0; u < b.size[b.d1]; ++u) {
          const int n = shift_of_[b.id(b.wall(), u, v)];
          const Vec3 by = move_of(n, state_[n]);
          if (by.isZero(0) || done[n]) {
            continue;
          }
          done[n] = 1;
          for (int i = 0; i < b.size[b.d]; ++i) {
            mesh_.nodes[b.id(i, u, v)] += follow(b, n, i) * by;
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
  double centred_below_;  ///< scaled Jacobian of elements whose nodes may be centred
  const LatticeNumbering& numbering_;
  const std::vector<int>& wall_face_;
  int p_, line_;
  std::vector<double> family_;
  std::vector<WallShift> shifts_;
  std::vector<int> shift_of_;   ///< [nodes] index of the shift of a wall node, -1 of others
  std::vector<Vec3> bilinear_;  ///< [shifts] between those of the corners of their faces
  std::vector<Vec3> centring_;  ///< [shifts] to even parts of the edges of their faces
  std::vector<State> state_;    ///< [shifts]
  mutable std::once_flag smoothed_;
  mutable std::vector<Vec3> smoothing_;  ///< [shifts] from the blocks' wall to a smoother one, once it is asked for
};

}  // namespace

RelaxedWall relax_wall(HexMesh& mesh, const LatticeNumbering& numbering, const std::vector<int>& wall_face,
                       std::vector<WallShift> shifts, const ImplicitSurface& surface, const Run& run) {
  // blocks of round vessels stay what grids refined from them in process are, too, unless they fold
  const double centred_below = surface.is_round() ? 0 : kWeakOnWall;
  return WallRelaxer(mesh, numbering, wall_face, std::move(shifts), centred_below).run(surface, run);
}

}  // namespace vasohex
