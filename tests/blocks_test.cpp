// Parts that blocks are made of: shared lattices, the O-grid, the cube's assignments, the energy, the optimiser.

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "gallery.h"
#include "mesh_properties.h"
#include "random_network.h"
#include "vasohex/blocks/clear_ends.h"
#include "vasohex/blocks/cross_section.h"
#include "vasohex/blocks/energy_kernel_isa.h"
#include "vasohex/blocks/hubs.h"
#include "vasohex/blocks/junction.h"
#include "vasohex/blocks/split_hub.h"
#include "vasohex/blocks/topology.h"
#include "vasohex/blocks/wall_model.h"
#include "vasohex/core/node_family.h"
#include "vasohex/core/reference_hex.h"
#include "vasohex/surface/project.h"
#include "vasohex/vasohex.h"

namespace vasohex {
namespace {

TEST(Lattice, SharedNodesLieAtTheSamePlace) {
  // three cubes around an edge, their axes turned at random
  std::vector<Vec3> vertices{{0, 0, 0}, {0, 0, 1}};
  const std::array<double, 6> angles{0, 60, 120, 180, 240, 300};
  for (const double a : angles) {
    const double c = std::cos(a * std::numbers::pi / 180), s = std::sin(a * std::numbers::pi / 180);
    vertices.push_back({c, s, 0});
    vertices.push_back({c, s, 1});
  }
  std::mt19937 random(5);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<std::array<int, 8>> blocks;
    std::vector<int> names(vertices.size());  // vertex numbers in any order
    std::iota(names.begin(), names.end(), 0);
    std::shuffle(names.begin(), names.end(), random);
    for (int q = 0; q < 3; ++q) {
      const int a = 2 + 4 * q, b = 4 + 4 * q, c = q == 2 ? 2 : 6 + 4 * q;
      std::array<int, 8> block{0, a, c, b, 1, a + 1, c + 1, b + 1};
      for (int turn = static_cast<int>(random() % 3); turn > 0; --turn) {  // i <- j <- k <- i
        block = {block[0], block[4], block[1], block[5], block[2], block[6], block[3], block[7]};
      }
      for (int& v : block) {
        v = names[v];
      }
      blocks.push_back(block);
    }
    const BlockTopology t = build_topology(static_cast<int>(vertices.size()), blocks);
    EXPECT_EQ(t.edges.size(), 12u * 3 - 1 - 1 - 3 * 3);  // one edge of three blocks, three faces of two
    EXPECT_EQ(std::count(t.face_block_count.begin(), t.face_block_count.end(), 2), 3);
    std::vector<Vec3> at(vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      at[names[v]] = vertices[v];
    }
    const LatticeNumbering numbering(t, std::vector<int>(t.edges.size(), 4));
    std::vector<Vec3> place(numbering.node_count(), Vec3::Constant(1e9));
    std::vector<int> ids;
    for (int b = 0; b < 3; ++b) {
      numbering.block_nodes(b, ids);
      EXPECT_EQ(std::set<int>(ids.begin(), ids.end()).size(), 125u);
      for (int i = 0; i < 125; ++i) {
        Vec3 p = Vec3::Zero();
        for (int c = 0; c < 8; ++c) {
          double w = 1;
          for (const auto& [d, u] :
               {std::pair(0, i % 5 / 4.0), std::pair(1, i / 5 % 5 / 4.0), std::pair(2, i / 25 / 4.0)}) {
            w *= c >> d & 1 ? u : 1 - u;
          }
          p += w * at[blocks[b][c]];
        }
        if (place[ids[i]].x() > 1e8) {
          place[ids[i]] = p;
        }
        EXPECT_LT((place[ids[i]] - p).norm(), 1e-12);
      }
    }
    for (const Vec3& p : place) {
      EXPECT_LT(p.norm(), 10) << "a node that no block has";
    }
  }
}

TEST(Section, IsADiscOfRightHandedQuads) {
  for (int quad = 0; quad < 5; ++quad) {
    for (double u = 0.01; u < 1; u += 0.07) {
      for (double v = 0.01; v < 1; v += 0.07) {
        const double h = 1e-6;
        const Eigen::Vector2d du = section_point(quad, u + h, v) - section_point(quad, u - h, v);
        const Eigen::Vector2d dv = section_point(quad, u, v + h) - section_point(quad, u, v - h);
        EXPECT_GT((du.x() * dv.y() - du.y() * dv.x()) / (du.norm() * dv.norm()), 0.84) << "quad " << quad;
      }
    }
  }
  for (int j = 0; j < 4; ++j) {
    const double corner = (45 + 90 * j) * std::numbers::pi / 180;
    EXPECT_LT((section_point(1 + j, 1, 0) - Eigen::Vector2d(std::cos(corner), std::sin(corner))).norm(), 1e-14);
    for (double v = 0; v <= 1; v += 0.125) {
      EXPECT_NEAR(section_point(1 + j, 1, v).norm(), 1, 1e-14);
      // neighbours agree along their common line
      EXPECT_LT((section_point(1 + j, v, 1) - section_point(1 + (j + 1) % 4, v, 0)).norm(), 1e-14);
    }
  }
  EXPECT_LT((section_point(0, 0, 0) - section_point(1, 0, 0)).norm(), 1e-14);
  EXPECT_LT((section_point(0, 1, 0) - section_point(2, 0, 0)).norm(), 1e-14);
}

TEST(Cube, AssignmentsFitTheArms) {
  const auto cross = cube_assignments({Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitX(), -Vec3::UnitY()}, 3);
  EXPECT_NEAR(cross.front().cost, 0, 1e-12);
  EXPECT_GT(cross.at(1).cost, 0.1);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int arms = 1; arms <= 6; ++arms) {
    std::vector<Vec3> directions;
    for (int a = 0; a < arms; ++a) {
      directions.push_back(Vec3(normal(random), normal(random), normal(random)).normalized());
    }
    double before = -1;
    for (const CubeAssignment& c : cube_assignments(directions, 100)) {
      EXPECT_GE(c.cost, before);
      before = c.cost;
      EXPECT_EQ(std::set<int>(c.face.begin(), c.face.end()).size(), static_cast<std::size_t>(arms));
      EXPECT_LT((c.rotation * c.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
      EXPECT_NEAR(c.rotation.determinant(), 1, 1e-12);
    }
    EXPECT_EQ(cube_assignments(directions, 3).size(), arms == 1 ? 1u : arms == 2 ? 2u : 3u);
  }
}

TEST(CapDistance, IsThatOfTheDesign) {
  // a thin branch at a right angle leaves a thick one at its wall: t = r_thick, widened by .16 of the least radius
  const std::vector<Vec3> t{Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY()};
  EXPECT_NEAR(cap_distance(t, {1, 1, 0.25}, 2), 1.04 + 0.125, 1e-12);
  EXPECT_NEAR(cap_distance(t, {1, 1, 0.25}, 0), 0.3 + 0.5, 1e-12);
}

/// Nodes of one block: the unit cube's Gauss-Lobatto lattice, bent and shaken.
std::vector<double> shaken_block(int degree, std::mt19937& random, double by) {
  std::uniform_real_distribution<double> uniform(-by, by);
  const std::vector<double> t = family_nodes(NodeFamily::gauss_lobatto, degree);
  std::vector<double> x;
  for (const double w : t) {
    for (const double v : t) {
      for (const double u : t) {
        for (const double c : {u + 0.2 * v * w, v - 0.1 * u * u, 1.5 * w + 0.1 * u * v}) {
          x.push_back(c + uniform(random));
        }
      }
    }
  }
  return x;
}

TEST(Energy, GradientIsThatOfTheValue) {
  std::mt19937 random(11);
  for (int degree = 2; degree <= 4; ++degree) {
    const int nodes = (degree + 1) * (degree + 1) * (degree + 1);
    const std::vector<double> gauss = family_nodes(NodeFamily::gauss_lobatto, degree);
    const std::vector<double> at = family_nodes(NodeFamily::equispaced, degree + 2);
    const std::vector<double> value = lagrange_values(gauss, at), slope = lagrange_derivatives(gauss, at);
    for (const int blocks : {1, 9}) {
      std::vector<double> x;
      std::vector<int> ids;
      std::vector<double> lengths;
      for (int b = 0; b < blocks; ++b) {
        const auto block = shaken_block(degree, random, 0.03);
        x.insert(x.end(), block.begin(), block.end());
        for (int i = 0; i < nodes; ++i) {
          ids.push_back(b * nodes + i);
        }
        lengths.insert(lengths.end(), {1.0, 0.8, 1.3});
      }
      for (const int power : {8, 16}) {
        kernel::DistortionInput in;
        in.degree = degree;
        in.samples = degree + 3;
        in.value = value.data();
        in.slope = slope.data();
        in.blocks = blocks;
        in.ids = ids.data();
        in.nodes = x.data();
        in.inverse_length = lengths.data();
        in.shape_weight = 0.5;
        in.jacobian_weight = 1;
        in.epsilon = 0.1;
        in.jacobian_goal = 0.3;
        in.power = power;
        std::vector<double> gradient(x.size(), 0.0);
        const auto out = kernel::distortion(in, gradient.data());
        EXPECT_NEAR(out.energy, kernel::distortion(in, nullptr).energy, 1e-15 * out.energy);
        double norm = 0;
        for (const double g : gradient) {
          norm = std::max(norm, std::abs(g));
        }
        for (int probe = 0; probe < 20; ++probe) {
          const std::size_t i = random() % x.size();
          const double h = 1e-5, there = x[i];
          x[i] = there + h;
          const double up = kernel::distortion(in, nullptr).energy;
          x[i] = there - h;
          const double down = kernel::distortion(in, nullptr).energy;
          x[i] = there;
          EXPECT_NEAR(gradient[i], (up - down) / (2 * h), 1e-6 * norm + 1e-9);
        }
      }
    }
  }
}

TEST(Energy, IsTheSameForEveryInstructionSet) {
  std::mt19937 random(2);
  const std::vector<double> x = shaken_block(4, random, 0.1);
  std::vector<int> ids(125);
  std::iota(ids.begin(), ids.end(), 0);
  const std::vector<double> gauss = family_nodes(NodeFamily::gauss_lobatto, 4);
  const std::vector<double> at = family_nodes(NodeFamily::equispaced, 6);
  const std::vector<double> value = lagrange_values(gauss, at), slope = lagrange_derivatives(gauss, at);
  const std::vector<double> lengths{1, 1, 1};
  kernel::DistortionInput in;
  in.degree = 4;
  in.samples = 7;
  in.value = value.data();
  in.slope = slope.data();
  in.blocks = 1;
  in.ids = ids.data();
  in.nodes = x.data();
  in.inverse_length = lengths.data();
  in.jacobian_weight = 1;
  std::vector<double> best(x.size(), 0.0), plain(x.size(), 0.0);
  EXPECT_EQ(kernel::distortion(in, best.data()).energy, kernel::baseline::distortion(in, plain.data()).energy);
  EXPECT_EQ(best, plain);
}

TEST(WallModel, IsTheSurfaceToThirdOrder) {
  struct Sphere final : ImplicitSurface {
    mutable int looks = 0;
    double value(const Vec3& x) const override { return x.norm() - 1; }
    double value(const Vec3& x, Vec3& gradient) const override {
      ++looks;
      gradient = x.normalized();
      return x.norm() - 1;
    }
    double radius(const Vec3&) const override { return 1; }
  } sphere;
  constexpr double kReach = 0.1;
  WallModel wall(sphere, 2);
  wall.set_reach(kReach);
  const Vec3 start = Vec3(1, 2, -2) / 3, aside = Vec3(2, 1, 2) / 3;
  Vec3 gradient;
  EXPECT_EQ(wall.value(1, start, gradient), sphere.value(start));
  for (const double part : {0.3, 0.99}) {
    const Vec3 x = start + part * kReach * (0.8 * aside + 0.6 * start);
    EXPECT_NEAR(wall.value(1, x, gradient), sphere.value(x), std::pow(kReach, 3) / 2);
    EXPECT_LT((gradient - x.normalized()).norm(), kReach * kReach);
  }
  EXPECT_EQ(sphere.looks, 3);  // at the start, and twice beside it for the curvature
  const Vec3 far = start + 1.01 * kReach * aside;
  EXPECT_EQ(wall.value(1, far, gradient), sphere.value(far));
  wall.forget();
  EXPECT_EQ(wall.value(1, far, gradient), sphere.value(far));
  EXPECT_EQ(sphere.looks, 5);
}

TEST(WallModel, KnowsItsOwnWallBeyondAGap) {
  // two tubes of radius 1 along z, a gap between them
  constexpr double kGap = 0.1;
  class Pair final : public ImplicitSurface {
   public:
    double value(const Vec3& x) const override {
      Vec3 gradient;
      return value(x, gradient);
    }
    double value(const Vec3& x, Vec3& gradient) const override {
      const Vec3 axis(x.x() < 0 ? -1 - 0.5 * kGap : 1 + 0.5 * kGap, 0, x.z());
      gradient = (x - axis).normalized();
      return (x - axis).norm() - 1;
    }
    double radius(const Vec3&) const override { return 1; }
  } surface;
  const Vec3 axis(-1 - 0.5 * kGap, 0, 0);
  for (const double degrees : {-15, 0, 10}) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3 outward(std::cos(angle), std::sin(angle), 0);
    for (const double off : {-0.1, 0.02, 0.07, 0.12, 0.3}) {
      WallModel model(surface, 1);
      model.set_reach(0.04);
      const Vec3 x = axis + (1 + off) * outward;
      Vec3 gradient;
      EXPECT_NEAR(model.value_facing(0, x, outward, gradient), off, 1e-3);
      EXPECT_NEAR((gradient - outward).norm(), 0, 1e-9);
      // without the direction it is the other tube's wall that is near
      EXPECT_EQ(model.value_facing(0, x, Vec3::Zero(), gradient), surface.value(x));
      EXPECT_EQ(gradient.x() < 0, x.x() > 0);
    }
  }
}

TEST(Junctions, ReachTheQualityOfTheDesign) {
  // what a prototype reached with cubes for the named junctions, less .03
  struct Named {
    std::string name;
    double least;
  };
  const std::vector<gallery::Shape> shapes = gallery::shapes();
  for (const Named& named : {Named{"Y 120", 0.75},
                             {"iliac", 0.74},
                             {"T thin", 0.75},
                             {"trifurcation", 0.73},
                             {"cross", 0.74},
                             {"six axes", 0.74}}) {
    const auto shape =
        std::find_if(shapes.begin(), shapes.end(), [&](const auto& s) { return s.name == named.name; });
    ASSERT_TRUE(shape != shapes.end());
    const SkeletonMesh m = mesh_skeleton(shape->skeleton);
    ASSERT_EQ(m.blocks.junctions.size(), 1u);
    EXPECT_TRUE(m.blocks.junctions[0].certified) << named.name;
    EXPECT_GT(m.blocks.junctions[0].min_jacobian, named.least) << named.name;
  }
}

TEST(Junctions, OfTwoBranchesTurnSharpBends) {
  // two straight tubes that meet at 60 degrees without any rounding
  Network network;
  network.nodes.resize(3);
  network.nodes[0].degree = 2;
  for (int b = 0; b < 2; ++b) {
    network.nodes[1 + b].degree = 1;
    network.nodes[1 + b].name = b == 0 ? "inlet" : "outlet_1";
    Branch branch;
    branch.nodes = {0, 1 + b};
    for (int i = 0; i <= 16; ++i) {
      branch.points.push_back(0.4 * i * gallery::spherical(60 * b, 0));
      branch.radii.push_back(1);
      branch.tangents.push_back(gallery::spherical(60 * b, 0));
      branch.arc.push_back(0.4 * i);
    }
    network.nodes[1 + b].position = branch.points.back();
    network.branches.push_back(branch);
  }
  const auto surface = make_convolution_surface(network);
  const BlockStructure blocks = build_blocks(network, *surface, {}, {});
  ASSERT_EQ(blocks.junctions.size(), 1u);
  EXPECT_EQ(blocks.certified, static_cast<int>(blocks.blocks.size()));
  EXPECT_GT(blocks.junctions[0].min_jacobian, 0.5);
}

TEST(Junctions, NearEachOtherAreLinked) {
  EXPECT_EQ(mesh_skeleton(gallery::linked(1.2)).blocks.junctions.at(0).prototype, "cubes linked");
  EXPECT_EQ(mesh_skeleton(gallery::linked(6)).blocks.junctions.at(0).prototype, "cube");
}

TEST(Junctions, OfManyBranchesBecomeTreesOfCubes) {
  const SkeletonMesh m = mesh_skeleton(gallery::random_star(8, 2, 30));
  ASSERT_EQ(m.blocks.junctions.size(), 1u);
  EXPECT_EQ(m.blocks.junctions[0].degree, 8);
  EXPECT_EQ(m.blocks.junctions[0].prototype, "tree of cubes");
  EXPECT_EQ(m.blocks.certified, static_cast<int>(m.blocks.blocks.size()));
  EXPECT_GT(m.blocks.junctions[0].min_jacobian, 0.5);
}

TEST(Junctions, TooWeakForOneCubeAreDivided) {
  const SkeletonMesh m = mesh_skeleton(gallery::random_star(5, 3, 30));  // .39 with any single cube
  EXPECT_EQ(m.blocks.junctions.at(0).prototype, "tree of cubes");
  EXPECT_GT(m.blocks.junctions[0].min_jacobian, 0.5);
}

TEST(Junctions, WithBranchesSideBySideShareCubes) {
  const SkeletonMesh m = mesh_skeleton(gallery::two_pairs_side_by_side());
  ASSERT_EQ(m.blocks.junctions.size(), 2u);
  EXPECT_EQ(m.blocks.certified, static_cast<int>(m.blocks.blocks.size()));
  EXPECT_GT(m.blocks.min_jacobian, 0.5);
}

TEST(Junctions, WithBranchesSideBySideAsFarAsTheNextShareATube) {
  for (const double angle : {10.0, 12.0}) {
    const SkeletonMesh m = mesh_skeleton(gallery::fork_that_divides(angle));
    EXPECT_EQ(m.blocks.certified, static_cast<int>(m.blocks.blocks.size())) << angle;
  }
}

TEST(Junctions, OfNarrowForksAreCertified) {
  for (const double angle : {6.0, 8.0}) {
    for (const auto& [left, right] : {std::pair(1.0, 1.0), std::pair(0.8, 0.5)}) {
      const SkeletonMesh m = mesh_skeleton(gallery::star(
          {gallery::spherical(180, 0), gallery::spherical(0, 0), gallery::spherical(angle, 0)}, {1, left, right}, 32));
      EXPECT_EQ(m.blocks.certified, static_cast<int>(m.blocks.blocks.size())) << angle << " " << right;
      EXPECT_GT(m.blocks.min_jacobian, 0.2) << angle << " " << right;
    }
  }
}

TEST(Junctions, OfMuchThinnerBranchesAreCertified) {
  for (const double angle : {90.0, 60.0, 45.0}) {
    for (const double radius : {0.08, 0.05, 0.03}) {
      const SkeletonMesh m = mesh_skeleton(gallery::star(
          {gallery::spherical(180, 0), gallery::spherical(0, 0), gallery::spherical(angle, 0)}, {1, 1, radius}, 3));
      EXPECT_EQ(m.blocks.certified, static_cast<int>(m.blocks.blocks.size())) << angle << " " << radius;
      EXPECT_GT(m.blocks.min_jacobian, 0.2) << angle << " " << radius;
    }
  }
}

TEST(Branches, WithSpikesAreCertified) {
  const SkeletonMesh m = mesh_skeleton(gallery::spike());
  EXPECT_EQ(m.blocks.certified, static_cast<int>(m.blocks.blocks.size()));
  EXPECT_GT(m.blocks.min_jacobian, 0.5);
}

TEST(Clusters, HaveCapsWhereTheirVesselsAreTubes) {
  // networks with junctions so near each other that one stands within the other's vessels
  for (const int seed : {2, 3, 10, 14, 20}) {
    Network network = build_network(gallery::RandomNetwork::grown(seed, 10));
    clear_ends(network);
    const auto surface = make_convolution_surface(network);
    for (const Cluster& cluster : find_clusters(network, *surface)) {
      const auto around = surface->part(stretches_of(network, cluster));
      for (const Hub& hub : cluster) {
        for (const Arm& arm : hub.arms) {
          if (arm.link >= 0 || arm.cap >= network.branches[arm.branch].length()) {
            continue;
          }
          const SectionFrame& f = arm.section;
          for (int ray = 0; ray < 72; ++ray) {
            const double angle = ray * 2 * std::numbers::pi / 72;
            const auto t =
                shoot(*around, f.origin, std::cos(angle) * f.x + std::sin(angle) * f.y, f.radius, 4 * f.radius);
            ASSERT_TRUE(t) << "network " << seed << ", branch " << arm.branch;
            EXPECT_LT(*t, 1.1 * f.radius) << "network " << seed << ", branch " << arm.branch;
          }
        }
      }
    }
  }
}

TEST(Clusters, OfManyBranchesAreDividedInAllNarrowWays) {
  for (int seed = 1; seed <= 4; ++seed) {
    const Network network = build_network(gallery::random_star(8, seed, 30));
    const auto surface = make_convolution_surface(network);
    const Cluster star = find_clusters(network, *surface).at(0);
    ASSERT_EQ(star.at(0).arms.size(), 8u);
    const auto angle = [&](int a, int b) {
      return std::acos(star[0].arms[a].direction.dot(star[0].arms[b].direction));
    };
    std::set<std::set<int>> together;  // branches that share a cube beside the first one
    for (const Cluster& divided : split_hub(star, 0)) {
      std::multiset<int> branches;
      for (std::size_t h = 0; h < divided.size(); ++h) {
        EXPECT_LE(divided[h].arms.size(), static_cast<std::size_t>(kCubeArms));
        std::set<int> here;
        for (const Arm& arm : divided[h].arms) {
          if (arm.link < 0) {
            branches.insert(arm.branch);
            here.insert(arm.branch);
          }
        }
        together.insert(here);
      }
      EXPECT_EQ(branches, (std::multiset<int>{0, 1, 2, 3, 4, 5, 6, 7}));
    }
    // the four narrowest pairs, whatever else is together
    std::vector<std::pair<double, std::set<int>>> pairs;
    for (int a = 0; a < 8; ++a) {
      for (int b = a + 1; b < 8; ++b) {
        pairs.emplace_back(angle(a, b), std::set<int>{star[0].arms[a].branch, star[0].arms[b].branch});
      }
    }
    std::sort(pairs.begin(), pairs.end());
    for (int i = 0; i < 4; ++i) {
      EXPECT_TRUE(together.contains(pairs[i].second)) << "seed " << seed << ", pair " << i;
    }
    EXPECT_TRUE(std::any_of(together.begin(), together.end(), [](const auto& t) { return t.size() == 4; }));
  }
}

TEST(Junctions, JoinedTwiceAreLinkedOnce) {
  // a loop as small as the vessels: two branches between the same two junctions, one of them a link
  Skeleton s;
  s.points = {Vec3(0, 0, 0), Vec3(2.2, 0, 0), Vec3(1.1, 2.8, 0), Vec3(1.1, 2.8, 2)};
  s.radii = {0.7, 0.7, 0.7, 0.7};
  s.points[3] = Vec3(2.6, 1.6, 0);
  s.segments = {{0, 1}, {0, 2}, {2, 3}, {3, 1}};
  for (const int from : {0, 1}) {
    int before = from;
    for (int i = 1; i <= 6; ++i) {
      s.points.push_back(s.points[from] + i * Vec3(from == 0 ? -0.6 : 0.6, -0.3, 0.1));
      s.radii.push_back(0.7);
      s.segments.push_back({before, static_cast<int>(s.points.size()) - 1});
      before = static_cast<int>(s.points.size()) - 1;
    }
  }
  const SkeletonMesh m = mesh_skeleton(s);
  EXPECT_EQ(m.blocks.junctions.size(), 2u);
  properties::expect_conforming(m.result.mesh);
}

}  // namespace
}  // namespace vasohex
