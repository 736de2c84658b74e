#include "sim/live/session_scores.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "sim/base/stop.h"
#include "tests/link/two_motors.h"
#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

constexpr double kRate_hz = 1000.0;
constexpr double kDelay_s = 0.04;
constexpr std::size_t kJoints = 2;
constexpr double kRounding = 1e-9;

controller::JointMap JointMapOfTwo() {
  controller::TendonTransmission hand = test::TwoMotors();
  hand.joint_names = {"a", "b"};
  hand.reference_angle_rad = {0.0, 0.0};
  return {{}, {"a", "b"}, hand};
}

/// A motion that does not repeat; another one of each joint [rad].
double Wearer_rad(double time_s, std::size_t joint) {
  const double phase = 1.0 + static_cast<double>(joint);
  return 0.4 * std::sin(2.0 * kPi * 0.31 * time_s + phase) +
         0.3 * std::sin(2.0 * kPi * std::numbers::sqrt2 * 0.37 * time_s) +
         0.2 * std::sin(2.0 * kPi * 0.83 * time_s * (1.0 + 0.02 * time_s) + phase);
}

/// Jitter of so many deg RMS at 20 Hz.
double Jitter_rad(double time_s, double rms_deg) {
  return std::sqrt(2.0) * rms_deg * kRadPerDeg * std::sin(2.0 * kPi * 20.0 * time_s);
}

/// A session in which each controller asks for the wearer's angles kDelay_s later, the first with
/// jitter of 0.4 deg, the second 20 ms later still and with 0.1 deg.
class Session {
 public:
  /// Without a length: a real glove, with a sample every 10 ticks.
  explicit Session(double simulated_s = 0.0) : Session(How(simulated_s)) {}
  explicit Session(RunningScoring how) : window_(std::move(how)) {}

  static RunningScoring How(double simulated_s) {
    RunningScoring how{.scoring = {.rate_hz = kRate_hz, .joints = {0, 1}},
                       .earliest_delay_s = {0.0, 0.0},
                       .joint_map = JointMapOfTwo(),
                       .simulated_glove = nullptr};
    if (simulated_s == 0.0) return how;
    auto glove = std::make_shared<GloveSignal>();
    glove->true_angle_rad = Signal(std::lround(simulated_s * kRate_hz), kJoints);
    for (Eigen::Index tick = 0; tick < glove->true_angle_rad.rows(); ++tick) {
      for (std::size_t joint = 0; joint < kJoints; ++joint) {
        glove->true_angle_rad(tick, static_cast<Eigen::Index>(joint)) =
            Wearer_rad(static_cast<double>(tick) / kRate_hz, joint);
      }
    }
    how.simulated_glove = std::move(glove);
    return how;
  }

  static double Asked_rad(std::size_t controller, double time_s, std::size_t joint) {
    const double more_s = controller == 0 ? 0.0 : 0.02;
    return Wearer_rad(time_s - kDelay_s - more_s, joint) +
           Jitter_rad(time_s, controller == 0 ? 0.4 : 0.1);
  }

  static std::vector<double> ValuesOf(std::int64_t tick, int driving) {
    const double time_s = static_cast<double>(tick) / kRate_hz;
    const double sample_s = std::floor(time_s * 100.0) / 100.0;
    std::vector<double> values;
    for (std::size_t j = 0; j < kJoints; ++j) values.push_back(Wearer_rad(sample_s, j));
    for (const std::size_t controller :
         {static_cast<std::size_t>(driving), std::size_t{0}, std::size_t{1}}) {
      for (std::size_t j = 0; j < kJoints; ++j) values.push_back(Asked_rad(controller, time_s, j));
    }
    return values;
  }

  void Run(double from_s, double to_s, int driving = 0) {
    for (auto tick = std::llround(from_s * kRate_hz); tick < std::llround(to_s * kRate_hz);
         ++tick) {
      window_.Add({.number = tick, .driving = driving, .has_sample = tick % 10 == 0},
                  ValuesOf(tick, driving));
    }
  }

