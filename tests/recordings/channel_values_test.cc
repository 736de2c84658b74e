#include "sim/recordings/channel_values.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace gauntlet::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(ChannelValues, AreSumsOfScaledColumnsWithoutTheirJumps) {
  ChannelValues channels({{{.column = 1, .factor = 2.0, .offset = 5.0},
                           {.column = 0, .factor = -1.0, .offset = 0.5, .wraps_at = 360.0}},
                          {{.column = 1}}});
  EXPECT_FALSE(channels.needs_time());
  EXPECT_EQ(channels.Next(0, kNone, std::array{350.0, 10.0}), 25.0 - 349.5);
  EXPECT_EQ(channels.Next(0, kNone, std::array{5.0, 10.0}), 25.0 - 364.5);
  EXPECT_EQ(channels.jumps(0, 0), 0u);
  EXPECT_EQ(channels.jumps(0, 1), 1u);
  EXPECT_TRUE(std::isnan(channels.Next(0, kNone, std::array{kNone, 10.0})));
  EXPECT_EQ(channels.Next(0, kNone, std::array{340.0, 10.0}), 25.0 - 339.5) << "back again";
  EXPECT_TRUE(std::signbit(channels.Next(1, kNone, std::array{0.0, -0.0}))) << "as it is";
  EXPECT_TRUE(std::isnan(channels.Next(1, kNone, std::array{0.0}))) << "a short row";
}

TEST(ChannelValues, OfAnEnvelopeAreThoseOfItsRowsInOrder) {
  const auto muscle = [](int row) { return row % 2 == 0 ? 700.0 : 300.0; };
  ChannelValues channels({{{.column = 0, .factor = 0.5, .offset = 7.0, .envelope_ms = 50.0}}});
  Envelope envelope(50.0);
  EXPECT_TRUE(channels.needs_time());
  const auto next = [&](double time_s, double value) {
    return channels.Next(0, time_s, std::array{value});
  };
  double last = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double time_s = 1e-3 * k;
    last = 0.5 * envelope.Step(time_s, muscle(k)) + 7.0;
    ASSERT_EQ(next(time_s, muscle(k)), last);
    // A frame that came twice, or late, has no value and leaves the next ones as they are.
    ASSERT_TRUE(std::isnan(next(time_s, 0.0)));
    ASSERT_TRUE(std::isnan(next(time_s - 0.01, 0.0)));
    ASSERT_TRUE(std::isnan(next(time_s + 5e-4, kNone)));
    ASSERT_TRUE(std::isnan(next(kNone, 0.0)));
  }
  EXPECT_GT(last, 50.0);
  EXPECT_EQ(next(-2.0, 700.0), 7.0) << "a clock that was started anew";
  EXPECT_GT(next(-1.999, 300.0), 20.0);
}

}  // namespace
}  // namespace gauntlet::sim
