#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "commands.h"
#include "findings.h"
#include "input.h"
#include "json_point.h"
#include "option_checks.h"
#include "report.h"

namespace vasohex::cli {
namespace {

struct InfoCommand {
  Input input;
  std::string json;
};

void run_info(const InfoCommand& c, Common& common) {
  if (!c.json.empty()) {
    check_outputs(c.input.files(), {c.json});
  }
  const Run run = common.run();
  const Loaded loaded = load(c.input, run);
  const Skeleton& skeleton = loaded.skeleton;
  NetworkOptions options;
  options.inlet = c.input.inlet;
  Network network = with_context(c.input.path, [&] { return build_network(skeleton, options, run); });
  network.repairs.insert(network.repairs.begin(), loaded.repairs.begin(), loaded.repairs.end());
  const std::vector<Finding> findings = diagnose(network);
  const NetworkCounts counts = count(network);
  std::map<int, int> degrees;
  double length = 0, least = network.branches[0].radii[0], most = least;
  Box box;
  for (const NetworkNode& n : network.nodes) {
    if (n.degree > 1 && !n.seam) {
      ++degrees[n.degree];
    }
  }
  for (const Branch& b : network.branches) {
    length += b.length();
    const auto [low, high] = std::minmax_element(b.radii.begin(), b.radii.end());
    least = std::min(least, *low);
    most = std::max(most, *high);
    for (const Vec3& p : b.points) {
      box.add(p);
    }
  }
  nlohmann::ordered_json j;
  j["input"] = c.input.path;
  if (loaded.lumen) {
    j["lumen"] = *loaded.figures;
  }
  j["units"] = network.units;
  j["points"] = skeleton.points.size();
  j["branches"] = network.branches.size();
  j["components"] = counts.components;
  j["loops"] = counts.loops;
  auto& by_degree = j["junctions_by_degree"] = nlohmann::ordered_json::object();
  for (const auto& [degree, number] : degrees) {
    by_degree[std::to_string(degree)] = number;
  }
  auto& ends = j["ends"] = nlohmann::ordered_json::array();
  for (const NetworkNode& n : network.nodes) {
    if (n.degree == 1) {
      ends.push_back({{"name", n.name}, {"point", n.point}, {"at", xyz(n.position)}, {"radius", n.radius}});
    }
  }
  j["length"] = length;
  j["radius"] = {{"min", least}, {"max", most}};
  j["box"] = {{"min", xyz(box.min)}, {"max", xyz(box.max)}};
  j["repairs"] = network.repairs;
  j["findings"] = findings_json(findings);
  if (!c.json.empty()) {
    write_json(j, c.json);
  }
  common.end_progress();
  if (common.quiet) {
    return;
  }
  std::printf("%s: %zu points, %zu branches, %d component(s), %d loop(s), unit %s\n", c.input.path.c_str(),
              skeleton.points.size(), network.branches.size(), counts.components, counts.loops,
              network.units.empty() ? "not stated" : network.units.c_str());
  for (const auto& [degree, number] : degrees) {
    std::printf("  %d junction(s) of %d branches\n", number, degree);
  }
  std::printf("  length %.6g, radius %.6g to %.6g, box (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g)\n", length, least,
              most, box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z());
  for (const NetworkNode& n : network.nodes) {
    if (n.degree == 1) {
      std::printf("  end %-10s point %d at (%.6g, %.6g, %.6g), radius %.6g\n", n.name.c_str(), n.point,
                  n.position.x(), n.position.y(), n.position.z(), n.radius);
    }
  }
  for (const std::string& repair : network.repairs) {
    std::printf("  %s\n", repair.c_str());
  }
  std::printf("%s", findings_text(findings).c_str());
}

}  // namespace

void add_info_command(CLI::App& app, Common& common) {
  CLI::App* command =
      app.add_subcommand("info", "What is in a skeleton, surface or labelmap, and what is wrong with it");
  auto c = std::make_shared<InfoCommand>();
  c->input.add_to(*command);
  command->add_option("--json", c->json, "File for the figures");
  common.add_to(*command, [c, &common] { run_info(*c, common); });
}

}  // namespace vasohex::cli
