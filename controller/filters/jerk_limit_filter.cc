#include "controller/filters/jerk_limit_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/recursive_filter.h"
#include "controller/filters/subnormal.h"

namespace gauntlet::controller {
namespace {

/// Per step, step^2 and step^3.
struct MotionLimits {
  double velocity;
  double acceleration;
  double jerk;
};

struct MotionState {
  double position;
  double velocity;
  double acceleration;
};

/// b + (b - J) + (b - 2 J) + .., the positive terms: the change of the velocity while the
/// acceleration returns from b to 0, b included. Odd in b.
double VelocityOf(double acceleration, double jerk) {
  const double b = std::abs(acceleration);
  const double terms = std::ceil(b / jerk);
  return std::copysign(terms * b - jerk * terms * (terms - 1.0) / 2.0, acceleration);
}

/// Number of terms of VelocityOf() for this change of the velocity, at least 1.
double TermsOf(double velocity, double jerk) {
  return std::max(1.0, std::ceil((std::sqrt(1.0 + 8.0 * std::abs(velocity) / jerk) - 1.0) / 2.0));
}

/// The inverse of VelocityOf().
double AccelerationOf(double velocity, double jerk) {
  const double terms = TermsOf(velocity, jerk);
  return std::copysign(std::abs(velocity) / terms + jerk * (terms - 1.0) / 2.0, velocity);
}

/// Way from velocity v to rest with v <- v - AccelerationOf(v), after the first of these steps.
double WayOfLastRamp(double velocity, double jerk) {
  const double n = TermsOf(velocity, jerk);
  const double first = std::abs(AccelerationOf(velocity, jerk));
  const double way = first * n * (n - 1.0) / 2.0 - jerk * (n - 1.0) * n * (2.0 * n - 1.0) / 6.0;
  return std::copysign(way, velocity);
}

/// Sum of v, v + .., as `steps` samples pass whose accelerations are first, first + jerk, ..
struct Ramp {
  double velocity;  // behind it
  double way;
};
Ramp RampOf(double velocity, double first, double jerk, double steps) {
  const double triangle = steps * (steps + 1.0) / 2.0;
  return {.velocity = velocity + steps * first + jerk * steps * (steps - 1.0) / 2.0,
          .way = steps * velocity + first * triangle +
                 jerk * (steps - 1.0) * steps * (steps + 1.0) / 6.0};
}

/// Number of samples for which a fastest stop lowers the acceleration by J each: as long as the one
/// that ends at rest, -AccelerationOf(v), is lower still.
double FallingSamples(double velocity, double acceleration, double jerk) {
  // Place of the first of these accelerations that is not positive, or would have been earlier, and
  // the velocity before it.
  const double place = std::ceil(acceleration / jerk - 1.0);
  const double velocity_then = RampOf(velocity, acceleration - jerk, -jerk, place).velocity;
  const double fall = (place + 1.0) * jerk - acceleration;
  // The last ramp begins where v - i fall - J i (i - 1) / 2 <= (i + 1) (fall + J i / 2).
  if (velocity_then <= fall) return std::max(0.0, place);
  const double root = std::sqrt(fall * fall + jerk * (velocity_then - fall));
  return std::max(0.0, place + std::ceil((root - fall) / jerk));
}

/// Way of the fastest stop from this velocity and acceleration.
double StoppingWay(double velocity, double acceleration, const MotionLimits& limits) {
  const double jerk = limits.jerk;
  const bool rises = -AccelerationOf(velocity, jerk) > acceleration;
  const double sign = rises ? -1.0 : 1.0;
  double v = sign * velocity;
  const double a = sign * acceleration;
  double way = 0.0;
  if (-AccelerationOf(v, jerk) < a - jerk) {
    const double to_limit = std::max(0.0, std::floor((a + limits.acceleration) / jerk));
    const Ramp ramp = RampOf(v, a - jerk, -jerk, std::min(FallingSamples(v, a, jerk), to_limit));
    way = ramp.way;
    v = ramp.velocity;
  }
  const double beyond = v - VelocityOf(limits.acceleration, jerk);
  if (beyond > 0.0) {
    const Ramp at_limit =
        RampOf(v, -limits.acceleration, 0.0, std::ceil(beyond / limits.acceleration));
    way += at_limit.way;
    v = at_limit.velocity;
  }
  return sign * (way + WayOfLastRamp(v, jerk));
}

/// The acceleration after which the fastest stop ends at `target`, or the nearest that the limits
/// allow.
double NextAcceleration(const MotionState& now, double target, const MotionLimits& limits) {
  const double jerk = limits.jerk;
  double low = std::max({now.acceleration - jerk, -limits.acceleration,
                         -AccelerationOf(limits.velocity + now.velocity, jerk)});
  double high = std::min({now.acceleration + jerk, limits.acceleration,
                          AccelerationOf(limits.velocity - now.velocity, jerk)});
  const double ahead = target - now.position;
  const auto beyond = [&](double acceleration) {
    const double velocity = now.velocity + acceleration;
    return velocity + StoppingWay(velocity, acceleration, limits) - ahead;
  };
  double beyond_low = beyond(low);
  if (!(low < high) || beyond_low >= 0.0) return low;
  double beyond_high = beyond(high);
  if (beyond_high <= 0.0) return high;
  // A piecewise linear equation: regula falsi, with the weight of an end that stays halved.
  constexpr int kMostTrials = 60;
  const double enough = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(ahead);
  double best = low;
  int last_side = 0;
  for (int trial = 0; trial < kMostTrials; ++trial) {
    best = std::clamp(low + (high - low) * (beyond_low / (beyond_low - beyond_high)), low, high);
    if (best == low || best == high) best = low + 0.5 * (high - low);
    const double value = beyond(best);
    if (std::abs(value) <= enough || best == low || best == high) return best;
    const int side = value > 0.0 ? 1 : -1;
    if (side > 0) {
      high = best;
      beyond_high = value;
      if (last_side > 0) beyond_low *= 0.5;
    } else {
      low = best;
      beyond_low = value;
      if (last_side < 0) beyond_high *= 0.5;
    }
    last_side = side;
  }
  return best;
}

class JerkLimitFilter final : public RecursiveFilter {
 public:
  JerkLimitFilter(const JerkLimitConfig& config, int channel_count, double rate_hz)
      : RecursiveFilter(3, channel_count),
        limits_{.velocity = config.max_velocity_per_s / rate_hz,
                .acceleration = config.max_acceleration_per_s2 / rate_hz / rate_hz,
                .jerk = config.max_jerk_per_s3 / rate_hz / rate_hz / rate_hz} {}

