// The block file: what it says comes back to the last bit, meshes made from it are the same, bad files are refused.

#include "vasohex/block_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "errors.h"
#include "gallery.h"
#include "mesh_properties.h"
#include "vasohex/mesh_part.h"

namespace vasohex {
namespace {

class Files : public testing::Test {
 protected:
  Files() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / (std::string("vasohex_block_file_") + test->name());
    std::filesystem::create_directories(folder_);
  }
  ~Files() override { std::filesystem::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
};

std::string bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

SkeletonMeshOptions options_of(int order, int elements) {
  SkeletonMeshOptions options;
  options.mesh.order = order;
  options.grading.elements = elements;
  return options;
}

std::vector<Skeleton> skeletons() {
  return {gallery::tube(8, 1), gallery::torus(4, 1), gallery::linked(6), gallery::ring_with_arms(),
          gallery::both(gallery::tube(8, 1), gallery::torus(4, 1), Vec3(20, 0, 0))};
}

void expect_same(const BlockFile& a, const BlockFile& b) {
  EXPECT_EQ(a.blocks.degree, b.blocks.degree);
  EXPECT_EQ(a.blocks.vertex_count, b.blocks.vertex_count);
  EXPECT_EQ(a.blocks.blocks, b.blocks.blocks);
  EXPECT_EQ(a.blocks.nodes, b.blocks.nodes);
  EXPECT_EQ(a.blocks.block_nodes, b.blocks.block_nodes);
  EXPECT_EQ(a.blocks.kinds, b.blocks.kinds);
  EXPECT_EQ(a.blocks.places, b.blocks.places);
  EXPECT_EQ(a.blocks.block_region, b.blocks.block_region);
  EXPECT_EQ(a.blocks.surfaces, b.blocks.surfaces);
  EXPECT_EQ(a.blocks.units, b.blocks.units);
  EXPECT_EQ(a.blocks.min_jacobian, b.blocks.min_jacobian);
  EXPECT_EQ(a.blocks.certified, b.blocks.certified);
  ASSERT_EQ(a.blocks.regions.size(), b.blocks.regions.size());
  for (std::size_t r = 0; r < a.blocks.regions.size(); ++r) {
    ASSERT_EQ(a.blocks.regions[r].size(), b.blocks.regions[r].size());
    for (std::size_t i = 0; i < a.blocks.regions[r].size(); ++i) {
      const Stretch &s = a.blocks.regions[r][i], &t = b.blocks.regions[r][i];
      EXPECT_TRUE(s.branch == t.branch && s.from == t.from && s.to == t.to);
    }
  }
  ASSERT_EQ(a.blocks.boundary.size(), b.blocks.boundary.size());
  for (std::size_t i = 0; i < a.blocks.boundary.size(); ++i) {
    const auto &f = a.blocks.boundary[i], &g = b.blocks.boundary[i];
    EXPECT_TRUE(f.block == g.block && f.face == g.face && f.surface == g.surface);
  }
  ASSERT_EQ(a.blocks.ends.size(), b.blocks.ends.size());
  for (std::size_t i = 0; i < a.blocks.ends.size(); ++i) {
    const SectionFrame &e = a.blocks.ends[i], &f = b.blocks.ends[i];
    EXPECT_TRUE(e.origin == f.origin && e.x == f.x && e.y == f.y && e.radius == f.radius);
  }
  ASSERT_EQ(a.network.nodes.size(), b.network.nodes.size());
  for (std::size_t i = 0; i < a.network.nodes.size(); ++i) {
    const NetworkNode &n = a.network.nodes[i], &m = b.network.nodes[i];
    EXPECT_TRUE(n.position == m.position && n.radius == m.radius && n.degree == m.degree && n.point == m.point &&
                n.seam == m.seam && n.blind == m.blind && n.name == m.name);
  }
  ASSERT_EQ(a.network.branches.size(), b.network.branches.size());
  for (std::size_t i = 0; i < a.network.branches.size(); ++i) {
    const Branch &c = a.network.branches[i], &d = b.network.branches[i];
    EXPECT_TRUE(c.nodes == d.nodes && c.points == d.points && c.radii == d.radii && c.tangents == d.tangents &&
                c.arc == d.arc);
  }
  EXPECT_EQ(a.grading.elements, b.grading.elements);
  EXPECT_EQ(a.grading.axial, b.grading.axial);
  ASSERT_EQ(a.grading.layers.has_value(), b.grading.layers.has_value());
  if (a.grading.layers) {
    EXPECT_EQ(a.grading.layers->first_height, b.grading.layers->first_height);
    EXPECT_EQ(a.grading.layers->layers, b.grading.layers->layers);
  }
  ASSERT_EQ(a.grading.requests.size(), b.grading.requests.size());
  for (std::size_t i = 0; i < a.grading.requests.size(); ++i) {
    EXPECT_EQ(a.grading.requests[i].sheet, b.grading.requests[i].sheet);
    EXPECT_EQ(a.grading.requests[i].count, b.grading.requests[i].count);
    ASSERT_TRUE(a.grading.requests[i].law && b.grading.requests[i].law);
    EXPECT_EQ(divide(*a.grading.requests[i].law, 7), divide(*b.grading.requests[i].law, 7));
  }
}

TEST_F(Files, ComeBackToTheLastBit) {
  for (const Skeleton& skeleton : skeletons()) {
    const SkeletonMeshOptions options = options_of(1, 1);
    BlockFile file = block_file(mesh_skeleton(skeleton, options), options);
    file.grading.elements = 5;
    file.grading.axial = 3;
    file.grading.layers = WallLayers{2, 0.1 / 3, true, 1.3};
    file.grading.requests = {{"core.1", 4, TanhLaw{1.0 / 3}}, {"axial.1", 3, UniformLaw{}}};
    write_block_file(file, path("a.json"));
    const BlockFile back = read_block_file(path("a.json"));
    expect_same(file, back);
    write_block_file(back, path("b.json"));
    EXPECT_EQ(bytes(path("a.json")), bytes(path("b.json")));
  }
}

TEST_F(Files, MakeTheMeshOfTheSkeleton) {
  for (const Skeleton& skeleton : skeletons()) {
    for (const int order : {1, 3}) {
      SkeletonMeshOptions options = options_of(order, 2);
      if (order == 3) {
        options.grading.layers = WallLayers{2, 0.04, false, 1.2};
      }
      const SkeletonMesh m = mesh_skeleton(skeleton, options);
      write_block_file(block_file(m, options), path("a.json"));
      const BlockFile file = read_block_file(path("a.json"));
      const HexMesh mesh = mesh_blocks(file, file.grading, options.mesh).mesh;
      ASSERT_EQ(mesh.elements, m.result.mesh.elements);
      EXPECT_EQ(mesh.element_block, m.result.mesh.element_block);
      EXPECT_EQ(mesh.element_branch, m.result.mesh.element_branch);
      EXPECT_EQ(mesh.surfaces, m.result.mesh.surfaces);
      double most = 0;
      for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        most = std::max(most, (mesh.nodes[i] - m.result.mesh.nodes[i]).norm());
      }
      EXPECT_LT(most, 1e-12) << "radii are about 1";
    }
  }
}

TEST_F(Files, PartsOfAllRanksAreTheWhole) {
  for (const Skeleton& skeleton : skeletons()) {
    SkeletonMeshOptions options = options_of(2, 2);
    const BlockFile file = block_file(mesh_skeleton(skeleton, options), options);
    const HexMesh whole = mesh_blocks(file, file.grading, options.mesh).mesh;
    const int per_element = whole.nodes_per_element();
    std::vector<std::vector<int>> elements_at(whole.nodes.size());
    for (int i = 0; i < static_cast<int>(whole.elements.size()); ++i) {
      elements_at[whole.elements[i]].push_back(i / per_element);
    }
    for (const int ranks : {2, 3, 7}) {
      std::vector<int> seen(whole.element_count(), 0);
      for (int rank = 0; rank < ranks; ++rank) {
        const MeshPart part = mesh_part(file, file.grading, options.mesh, rank, ranks);
        const HexMesh& mesh = part.result.mesh;
        EXPECT_EQ(part.total, whole.element_count());
        ASSERT_EQ(part.ids.size(), static_cast<std::size_t>(mesh.element_count()));
        EXPECT_TRUE(std::is_sorted(part.ids.begin(), part.ids.end(), std::less_equal<>()));
        std::set<int> wanted;  // by brute force: the elements at the nodes of the owned ones
        for (int e = 0; e < mesh.element_count(); ++e) {
          const int id = static_cast<int>(part.ids[e]);
          const int* nodes = &whole.elements[static_cast<std::size_t>(id) * per_element];
          for (int i = 0; i < per_element; ++i) {
            // to the last bit
            ASSERT_EQ(mesh.nodes[mesh.elements[static_cast<std::size_t>(e) * per_element + i]],
                      whole.nodes[nodes[i]]);
            if (part.owner[e] == rank) {
              wanted.insert(elements_at[nodes[i]].begin(), elements_at[nodes[i]].end());
            }
          }
          seen[id] += part.owner[e] == rank;
          EXPECT_EQ(mesh.element_block[e], whole.element_block[id]);
        }
        EXPECT_EQ(std::set<int>(part.ids.begin(), part.ids.end()), wanted);
        std::set<std::array<int, 3>> expected, listed;
        for (const auto& f : whole.boundary) {
          if (wanted.count(f.element) > 0) {
            expected.insert({f.element, f.face, f.surface});
          }
        }
        for (const auto& f : mesh.boundary) {
          listed.insert({static_cast<int>(part.ids[f.element]), f.face, f.surface});
        }
        EXPECT_EQ(listed, expected);
      }
      EXPECT_EQ(seen, std::vector<int>(seen.size(), 1)) << "every element has one owner";
    }
  }
}

/// A surface moved to and fro along itself, within less than an element.
class Rippled final : public ImplicitSurface {
 public:
  explicit Rippled(std::shared_ptr<const ImplicitSurface> smooth) : smooth_(std::move(smooth)) {}
  double value(const Vec3& x) const override { return smooth_->value(moved(x)); }
  double value(const Vec3& x, Vec3& gradient) const override {
    Vec3 g;
    const double v = smooth_->value(moved(x), g);
    for (int d = 0; d < 3; ++d) {
      gradient[d] = g[d] + kHigh * kWave * std::cos(kWave * x[d]) * g[(d + 2) % 3];
    }
    return v;
  }
  double radius(const Vec3& x) const override { return smooth_->radius(x); }

