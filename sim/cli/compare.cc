#include <memory>

#include "sim/cli/commands.h"
#include "sim/cli/study_command.h"
#include "sim/cli/usage_error.h"

namespace gauntlet::sim {

void AddCompareCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "compare", "Run every controller over several seeds: means, 95 % intervals, ranking");
  const auto options = std::make_shared<StudyCommand>();
  options->comparison = true;
  options->seeds = 0;
  AddStudyOptions(*command, *options);
  command
      ->add_option("--seeds", options->seeds,
                   "number of seeds, counted up from the scenario's; each is another glove, and "
                   "takes the next of the scenario's repetitions [8, or one for each repetition]")
      ->transform(WholeNumber(1, 100'000));
  command->footer(
      "\nExamples:\n  gauntlet compare scenarios/door_opening.yaml --video\n"
      "  gauntlet compare scenarios/random_motion.yaml --seeds 32 --controllers "
      "raw,paper_kalman\n");
  command->callback([options] { RunStudyCommand(*options); });
}

}  // namespace gauntlet::sim
