#include "vasohex/skeleton/straighten.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "vasohex/core/error.h"
#include "vasohex/core/short_text.h"
#include "vasohex/skeleton/clean.h"

namespace vasohex {
namespace {

constexpr double kOneJunction = 0.3;  // largest distance between two junctions that are one, in radii

using Pair = std::array<int, 2>;

Pair pair(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

double length(const Skeleton& skeleton, const PointChain& chain) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    sum += (skeleton.points[chain[i + 1]] - skeleton.points[chain[i]]).norm();
  }
  return sum;
}

/// Mean over the points between the ends, which say more about the branch than its junctions do.
double mean_radius(const Skeleton& skeleton, const PointChain& chain) {
  const std::size_t skip = chain.size() > 2 ? 1 : 0;
  double sum = 0;
  for (std::size_t i = skip; i + skip < chain.size(); ++i) {
    sum += skeleton.radii[chain[i]];
  }
  return sum / static_cast<double>(chain.size() - 2 * skip);
}

/// Removes one closed tube without a hole, if there is one.
bool remove_blind_loop(Skeleton& skeleton, std::vector<std::string>& repairs) {
  const std::vector<PointChain> chains = split(skeleton);
  std::map<Pair, std::size_t> shortest;  // of the branches between two nodes
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const Pair ends = pair(chains[c].front(), chains[c].back());
    double around = length(skeleton, chains[c]), radius = mean_radius(skeleton, chains[c]);
    std::size_t longer = c;
    if (ends[0] != ends[1]) {
      const auto [other, is_first] = shortest.emplace(ends, c);
      if (is_first) {
        continue;
      }
      const double beside = length(skeleton, chains[other->second]);
      radius = (radius + mean_radius(skeleton, chains[other->second])) / 2;
      if (around < beside) {
        std::swap(longer, other->second);
      }
      around += beside;
    }
    if (around <= 2 * std::numbers::pi * radius) {
      repairs.push_back("the branch from " + place_of(skeleton, chains[longer].front()) + " to " +
                        place_of(skeleton, chains[longer].back()) + " closes a loop of length " + short_text(around) +
                        ", too short for a hole at radius " + short_text(radius) + ": dropped");
      remove_chain(skeleton, chains[longer]);
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<PointChain> split(const Skeleton& skeleton) {
  struct Link {
    int point, segment;
  };
  std::vector<std::vector<Link>> links(skeleton.points.size());
  for (int s = 0; s < static_cast<int>(skeleton.segments.size()); ++s) {
    const auto [a, b] = skeleton.segments[s];
    links[a].push_back({b, s});
    links[b].push_back({a, s});
  }
  std::vector<PointChain> chains;
  std::vector<bool> done(skeleton.segments.size(), false);
  const auto walk = [&](int start, Link link) {
    PointChain chain{start};
    for (;;) {
      done[link.segment] = true;
      chain.push_back(link.point);
      const std::vector<Link>& here = links[link.point];
      if (here.size() != 2 || link.point == start) {
        break;
      }
      link = here[0].segment == link.segment ? here[1] : here[0];
    }
    chains.push_back(std::move(chain));
  };
  for (const bool closed : {false, true}) {
    for (int p = 0; p < static_cast<int>(links.size()); ++p) {
      if (closed == (links[p].size() == 2)) {
        for (const Link& link : links[p]) {
          if (!done[link.segment]) {
            walk(p, link);
          }
        }
      }
    }
  }
  return chains;
}

void remove_chain(Skeleton& skeleton, const PointChain& chain) {
  std::set<Pair> gone;
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    gone.insert(pair(chain[i], chain[i + 1]));
  }
  std::erase_if(skeleton.segments, [&](const Pair& s) { return gone.contains(pair(s[0], s[1])); });
}

Skeleton merge_junctions(Skeleton skeleton, std::vector<std::string>& repairs) {
  for (bool merged = true; merged;) {
    merged = false;
    std::vector<int> degree(skeleton.points.size(), 0);
    for (const auto& [a, b] : skeleton.segments) {
      ++degree[a];
      ++degree[b];
    }
    struct Link {
      double distance;  // over the radius
      PointChain chain;
    };
    std::vector<Link> links;
    for (PointChain& chain : split(skeleton)) {
      const int a = chain.front(), b = chain.back();
      const double distance = length(skeleton, chain) / std::max(skeleton.radii[a], skeleton.radii[b]);
      if (a != b && degree[a] > 2 && degree[b] > 2 && distance < kOneJunction) {
        links.push_back({distance, std::move(chain)});
      }
    }
    std::stable_sort(links.begin(), links.end(),
                     [](const Link& x, const Link& y) { return x.distance < y.distance; });
    std::set<int> touched;
    std::map<int, int> instead;
    for (const Link& link : links) {
      int keep = std::min(link.chain.front(), link.chain.back()),
          drop = std::max(link.chain.front(), link.chain.back());
      if (skeleton.radii[drop] > skeleton.radii[keep] * (1 + 1e-9)) {
        std::swap(keep, drop);
      }
      if (touched.contains(keep) || touched.contains(drop)) {
        continue;  // in the next round
      }
      touched.insert({keep, drop});
      instead[drop] = keep;
      remove_chain(skeleton, link.chain);
      repairs.push_back("the junctions at " + place_of(skeleton, drop) + " and at " + place_of(skeleton, keep) +
                        " are " + short_text(std::round(100 * link.distance) / 100) +
                        " radii apart: made one, at the latter");
      merged = true;
    }
    std::set<Pair> seen;
    std::vector<Pair> segments;
    for (Pair s : skeleton.segments) {
      for (int& p : s) {
        const auto other = instead.find(p);
        p = other == instead.end() ? p : other->second;
      }
      if (s[0] == s[1]) {
        continue;
      }
      if (seen.insert(pair(s[0], s[1])).second) {
        segments.push_back(s);
      } else {
        repairs.push_back("with that the segment between " + place_of(skeleton, s[0]) + " and " +
                          place_of(skeleton, s[1]) + " is there twice: one dropped");
      }
    }
    skeleton.segments = std::move(segments);
  }
  return skeleton;
}

Skeleton straighten(Skeleton skeleton, std::vector<std::string>& repairs) {
  while (remove_blind_loop(skeleton, repairs)) {
  }
  if (skeleton.segments.empty()) {
    throw Error(ErrorCode::bad_input,
                "nothing but closed curves too short for a hole, at least one branch is needed");
  }
  return skeleton;
}

}  // namespace vasohex
