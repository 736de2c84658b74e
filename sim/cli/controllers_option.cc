#include "sim/cli/controllers_option.h"

namespace gauntlet::sim {

void AddControllersOption(CLI::App& command, std::vector<std::string>& names) {
  command.add_option("--controllers", names, "only these, separated by commas")->delimiter(',');
}

}  // namespace gauntlet::sim
