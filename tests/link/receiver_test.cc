// What a receiver makes of arrivals that come from outside: it has no clock of its own.
#include "sim/trial/link/receiver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "sim/trial/link/transport.h"

namespace gauntlet::sim {
namespace {

constexpr controller::Timing kTicks;  // of 1 ms
using Found = Receiver::Found;

/// A frame that was sent at a tick; its value is that tick.
class Frame {
 public:
  Frame(std::int64_t number, std::int64_t sent_tick)
      : value_(static_cast<double>(sent_tick)),
        frame_{.number = number, .origin_tick = sent_tick, .stamp_ticks = value_} {}
  LinkFrame operator*() const {
    LinkFrame frame = frame_;
    frame.values = {&value_, 1};
    return frame;
  }

 private:
  double value_;
  LinkFrame frame_;
};

/// Ages of the used frame at every tick, for a link and a receiver.
struct Used {
  std::vector<double> ages;
  std::vector<double> values;
  double late_share = 0.0;
  double buffer_ticks = 0.0;
};

template <class Link>
Used UsedBehind(Link& link, const ReceiverConfig& config, int ticks, int period = 1) {
  Receiver receiver(config, 1, period, kTicks);
  Used used;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const auto value = static_cast<double>(tick);
    if (tick % period == 0) link.Send(tick, tick, {&value, 1});
    link.Deliver(tick, [&](const LinkFrame& frame) { receiver.Accept(tick, frame); });
    if (receiver.Step(tick) == Found::kNothing) continue;
    used.ages.push_back(static_cast<double>(tick - receiver.origin_tick()));
    used.values.push_back(receiver.values()[0]);
  }
  used.late_share =
      static_cast<double>(receiver.late_frames()) / static_cast<double>(receiver.arrived_frames());
  used.buffer_ticks = receiver.buffer_ticks();
  return used;
}

Used UsedOver(const TransportConfig& config, const ReceiverConfig& receiver, int ticks,
              int period = 1) {
  const auto* queue = std::get_if<QueueReceiver>(&receiver.settings);
  Transport transport(
      config,
      {.name = "test",
       .values = 1,
       .period_ticks = static_cast<double>(period),
       .waiting_frames = queue ? static_cast<std::size_t>(queue->longest_frames) : 1},
      kTicks, 5);
  return UsedBehind(transport, receiver, ticks, period);
}

/// A link as real ones can be: frames overtake one another, and the sender's clock drifts.
class DisorderedLink {
 public:
  explicit DisorderedLink(const DelaySettings& delay, double drift = 0.0)
      : delay_({delay}, RandomStream(5, "test")), drift_(drift) {}

  void Send(std::int64_t tick, std::int64_t origin_tick, std::span<const double> values) {
    const auto now = static_cast<double>(tick);
    const std::int64_t arrival_tick = std::llround(std::ceil(now + delay_.Next()));
    const LinkFrame frame = {.number = sent_++,
                             .origin_tick = origin_tick,
                             .stamp_ticks = now * (1.0 + drift_),
                             .values = {}};
    arrivals_.emplace(arrival_tick, std::pair(frame, values[0]));
  }
  template <class Receive>
  void Deliver(std::int64_t tick, const Receive& receive) {
    for (; !arrivals_.empty() && arrivals_.begin()->first <= tick;
         arrivals_.erase(arrivals_.begin())) {
      auto& [frame, value] = arrivals_.begin()->second;
      frame.values = {&value, 1};
      receive(frame);
    }
  }

