#include <gmsh.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "curved_box.h"
#include "errors.h"
#include "gmsh/node_order.h"
#include "gmsh/read_msh.h"
#include "gmsh/write_msh.h"
#include "vasohex/core/atomic_file.h"

namespace vasohex {
namespace {

namespace fs = std::filesystem;

class Msh : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("msh_test_" + std::string(test_name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t files() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }
  void put(const std::string& name, const std::string& text) const { std::ofstream(file(name)) << text; }

 private:
  static const char* test_name() { return testing::UnitTest::GetInstance()->current_test_info()->name(); }
  fs::path folder_;
};

class Gmsh {
 public:
  Gmsh() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
  }
  ~Gmsh() { gmsh::finalize(); }
};

void expect_error_of_read(const std::string& path, const std::string& part) {
  SCOPED_TRACE(path);
  const std::string message = error_of([&] { read_msh(path); });
  EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_NE(message.find(path), std::string::npos) << message;
}

TEST_F(Msh, NodeOrdersAreGmshs) {
  const Gmsh session;
  for (int p = 1; p <= kGmshMaxOrder; ++p) {
    EXPECT_EQ(gmsh_hex_type(p), gmsh::model::mesh::getElementType("Hexahedron", p));
    EXPECT_EQ(gmsh_quad_type(p), gmsh::model::mesh::getElementType("Quadrangle", p));
    for (const int dimension : {2, 3}) {
      std::string name;
      int dim, order, count, primary;
      std::vector<double> local;
      gmsh::model::mesh::getElementProperties(dimension == 3 ? gmsh_hex_type(p) : gmsh_quad_type(p), name, dim, order,
                                              count, local, primary);
      std::vector<int> wanted;
      for (int g = 0; g < count; ++g) {
        int index = 0;
        for (int d = dimension - 1; d >= 0; --d) {
          index = index * (p + 1) + static_cast<int>(std::lround((local[dimension * g + d] + 1) / 2 * p));
        }
        wanted.push_back(index);
      }
      EXPECT_EQ(dimension == 3 ? gmsh_hex_order(p) : gmsh_quad_order(p), wanted) << name;
    }
  }
}

/// Points that Gmsh computes at parametric coordinates in [0,1]^d: [elements][samples].
std::vector<Vec3> gmsh_points(int type, int entity, const std::vector<Vec3>& samples) {
  std::vector<double> local, jacobians, determinants, xyz;
  for (const Vec3& s : samples) {
    for (int d = 0; d < 3; ++d) {
      local.push_back(2 * s[d] - 1);
    }
  }
  gmsh::model::mesh::getJacobians(type, local, jacobians, determinants, xyz, entity);
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    result.emplace_back(xyz[i], xyz[i + 1], xyz[i + 2]);
  }
  return result;
}

