#include "vasohex/skeleton/build_network.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "vasohex/core/disjoint_sets.h"
#include "vasohex/core/error.h"
#include "vasohex/core/short_text.h"
#include "vasohex/skeleton/clean.h"
#include "vasohex/skeleton/leave_out.h"
#include "vasohex/skeleton/loops.h"
#include "vasohex/skeleton/sample_axis.h"
#include "vasohex/skeleton/smooth_path.h"
#include "vasohex/skeleton/straighten.h"

namespace vasohex {
namespace {

constexpr double kLargestBend = 40 * std::numbers::pi / 180;    // of a vessel that goes straight on at a junction
constexpr double kClearlyBest = 15 * std::numbers::pi / 180;    // no other pair may come that close
constexpr double kRadiusPenalty = 30 * std::numbers::pi / 180;  // per factor e between the radii
constexpr double kWorthALine = 0.1;  // a displacement, in radii
constexpr double kWiderNode = 1.15;  // a node this much wider than its branch says nothing about the branch

/// A chain of points between two nodes, or around a closed curve (first and last point are the seam).
struct Chain {
  std::array<int, 2> nodes{};
  std::vector<int> points;
  std::vector<double> radii;       ///< its own, see own_radii
  std::array<bool, 2> narrowed{};  ///< at its start and end: the node's radius is not its own
};

/// End `side` (0: start, 1: end) of chain `chain`.
struct ChainEnd {
  int chain = 0;
  int side = 0;
};

struct Topology {
  std::vector<NetworkNode> nodes;
  std::vector<Chain> chains;
};

Topology topology_of(const Skeleton& skeleton) {
  Topology topology;
  std::map<int, NetworkNode> node_at;
  for (PointChain& points : split(skeleton)) {
    for (int p : {points.front(), points.back()}) {
      NetworkNode& node = node_at[p];
      node.position = skeleton.points[p];
      node.point = p;
      ++node.degree;
    }
    Chain chain;
    chain.points = std::move(points);
    topology.chains.push_back(std::move(chain));
  }
  std::map<int, int> index_of;
  for (auto& [p, node] : node_at) {
    node.seam = node.degree == 2;  // otherwise two segments do not make a node
    index_of[p] = static_cast<int>(topology.nodes.size());
    topology.nodes.push_back(node);
  }
  for (Chain& chain : topology.chains) {
    chain.nodes = {index_of[chain.points.front()], index_of[chain.points.back()]};
  }
  return topology;
}

/// Lengths of a chain's polyline up to each point.
std::vector<double> chain_length(const Skeleton& skeleton, const std::vector<int>& points) {
  std::vector<Vec3> positions;
  for (int p : points) {
    positions.push_back(skeleton.points[p]);
  }
  return polyline_length(positions, false);
}

/// Sets the radii of a chain. A skeleton has one radius per point, at a junction that of the widest branch or of the
/// ball that fills the junction; where that is not this branch's, its own radius farther on takes the place.
void own_radii(const Skeleton& skeleton, const Topology& topology, Chain& chain, std::vector<std::string>& repairs) {
  const int last = static_cast<int>(chain.points.size()) - 1;
  for (int p : chain.points) {
    chain.radii.push_back(skeleton.radii[p]);
  }
  const std::vector<double> raw = chain.radii;
  const std::vector<double> arc = chain_length(skeleton, chain.points);
  for (int side = 0; side < 2; ++side) {
    const NetworkNode& node = topology.nodes[chain.nodes[side]];
    if (node.degree == 1 || node.seam) {
      continue;
    }
    const auto at = [&](int k) { return side == 0 ? k : last - k; };  // k-th point from the node
    const auto distance = [&](int k) { return std::abs(arc[at(k)] - arc[at(0)]); };
    const double wide = raw[at(0)];
    // beyond the middle of a branch between two junctions the other one rules
    const bool between = topology.nodes[chain.nodes[1 - side]].degree > 1;
    const double reach = std::min(wide, arc[last] * (between ? 0.5 : 1.0));
    int k = 1;
    while (k < last && distance(k) < reach) {
      ++k;
    }
    const double fraction = (reach - distance(k - 1)) / (distance(k) - distance(k - 1));
    const double there = raw[at(k - 1)] + std::min(fraction, 1.0) * (raw[at(k)] - raw[at(k - 1)]);
    if (wide <= kWiderNode * there) {
      continue;
    }
    // the first point out of reach if there is one before the next node, otherwise the value in between
    const double own = k < last || !between ? std::min(raw[at(k)], there) : there;
    for (int i = 0; i < k && i <= last; ++i) {
      chain.radii[at(i)] = std::min(chain.radii[at(i)], own);
    }
    chain.narrowed[side] = true;
    repairs.push_back("the branch from " + place_of(skeleton, chain.points[at(0)]) + " towards " +
                      place_of(skeleton, chain.points[at(1)]) + " starts with its own radius " + short_text(own) +
                      ", not with that of the junction, " + short_text(wide));
  }
}

/// Which branch end continues which at the junctions: partner of 2 * chain + side, or -1.
std::vector<int> continuations(const Skeleton& skeleton, const Topology& topology) {
  const int count = 2 * static_cast<int>(topology.chains.size());
  std::vector<std::vector<int>> ends_at(topology.nodes.size());
  std::vector<Vec3> direction(count);
  std::vector<double> radius(count);
  for (int e = 0; e < count; ++e) {
    const Chain& chain = topology.chains[e / 2];
    const NetworkNode& node = topology.nodes[chain.nodes[e % 2]];
    ends_at[chain.nodes[e % 2]].push_back(e);
    // the direction over one radius of the node: noise of the first points does not matter
    std::vector<int> points = chain.points;
    std::vector<double> radii = chain.radii;
    if (e % 2 == 1) {
      std::reverse(points.begin(), points.end());
      std::reverse(radii.begin(), radii.end());
    }
    const std::vector<double> arc = chain_length(skeleton, points);
    const double s = std::min(skeleton.radii[node.point], arc.back() / (chain.nodes[0] == chain.nodes[1] ? 2 : 1));
    std::size_t k = 1;
    while (k + 1 < points.size() && arc[k] < s) {
      ++k;
    }
    const double u = (s - arc[k - 1]) / (arc[k] - arc[k - 1]);
    direction[e] = ((1 - u) * skeleton.points[points[k - 1]] + u * skeleton.points[points[k]] - node.position);
    direction[e].normalize();
    radius[e] = (1 - u) * radii[k - 1] + u * radii[k];
  }

  std::vector<int> partner(count, -1);
  for (std::size_t n = 0; n < topology.nodes.size(); ++n) {
    const std::vector<int>& ends = ends_at[n];
    if (topology.nodes[n].seam) {
      partner[ends[0]] = ends[1];
      partner[ends[1]] = ends[0];
      continue;
    }
    struct Pair {
      double cost;
      int a, b;
    };
    std::vector<Pair> pairs;
    const auto bend = [&](int a, int b) { return std::numbers::pi - angle_between(direction[a], direction[b]); };
    for (std::size_t i = 0; i < ends.size(); ++i) {
      for (std::size_t j = i + 1; j < ends.size(); ++j) {
        const int a = ends[i], b = ends[j];
        pairs.push_back({bend(a, b) + kRadiusPenalty * std::abs(std::log(radius[a] / radius[b])), a, b});
      }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) { return x.cost < y.cost; });
    for (const Pair& pair : pairs) {
      if (partner[pair.a] >= 0 || partner[pair.b] >= 0 || bend(pair.a, pair.b) > kLargestBend) {
        continue;
      }
      // at a symmetric fork neither of the two goes on straighter: all three keep their own directions
      const bool ambiguous = std::any_of(pairs.begin(), pairs.end(), [&](const Pair& other) {
        const int shared = (other.a == pair.a || other.a == pair.b) + (other.b == pair.a || other.b == pair.b);
        return shared == 1 && partner[other.a] < 0 && partner[other.b] < 0 && other.cost < pair.cost + kClearlyBest;
      });
      if (!ambiguous) {
        partner[pair.a] = pair.b;
        partner[pair.b] = pair.a;
      }
    }
  }
  return partner;
}

/// Chains that continue each other, entered at the given ends, in order; a closed path returns to its first chain.
struct Path {
  std::vector<ChainEnd> chains;
  bool closed = false;
};

std::vector<Path> paths_of(const Topology& topology, const std::vector<int>& partner) {
  std::vector<Path> paths;
  std::vector<bool> done(topology.chains.size(), false);
  const auto follow = [&](int end) {
    Path path;
    const int start = end;
    while (end >= 0 && !done[end / 2]) {
      done[end / 2] = true;
      path.chains.push_back({end / 2, end % 2});
      end = partner[end ^ 1];
    }
    path.closed = end == start;
    paths.push_back(std::move(path));
  };
  for (int e = 0; e < static_cast<int>(partner.size()); ++e) {
    if (partner[e] < 0 && !done[e / 2]) {
      follow(e);
    }
  }
  for (int e = 0; e < static_cast<int>(partner.size()); e += 2) {
    if (!done[e / 2]) {
      follow(e);
    }
  }
  return paths;
}

/// The largest change of a kind over the network.
struct Largest {
  double value = 0;
  int point = -1;
  void add(double v, int p) {
    if (v > value) {
      value = v;
      point = p;
    }
  }
};

struct Changes {
  Largest moved;     ///< over the radius
  Largest smoothed;  ///< relative change of the radius
  Largest lowered;   ///< relative
  Largest rounded;   ///< distance of the axis from straight edges, over the radius
  int straightened = 0;
  std::vector<Largest> bends;  ///< rounded: displacement over the radius
  std::vector<Largest> left_out;  ///< points: distance from the axis over the radius
};

/// The stretch of a curve between the nodes at parameters `at.front()` and `at.back()`, with radii given at some
/// parameters. Knots in between take theirs from the interpolant.
AxisPiece piece_between(const SpaceSpline& spline, const std::vector<double>& at, const std::vector<double>& radii) {
  const std::vector<double> slopes = monotone_slopes(at, radii);
  const auto knot = [&](double t) {
    return static_cast<std::size_t>(std::lower_bound(spline.t.begin(), spline.t.end(), t) - spline.t.begin());
  };
  AxisPiece piece{knot(at.front()), knot(at.back()), {}, {}};
  std::size_t i = 0;
  for (std::size_t k = piece.first; k <= piece.last; ++k) {
    while (i + 2 < at.size() && at[i + 1] <= spline.t[k]) {
      ++i;
    }
    const double h = at[i + 1] - at[i], u = (spline.t[k] - at[i]) / h;
    piece.radii.push_back(hermite(radii[i], slopes[i], radii[i + 1], slopes[i + 1], h, u));
    piece.slopes.push_back(hermite_derivative(radii[i], slopes[i], radii[i + 1], slopes[i + 1], h, u));
  }
  return piece;
}

template <class T>
std::vector<T> oriented(const std::vector<T>& values, int side) {
  return side == 0 ? values : std::vector<T>(values.rbegin(), values.rend());
}

void add_branches(const Skeleton& skeleton, const Topology& topology, Path path, std::vector<Branch>& branches,
                  Changes& changes) {
  const auto breaks_before = [&](std::size_t k) {  // the radius may jump between chain k - 1 and chain k
    const ChainEnd& before = path.chains[(k + path.chains.size() - 1) % path.chains.size()];
    return topology.chains[before.chain].narrowed[1 - before.side] ||
           topology.chains[path.chains[k].chain].narrowed[path.chains[k].side];
  };
  if (path.closed) {
    for (std::size_t k = 0; k < path.chains.size(); ++k) {
      if (breaks_before(k)) {
        std::rotate(path.chains.begin(), path.chains.begin() + static_cast<std::ptrdiff_t>(k), path.chains.end());
        break;
      }
    }
  }

  // Knots of the path; those of a chain are starts[k] .. starts[k + 1]
  std::vector<int> points;
  std::vector<std::size_t> starts{0};
  for (const ChainEnd& end : path.chains) {
    const std::vector<int> own = oriented(topology.chains[end.chain].points, end.side);
    points.insert(points.end(), own.begin() + (points.empty() ? 0 : 1), own.end());
    starts.push_back(points.size() - 1);
  }
  PathPoints curve;
  curve.closed = path.closed;
  const std::size_t n = points.size() - (path.closed ? 1 : 0);
  for (std::size_t i = 0; i < n; ++i) {
    curve.points.push_back(skeleton.points[points[i]]);
  }
  curve.fixed.assign(n, false);
  for (std::size_t s : starts) {
    curve.fixed[s % n] = true;
  }
  const std::vector<double> t = polyline_length(curve.points, curve.closed);

  // Radii, in runs of chains between which they do not jump
  struct RadiusRun {
    std::size_t begin = 0, end = 0;  // chains
    bool closed = false;
    std::vector<double> radii;
  };
  const auto stretch = [&](const std::vector<double>& values, std::size_t begin, std::size_t end) {
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(starts[begin]),
                               values.begin() + static_cast<std::ptrdiff_t>(starts[end]) + 1);
  };
  std::vector<RadiusRun> runs;
  std::vector<double> scale(n, std::numeric_limits<double>::infinity());
  const auto limit_slopes = [&](RadiusRun& run, const std::vector<double>& at) {
    const std::vector<double> before = run.radii;
    run.radii = limit_slope(stretch(at, run.begin, run.end), before, run.closed);
    for (std::size_t i = 0; i < run.radii.size(); ++i) {
      changes.lowered.add(1 - run.radii[i] / before[i], points[starts[run.begin] + i]);
      double& smallest = scale[(starts[run.begin] + i) % n];
      smallest = std::min(smallest, run.radii[i]);
    }
  };
  for (std::size_t begin = 0, end = 0; begin < path.chains.size(); begin = end) {
    end = begin + 1;
    while (end < path.chains.size() && !breaks_before(end)) {
      ++end;
    }
    RadiusRun run{begin, end, path.closed && begin == 0 && end == path.chains.size() && !breaks_before(0), {}};
    std::vector<double> raw;
    for (std::size_t k = begin; k < end; ++k) {
      const std::vector<double> own = oriented(topology.chains[path.chains[k].chain].radii, path.chains[k].side);
      raw.insert(raw.end(), own.begin() + (raw.empty() ? 0 : 1), own.end());
    }
    if (run.closed) {
      raw.pop_back();
    }
    run.radii = smooth_radii(stretch(t, begin, end), raw, run.closed);
    for (std::size_t i = 0; i < raw.size(); ++i) {
      changes.smoothed.add(std::abs(run.radii[i] / raw[i] - 1), points[starts[begin] + i]);
    }
    limit_slopes(run, t);
    runs.push_back(std::move(run));
  }

