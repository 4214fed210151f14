#include <algorithm>
#include <charconv>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "vasohex/core/error.h"
#include "vasohex/skeleton/read_skeleton.h"

namespace vasohex {
namespace {

struct Row {
  int line = 0;
  long long id = 0;
  long long parent = 0;
};

[[noreturn]] void fail(int line, const std::string& what) {
  throw Error(ErrorCode::bad_input, "line " + std::to_string(line) + ": " + what);
}

std::vector<std::string_view> words(std::string_view line) {
  constexpr std::string_view blank = " \t\r\f\v";
  std::vector<std::string_view> result;
  for (std::size_t begin = line.find_first_not_of(blank); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(blank, begin), line.size());
    result.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(blank, end);
  }
  return result;
}

double real(int line, std::string_view word, const char* column) {
  double value = 0;
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
    fail(line, std::string(column) + " is '" + std::string(word) + "', must be a finite number");
  }
  return value;
}

long long integer(int line, std::string_view word, const char* column) {
  // some programs write identifiers as 12.0
  const double value = real(line, word, column);
  if (value != std::floor(value) || std::abs(value) > 1e15) {
    fail(line, std::string(column) + " is '" + std::string(word) + "', must be an integer");
  }
  return static_cast<long long>(value);
}

std::string number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// Throws if the parents of a point lead back to it. parents[i]: index or -1.
void check_no_cycle(const std::vector<int>& parents, const std::vector<Row>& rows) {
  std::vector<int> walk(parents.size(), -1);  // the walk that met the point first
  for (int start = 0; start < static_cast<int>(parents.size()); ++start) {
    for (int i = start; i >= 0 && walk[i] != start; i = parents[i]) {
      if (walk[i] >= 0) {
        break;  // met by an earlier walk, which ended
      }
      walk[i] = start;
      if (parents[i] >= 0 && walk[parents[i]] == start) {
        fail(rows[parents[i]].line, "node " + std::to_string(rows[parents[i]].id) +
                                        " is its own ancestor; SWC holds trees, write a cycle as JSON instead");
      }
    }
  }
}

}  // namespace

Skeleton parse_swc(std::string_view text) {
  Skeleton skeleton;
  std::vector<Row> rows;
  std::unordered_map<long long, int> index_of;
  int line = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view content = text.substr(begin, end - begin);
    begin = end + 1;
    ++line;
    const std::vector<std::string_view> columns = words(content);
    if (columns.empty()) {
      continue;
    }
    if (columns[0].starts_with('#')) {
      const std::string_view comment = content.substr(std::min(content.find_first_not_of("# \t"), content.size()));
      if (comment.starts_with("units:")) {
        skeleton.units = length_unit(comment.substr(6));
      }
      continue;
    }
    if (columns.size() != 7) {
      fail(line, std::to_string(columns.size()) + " columns, must be 7: id type x y z radius parent");
    }
    const Row row{line, integer(line, columns[0], "id"), integer(line, columns[6], "parent")};
    const std::string node = "node " + std::to_string(row.id);
    if (row.id < 0) {
      fail(line, "id is " + std::to_string(row.id) + ", must be >= 0");
    }
    const Vec3 point(real(line, columns[2], "x"), real(line, columns[3], "y"), real(line, columns[4], "z"));
    const double radius = real(line, columns[5], "radius");
    if (radius <= 0) {
      fail(line, "radius " + number(radius) + " at " + node + " (" + number(point.x()) + " " + number(point.y()) +
                     " " + number(point.z()) + "), must be > 0");
    }
    if (row.parent == row.id) {
      fail(line, node + " is its own parent, must be another node, or -1 for a root");
    }
    const auto [entry, is_new] = index_of.emplace(row.id, static_cast<int>(rows.size()));
    if (!is_new) {
      fail(line, node + " is already given on line " + std::to_string(rows[entry->second].line) +
                     "; every id must occur once");
    }
    rows.push_back(row);
    skeleton.points.push_back(point);
    skeleton.radii.push_back(radius);
  }
  if (rows.empty()) {
    throw Error(ErrorCode::bad_input, "no points; an SWC file needs lines of id type x y z radius parent");
  }

  std::vector<int> parents(rows.size(), -1);
  for (int i = 0; i < static_cast<int>(rows.size()); ++i) {
    if (rows[i].parent < 0) {
      if (!skeleton.root) {
        skeleton.root = i;
      }
      continue;
    }
    const auto parent = index_of.find(rows[i].parent);
    if (parent == index_of.end()) {
      fail(rows[i].line, "node " + std::to_string(rows[i].id) + " has the parent " + std::to_string(rows[i].parent) +
                             ", which the file does not contain; must be the id of a node, or -1 for a root");
    }
    parents[i] = parent->second;
    skeleton.segments.push_back({parents[i], i});
  }
  check_no_cycle(parents, rows);
  if (skeleton.segments.empty()) {
    throw Error(ErrorCode::bad_input, "no segments: every node is a root; give each node its parent");
  }
  return skeleton;
}

}  // namespace vasohex
