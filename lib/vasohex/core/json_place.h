#pragma once
/// \file Internal: values within a JSON document that know where they are, so that complaints can say so.

#include <cmath>
#include <concepts>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "vasohex/core/error.h"

namespace vasohex {

/// A value of a document and its path, as `blocks[3].vertices[0]`. All functions throw Error(bad_input) that names
/// the path, what is there and what would be right. The document must outlive it.
class JsonPlace {
 public:
  JsonPlace(const nlohmann::json& value, std::string path) : value_(value), path_(std::move(path)) {}

  const nlohmann::json& value() const { return value_; }

  [[noreturn]] void fail(const std::string& wanted) const {
    std::string shown = value_.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    if (shown.size() > 40) {
      shown = shown.substr(0, 37) + "...";
    }
    throw Error(ErrorCode::bad_input, (path_.empty() ? "is " : path_ + " is ") + shown + ", must be " + wanted);
  }
  JsonPlace operator[](const char* key) const {
    if (!value_.is_object()) {
      fail(std::string("an object with '") + key + "'");
    }
    const auto entry = value_.find(key);
    if (entry == value_.end()) {
      throw Error(ErrorCode::bad_input, (path_.empty() ? "" : path_ + ": ") + "key '" + key + "' is missing");
    }
    return {*entry, (path_.empty() ? "" : path_ + ".") + key};
  }
  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }

  /// Of an array, whose elements `what` tells ("[x, y, z]"). \param size exact size wanted, or -1: any.
  std::size_t size(const std::string& what, std::int64_t wanted = -1) const {
    if (!value_.is_array() || (wanted >= 0 && static_cast<std::int64_t>(value_.size()) != wanted)) {
      fail(what);
    }
    return value_.size();
  }
  template <std::integral Index>
  JsonPlace operator[](Index i) const {
    return {value_[static_cast<std::size_t>(i)], path_ + "[" + std::to_string(i) + "]"};
  }

  double number() const {
    if (!value_.is_number() || !std::isfinite(value_.get<double>())) {
      fail("a finite number");
    }
    return value_.get<double>();
  }
  double positive() const {
    const double x = number();
    if (!(x > 0)) {
      fail("> 0");
    }
    return x;
  }
  int integer(std::int64_t least, std::int64_t most) const {
    const bool whole = value_.is_number_integer();
    const bool fits = whole && (!value_.is_number_unsigned() || value_.get<std::uint64_t>() <= INT32_MAX) &&
                      value_.get<std::int64_t>() >= least && value_.get<std::int64_t>() <= most;
    if (!fits) {
      fail("a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    }
    return value_.get<int>();
  }
  bool boolean() const {
    if (!value_.is_boolean()) {
      fail("true or false");
    }
    return value_.get<bool>();
  }
  std::string text() const {
    if (!value_.is_string()) {
      fail("a text");
    }
    return value_.get<std::string>();
  }

 private:
  const nlohmann::json& value_;
  std::string path_;
};

}  // namespace vasohex
