#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/base/data_folder.h"
#include "sim/study/elsewhere.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/trial/external/external_filters.h"
#include "sim/trial/external/own_objects.h"

namespace gauntlet::python {

/// Settings as Python gives them: a file, or a text (of a dict, too) that is called `file` in
/// messages.
struct SettingsSource {
  std::string file;
  std::optional<std::string> text;
};

/// The caller's own filters, for one long call: the consent to programs of the scenario, and
/// objects.
struct OwnFilters {
  bool allow_programs = false;
  sim::OwnObjects objects = {};
};

/// They can be used while this object lives. Long calls take turns.
class OwnFiltersOfCall {
 public:
  /// `call`: a name of the call, where several processes work for it.
  explicit OwnFiltersOfCall(const OwnFilters& filters, const std::string& call = "") {
    sim::NameRun(call);
    sim::AllowPrograms(filters.allow_programs);
    sim::SetOwnObjects(filters.objects);
  }
  ~OwnFiltersOfCall() {
    sim::NameRun("");
    sim::SetOwnObjects({});
    sim::AllowPrograms(false);
  }
  OwnFiltersOfCall(const OwnFiltersOfCall&) = delete;
  OwnFiltersOfCall& operator=(const OwnFiltersOfCall&) = delete;
};

/// What a part of a long call runs: some trials or cells into a study.db.
struct PartRequest {
  sim::WorkRange range;
  std::string database;
};

/// Settings of a scenario. Errors: UserError for a file that is none.
inline sim::ScenarioSource ScenarioSourceOf(const SettingsSource& given,
                                            const std::vector<std::string>& overrides) {
  if (given.text) return {.file = given.file, .text = *given.text, .overrides = overrides};
  const std::string file = sim::ReadyFile(given.file, "scenarios", "scenario");
  return {.file = file, .text = sim::ReadYamlText(file), .overrides = overrides};
}

}  // namespace gauntlet::python