 private:
  static constexpr double kHigh = 0.12, kWave = 9;
  static Vec3 moved(const Vec3& x) {
    return x + kHigh * Vec3(std::sin(kWave * x.y()), std::sin(kWave * x.z()), std::sin(kWave * x.x()));
  }
  std::shared_ptr<const ImplicitSurface> smooth_;
};

TEST_F(Files, PartsFitWhereWallsAreRelaxed) {
  for (const int elements : {1, 2, 5}) {
    SCOPED_TRACE(elements);
    const SkeletonMeshOptions options = options_of(4, elements);
    const BlockFile file = block_file(mesh_skeleton(gallery::tube(60, 1), options), options);
    const auto lumen = std::make_shared<Rippled>(make_surface(file));
    const MeshResult result = mesh_blocks(file, file.grading, options.mesh, {}, lumen);
    const HexMesh& whole = result.mesh;
    EXPECT_GT(result.relaxed.nodes, 0);
    const std::size_t per_element = whole.nodes_per_element();
    for (int rank = 0; rank < 8; ++rank) {
      const MeshPart part = mesh_part(file, file.grading, options.mesh, rank, 8, {}, lumen);
      const HexMesh& mesh = part.result.mesh;
      for (std::size_t e = 0; e < part.ids.size(); ++e) {
        for (std::size_t i = 0; i < per_element; ++i) {
          ASSERT_EQ(mesh.nodes[mesh.elements[e * per_element + i]],
                    whole.nodes[whole.elements[part.ids[e] * per_element + i]]);
        }
      }
    }
  }
}

TEST_F(Files, OfLumensNeedTheirSurface) {
  const SkeletonMeshOptions options = options_of(2, 2);
  const BlockFile file = block_file(mesh_skeleton(gallery::linked(6), options), options);
  BlockFile without = file;
  without.surface.reset();
  write_block_file(without, path("a.json"));
  without = read_block_file(path("a.json"));
  EXPECT_FALSE(without.surface);
  EXPECT_NE(error_of([&] { mesh_blocks(without, without.grading, options.mesh); }).find("surface"),
            std::string::npos);
  const HexMesh wanted = mesh_blocks(file, file.grading, options.mesh).mesh;
  const HexMesh mesh = mesh_blocks(without, without.grading, options.mesh, {}, make_surface(file)).mesh;
  ASSERT_EQ(mesh.nodes.size(), wanted.nodes.size());
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    ASSERT_EQ(mesh.nodes[i], wanted.nodes[i]);
  }
}

