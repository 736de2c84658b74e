// Sessions of some tenths of a second with gloves and motors of the test. One in which the machine
// skipped a tick says nothing of the program, and is left out.
#include "sim/live/live_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/live/device/device_clock.h"
#include "tests/support/program.h"
#include "tests/support/read_file.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kBusy = "the machine is busy";

GloveConfig ShortMotion() {
  GloveConfig config;
  config.rate_hz = 100.0;
  config.motion.settings = RandomMotionConfig{.duration_s = 0.4};
  return config;
}

controller::ControllerConfig Smooth() {
  controller::ControllerConfig config;
  config.filters = {{controller::ExponentialConfig{.alpha = 0.2}}};
  return config;
}

LiveSetup SetupOf(const GloveConfig& glove) {
  static const auto hand = std::make_shared<const HandModel>(
      HandConfig(), MakeLoopTiming({.sample_rate_hz = 100.0, .event_delay_ms = 5.0}));
  return {.trial = {.controller_name = "first",
                    .controller = {},
                    .calibration = NominalCalibration(glove),
                    .joint_map = {},
                    .hand = hand}};
}

/// A session of the whole simulated motion.
LiveSetup Simulated() {
  LiveSetup setup = SetupOf(ShortMotion());
  setup.simulated_glove = std::make_shared<GloveSignal>(SynthesiseGlove(ShortMotion(), 1));
  return setup;
}

/// A session in which the machine skipped no tick, if one of five is such. `begin`: before each.
LiveResult RunWithoutSkips(
    const LiveSetup& setup, const std::function<void()>& begin = [] {}) {
  LiveResult result;
  for (int i = 0; i < 5; ++i) {
    begin();
    result = RunLive(setup);
    if (result.facts.skipped_ticks == 0) break;
  }
  return result;
}

