#include "sim/glove/motions/sine_motion.h"

#include <cmath>
#include <functional>

#include "sim/glove/channels.h"
#include "sim/glove/motions/postures.h"
#include "sim/glove/motions/settings_of_motions.h"

namespace gauntlet::sim {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;

/// A phase and its first two derivatives with respect to time.
struct Phase {
  double value, speed, acceleration;
};

/// middle + half sin(phase(t)) in one channel.
void Swing(const Excursion& range, double rate_hz, const std::function<Phase(double)>& phase_at,
           Eigen::Index column, Motion& motion) {
  for (Eigen::Index i = 0; i < motion.angle_rad.rows(); ++i) {
    const Phase phase = phase_at(static_cast<double>(i) / rate_hz);
    const double sine = std::sin(phase.value);
    motion.angle_rad(i, column) = range.middle_rad + range.half_rad * sine;
    if (!motion.has_derivatives()) continue;
    const double cosine = std::cos(phase.value);
    motion.velocity_rad_s(i, column) = range.half_rad * phase.speed * cosine;
    motion.acceleration_rad_s2(i, column) =
        range.half_rad * (phase.acceleration * cosine - phase.speed * phase.speed * sine);
  }
}

/// Calls `swing` for each moving channel with the channel and its number among them.
Motion ForEachChannel(const std::vector<std::string>& names, int samples,
                      const MotionContext& context,
                      const std::function<void(std::size_t, int, Motion&)>& swing) {
  Motion motion = StillMotion(context, samples);
  const std::vector<bool> selected = SelectChannels(names);
  const std::vector<double> rest = context.start_rad.empty() ? PostureAngles(0) : context.start_rad;
  int number = 0;
  for (std::size_t channel = 0; channel < selected.size(); ++channel) {
    if (selected[channel]) {
      swing(channel, number++, motion);
    } else {
      HoldChannel(channel, rest[channel], motion);
    }
  }
  return motion;
}

}  // namespace

void SineConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  visitor.Numbers({.key = "frequency_hz",
                   .help = "one number, or 18 in the order of the channels",
                   .min = 0,
                   .max = 50},
                  frequency_hz);
  VisitRange(visitor, range_percent);
  visitor.Number({.key = "phase_step_deg",
                  .help = "how much earlier each channel is than the one before",
                  .min = -360,
                  .max = 360},
                 phase_step_deg);
  VisitChannels(visitor, channels);
}

Motion MakeMotion(const SineConfig& config, const MotionContext& context) {
  const std::size_t count = config.frequency_hz.size();
  if (count != 1 && count != GloveChannels().size()) {
    throw controller::SettingError("frequency_hz",
                                   "has " + std::to_string(count) + " values, must have 1 or 18");
  }
  return ForEachChannel(config.channels, context.SampleCount(config.duration_s), context,
                        [&](std::size_t channel, int number, Motion& motion) {
                          const double omega =
                              kTwoPi * config.frequency_hz[count == 1 ? 0 : channel];
                          const double offset = number * config.phase_step_deg * kRadPerDeg;
                          Swing(
                              ChannelExcursion(channel, config.range_percent), context.rate_hz,
                              [&](double t) {
                                return Phase{omega * t + offset, omega, 0.0};
                              },
                              static_cast<Eigen::Index>(channel), motion);
                        });
}

void ChirpConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  visitor.Number({.key = "from_hz", .help = "frequency at the start", .min = 0.001, .max = 50},
                 from_hz);
  visitor.Number({.key = "to_hz", .help = "frequency at the end", .min = 0.001, .max = 50}, to_hz);
  VisitRange(visitor, range_percent);
  VisitChannels(visitor, channels);
}

Motion MakeMotion(const ChirpConfig& config, const MotionContext& context) {
  const double growth_per_s = std::log(config.to_hz / config.from_hz) / config.duration_s;
  const auto phase_at = [&](double t) {
    const double speed = kTwoPi * config.from_hz * std::exp(growth_per_s * t);
    // The limit of no growth is a plain sine.
    const double value =
        growth_per_s == 0.0 ? speed * t
                            : kTwoPi * config.from_hz * std::expm1(growth_per_s * t) / growth_per_s;
    return Phase{value, speed, growth_per_s * speed};
  };
  return ForEachChannel(config.channels, context.SampleCount(config.duration_s), context,
                        [&](std::size_t channel, int, Motion& motion) {
                          Swing(ChannelExcursion(channel, config.range_percent), context.rate_hz,
                                phase_at, static_cast<Eigen::Index>(channel), motion);
                        });
}

}  // namespace gauntlet::sim
