// Where the hands of a comparison differ most.
#include "sim/answers/compare/decisive_second.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace gauntlet::sim {
namespace {

constexpr int kTicks = 4000;

/// Hands of two joints at 1 kHz that move as `lag_rad(tick)` apart; the first is the baseline. The
/// second joint, which is not measured, is far off at the end.
FinishedStudy TwoHands(double (*lag_rad)(int)) {
  FinishedStudy finished;
  GloveSignal glove;
  glove.tick_rate_hz = 1000.0;
  finished.result.first_glove = std::make_shared<const GloveSignal>(std::move(glove));
  finished.study.measured_joints = {0};
  finished.summary.baseline = 0;
  for (int c = 0; c < 2; ++c) {
    Trace trace;
    trace.hand_angle_rad = Signal::Zero(kTicks, 2);
    for (int tick = 0; tick < kTicks; ++tick) {
      trace.hand_angle_rad(tick, 0) = std::sin(0.003 * tick) - c * lag_rad(tick);
      trace.hand_angle_rad(tick, 1) = c * (tick > 3500 ? 2.0 : 0.0);
    }
    finished.result.first_traces.push_back(std::move(trace));
    ControllerSummary& controller = finished.summary.controllers.emplace_back();
    controller.summary.resize(Metrics().size());
    finished.summary.answer.shown.push_back(static_cast<std::size_t>(c));
  }
  return finished;
}

// A hump from 1.9 to 2.5 s, highest at 2.2 s: the whole of it is in the second, in steps of 0.05 s.
TEST(DecisiveSecond, HoldsTheLargestDifferenceOfMeasuredJoints) {
  const auto second = DecisiveSecondOf(
      TwoHands([](int tick) { return std::max(0.0, 0.3 - std::abs(tick - 2200) / 1000.0); }));
  ASSERT_TRUE(second);
  EXPECT_NEAR(second->moment_s, 2.2, 1e-9);
  EXPECT_NEAR(second->to_s - second->from_s, 1.0, 1e-9);
  EXPECT_LE(second->from_s, 1.9 + 1e-9);
  EXPECT_GE(second->to_s, 2.5 - 1e-9);
  EXPECT_NEAR(std::remainder(second->from_s, 0.05), 0.0, 1e-9);
}

TEST(DecisiveSecond, NeedsTwoHandsThatHaveTraces) {
  FinishedStudy finished = TwoHands([](int) { return 0.1; });
  finished.result.first_traces.pop_back();
  EXPECT_FALSE(DecisiveSecondOf(finished));
  finished.summary.controllers.pop_back();
  finished.summary.answer.shown.pop_back();
  EXPECT_FALSE(DecisiveSecondOf(finished));
}

}  // namespace
}  // namespace gauntlet::sim
