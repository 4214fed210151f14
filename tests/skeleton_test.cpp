#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <set>

#include "errors.h"
#include "gallery.h"
#include "vasohex/core/error.h"
#include "vasohex/quality/quality_report.h"
#include "vasohex/skeleton/build_network.h"
#include "vasohex/skeleton/read_skeleton.h"
#include "vasohex/vasohex.h"

namespace vasohex {
namespace {

constexpr double kPi = std::numbers::pi;

std::string written(const std::string& name, const std::string& text) {
  const std::string path = (std::filesystem::path(testing::TempDir()) / name).string();
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

int lines_with(const Network& network, const std::string& part) {
  return static_cast<int>(std::count_if(network.repairs.begin(), network.repairs.end(),
                                        [&](const std::string& line) { return has(line, part); }));
}

void add_chain(Skeleton& skeleton, const std::vector<int>& chain) {
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    skeleton.segments.push_back({chain[i], chain[i + 1]});
  }
}

/// A skeleton of one branch, points curve(0), curve(1), ..
template <class Curve>
Skeleton one_branch(int n, double radius, Curve&& curve) {
  Skeleton skeleton;
  std::vector<int> chain;
  for (int i = 0; i < n; ++i) {
    skeleton.points.push_back(curve(i));
    skeleton.radii.push_back(radius);
    chain.push_back(i);
  }
  add_chain(skeleton, chain);
  return skeleton;
}

/// Tubes of n points from a centre along the directions.
Skeleton star(const std::vector<Vec3>& directions, double radius, double spacing, int n) {
  Skeleton skeleton;
  skeleton.points.push_back(Vec3::Zero());
  skeleton.radii.push_back(radius);
  for (const Vec3& d : directions) {
    std::vector<int> chain{0};
    for (int i = 1; i <= n; ++i) {
      chain.push_back(static_cast<int>(skeleton.points.size()));
      skeleton.points.push_back(i * spacing * d.normalized());
      skeleton.radii.push_back(radius);
    }
    add_chain(skeleton, chain);
  }
  return skeleton;
}

/// What every network promises.
void expect_sound(const Network& network) {
  std::vector<int> degree(network.nodes.size(), 0);
  for (const Branch& b : network.branches) {
    ASSERT_GE(b.points.size(), 5u);
    ASSERT_EQ(b.radii.size(), b.points.size());
    ASSERT_EQ(b.tangents.size(), b.points.size());
    ASSERT_EQ(b.arc.size(), b.points.size());
    EXPECT_EQ(b.arc[0], 0.0);
    EXPECT_EQ(b.points.front(), network.nodes[b.nodes[0]].position);
    EXPECT_EQ(b.points.back(), network.nodes[b.nodes[1]].position);
    ++degree[b.nodes[0]];
    ++degree[b.nodes[1]];
    for (std::size_t i = 0; i < b.points.size(); ++i) {
      ASSERT_TRUE(b.points[i].allFinite());
      ASSERT_GT(b.radii[i], 0);
      ASSERT_NEAR(b.tangents[i].norm(), 1, 1e-12);
    }
    for (std::size_t i = 0; i + 1 < b.points.size(); ++i) {
      const double step = b.arc[i + 1] - b.arc[i], chord = (b.points[i + 1] - b.points[i]).norm();
      ASSERT_GT(step, 0);
      ASSERT_LE(step, 0.5 * std::min(b.radii[i], b.radii[i + 1]) * (1 + 1e-9));
      ASSERT_LE(chord, step * (1 + 1e-9));
      ASSERT_GE(chord, step * 0.98);
      ASSERT_LE(std::abs(b.radii[i + 1] - b.radii[i]), 2.5 * step);
    }
  }
  std::set<std::string> names;
  int ends = 0;
  for (std::size_t n = 0; n < network.nodes.size(); ++n) {
    const NetworkNode& node = network.nodes[n];
    EXPECT_EQ(node.degree, degree[n]);
    EXPECT_NE(node.degree, 0);
    EXPECT_EQ(node.seam, node.degree == 2);
    EXPECT_GT(node.radius, 0);
    EXPECT_EQ(node.name.empty(), node.degree != 1);
    if (node.degree == 1) {
      ++ends;
      names.insert(node.name);
    }
    if (n > 0) {
      EXPECT_LT(network.nodes[n - 1].point, node.point);
    }
  }
  EXPECT_EQ(static_cast<int>(names.size()), ends);
}

double largest_distance(const Branch& branch, const std::function<double(const Vec3&)>& distance) {
  double largest = 0;
  for (int i = 0; i <= 1000; ++i) {
    largest = std::max(largest, distance(axis_point(branch, branch.length() * i / 1000).position));
  }
  return largest;
}

// ---------------------------------------------------------------------------------------------------- readers

TEST(ReadSwc, PointsRadiiSegmentsRootUnits) {
  const Skeleton s = parse_swc(
      "# a comment\r\n# units: cm\n\n  7 3 1e0 2 3 .5 9\n9\t3\t0 0 -1 +0.25 -1  \n0 3 1 1 1 2 7\n12 0 5 5 5 1 -1\n");
  ASSERT_EQ(s.points.size(), 4u);
  EXPECT_EQ(s.points[0], Vec3(1, 2, 3));
  EXPECT_EQ(s.radii, (std::vector<double>{.5, .25, 2, 1}));
  EXPECT_EQ(s.segments, (std::vector<std::array<int, 2>>{{1, 0}, {0, 2}}));
  EXPECT_EQ(s.root, 1);
  EXPECT_EQ(s.units, "cm");
}

TEST(ReadSwc, Errors) {
  const auto message = [](const std::string& text) {
    return error_of([&] { read_skeleton(written("bad.swc", text)); });
  };
  const std::vector<std::array<std::string, 3>> cases{
      {"", "no points", "id type x y z radius parent"},
      {"# units: mm\n", "no points", "bad.swc"},
      {"1 0 0 0 0 1 -1\n2 0 0 0 1 -0.3 1\n", "line 2: radius -0.3 at node 2 (0 0 1)", "must be > 0"},
      {"1 0 0 0 0 0 -1\n2 0 0 0 1 1 1\n", "line 1: radius 0 at node 1", "must be > 0"},
      {"1 0 0 nan 0 1 -1\n2 0 0 0 1 1 1\n", "line 1: y is 'nan'", "finite"},
      {"1 0 0 0 0 inf -1\n2 0 0 0 1 1 1\n", "line 1: radius is 'inf'", "finite"},
      {"1 0 0 0 1e999 1 -1\n2 0 0 0 1 1 1\n", "line 1: z is '1e999'", "finite"},
      {"1 0 0 0 0x1 1 -1\n", "line 1: z is '0x1'", "finite"},
      {"1 0 0 0 0 1 -1\n2 0 0 0 1 1\n", "line 2: 6 columns", "must be 7"},
      {"1 0 0 0 0 1 -1 8\n", "line 1: 8 columns", "must be 7"},
      {"1 0 0 0 0 1 -1\n2 0 0 0 1 1 5\n", "line 2: node 2 has the parent 5", "does not contain"},
      {"1 0 0 0 0 1 -1\n1 0 0 0 1 1 1\n", "line 2: node 1 is its own parent", "root"},
      {"1 0 0 0 0 1 -1\n2 0 0 0 1 1 1\n2 0 0 0 2 1 1\n", "line 3: node 2 is already given on line 2", "once"},
      {"1 0 0 0 0 1 3\n2 0 0 0 1 1 1\n3 0 0 0 2 1 2\n", "node 1 is its own ancestor", "line 1"},
      {"1 0 0 0 0 1 -1\n2 0 0 0 1 1 3\n3 0 0 0 2 1 2\n", "is its own ancestor", "line 2"},
      {"1 0 0 0 0 1 -1\n2 0 0 0 1 1 -1\n", "no segments", "parent"},
      {"1.5 0 0 0 0 1 -1\n", "line 1: id is '1.5'", "integer"},
      {"a 0 0 0 0 1 -1\n", "line 1: id is 'a'", "number"},
      {"-4 0 0 0 0 1 -1\n", "line 1: id is -4", ">= 0"},
  };
  for (const auto& [text, first, second] : cases) {
    const std::string what = message(text);
    EXPECT_TRUE(has(what, "bad.swc")) << what;
    EXPECT_TRUE(has(what, first)) << what << "\n" << text;
    EXPECT_TRUE(has(what, second)) << what << "\n" << text;
  }
}

TEST(ReadSkeleton, FilesThatCannotBeRead) {
  EXPECT_TRUE(has(error_of([] { read_skeleton("/nowhere/a.swc"); }), "/nowhere/a.swc: cannot be opened"));
  EXPECT_TRUE(has(error_of([] { read_skeleton("a.vtp"); }), "known are .swc and .json"));
  EXPECT_TRUE(has(error_of([] { read_skeleton("a"); }), "known are .swc and .json"));
  const std::string folder = (std::filesystem::path(testing::TempDir()) / "folder.json").string();
  std::filesystem::create_directories(folder);
  EXPECT_TRUE(has(error_of([&] { read_skeleton(folder); }), "is a directory"));
  EXPECT_EQ(parse_swc("1 0 0 0 0 1 -1\n2 0 0 0 1 1 1").segments.size(), 1u);
  EXPECT_EQ(read_skeleton(written("UPPER.SWC", "1 0 0 0 0 1 -1\n2 0 0 0 1 1 1")).segments.size(), 1u);
}

TEST(ReadJson, PointsRadiiSegmentsNamesUnits) {
  const Skeleton s = parse_skeleton_json(R"({"format": "vascular-graph-1", "units": "um", "note": 1,
      "points": [[0,0,0],[1,0,0],[2,0,0.5],[1,1,1]], "radius": [1,1,0.5,2], "branches": [[0,1],[1,2],[1,3]],
      "names": {"0": "inlet", "3": "left"}})");
  EXPECT_EQ(s.points[2], Vec3(2, 0, .5));
  EXPECT_EQ(s.radii[3], 2);
  EXPECT_EQ(s.segments, (std::vector<std::array<int, 2>>{{0, 1}, {1, 2}, {1, 3}}));
  EXPECT_EQ(s.names, (std::map<int, std::string>{{0, "inlet"}, {3, "left"}}));
  EXPECT_EQ(s.units, "um");
  EXPECT_FALSE(s.root);
}

TEST(ReadJson, Errors) {
  // a good file, in which one piece of text is replaced
  const std::string good =
      R"({"format":"vascular-graph-1","units":"mm","points":[[0,0,0],[1,0,0],[2,0,0]],"radius":[1,1,0.5],)"
      R"("branches":[[0,1,2]],"names":{"0":"a","2":"b"}})";
  EXPECT_EQ(parse_skeleton_json(good).segments.size(), 2u);
  const std::vector<std::array<std::string, 3>> cases{
      {R"("format":"vascular-graph-1",)", "", "format is missing"},
      {"vascular-graph-1", "vascular-graph-2", R"(must be "vascular-graph-1")"},
      {R"("mm")", R"("inch")", R"(units is "inch")"},
      {R"("mm")", "3", "units is 3"},
      {R"("points":)", R"("pts":)", "key 'points' is missing"},
      {R"("radius":)", R"("radii":)", "key 'radius' is missing"},
      {R"("branches":)", R"("lines":)", "key 'branches' is missing"},
      {"[1,1,0.5]", "null", "radius is null, must be an array"},
      {"[1,1,0.5]", "[1,1]", "radius has 2 values, must have one for each of the 3 points"},
      {"[1,1,0.5]", "[1,0,0.5]", "radius[1] is 0 at [1,0,0], must be > 0"},
      {"[1,1,0.5]", "[1,1,-1e-3]", "radius[2] is -0.001"},
      {"[1,1,0.5]", "[1,null,0.5]", "radius[1] is null, must be a finite number"},
      {"[1,1,0.5]", "[1,1e999,0.5]", "not JSON"},
      {"[1,1,0.5]", "[1,NaN,0.5]", "not JSON: parse error at line 1, column"},
      {"[1,0,0]", "[1,0]", "points[1] is [1,0], must be [x, y, z]"},
      {"[1,0,0]", R"([1,"a",0])", R"(points[1][1] is "a", must be a finite number)"},
      {"[[0,0,0],[1,0,0],[2,0,0]]", "[]", "points is empty"},
      {"[[0,1,2]]", "[[0,1,3]]", "branches[0][2] is 3, must be an index of points, 0 to 2"},
      {"[[0,1,2]]", "[[0,-1]]", "branches[0][1] is -1"},
      {"[[0,1,2]]", "[[0,1.5]]", "branches[0][1] is 1.5"},
      {"[[0,1,2]]", "[[0,1,2],[1]]", "branches[1] is [1], must be an array of at least 2 points"},
      {"[[0,1,2]]", "[]", "branches is empty"},
      {"[[0,1,2]]", "{}", "branches is {}, must be an array"},
      {R"("2":"b")", R"("2":"a")", "names[\"2\"]: the name 'a' is already that of point 0"},
      {R"("2":"b")", R"("1":"b")", "names[\"1\"]: point 1 has 2 segments; only ends"},
      {R"("2":"b")", R"("7":"b")", "names[\"7\"]: the key must be an index of points, 0 to 2"},
      {R"("2":"b")", R"("x":"b")", "names[\"x\"]: the key must be an index"},
      {R"("2":"b")", R"("2":"")", "names[\"2\"] is \"\", must be a name"},
      {R"("2":"b")", R"("2":5)", "names[\"2\"] is 5, must be a name"},
      {R"({"0":"a","2":"b"})", "[]", "names is [], must be an object"},
  };
  for (const auto& [piece, replacement, expected] : cases) {
    std::string text = good;
    ASSERT_NE(text.find(piece), std::string::npos) << piece;
    text.replace(text.find(piece), piece.size(), replacement);
    const std::string what = error_of([&] { read_skeleton(written("bad.json", text)); });
    EXPECT_TRUE(has(what, "bad.json: ")) << what;
    EXPECT_TRUE(has(what, expected)) << "expected: " << expected << "\nwhat:     " << what;
  }
  EXPECT_TRUE(has(error_of([] { parse_skeleton_json(""); }), "not JSON"));
  EXPECT_TRUE(has(error_of([] { parse_skeleton_json("[1]"); }), "must be an object"));
}

TEST(LengthUnit, FirstWord) {
  EXPECT_EQ(length_unit(" mm (NIfTI world)"), "mm");
  EXPECT_EQ(length_unit("um"), "um");
  EXPECT_EQ(length_unit("metres"), "");
  EXPECT_EQ(length_unit(""), "");
}

// ------------------------------------------------------------------------------------------------- topology

TEST(BuildNetwork, RefusesWhatIsNoSkeleton) {
  const Skeleton good = one_branch(4, 1, [](int i) { return Vec3(i, 0, 0); });
  const auto message = [&](auto&& spoil) {
    Skeleton s = good;
    spoil(s);
    return error_of([&] { build_network(s); });
  };
  EXPECT_EQ(message([](Skeleton&) {}), "");
  EXPECT_TRUE(has(message([](Skeleton& s) { s.radii.pop_back(); }), "3 radii, must be one for each of the 4 points"));
  EXPECT_TRUE(
      has(message([](Skeleton& s) { s.radii[2] = 0; }), "radius 0 at point 2 (2 0 0), must be finite and > 0"));
  EXPECT_TRUE(has(message([](Skeleton& s) { s.points[1].x() = NAN; }), "point 1"));
  EXPECT_TRUE(has(message([](Skeleton& s) { s.segments[1][0] = 9; }), "segment 1 has the point 9, must be 0 to 3"));
  EXPECT_TRUE(has(message([](Skeleton& s) { s.segments.clear(); }), "no segment"));
  EXPECT_TRUE(
      has(message([](Skeleton& s) { s.names[1] = "a"; }), "'a' is given for point 1 (1 0 0), which is not an"));
  EXPECT_TRUE(has(message([](Skeleton& s) { s.names[11] = "a"; }), "is for point 11, must be 0 to 3"));
  EXPECT_TRUE(has(message([](Skeleton& s) { s.names[0] = ""; }), "is empty"));
  EXPECT_TRUE(has(message([](Skeleton& s) { s.names = {{0, "a"}, {3, "a"}}; }), "unique"));
  EXPECT_TRUE(has(error_of([&] { build_network(good, {.inlet = 2, .names = {}}); }), "not an end"));
}

TEST(BuildNetwork, RepairsAreDoneAndReported) {
  Skeleton s = one_branch(6, 1, [](int i) { return Vec3(i, 0, 0); });
  s.points.push_back(Vec3(5, 1e-8, 0));  // 6: coincides with 5, which it prolongs
  s.points.push_back(Vec3(7, 0, 0));     // 7
  s.points.push_back(Vec3(9, 9, 9));     // 8: isolated
  s.radii.resize(9, 1);
  add_chain(s, {5, 6, 7});
  s.segments.push_back({3, 2});  // a second time
  s.segments.push_back({4, 4});
  s.names[7] = "end";
  const Network n = build_network(s);
  expect_sound(n);
  ASSERT_EQ(n.branches.size(), 1u);
  EXPECT_NEAR(n.branches[0].length(), 7, 1e-12);
  EXPECT_EQ(lines_with(n, "point 6 (5 1e-08 0) coincides with its neighbour point 5"), 1);
  EXPECT_EQ(lines_with(n, "second segment between point 3"), 1);
  EXPECT_EQ(lines_with(n, "segment from point 4 (4 0 0) to itself"), 1);
  EXPECT_EQ(lines_with(n, "point 8 (9 9 9) has no segment"), 1);
  EXPECT_EQ(n.nodes[1].name, "end");
}

double sharpest_bend(const Branch& b) {  // radius times curvature
  double largest = 0;
  for (std::size_t i = 1; i < b.points.size(); ++i) {
    const double turn = (b.tangents[i] - b.tangents[i - 1]).norm() / (b.arc[i] - b.arc[i - 1]);
    largest = std::max(largest, turn * (b.radii[i] + b.radii[i - 1]) / 2);
  }
  return largest;
}

TEST(BuildNetwork, DetoursVanish) {
  const Network n = build_network(one_branch(12, 1, [](int i) { return Vec3(i == 6 ? 4.2 : i, i == 6 ? .3 : 0, 0); }));
  expect_sound(n);
  EXPECT_EQ(lines_with(n, "too sharp for a tube: rounded"), 1);
  EXPECT_LT(sharpest_bend(n.branches[0]), 1.1);
  EXPECT_LT(n.branches[0].length(), 12.5);  // 14.7 along the points
}

TEST(BuildNetwork, SharpBendsAreRoundedAsFarAsThatTakes) {
  // corner of two long straight stretches, of any sampling: the arc of the bend touches both of them
  for (const double spacing : {.4, 1.0, 3.0, 6.0}) {
    for (const double degrees : {70.0, 110.0, 140.0}) {
      const double a = degrees * kPi / 180;
      const int half = static_cast<int>(std::lround(24 / spacing));
      const Network n = build_network(one_branch(2 * half + 1, 1, [&](int i) {
        const double s = spacing * (i - half);
        return Vec3(s < 0 ? s : s * std::cos(a), s < 0 ? 0 : s * std::sin(a), 0);
      }));
      expect_sound(n);
      const Branch& b = n.branches[0];
      EXPECT_LT(sharpest_bend(b), 1) << spacing << " " << degrees;
      double nearest = 1e9;  // of the axis to the corner
      for (int i = 0; i <= 4000; ++i) {
        nearest = std::min(nearest, axis_point(b, b.length() * i / 4000).position.norm());
      }
      EXPECT_LT(nearest, 1.25 * (1 / std::cos(a / 2) - 1) + .2) << spacing << " " << degrees;
      EXPECT_LT((b.tangents.front() - Vec3::UnitX()).norm(), 2e-2);
    }
  }
}

TEST(BuildNetwork, PointsOfASpikeAreLeftOut) {
  const Skeleton s = gallery::spike();
  const Network n = build_network(s);
  expect_sound(n);
  EXPECT_EQ(lines_with(n, "left out: a tube through it would bend too sharply"), 1);
  EXPECT_LT(sharpest_bend(n.branches[0]), 1);
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    double nearest = 1e9;
    for (const Vec3& p : n.branches[0].points) {
      nearest = std::min(nearest, (p - s.points[i]).norm());
    }
    EXPECT_LT(nearest, 4 * s.radii[i]) << i;
  }
}

