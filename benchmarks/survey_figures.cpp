#include "survey_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "vasohex/core/error.h"
#include "vasohex/quality/quality_report.h"

namespace vasohex::survey {
namespace {

constexpr int kElementsPerEdge = 6;

std::string number(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// What is wrong with the mesh, apart from its figures; empty: nothing.
std::string faults(const Figures& f) {
  if (!f.error.empty()) {
    return "no mesh: " + f.error;
  }
  std::string text;
  for (const auto& [count, what] : {std::pair(f.faulty, "elements"), {f.faulty_blocks, "blocks"}}) {
    if (count > 0) {
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what + " not certified";
    }
  }
  if (f.unconverged > 0) {
    text += (text.empty() ? "" : ", ") + std::to_string(f.unconverged) + " nodes off the surface";
  }
  return text;
}

/// Part `fraction` of the values lies below, interpolated between ranks. No values: NaN.
double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) {
    return std::nan("");
  }
  std::sort(values.begin(), values.end());
  const double rank = fraction * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(rank);
  const auto high = std::min(low + 1, values.size() - 1);
  return values[low] + (rank - static_cast<double>(low)) * (values[high] - values[low]);
}

std::vector<double> values_of(const std::vector<const Figures*>& rows,
                              const std::function<double(const Figures&)>& value) {
  std::vector<double> values;
  for (const Figures* f : rows) {
    if (f->error.empty()) {
      values.push_back(value(*f));
    }
  }
  return values;
}

/// Percent, rounded down: 100 % means all.
std::string certified_part(const std::vector<const Figures*>& rows) {
  const auto good = std::count_if(rows.begin(), rows.end(), [](const Figures* f) { return f->certified(); });
  return number(std::floor(1000.0 * static_cast<double>(good) / static_cast<double>(rows.size())) / 10, 1) + " %";
}

/// Rows of one group and one order, as they came.
std::vector<std::pair<std::pair<std::string, int>, std::vector<const Figures*>>> by_group_and_order(
    const std::vector<Figures>& figures) {
  std::vector<std::pair<std::pair<std::string, int>, std::vector<const Figures*>>> groups;
  for (const Figures& f : figures) {
    const std::pair key(f.subject->group, f.order);
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == key; });
    if (group == groups.end()) {
      group = groups.insert(groups.end(), {key, {}});
    }
    group->second.push_back(&f);
  }
  return groups;
}

using Cells = std::vector<std::string>;

std::string row_of(const Cells& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) {
    text.append(" ").append(cell).append(" |");
  }
  return text + "\n";
}

std::string head_of(const Cells& names) { return row_of(names) + row_of(Cells(names.size(), "---")); }

double cpu_ms(const Figures& f) { return 1e3 * f.cpu_seconds / std::max(1, f.junctions); }

