#include "sim/glove/motions/random_motion.h"

#include <algorithm>
#include <cmath>

#include "sim/base/random.h"
#include "sim/glove/motions/settings_of_motions.h"

namespace gauntlet::sim {
namespace {

constexpr double kKnotSpacingTimesBandwidth = 0.2282;

/// Polynomial of one stretch between two knots: p0 + p1 u + p2 u^2 + p3 u^3, u in [0, 1).
struct Stretch {
  double p0, p1, p2, p3;

  /// From the four control values that reach into the stretch.
  Stretch(double a, double b, double c, double d)
      : p0((a + 4.0 * b + c) / 6.0),
        p1((c - a) / 2.0),
        p2((a - 2.0 * b + c) / 2.0),
        p3((d - a + 3.0 * (b - c)) / 6.0) {}
  double Value(double u) const { return p0 + u * (p1 + u * (p2 + u * p3)); }
};

/// The spline of one channel.
void FillSpline(RandomStream& random, const Excursion& range, double knots_per_s, double rate_hz,
                Eigen::Index column, Motion& motion) {
  const auto draw = [&] {
    return random.Uniform(range.middle_rad - range.half_rad, range.middle_rad + range.half_rad);
  };
  double a = draw(), b = draw(), c = draw(), d = draw();
  const double knots_per_sample = knots_per_s / rate_hz;
  const auto samples = static_cast<double>(motion.angle_rad.rows());
  double* const angle = motion.angle_rad.col(column).data();
  for (double knot = 0.0, begin = 0.0; begin < samples; knot += 1.0) {
    const Stretch stretch(a, b, c, d);
    const double end = std::min(samples, std::ceil((knot + 1.0) / knots_per_sample));
    for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
      angle[i] = stretch.Value(static_cast<double>(i) * knots_per_sample - knot);
    }
    begin = end;
    a = b, b = c, c = d, d = draw();
  }
}

}  // namespace

void RandomMotionConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  visitor.Number(
      {"bandwidth_hz", "frequency at which the amplitude has fallen to 0.707 (-3 dB)", 0.01, 50},
      bandwidth_hz);
  VisitRange(visitor, range_percent);
  VisitChannels(visitor, channels);
}

Motion MakeMotion(const RandomMotionConfig& config, const MotionContext& context) {
  const auto move = [&](std::size_t channel, int, Motion& motion) {
    RandomStream random(context.seed, "motion/random", context.StreamIndex(channel));
    FillSpline(random, ChannelExcursion(channel, config.range_percent),
               config.bandwidth_hz / kKnotSpacingTimesBandwidth, context.rate_hz,
               static_cast<Eigen::Index>(channel), motion);
  };
  return MoveChannels(config.channels, context.SampleCount(config.duration_s), context, move);
}

}  // namespace gauntlet::sim
