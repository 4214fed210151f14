#include <unistd.h>

#include <chrono>
#include <cstdio>

#include "commands.h"
#include "vasohex/core/error.h"

namespace vasohex::cli {

void Common::add_to(CLI::App& command) {
  command.add_option("--threads", threads, "Threads; 0: all cores. The result does not depend on it")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_flag("-q,--quiet", quiet, "Print errors only");
  command.add_flag("-v,--verbose", verbose, "Print messages of the stages");
}

Run Common::run() const {
  Run run;
  run.threads = threads;
  if (!quiet && isatty(STDERR_FILENO)) {
    run.on_progress = [](std::string_view stage, double fraction) {
      std::fprintf(stderr, "\r%-12.*s %3.0f %%", static_cast<int>(stage.size()), stage.data(), 100 * fraction);
      return true;
    };
  }
  if (verbose) {
    run.on_log = [](std::string_view line) {
      std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data());
    };
  }
  return run;
}

void Common::end_progress() const {
  if (!quiet && isatty(STDERR_FILENO)) {
    std::fprintf(stderr, "\r%30s\r", "");
  }
}

Stopwatch::Stopwatch()
    : start_(std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count()) {}

double Stopwatch::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count() - start_;
}

}  // namespace vasohex::cli

int main(int argc, char** argv) {
  using namespace vasohex::cli;
  CLI::App app{"vasohex: structured hexahedral meshes of vascular networks, of any order, proven valid.\n"
               "Exit status: 0 done and valid, 1 internal error, 2 bad input or usage, 3 written but invalid elements "
               "remain."};
  app.set_version_flag("--version", VASOHEX_VERSION);
  app.require_subcommand(1);
  Common common;
  add_mesh_command(app, common);
  add_check_command(app, common);
  add_info_command(app, common);
  add_blocks_command(app, common);
  try {
    app.parse(argc, argv);
    return common.exit_code;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? done : bad_input;
  } catch (const vasohex::Error& e) {
    common.end_progress();
    std::fprintf(stderr, "vasohex: %s\n", e.what());
    return e.code() == vasohex::ErrorCode::internal ? internal_error : bad_input;
  } catch (const std::exception& e) {
    common.end_progress();
    std::fprintf(stderr, "vasohex: internal error: %s\n", e.what());
    return internal_error;
  }
}
