#pragma once
/// \file Internal to blocks/: the blocks of a BlockProblem as polynomials of one degree, and their energy.

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "vasohex/blocks/energy_kernel.h"
#include "vasohex/blocks/optimise.h"
#include "vasohex/blocks/samples.h"
#include "vasohex/blocks/topology.h"
#include "vasohex/blocks/wall_model.h"
#include "vasohex/core/node_family.h"
#include "vasohex/core/reference_hex.h"

namespace vasohex {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

enum class NodeKind : char { free, wall, fixed };

/// Point u in [0,1]^3 of a hexahedron with straight edges.
inline Vec3 trilinear(const std::vector<Vec3>& vertices, const std::array<int, 8>& block,
                      const std::array<double, 3>& u) {
  Vec3 p = Vec3::Zero();
  for (int c = 0; c < 8; ++c) {
    double w = 1;
    for (int d = 0; d < 3; ++d) {
      w *= (c >> d) & 1 ? u[d] : 1 - u[d];
    }
    p += w * vertices[block[c]];
  }
  return p;
}

/// Weight of the mean square distance of the wall to the surface, over the block length. Decisive: without it
/// polynomial faces drift and projection lands on the wrong vessel.
inline constexpr double kWallWeight = 72;

/// What the energy is made of; see kernel::DistortionInput.
struct EnergyTerms {
  double shape_weight = 1;
  double jacobian_weight = 0;
  double wall_weight = kWallWeight;
  double epsilon = 1e-3;
  double jacobian_goal = 0.5;
  int power = 8;
  std::vector<Samples> samples;
};

struct Energy {
  double value = 0;
  double min_jacobian = std::numeric_limits<double>::infinity();
  double min_det = std::numeric_limits<double>::infinity();
  double gap_cost = 8;  ///< 2 where the wall is projected: the projection changes a little with the gap
  double wall_gap = 0;  ///< largest distance of the wall to the surface at a sample, over the block's length

  /// What is left of the least scaled Jacobian once the wall of a mesh is projected, roughly: blocks gain Jacobians
  /// by leaving the surface, and meshes lose them again.
  double quality() const { return min_jacobian - gap_cost * wall_gap; }
};

/// Between the wall nodes of blocks a mesh has nodes of its own on the surface: as seen by polynomials of this
/// degree.
inline constexpr int kProjectionDegree = 12;

/// Topology, nodes, wall: everything the energy needs. The problem and the topology must outlive it.
class PolynomialBlocks {
 public:
  PolynomialBlocks(const BlockProblem& problem, const BlockTopology& topology, int degree);

  Points x;  ///< [nodes][3] control points

  int degree() const { return degree_; }
  int block_count() const { return static_cast<int>(topology_->blocks.size()); }
  int id(int block, int lattice) const {
    const int n = degree_ + 1;
    return ids_[static_cast<std::size_t>(block) * n * n * n + lattice];
  }
  const std::vector<double>& nodes_1d() const { return nodes_1d_; }
  const std::vector<NodeKind>& kinds() const { return kinds_; }
  const std::vector<std::array<double, 3>>& lengths() const { return lengths_; }
  double mean_length() const { return mean_length_; }

  /// Takes over control points [blocks][(degree + 1)^3].
  void adopt_nodes(const std::vector<Vec3>& nodes);

  /// Trilinear blocks, sections placed, wall nodes shot from the vessels' axes, the shift carried inside.
  void place();

  /// Puts the nodes of the sections where their cross-sections are; those that slide too if `sliding`.
  void place_sections(bool sliding);

  /// Whether the wall is taken to face where it did, on its own side of a gap between vessels; from the start it is.
  void keep_sides(bool keep) { keeps_sides_ = keep; }

  /// Wall nodes onto the wall's model by Newton's method, in the plane of a section that they slide in; remembers the
  /// normals there.
  void retract(Points& y);

  /// Wall nodes onto the surface itself.
  void land();

  /// Spreads how far wall nodes moved from `before` linearly along the blocks that end on the wall.
  void carry_inside(const Points& before);

