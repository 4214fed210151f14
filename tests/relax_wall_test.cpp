// Walls of a slab whose nodes were shifted so that elements fold.

#include "vasohex/mesh/relax_wall.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "vasohex/quality/quality_report.h"

namespace vasohex {
namespace {

/// Only tells a radius.
class UnitRadius final : public ImplicitSurface {
 public:
  double value(const Vec3& x) const override { return x.z(); }
  double value(const Vec3& x, Vec3& gradient) const override {
    gradient = Vec3::UnitZ();
    return x.z();
  }
  double radius(const Vec3&) const override { return 1; }
};

constexpr int kWide = 12, kHigh = 2;

/// Cubes of edge 1, kWide x kWide x kHigh, in two blocks that meet at x = kWide / 2; wall above, or below.
struct Slab {
  BlockTopology topology;
  std::unique_ptr<LatticeNumbering> numbering;
  std::vector<int> wall_face;
  HexMesh mesh;
  std::vector<WallShift> shifts;

  /// `bend`: how the wall of the blocks themselves differs from a plane.
  Slab(
      int order, bool wall_above, const std::function<Vec3(const Vec3&)>& shift,
      const std::function<Vec3(const Vec3&)>& bend = [](const Vec3&) -> Vec3 { return Vec3::Zero(); }) {
    const auto vertex = [](int x, int y, int z) { return x + 3 * (y + 2 * z); };
    std::vector<std::array<int, 8>> blocks(2);
    for (int b = 0; b < 2; ++b) {
      for (int c = 0; c < 8; ++c) {
        blocks[b][c] = vertex(b + (c & 1), c >> 1 & 1, c >> 2);
      }
    }
    topology = build_topology(12, blocks);
    std::vector<int> intervals(topology.edges.size());
    for (int b = 0; b < 2; ++b) {
      for (int e = 0; e < 12; ++e) {
        const int count = e / 4 == 0 ? kWide / 2 : e / 4 == 1 ? kWide : kHigh;
        intervals[topology.block_edges[b][e].edge] = order * count;
      }
    }
    numbering = std::make_unique<LatticeNumbering>(topology, intervals);
    wall_face = {wall_above ? 5 : 4, wall_above ? 5 : 4};
    mesh.order = order;
    mesh.surfaces = {"wall"};
    mesh.nodes.resize(numbering->node_count());
    auto fade = std::make_shared<std::vector<double>>();
    for (int i = 0; i <= kHigh * order; ++i) {
      fade->push_back(static_cast<double>(i) / (kHigh * order));
    }
    std::vector<char> has_shift(mesh.nodes.size(), 0);
    for (int b = 0; b < 2; ++b) {
      std::vector<int> ids;
      numbering->block_nodes(b, ids);
      const auto c = numbering->intervals(b);
      const auto id = [&](int i, int j, int k) { return ids[i + (c[0] + 1) * (j + (c[1] + 1) * k)]; };
      for (int k = 0; k <= c[2]; ++k) {
        for (int j = 0; j <= c[1]; ++j) {
          for (int i = 0; i <= c[0]; ++i) {
            const Vec3 x = Vec3(b * kWide / 2 * order + i, j, k) / order;
            const double part = wall_above ? x.z() / kHigh : 1 - x.z() / kHigh;
            mesh.nodes[id(i, j, k)] = x + part * (bend(x) + shift(x));
            if (part == 1 && !has_shift[id(i, j, k)]) {
              has_shift[id(i, j, k)] = 1;
              shifts.push_back({id(i, j, k), shift(x), fade});
            }
          }
        }
      }
      for (int k = 0; k < c[2]; k += order) {
        for (int j = 0; j < c[1]; j += order) {
          for (int i = 0; i < c[0]; i += order) {
            for (int at = 0; at < mesh.nodes_per_element(); ++at) {
              const int n = order + 1;
              mesh.elements.push_back(id(i + at % n, j + at / n % n, k + at / n / n));
            }
          }
        }
      }
    }
  }