 private:
  DelayDraw delay_;
  double drift_;
  std::int64_t sent_ = 0;
  std::multimap<std::int64_t, std::pair<LinkFrame, double>> arrivals_;
};

TEST(Receiver, NewestIgnoresOldAndRepeatedFrames) {
  Receiver receiver({}, 1, 1.0, kTicks);
  EXPECT_EQ(receiver.Step(0), Found::kNothing);
  receiver.Accept(5, *Frame(2, 2));
  receiver.Accept(5, *Frame(1, 1));
  EXPECT_EQ(receiver.Step(5), Found::kNew);
  EXPECT_EQ(receiver.values()[0], 2.0);
  receiver.Accept(6, *Frame(1, 1));
  receiver.Accept(6, *Frame(2, 2));
  EXPECT_EQ(receiver.Step(6), Found::kHeld);
  EXPECT_EQ(receiver.values()[0], 2.0);
  receiver.Accept(7, *Frame(3, 3));
  EXPECT_EQ(receiver.Step(7), Found::kNew);
  EXPECT_EQ(receiver.origin_tick(), 3);
}

TEST(Receiver, QueueReplaysAGapAndStaysLate) {
  Receiver receiver({.settings = QueueReceiver{}}, 1, 1.0, kTicks);
  std::vector<double> values;
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    // Nothing arrives from 20 to 39; then all of it at once.
    if (tick < 20 || tick > 40) receiver.Accept(tick, *Frame(tick, tick));
    for (std::int64_t late = 20; tick == 40 && late <= 40; ++late) {
      receiver.Accept(tick, *Frame(late, late));
    }
    receiver.Step(tick);
    values.push_back(receiver.values()[0]);
  }
  EXPECT_EQ(values[19], 19.0);
  EXPECT_EQ(values[40], 20.0);
  EXPECT_EQ(values[41], 21.0);
  EXPECT_EQ(values[99], 79.0);
}

// At a period of one tick it could use only one a tick anyway.
TEST(Receiver, QueueGivesOneFrameAPeriodBehindAGap) {
  constexpr std::int64_t kPeriod = 10;
  Receiver receiver({.settings = QueueReceiver{}}, 1, kPeriod, kTicks);
  std::vector<double> values;
  for (std::int64_t tick = 0; tick < 800; ++tick) {
    // Frames of 200 to 400 arrive together at 400.
    const std::int64_t first = tick == 400 ? 200 : tick;
    for (std::int64_t sent = first; sent <= tick && tick % kPeriod == 0; sent += kPeriod) {
      if (tick < 200 || tick >= 400) receiver.Accept(tick, *Frame(sent / kPeriod, sent));
    }
    receiver.Step(tick);
    values.push_back(receiver.values()[0]);
  }
  for (std::int64_t tick = 400; tick < 800; ++tick) {
    ASSERT_EQ(values[static_cast<std::size_t>(tick)],
              static_cast<double>(200 + (tick - 400) / kPeriod * kPeriod))
        << tick;
  }
}

