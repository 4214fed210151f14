#include "vasohex/surface/prepare_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>

#include "errors.h"
#include "iso_surface.h"
#include "triangle_shapes.h"
#include "vasohex/surface/read_surface.h"
#include "vasohex/surface/repair_triangles.h"

namespace vasohex {
namespace {

/// Volume between the triangles and the fans of their ends.
double volume(const PreparedSurface& p) {
  double sum = 0;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) { sum += a.cross(b).dot(c) / 6; };
  for (const auto& [a, b, c] : p.surface.triangles) {
    add(p.surface.points[a], p.surface.points[b], p.surface.points[c]);
  }
  for (std::size_t e = 0; e < p.rims.size(); ++e) {
    for (std::size_t i = 0; i < p.rims[e].size(); ++i) {
      add(p.ends[e].centre, p.surface.points[p.rims[e][i]], p.surface.points[p.rims[e][(i + 1) % p.rims[e].size()]]);
    }
  }
  return sum;
}

/// Each edge has one triangle, of a rim, or two that run against each other; rims are all the edges of one triangle.
void expect_manifold(const PreparedSurface& p) {
  std::map<std::pair<int, int>, int> directed;
  for (const auto& t : p.surface.triangles) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NE(t[k], t[(k + 1) % 3]);
      EXPECT_EQ(++directed[std::make_pair(t[k], t[(k + 1) % 3])], 1);
    }
  }
  std::size_t open = 0, rim_edges = 0;
  for (const auto& [edge, count] : directed) {
    open += directed.count({edge.second, edge.first}) == 0;
  }
  for (const auto& rim : p.rims) {
    for (std::size_t i = 0; i < rim.size(); ++i) {
      EXPECT_EQ(directed.count({rim[(i + 1) % rim.size()], rim[i]}), 1u) << "a cap would run against the wall";
    }
    rim_edges += rim.size();
  }
  EXPECT_EQ(open, rim_edges);
  EXPECT_EQ(p.rims.size(), p.ends.size());
}

bool mentions(const PreparedSurface& p, const std::string& text) {
  return std::any_of(p.repairs.begin(), p.repairs.end(),
                     [&](const std::string& r) { return r.find(text) != std::string::npos; });
}

std::string listed(const PreparedSurface& p) {
  std::string all;
  for (const std::string& r : p.repairs) {
    all += r + "\n";
  }
  return all;
}

constexpr int kAround = 24;

/// Fans over the rims of a tube: flat caps, or cones of this height.
TriSurface capped_tube(double height = 0) {
  const TubeShape shape;
  TriSurface s = shape.triangles(kAround);
  const int last = static_cast<int>(s.points.size()) - kAround, first_middle = static_cast<int>(s.points.size());
  s.points.emplace_back(0, 0, -height);
  s.points.emplace_back(0, 0, shape.length + height);
  for (int j = 0; j < kAround; ++j) {
    s.triangles.push_back({first_middle, (j + 1) % kAround, j});
    s.triangles.push_back({first_middle + 1, last + j, last + (j + 1) % kAround});
  }
  return s;
}

TEST(PrepareSurface, LeavesACleanTubeAlone) {
  const TriSurface s = TubeShape{}.triangles(kAround);
  const PreparedSurface p = prepare_surface(s);
  EXPECT_EQ(listed(p), "");
  EXPECT_EQ(p.surface.triangles, s.triangles);
  EXPECT_EQ(p.components, 1);
  expect_manifold(p);
  ASSERT_EQ(p.ends.size(), 2u);
  const double r = std::sqrt(0.5 * kAround * std::sin(2 * std::numbers::pi / kAround) / std::numbers::pi);
  for (int e = 0; e < 2; ++e) {
    EXPECT_NEAR((p.ends[e].centre - Vec3(0, 0, e * 8.0)).norm(), 0, 1e-12);
    EXPECT_NEAR((p.ends[e].normal - Vec3(0, 0, 2.0 * e - 1)).norm(), 0, 1e-12);
    EXPECT_NEAR(p.ends[e].radius, r, 1e-12);
  }
}

TEST(PrepareSurface, DropsCapsAndKeepsTheirPlanes) {
  for (const double height : {0.0, 0.1}) {
    const PreparedSurface p = prepare_surface(capped_tube(height));
    EXPECT_TRUE(mentions(p, "flat cap")) << listed(p);
    EXPECT_EQ(p.repairs.size(), 2u) << listed(p);
    EXPECT_EQ(p.surface.triangles, TubeShape{}.triangles(kAround).triangles);
    ASSERT_EQ(p.ends.size(), 2u);
    EXPECT_NEAR((p.ends[1].centre - Vec3(0, 0, 8)).norm(), 0, 1e-12);
    EXPECT_NEAR((p.ends[1].normal - Vec3(0, 0, 1)).norm(), 0, 1e-12);
    expect_manifold(p);
  }
  // hemispheres and long cones are no caps
  EXPECT_EQ(prepare_surface(capped_tube(1)).ends.size(), 0u);
}

