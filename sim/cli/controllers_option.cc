#include "sim/cli/controllers_option.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"

namespace gauntlet::sim {

void AddControllersOption(CLI::App& command, std::vector<std::string>& names) {
  command.add_option("--controllers", names, "only these, separated by commas")->delimiter(',');
}

void CheckControllersOption(const std::vector<std::string>& names, const Scenario& scenario) {
  std::vector<std::string> known;
  for (const NamedController& controller : scenario.controllers) known.push_back(controller.name);
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) == known.end()) {
      throw UserError(
          fmt::format("--controllers: {}: unknown controller{}", name, Suggestion(name, known)));
    }
    if (std::ranges::count(names, name) > 1) {
      throw UserError(fmt::format("--controllers: {}: named twice", name));
    }
  }
}

}  // namespace gauntlet::sim
