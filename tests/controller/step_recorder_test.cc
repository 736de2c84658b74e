#include "controller/step_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "tests/controller/allocation_counter.h"
#include "tests/controller/test_hand.h"

namespace gauntlet::controller {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::NanSensitiveDoubleEq;
using testing::Pointwise;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

RobotConfig RecordedRobot(int channels, const Timing& timing = {.event_period_ms = 3.0}) {
  RobotConfig robot = {.controller = {},
                       .glove = PlainGlove(channels),
                       .hand = CoupledHand(channels),
                       .joint_map = {},
                       .timing = timing};
  robot.controller.untrusted.stuck_after_ms = 6.0;
  return robot;
}

/// A robot of two channels with its recorder. Its columns: 0 tick, 1 sample, 2 frame_number,
/// 3 event, 4 glove, 5 counts, 7 untrusted, 9 target_angle_rad, 11 command_counts.
struct Recorded {
  static constexpr std::size_t kColumns = 13;
  static constexpr std::size_t kUntrusted = 7;

  explicit Recorded(int steps, const Timing& timing = {.event_period_ms = 3.0})
      : controller(RecordedRobot(2, timing)), recorder(RecordedRobot(2, timing), steps) {
    controller.Reset(HalfClosed(2));
  }
  bool Step(const GloveSample& sample) {
    return recorder.Add(sample, controller, controller.Step(sample));
  }
  bool Step(double first, double second, std::optional<std::int64_t> number = {}) {
    const std::array counts = {first, second};
    return Step({.counts = counts, .number = number});
  }
  bool Step() { return recorder.Add(controller, controller.Step()); }

  /// The newest rows.
  std::vector<std::vector<double>> Rows(std::size_t most = 1000) const {
    std::vector<double> values(most * kColumns);
    const std::size_t count = recorder.CopyTo(values);
    std::vector<std::vector<double>> rows;
    for (std::size_t row = 0; row < count; ++row) {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * kColumns);
      rows.emplace_back(begin, begin + kColumns);
    }
    return rows;
  }
  /// The reasons of both channels in the last step.
  std::vector<double> LastReasons() const {
    const std::vector<double> row = Rows(1).at(0);
    return {row[kUntrusted], row[kUntrusted + 1]};
  }

  Controller controller;
  StepRecorder recorder;
};

/// What LastReasons() has for these; none: trusted, or no sample was due.
std::vector<double> Reasons(std::optional<Untrusted> first, std::optional<Untrusted> second) {
  const auto number = [](std::optional<Untrusted> kind) {
    return kind ? 1.0 + static_cast<int>(*kind) : 0.0;
  };
  return {number(first), number(second)};
}

TEST(StepRecorder, NamesTheColumnsBySignalAndName) {
  EXPECT_THAT(Recorded(1).recorder.column_names(),
              ElementsAre("tick", "sample", "frame_number", "event", "glove", "counts.joint_0",
                          "counts.joint_1", "untrusted.joint_0", "untrusted.joint_1",
                          "target_angle_rad.joint_0", "target_angle_rad.joint_1",
                          "command_counts.motor_0", "command_counts.motor_1"));
}

TEST(StepRecorder, KeepsTheNewestStepsOldestFirst) {
  constexpr int kSteps = 7;
  for (const int added : {0, 1, 6, 7, 8, 13, 14, 15, 40}) {
    Recorded recorded(kSteps, {.ticks_per_sample = 2, .event_period_ms = 3.0});
    std::vector<std::vector<double>> expected;
    for (int tick = 0; tick < added; ++tick) {
      const std::array counts = {500.0 + tick, tick % 4 == 1 ? kNaN : 510.0 - tick};
      const bool has_sample = tick % 5 != 3;
      const GloveSample sample = {.counts = counts, .number = 100 + tick};
      const Command command = has_sample ? recorded.controller.Step(sample)  //
                                         : recorded.controller.Step();
      ASSERT_TRUE(has_sample ? recorded.recorder.Add(sample, recorded.controller, command)
                             : recorded.recorder.Add(recorded.controller, command));
      const bool missing = has_sample && tick % 4 == 1;
      const auto target_rad = recorded.controller.target_angle_rad();
      expected.push_back({static_cast<double>(tick), has_sample ? 1.0 : 0.0,
                          has_sample ? 100.0 + tick : kNaN, tick % 3 == 0 ? 1.0 : 0.0,
                          static_cast<double>(command.glove), has_sample ? counts[0] : kNaN,
                          has_sample ? counts[1] : kNaN, 0.0, missing ? 1.0 : 0.0, target_rad[0],
                          target_rad[1], static_cast<double>(command.motor_counts[0]),
                          static_cast<double>(command.motor_counts[1])});
      if (std::ssize(expected) > kSteps) expected.erase(expected.begin());
    }
    EXPECT_EQ(recorded.recorder.size(), expected.size());
    const auto rows = recorded.Rows();
    ASSERT_EQ(rows.size(), expected.size()) << added;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      EXPECT_THAT(rows[row], Pointwise(NanSensitiveDoubleEq(), expected[row]))
          << "row " << row << " of " << added;
    }
  }
}