TEST(PrepareSurface, TurnsTrianglesOutward) {
  const TriSurface clean = TubeShape{}.triangles(kAround);
  std::mt19937 generator(7);
  TriSurface mixed = clean, inward = clean;
  for (std::size_t t = 0; t < clean.triangles.size(); ++t) {
    std::swap(inward.triangles[t][1], inward.triangles[t][2]);
    if (generator() % 2 == 0) {
      std::swap(mixed.triangles[t][1], mixed.triangles[t][2]);
    }
  }
  const double expected = volume(prepare_surface(clean));
  const PreparedSurface m = prepare_surface(mixed), i = prepare_surface(inward);
  expect_manifold(m);
  expect_manifold(i);
  EXPECT_NEAR(volume(m), expected, 1e-9);
  EXPECT_NEAR(volume(i), expected, 1e-9);
  EXPECT_TRUE(mentions(m, "turned over to agree with the neighbours")) << listed(m);
  EXPECT_TRUE(mentions(i, "pointed inward")) << listed(i);
}

TEST(PrepareSurface, RepairsEachFaultWithOneLine) {
  const TriSurface clean = TubeShape{}.triangles(kAround);
  const double expected = volume(prepare_surface(clean));
  const std::array<int, 3> t = clean.triangles[100];
  const Vec3 outside = clean.points[t[0]] * 1.01 + Vec3(0, 0, 0.1);
  struct Case {
    const char* name;
    std::function<void(TriSurface&)> damage;
    const char* line;
  };
  const std::vector<Case> cases{
      {"points not shared",
       [](TriSurface& s) {
         TriSurface soup;
         for (const auto& corners : s.triangles) {
           const int first = static_cast<int>(soup.points.size());
           for (const int p : corners) {
             soup.points.push_back(s.points[p] + Vec3::Constant(1e-8 * (first % 7)));
           }
           soup.triangles.push_back({first, first + 1, first + 2});
         }
         s = soup;
       },
       "welded"},
      {"equal corners",
       [&](TriSurface& s) {
         s.triangles.push_back({t[0], t[1], t[1]});
       },
       "equal corners"},
      {"a triangle twice", [&](TriSurface& s) { s.triangles.push_back(t); }, "given more than once"},
      {"a film",
       [&](TriSurface& s) {
         s.points.push_back(outside);
         const int p = static_cast<int>(s.points.size()) - 1;
         s.triangles.push_back({t[0], t[1], p});
         s.triangles.push_back({t[1], t[0], p});
       },
       "without anything between"},
      {"a fin",
       [&](TriSurface& s) {
         s.points.push_back(outside);
         s.triangles.push_back({t[0], t[1], static_cast<int>(s.points.size()) - 1});
       },
       "edge of more than two triangles"},
      {"sheets that touch in a point",
       [&](TriSurface& s) {
         const int p = static_cast<int>(s.points.size());
         const Vec3 o = s.points[t[0]], d = Vec3(o.x(), o.y(), 0).normalized();
         s.points.push_back(o + 0.1 * d);
         s.points.push_back(o + 0.1 * d + Vec3(0, 0, 0.1));
         s.points.push_back(o + 0.2 * d + 0.1 * d.unitOrthogonal());
         s.triangles.push_back({t[0], p, p + 1});
         s.triangles.push_back({t[0], p + 1, p + 2});
         s.triangles.push_back({t[0], p + 2, p});
         s.triangles.push_back({p, p + 2, p + 1});
       },
       "point where sheets touch"},
      {"a fragment",
       [](TriSurface& s) {
         const int p = static_cast<int>(s.points.size());
         for (const Vec3& q : {Vec3(3, 0, 0), Vec3(3.1, 0, 0), Vec3(3, 0.1, 0)}) {
           s.points.push_back(q);
         }
         s.triangles.push_back({p, p + 1, p + 2});
       },
       "fragment"},
      {"a shell inside",
       [](TriSurface& s) {
         const TriSurface inner = TubeShape{4}.triangles(12);
         const int p = static_cast<int>(s.points.size());
         for (const Vec3& q : inner.points) {
           s.points.push_back(0.5 * q + Vec3(0, 0, 3));
         }
         for (const auto& c : inner.triangles) {
           s.triangles.push_back({c[0] + p, c[1] + p, c[2] + p});
         }
       },
       "inside another"},
      {"a missing triangle", [](TriSurface& s) { s.triangles.erase(s.triangles.begin() + 100); },
       "hole of 3 edges in the wall closed"},
      {"missing triangles",
       [](TriSurface& s) {
         const int p = s.triangles[100][0];
         s.triangles.erase(std::remove_if(s.triangles.begin(), s.triangles.end(),
                                          [&](const auto& c) { return std::count(c.begin(), c.end(), p) > 0; }),
                           s.triangles.end());
       },
       "edges in the wall closed"},
      {"cracks",
       [](TriSurface& s) {
         TriSurface soup;
         for (const auto& corners : s.triangles) {
           const int first = static_cast<int>(soup.points.size());
           for (int k = 0; k < 3; ++k) {
             soup.points.push_back(s.points[corners[k]] + Vec3(1e-4 * (first % 11), 1e-4 * (first % 7), 0));
           }
           soup.triangles.push_back({first, first + 1, first + 2});
         }
         s = soup;
       },
       "across cracks"},
      {"a slit",
       [](TriSurface& s) {  // along a quarter of a ring the triangles above have points of their own
         for (int j = 2; j < 8; ++j) {
           const int p = 10 * kAround + j, q = static_cast<int>(s.points.size());
           const Vec3 copy = s.points[p] + Vec3(0, 0, 0.1);
           s.points.push_back(copy);
           for (auto& c : s.triangles) {
             if (std::any_of(c.begin(), c.end(), [&](int i) { return i >= 11 * kAround && i < 12 * kAround; })) {
               std::replace(c.begin(), c.end(), p, q);
             }
           }
         }
       },
       "edges in the wall closed"},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    TriSurface damaged = clean;
    c.damage(damaged);
    const PreparedSurface p = prepare_surface(damaged);
    EXPECT_TRUE(mentions(p, c.line)) << listed(p);
    expect_manifold(p);
    EXPECT_EQ(p.ends.size(), 2u);
    EXPECT_EQ(p.components, 1);
    EXPECT_NEAR(volume(p) / expected, 1, 2e-3);
  }
}

