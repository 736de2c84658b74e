#include "sim/cli/commands.h"
#include "sim/cli/study_command.h"

namespace gauntlet::sim {
namespace {

struct CompareCommand : StudyCommand {
  static constexpr auto kName = "compare";
  static constexpr auto kPurpose =
      "Run every controller over several seeds: means, 95 % intervals, ranking";
  CompareCommand() {
    seeds = 0;
    comparison = true;
  }

  Options Rows() {
    return {
        StudyCommand::Rows(),
        Option("--seeds", &seeds, {.range = {1, 100'000}},
               "number of seeds, counted up from the scenario's; each is another glove, and takes "
               "the next of the scenario's repetitions [8, or one for each repetition]"),
    };
  }

  static constexpr auto kNotes = R"(
Examples:
  gauntlet compare scenarios/door_opening.yaml --video
  gauntlet compare scenarios/random_motion.yaml --seeds 32 --controllers raw,paper_kalman
)";
};

void Compare(const CompareCommand& command) { RunStudyCommand(command); }

}  // namespace

Command MakeCompareCommand() { return MakeCommand(Compare); }

}  // namespace gauntlet::sim