TEST(BuildNetwork, HairpinsKeepTheirLength) {
  const Network n = build_network(one_branch(60, 1, [](int i) {  // two limbs 1.4 apart, 14 long
    const double s = .5 * (i - 29.5), turn = .7 * kPi / 2;
    return std::abs(s) < turn ? Vec3(.7 * std::cos(s / .7), .7 * std::sin(s / .7), 0)
                              : Vec3(turn - std::abs(s), s > 0 ? .7 : -.7, 0);
  }));
  expect_sound(n);
  double farthest = -1e9;
  for (const Vec3& p : n.branches[0].points) {
    farthest = std::max(farthest, p.x());
  }
  EXPECT_GT(farthest, .3);
}

TEST(BuildNetwork, CyclesComponentsDegrees) {
  Skeleton s;
  const auto ring = [&](const Vec3& centre, double radius, int n, bool close) {
    std::vector<int> chain;
    for (int i = 0; i < n; ++i) {
      chain.push_back(static_cast<int>(s.points.size()));
      s.points.push_back(centre + radius * Vec3(std::cos(2 * kPi * i / n), std::sin(2 * kPi * i / n), 0));
      s.radii.push_back(.5);
    }
    if (close) {
      chain.push_back(chain[0]);
    }
    add_chain(s, chain);
    return chain;
  };
  ring(Vec3(0, 0, 0), 5, 30, true);                                   // closed, without a junction
  const std::vector<int> handle = ring(Vec3(30, 0, 0), 5, 30, true);  // closed, with one branch
  s.points.push_back(Vec3(45, 0, 0));
  s.radii.push_back(.5);
  add_chain(s, {handle[0], static_cast<int>(s.points.size()) - 1});
  const std::vector<int> theta = ring(Vec3(60, 0, 0), 5, 30, true);  // two junctions joined by three branches
  s.points.push_back(Vec3(60, 0, 1));
  s.radii.push_back(.5);
  add_chain(s, {theta[0], static_cast<int>(s.points.size()) - 1, theta[15]});

  const Network n = build_network(s);
  expect_sound(n);
  ASSERT_EQ(n.branches.size(), 1u + 2u + 3u);
  ASSERT_EQ(n.nodes.size(), 1u + 2u + 2u);
  std::multiset<int> degrees;
  for (const NetworkNode& node : n.nodes) {
    degrees.insert(node.degree);
  }
  EXPECT_EQ(degrees, (std::multiset<int>{1, 2, 3, 3, 3}));
  for (const Branch& b : n.branches) {
    if (n.nodes[b.nodes[0]].seam) {  // periodic: the circle, smooth at the seam too
      EXPECT_EQ(b.nodes[0], b.nodes[1]);
      EXPECT_LT((b.tangents.front() - b.tangents.back()).norm(), 1e-12);
      EXPECT_NEAR(b.length(), 10 * kPi, 2e-3);
      EXPECT_LT(largest_distance(b, [](const Vec3& p) { return std::abs(p.norm() - 5); }), 5e-3);
    }
  }
  EXPECT_EQ(lines_with(n, "note: inlet chosen"), 1);
}

