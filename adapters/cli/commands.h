#pragma once
/// \file The commands of the program. Each adds itself to the command line; its callback runs it.

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "vasohex/core/run.h"

namespace vasohex::cli {

/// What the process returns.
enum ExitCode {
  done = 0,
  internal_error = 1,
  bad_input = 2,
  invalid_elements = 3,
  interrupted = 128  ///< + the signal
};

/// Options of every command, and what they make of a Run.
struct Common {
  int threads = 0;
  bool quiet = false;
  bool verbose = false;
  std::string config;
  int exit_code = done;

  /// Adds the common options; `run` is what the command does, called when all options are known.
  void add_to(CLI::App& command, std::function<void()> run);
  /// Progress on a terminal (stderr), messages with -v; cancelled by the first SIGINT or SIGTERM.
  Run run() const;
  /// Wipes the progress line.
  void end_progress() const;
};

void add_mesh_command(CLI::App& app, Common& common);
void add_check_command(CLI::App& app, Common& common);
void add_info_command(CLI::App& app, Common& common);
void add_skeleton_command(CLI::App& app, Common& common);
void add_blocks_command(CLI::App& app, Common& common);

/// A duration in seconds since the call.
class Stopwatch {
 public:
  Stopwatch();
  double seconds() const;

 private:
  double start_;
};

}  // namespace vasohex::cli