template <class Matrix>
auto LargestDifference(const Matrix& a, const Matrix& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

TEST(LiveSession, OfASimulatedGloveIsATrialInRealTime) {
  LiveSetup setup = Simulated();
  setup.shadows = {{"same", setup.trial.controller}, {"smooth", Smooth()}};
  const LiveResult live = RunWithoutSkips(setup);
  if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
  const LiveFacts& facts = live.facts;
  EXPECT_EQ(facts.end, LiveEnd::kGloveEnded);
  EXPECT_EQ(facts.ticks + facts.skipped_ticks, 400);
  EXPECT_EQ(facts.duration_s, 0.4);
  EXPECT_EQ(live.trace.hand_angle_rad.rows(), 400);
  EXPECT_EQ(live.trace_rows_left_out, 0);
  EXPECT_EQ(facts.step.count(), facts.ticks);
  EXPECT_EQ(facts.step_cpu.count(), facts.ticks);
  EXPECT_EQ(facts.tick_work.count(), facts.ticks);
  EXPECT_EQ(facts.lateness.count(), facts.ticks + 1);  // the one that found the end, too
  EXPECT_LE(facts.step.max_us(), facts.tick_work.max_us());
  EXPECT_EQ(facts.tiers[0].entered, 0);
  EXPECT_EQ(facts.rests, 0);
  EXPECT_EQ(facts.arrivals.frames, 0);
  ASSERT_EQ(live.shadows.size(), 2u);
  ASSERT_EQ(live.shadows[1].target_angle_rad.rows(), 400);
  EXPECT_EQ(live.shadows[1].step.count(), facts.ticks);

  const Trace trial = RunTrial(setup.trial, *setup.simulated_glove);
  EXPECT_EQ(live.trace.controller_name, "first");
  EXPECT_EQ(LargestDifference(live.trace.hand_angle_rad, trial.hand_angle_rad), 0.0);
  EXPECT_EQ(LargestDifference(live.trace.command_counts, trial.command_counts), 0);
  EXPECT_EQ(LargestDifference(live.trace.filtered_angle_rad, trial.filtered_angle_rad), 0.0);
  EXPECT_EQ(facts.untrusted_samples, trial.untrusted_samples);
  EXPECT_TRUE(live.trace.health.ok);
  setup.trial.controller = Smooth();
  const Signal smooth_rad = RunTrial(setup.trial, *setup.simulated_glove).target_angle_rad;
  EXPECT_LT(LargestDifference(live.shadows[0].target_angle_rad, trial.target_angle_rad), 1e-6);
  EXPECT_LT(LargestDifference(live.shadows[1].target_angle_rad, smooth_rad), 1e-6);
  EXPECT_GT(LargestDifference(live.shadows[0].target_angle_rad, smooth_rad), 1e-3);

  constexpr int kFrameTicks = 20;
  EXPECT_EQ(facts.commands, 400 / kFrameTicks);
  EXPECT_EQ(facts.repeated_samples, 0);
  EXPECT_EQ(facts.total.count(), facts.commands);
  int largest = 0;
  for (int tick = kFrameTicks + 5; tick < 400; tick += kFrameTicks) {
    largest = std::max(
        largest, (trial.command_counts.row(tick) - trial.command_counts.row(tick - kFrameTicks))
                     .cwiseAbs()
                     .maxCoeff());
  }
  EXPECT_EQ(facts.largest_step_counts, largest);
}

TEST(LiveSession, EndsAfterItsSecondsAndKeepsTheBeginningOfTheTrace) {
  LiveSetup setup = Simulated();
  setup.seconds = 0.2;
  setup.trace_s = 0.1;
  const LiveResult live = RunWithoutSkips(setup);
  if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
  EXPECT_EQ(live.facts.end, LiveEnd::kSeconds);
  EXPECT_GE(live.facts.ticks + live.facts.skipped_ticks, 200);
  EXPECT_LE(live.facts.ticks, 201);
  EXPECT_EQ(live.trace.hand_angle_rad.rows(), 100);
}

/// The moments that a watcher saw, behind the session.
struct Watched {
  std::vector<LiveMoment> moments;
  std::vector<std::vector<double>> values;
  std::vector<ShownTick> ticks;
};

Watched See(LiveView& view) {
  Watched watched;
  while (view.Next([&](const LiveMoment& moment, std::span<const double> values) {
    watched.moments.push_back(moment);
    watched.values.emplace_back(values.begin(), values.end());
  })) {
  }
  while (view.NextTick(
      [&](const ShownTick& tick, std::span<const double>) { watched.ticks.push_back(tick); })) {
  }
  return watched;
}

LiveView ViewOf(const LiveSetup& setup) {
  return {setup.trial.calibration.channel_names.size(), setup.trial.hand->joint_names().size(),
          1 + setup.shadows.size(), 1000.0};
}

TEST(LiveSession, ShowsItsMomentsToAWatcher) {
  LiveSetup setup = Simulated();
  setup.shadows = {{"smooth", Smooth()}};
  LiveView view = ViewOf(setup);
  setup.view = &view;
  const LiveResult live = RunWithoutSkips(setup, [&] { See(view); });
  if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
  const Watched watched = See(view);
  const auto count = static_cast<double>(watched.moments.size());
  EXPECT_EQ(count, 20.0);  // 50 a second
  double time_s = 0.0;
  for (std::size_t i = 0; i < watched.moments.size(); ++i) {
    const LiveMoment& moment = watched.moments[i];
    EXPECT_GE(moment.time_s, time_s);
    time_s = moment.time_s + 0.019;
    EXPECT_EQ(moment.driving, 0);
    EXPECT_FALSE(moment.is_still || moment.is_ending);
    EXPECT_TRUE(moment.has_sink);
    EXPECT_EQ(moment.queued_frames, 0);
    EXPECT_LE(moment.skipped_ticks, live.facts.skipped_ticks);
    EXPECT_GE(moment.largest_lateness_s, 0.0);
    EXPECT_LE(moment.largest_lateness_s, 1e-6 * live.facts.lateness.max_us() + 1e-9);
    EXPECT_GE(moment.silent_s, 0.0);
    EXPECT_LE(moment.commands, live.facts.commands);
    // The hand's angles, behind those of channels and of the command.
    const auto tick = static_cast<Eigen::Index>(std::lround(1000.0 * moment.time_s));
    const std::size_t joints = setup.trial.hand->joint_names().size();
    const std::size_t hand = setup.trial.calibration.channel_names.size() + joints;
    EXPECT_NEAR(watched.values[i][hand], live.trace.hand_angle_rad(tick - 1, 0), 1e-6);
    EXPECT_NEAR(watched.values[i][hand - joints], live.trace.target_angle_rad(tick - 1, 0), 1e-6);
    EXPECT_NEAR(watched.values[i][hand + 2 * joints], live.shadows[0].target_angle_rad(tick - 1, 0),
                1e-6);
  }
  ASSERT_EQ(watched.ticks.size(), 400u);
  for (std::size_t tick = 0; tick < 400; ++tick) {
    EXPECT_EQ(watched.ticks[tick].number, static_cast<std::int64_t>(tick));
    EXPECT_EQ(watched.ticks[tick].has_sample, tick % 10 == 0) << tick;
    EXPECT_EQ(watched.ticks[tick].driving, 0);
  }
}

TEST(LiveSession, SwitchesToTheControllerThatIsAskedForAndEndsItsTrace) {
  LiveSetup setup = Simulated();
  setup.shadows = {{"smooth", Smooth()}};
  LiveView view = ViewOf(setup);
  setup.view = &view;
  for (const int asked : {0, 1, 2}) {
    const LiveResult live = RunWithoutSkips(setup, [&] {
      See(view);
      view.Ask(asked);
    });
    if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
    const Watched watched = See(view);
    EXPECT_EQ(live.facts.switch_count, asked == 1 ? 1 : 0);
    ASSERT_EQ(live.facts.switches.size(), asked == 1 ? 1u : 0u);
    EXPECT_EQ(live.trace.hand_angle_rad.rows(),
              asked == 1 ? std::lround(1000.0 * live.facts.switches[0].time_s) : 400);
    EXPECT_EQ(live.shadows[0].target_angle_rad.rows(), 400);
    ASSERT_FALSE(watched.ticks.empty());
    EXPECT_EQ(watched.ticks.back().driving, asked == 1 ? 1 : 0);
    EXPECT_EQ(watched.moments.back().driving, asked == 1 ? 1 : 0);
    if (asked != 1) continue;
    EXPECT_EQ(live.facts.switches[0].to, 1);
    EXPECT_LT(live.facts.switches[0].time_s, 0.4);
  }
}

TEST(LiveSession, KeepsStretchesOfHalfASecondInWhichTheHandIsMarkedStill) {
  for (const double seconds : {0.45, 0.7}) {
    GloveConfig glove = ShortMotion();
    glove.motion.settings = RandomMotionConfig{.duration_s = seconds};
    LiveSetup setup = SetupOf(glove);
    setup.simulated_glove = std::make_shared<GloveSignal>(SynthesiseGlove(glove, 1));
    LiveView view = ViewOf(setup);
    setup.view = &view;
    const LiveResult live = RunWithoutSkips(setup, [&] {
      See(view);
      view.Mark(true);
    });
    if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
    EXPECT_EQ(live.facts.still.size(), seconds > 0.5 ? 1u : 0u);
    const Watched watched = See(view);
    EXPECT_TRUE(watched.moments.back().is_still);
    if (live.facts.still.empty()) continue;
    EXPECT_EQ(live.facts.still[0].begin_s, 0.0);
    EXPECT_NEAR(live.facts.still[0].end_s, seconds, 0.0011);
  }
}

/// A glove of the test: frames of all channels at 100 Hz, then its end. `count` of them; the first
/// `at_once` of them have waited.
class ScriptedGlove final : public FrameSource {
 public:
  ScriptedGlove(DeviceKind kind, int at_once, int count, std::size_t width)
      : at_once_(at_once), count_(count), values_(width) {
    address_.kind = kind;
    columns_.count = width + 1;
    columns_.number = 0;
    columns_.version = 1;
  }

  State Wait(std::chrono::nanoseconds timeout, const FrameReceiver& receive) override {
    if (sent_ >= count_) {
      if (ends) return State::kEnded;
      std::this_thread::sleep_for(timeout);
      return State::kOpen;
    }
    if (sent_ >= at_once_) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    do {
      Give(receive);
    } while (sent_ < at_once_);
    return State::kOpen;
  }
  const DeviceColumns& columns() const override { return columns_; }
  SourceCounts counts() const override { return {.frames = 1, .garbage = 2}; }
  std::string problem() const override { return ""; }
  std::string Description() const override { return "the test's glove"; }
  const DeviceAddress& address() const override { return address_; }

  /// Counts of all channels in a frame.
  static double CountsOf(int number) { return 400.0 + number; }

  std::function<std::int64_t(int)> number_of = [](int sent) { return sent; };
  bool ends = true;

 private:
  void Give(const FrameReceiver& receive) {
    std::vector<double> values = {static_cast<double>(sent_)};
    values.resize(columns_.count, CountsOf(sent_));
    receive({.arrival_ns = MonotonicNow_ns(), .number = number_of(sent_), .values = values});
    ++sent_;
  }

  int at_once_;
  int count_;
  int sent_ = 0;
  std::vector<double> values_;
  DeviceColumns columns_;
  DeviceAddress address_;
};

/// Motors of the test.
class KeepingMotors final : public FrameSink {
 public:
  Result Send(const OutgoingFrame& frame) override {
    numbers.push_back(frame.number);
    counts_.emplace_back(frame.values.begin(), frame.values.end());
    return result;
  }
  SinkCounts counts() const override { return {.frames = numbers.size()}; }
  std::string problem() const override { return ""; }
  std::string Description() const override { return "the test's motors"; }
  const std::vector<std::vector<double>>& sent() const { return counts_; }

  std::vector<std::int64_t> numbers;
  Result result = Result::kSent;

 private:
  std::vector<std::vector<double>> counts_;
};

LiveSetup WithGlove(FrameSource& source) {
  LiveSetup setup = SetupOf(ShortMotion());
  setup.source = &source;
  setup.channels = {
      .glove = setup.trial.calibration, .source = "--glove test", .map = {}, .unit = {}};
  setup.trial.links.config.glove.emplace().watchdog.settings = TieredWatchdog{};
  return setup;
}

const std::size_t kChannels = GloveChannels().size();

TEST(LiveSession, TakesEachFrameOfAFileAndNumbersThemAsTheSenderDoes) {
  const test::TemporaryDirectory folder;
  ScriptedGlove glove(DeviceKind::kFile, 3, 30, kChannels);
  glove.number_of = [](int sent) { return sent < 10 ? sent : sent == 10 ? 9 : sent + 4; };
  LiveSetup setup = WithGlove(glove);
  SessionRecording recording(setup.trial.calibration, 0.01,
                             {.angles = {}, .counts = folder.path() / "counts.csv"});
  setup.recording = &recording;
  std::vector<std::string> said;
  setup.say = [&](const std::string& line) { said.push_back(line); };
  const LiveResult live = RunLive(setup);
  if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
  const LiveFacts& facts = live.facts;
  EXPECT_EQ(facts.end, LiveEnd::kGloveEnded);
  EXPECT_EQ(facts.arrivals.frames, 30);
  EXPECT_EQ(facts.arrivals.different, 30);
  EXPECT_EQ(facts.arrivals.lost, 5);
  EXPECT_EQ(facts.arrivals.repeated, 1);
  EXPECT_EQ(facts.source.garbage, 2u);
  EXPECT_EQ(facts.input_overruns, 0);
  EXPECT_GE(facts.most_waiting, 1);
  EXPECT_LE(facts.most_waiting, 30);
  EXPECT_GE(facts.most_queued, 0);
  EXPECT_EQ(live.recorded.samples, 29);
  EXPECT_EQ(live.recorded.kept, 29);
  EXPECT_GT(live.recorded.last_time_s, 0.1);
  EXPECT_LE(live.recorded.last_time_s, facts.duration_s);
  EXPECT_THAT(live.columns_remark, HasSubstr("18 values a frame"));
  ASSERT_FALSE(said.empty());
  EXPECT_EQ(said[0], "waiting for frames from the test's glove");
  EXPECT_GT(facts.commands, 0);
  EXPECT_GT(facts.total.count(), 0);
  EXPECT_GT(facts.duration_s, 0.1);
  EXPECT_EQ(facts.ticks + facts.skipped_ticks, std::lround(1000.0 * facts.duration_s));
  const std::string counts = test::ReadFile(folder.path() / "counts.csv");
  for (int sent = 0; sent < 30; ++sent) {
    EXPECT_EQ(counts.find("," + std::to_string(400 + sent) + ",") != std::string::npos, sent != 10)
        << sent;
  }
  // Stages from the arrival of a sample to its command, one behind the other.
  double stages_us = 0.0;
  for (const DurationHistogram& stage : facts.stages) {
    EXPECT_EQ(stage.count(), facts.total.count());
    stages_us += stage.mean_us();
  }
  EXPECT_NEAR(stages_us, facts.total.mean_us(), 1e-3 * facts.total.mean_us());
}

TEST(LiveSession, BeginsWithTheNewestFrameOfADevice) {
  ScriptedGlove glove(DeviceKind::kUdp, 60, 80, kChannels);
  LiveSetup setup = WithGlove(glove);
  setup.shadows = {{"raw", {}}};
  const LiveResult live = RunLive(setup);
  if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
  EXPECT_EQ(live.facts.arrivals.frames, 80);
  const controller::GloveCalibration& calibration = setup.trial.calibration;
  ASSERT_GT(live.trace.linearised_angle_rad.rows(), 0);
  const auto least_rad = [&](int number) {
    return calibration.low_angle_rad[0] +
           (ScriptedGlove::CountsOf(number) - calibration.low_counts[0]) /
               (calibration.high_counts[0] - calibration.low_counts[0]) *
               (calibration.high_angle_rad[0] - calibration.low_angle_rad[0]);
  };
  const auto& shown_rad = live.trace.linearised_angle_rad;
  const double last_rad = shown_rad(shown_rad.rows() - 1, 0);
  EXPECT_LT(std::abs(last_rad - least_rad(79)), std::abs(least_rad(79) - least_rad(76)));
  Eigen::Index first = 0;
  while (std::isnan(shown_rad(first, 0)) && first + 1 < shown_rad.rows()) ++first;
  EXPECT_LT(std::abs(shown_rad(first, 0) - least_rad(79)), std::abs(least_rad(58) - least_rad(79)));
}

TEST(LiveSession, EndsInWordsWithoutAFrame) {
  {
    ScriptedGlove glove(DeviceKind::kFile, 0, 0, kChannels);
    EXPECT_THROW(RunLive(WithGlove(glove)), UserError);
  }
  ScriptedGlove glove(DeviceKind::kUdp, 0, 0, kChannels);
  glove.ends = false;
  LiveSetup setup = WithGlove(glove);
  setup.seconds = 0.1;
  try {
    RunLive(setup);
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no frame from the test's glove within 0.1 s; "));
  }
  ScriptedGlove other(DeviceKind::kUdp, 0, 10, 3);
  try {
    RunLive(WithGlove(other));
    FAIL();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--glove test: a frame has 3 values"));
  }
}

TEST(LiveSession, BringsRealMotorsFromRestAndBackToRest) {
  ScriptedGlove glove(DeviceKind::kUdp, 0, 40, kChannels);
  glove.ends = false;
  KeepingMotors motors;
  LiveSetup setup = WithGlove(glove);
  setup.sink = &motors;
  setup.seconds = 0.4;
  const LiveResult live = RunLive(setup);
  if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
  const LiveFacts& facts = live.facts;
  EXPECT_EQ(facts.end, LiveEnd::kSeconds);
  EXPECT_GE(facts.duration_s, 0.4);
  EXPECT_LE(facts.ticks, 401);
  EXPECT_EQ(facts.rests, 1);
  EXPECT_EQ(facts.sink.frames, motors.numbers.size());
  EXPECT_EQ(facts.commands,
            static_cast<std::int64_t>(motors.numbers.size()) + facts.replaced_commands);
  EXPECT_EQ(motors.numbers.back(), facts.commands - 1);
  const controller::TendonTransmission& hand = setup.trial.hand->transmission();
  const std::vector<double> rest(hand.center_counts.begin(), hand.center_counts.end());
  const auto& sent = motors.sent();
  ASSERT_GT(sent.size(), 10u);
  for (std::size_t last = sent.size() - 2; last < sent.size(); ++last) EXPECT_EQ(sent[last], rest);
  double largest = 0.0;
  double farthest = 0.0;
  std::vector<double> before = rest;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const auto frames =
        static_cast<double>(motors.numbers[i] - (i == 0 ? -1 : motors.numbers[i - 1]));
    for (std::size_t motor = 0; motor < rest.size(); ++motor) {
      const double most = std::abs(hand.counts_per_rad[motor]) * 300.0 * kRadPerDeg * 0.02 + 1.0;
      const double step = std::abs(sent[i][motor] - before[motor]);
      EXPECT_LE(step, most * frames) << i << " " << motor;
      largest = std::max(largest, step);
      farthest = std::max(farthest, std::abs(sent[i][motor] - rest[motor]));
    }
    before = sent[i];
  }
  EXPECT_GT(farthest, 50.0) << "the motors followed";
  if (facts.replaced_commands == 0) {
    EXPECT_EQ(facts.largest_step_counts, largest);
  }
}