TEST(BuildNetwork, LoopsWithoutAHoleAreDropped) {
  Skeleton s = one_branch(9, 1, [](int i) { return Vec3(i, 0, 0); });
  s.points.push_back(Vec3(4.3, .4, 0));
  s.points.push_back(Vec3(3.7, .4, 0));
  s.points.push_back(Vec3(5.5, .5, 0));
  s.radii.resize(12, 1);
  add_chain(s, {4, 9, 10, 4});  // back to its start
  add_chain(s, {5, 11, 6});     // beside 5, 6
  const Network n = build_network(s);
  expect_sound(n);
  EXPECT_EQ(n.branches.size(), 1u);
  EXPECT_EQ(lines_with(n, "too short for a hole"), 2);
}

/// A tube of n further points of radius 1, one apart, from a point along a direction.
void add_arm(Skeleton& skeleton, int from, const Vec3& direction, int n) {
  const Vec3 start = skeleton.points[from], step = direction.normalized();
  for (int i = 1, before = from; i <= n; ++i) {
    const int here = static_cast<int>(skeleton.points.size());
    skeleton.points.push_back(start + i * step);
    skeleton.radii.push_back(1);
    skeleton.segments.push_back({before, here});
    before = here;
  }
}

/// Three junctions joined to each other, each with an arm outwards.
Skeleton triangle(double side) {
  Skeleton s;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * kPi * i / 3 + .2;
    s.points.push_back(side / std::sqrt(3) * Vec3(std::cos(angle), std::sin(angle), 0));
    s.radii.push_back(1);
    s.segments.push_back({i, (i + 1) % 3});
  }
  for (int i = 0; i < 3; ++i) {
    add_arm(s, i, s.points[i], 8);
  }
  return s;
}