  /// Calls f(block, direction, lattice point, node there, next node along the direction) for every lattice edge.
  template <class F>
  void for_lattice_edges(F&& f) const {
    const int n = degree_ + 1;
    const std::array<int, 3> stride{1, n, n * n};
    for (int b = 0; b < block_count(); ++b) {
      for (int at = 0; at < n * n * n; ++at) {
        const std::array<int, 3> ijk{at % n, at / n % n, at / n / n};
        for (int d = 0; d < 3; ++d) {
          if (ijk[d] < degree_) {
            f(b, d, ijk, id(b, at), id(b, at + stride[d]));
          }
        }
      }
    }
  }

  /// Target lengths: the mean length of a block's control edges per direction.
  void update_lengths();

  /// Takes over the target lengths of the same blocks at another degree.
  void adopt_lengths(const PolynomialBlocks& other);

  /// Energy at y, whose wall nodes have just been retracted; the gradient lies in the wall and leaves sections alone.
  Energy energy(const Points& y, const EnergyTerms& terms, Points* gradient);

  /// Removes what would move fixed nodes or lead off the wall.
  void make_tangential(Points& v) const;

  const Points& normals() const { return normals_; }
  void set_normals(const Points& n) { normals_ = n; }

  /// Laplace sweeps: every free or wall node halfway to the mean of its neighbours on the lattice (of wall nodes: on
  /// the wall and sections; of those that slide: in their plane).
  void smooth(int sweeps);

  /// The same blocks with a higher degree: sections and wall exact again.
  PolynomialBlocks elevated(int degree) const;

  std::vector<Vec3> block_nodes() const;

  /// From the blocks' wall to the surface at the Gauss-Lobatto nodes of degree kProjectionDegree:
  /// [wall faces][kProjectionDegree + 1][kProjectionDegree + 1].
  std::vector<Vec3> wall_shifts() const;

  /// Samples of a mesh whose wall nodes lie on the surface, their shifts carried linearly through the blocks that end
  /// there. `tables`: from nodes on [0, 1], those of the blocks and those of the shifts, to tables at the same
  /// samples.
  template <class MakeTables>
  Samples projected(const std::vector<Vec3>& shifts, const MakeTables& tables) const {
    SampleTables of_blocks = tables(nodes_1d_);
    std::vector<double> added =
        projection(shifts, of_blocks, tables(family_nodes(NodeFamily::gauss_lobatto, kProjectionDegree)));
    return {std::move(of_blocks), std::move(added), 0};
  }

 private:
  /// Of the plane that a node slides in; zero if it does not.
  Vec3 plane_normal(int node) const;
  /// Of the wall's model, which faces `outward` where sides are kept.
  double wall_value(std::size_t point, const Vec3& x, const Vec3& outward, Vec3& gradient);
  struct WallFace {
    int block, face;
  };

  template <class F>
  void for_face(int face, F&& f) const {
    const std::array<int, 3> n{degree_ + 1, degree_ + 1, degree_ + 1};
    for (int b = 0; b <= degree_; ++b) {
      for (int a = 0; a <= degree_; ++a) {
        f(a, b, hex_face_point(face, a, b, n));
      }
    }
  }

  /// What shifts of the wall add to dx/du at samples, as kernel::DistortionInput::added. `fine`: the samples from the
  /// nodes of the shifts.
  std::vector<double> projection(const std::vector<Vec3>& shifts, const SampleTables& tables,
                                 const SampleTables& fine) const;

  /// kWallWeight * mean over samples between the wall nodes of (distance to the surface / block length)^2; `gap` is
  /// the largest of these distances over the length.
  double wall_distance(const Points& y, double wall_weight, Points* gradient, double& gap);

  const BlockProblem* problem_;
  const BlockTopology* topology_;
  int degree_;
  std::vector<double> nodes_1d_;
  std::vector<int> ids_;  ///< [blocks][(degree + 1)^3]
  std::vector<NodeKind> kinds_;
  std::vector<WallFace> wall_faces_;
  std::vector<int> wall_nodes_;
  std::vector<int> plane_;  ///< [nodes] the section in whose plane the node slides; -1: none
  WallModel wall_;          ///< of the wall nodes, then of the samples between them
  Points normals_;
  bool keeps_sides_ = true;
  std::vector<double> wall_values_;  ///< [degree][degree + 1]: between the nodes
  std::vector<std::array<double, 3>> lengths_;
  std::vector<double> inverse_lengths_;
  double mean_length_ = 1;
};

}  // namespace vasohex