  const PathCurve near = curve_near(curve, scale);
  for (std::size_t i = 0; i < n; ++i) {
    changes.moved.add(near.moved[i], points[i]);
  }
  for (const PathBend& bend : near.bends) {
    changes.bends.push_back({bend.moved, points[bend.point]});
  }
  for (const PathBend& point : near.left_out) {
    changes.left_out.push_back({point.moved, points[point.point]});
  }
  changes.straightened += near.straightened;
  changes.rounded.add(near.off_edge, points[near.off_edge_at]);

  std::vector<std::vector<double>> radii(path.chains.size());
  for (RadiusRun& run : runs) {
    limit_slopes(run, near.t);  // where a bend was rounded, points are nearer to each other
    if (run.closed) {
      run.radii.push_back(run.radii.front());
    }
    for (std::size_t k = run.begin; k < run.end; ++k) {
      radii[k].assign(run.radii.begin() + static_cast<std::ptrdiff_t>(starts[k] - starts[run.begin]),
                      run.radii.begin() + static_cast<std::ptrdiff_t>(starts[k + 1] - starts[run.begin]) + 1);
    }
  }
  for (std::size_t k = 0; k < path.chains.size(); ++k) {
    const auto [chain, side] = path.chains[k];
    Branch branch = sample_axis(near.spline, piece_between(near.spline, stretch(near.t, k, k + 1), radii[k]));
    if (side == 1) {
      std::reverse(branch.points.begin(), branch.points.end());
      std::reverse(branch.radii.begin(), branch.radii.end());
      std::reverse(branch.tangents.begin(), branch.tangents.end());
      std::reverse(branch.arc.begin(), branch.arc.end());
      const double length = branch.arc.front();
      for (std::size_t i = 0; i < branch.arc.size(); ++i) {
        branch.arc[i] = length - branch.arc[i];
        branch.tangents[i] = -branch.tangents[i];
      }
    }
    branch.nodes = topology.chains[chain].nodes;
    branches[chain] = std::move(branch);
  }
}

