#include <fmt/core.h>

#include "tests/loop/joint_loop_bench.h"
#include "tests/measurements/hand_measurements.h"

namespace gauntlet::sim::testing {

void PrintJointLoop() {
  fmt::print(
      "| servo | loop | expected delay [ms] | hysteresis MCP, PIP [deg] | error at rest MCP, PIP "
      "[deg] | swing at rest MCP, PIP [deg] | gain MCP, PIP | PIP behind MCP [ms] |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const ServoKind& kind : ServoKinds()) {
    const HandConfig hand = SensingHand(kind.defaults);
    const AtRest without = MeasureAtRest(hand, {});
    const controller::JointLoopConfig fitted = FittedLoop(hand, without);
    controller::JointLoopConfig pi_alone = fitted;
    pi_alone.friction_deg = {0.0};
    const auto print = [&](const char* name, const controller::JointLoopConfig& loop,
                           const AtRest& rest) {
      const OnASine sine = MeasureOnASine(hand, loop, 10.0);
      fmt::print(
          "| `{}` | {} | {:.0f} | {:.2f}, {:.2f} | {:.2f}, {:.2f} | {:.2f}, {:.2f} | {:.2f}, "
          "{:.2f} | {:.0f} |\n",
          kind.name, name, fitted.expected_delay_ms, rest.hysteresis_deg.mcp,
          rest.hysteresis_deg.pip, rest.error_deg.mcp, rest.error_deg.pip, rest.swing_deg.mcp,
          rest.swing_deg.pip, sine.gain.mcp, sine.gain.pip, sine.delay_ms.pip - sine.delay_ms.mcp);
    };
    print("none", {}, without);
    print("PI", pi_alone, MeasureAtRest(hand, pi_alone));
    print("PI and friction", fitted, MeasureAtRest(hand, fitted));
  }
}

}  // namespace gauntlet::sim::testing
