#include "vasohex/core/text_lines.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "vasohex/core/error.h"

namespace vasohex {

std::string file_bytes(const std::string& path) {
  std::error_code status;
  if (std::filesystem::is_directory(path, status)) {
    throw Error(ErrorCode::bad_input, "is a directory, a file is needed");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorCode::bad_input, "cannot be opened; check that it exists and may be read");
  }
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return std::move(bytes).str();
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string lower_extension(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

bool TextLines::next() {
  constexpr std::string_view blank = " \t\r\f\v";
  words_.clear();
  while (words_.empty() && begin_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
    std::string_view line = text_.substr(begin_, end - begin_);
    begin_ = std::min(end + 1, text_.size());
    ++number_;
    if (comment_ != 0) {
      line = line.substr(0, line.find(comment_));
    }
    for (std::size_t at = line.find_first_not_of(blank); at != std::string_view::npos;) {
      const std::size_t stop = std::min(line.find_first_of(blank, at), line.size());
      words_.push_back(line.substr(at, stop - at));
      at = line.find_first_not_of(blank, stop);
    }
  }
  return !words_.empty();
}

double TextLines::real(std::size_t w, const char* what) const {
  if (w >= words_.size()) {
    fail(std::string(what) + " is missing");
  }
  const std::string_view digits = words_[w].starts_with('+') ? words_[w].substr(1) : words_[w];
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range && end == digits.data() + digits.size() &&
      digits.find("e-") + digits.find("E-") != 2 * std::string_view::npos) {
    return 0;  // below the smallest double
  }
  if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
    fail(std::string(what) + " is '" + std::string(words_[w]) + "', must be a finite number");
  }
  return value;
}

long long TextLines::integer(std::size_t w, const char* what) const {
  if (w >= words_.size()) {
    fail(std::string(what) + " is missing");
  }
  long long value = 0;
  const auto [end, error] = std::from_chars(words_[w].data(), words_[w].data() + words_[w].size(), value);
  if (error != std::errc() || end != words_[w].data() + words_[w].size()) {
    fail(std::string(what) + " is '" + std::string(words_[w]) + "', must be an integer");
  }
  return value;
}

void TextLines::fail(const std::string& what) const {
  throw Error(ErrorCode::bad_input, "line " + std::to_string(number_) + ": " + what);
}

}  // namespace vasohex
