#pragma once
/// \file How a stage runs: threads, progress, messages. The library never prints.

#include <functional>
#include <string>
#include <string_view>

#include "vasohex/core/error.h"

namespace vasohex {

struct Run {
  /// Number of threads; 0: all cores. The result is the same to the last bit for any number.
  int threads = 0;
  /// Called from one thread at a time with the stage and the part done in [0, 1]; false cancels
  /// (ErrorCode::cancelled).
  std::function<bool(std::string_view stage, double fraction)> on_progress;
  /// Called with one line of text per message.
  std::function<void(std::string_view line)> on_log;

  void progress(std::string_view stage, double fraction) const {
    if (on_progress && !on_progress(stage, fraction)) {
      throw Error(ErrorCode::cancelled, std::string(stage) + " was cancelled");
    }
  }
  void log(std::string_view line) const {
    if (on_log) {
      on_log(line);
    }
  }
};

}  // namespace vasohex