TEST(StepRecorder, CopiesOnlyWholeRowsAndTheNewestOfThem) {
  Recorded recorded(5);
  for (int k = 0; k < 8; ++k) recorded.Step(500.0 + k, 500.0 - k);
  constexpr std::size_t kColumns = Recorded::kColumns;
  for (std::size_t room = 0; room < 7 * kColumns; ++room) {
    std::vector<double> values(room, -7.0);
    const std::size_t count = recorded.recorder.CopyTo(values);
    ASSERT_EQ(count, std::min<std::size_t>(room / kColumns, 5)) << room;
    for (std::size_t row = 0; row < count; ++row) {
      ASSERT_EQ(values[row * kColumns], static_cast<double>(8 - count + row)) << room;
    }
    const std::vector<double> rest(values.begin() + static_cast<std::ptrdiff_t>(count * kColumns),
                                   values.end());
    ASSERT_THAT(rest, Each(-7.0)) << room;
  }
}

TEST(StepRecorder, HasTheReasonOfEachUntrustedValue) {
  Recorded recorded(1);
  recorded.Step(500.0, 500.0);
  EXPECT_EQ(recorded.LastReasons(), Reasons({}, {}));
  const std::pair<double, Untrusted> cases[] = {
      {kNaN, Untrusted::kMissing},      {-kInfinity, Untrusted::kInfinite},
      {1023.5, Untrusted::kOutOfRange}, {-1.0, Untrusted::kOutOfRange},
      {1023.0, Untrusted::kFullScale},  {0.0, Untrusted::kFullScale},
      {900.0, Untrusted::kJumped}};
  double good = 501.0;
  for (const auto& [counts, reason] : cases) {
    recorded.Step(good, counts);
    EXPECT_EQ(recorded.LastReasons(), Reasons({}, reason)) << counts;
    recorded.Step(counts, ++good);
    EXPECT_EQ(recorded.LastReasons(), Reasons(reason, {})) << counts;
    recorded.Step(good, good);
    EXPECT_EQ(recorded.LastReasons(), Reasons({}, {})) << counts;
  }
  const std::array counts = {++good};
  recorded.Step({.counts = counts});
  EXPECT_EQ(recorded.LastReasons(), Reasons({}, Untrusted::kMissing));
  for (int repeated = 0; repeated < 6; ++repeated) recorded.Step(++good, 512.0);
  EXPECT_EQ(recorded.LastReasons(), Reasons({}, {}));  // stuck for 5 ms
  recorded.Step(++good, 512.0);
  EXPECT_EQ(recorded.LastReasons(), Reasons({}, Untrusted::kStuck));
  recorded.Step(++good, 513.0, 7);
  EXPECT_EQ(recorded.LastReasons(), Reasons({}, {}));
  recorded.Step(++good, kNaN, 7);
  EXPECT_EQ(recorded.LastReasons(), Reasons(Untrusted::kStale, Untrusted::kMissing));
}

TEST(StepRecorder, HasNoReasonInTicksWithoutASampleUnlessItIsOverdue) {
  Recorded recorded(100, {.ticks_per_sample = 4, .event_period_ms = 3.0});
  recorded.Step(500.0, kNaN);
  EXPECT_EQ(recorded.LastReasons(), Reasons({}, Untrusted::kMissing));
  for (int tick = 1; tick < 14; ++tick) {  // due at tick 4, overdue at ticks 6 and 10
    recorded.Step();
    const auto missing =
        tick == 6 || tick == 10 ? std::optional(Untrusted::kMissing) : std::nullopt;
    EXPECT_EQ(recorded.LastReasons(), Reasons(missing, missing)) << tick;
    EXPECT_EQ(recorded.controller.untrusted(1), missing) << tick;
  }
  recorded.Step(501.0, 502.0);
  recorded.Step();
  EXPECT_EQ(recorded.LastReasons(), Reasons({}, {}));
}