TEST(PrepareSurface, NeedlesAreFlipped) {
  TriSurface s = TubeShape{}.triangles(kAround);
  // a point on an edge, used by one side only
  const std::array<int, 3> t = s.triangles[100];
  const int p = static_cast<int>(s.points.size());
  s.points.push_back((s.points[t[0]] + s.points[t[1]]) / 2);
  s.triangles[100] = {t[0], p, t[2]};
  s.triangles.push_back({p, t[1], t[2]});
  s.triangles.push_back({t[0], t[1], p});
  const PreparedSurface prepared = prepare_surface(s);
  EXPECT_TRUE(mentions(prepared, "without height flipped")) << listed(prepared);
  expect_manifold(prepared);
}

/// A tube whose upper rim is pushed in: over a sixth of the way around, a flap as deep as `in` lies within the lumen.
TriSurface torn_tube(double in) {
  TriSurface s = TubeShape{}.triangles(96);
  for (Vec3& p : s.points) {
    const double angle = std::atan2(p.y(), p.x()), part = std::max(0.0, 1 - std::abs(angle) / 0.5);
    if (p.z() > 7.7) {
      const double r = 1 - in * std::sqrt(part), turn = angle + (angle < 0 ? -0.9 : 0.9) * part;
      p = part > 0 ? Vec3(r * std::cos(turn), r * std::sin(turn), p.z()) : p;
    }
  }
  return s;
}

TEST(PrepareSurface, CutsRaggedEndsBack) {
  const TubeShape tube;
  const PreparedSurface p = prepare_surface(torn_tube(0.6));
  ASSERT_EQ(p.ends.size(), 2u);
  ASSERT_EQ(p.repairs.size(), 1u) << listed(p);
  EXPECT_TRUE(mentions(p, "ragged end at")) << listed(p);
  expect_manifold(p);
  EXPECT_NEAR(p.ends[0].centre.z(), 0, 1e-12);
  EXPECT_GT(p.ends[1].centre.z(), 7);
  EXPECT_LT(p.ends[1].centre.z(), 7.95);
  EXPECT_GT(p.ends[1].normal.z(), 1 - 1e-9);
  EXPECT_NEAR(p.ends[1].radius, 1, 0.1);
  for (const int i : p.rims[1]) {
    EXPECT_NEAR(p.surface.points[i].z(), p.ends[1].centre.z(), 1e-9);  // in one plane
  }
  for (const Vec3& x : p.surface.points) {
    EXPECT_TRUE(x.z() > 7.5 || std::abs(tube.distance(x)) < 1e-12);
    EXPECT_LE(x.z(), p.ends[1].centre.z() + 1e-9);
  }
}

