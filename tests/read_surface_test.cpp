#include "vasohex/surface/read_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "errors.h"

namespace vasohex {
namespace {

/// A tetrahedron, one point of it not representable in single precision.
TriSurface tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1.1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, ""};
}

std::string ascii_stl(const TriSurface& s) {
  std::string text = "solid lumen of two words\n";
  for (const auto& t : s.triangles) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const int p : t) {
      text += "   vertex";
      for (int d = 0; d < 3; ++d) {
        text += " " + std::to_string(s.points[p][d]);
      }
      text += "\n";
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid\n";
}

template <class T>
void append(std::string& bytes, T value, bool big = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big != (std::endian::native == std::endian::big)) {
    std::reverse(raw, raw + sizeof value);
  }
  bytes.append(raw, sizeof value);
}

std::string binary_stl(const TriSurface& s) {
  std::string bytes = "solid, but binary";
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(s.triangles.size()));
  for (const auto& t : s.triangles) {
    bytes.append(12, '\0');
    for (const int p : t) {
      for (int d = 0; d < 3; ++d) {
        append(bytes, static_cast<float>(s.points[p][d]));
      }
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string binary_ply(const TriSurface& s, bool big) {
  std::string bytes = "ply\nformat " + std::string(big ? "binary_big_endian" : "binary_little_endian") +
                      " 1.0\ncomment a lumen\nelement vertex " + std::to_string(s.points.size()) +
                      "\nproperty uchar red\nproperty double x\nproperty double y\nproperty float z\n"
                      "element edge 1\nproperty int vertex1\n"
                      "element face " +
                      std::to_string(s.triangles.size()) +
                      "\nproperty short patch\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& p : s.points) {
    append(bytes, std::uint8_t{10}, big);
    append(bytes, p[0], big);
    append(bytes, p[1], big);
    append(bytes, static_cast<float>(p[2]), big);
  }
  append(bytes, std::int32_t{10}, big);
  for (const auto& t : s.triangles) {
    append(bytes, std::int16_t{-1}, big);
    append(bytes, std::uint8_t{3}, big);
    for (const int p : t) {
      append(bytes, std::int32_t{p}, big);
    }
  }
  return bytes;
}

/// The same triangles at the same places; points may be numbered otherwise.
void expect_same(const TriSurface& got, const TriSurface& expected, double tolerance) {
  EXPECT_EQ(got.points.size(), expected.points.size());
  ASSERT_EQ(got.triangles.size(), expected.triangles.size());
  for (std::size_t t = 0; t < got.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_LE((got.points[got.triangles[t][c]] - expected.points[expected.triangles[t][c]]).norm(), tolerance);
    }
  }
}

TEST(ReadSurface, EveryFormatHoldsTheSameTriangles) {
  const TriSurface s = tetrahedron();
  expect_same(parse_stl(ascii_stl(s)), s, 0);
  expect_same(parse_stl(binary_stl(s)), s, 1e-7);
  expect_same(parse_ply(binary_ply(s, false)), s, 0);
  expect_same(parse_ply(binary_ply(s, true)), s, 0);
  expect_same(parse_ply("ply\r\nformat ascii 1.0\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\n"
                        "property float z\r\nelement face 4\r\nproperty list uchar int vertex_index\r\nend_header\r\n"
                        "0 0 0\r\n1 0 0\r\n0 1.1 0\r\n0 0 1\r\n3 0 2 1\r\n3 0 1 3\r\n3 1 2 3\r\n3 2 0 3\r\n"),
              s, 0);
  expect_same(parse_obj("# lumen\nmtllib none.mtl\no a\nv 0 0 0\nv 1 0 0 1.0\nv 0 1.1e0 0\nvn 0 0 1\nv 0 0 1\n"
                        "f 1 3 2\nf 1/5 2/5 4/5\nf -3//1 -2//1 -1//1\nf 3/1/1 1/1/1 4/1/1"),
              s, 0);
  expect_same(parse_off("OFF\n# counts\n4 4 6\n0 0 0\n1 0 0\n0 1.1 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n\n3 1 2 3\n"
                        "3 2 0 3\n"),
              s, 0);
}

TEST(ReadSurface, QuadrilateralsAreSplitAtTheShorterDiagonal) {
  const std::string points = "OFF 4 1 0\n0 0 0\n3 0 0\n4 1 0\n1 1 0\n";
  const TriSurface a = parse_off(points + "4 0 1 2 3\n"), b = parse_off(points + "4 1 2 3 0\n");
  for (const TriSurface& s : {a, b}) {
    ASSERT_EQ(s.triangles.size(), 2u);
    for (const auto& t : s.triangles) {  // the diagonal from 1 to 3 is in both, both face +z
      EXPECT_EQ(std::count(t.begin(), t.end(), 1) + std::count(t.begin(), t.end(), 3), 2);
      EXPECT_GT((s.points[t[1]] - s.points[t[0]]).cross(s.points[t[2]] - s.points[t[0]]).z(), 0);
    }
  }
}

TEST(ReadSurface, FacesThatNoManifoldHasAreKept) {
  // three triangles at one edge, one of them twice
  EXPECT_EQ(parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 5\n")
                .triangles.size(),
            4u);
}

