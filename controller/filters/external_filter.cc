#include "controller/filters/external_filter.h"

namespace gauntlet::controller {

void ExternalConfig::Visit(SettingsVisitor& visitor) {
  visitor.Text({.key = "command",
                .help = "the program and its arguments; quotes keep blanks, no shell reads it"},
               command);
  visitor.Text({.key = "library",
                .help = "in place of a program, a shared library with gauntlet_filter_1() of "
                        "gauntlet_filter.h"},
               library);
  visitor.Path({"answers",
                "in place of both, what another program made of the recording that is played: a "
                "file with the same rows"},
               answers);
  visitor.Path({"answers_map", "column map of that file; by default as that of the recording"},
               answers_map);
  visitor.Path({"folder", "where it runs or is [the folder of the file that names it]"}, folder);
  visitor.Number(
      {"timeout_ms", "longest wait for an answer of a program; for the first, ten times as long", 1,
       600'000},
      timeout_ms);
  visitor.Flag({"deterministic",
                "its answers depend on its samples and parameters alone: finished trials are kept"},
               deterministic);
  visitor.NamedNumbers({"parameters", "numbers that it gets in its first line, by name"},
                       parameters);
}

}  // namespace gauntlet::controller
