#include "option_checks.h"

#include <charconv>
#include <cmath>
#include <filesystem>

#include "vasohex/core/atomic_file.h"
#include "vasohex/core/error.h"

namespace vasohex::cli {
namespace {

template <class T>
bool read_number(const std::string& text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  const auto canonical = [&](const std::string& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
  };
  return canonical(a) == canonical(b) || std::filesystem::equivalent(a, b, ignored);
}

}  // namespace

CLI::Validator whole_number(int least) {
  return {[least](std::string& text) -> std::string {
            int value = 0;
            if (read_number(text, value) && value >= least) {
              return {};
            }
            return text + ": must be a whole number >= " + std::to_string(least);
          },
          ""};
}

CLI::Validator positive_number() {
  return {[](std::string& text) -> std::string {
            double value = 0;
            if (read_number(text, value) && std::isfinite(value) && value > 0) {
              return {};
            }
            return text + ": must be a number > 0";
          },
          ""};
}

void usage(const std::string& message) { throw Error(ErrorCode::bad_input, message); }

void check_outputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const std::string& input : inputs) {
      if (same_file(outputs[i], input)) {
        usage("output " + outputs[i] + ": is the input, which would be lost; choose another name");
      }
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (same_file(outputs[i], outputs[k])) {
        usage("output " + outputs[i] + ": is given twice; choose another name for one of them");
      }
    }
    AtomicFile probe(outputs[i]);
  }
}

}  // namespace vasohex::cli
