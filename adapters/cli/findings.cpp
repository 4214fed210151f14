#include "findings.h"

#include <algorithm>

#include "json_point.h"

namespace vasohex::cli {
namespace {

const char* title(FindingKind kind, bool one) {
  switch (kind) {
    case FindingKind::overlap:
      return one ? "place where vessels overlap" : "places where vessels overlap";
    case FindingKind::touch:
      return one ? "place where vessels nearly touch" : "places where vessels nearly touch";
    case FindingKind::hairpin:
      return one ? "vessel that turns back into itself" : "places where vessels turn back into themselves";
    case FindingKind::side_by_side:
      return one ? "pair of branches that part too late" : "pairs of branches that part too late";
    case FindingKind::sharp_bend:
      return one ? "bend sharper than 1.1 radii" : "bends sharper than 1.1 radii";
    case FindingKind::steep_taper:
      return one ? "steep change of a radius" : "steep changes of radii";
    case FindingKind::thin_branch:
      return one ? "branch far thinner than its junction" : "branches far thinner than their junctions";
    case FindingKind::stub:
      return one ? "branch that ends inside its parent" : "branches that end inside their parents";
    case FindingKind::fragment:
      return one ? "stray piece" : "stray pieces";
    case FindingKind::unjoined:
      return one ? "point inside a vessel that it is not joined to"
                 : "points inside vessels that they are not joined to";
    case FindingKind::near_junctions:
      return one ? "pair of junctions within a radius" : "pairs of junctions within a radius";
  }
  return "";
}

/// Calls `group` with each run of findings of one kind.
template <class Group>
void for_kinds(const std::vector<Finding>& findings, const Group& group) {
  for (auto begin = findings.begin(); begin != findings.end();) {
    const auto end = std::find_if(begin, findings.end(), [&](const Finding& f) { return f.kind != begin->kind; });
    group(begin, end);
    begin = end;
  }
}

}  // namespace

nlohmann::ordered_json findings_json(const std::vector<Finding>& findings) {
  auto all = nlohmann::ordered_json::array();
  for (const Finding& f : findings) {
    nlohmann::ordered_json branches = nlohmann::ordered_json::array();
    for (const int b : f.branches) {
      if (b >= 0) {
        branches.push_back(b);
      }
    }
    nlohmann::ordered_json row{{"kind", name_of(f.kind)}, {"severity", name_of(f.severity)},
                               {"branches", branches},    {"at", xyz(f.at)},
                               {"figure", f.figure},      {"text", f.text},
                               {"cure", f.cure}};
    if (f.point >= 0) {
      row["point"] = f.point;
    }
    all.push_back(row);
  }
  return all;
}

std::string findings_text(const std::vector<Finding>& findings) {
  constexpr std::ptrdiff_t shown = 10;
  std::string out;
  for_kinds(findings, [&](auto begin, auto end) {
    const std::ptrdiff_t count = end - begin;
    out += "  " + std::to_string(count) + " " + title(begin->kind, count == 1);
    out += count > shown ? ", the worst " + std::to_string(shown) + ":\n" : ":\n";
    for (auto f = begin; f != begin + std::min(count, shown); ++f) {
      out += "    " + std::string(name_of(f->severity)) + ": " + f->text + "\n";
      if (f + 1 == begin + std::min(count, shown) || (f + 1)->cure != f->cure) {
        out += "      what helps: " + f->cure + "\n";
      }
    }
  });
  return out;
}

std::string findings_summary(const std::vector<Finding>& findings, bool repaired) {
  std::string out;
  for_kinds(findings, [&](auto begin, auto end) {
    const auto count = std::count_if(begin, end, [](const Finding& f) { return f.severity != Severity::note; });
    if (count > 0) {
      out += std::to_string(count) + " " + title(begin->kind, count == 1) + "; " + (count > 1 ? "worst: " : "") +
             begin->text + (repaired ? "; see vasohex info\n" : "; see vasohex info, or use --repair\n");
    }
  });
  return out;
}

}  // namespace vasohex::cli
