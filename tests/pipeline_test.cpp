// From skeletons to meshes: properties that hold for every shape and every order.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numbers>

#include "gallery.h"
#include "measures.h"
#include "mesh_properties.h"
#include "vasohex/failed_places.h"
#include "vasohex/mesh/layer_heights.h"
#include "vasohex/quality/quality_report.h"
#include "vasohex/skeleton/read_skeleton.h"
#include "vasohex/vasohex.h"

namespace vasohex {
namespace {

SkeletonMeshOptions with(int order, int elements, NodeFamily family = NodeFamily::equispaced) {
  SkeletonMeshOptions options;
  options.mesh = {order, family};
  options.grading.elements = elements;
  return options;
}

class Gallery : public testing::TestWithParam<int> {};

TEST_P(Gallery, IsValidAndConformingAtEveryOrder) {
  const gallery::Shape shape = gallery::shapes()[GetParam()];
  SCOPED_TRACE(shape.name);
  for (const int order : {1, 2, 3, 4}) {
    SCOPED_TRACE("order " + std::to_string(order));
    const SkeletonMesh m = mesh_skeleton(shape.skeleton, with(order, order == 1 ? 6 : 3));
    const HexMesh& mesh = m.result.mesh;
    EXPECT_EQ(mesh.order, order);
    const auto topology = properties::expect_conforming(mesh);
    EXPECT_EQ(topology.components, shape.components);
    EXPECT_EQ(topology.loops, shape.loops);
    ASSERT_EQ(static_cast<int>(mesh.surfaces.size()), 1 + shape.ends);
    EXPECT_EQ(mesh.surfaces[0], "wall");
    if (shape.ends > 0) {
      EXPECT_EQ(mesh.surfaces[1], "inlet");
    }
    for (int s = 1; s <= shape.ends; ++s) {
      const SectionFrame& end = m.blocks.ends[s - 1];
      EXPECT_LT(properties::distance_from_plane(mesh, s, end.origin, end.normal()), 1e-9 * end.radius);
    }
    EXPECT_EQ(m.result.unconverged, 0);
    EXPECT_LT(m.result.wall_residual_max, 1e-8);
    EXPECT_EQ(m.blocks.certified, static_cast<int>(m.blocks.blocks.size()));
    const QualityReport q = measure_quality(mesh);
    EXPECT_EQ(q.certified, mesh.element_count());
    EXPECT_GT(q.scaled_jacobian.min, 0.4);
    if (order == 1) {
      EXPECT_GT(q.scaled_jacobian_linear.min, 0.35);
      EXPECT_GT(q.scaled_jacobian_linear.mean, 0.93);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Gallery, testing::Range(0, static_cast<int>(gallery::shapes().size())),
                         [](const auto& info) {
                           std::string name = gallery::shapes()[info.param].name;
                           std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
                           return name;
                         });

TEST(RandomJunctions, AreCertified) {
  for (int arms = 3; arms <= 5; ++arms) {
    for (int seed = 0; seed < 6; ++seed) {
      SCOPED_TRACE(std::to_string(arms) + " arms, seed " + std::to_string(seed));
      const SkeletonMesh m = mesh_skeleton(gallery::random_star(arms, seed, 30), with(3, 2));
      const QualityReport q = measure_quality(m.result.mesh);
      EXPECT_EQ(q.certified, m.result.mesh.element_count());
      EXPECT_GT(q.scaled_jacobian.min, 0.4);
      EXPECT_EQ(properties::expect_conforming(m.result.mesh).loops, 0);
    }
  }
}

/// Six of eight arms in a half-sphere: trees of cubes two deep. Crotches so sharp that wall nodes must change sides.
TEST(ManyArms, AreCertified) {
  for (const int seed : {15, 27}) {
    SCOPED_TRACE(seed);
    const SkeletonMesh m = mesh_skeleton(gallery::random_star(8, seed, 30), with(3, 6));
    const QualityReport q = measure_quality(m.result.mesh);
    EXPECT_EQ(q.certified, m.result.mesh.element_count());
    EXPECT_EQ(m.blocks.certified, static_cast<int>(m.blocks.blocks.size()));
    EXPECT_GT(q.scaled_jacobian.min, 0.4);
  }
}

TEST(NearJunctions, AreCertified) {
  // arms of different junctions that leave their trunk side by side; a thin arm along a thick one
  for (const Skeleton& skeleton : {gallery::dumbbell(0.5, 0), gallery::dumbbell(0.5, 30), gallery::dumbbell(0.5, 45),
                                   gallery::forked_stub(0.6, 0), gallery::forked_stub(0.8, 0),
                                   gallery::fork(20, 1, 0.3, 80)}) {
    for (const int order : {1, 3}) {
      const SkeletonMesh m = mesh_skeleton(skeleton, with(order, 6));
      const QualityReport q = measure_quality(m.result.mesh);
      EXPECT_EQ(q.certified, m.result.mesh.element_count()) << "order " << order;
      EXPECT_EQ(m.result.unconverged, 0) << "order " << order;
    }
  }
}

TEST(RealVessels, AreCertifiedAtOrders1To3) {
  const char* data = std::getenv("VASOHEX_DATA");
  if (!data) {
    GTEST_SKIP() << "VASOHEX_DATA is not set: the folder of published skeletons";
  }
  std::vector<std::string> cases{"s01_aorta_iliac_vmr0110/aorta.contours.swc",
                                 "s01_aorta_iliac_vmr0110/demo.derived_skeleton.graph.json",
                                 "s03_ica_tree/example_centerline_ICA.swc",
                                 "s06_coronary_721A/721A_Centreline.graph.json",
                                 "s11_six_branch_junction/bifurcation_Y.axes.graph.json"};
  for (const int i : {1, 2, 12, 23, 50, 66}) {
    cases.push_back("s13_synthaorta/skeleton_" + std::to_string(i) + ".graph.json");
  }
  for (const std::string& name : cases) {
    SCOPED_TRACE(name);
    const Skeleton skeleton = read_skeleton(std::string(data) + "/" + name);
    for (const int order : {1, 2, 3}) {
      const SkeletonMesh m = mesh_skeleton(skeleton, with(order, order == 1 ? 6 : 3));
      const QualityReport q = measure_quality(m.result.mesh);
      EXPECT_EQ(q.certified, m.result.mesh.element_count()) << "order " << order;
      EXPECT_EQ(m.result.unconverged, 0);
      EXPECT_GT(q.scaled_jacobian.min, order == 1 ? 0.35 : 0.4) << "order " << order;
      if (order == 1) {
        EXPECT_GT(q.scaled_jacobian_linear.mean, 0.93);
      }
    }
  }
}

/// Below the blocks' degree their last stage is for the mesh asked for.
TEST(Mesh, OfLowOrderIsBetterThanOneOfBlocksForAnyOrder) {
  struct Asked {
    const char* name;
    Skeleton skeleton;
    int order, elements;
    double least;
  };
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY();
  const Skeleton y120 =
      gallery::star({gallery::spherical(0, 0), gallery::spherical(120, 0), gallery::spherical(240, 0)}, {1, 1, 1}, 6);
  const Skeleton tee = gallery::star({x, -x, y}, {1, 1, 1}, 6);
  for (const Asked& asked : {Asked{"Y 120", y120, 1, 6, 0.81}, Asked{"T", tee, 1, 6, 0.81}, Asked{"T", tee, 2, 2, 0.7},
                             Asked{"star", gallery::random_star(4, 2, 30), 1, 6, 0.7},
                             Asked{"star", gallery::random_star(4, 2, 30), 2, 2, 0.6},
                             Asked{"star of 5", gallery::random_star(5, 2, 30), 2, 3, 0.5},
                             Asked{"star of 5", gallery::random_star(5, 2, 30), 3, 1, 0.6}}) {
    SCOPED_TRACE(std::string(asked.name) + " order " + std::to_string(asked.order));
    const SkeletonMeshOptions fitted = with(asked.order, asked.elements);
    SkeletonMeshOptions plain = fitted;
    plain.blocks.mesh.order = kBlockDegree;
    const SkeletonMesh m = mesh_skeleton(asked.skeleton, fitted);
    const double before = measure_quality(mesh_skeleton(asked.skeleton, plain).result.mesh).scaled_jacobian.min;
    const QualityReport q = measure_quality(m.result.mesh);
    EXPECT_GE(q.scaled_jacobian.min, before);
    EXPECT_GT(q.scaled_jacobian.min, asked.least);
    EXPECT_EQ(q.certified, m.result.mesh.element_count());
    EXPECT_EQ(m.blocks.certified, static_cast<int>(m.blocks.blocks.size()));
    if (asked.order == 1) {
      EXPECT_NEAR(m.blocks.junctions.at(0).min_jacobian, q.scaled_jacobian.min, 0.02);
    }
  }
}

/// Turns the first element of each place inside out. Returns these elements.
std::map<int, int> turn_inside_out(HexMesh& mesh) {
  std::map<int, int> first;
  for (int e = 0; e < mesh.element_count(); ++e) {
    first.try_emplace(mesh.element_branch[e], e);
  }
  for (const auto& [place, e] : first) {
    std::swap_ranges(mesh.elements.begin() + 8 * e, mesh.elements.begin() + 8 * e + 4,
                     mesh.elements.begin() + 8 * e + 4);
  }
  return first;
}

TEST(FailedPlaces, AreNamedWithTheNearestFinding) {
  SkeletonMesh m = mesh_skeleton(gallery::linked(6), with(1, 2));
  HexMesh& mesh = m.result.mesh;
  EXPECT_TRUE(failed_places(m.network, m.findings, mesh, measure_quality(mesh)).empty());
  const std::map<int, int> first = turn_inside_out(mesh);
  ASSERT_EQ(first.size(), 7u);  // two junctions, five branches
  Finding bend;
  bend.kind = FindingKind::sharp_bend;
  bend.branches = {3, -1};
  bend.text = "a sharp bend";
  bend.cure = "a wider one";
  for (int i = 0; i < 8; ++i) {
    bend.at += mesh.nodes[mesh.elements[8 * first.at(3) + i]] / 8;
  }
  const std::vector<FailedPlace> failed = failed_places(m.network, {bend}, mesh, measure_quality(mesh));
  ASSERT_EQ(failed.size(), first.size());
  for (std::size_t i = 0; i < failed.size(); ++i) {
    const FailedPlace& f = failed[i];
    EXPECT_TRUE(i == 0 || failed[i - 1].scaled_jacobian <= f.scaled_jacobian);
    EXPECT_EQ(f.elements, 1);
    EXPECT_LT(f.scaled_jacobian, 0);
    Vec3 middle = Vec3::Zero();
    for (int k = 0; k < 8; ++k) {
      middle += mesh.nodes[mesh.elements[8 * first.at(f.place) + k]] / 8;
    }
    EXPECT_LT((f.at - middle).norm(), 1e-12);
    if (f.place == 3) {
      EXPECT_EQ(f.finding, 0);
      EXPECT_EQ(f.reason, "a sharp bend");
    }
    const std::string point =
        "point " +
        std::to_string(m.network.nodes[f.place < 0 ? -1 - f.place : m.network.branches[f.place].nodes[0]].point);
    EXPECT_NE(f.text.find(point), std::string::npos) << f.text;
    EXPECT_FALSE(f.reason.empty() || f.cure.empty());
    EXPECT_EQ(f.reason.find("is cut"), std::string::npos) << f.reason;
  }
  // the same with a short branch that ends where the failed element of its junction is
  const auto degree = [&](int node) { return m.network.nodes[node].degree; };
  Branch& branch = *std::find_if(m.network.branches.begin(), m.network.branches.end(),
                                 [&](const Branch& b) { return degree(b.nodes[0]) == 1 || degree(b.nodes[1]) == 1; });
  const int side = degree(branch.nodes[0]) == 1 ? 0 : 1, end = branch.nodes[side], junction = branch.nodes[1 - side];
  const auto at_junction = [&](const FailedPlace& f) { return f.place == -1 - junction; };
  branch.arc.back() = m.network.nodes[end].radius;
  m.network.nodes[end].position = std::find_if(failed.begin(), failed.end(), at_junction)->at;
  const std::vector<FailedPlace> cut = failed_places(m.network, {bend}, mesh, measure_quality(mesh));
  const auto f = std::find_if(cut.begin(), cut.end(), at_junction);
  ASSERT_NE(f, cut.end());
  EXPECT_NE(f->reason.find("is cut"), std::string::npos) << f->reason;
  EXPECT_EQ(f->finding, -1);
}

TEST(FailedPlaces, SayHowFarBranchesRunSideBySide) {
  for (const double angle : {12.0, 90.0}) {
    SCOPED_TRACE(angle);
    SkeletonMesh m = mesh_skeleton(gallery::fork(angle, 1, 1, 0), with(1, 2));
    turn_inside_out(m.result.mesh);
    int junctions = 0;
    for (const FailedPlace& f : failed_places(m.network, {}, m.result.mesh, measure_quality(m.result.mesh))) {
      if (f.place >= 0) {
        continue;
      }
      ++junctions;
      const std::size_t at = f.reason.find("in one tube up to ");
      EXPECT_EQ(f.cure.starts_with("move the junction"), angle < 90) << f.cure;
      ASSERT_EQ(at != std::string::npos, angle < 90) << f.reason;
      if (angle < 90) {
        // straight tubes of radius 1 part where the axes are 2 apart
        const double parting = 1 / std::sin(angle / 2 * std::numbers::pi / 180);
        EXPECT_NEAR(std::stod(f.reason.substr(at + 18)), parting, 0.1 * parting) << f.reason;
      }
    }
    EXPECT_EQ(junctions, 1);
  }
}

TEST(Mesh, IsTheSameForAnyNumberOfThreads) {
  const Skeleton skeleton = gallery::linked(6);
  for (const SkeletonMeshOptions& options : {with(3, 6), with(1, 6)}) {
    std::vector<HexMesh> meshes;
    for (const int threads : {1, 2, 8}) {
      vasohex::Run run;
      run.threads = threads;
      meshes.push_back(mesh_skeleton(skeleton, options, run).result.mesh);
    }
    for (const HexMesh& other : meshes) {
      EXPECT_EQ(meshes[0].elements, other.elements);
      ASSERT_EQ(meshes[0].nodes.size(), other.nodes.size());
      EXPECT_TRUE(std::equal(other.nodes.begin(), other.nodes.end(), meshes[0].nodes.begin()));
    }
  }
}

TEST(Mesh, MovesAndScalesWithItsSkeleton) {
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()) * Eigen::AngleAxisd(-1.9, Vec3(0, 1, -1).normalized()))
          .toRotationMatrix();
  for (const Skeleton& skeleton : {gallery::linked(6), gallery::linked(1.2), gallery::random_star(4, 1, 30),
                                   gallery::ring_with_arms(), gallery::torus(4, 1)}) {
    const SkeletonMesh made = mesh_skeleton(skeleton, with(2, 2));
    const HexMesh& plain = made.result.mesh;
    for (const double scale : {1.0, 1e-6, 1e3}) {
      Skeleton moved = skeleton;
      const Vec3 shift(3, -5, 7);
      for (Vec3& p : moved.points) {
        p = scale * (rotation * p + shift);
      }
      for (double& r : moved.radii) {
        r *= scale;
      }
      const SkeletonMesh again = mesh_skeleton(moved, with(2, 2));
      const HexMesh& mesh = again.result.mesh;
      ASSERT_EQ(mesh.elements, plain.elements);
      double most = 0;
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        most = std::max(most, (mesh.nodes[i] / scale - (rotation * plain.nodes[i] + shift)).norm());
      }
      EXPECT_LT(most, 1e-11) << "scale " << scale;
      ASSERT_EQ(again.blocks.regions.size(), made.blocks.regions.size());
      for (std::size_t r = 0; r < made.blocks.regions.size(); ++r) {
        EXPECT_NEAR(again.blocks.regions[r].front().to / scale, made.blocks.regions[r].front().to, 1e-9);
        EXPECT_LE(made.blocks.regions[r].front().to,
                  made.network.branches[made.blocks.regions[r].front().branch].length() * (1 + 1e-9));
      }
    }
  }
}

TEST(Tube, VolumeConvergesAtOrderTwoP) {
  const double length = 8, radius = 1, exact = std::numbers::pi * radius * radius * length;
  for (const int order : {1, 2, 3}) {
    double before = 0;
    for (const int elements : {1, 2, 4}) {
      const double error = std::abs(measures::volume(mesh_skeleton(gallery::tube(length, radius),
                                                         with(order, elements, NodeFamily::gauss_lobatto))
                                               .result.mesh) -
                                    exact) /
                           exact;
      if (elements > 1 && before > 1e-11) {
        EXPECT_GT(std::log2(before / error), 2 * order - 0.3) << "order " << order << ", " << elements << " elements";
      }
      before = error;
    }
    // order 1 with 4 elements: the prism over a regular polygon of 16 corners, .0255 less than the cylinder
    EXPECT_LT(before, order == 1 ? 0.0256 : 1e-4);
  }
}

TEST(Tube, HasTheQualityOfItsSection) {
  const SkeletonMesh m = mesh_skeleton(gallery::tube(8, 1), with(1, 6));
  EXPECT_GE(measure_quality(m.result.mesh).scaled_jacobian_linear.min, 0.84);
}

TEST(Torus, VolumeConvergesBetterThanPPlusOne) {
  // against the convolution surface itself, by a much finer mesh of a higher order
  const auto of = [](int order, int elements) {
    return measures::volume(mesh_skeleton(gallery::torus(4, 1), with(order, elements, NodeFamily::gauss_lobatto)).result.mesh);
  };
  const double exact = of(6, 4);
  for (const int order : {1, 2, 3}) {
    const double coarse = std::abs(of(order, 2) - exact), fine = std::abs(of(order, 4) - exact);
    EXPECT_GT(std::log2(coarse / fine), order == 1 ? 1.95 : order + 1) << "order " << order;
  }
}

TEST(Layers, HaveTheHeightAskedFor) {
  for (const Skeleton& skeleton :
       {gallery::tube(8, 1), gallery::linked(6),
        gallery::star({-Vec3::UnitY(), gallery::spherical(65, 0), gallery::spherical(115, 0)}, {1, 0.75, 0.75}, 6)}) {
    for (const int order : {1, 3}) {
      SkeletonMeshOptions options = with(order, 6);
      options.grading.layers = WallLayers{6, 0.02, true, 1.3};
      const SkeletonMesh m = mesh_skeleton(skeleton, options);
      const HexMesh& mesh = m.result.mesh;
      EXPECT_EQ(m.result.shrunk_lines, 0);
      EXPECT_EQ(measure_quality(mesh).certified, mesh.element_count());
      EXPECT_GT(first_layer_kept(mesh, *m.surface, *options.grading.layers), 0.9) << "order " << order;
    }
  }
}

TEST(Sheets, CarryOneCount) {
  const SkeletonMesh m = mesh_skeleton(gallery::linked(6), with(1, 2));
  const BlockTopology topology = build_topology(m.blocks.vertex_count, m.blocks.blocks);
  Grading grading;
  grading.requests = {{"axial.1", 3, {}}, {"axial.1", 4, {}}};
  try {
    grade(m.blocks, topology, grading);
    FAIL() << "two counts for one sheet were accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::bad_input);
    EXPECT_NE(std::string(e.what()).find("sheet axial.1"), std::string::npos) << e.what();
  }
  grading.requests = {{"axial.1", 5, {}}};
  const Sheets sheets = grade(m.blocks, topology, grading);
  int radial = 0, five = 0;
  for (const Sheet& s : sheets.sheets) {
    radial += s.kind == DirectionKind::radial;
    five += s.count == 5;
  }
  EXPECT_EQ(radial, 1) << "one radial sheet for a connected network";
  EXPECT_EQ(five, 1);
  const MeshResult graded = generate_mesh(m.blocks, topology, sheets, *m.surface, {1}, {});
  properties::expect_conforming(graded.mesh);
}

}  // namespace
}  // namespace vasohex