TEST_F(Msh, GmshSeesTheWrittenShape) {
  const std::array<int, 3> cells{2, 1, 3};
  for (int p = 1; p <= kGmshMaxOrder; ++p) {
    const HexMesh mesh = curved_box(p, cells);
    write_msh(mesh, file("box.msh"));
    const Gmsh session;
    gmsh::open(file("box.msh"));

    const auto parameter = [&](int element, const Vec3& s) {
      const Vec3 cell(element % cells[0], element / cells[0] % cells[1], element / cells[0] / cells[1]);
      return Vec3((cell + s).array() / Vec3(cells[0], cells[1], cells[2]).array());
    };
    const std::vector<Vec3> samples{Vec3(0, 0, 0), Vec3(0.3, 0.1, 0.9), Vec3(0.7, 0.8, 0.2)};
    const std::vector<Vec3> inside = gmsh_points(gmsh_hex_type(p), 4, samples);
    ASSERT_EQ(inside.size(), mesh.element_count() * samples.size());
    // Gmsh's own polynomials lose digits: 1e-5 at order 9
    const double tolerance = p <= 5 ? 1e-9 : 1e-4;
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const Vec3 wanted =
          curved_box_point(p, parameter(static_cast<int>(i / samples.size()), samples[i % samples.size()]));
      EXPECT_LT((inside[i] - wanted).norm(), tolerance) << "order " << p << " sample " << i;
    }

    for (int s = 0; s < 3; ++s) {
      std::vector<Vec3> wanted;
      for (const HexMesh::BoundaryFace& b : mesh.boundary) {
        if (b.surface == s) {
          const auto [a0, a1] = hex_face_axes(b.face);
          for (const Vec3& sample : samples) {
            Vec3 at = Vec3::Zero();
            at[b.face / 2] = b.face % 2;
            at[a0] = sample[0];
            at[a1] = sample[1];
            wanted.push_back(curved_box_point(p, parameter(b.element, at)));
          }
        }
      }
      const std::vector<Vec3> faces = gmsh_points(gmsh_quad_type(p), s + 1, samples);
      ASSERT_EQ(faces.size(), wanted.size());
      for (std::size_t i = 0; i < faces.size(); ++i) {
        EXPECT_LT((faces[i] - wanted[i]).norm(), tolerance) << "order " << p << " surface " << s;
      }
    }

    std::string name;
    gmsh::model::getPhysicalName(2, 1, name);
    EXPECT_EQ(name, "wall");
    gmsh::model::getPhysicalName(3, 4, name);
    EXPECT_EQ(name, "lumen");
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(2, 3, entities);
    EXPECT_EQ(entities, std::vector<int>{3});
  }
}

TEST_F(Msh, GmshIntegratesTheVolume) {
  // of curved_box_point, integrated by exact rational arithmetic
  const double exact[] = {2779. / 960, 6991. / 2400, 981797. / 336000, 35131. / 12000, 1083433. / 369600};
  for (int p = 1; p <= 5; ++p) {
    write_msh(curved_box(p, {2, 2, 1}), file("box.msh"));
    const Gmsh session;
    gmsh::open(file("box.msh"));
    std::vector<double> local, weights, jacobians, determinants, xyz;
    gmsh::model::mesh::getIntegrationPoints(gmsh_hex_type(p), "Gauss" + std::to_string(3 * p), local, weights);
    gmsh::model::mesh::getJacobians(gmsh_hex_type(p), local, jacobians, determinants, xyz);
    double volume = 0;
    for (std::size_t i = 0; i < determinants.size(); ++i) {
      volume += determinants[i] * weights[i % weights.size()];
    }
    EXPECT_NEAR(volume, exact[p - 1], 1e-11) << "order " << p;
  }
}

TEST_F(Msh, ReadsBackWhatWasWritten) {
  for (const int p : {1, 2, 3, 6}) {
    const HexMesh mesh = curved_box(p, {2, 3, 2});
    write_msh(mesh, file("box.msh"));
    const HexMesh again = read_msh(file("box.msh"));
    EXPECT_EQ(again.order, p);
    EXPECT_EQ(again.family, NodeFamily::equispaced);
    EXPECT_EQ(again.nodes, mesh.nodes);
    EXPECT_EQ(again.elements, mesh.elements);
    EXPECT_EQ(again.surfaces, mesh.surfaces);
    EXPECT_EQ(again.volume, mesh.volume);
    EXPECT_TRUE(again.element_block.empty() && again.element_branch.empty());
    ASSERT_EQ(again.boundary.size(), mesh.boundary.size());
    for (std::size_t b = 0; b < mesh.boundary.size(); ++b) {
      EXPECT_EQ(again.boundary[b].element, mesh.boundary[b].element);
      EXPECT_EQ(again.boundary[b].face, mesh.boundary[b].face);
      EXPECT_EQ(again.boundary[b].surface, mesh.boundary[b].surface);
    }
  }
}