  RelaxedWall relax(const Run& run = {}) {
    return relax_wall(mesh, *numbering, wall_face, shifts, UnitRadius(), run);
  }
};

/// Towards the middle, across the plane between the blocks: there, nodes pass each other.
Vec3 folding(const Vec3& x) {
  const Vec3 d(x.x() - kWide / 2.0, x.y() - kWide / 2.0, 0);
  return -2 * d.x() * std::exp(-d.squaredNorm() / 3) * Vec3::UnitX();
}

TEST(RelaxWall, UnfoldsElementsWhoseCornersPassEachOther) {
  for (const int order : {1, 2, 3}) {
    for (const bool above : {false, true}) {
      SCOPED_TRACE(testing::Message() << "order " << order << (above ? ", above" : ", below"));
      Slab slab(order, above, folding);
      const HexMesh before = slab.mesh;
      const QualityReport folded = measure_quality(before);
      EXPECT_LT(folded.certified, before.element_count());
      const RelaxedWall relaxed = slab.relax();
      const QualityReport quality = measure_quality(slab.mesh);
      EXPECT_EQ(quality.certified, slab.mesh.element_count());
      EXPECT_GE(quality.scaled_jacobian.min, kFoldedOnWall);
      EXPECT_GE(quality.scaled_jacobian_linear.min, kFoldedOnWall);
      // no node is further off than its shift was, and only those near the fold moved
      double largest = 0;
      int moved = 0;
      const Slab flat(order, above, [](const Vec3&) { return Vec3(Vec3::Zero()); });
      for (std::size_t i = 0; i < before.nodes.size(); ++i) {
        const Vec3& x = flat.mesh.nodes[i];
        const double by = (slab.mesh.nodes[i] - before.nodes[i]).norm();
        moved += by > 0 && x.z() == (above ? kHigh : 0);
        largest = std::max(largest, by);
        EXPECT_LE(by, folding(x).norm() + 1e-12);
        EXPECT_TRUE(by == 0 || (x - Vec3(kWide, kWide, 2 * x.z()) / 2).norm() < 4) << x.transpose();
      }
      EXPECT_EQ(relaxed.nodes, moved);
      EXPECT_NEAR(relaxed.largest, largest, 1e-12);
      vasohex::Run three;
      three.threads = 3;
      Slab again(order, above, folding);
      again.relax(three);
      EXPECT_EQ(again.mesh.nodes, slab.mesh.nodes);
    }
  }
}

/// A spike thinner than an element, leaning over: at one corner of elements, away from block edges.
Vec3 spike(const Vec3& x) {
  const Vec3 d(x.x() - 3, x.y() - 6, 0);
  return std::exp(-4 * d.squaredNorm()) * Vec3(1.1, 0.3, 0);
}

TEST(RelaxWall, CentresNodesWhereTheParameterOfAnEdgeAlmostStops) {
  const auto none = [](const Vec3&) -> Vec3 { return Vec3::Zero(); };
  // the middle node of one element's edges lies at .8 of them: beyond .75 the element folds
  const auto late = [](const Vec3& x) -> Vec3 {
    return std::abs(x.x() - (kWide / 2 + 1.5)) < 0.1 ? Vec3(0.3 * Vec3::UnitX()) : Vec3(Vec3::Zero());
  };
  for (const bool above : {false, true}) {
    Slab slab(2, above, none, late);
    const HexMesh before = slab.mesh;
    EXPECT_LT(measure_quality(before).certified, before.element_count());
    const RelaxedWall relaxed = slab.relax();
    EXPECT_GT(relaxed.nodes, 0);
    EXPECT_NEAR(relaxed.largest, 0.3, 1e-9);
    EXPECT_GT(measure_quality(slab.mesh).scaled_jacobian.min, 0.9);
    for (std::size_t i = 0; i < before.nodes.size(); ++i) {
      EXPECT_EQ(before.nodes[i].z(), slab.mesh.nodes[i].z());
    }
  }
}

TEST(RelaxWall, FlattensSpikesOfTheBlocksThatFoldElements) {
  // of the first order: elements of the others fold, or not, with all of the spike's shape
  const auto small = [](const Vec3& x) -> Vec3 { return 0.1 * spike(x); };
  Slab slab(1, true, small, spike);
  const QualityReport folded = measure_quality(slab.mesh);
  ASSERT_LT(folded.scaled_jacobian.min, kFoldedOnWall);
  Slab without(
      1, true, [](const Vec3&) -> Vec3 { return Vec3::Zero(); }, spike);
  ASSERT_LT(measure_quality(without.mesh).scaled_jacobian.min, kFoldedOnWall) << "the shifts are not what folds";
  const RelaxedWall relaxed = slab.relax();
  EXPECT_GE(measure_quality(slab.mesh).scaled_jacobian.min, kFoldedOnWall);
  EXPECT_LE(relaxed.largest, 1.2 * spike({3, 6, 0}).norm());
  EXPECT_LE(relaxed.nodes, 16) << "the corners of the elements around the spike";
}

TEST(RelaxWall, LeavesElementsAloneThatAreOnlySheared) {
  for (const int order : {1, 3}) {
    Slab slab(order, true, [](const Vec3& x) { return Vec3(0.8, 0.3, 0.2 + 0.1 * std::sin(x.x())); });
    const std::vector<Vec3> before = slab.mesh.nodes;
    EXPECT_EQ(slab.relax().nodes, 0);
    EXPECT_EQ(slab.mesh.nodes, before);
  }
}

}  // namespace
}  // namespace vasohex
