#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "vasohex/core/error.h"
#include "vasohex/skeleton/read_skeleton.h"

namespace vasohex {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::bad_input, what); }

std::string at(const std::string& name, std::size_t i) { return name + "[" + std::to_string(i) + "]"; }

/// One line of at most 40 characters of a value, for messages.
std::string shown(const json& value) {
  const std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
  return text.size() <= 40 ? text : text.substr(0, 37) + "...";
}

const json& array_of(const json& file, const char* key) {
  const auto entry = file.find(key);
  if (entry == file.end()) {
    fail(std::string("key '") + key + "' is missing; needed are format, points, radius, branches");
  }
  if (!entry->is_array()) {
    fail(std::string(key) + " is " + shown(*entry) + ", must be an array");
  }
  return *entry;
}

double finite(const json& value, const std::string& place) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    fail(place + " is " + shown(value) + ", must be a finite number");
  }
  return value.get<double>();
}

int point_index(const json& value, const std::string& place, std::size_t n) {
  const std::string range = ", must be an index of points, 0 to " + std::to_string(n - 1);
  if (!value.is_number_integer()) {
    fail(place + " is " + shown(value) + range);
  }
  const bool in_range = value.is_number_unsigned() ? value.get<std::uint64_t>() < n : false;
  if (!in_range) {
    fail(place + " is " + shown(value) + range);
  }
  return value.get<int>();
}

/// Names of end points; `degree` counts the segments at each point.
std::map<int, std::string> end_names(const json& names, const std::vector<int>& degree) {
  if (!names.is_object()) {
    fail("names is " + shown(names) + ", must be an object {\"point\": \"name\"}");
  }
  std::map<int, std::string> result;
  std::map<std::string, int> point_of;
  for (const auto& [key, value] : names.items()) {
    const std::string place = "names[" + json(key).dump(-1, ' ', true, json::error_handler_t::replace) + "]";
    int point = -1;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), point);
    if (error != std::errc() || end != key.data() + key.size() || point < 0 ||
        point >= static_cast<int>(degree.size())) {
      fail(place + ": the key must be an index of points, 0 to " + std::to_string(degree.size() - 1));
    }
    if (!value.is_string() || value.get<std::string>().empty()) {
      fail(place + " is " + shown(value) + ", must be a name");
    }
    if (degree[point] != 1) {
      fail(place + ": point " + std::to_string(point) + " has " + std::to_string(degree[point]) +
           " segments; only ends (one segment) can have a name");
    }
    const auto [other, is_new] = point_of.emplace(value.get<std::string>(), point);
    if (!is_new) {
      fail(place + ": the name '" + other->first + "' is already that of point " + std::to_string(other->second) +
           "; names must be unique");
    }
    if (!result.emplace(point, value.get<std::string>()).second) {
      fail(place + ": point " + std::to_string(point) + " has two names, must have one");
    }
  }
  return result;
}

}  // namespace

Skeleton parse_skeleton_json(std::string_view text) {
  json file;
  try {
    file = json::parse(text);
  } catch (const json::parse_error& e) {
    // the text of the library repeats its own name and error number; its place is what helps
    const std::string what = e.what();
    const std::size_t place = what.find("parse error");
    fail("not JSON: " + (place == std::string::npos ? what : what.substr(place)));
  } catch (const json::out_of_range&) {
    fail("not JSON: a number is out of the range of double precision");
  }
  if (!file.is_object()) {
    fail("is " + shown(file) + ", must be an object with format, points, radius, branches");
  }
  const auto format = file.find("format");
  if (format == file.end() || *format != "vascular-graph-1") {
    fail("format is " + (format == file.end() ? "missing" : shown(*format)) + ", must be \"vascular-graph-1\"");
  }
  Skeleton skeleton;
  if (const auto units = file.find("units"); units != file.end() && !units->is_null()) {
    if (!units->is_string()) {
      fail("units is " + shown(*units) + ", must be \"um\", \"mm\", \"cm\" or \"m\"");
    }
    skeleton.units = length_unit(units->get<std::string>());
    if (skeleton.units.empty() && !units->get<std::string>().empty() &&
        !units->get<std::string>().starts_with("dimensionless")) {
      fail("units is " + shown(*units) + ", must be \"um\", \"mm\", \"cm\" or \"m\" (or \"dimensionless\")");
    }
  }

  const json& points = array_of(file, "points");
  const json& radius = array_of(file, "radius");
  const json& branches = array_of(file, "branches");
  if (points.empty()) {
    fail("points is empty, must have at least 2");
  }
  if (radius.size() != points.size()) {
    fail("radius has " + std::to_string(radius.size()) + " values, must have one for each of the " +
         std::to_string(points.size()) + " points");
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string place = at("points", i);
    if (!points[i].is_array() || points[i].size() != 3) {
      fail(place + " is " + shown(points[i]) + ", must be [x, y, z]");
    }
    Vec3 p;
    for (int d = 0; d < 3; ++d) {
      p[d] = finite(points[i][d], at(place, d));
    }
    skeleton.points.push_back(p);
    skeleton.radii.push_back(finite(radius[i], at("radius", i)));
    if (skeleton.radii[i] <= 0) {
      fail(at("radius", i) + " is " + shown(radius[i]) + " at " + shown(points[i]) + ", must be > 0");
    }
  }
  std::vector<int> degree(points.size(), 0);
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const std::string place = at("branches", b);
    if (!branches[b].is_array() || branches[b].size() < 2) {
      fail(place + " is " + shown(branches[b]) + ", must be an array of at least 2 points");
    }
    for (std::size_t k = 0; k < branches[b].size(); ++k) {
      const int point = point_index(branches[b][k], at(place, k), points.size());
      if (k > 0) {
        const int before = point_index(branches[b][k - 1], at(place, k - 1), points.size());
        skeleton.segments.push_back({before, point});
        ++degree[before];
        ++degree[point];
      }
    }
  }
  if (skeleton.segments.empty()) {
    fail("branches is empty, must have at least one branch of two points");
  }
  if (const auto names = file.find("names"); names != file.end() && !names->is_null()) {
    skeleton.names = end_names(*names, degree);
  }
  return skeleton;
}

}  // namespace vasohex