/// Two branches between the same two junctions, at most 2 * bow apart, and an arm at either end.
Skeleton bows(double bow) {
  Skeleton s;
  s.points = {{0, 0, 0}, {12, 0, 0}};
  s.radii = {1, 1};
  for (const double y : {bow, -bow}) {
    std::vector<int> chain{0};
    for (int i = 1; i < 12; ++i) {
      chain.push_back(static_cast<int>(s.points.size()));
      s.points.push_back(Vec3(i, y * std::sin(kPi * i / 12), .1 * y));
      s.radii.push_back(1);
    }
    chain.push_back(1);
    add_chain(s, chain);
  }
  add_arm(s, 0, Vec3(-1, .3, 0), 8);
  add_arm(s, 1, Vec3(1, .2, .1), 8);
  return s;
}

/// Four rungs between two rails that go on at both ends.
Skeleton ladder(double cell) {
  Skeleton s;
  for (int i = 0; i < 4; ++i) {
    for (const double y : {0., cell}) {
      s.points.push_back(Vec3(i * cell, y, 0));
      s.radii.push_back(1);
    }
    s.segments.push_back({2 * i, 2 * i + 1});
    if (i > 0) {
      s.segments.push_back({2 * i - 2, 2 * i});
      s.segments.push_back({2 * i - 1, 2 * i + 1});
    }
  }
  add_arm(s, 0, Vec3(-1, -.6, 0), 8);
  add_arm(s, 1, Vec3(-1, .6, 0), 8);
  add_arm(s, 6, Vec3(1, -.6, 0), 8);
  add_arm(s, 7, Vec3(1, .6, 0), 8);
  return s;
}
Skeleton small_triangle() { return triangle(2); }
Skeleton small_ladder() { return ladder(1.3); }
Skeleton narrow_bows() { return bows(.33); }  // 10 degrees at the junctions

