#include <fmt/core.h>

#include "tests/hand/servo_response.h"
#include "tests/measurements/hand_measurements.h"

namespace gauntlet::sim::testing {

void PrintServos() {
  constexpr double kSteps_deg[] = {10.0, 20.0, 60.0, 90.0, 135.0};
  fmt::print(
      "| kind | first motion [ms] | 10 to 90 % of 10, 20, 60, 90, 135 deg [ms] | overshoot of 20 "
      "[deg] | steady error [deg] | behind a sine of 1 Hz [ms] |\n|---|---|---|---|---|---|\n");
  for (const ServoKind& kind : ServoKinds()) {
    std::string rises;
    StepResponse of_20;
    for (double step_deg : kSteps_deg) {
      const StepResponse response = MeasureStep(kind.defaults, step_deg);
      rises += fmt::format("{}{:.0f}", rises.empty() ? "" : ", ", response.rise_ms);
      if (step_deg == 20.0) of_20 = response;
    }
    fmt::print("| `{}` | {:.0f} ({:.0f} to {:.0f}) | {} | {:.1f} | {:.2f} | {:.0f} |\n", kind.name,
               of_20.first_motion_ms, of_20.earliest_ms, of_20.latest_ms, rises,
               of_20.overshoot_deg, of_20.error_deg, MeasureSineDelay(kind.defaults));
  }
  fmt::print("\n| kind | figure | measured [ms] | simulated [ms] | difference [ms] | source |\n");
  fmt::print("|---|---|---|---|---|---|\n");
  for (const PublishedFigure& figure : PublishedFigures()) {
    const auto kind = std::ranges::find(ServoKinds(), figure.kind, &ServoKind::name);
    const double simulated_ms = figure.Simulated(kind->defaults);
    fmt::print("| `{}` | {} | {:.0f} | {:.0f} | {:+.0f} | {} |\n", figure.kind, figure.what,
               figure.published_ms, simulated_ms, simulated_ms - figure.published_ms,
               figure.source);
  }
}

}  // namespace gauntlet::sim::testing
