#include "vasohex/skeleton/read_skeleton.h"

#include <algorithm>
#include <cctype>

#include "vasohex/core/error.h"
#include "vasohex/core/text_lines.h"

namespace vasohex {

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
    const std::string extension = lower_extension(path);
    if (extension == ".swc") {
      return parse_swc(file_bytes(path));
    }
    if (extension == ".json") {
      return parse_skeleton_json(file_bytes(path));
    }
    throw Error(ErrorCode::bad_input,
                "a skeleton cannot be read from the extension '" + extension + "'; known are .swc and .json");
  });
}

}  // namespace vasohex