/// Independent cycles of a network in one piece.
int loops(const Network& network) {
  return static_cast<int>(network.branches.size()) - static_cast<int>(network.nodes.size()) + 1;
}

TEST(BuildNetwork, LoopsThatTheirTubesFillAreOpened) {
  struct Case {
    std::string name;
    Skeleton skeleton;
    int loops, opened;
    std::size_t ends;
  };
  Skeleton thin = triangle(2);  // side 1 to 2 is thinner than the others, through a point of its own
  thin.points.push_back((thin.points[1] + thin.points[2]) / 2);
  thin.radii.push_back(.6);
  thin.segments[1] = {1, static_cast<int>(thin.points.size()) - 1};
  thin.segments.push_back({static_cast<int>(thin.points.size()) - 1, 2});
  for (const Case& c : {Case{"triangle", triangle(2), 0, 1, 3}, Case{"with a thin side", thin, 0, 1, 3},
                        Case{"triangle, nearly a hole", triangle(3.3), 0, 1, 3}, Case{"a hole", triangle(4.2), 1, 0, 3},
                        Case{"large triangle", triangle(8), 1, 0, 3}, Case{"10 degrees", bows(.33), 0, 1, 2},
                        Case{"a fifth of a radius apart", bows(1.08), 0, 1, 2},
                        Case{"bows that part", bows(1.5), 1, 0, 2}, Case{"ladder", ladder(1.3), 0, 3, 4},
                        Case{"wide ladder", ladder(4), 3, 0, 4}}) {
    const Network n = build_network(c.skeleton);
    expect_sound(n);
    EXPECT_EQ(loops(n), c.loops) << c.name;
    EXPECT_EQ(lines_with(n, "filled by its own tubes"), c.opened) << c.name;
    std::size_t ends = 0;
    for (const NetworkNode& node : n.nodes) {
      ends += node.degree == 1;
    }
    EXPECT_EQ(ends, c.ends) << c.name;
  }
  const Network n = build_network(thin);
  EXPECT_EQ(n.nodes[0].degree, 3);  // opposite to the side left out
  EXPECT_EQ(lines_with(n, "through points"), 1);
  EXPECT_EQ(lines_with(n, "the branch from point 1 ("), 1);
}

TEST(BuildNetwork, OpenedLoopsAreCertified) {
  SkeletonMeshOptions options;
  options.grading.elements = 2;
  options.mesh.order = 2;
  for (const Skeleton& s : {triangle(2), triangle(8), bows(.33), bows(1.08)}) {
    const SkeletonMesh m = mesh_skeleton(s, options);
    EXPECT_EQ(measure_quality(m.result.mesh).certified, m.result.mesh.element_count());
  }
}

TEST(BuildNetwork, JunctionsWithinAFractionOfTheirRadiusBecomeOne) {
  // a triangle of junctions .2 radii apart, and a further junction .5 radii away that stays
  Skeleton s;
  s.points = {{0, 0, 0}, {.2, 0, 0}, {.1, .17, 0}, {-8, -1, 0}, {.5, -8, 0}, {.1, .7, 0}, {7, 5, 0}, {-7, 6, 0}};
  s.radii = {1, 1.05, 1, 1, 1, 1, 1, 1};
  s.segments = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 4}, {2, 5}, {5, 6}, {5, 7}};
  const Network n = build_network(s);
  expect_sound(n);
  EXPECT_EQ(lines_with(n, "made one"), 1);  // then point 2 is no junction any more
  EXPECT_EQ(lines_with(n, "is there twice"), 1);
  ASSERT_EQ(n.branches.size(), 5u);
  EXPECT_EQ(n.nodes[0].point, 1);
  EXPECT_EQ(n.nodes[0].position, s.points[1]);
  EXPECT_EQ(n.nodes[0].degree, 3);
  EXPECT_EQ(n.nodes[3].point, 5);
  s.points[0] = Vec3(-.4, 0, 0);  // .6 from the next
  s.points[2] = Vec3(.1, .5, 0);
  EXPECT_EQ(lines_with(build_network(s), "made one"), 1);  // points 2 and 5
}

TEST(BuildNetwork, SegmentOfTwoPoints) {
  const Network n = build_network(one_branch(2, 1, [](int i) { return Vec3(0, 0, .1 * i); }));
  expect_sound(n);
  EXPECT_NEAR(n.branches[0].length(), .1, 1e-15);
  EXPECT_EQ(n.branches[0].points.size(), 5u);
}

// ---------------------------------------------------------------------------------------------------- names