  ScoreWindow window_;
};

/// The scores of gauntlet run, of these seconds. They come from both joints at once.
std::pair<double, double> JitterAndDelay(std::size_t controller, double from_s, double to_s) {
  const auto first = std::llround(from_s * kRate_hz);
  const auto rows = std::llround(to_s * kRate_hz) - first;
  Signal reference_rad(rows, kJoints), asked_rad(rows, kJoints);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double time_s = static_cast<double>(first + row) / kRate_hz;
    for (std::size_t j = 0; j < kJoints; ++j) {
      reference_rad(row, j) = Wearer_rad(time_s, j);
      asked_rad(row, j) = Session::Asked_rad(controller, time_s, j);
    }
  }
  const std::vector<std::string> joints = {"a", "b"};
  const ScoreRows table(joints, {}, {});
  ScoreInput input{
      .rate_hz = kRate_hz, .reference_angle_rad = &reference_rad, .hand_angle_rad = &asked_rad};
  const std::vector<double> summary = ComputeScores(input, table).summary;
  return {summary[MetricIndex("jitter_rms_deg")], summary[MetricIndex("delay_ms")]};
}

TEST(SessionScores, AreTheScoresOfTheSameRows) {
  Session session(20.0);
  session.Run(0.0, 3.0);
  auto scores = session.window_.Scores();
  ASSERT_EQ(scores.size(), 2U);
  EXPECT_DOUBLE_EQ(scores[1].over_s, 3.0);
  EXPECT_NEAR(scores[1].jitter_rms_deg, JitterAndDelay(1, 0.0, 3.0).first, kRounding);
  EXPECT_TRUE(std::isnan(scores[1].delay_ms));
  session.Run(3.0, 13.456);
  scores = session.window_.Scores();
  for (std::size_t controller = 0; controller < 2; ++controller) {
    const auto [jitter_deg, delay_ms] = JitterAndDelay(controller, 3.456, 13.456);
    EXPECT_DOUBLE_EQ(scores[controller].over_s, 10.0);
    EXPECT_NEAR(scores[controller].jitter_rms_deg, jitter_deg, kRounding);
    EXPECT_NEAR(scores[controller].delay_ms, delay_ms, kRounding);
  }
  EXPECT_NEAR(scores[0].jitter_rms_deg, 0.4, 0.002);
  EXPECT_NEAR(scores[1].jitter_rms_deg, 0.1, 0.002);
  EXPECT_NEAR(scores[0].delay_ms, 40.0, 1.0);
  EXPECT_NEAR(scores[1].delay_ms, 60.0, 1.0);
}

TEST(SessionScores, OfTheOneThatDrivesBeginAtTheSwitch) {
  Session session(30.0);
  session.Run(0.0, 12.0);
  session.Run(12.0, 17.0, 1);
  auto scores = session.window_.Scores();
  EXPECT_DOUBLE_EQ(scores[0].over_s, 10.0);
  EXPECT_NEAR(scores[0].jitter_rms_deg, JitterAndDelay(0, 7.0, 17.0).first, kRounding);
  EXPECT_DOUBLE_EQ(scores[1].over_s, 5.0);
  EXPECT_NEAR(scores[1].jitter_rms_deg, JitterAndDelay(1, 12.0, 17.0).first, kRounding);
  EXPECT_NEAR(scores[1].delay_ms, JitterAndDelay(1, 12.0, 17.0).second, kRounding);
  session.Run(17.0, 23.0, 1);
  scores = session.window_.Scores();
  EXPECT_DOUBLE_EQ(scores[1].over_s, 10.0);
  EXPECT_NEAR(scores[1].jitter_rms_deg, JitterAndDelay(1, 13.0, 23.0).first, kRounding);
}