TEST(LiveSession, EndsWithAPipeThatIsClosedAndOutlivesOtherMotors) {
  for (const bool comes_back : {false, true}) {
    ScriptedGlove glove(DeviceKind::kUdp, 0, 200, kChannels);
    KeepingMotors motors;
    motors.result = FrameSink::Result::kGone;
    LiveSetup setup = WithGlove(glove);
    setup.sink = &motors;
    setup.sink_comes_back = comes_back;
    setup.seconds = 0.3;
    LiveView view = ViewOf(setup);
    setup.view = &view;
    const LiveResult live = RunLive(setup);
    if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
    EXPECT_EQ(live.facts.end, comes_back ? LiveEnd::kSeconds : LiveEnd::kSinkGone);
    EXPECT_EQ(live.facts.duration_s < 0.3, !comes_back);
    const Watched watched = See(view);
    EXPECT_EQ(watched.moments.back().is_ending, comes_back);
    if (comes_back) {
      EXPECT_FALSE(watched.moments.back().has_sink);
    }
  }
}

TEST(LiveSession, HoldsAndRelaxesWhileAGloveIsSilent) {
  ScriptedGlove glove(DeviceKind::kUdp, 0, 20, kChannels);
  glove.ends = false;
  LiveSetup setup = WithGlove(glove);
  setup.seconds = 0.6;
  LiveView view = ViewOf(setup);
  setup.view = &view;
  const LiveResult live = RunLive(setup);
  if (live.facts.skipped_ticks > 0) GTEST_SKIP() << kBusy;
  const auto& tiers = live.facts.tiers;
  EXPECT_GE(tiers[1].entered, 1);
  EXPECT_EQ(tiers[2].entered, 1);
  EXPECT_EQ(tiers[3].entered, 0);
  EXPECT_GT(tiers[1].longest_s, 0.1);
  EXPECT_LE(tiers[1].longest_s, 0.1501);
  EXPECT_GT(tiers[2].longest_s, 0.1);
  EXPECT_LT(tiers[2].longest_s, 0.4);
  EXPECT_GT(live.facts.repeated_samples, 10);
  const Watched watched = See(view);
  EXPECT_EQ(watched.moments.back().tier, Watchdog::Tier::kRelax);
  EXPECT_GT(watched.moments.back().silent_s, 0.2);
  EXPECT_LT(watched.moments.back().silent_s, 0.6);
}

}  // namespace
}  // namespace gauntlet::sim