TEST(BuildNetwork, NamesOfEnds) {
  Skeleton s = star({{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}}, 1, 1, 6);  // ends 6, 12, 18
  s.radii[12] = 1.1;
  const auto names = [](const Network& n) {
    std::map<int, std::string> result;
    for (const NetworkNode& node : n.nodes) {
      if (node.degree == 1) {
        result[node.point] = node.name;
      }
    }
    return result;
  };
  using Names = std::map<int, std::string>;
  std::vector<std::string> log;
  vasohex::Run run;
  run.on_log = [&](std::string_view line) { log.emplace_back(line); };
  const Network widest = build_network(s, {}, run);
  EXPECT_EQ(names(widest), (Names{{12, "inlet"}, {6, "outlet_1"}, {18, "outlet_2"}}));
  EXPECT_EQ(lines_with(widest, "note: inlet chosen: end at point 12"), 1);
  EXPECT_EQ(log.size(), 1u);
  s.root = 18;
  EXPECT_EQ(names(build_network(s)), (Names{{18, "inlet"}, {6, "outlet_1"}, {12, "outlet_2"}}));
  EXPECT_EQ(lines_with(build_network(s), "chosen"), 0);
  EXPECT_EQ(names(build_network(s, {.inlet = 6, .names = {}})),
            (Names{{6, "inlet"}, {12, "outlet_1"}, {18, "outlet_2"}}));
  s.names = {{6, "inlet_main"}, {12, "outlet_1"}};
  EXPECT_EQ(names(build_network(s)), (Names{{6, "inlet_main"}, {12, "outlet_1"}, {18, "outlet_2"}}));
  EXPECT_EQ(names(build_network(s, {.inlet = {}, .names = {{12, "left"}}})),
            (Names{{6, "inlet_main"}, {12, "left"}, {18, "outlet_1"}}));
}

TEST(BuildNetwork, ComponentsAreNumberedByVolume) {
  Skeleton s = one_branch(4, 1, [](int i) { return Vec3(i, 0, 0); });
  const Skeleton large = one_branch(9, 1, [](int i) { return Vec3(i, 9, 0); });
  for (std::size_t i = 0; i < large.points.size(); ++i) {
    s.points.push_back(large.points[i]);
    s.radii.push_back(1);
  }
  for (const auto& [a, b] : large.segments) {
    s.segments.push_back({a + 4, b + 4});
  }
  const Network n = build_network(s);
  expect_sound(n);
  EXPECT_EQ(n.nodes[0].name, "inlet_2");
  EXPECT_EQ(n.nodes[1].name, "outlet_2");
  EXPECT_EQ(n.nodes[2].name, "inlet");
  EXPECT_EQ(n.nodes[3].name, "outlet_1");
}

// ------------------------------------------------------------------------------------------------- smoothing

TEST(BuildNetwork, StraightDataStayAsTheyAre) {
  const Vec3 u = Vec3(1, 2, 3).normalized();
  for (double spacing : {.1, .5, 1.0, 3.0, 10.0}) {
    Skeleton s = one_branch(20, 1, [&](int i) -> Vec3 { return spacing * i * u; });
    for (int i = 0; i < 20; ++i) {
      s.radii[i] = std::exp(.02 * spacing * i);
    }
    const Network n = build_network(s);
    expect_sound(n);
    EXPECT_EQ(lines_with(n, "smoothing"), 0);
    const Branch& b = n.branches[0];
    EXPECT_NEAR(b.length(), 19 * spacing, 1e-12 * spacing);
    EXPECT_LT(largest_distance(b, [&](const Vec3& p) { return p.cross(u).norm(); }), 1e-13 * spacing * 20);
    for (std::size_t i = 0; i < b.points.size(); ++i) {
      EXPECT_NEAR(b.radii[i], std::exp(.02 * b.arc[i]), .004 * spacing * spacing * b.radii[i] + 1e-9);
    }
  }
}

TEST(BuildNetwork, CircleAndHelixAreMet) {
  const double bend = 4;  // radii
  for (double spacing : {.1, .3, 1.0, 2.0}) {
    const Network n = build_network(one_branch(static_cast<int>(18 / spacing), 1, [&](int i) {
      const double a = spacing * i / bend;
      return Vec3(bend * std::cos(a), bend * std::sin(a), 0);
    }));
    expect_sound(n);
    const double error = largest_distance(
        n.branches[0], [&](const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - bend, p.z()); });
    EXPECT_LT(error, spacing > 1.5 ? 8e-3 : 1.5e-3) << spacing;
  }
  const double pitch = .3;  // rise per angle over the radius of the helix
  const Network n = build_network(one_branch(60, 1, [&](int i) {
    const double a = .2 * i;
    return Vec3(bend * std::cos(a), bend * std::sin(a), bend * pitch * a);
  }));
  expect_sound(n);
  const Branch& b = n.branches[0];
  EXPECT_NEAR(b.length(), bend * std::sqrt(1 + pitch * pitch) * .2 * 59, 2e-3);
  for (int i = 0; i <= 100; ++i) {
    const AxisPoint p = axis_point(b, b.length() * i / 100);
    const double a = p.position.z() / (bend * pitch);
    EXPECT_LT((p.position - Vec3(bend * std::cos(a), bend * std::sin(a), p.position.z())).norm(), 2e-3);
    const Vec3 tangent = Vec3(-std::sin(a), std::cos(a), pitch).normalized();
    EXPECT_LT((p.tangent - tangent).norm(), 1e-2);
  }
}

TEST(BuildNetwork, NoiseIsRemovedWithinBounds) {
  std::mt19937 random(7);
  const auto uniform = [&](double a) { return a * (2.0 * static_cast<double>(random()) / 4294967295.0 - 1); };
  const double bend = 6;
  Skeleton s = one_branch(120, 1, [&](int i) {
    const double a = .25 * i / bend;
    return Vec3(bend * std::cos(a) + uniform(.12), bend * std::sin(a) + uniform(.12), .2 * i + uniform(.12));
  });
  for (double& r : s.radii) {
    r *= 1 + uniform(.12);
  }
  const Network n = build_network(s);
  expect_sound(n);
  EXPECT_EQ(lines_with(n, "smoothing moved points"), 1);
  EXPECT_EQ(lines_with(n, "smoothing changed radii"), 1);
  const Branch& b = n.branches[0];
  double square = 0, bent = 0, slope = 0;
  for (std::size_t i = 0; i < b.points.size(); ++i) {
    const Vec3& p = b.points[i];
    square += std::pow(std::hypot(p.x(), p.y()) - bend, 2);
    EXPECT_NEAR(b.radii[i], 1, .15);
    if (i > 0) {
      const double ds = b.arc[i] - b.arc[i - 1];
      bent = std::max(bent, (b.tangents[i] - b.tangents[i - 1]).norm() / ds);
      slope = std::max(slope, std::abs(b.radii[i] - b.radii[i - 1]) / ds);
    }
  }
  EXPECT_LT(std::sqrt(square / static_cast<double>(b.points.size())), .06);
  EXPECT_LT(bent, .35);  // the curve itself bends with .1, the polyline turns by up to 1 per point
  EXPECT_LT(slope, .15);
  for (const Vec3& p : s.points) {  // no point is farther from the axis than it may move
    double nearest = 1e9;
    for (int i = 0; i <= 2000; ++i) {
      nearest = std::min(nearest, (axis_point(b, b.length() * i / 2000).position - p).norm());
    }
    EXPECT_LT(nearest, .2 * 1.13 + .01);
  }
}

