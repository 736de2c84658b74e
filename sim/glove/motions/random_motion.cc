#include "sim/glove/motions/random_motion.h"

#include <cmath>

#include "sim/base/random.h"
#include "sim/glove/channels.h"

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
  double operator()(double u) const { return p0 + u * (p1 + u * (p2 + u * p3)); }
};

}  // namespace

Signal RandomMotion(const RandomMotionConfig& config, int samples, double rate_hz,
                    std::uint64_t seed) {
  const auto channels = GloveChannels();
  Signal angle_rad(samples, static_cast<Eigen::Index>(channels.size()));
  const double knots_per_sample = config.bandwidth_hz / kKnotSpacingTimesBandwidth / rate_hz;
  for (std::size_t channel = 0; channel < channels.size(); ++channel) {
    const double middle = 0.5 * (channels[channel].max_deg + channels[channel].min_deg);
    const double half = 0.5 * (channels[channel].max_deg - channels[channel].min_deg) *
                        config.range_percent / 100.0;
    RandomStream random(seed, "motion/random", channel);
    const auto draw = [&] { return kRadPerDeg * random.Uniform(middle - half, middle + half); };
    double a = draw(), b = draw(), c = draw(), d = draw();
    auto column = angle_rad.col(static_cast<Eigen::Index>(channel));
    Stretch stretch(a, b, c, d);
    double knot = 0.0;
    for (int i = 0; i < samples; ++i) {
      const double place = i * knots_per_sample;
      while (place >= knot + 1.0) {
        a = b, b = c, c = d, d = draw();
        stretch = Stretch(a, b, c, d);
        knot += 1.0;
      }
      column[i] = stretch(place - knot);
    }
  }
  return angle_rad;
}

}  // namespace gauntlet::sim