double volume(const Branch& branch) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < branch.arc.size(); ++i) {
    const double a = branch.radii[i], b = branch.radii[i + 1];
    sum += std::numbers::pi / 3 * (a * a + a * b + b * b) * (branch.arc[i + 1] - branch.arc[i]);
  }
  return sum;
}

/// Names that the skeleton gives, at the nodes.
void give_names(const Skeleton& skeleton, Network& network) {
  std::map<int, std::size_t> end_at;
  for (std::size_t n = 0; n < network.nodes.size(); ++n) {
    if (network.nodes[n].degree == 1) {
      end_at[network.nodes[n].point] = n;
    }
  }
  std::map<std::string, int> point_of;
  for (const auto& [point, name] : skeleton.names) {
    const auto end = end_at.find(point);
    if (end == end_at.end()) {
      throw Error(ErrorCode::bad_input, "the name '" + name + "' is given for " + place_of(skeleton, point) +
                                            ", which is not an end of a vessel");
    }
    const auto [other, is_new] = point_of.emplace(name, point);
    if (!is_new) {
      throw Error(ErrorCode::bad_input, "the name '" + name + "' is given to " + place_of(skeleton, other->second) +
                                            " and to " + place_of(skeleton, point) + ", names must be unique");
    }
    network.nodes[end->second].name = name;
  }
}

