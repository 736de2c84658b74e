// How an angle follows its command, and whether the delay stays.
#include "sim/fit/follow_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "tests/controller/test_signal.h"

namespace gauntlet::sim {
namespace {

constexpr double kLogRate_hz = 100.0;
constexpr double kLogRow_ms = 1e3 / kLogRate_hz;
constexpr double kLeast_rows = 1.0;

/// A log of a hand that follows `delay_ms` late, with a noise of 0.2 deg.
FollowRows DelayedLog(double length_s, std::uint64_t seed,
                      const std::function<double(double)>& delay_ms) {
  const auto command = [seed](double t) {
    const auto swing = [t, seed](double hz) {
      return std::sin(2.0 * std::numbers::pi * hz * t + hz * static_cast<double>(seed));
    };
    return 40.0 + 15.0 * swing(0.31) + 9.0 * swing(0.83) + 4.0 * swing(1.71);
  };
  controller::TestNoise random(seed);
  const auto rows = static_cast<Eigen::Index>(length_s * kLogRate_hz);
  FollowRows log = {Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) / kLogRate_hz;
    log.command[i] = command(t);
    log.angle[i] = command(t - 1e-3 * delay_ms(t)) + 0.2 * random.Normal();
  }
  return log;
}

TEST(DelayDrift, IsThatOfTwoClocks) {
  for (const double sign : {1.0, -1.0}) {
    // 1 ms in a second: the parts of 10 s have their delays in their middles.
    const auto drift =
        FindDelayDrift(DelayedLog(40.0, 3, [sign](double t) { return 60.0 + sign * (t - 20.0); }),
                       kLogRate_hz, kLeast_rows);
    ASSERT_TRUE(drift.has_value());
    EXPECT_NEAR(kLogRow_ms * drift->first_rows, 60.0 - 15.0 * sign, 1.5);
    EXPECT_NEAR(kLogRow_ms * drift->last_rows, 60.0 + 15.0 * sign, 1.5);
  }
}

TEST(DelayDrift, IsNoneWhereTheDelayStaysOrGoesToAndFro) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    found += FindDelayDrift(DelayedLog(40.0, seed, [](double) { return 60.0; }), kLogRate_hz, 0.0)
                 ? 1
                 : 0;
  }
  EXPECT_LE(found, 3);  // of 100; at random the order is one of two in 24, the test at 1 %
  const auto to_and_fro = [](double t) { return t < 10.0 || t > 30.0 ? 60.0 : 90.0; };
  EXPECT_FALSE(FindDelayDrift(DelayedLog(40.0, 3, to_and_fro), kLogRate_hz, kLeast_rows));
  const auto little = [](double t) { return 60.0 + 0.1 * t; };
  EXPECT_FALSE(FindDelayDrift(DelayedLog(40.0, 3, little), kLogRate_hz, kLeast_rows));
  EXPECT_TRUE(FindDelayDrift(DelayedLog(40.0, 3, little), kLogRate_hz, 0.1));
  const auto of_clocks = [](double t) { return 60.0 + t; };
  EXPECT_FALSE(FindDelayDrift(DelayedLog(19.0, 3, of_clocks), kLogRate_hz, kLeast_rows));
  EXPECT_FALSE(FindDelayDrift({Eigen::VectorXd::Zero(4000), Eigen::VectorXd::Zero(4000)},
                              kLogRate_hz, kLeast_rows));
}

}  // namespace
}  // namespace gauntlet::sim
