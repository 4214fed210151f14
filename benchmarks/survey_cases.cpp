#include "survey_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "gallery.h"
#include "vasohex/blocks/build_blocks.h"
#include "vasohex/skeleton/read_skeleton.h"

namespace vasohex::survey {
namespace {

using gallery::spherical;

/// A junction's search for better blocks ends there.
const double kGood = BlockOptions{}.good_jacobian;
constexpr double kLeastAngle = 30;

std::vector<Case> random_junctions(std::optional<int> count) {
  std::vector<Case> all;
  for (const auto& [arms, seeds] :
       std::vector<std::array<int, 2>>{{3, 200}, {4, 200}, {5, 200}, {6, 50}, {7, 50}, {8, 50}}) {
    const std::string group = std::string("k").append(std::to_string(arms));
    for (int seed = 1; seed <= std::min(seeds, count.value_or(seeds)); ++seed) {
      all.push_back({Kind::random, group, group + "/" + std::to_string(seed),
                     gallery::random_star(arms, seed, kLeastAngle), kGood});
    }
  }
  return all;
}

std::vector<Case> named_cases() {
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  std::vector<Case> all;
  const auto add = [&](const std::string& name, double goal, const Skeleton& skeleton) {
    all.push_back({Kind::named, "", name, skeleton, goal});
  };
  const auto planar = [](int arms) {
    std::vector<Vec3> directions;
    for (int a = 0; a < arms; ++a) {
      directions.push_back(spherical(360.0 * a / arms, 0));
    }
    return gallery::star(directions, std::vector<double>(arms, 1), 6);
  };
  add("Y 120", .82, planar(3));
  add("iliac", .80, gallery::star({-y, spherical(65, 0), spherical(115, 0)}, {1, .75, .75}, 6));
  add("T", .80, gallery::star({x, -x, y}, {1, 1, 1}, 6));
  add("T, side .25", .79, gallery::star({x, -x, y}, {1, 1, .25}, 6));
  add("Y 20", .65, gallery::star({-x, spherical(10, 0), spherical(-10, 0)}, {1, .8, .8}, 12));
  add("tetrahedral", .75,
      gallery::star({Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)}, {1, 1, 1, 1}, 6));
  add("planar cross", .79, planar(4));
  add("six axes", .75, gallery::star({x, -x, y, -y, z, -z}, {1, 1, 1, 1, 1, 1}, 6));
  add("Willis cycle", .65, read_skeleton(VASOHEX_MESHES "/willis_cycle.json"));
  add("six coplanar", .5, planar(6));
  if (const char* data = std::getenv("VASOHEX_DATA")) {
    add("SixBranch (s11)", .5,
        read_skeleton(std::string(data) + "/s11_six_branch_junction/SixBranch.axes.graph.json"));
  }
  return all;
}

}  // namespace

const std::vector<Kind>& all_kinds() {
  static const std::vector<Kind> kinds{Kind::random, Kind::nasty, Kind::named, Kind::trees};
  return kinds;
}

std::string name_of(Kind kind) {
  switch (kind) {
    case Kind::random:
      return "random";
    case Kind::nasty:
      return "nasty";
    case Kind::named:
      return "named";
    case Kind::trees:
      return "trees";
  }
  return "";
}

std::vector<Case> cases_of(Kind kind, std::optional<int> count) {
  switch (kind) {
    case Kind::random:
      return random_junctions(count);
    case Kind::nasty:
      return {};
    case Kind::named:
      return named_cases();
    case Kind::trees:
      return {};
  }
  return {};
}

}  // namespace vasohex::survey