TEST(PrepareSurface, CutsBevelledEndsBack) {
  // A closed cylinder askew in a grid: the edges between its wall and its caps come out cut at an angle.
  for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(0.05, 0.1, 1), Vec3(0.2, 0.1, 1), Vec3(0.1, 0.3, 1),
                                Vec3(-0.2, -0.2, 1), Vec3(0.3, 0.4, 1)}) {
    const Vec3 axis = direction.normalized();
    const auto value = [&](const Vec3& x) {
      const double z = axis.dot(x);
      return std::max((x - z * axis).norm() - 1, std::abs(z) - 3);
    };
    const PreparedSurface p = prepare_surface(iso_surface(value, Vec3(-2.53, -2.71, -4.17), 0.125, {42, 44, 68}));
    ASSERT_EQ(p.ends.size(), 2u) << direction.transpose() << "\n" << listed(p);
    EXPECT_TRUE(mentions(p, "bevelled end at")) << listed(p);
    expect_manifold(p);
    for (const SurfaceEnd& end : p.ends) {
      EXPECT_GT(std::abs(end.normal.dot(axis)), std::cos(0.03));
      EXPECT_NEAR(end.radius, 1, 0.02);
      EXPECT_LT(std::abs(end.centre.dot(axis)), 3.01);
      EXPECT_GT(std::abs(end.centre.dot(axis)), 2.7);
    }
  }
}

TEST(PrepareSurface, KeepsSeveralLumens) {
  TriSurface s = TubeShape{}.triangles(kAround);
  const int n = static_cast<int>(s.points.size());
  const std::size_t m = s.triangles.size();
  for (int p = 0; p < n; ++p) {
    const Vec3 beside = s.points[p] + Vec3(3, 0, 0);
    s.points.push_back(beside);
  }
  for (std::size_t t = 0; t < m; ++t) {
    const auto c = s.triangles[t];
    s.triangles.push_back({c[0] + n, c[2] + n, c[1] + n});
  }
  const PreparedSurface p = prepare_surface(s);
  EXPECT_EQ(p.components, 2);
  EXPECT_EQ(p.ends.size(), 4u);
  EXPECT_TRUE(mentions(p, "1 of 2 components pointed inward")) << listed(p);
  expect_manifold(p);
}

TEST(PrepareSurface, RefusesWhatCannotBeRepaired) {
  const auto error = [](const TriSurface& s) { return error_of([&] { prepare_surface(s); }); };
  EXPECT_EQ(error({{{0, 0, 0}}, {{0, 0, 1}}, ""}), "triangle 0 has point 1, must be 0 to 1 - 1");
  EXPECT_EQ(error({{{0, 0, std::nan("")}}, {{0, 0, 0}}, ""}), "point 0: a coordinate is not a finite number");
  EXPECT_EQ(error({{{0, 0, 0}}, {{0, 0, 0}}, ""}), "no triangles remain; the surface must enclose a lumen");
  TriSurface band;
  constexpr int n = 30;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    for (const double side : {-0.3, 0.3}) {
      band.points.emplace_back((1 + side * std::cos(a / 2)) * std::cos(a), (1 + side * std::cos(a / 2)) * std::sin(a),
                               side * std::sin(a / 2));
    }
  }
  for (int i = 0; i < n; ++i) {
    const bool last = i == n - 1;
    const int a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    band.triangles.push_back({a, b, c});
    band.triangles.push_back({b, d, c});
  }
  EXPECT_NE(error(band).find("has one side only (a Moebius band), seen at ("), std::string::npos) << error(band);
}

TEST(PrepareSurface, CommutesWithMotion) {
  TriSurface s = capped_tube();
  std::swap(s.triangles[5][0], s.triangles[5][1]);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  TriSurface moved = s;
  for (Vec3& p : moved.points) {
    p = 0.01 * (turn * p) + Vec3(0.3, -0.2, 0.1);
  }
  const PreparedSurface a = prepare_surface(s), b = prepare_surface(moved);
  EXPECT_EQ(a.surface.triangles, b.surface.triangles);
  ASSERT_EQ(a.ends.size(), b.ends.size());
  for (std::size_t e = 0; e < a.ends.size(); ++e) {
    EXPECT_NEAR((0.01 * (turn * a.ends[e].centre) + Vec3(0.3, -0.2, 0.1) - b.ends[e].centre).norm(), 0, 1e-12);
    EXPECT_NEAR((turn * a.ends[e].normal - b.ends[e].normal).norm(), 0, 1e-10);
    EXPECT_NEAR(0.01 * a.ends[e].radius, b.ends[e].radius, 1e-12);
  }
}

