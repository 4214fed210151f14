#include "config_file.h"

#include <fstream>

#include "option_checks.h"

namespace vasohex::cli {

void read_config(CLI::App& command, const std::string& path) {
  const std::string place = "config " + path + ": ";
  std::ifstream file(path);
  if (!file || file.peek() == std::ifstream::traits_type::eof()) {
    usage(place + "cannot be read, or is empty; it needs lines as `order = 3`");
  }
  try {
    for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_config(file)) {
      if (!item.parents.empty()) {
        usage(place + "[" + item.parents.front() + "]: sections have no meaning here; give the options alone");
      }
      CLI::Option* option = command.get_option_no_throw("--" + item.name);
      if (option == nullptr || item.name == "help" || item.name == "config") {
        usage(place + "'" + item.name + "' is not an option of `vasohex " + command.get_name() +
              "`; its --help lists them");
      }
      if (!option->empty()) {
        continue;
      }
      if (option->get_expected_min() == 0) {  // a flag
        option->add_result(option->get_flag_value(item.name, CLI::ConfigTOML().to_flag(item)));
      } else {
        for (const std::string& value : item.inputs) {
          option->add_result(value);
        }
      }
      option->run_callback();
    }
  } catch (const CLI::Error& e) {
    usage(place + e.what());
  }
}

}  // namespace vasohex::cli
