#include "sim/cli/out_option.h"

namespace gauntlet::sim {

CLI::Option* AddOutOption(CLI::App& command, std::string& out, const std::string& help,
                          const std::string& type_name) {
  const auto problem = [](const std::string& path) {
    return path.empty() ? std::string("is empty, must be a path") : std::string();
  };
  return command.add_option("--out", out, help)
      ->type_name(type_name)
      ->check(CLI::Validator(problem, ""));
}

void AddForceOption(CLI::App& command, bool& force) {
  command.add_flag("--force", force, "also replace files that were edited since they were written");
}

}  // namespace gauntlet::sim