TEST_F(Files, MoreRanksThanElementsAreRefused) {
  const SkeletonMeshOptions options = options_of(1, 1);
  const BlockFile file = block_file(mesh_skeleton(gallery::tube(4, 1), options), options);
  EXPECT_NE(error_of([&] { mesh_part(file, file.grading, options.mesh, 0, 1000); }).find("1000 ranks"),
            std::string::npos);
}

TEST_F(Files, BadOnesAreRefusedWithTheirPlace) {
  const SkeletonMeshOptions options = options_of(1, 1);
  BlockFile file = block_file(mesh_skeleton(gallery::linked(6), options), options);
  file.grading.requests = {{"core.1", {}, CustomLaw{[](double t) { return t; }}}};
  EXPECT_NE(error_of([&] { write_block_file(file, path("a.json")); }).find("function"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path("a.json")));
  file.grading.requests.clear();
  write_block_file(file, path("a.json"));
  const nlohmann::json good = nlohmann::json::parse(bytes(path("a.json")));
  const auto message_of = [&](const std::string& text) {
    std::ofstream(path("b.json")) << text;
    return error_of([&] { read_block_file(path("b.json")); });
  };
  EXPECT_EQ(message_of(good.dump()), "");
  EXPECT_NE(error_of([&] { read_block_file(path("none.json")); }).find("cannot be opened"), std::string::npos);
  EXPECT_NE(message_of("{\"format\": ").find("not JSON"), std::string::npos);
  EXPECT_NE(message_of("[1, 2]").find("must be an object"), std::string::npos);
  const std::string whole = good.dump();
  for (std::size_t length = 0; length < whole.size(); length += whole.size() / 40) {
    EXPECT_NE(message_of(whole.substr(0, length)), "") << length;
  }
  const auto bad = [&](const std::string& pointer, const nlohmann::json& value, const std::string& place) {
    nlohmann::json j = good;
    j[nlohmann::json::json_pointer(pointer)] = value;
    const std::string message = message_of(j.dump());
    EXPECT_NE(message.find(place), std::string::npos) << pointer << " said: " << message;
    EXPECT_NE(message.find("b.json"), std::string::npos);
  };
  bad("/format", "vasohex-blocks-1", "format is \"vasohex-blocks-1\", must be");
  bad("/degree", 0, "degree is 0, must be a whole number from 1");
  bad("/degree", 3, "must be 64 nodes");
  bad("/nodes/3/1", "x", "nodes[3][1] is \"x\"");
  bad("/blocks/2/vertices/5", 1 << 30, "blocks[2].vertices[5]");
  bad("/blocks/2/vertices/5", -1, "blocks[2].vertices[5]");
  bad("/blocks/2/vertices/5", good["blocks"][2]["vertices"][4], "names a vertex twice");
  bad("/blocks/2/nodes/7", 1.5, "blocks[2].nodes[7] is 1.5");
  bad("/blocks/2/nodes/0", good["blocks"][2]["nodes"][1], "as in the neighbour");
  bad("/blocks/1/directions/0", "round", "blocks[1].directions[0]");
  bad("/blocks/1/region", 1000, "blocks[1].region");
  bad("/boundary/0/1", 6, "boundary[0][1] is 6");
  bad("/boundary/0", good["boundary"][1], "boundary[1] is listed twice");
  bad("/surfaces", nlohmann::json::array({"wall"}), "ends is");
  bad("/regions/0/0/0", 99, "regions[0][0][0] is 99");
  bad("/network/branches/0/radii/1", -1, "network.branches[0].radii[1] is -1, must be > 0");
  bad("/network/branches/0/arc/1", 0, "network.branches[0].arc");
  bad("/network/nodes/0/radius", 0, "network.nodes[0].radius");
  bad("/grading/elements", 0, "grading.elements");
  bad("/units", 5, "units is 5");
  for (const auto& [key, value] : good.items()) {
    if (key != "control_points" && key != "sheets" && key != "surface") {
      nlohmann::json j = good;
      j.erase(key);
      EXPECT_NE(message_of(j.dump()).find("key '" + key + "' is missing"), std::string::npos) << key;
    }
  }
  nlohmann::json fewer = good;
  fewer["boundary"].erase(0);
  EXPECT_NE(message_of(fewer.dump()).find("boundary has"), std::string::npos);
}

}  // namespace
}  // namespace vasohex
