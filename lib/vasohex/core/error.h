#pragma once
/// \file The one exception type of the library.

#include <stdexcept>
#include <string>
#include <utility>

namespace vasohex {

enum class ErrorCode {
  bad_input,  ///< the input cannot be used: the message names file, place, what is wrong, what would be right
  cancelled,  ///< the caller's progress callback returned false
  internal,   ///< a broken promise of this library
};

/// Thrown when no result exists. Imperfect results (invalid elements, repairs) are data, never exceptions.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

/// Runs `f`; an Error leaves with `context: ` in front of its message (`skeleton aorta.swc: line 214: ...`).
template <class F>
auto with_context(const std::string& context, F&& f) -> decltype(f()) {
  try {
    return std::forward<F>(f)();
  } catch (const Error& e) {
    throw Error(e.code(), context + ": " + e.what());
  }
}

}  // namespace vasohex
