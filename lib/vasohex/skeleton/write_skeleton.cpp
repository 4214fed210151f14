#include "vasohex/skeleton/write_skeleton.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <ostream>

#include "vasohex/core/atomic_file.h"
#include "vasohex/core/error.h"
#include "vasohex/core/short_text.h"
#include "vasohex/core/text_lines.h"
#include "vasohex/skeleton/straighten.h"

namespace vasohex {
namespace {

std::string exact(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::vector<std::vector<int>> neighbours_of(const Skeleton& skeleton) {
  std::vector<std::vector<int>> neighbours(skeleton.points.size());
  for (const auto& [a, b] : skeleton.segments) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  return neighbours;
}

/// Points in the order in which they become roots, if they have no parent by then.
std::vector<int> by_rank_as_root(const Skeleton& skeleton, const std::vector<std::vector<int>>& neighbours) {
  std::vector<int> order;
  for (int i = 0; i < static_cast<int>(skeleton.points.size()); ++i) {
    if (!neighbours[i].empty()) {
      order.push_back(i);
    }
  }
  const auto rank = [&](int i) {
    const auto name = skeleton.names.find(i);
    return i == skeleton.root                                        ? 0
           : name != skeleton.names.end() && name->second == "inlet" ? 1
           : neighbours[i].size() == 1                               ? 2
                                                                     : 3;
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return rank(a) != rank(b) ? rank(a) < rank(b) : skeleton.radii[a] > skeleton.radii[b];
  });
  return order;
}

void write_swc(std::ostream& out, const Skeleton& skeleton) {
  const std::vector<std::vector<int>> neighbours = neighbours_of(skeleton);
  out << "# id type x y z radius parent\n";
  if (!skeleton.units.empty()) {
    out << "# units: " << skeleton.units << '\n';
  }
  std::vector<int> number(skeleton.points.size(), 0);  // 0: not yet met
  int count = 0;
  for (const int root : by_rank_as_root(skeleton, neighbours)) {
    if (number[root] > 0) {
      continue;
    }
    std::vector<std::pair<int, int>> open{{root, -1}};  // point, its parent
    while (!open.empty()) {
      const auto [i, parent] = open.back();
      open.pop_back();
      if (number[i] > 0) {
        throw Error(ErrorCode::bad_input, "the skeleton has a cycle through " + short_text(skeleton.points[i]) +
                                              ", SWC holds trees: write it as .json");
      }
      number[i] = ++count;
      const Vec3& p = skeleton.points[i];
      out << count << " 0 " << exact(p.x()) << ' ' << exact(p.y()) << ' ' << exact(p.z()) << ' '
          << exact(skeleton.radii[i]) << ' ' << (parent < 0 ? -1 : number[parent]) << '\n';
      for (auto next = neighbours[i].rbegin(); next != neighbours[i].rend(); ++next) {
        if (*next != parent) {
          open.emplace_back(*next, i);
        }
      }
    }
  }
}

void write_json(std::ostream& out, const Skeleton& skeleton) {
  nlohmann::ordered_json file;
  file["format"] = "vascular-graph-1";
  if (!skeleton.units.empty()) {
    file["units"] = skeleton.units;
  }
  for (const Vec3& p : skeleton.points) {
    file["points"].push_back({p.x(), p.y(), p.z()});
  }
  file["radius"] = skeleton.radii;
  file["branches"] = split(skeleton);
  for (const auto& [point, name] : skeleton.names) {
    file["names"][std::to_string(point)] = name;
  }
  out << file.dump() << '\n';
}

}  // namespace

void write_skeleton(const std::string& path, const Skeleton& skeleton) {
  const std::string extension = lower_extension(path);
  if (extension != ".swc" && extension != ".json") {
    throw Error(ErrorCode::bad_input, "skeleton " + path + ": extension must be .swc or .json");
  }
  with_context("skeleton " + path, [&] {
    AtomicFile file(path);
    extension == ".swc" ? write_swc(file.stream(), skeleton) : write_json(file.stream(), skeleton);
    file.commit();
  });
}

}  // namespace vasohex