/// Names of the ends that have none yet.
void choose_names(const Skeleton& skeleton, const Run& run, Network& network) {
  const int count = static_cast<int>(network.nodes.size());
  DisjointSets component(count);
  for (const Branch& branch : network.branches) {
    component.join(branch.nodes[0], branch.nodes[1]);
  }
  struct Component {
    double volume = 0;
    std::vector<int> ends;  // ascending by point, as nodes are
  };
  std::map<int, Component> by_root;
  for (const Branch& branch : network.branches) {
    by_root[component.find(branch.nodes[0])].volume += volume(branch);
  }
  std::set<std::string> taken;
  for (int n = 0; n < count; ++n) {
    if (network.nodes[n].degree == 1 && !network.nodes[n].blind) {
      by_root[component.find(n)].ends.push_back(n);
      taken.insert(network.nodes[n].name);
    }
  }
  std::vector<Component> components;
  for (auto& [first_node, value] : by_root) {
    components.push_back(std::move(value));
  }
  // sizes that differ by rounding alone keep the order of the points
  std::stable_sort(components.begin(), components.end(), [](const Component& a, const Component& b) {
    return static_cast<float>(a.volume) > static_cast<float>(b.volume);
  });

  const auto next_name = [&](const std::string& stem, int& number) {
    std::string name;
    do {
      name = stem == "inlet" && number == 1 ? stem : stem + "_" + std::to_string(number);
      ++number;
    } while (!taken.insert(name).second);
    return name;
  };
  int inlet_number = 1, outlet_number = 1;
  for (const Component& c : components) {
    const bool has_inlet =
        std::any_of(c.ends.begin(), c.ends.end(), [&](int n) { return network.nodes[n].name.starts_with("inlet"); });
    std::vector<int> open;
    std::copy_if(c.ends.begin(), c.ends.end(), std::back_inserter(open),
                 [&](int n) { return network.nodes[n].name.empty(); });
    if (!has_inlet && !open.empty()) {
      int inlet = open[0];
      bool is_root = false;
      for (int n : open) {
        if (skeleton.root && network.nodes[n].point == *skeleton.root) {
          inlet = n;
          is_root = true;
          break;
        }
        if (network.nodes[n].radius > network.nodes[inlet].radius * (1 + 1e-9)) {
          inlet = n;
        }
      }
      NetworkNode& node = network.nodes[inlet];
      node.name = next_name("inlet", inlet_number);
      if (!is_root) {
        const std::string note = "note: " + node.name + " chosen: end at " + place_of(skeleton, node.point) +
                                 ", the largest radius " + short_text(node.radius) +
                                 "; name it with names/--inlet to change it";
        run.log(note);
        network.repairs.push_back(note);
      }
    }
    for (int n : open) {
      if (network.nodes[n].name.empty()) {
        network.nodes[n].name = next_name("outlet", outlet_number);
      }
    }
  }
}

