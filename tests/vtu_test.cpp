#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "curved_box.h"
#include "errors.h"
#include "vasohex/core/error.h"
#include "vtk/write_vtu.h"

// What VTK makes of the files is judged by vtu_oracle.py.

namespace vasohex {
namespace {

namespace fs = std::filesystem;

class Vtu : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("vtu_test_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(file(name), std::ios::binary).rdbuf();
    return text.str();
  }
  bool empty() const { return fs::is_empty(folder_); }

 private:
  fs::path folder_;
};

TEST_F(Vtu, NodeOrdersArePermutations) {
  for (int p = 1; p <= 10; ++p) {
    for (std::vector<int> order : {vtk_hex_order(p), vtk_quad_order(p)}) {
      std::sort(order.begin(), order.end());
      for (std::size_t i = 0; i < order.size(); ++i) {
        ASSERT_EQ(order[i], static_cast<int>(i));
      }
    }
    EXPECT_EQ(vtk_hex_order(p).size(), static_cast<std::size_t>((p + 1) * (p + 1) * (p + 1)));
    EXPECT_EQ(vtk_quad_order(p).size(), static_cast<std::size_t>((p + 1) * (p + 1)));
  }
}

TEST_F(Vtu, PointsAreTheNodesBitByBit) {
  HexMesh mesh = curved_box(2, {1, 2, 1});
  mesh.units = "m -- really";
  mesh.element_block.clear();
  mesh.element_branch.clear();
  write_vtu(mesh, file("a.vtu"));
  const std::string text = read("a.vtu");
  EXPECT_EQ(text.find("Name=\"block\""), std::string::npos);
  EXPECT_NE(text.find("lengths in m"), std::string::npos);
  EXPECT_EQ(text.find("--", 0), text.find("<!--") + 2);
  // the points come first, behind the number of their bytes
  const char* appended = text.data() + text.find("<AppendedData encoding=\"raw\">\n_") +
                         std::strlen("<AppendedData encoding=\"raw\">\n_");
  std::uint64_t bytes;
  std::memcpy(&bytes, appended, sizeof bytes);
  ASSERT_EQ(bytes, mesh.nodes.size() * sizeof(Vec3));
  EXPECT_EQ(std::memcmp(appended + sizeof bytes, mesh.nodes.data(), bytes), 0);
}

TEST_F(Vtu, RefusesWhatItCannotWrite) {
  const auto error = [&](const HexMesh& mesh, const std::string& path) {
    return error_of([&] { write_vtu(mesh, path); });
  };
  EXPECT_NE(error(curved_box(11, {1, 1, 1}), file("a.vtu")).find("orders 1 to 10"), std::string::npos);
  const HexMesh lobatto = curved_box(3, {1, 1, 1}, NodeFamily::gauss_lobatto);
  EXPECT_NE(error(lobatto, file("a.vtu")).find("equispaced"), std::string::npos);
  EXPECT_NE(error_of([&] { write_vtu_boundary(lobatto, file("a.vtu")); }).find("equispaced"), std::string::npos);
  const HexMesh mesh = curved_box(1, {1, 1, 1});
  EXPECT_NE(error(mesh, file("none/a.vtu")).find("none/a.vtu"), std::string::npos);
  const std::vector<double> values(2);
  const CellScalars scalars[] = {{"quality", values}};
  EXPECT_NE(error_of([&] { write_vtu(mesh, file("a.vtu"), scalars); }).find("quality"), std::string::npos);
  vasohex::Run stop;
  stop.on_progress = [](std::string_view, double) { return false; };
  EXPECT_THROW(write_vtu(mesh, file("a.vtu"), {}, stop), Error);
  EXPECT_TRUE(empty());
}

}  // namespace
}  // namespace vasohex
