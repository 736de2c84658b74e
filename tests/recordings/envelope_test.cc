#include "sim/recordings/envelope.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace gauntlet::sim {
namespace {

/// A muscle at 1 kHz: 120 Hz on an offset, as a converter gives it.
double Muscle(int row, double amplitude) {
  return 512.0 + amplitude * std::sin(2.0 * std::numbers::pi * 0.12 * row);
}

// |H| of the high pass at 120 Hz, from its equation: a |1 - z^-1| / |1 - a z^-1|.
double GainAt120Hz() {
  const double a = 1.0 / (1.0 + 2.0 * std::numbers::pi * 10.0 * 1e-3);
  const double w = 2.0 * std::numbers::pi * 0.12;
  const double above = std::hypot(1.0 - std::cos(w), std::sin(w));
  return a * above / std::hypot(1.0 - a * std::cos(w), a * std::sin(w));
}

TEST(Envelope, OfASineIsItsMeanMagnitudeWithoutTheOffset) {
  Envelope envelope(150.0);
  double value = 0.0;
  for (int k = 0; k < 1000; ++k) value = envelope.Step(1e-3 * k, Muscle(k, 200.0));
  EXPECT_NEAR(value, 200.0 * GainAt120Hz() * 2.0 / std::numbers::pi, 1.0);
}

TEST(Envelope, LagsByHalfItsWindow) {
  for (const double window_ms : {50.0, 200.0}) {
    Envelope envelope(window_ms);
    int half = 0;
    for (int k = 0; k < 2000; ++k) {
      const double value = envelope.Step(1e-3 * k, Muscle(k, k < 1000 ? 0.0 : 200.0));
      const double whole = 200.0 * GainAt120Hz() * 2.0 / std::numbers::pi;
      if (half == 0 && value > 0.5 * whole) half = k;
    }
    EXPECT_NEAR(half - 1000, 0.5 * window_ms, 5.0);
  }
}

TEST(Envelope, BeginsAnewBehindAGapAndPassesMissingValues) {
  Envelope envelope(100.0);
  for (int k = 0; k < 300; ++k) envelope.Step(1e-3 * k, Muscle(k, 200.0));
  EXPECT_TRUE(std::isnan(envelope.Step(0.3, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_GT(envelope.Step(0.301, Muscle(301, 200.0)), 100.0);
  EXPECT_EQ(envelope.Step(0.5, 900.0), 0.0);  // no step of the offset
}

}  // namespace
}  // namespace gauntlet::sim