double distance_to_polyline(const Skeleton& s, const Vec3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [i, j] : s.segments) {
    const Vec3 edge = s.points[j] - s.points[i], to = p - s.points[i];
    nearest = std::min(nearest, (to - std::clamp(to.dot(edge) / edge.squaredNorm(), 0.0, 1.0) * edge).norm());
  }
  return nearest;
}

/// Edges of 12 to 60 radii with corners up to 90 degrees, a junction that goes straight on with a bend, a long side.
Skeleton far_apart() {
  Skeleton s;
  s.points = {{0, 0, 0},    {60, 0, 0},   {60, 40, 0},  {72, 52, 0},
              {80, 70, 30}, {40, -6, 50}, {95, 95, 60}, {140, 60, 33}};
  s.radii = {1, 1, 1.2, 1.2, 1.5, .7, 1.1, .8};
  add_chain(s, {0, 1, 2, 3, 4, 6});
  s.segments.push_back({1, 5});
  s.segments.push_back({4, 7});
  return s;
}

TEST(BuildNetwork, EdgesBetweenPointsFarApartStayStraight) {
  const Skeleton s = far_apart();
  const Network n = build_network(s);
  expect_sound(n);
  EXPECT_EQ(lines_with(n, "note: between points far apart the axis is straight"), 1);
  for (const Branch& b : n.branches) {
    for (std::size_t i = 0; i < b.points.size(); ++i) {
      double corner = std::numeric_limits<double>::infinity();  // distance in radii
      for (const Vec3& p : s.points) {
        corner = std::min(corner, (b.points[i] - p).norm() / b.radii[i]);
      }
      EXPECT_LT(distance_to_polyline(s, b.points[i]), (corner > 10 ? .1 : 1.1) * b.radii[i]) << corner;
      if (i > 0) {
        const double bent = (b.tangents[i] - b.tangents[i - 1]).norm() / (b.arc[i] - b.arc[i - 1]);
        EXPECT_LT(bent * b.radii[i], 1 / 1.5);
      }
    }
  }
}

TEST(BuildNetwork, CornersBetweenLongEdgesAreRounded) {
  for (const double degrees : {15.0, 40.0, 90.0, 115.0}) {
    const double a = degrees * kPi / 180;
    const Network n = build_network(one_branch(3, 2, [&](int i) {
      return i == 2 ? Vec3(100 + 200 * std::cos(a), 200 * std::sin(a), 0) : Vec3(100 * i, 0, 0);
    }));
    expect_sound(n);
    const Branch& b = n.branches[0];
    for (std::size_t i = 1; i < b.points.size(); ++i) {
      EXPECT_LT((b.tangents[i] - b.tangents[i - 1]).norm() / (b.arc[i] - b.arc[i - 1]) * 2, 1 / (degrees > 100 ? 1.1 : 1.45)) << degrees;
    }
  }
}

TEST(BuildNetwork, ClosedCurveOfLongEdges) {
  const Skeleton open = one_branch(4, 1, [](int i) { return Vec3(i % 3 == 0 ? 0 : 40, i < 2 ? 0 : 30, 0); });
  Skeleton s = open;
  s.segments.push_back({3, 0});
  const Network n = build_network(s);
  expect_sound(n);
  ASSERT_EQ(n.branches.size(), 1u);
  const Branch& b = n.branches[0];
  EXPECT_LT((b.tangents.front() - b.tangents.back()).norm(), 1e-9);
  EXPECT_LT(largest_distance(b, [&](const Vec3& p) { return distance_to_polyline(s, p); }), 1.1);
  EXPECT_NEAR(b.length(), 140, 2);
}

TEST(BuildNetwork, LongChordsOfACurveStaySmooth) {  // 12 degrees each, 8 radii long
  const double bend = 40;
  const Network n = build_network(
      one_branch(20, 1, [&](int i) { return Vec3(bend * std::cos(.2 * i), bend * std::sin(.2 * i), 0); }));
  EXPECT_EQ(lines_with(n, "far apart"), 0);
  EXPECT_LT(largest_distance(n.branches[0], [&](const Vec3& p) { return std::abs(p.norm() - bend); }), .05);
}

TEST(BuildNetwork, SharpCornersAreRounded) {
  const Network n = build_network(
      one_branch(41, 1, [](int i) { return i <= 20 ? Vec3(.4 * i, 0, 0) : Vec3(8, .4 * (i - 20), 0); }));
  expect_sound(n);
  EXPECT_EQ(lines_with(n, "bends with"), 0);
}

TEST(BuildNetwork, RadiiStayPositiveAndWithinTheData) {
  Skeleton s = one_branch(15, 2, [](int i) { return Vec3(2 * i, 0, 0); });
  s.radii[7] = .2;
  s.radii[8] = .2;
  s.radii[11] = 30;  // a bulge that no tube can follow
  const Network n = build_network(s);
  expect_sound(n);
  EXPECT_EQ(lines_with(n, "radii that change by more than 0.75 per length lowered"), 1);
  for (double r : n.branches[0].radii) {
    EXPECT_GE(r, .2 * (1 - 1e-12));
    EXPECT_LE(r, 2 + .75 * 2 + 1e-12);
  }
}

// ------------------------------------------------------------------------------------------------- junctions

TEST(BuildNetwork, MainVesselHasNoKinkAtASideBranch) {
  const double bend = 10 * kPi / 180;
  const Network n = build_network(star({{-1, 0, 0}, {std::cos(bend), std::sin(bend), 0}, {0, 0, 1}}, 1, .8, 12));
  expect_sound(n);
  ASSERT_EQ(n.branches.size(), 3u);
  EXPECT_LT((n.branches[0].tangents.front() + n.branches[1].tangents.front()).norm(), 1e-12);
  EXPECT_GT(n.branches[2].tangents.front().z(), .999);
}

TEST(BuildNetwork, SymmetricForkKeepsItsDirections) {
  const Vec3 left(std::cos(.5), std::sin(.5), 0), right(std::cos(.5), -std::sin(.5), 0);
  const Network n = build_network(star({{-1, 0, 0}, left, right}, 1, .5, 12));
  expect_sound(n);
  EXPECT_LT((n.branches[0].tangents.front() - Vec3(-1, 0, 0)).norm(), 1e-9);
  EXPECT_LT((n.branches[1].tangents.front() - left).norm(), 1e-9);
  EXPECT_LT((n.branches[2].tangents.front() - right).norm(), 1e-9);
}

