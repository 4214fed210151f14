#include "report.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <numeric>

#include "json_point.h"
#include "vasohex/core/atomic_file.h"
#include "vasohex/core/short_text.h"

namespace vasohex::cli {
namespace {

std::string text(const char* format, ...) {
  char line[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  return line;
}

}  // namespace

void add_quality(nlohmann::ordered_json& json, const QualityReport& r, const Network* network) {
  const auto figures = [](const QualityFigures& f) {
    return nlohmann::ordered_json{{"min", f.min}, {"p1", f.p1}, {"mean", f.mean}};
  };
  json["quality"] = {{"scaled_jacobian", figures(r.scaled_jacobian)},
                     {"scaled_jacobian_linear", figures(r.scaled_jacobian_linear)},
                     {"skewness", {{"max", r.skewness.max}, {"p99", r.skewness.p99}, {"mean", r.skewness.mean}}}};
  json["validity"] = {
      {"certified", r.certified}, {"invalid", r.invalid}, {"undecided", r.undecided}, {"bound_min", r.bound_min}};
  auto& worst = json["worst"] = nlohmann::ordered_json::array();
  for (const QualityReport::Element& e : r.worst) {
    nlohmann::ordered_json row{
        {"element", e.element + 1}, {"scaled_jacobian", e.scaled_jacobian}, {"at", xyz(e.centre)}};
    if (network != nullptr && e.branch && *e.branch >= 0) {
      row["branch"] = *e.branch;
    } else if (network != nullptr && e.branch) {
      row["junction"] = network->nodes.at(-1 - *e.branch).point;
    }
    worst.push_back(row);
  }
}

std::string quality_text(const QualityReport& r) {
  std::string out;
  const auto line = [&](const char* name, const QualityFigures& f) {
    out += text("  %-26s min %.3f   1%% %.3f   mean %.3f\n", name, f.min, f.p1, f.mean);
  };
  line("scaled Jacobian", r.scaled_jacobian);
  line("  straight-sided", r.scaled_jacobian_linear);
  out +=
      text("  %-26s max %.3f   99%% %.3f  mean %.3f\n", "skewness", r.skewness.max, r.skewness.p99, r.skewness.mean);
  out += text("  %-26s certified %d   invalid %d   undecided %d\n", "validity", r.certified, r.invalid, r.undecided);
  if (r.invalid + r.undecided > 0) {
    out += "  worst elements (id, scaled Jacobian, place):\n";
    for (const QualityReport::Element& e : r.worst) {
      out += text("    %d  %.4f  (%.6g, %.6g, %.6g)\n", e.element + 1, e.scaled_jacobian, e.centre.x(), e.centre.y(),
                  e.centre.z());
    }
  }
  return out;
}

nlohmann::ordered_json reach_json(const WallReach& r) {
  nlohmann::ordered_json json{{"points", r.points}, {"mean", r.mean}, {"p99", r.p99}, {"max", r.max}};
  auto& places = json["unreached"] = nlohmann::ordered_json::array();
  for (const WallReach::Place& p : r.unreached) {
    places.push_back({{"at", xyz(p.at)}, {"distance", p.distance}, {"radii", p.radii}, {"share", p.share}});
  }
  return json;
}

std::string reach_text(const WallReach& r) {
  if (r.points == 0) {
    return "";
  }
  std::string out =
      text("  %-26s max %.3f   99%% %.3f  mean %.4f radii\n", "lumen to the mesh's wall", r.max, r.p99, r.mean);
  constexpr std::size_t shown = 10;
  if (!r.unreached.empty()) {
    out += text("  not reached, further than %.2f radii from the mesh's wall: %zu place(s)", kReached,
                r.unreached.size());
    out += r.unreached.size() > shown ? ", the worst " + std::to_string(shown) + ":\n" : ":\n";
  }
  for (std::size_t i = 0; i < std::min(shown, r.unreached.size()); ++i) {
    const WallReach::Place& p = r.unreached[i];
    out += text("    %s  %.4g, %.2f radii; %.2g %% of the wall\n", short_text(p.at).c_str(), p.distance, p.radii,
                100 * p.share);
  }
  return out;
}

NetworkCounts count(const Network& network) {
  NetworkCounts c;
  std::vector<int> leader(network.nodes.size());
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](int n) {
    while (leader[n] != n) {
      n = leader[n];
    }
    return n;
  };
  for (const Branch& b : network.branches) {
    leader[find(b.nodes[0])] = find(b.nodes[1]);
  }
  for (std::size_t n = 0; n < network.nodes.size(); ++n) {
    c.components += find(static_cast<int>(n)) == static_cast<int>(n);
    c.ends += network.nodes[n].degree == 1;
    c.junctions += network.nodes[n].degree >= 2 && !network.nodes[n].seam;
  }
  c.loops = static_cast<int>(network.branches.size()) - static_cast<int>(network.nodes.size()) + c.components;
  return c;
}

void write_json(const nlohmann::ordered_json& json, const std::string& path) {
  AtomicFile file(path);
  file.stream() << json.dump(2) << "\n";
  file.commit();
}

}  // namespace vasohex::cli
