// Coverage of intervals from blocks of one recording, for errors whose true difference is known.
// The table of docs/evidence/measurements.md.

#include <fmt/core.h>

#include <cstdio>
#include <string>

#include "tests/statistics/simulated_recordings.h"

namespace {

using namespace gauntlet::sim;

struct Case {
  const char* name;
  RecordedErrors errors;
  double correlation_s;
};

constexpr Case kCases[] = {
    {"own errors, 0.3 s", RecordedErrors::kOwn, 0.3},
    {"own errors, 1 s", RecordedErrors::kOwn, 1.0},
    {"own errors, 3 s", RecordedErrors::kOwn, 3.0},
    {"own errors, 10 s", RecordedErrors::kOwn, 10.0},
    {"level of the squared error, 0.3 s", RecordedErrors::kLevel, 0.3},
    {"level of the squared error, 1 s", RecordedErrors::kLevel, 1.0},
    {"level of the squared error, 3 s", RecordedErrors::kLevel, 3.0},
    {"level of the squared error, 10 s", RecordedErrors::kLevel, 10.0},
    {"shared errors and noise, 0.3 s", RecordedErrors::kShared, 0.3},
    {"shared errors and noise, 1 s", RecordedErrors::kShared, 1.0},
    {"shared errors and noise, 3 s", RecordedErrors::kShared, 3.0},
    {"shared errors and noise, 10 s", RecordedErrors::kShared, 10.0},
    {"oscillation of 2 s, 1 s", RecordedErrors::kOscillating, 1.0},
    {"oscillation of 2 s, 3 s", RecordedErrors::kOscillating, 3.0},
    {"movements, rests of 0.5 s", RecordedErrors::kMovements, 0.5},
    {"movements, rests of 2 s", RecordedErrors::kMovements, 2.0},
    {"movements, rests of 8 s", RecordedErrors::kMovements, 8.0},
    {"few fast movements, rests of 2 s", RecordedErrors::kRareFast, 2.0},
};

std::string Percent(double share) {
  return share == share ? fmt::format("{:.1f}", 100.0 * share) : "-";
}

}  // namespace

int main(int argc, char** argv) {
  fmt::print(
      "| errors, correlation time of the process | recording [s] | found T [s] | with intervals | "
      "blocks | coverage | of a family |\n|---|---|---|---|---|---|---|\n");
  for (const Case& one : kCases) {
    for (const double duration_s : {40.0, 60.0, 100.0, 300.0}) {
      const RecordingsOutcome outcome =
          SimulateRecordings({.errors = one.errors,
                              .correlation_s = one.correlation_s,
                              .duration_s = duration_s,
                              .recordings = argc > 1 ? std::stoi(argv[1]) : 2000});
      fmt::print("| {} | {:g} | {:.1f} | {} | {} | {} | {} |\n", one.name, duration_s,
                 outcome.correlation_s, Percent(outcome.with_intervals),
                 outcome.with_intervals > 0.0 ? fmt::format("{:.0f}", outcome.blocks) : "-",
                 Percent(outcome.coverage), Percent(outcome.family_coverage));
      std::fflush(stdout);
    }
  }
}