TEST(BuildNetwork, ThinBranchKeepsItsRadiusUpToAWideJunction) {
  Skeleton s = star({{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 4, 2, 10);
  for (int i = 21; i <= 30; ++i) {
    s.radii[i] = 1;
  }
  const Network n = build_network(s);
  expect_sound(n);
  EXPECT_EQ(lines_with(n, "starts with its own radius 1, not with that of the junction, 4"), 1);
  for (double r : n.branches[2].radii) {
    EXPECT_NEAR(r, 1, 1e-9);
  }
  for (double r : n.branches[0].radii) {
    EXPECT_NEAR(r, 4, 1e-9);
  }
  EXPECT_NEAR(n.nodes[0].radius, 4, 1e-9);
  EXPECT_NEAR(n.nodes[3].radius, 1, 1e-9);

  s.radii[0] = 3;  // narrower at the node: kept, as far as smoothing allows
  const Network narrow = build_network(s);
  EXPECT_LT(narrow.branches[0].radii.front(), 3.7);
}

// ---------------------------------------------------------------------------------------------- invariance

Skeleton noisy_tree() {
  std::mt19937 random(3);
  const auto uniform = [&](double a) { return a * (2.0 * static_cast<double>(random()) / 4294967295.0 - 1); };
  Skeleton s = star({{-1, 0, 0}, {1, .2, 0}, {0, 1, .4}, {.1, 0, -1}}, 1, .4, 25);
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    s.points[i] += Vec3(uniform(.1), uniform(.1), uniform(.1) + .02 * s.points[i].squaredNorm());
    s.radii[i] *= 1 + uniform(.1) - .02 * s.points[i].norm();
  }
  return s;
}

class Moved : public testing::TestWithParam<Skeleton (*)()> {};
INSTANTIATE_TEST_SUITE_P(BuildNetwork, Moved, testing::Values(&noisy_tree, &far_apart, &small_triangle,
                                                              &small_ladder, &narrow_bows));

TEST_P(Moved, CommutesWithScalingAndRigidMotion) {
  const Skeleton s = GetParam()();
  const Network plain = build_network(s);
  expect_sound(plain);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (const double scale : {1e-6, 1e-3, 1.0, 25.4, 1e3}) {
    const Vec3 shift = scale * Vec3(3, -8, 5);
    Skeleton moved = s;
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      moved.points[i] = scale * (turn * s.points[i]) + shift;
      moved.radii[i] = scale * s.radii[i];
    }
    const Network n = build_network(moved);
    ASSERT_EQ(n.branches.size(), plain.branches.size());
    ASSERT_EQ(n.repairs.size(), plain.repairs.size());
    for (std::size_t b = 0; b < n.branches.size(); ++b) {
      const Branch &p = plain.branches[b], &q = n.branches[b];
      ASSERT_EQ(q.points.size(), p.points.size());
      for (std::size_t i = 0; i < p.points.size(); ++i) {
        EXPECT_LT((q.points[i] - scale * (turn * p.points[i]) - shift).norm(), 1e-9 * scale);
        EXPECT_NEAR(q.radii[i], scale * p.radii[i], 1e-9 * scale);
        EXPECT_NEAR(q.arc[i], scale * p.arc[i], 1e-9 * scale);
      }
    }
    for (std::size_t k = 0; k < n.nodes.size(); ++k) {
      EXPECT_EQ(n.nodes[k].name, plain.nodes[k].name);
    }
  }
}

TEST(BuildNetwork, SameTwice) {
  const Network a = build_network(noisy_tree()), b = build_network(noisy_tree());
  for (std::size_t k = 0; k < a.branches.size(); ++k) {
    EXPECT_EQ(a.branches[k].points, b.branches[k].points);
    EXPECT_EQ(a.branches[k].radii, b.branches[k].radii);
  }
  EXPECT_EQ(a.repairs, b.repairs);
}

TEST(BuildNetwork, CanBeCancelled) {
  vasohex::Run run;
  run.on_progress = [](std::string_view, double) { return false; };
  EXPECT_THROW(build_network(noisy_tree(), {}, run), Error);
}

TEST(AxisPoint, MeetsSamplesAndClamps) {
  const Network n = build_network(noisy_tree());
  for (const Branch& b : n.branches) {
    for (std::size_t i = 0; i < b.points.size(); ++i) {
      const AxisPoint p = axis_point(b, b.arc[i]);
      EXPECT_LT((p.position - b.points[i]).norm(), 1e-12);
      EXPECT_LT((p.tangent - b.tangents[i]).norm(), 1e-12);
      EXPECT_NEAR(p.radius, b.radii[i], 1e-12);
    }
    EXPECT_EQ(axis_point(b, -1).position, b.points.front());
    EXPECT_LT((axis_point(b, 2 * b.length()).position - b.points.back()).norm(), 1e-12);
    for (int i = 1; i <= 500; ++i) {  // as long as it says, without jumps
      const AxisPoint p = axis_point(b, b.length() * (i - 1) / 500), q = axis_point(b, b.length() * i / 500);
      EXPECT_NEAR((q.position - p.position).norm(), b.length() / 500, 2e-3 * b.length() / 500);
      EXPECT_LT((q.tangent - p.tangent).norm(), 2.0 * b.length() / 500);
    }
  }
}

// ------------------------------------------------------------------------------------------------- real data

TEST(BuildNetwork, MeshesOfThisProject) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(VASOHEX_MESHES)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".json" || extension == ".swc") {
      SCOPED_TRACE(entry.path());
      const Network n = build_network(read_skeleton(entry.path().string()));
      expect_sound(n);
      EXPECT_EQ(n.units, "mm");
      ++files;
    }
  }
  EXPECT_GE(files, 5);
}

TEST(BuildNetwork, RealVessels) {
  const char* data = std::getenv("VASOHEX_DATA");
  if (data == nullptr) {
    GTEST_SKIP() << "VASOHEX_DATA is not set";
  }
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".graph.json") && !name.ends_with(".swc")) {
      continue;
    }
    SCOPED_TRACE(entry.path());
    if (name.ends_with(".path.graph.json")) {  // without radii
      EXPECT_TRUE(has(error_of([&] { read_skeleton(entry.path().string()); }), "radius is null"));
      continue;
    }
    expect_sound(build_network(read_skeleton(entry.path().string())));
    ++files;
  }
  EXPECT_GE(files, 1);
}

}  // namespace
}  // namespace vasohex