std::string certified_cell(const Figures& f) {
  return faults(f).empty() ? "all" : (f.certified() ? "all; **" : "**") + faults(f) + "**";
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::string random_table(const std::vector<Figures>& figures) {
  std::string text =
      "Branches in random directions at least 30 degrees apart, radii up to 2:1. Per junction the least scaled\n"
      "Jacobian of its mesh is taken; *CPU*: of the junction's optimisation; *tried*: arrangements of cubes, "
      "mean.\n\n" +
      head_of({"branches", "order", "junctions", "certified", "min", "5 %", "median", "CPU ms median", "CPU ms 95 %",
               "tried"});
  for (const auto& [key, rows] : by_group_and_order(figures)) {
    const auto least = values_of(rows, [](const Figures& f) { return f.min; });
    const auto cpu = values_of(rows, cpu_ms);
    const auto tried = values_of(rows, [](const Figures& f) { return f.candidates; });
    text +=
        row_of({key.first.substr(1), std::to_string(key.second), std::to_string(rows.size()), certified_part(rows),
                number(percentile(least, 0), 3), number(percentile(least, .05), 3), number(percentile(least, .5), 3),
                number(percentile(cpu, .5), 0), number(percentile(cpu, .95), 0), number(mean(tried), 1)});
  }
  return text;
}

std::string named_table(const std::vector<Figures>& figures) {
  std::string text =
      "*Linear min*: of the straight-sided hexahedra, compared with the goal.\n\n" +
      head_of({"case", "order", "goal", "linear min", "met", "order-p min", "certified", "CPU ms per junction"});
  for (const Figures& f : figures) {
    const bool is_there = f.error.empty();
    text += row_of({f.subject->name, std::to_string(f.order), f.goal() > 0 ? number(f.goal(), 2) : std::string(),
                    is_there ? number(f.linear_min, 3) : "", f.good() ? "yes" : "**no**",
                    is_there ? number(f.min, 3) : "", certified_cell(f), number(cpu_ms(f), 0)});
  }
  return text;
}

/// Nasty cases and networks: one row a case, least scaled Jacobian per order.
std::string case_table(const std::vector<Figures>& figures, bool with_counts) {
  std::vector<int> orders;
  for (const Figures& f : figures) {
    if (std::find(orders.begin(), orders.end(), f.order) == orders.end()) {
      orders.push_back(f.order);
    }
  }
  Cells names{"case"};
  if (with_counts) {
    names.insert(names.end(), {"junctions", "loops", "elements"});
  }
  for (const char* what : {"min p", "certified p"}) {
    for (const int p : orders) {
      names.push_back(what + std::to_string(p));
    }
  }
  names.insert(names.end(), {"tried", "CPU ms per junction"});
  std::string text = head_of(names);
  for (std::size_t i = 0; i < figures.size(); i += orders.size()) {
    const std::vector<Figures> of_case(figures.begin() + i, figures.begin() + i + orders.size());
    const Figures& first = of_case.front();
    Cells cells{first.subject->name};
    if (with_counts) {
      cells.insert(cells.end(),
                   {std::to_string(first.junctions), std::to_string(first.loops), std::to_string(first.elements)});
    }
    for (const Figures& f : of_case) {
      cells.push_back(f.error.empty() ? number(f.min, 3) : "");
    }
    for (const Figures& f : of_case) {
      cells.push_back(certified_cell(f));
    }
    cells.insert(cells.end(), {number(first.candidates, 1), number(cpu_ms(first), 0)});
    text += row_of(cells);
  }
  for (const int p : orders) {
    std::vector<const Figures*> rows;
    for (const Figures& f : figures) {
      if (f.order == p) {
        rows.push_back(&f);
      }
    }
    const auto least = values_of(rows, [](const Figures& f) { return f.min; });
    text += "\nOrder " + std::to_string(p) + ": " + certified_part(rows) + " certified, least " +
            number(percentile(least, 0), 3) + ", median " + number(percentile(least, .5), 3) + ".\n";
  }
  return text;
}

/// Lines of at most `width` characters.
std::string wrapped(const std::string& text, std::size_t width) {
  std::string out;
  std::size_t line = 0, at = 0;
  while (at < text.size()) {
    const std::size_t space = std::min(text.find(' ', at), text.size());
    const std::size_t length = space - at;
    if (line > 0 && line + 1 + length > width) {
      out += '\n';
      line = 0;
    } else if (line > 0) {
      out += ' ';
      ++line;
    }
    out += text.substr(at, length);
    line += length;
    at = space + 1;
  }
  return out;
}

/// `k7/12 (p1 .431, p2 3 elements not certified); ..`
std::string compact_shortfalls(const std::vector<Figures>& figures) {
  std::vector<std::pair<std::string, std::string>> by_case;
  for (const Figures& f : figures) {
    if (!f.good()) {
      const std::string wrong = faults(f);
      const std::string what = "p" + std::to_string(f.order) + " " + (f.certified() ? number(f.measured(), 3) : "") +
                               (f.certified() && !wrong.empty() ? ", " : "") + wrong;
      if (by_case.empty() || by_case.back().first != f.subject->name) {
        by_case.emplace_back(f.subject->name, what);
      } else {
        by_case.back().second += ", " + what;
      }
    }
  }
  std::string text;
  for (const auto& [name, what] : by_case) {
    text += (text.empty() ? "" : "; ") + name + " (" + what + ")";
  }
  return text;
}

/// `junction of 4 at (1.00, 2.00, 3.00)`, `vessel 7 at ..`
std::string place_of(const QualityReport::Element& element, const Network& network) {
  const int branch = element.branch.value();
  std::string text;
  if (branch < 0) {
    text = "junction of " + std::to_string(network.nodes[-1 - branch].degree);
  } else {
    text = "vessel " + std::to_string(branch);
  }
  const Vec3& x = element.centre;
  return text + " at (" + number(x.x(), 2) + ", " + number(x.y(), 2) + ", " + number(x.z(), 2) + ")";
}

}  // namespace