/// Published lumens, as dirty as they are. Openings and components as other programs count them.
TEST(PrepareSurface, FindsTheEndsOfPublishedLumens) {
  const char* data = std::getenv("VASOHEX_DATA");
  if (!data) {
    GTEST_SKIP() << "VASOHEX_DATA is not set";
  }
  struct Case {
    const char* file;
    std::size_t ends;
    const char* repair;  ///< one that must be reported
  };
  for (const Case& c : {Case{"s02_carotid_stenosis/lumen.stl", 3, "without anything between"},
                        Case{"s02_carotid_stenosis/leftlumen.stl", 3, "fragment"},
                        Case{"s02_carotid_stenosis/leftlumen_capped.stl", 3, "flat cap"},
                        Case{"s08_aneurysm_palabos/aneurysm.stl", 3, ""},
                        Case{"s08_aneurysm_palabos/aneurysm_marching.stl", 0, "to agree with the neighbours"},
                        Case{"s11_six_branch_junction/SixBranch.stl", 6, "pointed inward"},
                        Case{"s11_six_branch_junction/bifurcation_Y.stl", 3, "pointed inward"},
                        Case{"s12_aortic_arch_gmsh/aorta2.stl", 5, ""}}) {
    SCOPED_TRACE(c.file);
    const PreparedSurface p = prepare_surface(read_surface(std::string(data) + "/" + c.file));
    EXPECT_EQ(p.ends.size(), c.ends);
    EXPECT_EQ(p.components, 1);
    expect_manifold(p);
    EXPECT_GT(volume(p), 0);
    EXPECT_TRUE(*c.repair == '\0' || mentions(p, c.repair)) << listed(p);
  }
}

/// Against known values: outside, inside, on a face of a tetrahedron.
TEST(WindingNumber, TellsInsideFromOutside) {
  const TriSurface s{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, ""};
  EXPECT_NEAR(winding_number(s, {0.1, 0.1, 0.1}), 1, 1e-12);
  EXPECT_NEAR(winding_number(s, {1, 1, 1}), 0, 1e-12);
  EXPECT_NEAR(winding_number(s, {0.2, 0.2, 1e-9}), 1, 1e-6);
  EXPECT_NEAR(winding_number(s, {0.2, 0.2, -1e-9}), 0, 1e-6);
}

/// Closed: `facets` around, caps with a point in the middle.
TriSurface prism(int facets, double length) {
  TriSurface s;
  const int rows = 4;  // larger triangles than those of the caps: these are looked at first
  for (int row = 0; row <= rows; ++row) {
    for (int k = 0; k < facets; ++k) {
      const double angle = 2 * std::numbers::pi * k / facets;
      s.points.emplace_back(std::cos(angle), std::sin(angle), length * row / rows);
    }
  }
  const auto at = [&](int row, int k) { return row * facets + k % facets; };
  s.points.emplace_back(0, 0, 0);
  s.points.emplace_back(0, 0, length);
  const int bottom = facets * (rows + 1);
  for (int k = 0; k < facets; ++k) {
    for (int row = 0; row < rows; ++row) {
      s.triangles.push_back({at(row, k), at(row, k + 1), at(row + 1, k + 1)});
      s.triangles.push_back({at(row, k), at(row + 1, k + 1), at(row + 1, k)});
    }
    s.triangles.push_back({bottom, at(0, k + 1), at(0, k)});
    s.triangles.push_back({bottom + 1, at(rows, k), at(rows, k + 1)});
  }
  return s;
}

TEST(PrepareSurface, TakesNoSideOfACoarseTubeForACap) {
  for (const int facets : {8, 12, 15, 16, 17, 20, 24, 32}) {
    for (const double length : {4.0, 6.0, 10.0}) {
      SCOPED_TRACE(testing::Message() << facets << " facets, length " << length);
      const PreparedSurface prepared = prepare_surface(prism(facets, length));
      ASSERT_EQ(prepared.ends.size(), 2u);
      EXPECT_NEAR(std::abs(prepared.ends[0].centre.z() - prepared.ends[1].centre.z()), length, 0.7);
    }
  }
}

}  // namespace
}  // namespace vasohex
