#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/base/data_folder.h"
#include "sim/external/external_filters.h"
#include "sim/scenario/scenario_reader.h"

namespace gauntlet::python {

/// Settings as Python gives them: a file, or a text (of a dict, too) that is called `file` in
/// messages.
struct SettingsSource {
  std::string file;
  std::optional<std::string> text;
};

/// The caller's consent to programs of a scenario, for one long call. Long calls take turns.
class ConsentOfCall {
 public:
  explicit ConsentOfCall(bool allowed) { sim::AllowPrograms(allowed); }
  ~ConsentOfCall() { sim::AllowPrograms(false); }
  ConsentOfCall(const ConsentOfCall&) = delete;
  ConsentOfCall& operator=(const ConsentOfCall&) = delete;
};

/// Settings of a scenario. Errors: UserError for a file that is none.
inline sim::ScenarioSource ScenarioSourceOf(const SettingsSource& given,
                                            const std::vector<std::string>& overrides) {
  if (given.text) return {.file = given.file, .text = *given.text, .overrides = overrides};
  const std::string file = sim::ReadyFile(given.file, "scenarios", "scenario");
  return {.file = file, .text = sim::ReadYamlText(file), .overrides = overrides};
}

}  // namespace gauntlet::python
