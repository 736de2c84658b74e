#include "sim/study/made_with.h"

#include <fmt/format.h>

#include "sim/base/mathematics.h"
#include "sim/study/scenario/scenario_files.h"

namespace gauntlet::sim {

std::string MadeElsewhere(const MadeWith& made, const HandModel& hand,
                          std::string_view consequence) {
  if (made.model_hash.empty() || made.model_hash == hand.Hash()) return {};
  return fmt::format(
      "warning: this scenario was resolved with another hand model (hash {}, now {}); {}",
      made.model_hash, hand.Hash(), consequence);
}

std::vector<std::string> WarningsOf(const Study& study) {
  const MadeWith& made = study.scenario.made_with;
  std::vector<std::string> lines;
  if (std::string line = MadeElsewhere(made, *study.hand, "the run may differ"); !line.empty()) {
    lines.push_back(std::move(line));
  }
  if (!made.mathematics.empty() && made.mathematics != HashOfMathematics()) {
    lines.emplace_back(
        "warning: this scenario was resolved on a machine whose sin, exp, ... differ in the last "
        "bits (another kind of processor or system); so will the results");
  }
  for (const auto& [then, now] : ChangedFiles(study.scenario)) {
    lines.push_back(
        fmt::format("warning: {} is not as it was when this scenario was resolved (hash {}, now "
                    "{}): the results will be others",
                    now.file, then.hash, now.hash));
  }
  lines.insert(lines.end(), study.remarks.begin(), study.remarks.end());
  return lines;
}

}  // namespace gauntlet::sim