Figures measure(const Case& subject, int order, SkeletonMesh* mesh) {
  Figures f;
  f.subject = &subject;
  f.order = order;
  Run serial;
  serial.threads = 1;
  SkeletonMeshOptions options;
  options.mesh.order = order;
  options.grading.elements = kElementsPerEdge;
  try {
    SkeletonMesh m = mesh_skeleton(subject.skeleton, options, serial);
    const QualityReport quality = measure_quality(m.result.mesh, serial);
    f.elements = m.result.mesh.element_count();
    f.faulty = quality.invalid + quality.undecided;
    f.faulty_blocks = static_cast<int>(m.blocks.blocks.size()) - m.blocks.certified;
    f.unconverged = m.result.unconverged;
    f.min = quality.scaled_jacobian.min;
    f.worst = place_of(quality.worst.front(), m.network);
    f.linear_min = quality.scaled_jacobian_linear.min;
    f.block_min = m.blocks.min_jacobian;
    f.junctions = static_cast<int>(m.blocks.junctions.size());
    f.loops = static_cast<int>(m.network.branches.size()) - static_cast<int>(m.network.nodes.size()) + 1;
    for (const BlockStructure::Junction& j : m.blocks.junctions) {
      f.cpu_seconds += j.cpu_seconds;
      f.candidates += static_cast<double>(j.candidates) / f.junctions;
    }
    if (mesh) {
      *mesh = std::move(m);
    }
  } catch (const Error& e) {
    f.error = e.what();
  }
  return f;
}

std::string table(Kind kind, const std::vector<Figures>& figures) {
  std::string text;
  switch (kind) {
    case Kind::random:
      text = "### Random junctions\n\n" + random_table(figures);
      break;
    case Kind::named:
      text = "### Named junctions\n\n" + named_table(figures);
      break;
    case Kind::nasty:
      text =
          "### Nasty cases\n\n"
          "*Fork*: daughters 20 degrees apart, radii over the parent's, which comes *lift* degrees out of their "
          "plane.\n"
          "*5:1*: radii. *Link*: two junctions .5 or 1 r apart. *Stub*: a side branch of radius .55 that divides "
          "again at\n"
          "once, the length from the parent's axis. *Bend*: curvature times radius .9.\n\n" +
          case_table(figures, false);
      break;
    case Kind::trees:
      text =
          "### Random networks\n\n"
          "About ten junctions of 3 or 4 branches, tapering and curved; some junctions have another one .5 to 1.2 r\n"
          "away; odd seeds contain a loop.\n\n" +
          case_table(figures, true);
      break;
  }
  const std::string lacking = compact_shortfalls(figures);
  return text + "\n" +
         wrapped(lacking.empty() ? "All are certified and reach their goals." : "Short of the goal: " + lacking + ".",
                 118) +
         "\n";
}

std::string shortfalls(const std::vector<Figures>& figures) {
  std::string text;
  for (const Figures& f : figures) {
    if (!f.good()) {
      text += "  " + f.subject->name + " order " + std::to_string(f.order) + ": ";
      if (f.error.empty()) {
        text += "min " + number(f.min, 3) + " in " + f.worst + ", linear " + number(f.linear_min, 3) + ", blocks " +
                number(f.block_min, 3) + ", goal " + number(f.goal(), 2);
      }
      text += (faults(f).empty() ? "" : (f.error.empty() ? "; " : "") + faults(f)) + "\n";
    }
  }
  return text;
}

std::string json(const std::vector<Figures>& figures) {
  auto all = nlohmann::ordered_json::array();
  for (const Figures& f : figures) {
    nlohmann::ordered_json row{
        {"kind", name_of(f.subject->kind)}, {"case", f.subject->name}, {"order", f.order}, {"goal", f.goal()}};
    if (f.error.empty()) {
      row.update({{"elements", f.elements},
                  {"elements_not_certified", f.faulty},
                  {"blocks_not_certified", f.faulty_blocks},
                  {"unconverged_projections", f.unconverged},
                  {"scaled_jacobian_min", f.min},
                  {"worst", f.worst},
                  {"scaled_jacobian_linear_min", f.linear_min},
                  {"block_scaled_jacobian_min", f.block_min},
                  {"junctions", f.junctions},
                  {"loops", f.loops},
                  {"candidates", f.candidates},
                  {"cpu_seconds", f.cpu_seconds}});
    } else {
      row["error"] = f.error;
    }
    all.push_back(row);
  }
  return all.dump(1) + "\n";
}

}  // namespace vasohex::survey