/// Nodes and branches of a clean skeleton, without names.
Network assemble(const Skeleton& skeleton, const Run& run) {
  Network network;
  network.units = skeleton.units;
  Topology topology = topology_of(skeleton);
  for (Chain& chain : topology.chains) {
    own_radii(skeleton, topology, chain, network.repairs);
  }
  const std::vector<Path> paths = paths_of(topology, continuations(skeleton, topology));

  network.branches.resize(topology.chains.size());
  Changes changes;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    run.progress("network", static_cast<double>(i) / static_cast<double>(paths.size()));
    add_branches(skeleton, topology, paths[i], network.branches, changes);
  }
  network.nodes = std::move(topology.nodes);
  for (const Branch& branch : network.branches) {
    for (int side = 0; side < 2; ++side) {
      double& radius = network.nodes[branch.nodes[side]].radius;
      radius = std::max(radius, side == 0 ? branch.radii.front() : branch.radii.back());
    }
  }

  const auto report = [&](const Largest& largest, double threshold, const std::string& text, double factor,
                          const std::string& unit) {
    if (largest.value > threshold) {
      network.repairs.push_back(text + short_text(std::round(factor * largest.value * 100) / 100) + unit +
                                ", most at " + place_of(skeleton, largest.point));
    }
  };
  report(changes.moved, 0.01, "smoothing moved points by up to ", 1, " radii");
  report(changes.smoothed, 0.01, "smoothing changed radii by up to ", 100, " %");
  report(changes.lowered, 0.01, "radii that change by more than 0.75 per length lowered by up to ", 100, " %");
  for (std::vector<Largest>* list : {&changes.bends, &changes.left_out}) {
    std::stable_sort(list->begin(), list->end(), [](const Largest& a, const Largest& b) { return a.value > b.value; });
  }
  for (const Largest& point : changes.left_out) {
    network.repairs.push_back(place_of(skeleton, point.point) +
                              " left out: a tube through it would bend too sharply; it is " +
                              short_text(std::round(100 * point.value) / 100) + " radii from the axis");
  }
  for (const Largest& bend : changes.bends) {
    if (bend.value > kWorthALine) {
      network.repairs.push_back("the bend at " + place_of(skeleton, bend.point) +
                                " is too sharp for a tube: rounded, which moves the axis by " +
                                short_text(std::round(100 * bend.value) / 100) + " radii");
    }
  }
  if (changes.straightened > 0) {
    network.repairs.push_back("note: between points far apart the axis is straight, on " +
                              std::to_string(changes.straightened) + " stretches; corners are rounded, " +
                              short_text(std::round(100 * changes.rounded.value) / 100) +
                              " radii off the line at most, at " + place_of(skeleton, changes.rounded.point));
  }
  return network;
}

}  // namespace

