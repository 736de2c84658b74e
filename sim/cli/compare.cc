#include <limits>
#include <string>

#include "sim/cli/commands.h"
#include "sim/cli/study_command.h"

namespace gauntlet::sim {
namespace {

struct CompareCommand : StudyCommand {
  static constexpr auto kName = "compare";
  static constexpr auto kPurpose = "Compare all controllers and recommend one";
  static constexpr auto kGroup = Group::kEveryday;
  CompareCommand() {
    seeds = 0;
    comparison = true;
  }

  Options Rows() {
    return {
        StudyCommand::Rows(
            Option("--seeds", &seeds, {.range = {1, 100'000}},
                   "number of seeds; each draws a new glove and uses the next recording [8, or one "
                   "for each recording]")),
        Option(
            "--estimate", &estimate, {},
            "print how long it takes on this computer, from a measured trial, and write nothing"),
    };
  }

  static constexpr auto kNotes = R"(
Examples:
  gauntlet compare scenarios/door_opening.yaml --video
  gauntlet compare scenarios/random_motion.yaml --seeds 32 --controllers raw,paper_kalman
  gauntlet compare scenarios/door_opening.yaml --priority jitter
)";
};

/// A comparison with one seed: no confidence intervals, and no database to go on from.
struct RunCommand : StudyCommand {
  static constexpr auto kName = "run";
  static constexpr auto kPurpose = "As compare with one seed";
  static constexpr auto kGroup = Group::kOther;
  int seed = -1;  // -1: the scenario's

  Options Rows() {
    return StudyCommand::Rows(Option("--seed", &seed,
                                     {.range = {0, std::numeric_limits<int>::max()}},
                                     "seed of all random numbers [as in the scenario]"));
  }

  static constexpr auto kNotes = R"(
Runs every controller once, without confidence intervals and study.db. A comparison in the same
folder is kept.

Example:
  gauntlet run scenarios/hold_still.yaml --seed 7 --out out/still
)";
};

void Compare(const CompareCommand& command) { RunStudyCommand(command); }

void RunOnce(const RunCommand& command) {
  StudyCommand study = command;
  if (command.seed >= 0) study.overrides.push_back("seed=" + std::to_string(command.seed));
  RunStudyCommand(study);
}

}  // namespace

Command MakeRunCommand() { return MakeCommand(RunOnce); }

Command MakeCompareCommand() { return MakeCommand(Compare); }

}  // namespace gauntlet::sim
