#include "sim/glove/motions/sine_motion.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "sim/base/channels.h"
#include "sim/glove/motions/settings_of_motions.h"

namespace gauntlet::sim {
namespace {

/// middle + half sin(phase(t)) in one channel.
void Swing(const Excursion& range, double rate_hz, const std::function<double(double)>& phase_at,
           std::size_t channel, Motion& motion) {
  auto angle_rad = motion.angle_rad.col(static_cast<Eigen::Index>(channel));
  for (Eigen::Index i = 0; i < angle_rad.size(); ++i) {
    angle_rad[i] =
        range.middle_rad + range.half_rad * std::sin(phase_at(static_cast<double>(i) / rate_hz));
  }
}

void VisitFrequency(controller::SettingsVisitor& visitor, std::string_view key,
                    std::string_view help, double min, std::vector<double>& frequency_hz) {
  visitor.Numbers({.key = key, .help = help, .min = min, .max = 50}, frequency_hz);
}

double FrequencyOf(const std::vector<double>& frequency_hz, std::size_t channel) {
  return frequency_hz[PlaceInList(channel, frequency_hz.size())];
}

}  // namespace

void SineConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  VisitFrequency(visitor, "frequency_hz", "one number, or 18 or 22 in the order of the channels", 0,
                 frequency_hz);
  VisitRange(visitor, range_percent);
  visitor.Number(
      {"phase_step_deg", "how much earlier each channel is than the one before", -360, 360},
      phase_step_deg);
  VisitChannels(visitor, channels);
}

Motion MakeMotion(const SineConfig& config, const MotionContext& context) {
  CheckListOfChannels("frequency_hz", config.frequency_hz.size());
  const auto swing = [&](std::size_t channel, int number, Motion& motion) {
    const double omega = 2.0 * std::numbers::pi * FrequencyOf(config.frequency_hz, channel);
    const double offset = number * config.phase_step_deg * kRadPerDeg;
    Swing(
        ChannelExcursion(channel, config.range_percent), context.rate_hz,
        [&](double t) { return omega * t + offset; }, channel, motion);
  };
  return MoveChannels(config.channels, context.SampleCount(config.duration_s), context, swing);
}

void ChirpConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  VisitFrequency(visitor, "from_hz",
                 "frequency at the start: one number, or 18 or 22 in the order of the channels",
                 0.001, from_hz);
  VisitFrequency(visitor, "to_hz", "frequency at the end, likewise", 0.001, to_hz);
  VisitRange(visitor, range_percent);
  VisitChannels(visitor, channels);
}

Motion MakeMotion(const ChirpConfig& config, const MotionContext& context) {
  CheckListOfChannels("from_hz", config.from_hz.size());
  CheckListOfChannels("to_hz", config.to_hz.size());
  const auto swing = [&](std::size_t channel, int, Motion& motion) {
    const double start_speed = 2.0 * std::numbers::pi * FrequencyOf(config.from_hz, channel);
    const double end_speed = 2.0 * std::numbers::pi * FrequencyOf(config.to_hz, channel);
    const double growth_per_s = std::log(end_speed / start_speed) / config.duration_s;
    const auto phase_at = [=](double t) {
      // The limit of no growth is a plain sine.
      return growth_per_s == 0.0 ? start_speed * t
                                 : start_speed * std::expm1(growth_per_s * t) / growth_per_s;
    };
    Swing(ChannelExcursion(channel, config.range_percent), context.rate_hz, phase_at, channel,
          motion);
  };
  return MoveChannels(config.channels, context.SampleCount(config.duration_s), context, swing);
}

}  // namespace gauntlet::sim