TEST_F(Msh, KeepsUntaggedFacesAndNames) {
  HexMesh mesh = curved_box(2, {1, 1, 2});
  mesh.surfaces = {"a \"b\"", "unused", ""};
  for (HexMesh::BoundaryFace& b : mesh.boundary) {
    b.surface = b.surface == 0 ? 0 : 2;
  }
  mesh.boundary.pop_back();
  write_msh(mesh, file("box.msh"));
  const HexMesh again = read_msh(file("box.msh"));
  EXPECT_EQ(again.surfaces, (std::vector<std::string>{"a 'b'", "unused", "surface_3", "untagged"}));
  ASSERT_EQ(again.boundary.size(), 10u);
  EXPECT_EQ(std::count_if(again.boundary.begin(), again.boundary.end(), [](const auto& b) { return b.surface == 3; }),
            1);
}

const char* const kHeader = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const char* const kCube =
    "$Nodes\n9\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n9 5 5 5\n$EndNodes\n";

TEST_F(Msh, ReadsPlainMsh2) {
  put("cube.MSH",
      std::string(kHeader) + kCube +
          "$Elements\n3\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 3 2 7 1 5 6 7 8\n3 3 2 7 1 8 7 6 5\n$EndElements\n");
  vasohex::Run run;
  std::string log;
  run.on_log = [&](std::string_view line) { log += line; };
  const HexMesh mesh = read_msh(file("cube.MSH"), run);
  EXPECT_EQ(mesh.nodes.size(), 8u);
  for (int at = 0; at < 8; ++at) {
    EXPECT_EQ(mesh.nodes[mesh.elements[at]], Vec3(at & 1, at >> 1 & 1, at >> 2));
  }
  EXPECT_EQ(mesh.surfaces, (std::vector<std::string>{"surface_7", "untagged"}));
  ASSERT_EQ(mesh.boundary.size(), 6u);
  EXPECT_EQ(mesh.boundary[5].surface, 0);
  EXPECT_EQ(mesh.boundary[4].surface, 1);
  EXPECT_NE(log.find("1 quadrangles"), std::string::npos) << log;
}

TEST_F(Msh, RefusesWhatItCannotRead) {
  expect_error_of_read(file("none.msh"), "no such file");
  put("mesh.txt", std::string(kHeader) + kCube);
  expect_error_of_read(file("mesh.txt"), ".msh");
  put("script.msh", "SystemCall \"touch " + file("owned") + "\";\n");
  expect_error_of_read(file("script.msh"), "$MeshFormat");
  EXPECT_FALSE(fs::exists(file("owned")));
  put("empty.msh", "");
  expect_error_of_read(file("empty.msh"), "$MeshFormat");
  put("old.msh", "$MeshFormat\n1 0 8\n");
  expect_error_of_read(file("old.msh"), "4.1");
  put("nodes.msh", std::string(kHeader) + kCube + "$Elements\n0\n$EndElements\n");
  expect_error_of_read(file("nodes.msh"), "no hexahedra");
  put("tet.msh",
      std::string(kHeader) + kCube + "$Elements\n2\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 4 2 1 1 1 2 3 9\n$EndElements\n");
  expect_error_of_read(file("tet.msh"), "Tetrahedron");
  put("tri.msh",
      std::string(kHeader) + kCube + "$Elements\n2\n1 5 2 1 1 1 2 3 4 5 6 7 8\n2 2 2 7 1 1 2 3\n$EndElements\n");
  expect_error_of_read(file("tri.msh"), "Triangle");
  put("nan.msh", std::string(kHeader) +
                     "$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1e999\n8 0 1 1\n"
                     "$EndNodes\n$Elements\n1\n1 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n");
  EXPECT_NE(error_of([&] { read_msh(file("nan.msh")); }), "");
  {
    const Gmsh session;
    gmsh::model::occ::addBox(0, 0, 0, 1, 1, 1);
    gmsh::model::occ::synchronize();
    gmsh::vectorpair all;
    gmsh::model::getEntities(all, 1);
    for (const auto& [dimension, tag] : all) {
      gmsh::model::mesh::setTransfiniteCurve(tag, 2);
    }
    gmsh::model::getEntities(all, 2);
    for (const auto& [dimension, tag] : all) {
      gmsh::model::mesh::setTransfiniteSurface(tag);
      gmsh::model::mesh::setRecombine(2, tag);
    }
    gmsh::model::mesh::setTransfiniteVolume(1);
    gmsh::option::setNumber("Mesh.SecondOrderIncomplete", 1);
    gmsh::model::mesh::generate(3);
    gmsh::model::mesh::setOrder(2);
    gmsh::write(file("serendipity.msh"));
  }
  expect_error_of_read(file("serendipity.msh"), "Mesh.SecondOrderIncomplete");
  for (const char* entity : {"1", "2"}) {  // of the second hexahedron; Gmsh shows it in the second case only
    std::string mixed = kHeader;
    mixed += "$Nodes\n35\n";
    for (int i = 1; i <= 35; ++i) {
      mixed.append(std::to_string(i)).append(" 0 0 0\n");
    }
    mixed.append("$EndNodes\n$Elements\n2\n1 5 2 1 1 28 29 30 31 32 33 34 35\n2 12 2 1 ").append(entity);
    for (int i = 1; i <= 27; ++i) {
      mixed.append(" ").append(std::to_string(i));
    }
    put("mixed.msh", mixed + "\n$EndElements\n");
    expect_error_of_read(file("mixed.msh"), "several orders");
  }
}

