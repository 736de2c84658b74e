// Laws of the simulated link: what is set is what frames meet.
#include "sim/trial/link/transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/trial/link/presets.h"

namespace gauntlet::sim {
namespace {

constexpr controller::Timing kTiming;  // ticks of 1 ms

struct Arrival {
  std::int64_t number;
  std::int64_t sent_tick;
  std::int64_t arrival_tick;
};

/// What arrives of `frames` frames, sent every `period` ticks.
std::vector<Arrival> Sent(const TransportConfig& config, int frames, int period = 1,
                          std::uint64_t seed = 1, std::size_t waiting_frames = 1) {
  Transport transport(config,
                      {.name = "test",
                       .values = 1,
                       .period_ticks = static_cast<double>(period),
                       .waiting_frames = waiting_frames},
                      kTiming, seed);
  std::vector<Arrival> arrivals;
  for (std::int64_t tick = 0; tick < std::int64_t{frames} * period + 20'000; ++tick) {
    if (tick % period == 0 && tick < std::int64_t{frames} * period) {
      const double value = static_cast<double>(tick);
      transport.Send(tick, tick, {&value, 1});
    }
    transport.Deliver(tick, [&](const LinkFrame& frame) {
      EXPECT_EQ(frame.values[0], static_cast<double>(frame.origin_tick));
      arrivals.push_back({frame.number, frame.origin_tick, tick});
    });
  }
  return arrivals;
}

std::vector<double> DelaysOf(const std::vector<Arrival>& arrivals) {
  std::vector<double> delays;
  for (const Arrival& arrival : arrivals) {
    delays.push_back(static_cast<double>(arrival.arrival_tick - arrival.sent_tick));
  }
  std::ranges::sort(delays);
  return delays;
}

/// Share of values up to a bound.
double ShareUpTo(const std::vector<double>& sorted, double bound) {
  return static_cast<double>(std::ranges::upper_bound(sorted, bound) - sorted.begin()) /
         static_cast<double>(sorted.size());
}

struct Losses {
  double share = 0.0;
  double mean_burst = 0.0;
  int bursts = 0;
};

Losses LossesOf(const LossConfig& config, int frames) {
  LossDraw draw(config, RandomStream(7, "test"));
  int lost = 0;
  int bursts = 0;
  bool before = false;
  for (int i = 0; i < frames; ++i) {
    const bool now = draw.Next();
    lost += now ? 1 : 0;
    bursts += now && !before ? 1 : 0;
    before = now;
  }
  return {static_cast<double>(lost) / frames, static_cast<double>(lost) / std::max(bursts, 1),
          bursts};
}

TEST(Loss, IndependentLossHasItsShareAndSingleBursts) {
  constexpr int kFrames = 1'000'000;
  const Losses losses = LossesOf({IndependentLoss{.percent = 10.0}}, kFrames);
  EXPECT_NEAR(losses.share, 0.1, 4.0 * std::sqrt(0.1 * 0.9 / kFrames));
  // A run of losses goes on with probability 0.1: its mean length is 1 / 0.9.
  EXPECT_NEAR(losses.mean_burst, 1.0 / 0.9, 0.01);
}

TEST(Loss, GilbertElliottHasTheShareAndTheBurstsOfItsTheory) {
  constexpr int kFrames = 2'000'000;
  for (const auto& [begin, end] : {std::pair{0.004, 0.2}, std::pair{0.0066, 0.125}}) {
    const Losses losses = LossesOf(
        {GilbertElliottLoss{.begin_percent = 100.0 * begin, .mean_frames = 1.0 / end}}, kFrames);
    // Bursts are geometric: their mean length has the deviation sqrt(1 - end) / end / sqrt(bursts).
    const double deviation = std::sqrt(1.0 - end) / end / std::sqrt(losses.bursts);
    EXPECT_NEAR(losses.mean_burst, 1.0 / end, 4.0 * deviation);
    const double share = begin / (begin + end);
    EXPECT_NEAR(losses.share, share, 4.0 * 1.5 * share / std::sqrt(losses.bursts));
  }
}

TEST(Loss, ABurstThatLosesHalfLosesHalfOfIt) {
  const GilbertElliottLoss whole{.begin_percent = 1.0, .mean_frames = 10.0};
  GilbertElliottLoss half = whole;
  half.lost_percent = 50.0;
  const double share = LossesOf({whole}, 1'000'000).share;
  EXPECT_NEAR(LossesOf({half}, 1'000'000).share, 0.5 * share, 0.002);
}

TEST(Delay, QuantilesAreAsTheyAreSet) {
  constexpr int kDraws = 50'000;
  DelayDraw draw({LogNormalDelay{.p50_ms = 13.3, .p99_ms = 47.0}}, RandomStream(3, "test"));
  std::vector<double> delays;
  for (int i = 0; i < kDraws; ++i) delays.push_back(draw.Next());
  std::ranges::sort(delays);
  EXPECT_NEAR(ShareUpTo(delays, 13.3), 0.5, 4.0 * std::sqrt(0.25 / kDraws));
  EXPECT_NEAR(ShareUpTo(delays, 47.0), 0.99, 4.0 * std::sqrt(0.0099 / kDraws));
}

TEST(Delay, GammaHasItsMeanAndDeviation) {
  for (const auto& [mean, deviation] : {std::pair{20.0, 5.0}, std::pair{5.0, 10.0}}) {
    DelayDraw draw({GammaDelay{.mean_ms = mean, .deviation_ms = deviation}},
                   RandomStream(3, "test"));
    constexpr int kDraws = 400'000;
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < kDraws; ++i) {
      const double delay = draw.Next();
      ASSERT_GE(delay, 0.0);
      sum += delay;
      squares += delay * delay;
    }
    const double found = sum / kDraws;
    EXPECT_NEAR(found, mean, 4.0 * deviation / std::sqrt(kDraws));
    EXPECT_NEAR(std::sqrt(squares / kDraws - found * found), deviation, 0.02 * deviation);
  }
}

TEST(Delay, HistogramIsDrawnInItsShares) {
  DelayDraw draw({HistogramDelay{.bucket_ms = 10.0, .counts = {3.0, 0.0, 1.0}}},
                 RandomStream(3, "test"));
  std::vector<double> delays;
  for (int i = 0; i < 100'000; ++i) delays.push_back(draw.Next());
  std::ranges::sort(delays);
  EXPECT_NEAR(ShareUpTo(delays, 5.0), 0.375, 0.01);
  EXPECT_NEAR(ShareUpTo(delays, 10.0), 0.75, 0.01);
  EXPECT_EQ(ShareUpTo(delays, 19.99), ShareUpTo(delays, 10.0));
  EXPECT_EQ(ShareUpTo(delays, 30.0), 1.0);
}

TEST(Transport, FramesOfALinkInOrderNeverOvertake) {
  TransportConfig config;
  config.delay.settings = GammaDelay{.mean_ms = 20.0, .deviation_ms = 20.0};
  const auto overtakes = [](const std::vector<Arrival>& arrivals) {
    return !std::ranges::is_sorted(arrivals, {}, &Arrival::number);
  };
  EXPECT_FALSE(overtakes(Sent(config, 5000)));
}

TEST(Transport, BatchesArriveTogetherAtTheirInterval) {
  TransportConfig config;
  config.batch_ms = 45.0;
  const std::vector<Arrival> arrivals = Sent(config, 1000, 7);
  for (const Arrival& arrival : arrivals) {
    EXPECT_EQ((arrival.arrival_tick - arrivals.front().arrival_tick) % 45, 0);
  }
  const std::vector<double> delays = DelaysOf(arrivals);
  EXPECT_LE(delays.back(), 45.0);
  EXPECT_NEAR(ShareUpTo(delays, 22.0), 0.5, 0.03);  // uniform over the interval
}

TEST(Transport, DelayGrowsInAQueueBeforeASlowLinkAndNotWithTheNewestAlone) {
  TransportConfig config;
  config.frame_ms = 8.0;  // 125 frames a second
  const std::vector<Arrival> queue = Sent(config, 1000, 5, 1, 100'000);
  ASSERT_EQ(queue.size(), 1000u);
  // Each frame adds the 3 ms by which the link is slower.
  EXPECT_EQ(queue.back().arrival_tick - queue.back().sent_tick, 999 * 3);
  const std::vector<Arrival> newest = Sent(config, 1000, 5);
  EXPECT_NEAR(static_cast<double>(newest.size()), 1000.0 * 5.0 / 8.0, 2.0);
  EXPECT_LE(DelaysOf(newest).back(), 8.0);
}

// Of 1000 frames each 5 ms, every 8 ms one is sent on.
TEST(Transport, WhatIsLostBeforeASlowLinkIsCountedAndMakesRoom) {
  TransportConfig config;
  config.frame_ms = 8.0;
  for (const std::size_t waiting_frames : {1, 2, 3}) {
    Transport transport(
        config,
        {.name = "test", .values = 1, .period_ticks = 5.0, .waiting_frames = waiting_frames},
        kTiming, 1);
    std::vector<Arrival> arrivals;
    for (std::int64_t tick = 0; tick < 5000; ++tick) {
      const auto value = static_cast<double>(tick);
      if (tick % 5 == 0) transport.Send(tick, tick, {&value, 1});
      transport.Deliver(tick, [&](const LinkFrame& frame) {
        arrivals.push_back({frame.number, frame.origin_tick, tick});
      });
    }
    EXPECT_NEAR(static_cast<double>(arrivals.size()), 5000.0 / 8.0, 2.0) << waiting_frames;
    const auto waiting =
        1000 - static_cast<std::int64_t>(arrivals.size()) - transport.lost_frames();
    EXPECT_GE(waiting, 0) << waiting_frames;
    EXPECT_LE(waiting, static_cast<std::int64_t>(waiting_frames) + 1) << waiting_frames;
    // One place holds the newest; a queue keeps those that came first.
    const Arrival& last = arrivals.back();
    const auto age = last.arrival_tick - last.sent_tick;
    const auto most = static_cast<std::int64_t>(waiting_frames);
    EXPECT_LE(age, most == 1 ? 8 : 8 * (most + 1));
    EXPECT_GE(age, 8 * (most - 1));
  }
}

TEST(Transport, AKnownLinkHasTheBatchesAndTheDelayOfItsSummary) {
  const LinkPreset& bluetooth = LinkPresets()[2];
  ASSERT_EQ(bluetooth.name, "bluetooth");
  EXPECT_EQ(bluetooth.transport.batch_ms, 45.0);
  EXPECT_EQ(LinkPresets()[1].transport.batch_ms, 16.0);
  EXPECT_EQ(LinkPresets()[5].transport.batch_ms, 1.0);  // EtherCAT
  EXPECT_TRUE(bluetooth.transport.has_jitter());
  const TransportConfig steady = bluetooth.transport.WithoutJitter();
  EXPECT_FALSE(steady.has_jitter());
  EXPECT_EQ(steady.delay.MeanMs(), 1.0 + 0.5 * 45.0);
  EXPECT_EQ(steady.batch_ms, 0.0);
}

TEST(Delay, MeanOfAHistogramCountsAllBuckets) {
  DelayConfig config{HistogramDelay{.bucket_ms = 10.0, .counts = {1.0, 3.0}}};
  EXPECT_DOUBLE_EQ(config.MeanMs(), (5.0 + 3.0 * 15.0) / 4.0);
}

TEST(Delay, HistogramMayReachTheLongestDelayAndNoFurther) {
  DelayConfig config{
      HistogramDelay{.bucket_ms = kLongestDelayMs / 10.0, .counts = std::vector<double>(10, 1.0)}};
  EXPECT_NO_THROW(config.Check());
  std::get<HistogramDelay>(config.settings).counts.push_back(1.0);
  EXPECT_THROW(config.Check(), controller::SettingError);
}

TEST(Transport, EverySeedHasAnotherLinkAndTheSameSeedTheSame) {
  const TransportConfig& config = LinkPresets()[3].transport;
  ASSERT_EQ(LinkPresets()[3].name, "wifi");
  const auto ticks = [&](std::uint64_t seed) {
    std::vector<std::int64_t> all;
    for (const Arrival& arrival : Sent(config, 2000, 1, seed)) {
      all.insert(all.end(), {arrival.number, arrival.arrival_tick});
    }
    return all;
  };
  EXPECT_EQ(ticks(1), ticks(1));
  EXPECT_NE(ticks(1), ticks(2));
}

// Frames are so rare that none waits for another.
TEST(Transport, ALostFrameChangesNoDelayOfTheOthers) {
  TransportConfig whole;
  whole.delay.settings = HistogramDelay{.bucket_ms = 1.0, .counts = std::vector<double>(50, 1.0)};
  TransportConfig lossy = whole;
  lossy.loss.settings = IndependentLoss{.percent = 30.0};
  const std::vector<Arrival> all = Sent(whole, 500, 60);
  const std::vector<Arrival> some = Sent(lossy, 500, 60);
  ASSERT_EQ(all.size(), 500U);
  EXPECT_NEAR(static_cast<double>(some.size()), 350.0, 50.0);
  for (const Arrival& arrival : some) {
    EXPECT_EQ(arrival.arrival_tick, all[static_cast<std::size_t>(arrival.number)].arrival_tick);
  }
}

TEST(Transport, ALinkWithoutSettingsPassesEachFrameAtItsTick) {
  for (const Arrival& arrival : Sent({}, 1000, 3)) {
    EXPECT_EQ(arrival.arrival_tick, arrival.sent_tick);
  }
}

}  // namespace
}  // namespace gauntlet::sim
