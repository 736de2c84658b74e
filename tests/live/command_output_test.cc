#include "sim/live/command_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <mutex>
#include <semaphore>
#include <string>
#include <vector>

namespace gauntlet::sim {
namespace {

/// Motors that take a frame when the test lets them.
class SlowMotors final : public FrameSink {
 public:
  Result Send(const OutgoingFrame& frame) override {
    sending_.release();
    may_send_.acquire();
    const std::lock_guard lock(mutex_);
    sent_.push_back(frame.values[0]);
    return result_;
  }
  SinkCounts counts() const override { return {.frames = sent_.size()}; }
  std::string problem() const override { return ""; }
  std::string Description() const override { return "motors"; }

  void WaitForSend() { sending_.acquire(); }
  void Let(int frames) { may_send_.release(frames); }
  void Answer(Result result) {
    const std::lock_guard lock(mutex_);
    result_ = result;
  }
  std::vector<double> sent() const {
    const std::lock_guard lock(mutex_);
    return sent_;
  }

 private:
  mutable std::mutex mutex_;
  std::counting_semaphore<> sending_{0};
  std::counting_semaphore<> may_send_{0};
  std::vector<double> sent_;
  Result result_ = Result::kSent;
};

void Send(double counts, CommandOutput& output) {
  output.Send({.sample = {.number = 1}, .number = static_cast<std::int64_t>(counts)},
              std::array{counts});
}

TEST(CommandOutput, SendsTheNewestOfThoseThatWaitAndTheLast) {
  SlowMotors motors;
  CommandOutput output(&motors, 1, nullptr);
  output.Begin();
  Send(1.0, output);
  motors.WaitForSend();
  for (const double counts : {2.0, 3.0, 4.0}) Send(counts, output);
  motors.Let(100);
  output.End();
  EXPECT_THAT(motors.sent(), testing::ElementsAre(1.0, 4.0));
  LiveFacts facts;
  output.AddFacts(facts);
  EXPECT_EQ(facts.replaced_commands, 2);
  EXPECT_EQ(facts.sink.frames, 2U);
  EXPECT_EQ(facts.total.count(), 2);
}

TEST(CommandOutput, HasMotorsBackAfterFiveGoodFrames) {
  SlowMotors motors;
  CommandOutput output(&motors, 1, nullptr);
  output.Begin();
  std::vector<bool> was_gone;  // before each frame
  using enum FrameSink::Result;
  for (const auto result :
       {kSent, kGone, kSent, kGone, kSent, kSent, kDropped, kSent, kSent, kSent}) {
    Send(1.0, output);
    motors.WaitForSend();  // so the frame before is done
    was_gone.push_back(output.is_gone());
    motors.Answer(result);
    motors.Let(1);
  }
  output.End();
  EXPECT_THAT(was_gone,
              testing::ElementsAre(false, false, true, true, true, true, true, true, true, false));
}

TEST(CommandOutput, WithoutMotorsSendsWhenACommandIsDue) {
  CommandOutput output(nullptr, 1, nullptr);
  output.Begin();
  output.Send({.sample = {.number = 1, .arrival_ns = 1000}, .due_ns = 4000}, std::array{1.0});
  output.End();
  LiveFacts facts;
  output.AddFacts(facts);
  EXPECT_EQ(facts.total.max_us(), 3.0);
  EXPECT_FALSE(output.is_gone());
}

TEST(CommandOutput, CountsTimeWithoutANewerSampleApartFromTheWaitForAFrame) {
  CommandOutput output(nullptr, 1, nullptr);
  output.Begin();
  for (const std::int64_t due_ns : {15'000, 35'000, 55'000}) {  // frames of 20 us
    output.Send({.sample = {.number = 1}, .due_ns = due_ns, .period_ns = 20'000}, std::array{1.0});
  }
  output.End();
  LiveFacts facts;
  output.AddFacts(facts);
  const auto mean_us = [&](Stage stage) {
    return facts.stages[static_cast<std::size_t>(stage)].mean_us();
  };
  EXPECT_EQ(facts.stages[static_cast<std::size_t>(Stage::kEvent)].max_us(), 20.0);
  EXPECT_DOUBLE_EQ(mean_us(Stage::kHeld), (0.0 + 15.0 + 35.0) / 3.0);
  EXPECT_DOUBLE_EQ(mean_us(Stage::kHeld) + mean_us(Stage::kEvent), facts.total.mean_us());
}

}  // namespace
}  // namespace gauntlet::sim
