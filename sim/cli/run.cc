#include <limits>
#include <memory>

#include "sim/cli/commands.h"
#include "sim/cli/study_command.h"
#include "sim/cli/usage_error.h"

namespace gauntlet::sim {

void AddRunCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "run", "Run every controller of a scenario once, on the same glove signal and hand");
  const auto options = std::make_shared<StudyCommand>();
  const auto seed = std::make_shared<int>(-1);
  AddStudyOptions(*command, *options);
  command
      ->add_option(
          "--seed", *seed,
          "seed of all random numbers, and the repetition that compare gives it [as in the "
          "scenario]")
      ->transform(WholeNumber(0, std::numeric_limits<int>::max()));
  command->footer(
      "\nExample:\n  gauntlet run scenarios/hold_still.yaml --seed 7 --out out/still\n");
  command->callback([options, seed] {
    if (*seed >= 0) options->overrides.push_back("seed=" + std::to_string(*seed));
    RunStudyCommand(*options);
  });
}

}  // namespace gauntlet::sim
