#include "sim/glove/motions/motion.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

#include "sim/base/error.h"
#include "sim/glove/channels.h"
#include "sim/glove/motions/postures.h"
#include "sim/glove/motions/random_motion.h"
#include "sim/glove/recordings/pchip.h"
#include "sim/glove/recordings/recording.h"

namespace gauntlet::sim {
namespace {

int SampleCount(double duration_s, double rate_hz) {
  return std::max(1, static_cast<int>(std::lround(duration_s * rate_hz)));
}

Signal Hold(std::size_t posture, int samples) {
  const std::vector<double> angles = PostureAngles(posture);
  const Eigen::Map<const Eigen::RowVectorXd> row(angles.data(),
                                                 static_cast<Eigen::Index>(angles.size()));
  return row.replicate(samples, 1);
}

/// The recording at the sampling rate; channels that it lacks hold the posture `rest`.
Signal Recorded(const RecordedMotionConfig& config, double rate_hz) {
  const Recording recording = LoadRecording(config.file);
  const double start_s = recording.time_s.front() + config.start_s;
  const double available_s = recording.time_s.back() - start_s;
  if (available_s <= 0.0 || config.duration_s > available_s + 0.5 / rate_hz) {
    throw UserError(fmt::format(
        "{}: start_s {} and duration_s {} go beyond the recording of {:.3f} s", config.file,
        config.start_s, config.duration_s, recording.time_s.back() - recording.time_s.front()));
  }
  const int samples = config.duration_s > 0.0
                          ? SampleCount(config.duration_s, rate_hz)
                          : static_cast<int>(std::floor(available_s * rate_hz + 1e-6)) + 1;
  Signal angle_rad = Hold(0, samples);
  for (Eigen::Index channel = 0; channel < angle_rad.cols(); ++channel) {
    if (!recording.has_channel[static_cast<std::size_t>(channel)]) continue;
    const std::span<const double> value(recording.angle_rad.col(channel).data(),
                                        recording.time_s.size());
    const std::span<double> result(angle_rad.col(channel).data(),
                                   static_cast<std::size_t>(samples));
    InterpolatePchip(recording.time_s, value, start_s, rate_hz, result);
  }
  return angle_rad;
}

}  // namespace

Motion SynthesiseMotion(const MotionConfig& config, double rate_hz, std::uint64_t seed) {
  switch (config.kind) {
    case MotionKind::kHold: {
      const int samples = SampleCount(config.hold.duration_s, rate_hz);
      return {Hold(config.hold.posture, samples), {{"rest", 0, samples}}};
    }
    case MotionKind::kRecording:
      return {Recorded(config.recording, rate_hz), {}};
    case MotionKind::kRandom:
      return {RandomMotion(config.random, SampleCount(config.random.duration_s, rate_hz), rate_hz,
                           seed),
              {}};
  }
  return {};
}

}  // namespace gauntlet::sim