TEST(StepRecorder, AgreesWithTheCountersOfTheController) {
  Recorded recorded(4000);
  std::uint32_t random = 1;
  const auto next = [&](std::uint32_t below) {
    random = random * 1664525u + 1013904223u;
    return (random >> 16) % below;
  };
  const double odd[] = {kNaN, kInfinity, -5.0, 0.0, 1023.0, 950.0, 500.0, 500.0};
  std::int64_t number = 0;
  double good = 500.0;
  for (int tick = 0; tick < 4000; ++tick) {
    if (next(8) == 0) {
      recorded.Step();
      continue;
    }
    good = good > 600.0 ? 400.0 : good + 0.5;
    number += next(10) == 0 ? -1 : 1;
    const bool wrong = next(3) == 0;
    recorded.Step(wrong ? odd[next(8)] : good, next(50) > 8 ? 512.0 : good, number);
  }
  std::array<std::array<std::int64_t, kUntrustedKinds + 1>, 2> counted = {};
  for (const auto& row : recorded.Rows(4000)) {
    for (std::size_t c = 0; c < 2; ++c) {
      ++counted[c].at(static_cast<std::size_t>(row[Recorded::kUntrusted + c]));
    }
  }
  for (int kind = 0; kind < kUntrustedKinds; ++kind) {
    const auto counters = recorded.controller.untrusted_samples(static_cast<Untrusted>(kind));
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_EQ(counted[c][static_cast<std::size_t>(kind) + 1], counters[c]) << kind;
    }
    EXPECT_GT(counters[0] + counters[1], 10) << kind;  // the signal has all kinds
  }
}

TEST(StepRecorder, HasTheReasonAfterAResetAndASwap) {
  Recorded recorded(10);
  recorded.Step(500.0, kNaN);
  recorded.controller.Reset();
  EXPECT_EQ(recorded.controller.untrusted(1), std::nullopt);
  recorded.Step(500.0, kNaN);  // the counter is 1 again
  EXPECT_EQ(recorded.LastReasons(), Reasons({}, Untrusted::kMissing));

  Controller other = recorded.controller.Prepare(RecordedRobot(2).controller);
  const std::array counts = {501.0, 2000.0};
  const Command command = recorded.controller.Step({.counts = counts});
  ASSERT_TRUE(recorded.controller.Swap(other));
  recorded.recorder.Add({.counts = counts}, recorded.controller, command);
  EXPECT_EQ(recorded.LastReasons(), Reasons({}, Untrusted::kOutOfRange));
}

TEST(StepRecorder, DoesNotAllocateAfterItsConstruction) {
  Recorded recorded(10);
  std::vector<double> rows(20 * Recorded::kColumns);
  const long before = AllocationCount();
  for (int k = 0; k < 100; ++k) {
    recorded.Step(500.0 + k, k % 7 == 0 ? kNaN : 400.0, k);
    recorded.Step();
    recorded.recorder.CopyTo(rows);
  }
  EXPECT_EQ(AllocationCount(), before);
}

TEST(StepRecorder, RefusesStepsOfAControllerOfAnotherShapeAndCountsTheirTicks) {
  Recorded recorded(10);
  EXPECT_TRUE(recorded.Step(500.0, 501.0));
  RobotConfig one_channel = RecordedRobot(2);
  one_channel.glove = PlainGlove(1);
  RobotConfig three_joints = RecordedRobot(3);
  three_joints.glove = PlainGlove(2);
  three_joints.hand.motor_names.pop_back();
  three_joints.hand.motor_of_joint = {"motor_0", "motor_1", "motor_1"};
  three_joints.hand.coupling = {1.0, 0.0, 0.0, 0.4, 1.0, 1.0};
  for (auto* values : {&three_joints.hand.center_counts, &three_joints.hand.min_counts,
                       &three_joints.hand.max_counts}) {
    values->pop_back();
  }
  three_joints.hand.counts_per_rad.pop_back();
  for (const RobotConfig& robot : {one_channel, three_joints, RecordedRobot(3)}) {
    Controller other(robot);
    EXPECT_FALSE(recorded.recorder.Add(other, other.Step()));
  }
  const Controller taken = std::move(recorded.controller);
  EXPECT_FALSE(recorded.Step(500.0, 501.0));
  recorded.controller = Controller(RecordedRobot(2));
  EXPECT_FALSE(recorded.recorder.Add(recorded.controller, Command{}));
  EXPECT_TRUE(recorded.Step(500.0, 501.0));
  const auto rows = recorded.Rows();
  ASSERT_EQ(rows.size(), 2);
  EXPECT_EQ(rows[0][0], 0.0);
  EXPECT_EQ(rows[1][0], 6.0);
}

TEST(StepRecorder, RefusesANumberOfStepsOutOfRange) {
  for (const int steps : {-1, 0, 1'000'001, std::numeric_limits<int>::min()}) {
    try {
      StepRecorder recorder(RecordedRobot(2), steps);
      ADD_FAILURE() << steps;
    } catch (const SettingError& error) {
      EXPECT_EQ(error.what(), "steps: is " + std::to_string(steps) + ", must be from 1 to 1000000");
    }
  }
}

}  // namespace
}  // namespace gauntlet::controller
