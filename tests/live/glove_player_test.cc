#include "sim/live/glove_player.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace gauntlet::sim {
namespace {

/// Keeps frames; the fourth finds no room, the fifth no receiver.
class FewFrames final : public FrameSink {
 public:
  Result Send(const OutgoingFrame& frame) override {
    numbers.push_back(frame.number);
    times_ns.push_back(frame.time_ns);
    first_values.push_back(frame.values[0]);
    return numbers.size() == 4   ? Result::kDropped
           : numbers.size() == 5 ? Result::kGone
                                 : Result::kSent;
  }
  SinkCounts counts() const override { return {}; }
  std::string problem() const override { return ""; }
  std::string Description() const override { return "few"; }

  std::vector<std::int64_t> numbers;
  std::vector<std::int64_t> times_ns;
  std::vector<double> first_values;
};

/// Eight samples of two channels, at every fifth of 40 ticks of 1 ms.
GlovePlay PlayOf(double seconds) {
  auto glove = std::make_shared<GloveSignal>();
  glove->channel_names = {"a", "b"};
  glove->ticks_per_sample = 5;
  glove->true_angle_rad = Signal(40, 2);
  glove->counts = Signal(8, 2);
  for (int row = 0; row < 8; ++row) {
    glove->counts(row, 0) = 100.0 + row;
    glove->counts(row, 1) = NAN;
  }
  GlovePlay play;
  play.glove = std::move(glove);
  play.timing.ticks_per_sample = 5;
  play.seconds = seconds;
  return play;
}

/// In a thread of its own, which gets a higher priority.
GlovePlayed Play(const GlovePlay& play, FrameSink& sink) {
  GlovePlayed played;
  std::thread([&] { played = PlayGlove(play, sink); }).join();
  return played;
}

TEST(PlayGlove, SendsEachSampleWithTheTimeOfItsCapture) {
  for (const double seconds : {0.0, 0.061}) {
    FewFrames sink;
    const GlovePlayed played = Play(PlayOf(seconds), sink);
    if (played.skipped_ticks > 0) GTEST_SKIP() << "the machine is busy";
    const std::size_t samples = seconds > 0.0 ? 13 : 8;  // it begins anew
    EXPECT_EQ(played.samples, static_cast<std::int64_t>(samples));
    EXPECT_DOUBLE_EQ(played.duration_s, seconds > 0.0 ? 0.061 : 0.04);
    EXPECT_EQ(played.dropped, 1);
    EXPECT_EQ(played.failed, 1);
    EXPECT_EQ(played.lost, 0);
    EXPECT_EQ(played.lateness.count(), std::lround(1e3 * played.duration_s));
    ASSERT_EQ(sink.numbers.size(), samples);
    for (std::size_t i = 0; i < samples; ++i) {
      EXPECT_EQ(sink.numbers[i], static_cast<std::int64_t>(i));
      EXPECT_EQ(sink.first_values[i], 100.0 + static_cast<double>(i % 8));
      EXPECT_EQ(sink.times_ns[i] - sink.times_ns[0], 5'000'000 * static_cast<std::int64_t>(i));
    }
  }
}

TEST(PlayGlove, CountsWhatItsLinkLoses) {
  GlovePlay play = PlayOf(0.2);
  play.link.emplace().transport.loss.settings = IndependentLoss{.percent = 50.0};
  FewFrames sink;
  const GlovePlayed played = Play(play, sink);
  EXPECT_EQ(played.samples, 40);
  EXPECT_GT(played.lost, 5);
  EXPECT_LT(played.lost, 35);
  EXPECT_EQ(static_cast<std::int64_t>(sink.numbers.size()), played.samples - played.lost);
}

}  // namespace
}  // namespace gauntlet::sim
