#include "survey_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "gallery.h"
#include "random_network.h"
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
    const int most = count ? std::max(1, *count * seeds / 200) : seeds;
    for (int seed = 1; seed <= std::min(seeds, most); ++seed) {
      all.push_back({Kind::random, group, group + "/" + std::to_string(seed),
                     gallery::random_star(arms, seed, kLeastAngle), kGood});
    }
  }
  return all;
}

/// As short as it can be: `0.5`, `1`, `20`.
std::string text_of(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::vector<Case> nasty_cases() {
  std::vector<Case> all;
  const auto add = [&](const std::string& group, const std::string& name, const Skeleton& skeleton) {
    all.push_back({Kind::nasty, group, group + " " + name, skeleton, kGood});
  };
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();

  for (const auto& [left, right] : {std::pair(1.0, 1.0), {.8, .8}, {.7, .35}, {1.0, .3}}) {
    for (const double lift : {0, 45, 80}) {
      add("fork 20", text_of(left) + ":" + text_of(right) + " lift " + text_of(lift),
          gallery::fork(20, left, right, lift));
    }
  }

  for (const double angle : {90, 70, 50, 35, 20}) {
    add("5:1", "side branch at " + text_of(angle), gallery::star({x, -x, spherical(angle, 0)}, {1, 1, .2}, 6));
  }
  add("5:1", "two side branches opposite", gallery::star({x, -x, y, -y}, {1, 1, .2, .2}, 6));
  add("5:1", "two side branches across", gallery::star({x, -x, y, z}, {1, 1, .2, .2}, 6));
  add("5:1", "fork 80, thin daughter", gallery::star({-x, spherical(20, 0), spherical(-60, 0)}, {1, .9, .2}, 6));
  add("5:1", "thin into two wide", gallery::star({-x, spherical(60, 0), spherical(-60, 0)}, {.2, 1, 1}, 6));
  add("5:1", "one wide, two thin", gallery::star({-x, spherical(30, 0), spherical(-30, 0)}, {1, .2, .2}, 6));

  for (const double gap : {.5, 1.0}) {
    for (const double twist : {0, 30, 45, 60, 90}) {
      add("link", text_of(gap) + " r, dumbbell, twist " + text_of(twist), gallery::dumbbell(gap, twist));
    }
    for (const double twist : {0, 45, 90, 135, 180}) {
      add("link", text_of(gap) + " r, side branches, twist " + text_of(twist),
          gallery::two_side_branches(gap, twist));
    }
  }

  for (const double length : {.6, .8, 1.1, 1.5}) {
    for (const double twist : {0, 45, 90}) {
      add("stub", text_of(length) + " r, twist " + text_of(twist), gallery::forked_stub(length, twist));
    }
  }

  const double tight = 1 / .9;
  for (const double degrees : {90, 135, 180}) {
    add("bend", text_of(degrees), gallery::bend(tight, degrees, 5).skeleton);
  }
  const auto with_arm = [](gallery::Bend b, int point, const Vec3& direction, double radius) {
    gallery::add_arm(b.skeleton, point, direction, radius, 6);
    return b.skeleton;
  };
  const gallery::Bend u = gallery::bend(tight, 180, 5);
  add("bend", "180, branch 1 r before, outward", with_arm(u, u.begin - 2, -y, .8));
  add("bend", "180, branch 1 r before, across", with_arm(u, u.begin - 2, z, .8));
  add("bend", "180, branch 2 r before, across", with_arm(u, u.begin - 4, z, .8));
  add("bend", "180, branch where it begins, across", with_arm(u, u.begin, z, .8));
  add("bend", "180, branch in its middle, outward", with_arm(u, u.middle, x, .8));
  add("bend", "180, branch in its middle, across", with_arm(u, u.middle, z, .8));
  return all;
}

std::vector<Case> random_networks(std::optional<int> count) {
  constexpr int seeds = 20, junctions = 10;
  std::vector<Case> all;
  for (int seed = 1; seed <= std::min(seeds, count.value_or(seeds)); ++seed) {
    all.push_back(
        {Kind::trees, "tree", "tree/" + std::to_string(seed), gallery::RandomNetwork::grown(seed, junctions), kGood});
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
      return nasty_cases();
    case Kind::named:
      return named_cases();
    case Kind::trees:
      return random_networks(count);
  }
  return {};
}

}  // namespace vasohex::survey
