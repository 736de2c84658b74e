// Coverage of the gain that `gauntlet tune` prints for recordings, against fresh motion of the same
// wearer. The table of docs/evidence/measurements.md.

#include <fmt/core.h>

#include <cstdio>
#include <string>

#include "tests/search/simulated_tuning.h"

namespace {

using namespace gauntlet::sim;

struct Case {
  const char* name;
  SimulatedMotion motion;
  int files;
  double duration_s;
};

constexpr Case kCases[] = {
    {"continuous, 1 of 60 s", SimulatedMotion::kContinuous, 1, 60.0},
    {"continuous, 3 of 30 s", SimulatedMotion::kContinuous, 3, 30.0},
    {"continuous, 8 of 15 s", SimulatedMotion::kContinuous, 8, 15.0},
    {"movements and rests, 1 of 60 s", SimulatedMotion::kMovements, 1, 60.0},
    {"movements and rests, 3 of 30 s", SimulatedMotion::kMovements, 3, 30.0},
    {"movements and rests, 8 of 15 s", SimulatedMotion::kMovements, 8, 15.0},
};

}  // namespace

int main(int argc, char** argv) {
  const int scenarios = argc > 1 ? std::stoi(argv[1]) : 150;
  const int jobs = argc > 2 ? std::stoi(argv[2]) : 1;
  const std::string part = argc > 3 ? argv[3] : "";
  fmt::print(
      "| recordings | answered | coverage | printed gain | fresh gain |\n"
      "|---|---|---|---|---|\n");
  for (const Case& one : kCases) {
    if (std::string(one.name).find(part) == std::string::npos) continue;
    const TuningOutcome outcome = SimulateTuning({.motion = one.motion,
                                                  .duration_s = one.duration_s,
                                                  .files = one.files,
                                                  .scenarios = scenarios,
                                                  .jobs = jobs});
    fmt::print("| {} | {} | {:.1f} | {:.3f} | {:.3f} |\n", one.name, outcome.answered,
               100.0 * outcome.covered / outcome.answered, outcome.printed_deg, outcome.fresh_deg);
    std::fflush(stdout);
  }
}
