#include "controller/filters/external_filter.h"

namespace gauntlet::controller {

void ExternalConfig::Visit(SettingsVisitor& visitor) {
  visitor.Text({.key = "command",
                .help = "the program and its arguments; quotes keep blanks, no shell reads it",
                .required = true},
               command);
  visitor.Path({"folder", "where it runs [the folder of the file that names it]"}, folder);
  visitor.Number(
      {"timeout_ms", "longest wait for an answer; for the first, ten times as long", 1, 600'000},
      timeout_ms);
  visitor.Flag({"deterministic",
                "its answers depend on its samples and parameters alone: finished trials are kept"},
               deterministic);
  visitor.NamedNumbers({"parameters", "numbers that it gets in its first line, by name"},
                       parameters);
}

}  // namespace gauntlet::controller