TEST(SessionScores, OfARealGloveCompareWithItsSmoothedSamples) {
  Session session;
  session.Run(0.0, 15.0);
  const auto scores = session.window_.Scores();
  EXPECT_NEAR(scores[0].jitter_rms_deg, 0.4, 0.002);
  EXPECT_NEAR(scores[0].delay_ms, 40.0, 1.0);
  EXPECT_NEAR(scores[1].delay_ms, 60.0, 1.0);
}

// Wrong: while the glove was silent the wearer stood still, and jumped.
TEST(SessionScores, LeaveOutTheTimeOfASilentGlove) {
  for (const double longest_gap_s : {0.1, 100.0}) {
    RunningScoring how = Session::How(0.0);
    how.longest_gap_s = longest_gap_s;
    Session session(std::move(how));
    session.Run(0.0, 4.0);
    for (std::int64_t tick = 4000; tick < 6000; ++tick) {
      session.window_.Add({.number = tick}, Session::ValuesOf(3999, 0));
    }
    session.Run(6.0, 12.0);
    const RunningScore raw = session.window_.Scores()[0];
    const bool is_left_out = longest_gap_s < 2.0;
    EXPECT_EQ(std::abs(raw.delay_ms - 40.0) < 1.5, is_left_out) << raw.delay_ms;
    EXPECT_EQ(std::abs(raw.jitter_rms_deg - 0.4) < 0.01, is_left_out) << raw.jitter_rms_deg;
  }
}

TEST(SessionScores, RepeatAShortSkipAndBeginAnewBehindALongOne) {
  Session skipping(20.0), repeated(20.0);
  skipping.Run(0.0, 5.0);
  skipping.Run(5.03, 8.0);
  repeated.Run(0.0, 5.0);
  for (std::int64_t tick = 5000; tick < 5030; ++tick) {
    repeated.window_.Add({.number = tick}, Session::ValuesOf(4999, 0));
  }
  repeated.Run(5.03, 8.0);
  EXPECT_DOUBLE_EQ(skipping.window_.Scores()[0].over_s, 8.0);
  EXPECT_NEAR(skipping.window_.Scores()[0].jitter_rms_deg,
              repeated.window_.Scores()[0].jitter_rms_deg, kRounding);
  skipping.Run(9.0, 11.0);
  EXPECT_DOUBLE_EQ(skipping.window_.Scores()[0].over_s, 2.0);
  EXPECT_NEAR(skipping.window_.Scores()[0].jitter_rms_deg, JitterAndDelay(0, 9.0, 11.0).first,
              kRounding);
}

// Wrong: Ctrl-C ends the process before its motors are at rest.
TEST(SessionScores, AreGivenUpWhereTheProgramIsToStop) {
  LiveView view(kJoints, kJoints, 2, kRate_hz);
  SessionScores scores(Session::How(20.0), view);
  for (std::int64_t tick = 0; tick < 1900; ++tick) {
    const std::vector<double> values = Session::ValuesOf(tick, 0);
    const std::span all(values);
    view.ShowTick({.number = tick}, all.first(kJoints), all.subspan(kJoints, kJoints),
                  all.last(2 * kJoints));
  }
  const auto wait_for_scores = [&](std::chrono::seconds most) {
    const auto end = std::chrono::steady_clock::now() + most;
    while (std::chrono::steady_clock::now() < end) {
      if (view.NextScores([](double, std::span<const double>) {})) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  };
  EXPECT_TRUE(wait_for_scores(std::chrono::seconds(30)));
  stop_signal = SIGINT;
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // one may be under way
  while (view.NextScores([](double, std::span<const double>) {})) {
  }
  EXPECT_FALSE(wait_for_scores(std::chrono::seconds(2)));
  stop_signal = 0;
  EXPECT_TRUE(wait_for_scores(std::chrono::seconds(30)));
}

}  // namespace
}  // namespace gauntlet::sim
