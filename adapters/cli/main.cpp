#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <new>

#include "commands.h"
#include "config_file.h"
#include "option_checks.h"
#include "vasohex/core/error.h"

namespace vasohex::cli {

namespace {

volatile std::sig_atomic_t caught_signal = 0;

/// Stages are left at their next progress, and remove files half written; a second signal ends the process at once.
void stop_at_signals() {
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, [](int caught) {
      caught_signal = caught;
      std::signal(caught, SIG_DFL);
    });
  }
}

}  // namespace

void Common::add_to(CLI::App& command, std::function<void()> run) {
  command.add_option("--threads", threads, "Threads; 0: all cores. The result does not depend on it")
      ->check(whole_number(0))
      ->capture_default_str();
  command.add_flag("-q,--quiet", quiet, "Print errors only");
  command.add_flag("-v,--verbose", verbose, "Print messages of the stages");
  command.add_option("--config", config, "File with any of these options, as `order = 3`; the command line wins");
  command.callback([this, &command, run = std::move(run)] {
    if (!config.empty()) {
      read_config(command, config);
    }
    run();
  });
}

Run Common::run() const {
  Run run;
  run.threads = threads;
  run.on_progress = [shown = !quiet && isatty(STDERR_FILENO)](std::string_view stage, double fraction) {
    if (shown) {
      std::fprintf(stderr, "\r%-12.*s %3.0f %%", static_cast<int>(stage.size()), stage.data(), 100 * fraction);
    }
    return caught_signal == 0;
  };
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

namespace {

/// What CLI11 has to say, on one line, and where to read on.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> commands = app.get_subcommands();
  std::string text = error.what(), help = "vasohex --help";
  if (!commands.empty()) {
    help = "vasohex " + commands.front()->get_name() + " --help";
  } else if (const std::vector<std::string> unknown = app.remaining(); !unknown.empty()) {
    text = "unknown command or option '" + unknown.front() + "'; the commands are";
    for (const CLI::App* command : app.get_subcommands(nullptr)) {
      text += " " + command->get_name();
    }
  }
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text + "; see `" + help + "`";
}

}  // namespace
}  // namespace vasohex::cli

int main(int argc, char** argv) {
  using namespace vasohex::cli;
  CLI::App app{
      "vasohex: structured hexahedral meshes of vascular networks, of any order, proven valid.\n"
      "Exit status: 0 done and valid, 1 internal error, 2 bad input or usage, 3 written but invalid elements "
      "remain, 130 interrupted (128 + the signal).",
      "vasohex"};
  app.set_version_flag("--version", VASOHEX_VERSION);
  app.require_subcommand(1);
  Common common;
  add_mesh_command(app, common);
  add_check_command(app, common);
  add_info_command(app, common);
  add_skeleton_command(app, common);
  add_blocks_command(app, common);
  stop_at_signals();
  try {
    app.parse(argc, argv);
    return common.exit_code;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) {  // --help, --version
      return app.exit(e);
    }
    std::fprintf(stderr, "vasohex: %s\n", usage_message(app, e).c_str());
    return bad_input;
  } catch (const vasohex::Error& e) {
    common.end_progress();
    std::fprintf(stderr, "vasohex: %s\n", e.what());
    if (e.code() == vasohex::ErrorCode::cancelled) {
      return interrupted + caught_signal;
    }
    return e.code() == vasohex::ErrorCode::internal ? internal_error : bad_input;
  } catch (const std::bad_alloc&) {
    common.end_progress();
    std::fprintf(stderr, "vasohex: not enough memory for this mesh; ask for fewer elements or a lower order\n");
    return bad_input;
  } catch (const std::exception& e) {
    common.end_progress();
    std::fprintf(stderr, "vasohex: internal error: %s\n", e.what());
    return internal_error;
  }
}
