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
        StudyCommand::Rows(),
        Option("--seeds", &seeds, {.range = {1, 100'000}},
               "number of seeds; each draws a new glove and uses the next recording [8, or one for "
               "each recording]"),
    };
  }

  static constexpr auto kNotes = R"(
Examples:
  gauntlet compare scenarios/door_opening.yaml --video
  gauntlet compare scenarios/random_motion.yaml --seeds 32 --controllers raw,paper_kalman
  gauntlet compare scenarios/door_opening.yaml --priority jitter
)";
};

void Compare(const CompareCommand& command) { RunStudyCommand(command); }

}  // namespace

Command MakeCompareCommand() { return MakeCommand(Compare); }

}  // namespace gauntlet::sim