TEST(ReadSurface, ErrorsNameThePlace) {
  const TriSurface s = tetrahedron();
  const auto stl = [&](const std::string& bytes) { return error_of([&] { parse_stl(bytes); }); };
  const auto ply = [&](const std::string& bytes) { return error_of([&] { parse_ply(bytes); }); };
  const auto obj = [&](const std::string& bytes) { return error_of([&] { parse_obj(bytes); }); };
  const auto off = [&](const std::string& bytes) { return error_of([&] { parse_off(bytes); }); };

  const std::string ascii = ascii_stl(s), binary = binary_stl(s);
  std::string nan = ascii;
  nan.replace(nan.find("1.1"), 3, "nan");
  EXPECT_EQ(stl(nan), "line 5: y is 'nan00000', must be a finite number");
  EXPECT_EQ(stl(ascii.substr(0, ascii.find("\n  endloop"))),
            "line 6: the file ends within a facet, after 0 triangles; it seems cut off");
  EXPECT_EQ(stl(ascii.substr(0, ascii.find("endsolid"))),
            "line 29: the file ends without endsolid, after 4 triangles; it seems cut off");
  EXPECT_EQ(stl("solid\nfacet\nvertex 0 0 0\nendfacet\nendsolid"), "line 4: a facet has 1 vertices, must have 3");
  EXPECT_EQ(stl(binary.substr(0, 84 + 2 * 50 + 17)),
            "cut off after triangle 2 of the 4 that the header of the binary STL names");
  std::string infinite = binary;
  const float inf = std::numeric_limits<float>::infinity();
  std::memcpy(infinite.data() + 84 + 3 * 50 + 12, &inf, 4);
  EXPECT_EQ(stl(infinite), "triangle 3, counted from 0: a coordinate is not a finite number");
  EXPECT_EQ(stl("nothing"),
            "neither an ASCII STL, which starts with solid, nor a binary one, whose header has 84 bytes");

  const std::string little = binary_ply(s, false);
  EXPECT_EQ(ply(little.substr(0, little.size() - 1)), "face 3 of 4, counted from 0: the file ends here");
  EXPECT_EQ(ply("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                "end_header\n0 0 0\n0 0\n"),
            "line 9: vertex 1 of 2, counted from 0: z is missing");
  EXPECT_EQ(ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 7\n"),
            "line 11: face 0 of 1, counted from 0: a face has point 7, counted from 0, but there are 1 points");
  EXPECT_EQ(ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n"),
            "line 4: 'half' is not a type of PLY (char, uchar, short, ushort, int, uint, float, double)");
  EXPECT_EQ(ply("ply\nformat ascii 1.0\n"), "line 2: the header does not end with end_header");

  EXPECT_EQ(obj("v 0 0 0\nv 1 x 0\n"), "line 2: y is 'x', must be a finite number");
  EXPECT_EQ(obj("v 0 0 0\nf 1 1 2\n"), "line 2: a face has point 1, counted from 0, but there are 1 points");
  EXPECT_EQ(obj("v 0 0 0\nf 0 1 1\n"), "line 2: a face has point 0; OBJ counts from 1");
  EXPECT_EQ(obj("v 0 0 0\nf 1 1 1 1 1\n"), "line 2: a face with 5 corners; must be a triangle or a quadrilateral");
  EXPECT_EQ(off("OFF\n2 1 0\n0 0 0\n"), "line 3: the file ends after 1 of 2 points");
  EXPECT_EQ(off("STOFF\n2 1 0\n0 0 0\n"),
            "line 1: 'STOFF' is a kind that is not known; known are OFF, NOFF, COFF, CNOFF");
}

TEST(ReadSurface, FilesAreReadByTheirExtension) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "vasohex_read_surface";
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return (folder / name).string();
  };
  expect_same(read_surface(write("a.STL", binary_stl(tetrahedron()))), tetrahedron(), 1e-7);
  expect_same(read_surface(write("a.ply", binary_ply(tetrahedron(), true))), tetrahedron(), 0);
  const auto error = [&](const std::string& path) { return error_of([&] { read_surface(path); }); };
  const std::string empty = write("empty.off", "");
  EXPECT_EQ(error(empty), "surface " + empty + ": the file is empty; must hold triangles");
  const std::string points = write("points.obj", "v 0 0 0\n");
  EXPECT_EQ(error(points), "surface " + points + ": no triangles; at least one is needed");
  EXPECT_EQ(error("a.step"),
            "surface a.step: a surface cannot be read from the extension '.step'; known are .stl, "
            ".ply, .obj and .off");
  EXPECT_EQ(error("none.stl"), "surface none.stl: cannot be opened; check that it exists and may be read");
  std::filesystem::remove_all(folder);
}

/// Whatever bytes: a surface or an Error, no crash and no point outside of the arrays.
TEST(ReadSurface, SurvivesDamagedFiles) {
  const std::string seeds[] = {ascii_stl(tetrahedron()), binary_stl(tetrahedron()), binary_ply(tetrahedron(), false),
                               "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n4 0 1 2 3\n",
                               "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2 3\n"};
  std::uint32_t state = 1;
  const auto random = [&](std::size_t n) {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % n;
  };
  TriSurface (*parsers[])(std::string_view) = {parse_stl, parse_stl, parse_ply, parse_off, parse_obj};
  for (int round = 0; round < 4000; ++round) {
    const int k = round % 5;
    std::string bytes = seeds[k];
    for (std::size_t change = random(4) + 1; change-- > 0;) {
      if (random(4) == 0) {
        bytes.resize(random(bytes.size()) + 1);
      } else {
        bytes[random(bytes.size())] = random(2) == 0 ? static_cast<char>(random(256)) : "0123456789-. \n"[random(14)];
      }
    }
    try {
      const TriSurface s = parsers[k](bytes);
      for (const auto& t : s.triangles) {
        for (const int p : t) {
          ASSERT_GE(p, 0);
          ASSERT_LT(p, static_cast<int>(s.points.size()));
        }
      }
      for (const Vec3& p : s.points) {
        ASSERT_TRUE(p.allFinite());
      }
    } catch (const Error& e) {
      ASSERT_EQ(e.code(), ErrorCode::bad_input);
    }
  }
}

}  // namespace
}  // namespace vasohex
