#include "vasohex/skeleton/clean.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "vasohex/core/disjoint_sets.h"
#include "vasohex/core/error.h"
#include "vasohex/core/short_text.h"

namespace vasohex {
namespace {

void check(const Skeleton& skeleton) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::bad_input, what); };
  const int n = static_cast<int>(skeleton.points.size());
  if (skeleton.radii.size() != skeleton.points.size()) {
    fail(std::to_string(skeleton.radii.size()) + " radii, must be one for each of the " + std::to_string(n) +
         " points");
  }
  for (int i = 0; i < n; ++i) {
    if (!skeleton.points[i].allFinite()) {
      fail(place_of(skeleton, i) + " is not finite");
    }
    if (!(skeleton.radii[i] > 0) || !std::isfinite(skeleton.radii[i])) {
      fail("radius " + short_text(skeleton.radii[i]) + " at " + place_of(skeleton, i) + ", must be finite and > 0");
    }
  }
  for (std::size_t k = 0; k < skeleton.segments.size(); ++k) {
    for (int p : skeleton.segments[k]) {
      if (p < 0 || p >= n) {
        fail("segment " + std::to_string(k) + " has the point " + std::to_string(p) + ", must be 0 to " +
             std::to_string(n - 1));
      }
    }
  }
  for (const auto& [p, name] : skeleton.names) {
    if (p < 0 || p >= n) {
      fail("name '" + name + "' is for point " + std::to_string(p) + ", must be 0 to " + std::to_string(n - 1));
    }
    if (name.empty()) {
      fail("the name of " + place_of(skeleton, p) + " is empty, must have at least one character");
    }
  }
}

}  // namespace

std::string place_of(const Skeleton& skeleton, int point) {
  return "point " + std::to_string(point) + " " + short_text(skeleton.points[point]);
}

Skeleton clean(const Skeleton& skeleton, std::vector<std::string>& repairs) {
  check(skeleton);
  const int n = static_cast<int>(skeleton.points.size());
  DisjointSets merged(n);
  std::vector<bool> used(n, false);
  for (const auto& [a, b] : skeleton.segments) {
    used[a] = used[b] = true;
    if (a == b) {
      repairs.push_back("segment from " + place_of(skeleton, a) + " to itself dropped");
      continue;
    }
    const double tolerance = 1e-6 * std::min(skeleton.radii[a], skeleton.radii[b]);
    if (merged.find(a) != merged.find(b) && (skeleton.points[a] - skeleton.points[b]).norm() <= tolerance) {
      repairs.push_back(place_of(skeleton, std::max(a, b)) + " coincides with its neighbour " +
                        place_of(skeleton, std::min(a, b)) + ": made one");
      merged.join(a, b);
    }
  }

  Skeleton result = skeleton;
  result.segments.clear();
  std::set<std::array<int, 2>> seen;
  for (const auto& [a, b] : skeleton.segments) {
    const int from = merged.find(a), to = merged.find(b);
    if (from == to) {
      continue;  // reported above
    }
    if (seen.insert({std::min(from, to), std::max(from, to)}).second) {
      result.segments.push_back({from, to});
    } else {
      repairs.push_back("second segment between " + place_of(skeleton, from) + " and " + place_of(skeleton, to) +
                        " dropped");
    }
  }
  for (int i = 0; i < n; ++i) {
    if (!used[i]) {
      repairs.push_back(place_of(skeleton, i) + " has no segment: dropped");
    }
  }
  if (result.segments.empty()) {
    throw Error(ErrorCode::bad_input, "no segment of positive length, at least one is needed");
  }
  result.names.clear();
  for (const auto& [p, name] : skeleton.names) {
    const auto [entry, is_new] = result.names.emplace(merged.find(p), name);
    if (!is_new) {
      throw Error(ErrorCode::bad_input, place_of(skeleton, merged.find(p)) + " has the names '" + entry->second +
                                            "' and '" + name + "', must have one");
    }
  }
  if (result.root) {
    result.root = merged.find(*result.root);
  }
  return result;
}

}  // namespace vasohex