 private:
  enum State { kPosition, kVelocity, kAcceleration };

  void StepAll(const double* input, double* output) noexcept override {
    for (int i = 0; i < channel_count(); ++i) {
      MotionState now{state(kPosition)[i], state(kVelocity)[i], state(kAcceleration)[i]};
      Follow(WithoutSubnormal(input[i]), now);
      state(kPosition)[i] = now.position;
      state(kVelocity)[i] = now.velocity;
      state(kAcceleration)[i] = now.acceleration;
      output[i] = now.position;
    }
  }
  void SettleAt(int channel, double value) noexcept override { state(kPosition)[channel] = value; }

  void Follow(double target, MotionState& now) const noexcept {
    // So near that the limits do not matter: no memory of rounding remains.
    const double near = 1e-9 * limits_.jerk;
    if (std::abs(target - now.position) <= near && std::abs(now.velocity) <= near &&
        std::abs(now.acceleration) <= near) {
      now = {target, 0.0, 0.0};
      return;
    }
    now.acceleration = NextAcceleration(now, target, limits_);
    now.velocity += now.acceleration;
    now.position += now.velocity;
  }

  MotionLimits limits_;
};

}  // namespace

void JerkLimitConfig::Visit(SettingsVisitor& visitor) {
  visitor.Number({"max_velocity_per_s", "largest velocity [input unit / s]", 1e-6, 1e12},
                 max_velocity_per_s);
  visitor.Number({"max_acceleration_per_s2", "largest acceleration [input unit / s^2]", 1e-6, 1e15},
                 max_acceleration_per_s2);
  visitor.Number(
      {"max_jerk_per_s3", "largest jerk [input unit / s^3]; lower means less jitter", 1e-6, 1e18},
      max_jerk_per_s3);
}

std::unique_ptr<Filter> MakeFilter(const JerkLimitConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  return std::make_unique<JerkLimitFilter>(config, channel_count, rate_hz);
}

}  // namespace gauntlet::controller
