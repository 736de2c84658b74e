#include <limits>

#include "sim/cli/commands.h"
#include "sim/cli/study_command.h"

namespace gauntlet::sim {
namespace {

struct RunCommand : StudyCommand {
  static constexpr auto kName = "run";
  static constexpr auto kPurpose = "Run every controller of a scenario once";
  static constexpr auto kGroup = Group::kStudy;
  int seed = -1;  // -1: the scenario's

  Options Rows() {
    return {
        StudyCommand::Rows(),
        Option("--seed", &seed, {.range = {0, std::numeric_limits<int>::max()}},
               "seed of all random numbers [as in the scenario]"),
    };
  }

  static constexpr auto kNotes = R"(
Example:
  gauntlet run scenarios/hold_still.yaml --seed 7 --out out/still
)";
};

void RunOnce(const RunCommand& command) {
  StudyCommand study = command;
  if (command.seed >= 0) study.overrides.push_back("seed=" + std::to_string(command.seed));
  RunStudyCommand(study);
}

}  // namespace

Command MakeRunCommand() { return MakeCommand(RunOnce); }

}  // namespace gauntlet::sim