TEST(Receiver, QueueGrowsWithASenderFasterThanTheLinkAndNewestDoesNot) {
  TransportConfig slow;
  slow.frame_ms = 8.0;
  const Used queue =
      UsedOver(slow, {.settings = QueueReceiver{.longest_frames = 100'000}}, 5000, 5);
  EXPECT_NEAR(queue.ages.back() - queue.ages[queue.ages.size() / 2], 0.5 * 5000.0 * 3.0 / 8.0,
              20.0);
  const Used newest = UsedOver(slow, {}, 5000, 5);
  for (const double age : newest.ages) EXPECT_LE(age, 16.0);
}

TEST(Receiver, BufferOfNoLengthOnALinkWithoutFaultsChangesNothing) {
  const Used plain = UsedOver({}, {}, 500);
  const Used buffer = UsedOver({}, {.settings = BufferReceiver{.delay_ms = 0.0}}, 500);
  EXPECT_EQ(plain.values, buffer.values);
  for (std::size_t i = 0; i < plain.values.size(); ++i) {
    EXPECT_EQ(plain.values[i], static_cast<double>(i));
  }
}

TEST(Receiver, BufferLongerThanAllJitterMakesTheAgeConstant) {
  DisorderedLink link(HistogramDelay{.bucket_ms = 1.0, .counts = std::vector<double>(30, 1.0)});
  const Used used = UsedBehind(link, {.settings = BufferReceiver{.delay_ms = 40.0}}, 3000);
  for (std::size_t i = 1000; i < used.ages.size(); ++i) ASSERT_EQ(used.ages[i], 41.0) << i;
}

TEST(Receiver, BufferFollowsAClockThatDrifts) {
  DisorderedLink link(ConstantDelay{}, 1e-3);  // 1 ms in 1 s
  const Used used =
      UsedBehind(link, {.settings = BufferReceiver{.delay_ms = 10.0, .window_ms = 1000.0}}, 20'000);
  EXPECT_NEAR(used.ages[5000], 10.0, 1.1);
  EXPECT_NEAR(used.ages.back(), 10.0, 1.1);
}

// The smallest transit of long ago is no measure of the transits of now.
TEST(Receiver, BufferForgetsTheTransitsBeforeItsWindow) {
  DisorderedLink link(ConstantDelay{}, -1e-3);  // transits grow by 1 ms in 1 s
  const Used used =
      UsedBehind(link, {.settings = BufferReceiver{.delay_ms = 10.0, .window_ms = 1000.0}}, 20'000);
  EXPECT_NEAR(used.ages[5000], 10.0, 1.1);
  EXPECT_NEAR(used.ages.back(), 10.0, 1.1);
}

// More arrive at once than wait at other times: the oldest go.
TEST(Receiver, BufferKeepsTheNewestOfABurst) {
  Receiver receiver({.settings = BufferReceiver{.delay_ms = 5.0}}, 1, 1.0, kTicks);
  for (std::int64_t tick = 0; tick < 20; ++tick) {
    receiver.Accept(tick, *Frame(tick, tick));
    receiver.Step(tick);
  }
  for (std::int64_t sent = 20; sent <= 40; ++sent) receiver.Accept(40, *Frame(sent, sent));
  for (std::int64_t tick = 40; tick <= 45; ++tick) {
    EXPECT_EQ(receiver.Step(tick), Found::kNew);
    EXPECT_EQ(receiver.values()[0], static_cast<double>(tick - 5));
  }
}

TEST(Receiver, AFullBufferDropsItsOldestFrameAlone) {
  Receiver receiver({.settings = BufferReceiver{.delay_ms = 3.0}}, 1, 1.0, kTicks);
  // Five have a place; the least transit is that of the last.
  std::int64_t number = 0;
  for (const double stamp : {0.0, 1.0, 1.2, 1.4, 1.6, 2.0}) {
    receiver.Accept(
        2, {.number = number++, .origin_tick = 0, .stamp_ticks = stamp, .values = {&stamp, 1}});
  }
  EXPECT_EQ(receiver.waiting_frames(), 5U);
  EXPECT_EQ(receiver.Step(3), Found::kNothing);  // that of 0 is gone
  EXPECT_EQ(receiver.Step(4), Found::kNew);
  EXPECT_EQ(receiver.values()[0], 1.0);
  EXPECT_EQ(receiver.Step(5), Found::kNew);
  EXPECT_EQ(receiver.values()[0], 2.0);
}

TEST(Receiver, BufferKeepsARepeatedFrameOnce) {
  Receiver receiver({.settings = BufferReceiver{.delay_ms = 5.0}}, 1, 1.0, kTicks);
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    for (int copy = 0; copy < 5; ++copy) receiver.Accept(tick, *Frame(tick, tick));
    receiver.Step(tick);
    EXPECT_LE(receiver.waiting_frames(), 6U);
    if (tick < 5) continue;
    EXPECT_EQ(receiver.values()[0], static_cast<double>(tick - 5));
  }
}

TEST(Receiver, AdaptiveBufferLeavesTheShareBeyondItsQuantileLate) {
  for (const double percent : {80.0, 95.0, 99.0}) {
    DisorderedLink link(LogNormalDelay{.p50_ms = 13.3, .p99_ms = 47.0});
    const Used used = UsedBehind(
        link, {.settings = AdaptiveBufferReceiver{.quantile_percent = percent}}, 100'000);
    const double late = 1.0 - percent / 100.0;
    EXPECT_NEAR(used.late_share, late, 0.2 * late + 0.002) << percent;
  }
}

TEST(Receiver, AdaptiveBufferIsAsLongAsTheQuantileOfTheRelativeDelays) {
  DisorderedLink link(HistogramDelay{.bucket_ms = 1.0, .counts = std::vector<double>(100, 1.0)});
  const Used used =
      UsedBehind(link, {.settings = AdaptiveBufferReceiver{.quantile_percent = 90.0}}, 60'000);
  EXPECT_NEAR(used.buffer_ticks, 89.0, 3.0);
}

TEST(Receiver, AdaptiveBufferIsNoLongerThanTheDelayItWaitsFor) {
  Receiver receiver({.settings = AdaptiveBufferReceiver{.quantile_percent = 95.0}}, 1, 10.0,
                    kTicks);
  for (std::int64_t number = 0; number < 200; ++number) {
    const std::int64_t sent = 10 * number;
    const std::int64_t arrival = sent + (number % 2 == 0 ? 0 : 3);
    receiver.Accept(arrival, *Frame(number, sent));
    receiver.Step(arrival);
  }
  EXPECT_EQ(receiver.buffer_ticks(), 3.0);
}

// The line through 100, 0, 0, 0, 0 falls by 20 in each step.
TEST(Receiver, SlopeIsThatOfAllFramesOfItsTime) {
  ReceiverConfig config;
  config.gap.settings = PredictGap{.slope_ms = 4.0, .longest_ms = 1.0};
  Receiver receiver(config, 1, 1.0, kTicks);
  for (std::int64_t tick = 0; tick < 5; ++tick) {
    const double value = tick == 0 ? 100.0 : 0.0;
    receiver.Accept(tick, {.number = tick,
                           .origin_tick = tick,
                           .stamp_ticks = static_cast<double>(tick),
                           .values = {&value, 1}});
    receiver.Step(tick);
  }
  EXPECT_EQ(receiver.Step(5), Found::kPredicted);
  EXPECT_NEAR(receiver.values()[0], -20.0, 1e-9);
}

TEST(Receiver, PredictionOfALineIsExactUntilItsLongestTime) {
  ReceiverConfig config;
  config.gap.settings = PredictGap{.slope_ms = 10.0, .longest_ms = 30.0};
  Receiver receiver(config, 1, 1.0, kTicks);
  for (std::int64_t tick = 0; tick < 50; ++tick) {
    receiver.Accept(tick, *Frame(tick, tick));
    ASSERT_EQ(receiver.Step(tick), Found::kNew);
    ASSERT_EQ(receiver.values()[0], static_cast<double>(tick));
  }
  for (std::int64_t tick = 50; tick < 120; ++tick) {
    ASSERT_EQ(receiver.Step(tick), Found::kPredicted);
    EXPECT_NEAR(receiver.values()[0], std::min<double>(static_cast<double>(tick), 79.0), 1e-9);
  }
}

TEST(Receiver, BetweenTwoFramesOfASlowSenderNothingIsPredicted) {
  ReceiverConfig config;
  config.gap.settings = PredictGap{};
  Receiver receiver(config, 1, 20.0, kTicks);
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    if (tick % 20 == 0) receiver.Accept(tick, *Frame(tick / 20, tick));
    EXPECT_EQ(receiver.Step(tick), tick % 20 == 0 ? Found::kNew : Found::kHeld);
  }
  EXPECT_EQ(receiver.Step(100), Found::kPredicted);
  EXPECT_NEAR(receiver.values()[0], 100.0, 1e-9);
}

TEST(Receiver, PredictionFollowsASineCloserThanHoldAcrossBursts) {
  TransportConfig link;
  link.loss.settings = GilbertElliottLoss{.begin_percent = 2.0, .mean_frames = 30.0};
  ReceiverConfig predict;
  predict.gap.settings = PredictGap{};
  const auto error = [&](const ReceiverConfig& config) {
    Transport transport(link, {.name = "test", .values = 1}, kTicks, 2);
    Receiver receiver(config, 1, 1.0, kTicks);
    double squares = 0.0;
    for (std::int64_t tick = 0; tick < 20'000; ++tick) {
      const double truth = std::sin(2.0 * std::numbers::pi * 1e-3 * static_cast<double>(tick));
      transport.Send(tick, tick, {&truth, 1});
      transport.Deliver(tick, [&](const LinkFrame& frame) { receiver.Accept(tick, frame); });
      receiver.Step(tick);
      squares += (receiver.values()[0] - truth) * (receiver.values()[0] - truth);
    }
    return std::sqrt(squares / 20'000.0);
  };
  EXPECT_LT(error(predict), 0.5 * error({}));
}

}  // namespace
}  // namespace gauntlet::sim
