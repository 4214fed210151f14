#include "vasohex/skeleton/read_skeleton.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "vasohex/core/error.h"

namespace vasohex {
namespace {

std::string file_text(const std::string& path) {
  std::error_code status;
  if (std::filesystem::is_directory(path, status)) {
    throw Error(ErrorCode::bad_input, "is a directory, a file is needed");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorCode::bad_input, "cannot be opened; check that it exists and may be read");
  }
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

std::string length_unit(std::string_view text) {
  std::string word;
  for (char c : text.substr(std::min(text.find_first_not_of(" \t"), text.size()))) {
    if (!std::isalpha(static_cast<unsigned char>(c))) {
      break;
    }
    word += c;
  }
  return word == "um" || word == "mm" || word == "cm" || word == "m" ? word : std::string();
}

Skeleton read_skeleton(const std::string& path) {
  return with_context("skeleton " + path, [&] {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".swc") {
      return parse_swc(file_text(path));
    }
    if (extension == ".json") {
      return parse_skeleton_json(file_text(path));
    }
    throw Error(ErrorCode::bad_input,
                "a skeleton cannot be read from the extension '" + extension + "'; known are .swc and .json");
  });
}

}  // namespace vasohex