TEST_F(Msh, RefusesWhatItCannotWrite) {
  const auto error = [&](const HexMesh& mesh, const std::string& path) {
    return error_of([&] { write_msh(mesh, path); });
  };
  EXPECT_NE(error(curved_box(10, {1, 1, 1}), file("a.msh")).find("orders 1 to 9"), std::string::npos);
  EXPECT_NE(error(curved_box(3, {1, 1, 1}, NodeFamily::gauss_lobatto), file("a.msh")).find("equispaced"),
            std::string::npos);
  EXPECT_EQ(error(curved_box(2, {1, 1, 1}, NodeFamily::gauss_lobatto), file("a.msh")), "");
  fs::remove(file("a.msh"));
  const HexMesh mesh = curved_box(1, {1, 1, 1});
  EXPECT_NE(error(mesh, file("none/a.msh")).find("create it"), std::string::npos);
  fs::create_directory(file("folder.msh"));
  EXPECT_NE(error(mesh, file("folder.msh")).find("folder"), std::string::npos);
  fs::remove(file("folder.msh"));
  EXPECT_EQ(files(), 0u);
}

TEST_F(Msh, OutputIsCompleteOrNotThere) {
  put("old", "old");
  {
    AtomicFile out(file("old"));
    out.stream() << "new";
  }
  std::ostringstream text;
  text << std::ifstream(file("old")).rdbuf();
  EXPECT_EQ(text.str(), "old");
  EXPECT_EQ(files(), 1u);

  vasohex::Run stop;
  stop.on_progress = [](std::string_view, double) { return false; };
  EXPECT_THROW(write_msh(curved_box(1, {1, 1, 1}), file("a.msh"), stop), Error);
  EXPECT_EQ(files(), 1u);

  // the file that a link names is replaced, the link stays
  fs::create_symlink(file("old"), file("link"));
  AtomicFile out(file("link"));
  out.stream() << "new";
  out.commit();
  EXPECT_TRUE(fs::is_symlink(file("link")));
  EXPECT_EQ(fs::file_size(file("old")), 3u);
  EXPECT_EQ(files(), 2u);
  text.str("");
  text << std::ifstream(file("old")).rdbuf();
  EXPECT_EQ(text.str(), "new");

  if (fs::exists("/dev/full")) {
    EXPECT_NE(error_of([] { AtomicFile("/dev/full"); }).find("not a regular file"), std::string::npos);
  }
}

}  // namespace
}  // namespace vasohex