Network build_network(const Skeleton& input, const NetworkOptions& options, const Run& run) {
  Skeleton skeleton = input;
  for (const auto& [point, name] : options.names) {
    skeleton.names[point] = name;
  }
  if (options.inlet) {
    skeleton.names[*options.inlet] = "inlet";
  }
  std::vector<std::string> repairs;
  skeleton = straighten(merge_junctions(clean(skeleton, repairs), repairs), repairs);
  Network network = assemble(skeleton, run);
  // what is filled can be seen only of the axes and radii as they will be
  for (auto loops = filled_loops(network); !loops.empty(); loops = filled_loops(network)) {
    const std::vector<PointChain> chains = split(skeleton);  // one for each branch
    for (const FilledLoop& loop : loops) {
      remove_chain(skeleton, chains[loop.leave_out]);
      repairs.push_back(loop.text);
    }
    skeleton = straighten(std::move(skeleton), repairs);
    network = assemble(skeleton, run);
  }
  network.repairs.insert(network.repairs.begin(), repairs.begin(), repairs.end());
  give_names(skeleton, network);
  for (NetworkNode& node : network.nodes) {
    node.blind = node.degree == 1 && options.blind.contains(node.point);
  }
  choose_names(skeleton, run, network);
  run.progress("network", 1);
  return network;
}

}  // namespace vasohex
