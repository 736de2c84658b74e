#include "sim/glove/motions/minimum_jerk.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

/// First sample at or after a time.
Eigen::Index SampleAt(double time_s, double rate_hz, Eigen::Index samples) {
  // The small number takes away the rounding of times like 0.3 s at 1 kHz.
  const double sample = std::ceil(time_s * rate_hz - 1e-6);
  return static_cast<Eigen::Index>(std::clamp(sample, 0.0, static_cast<double>(samples)));
}

}  // namespace

void MoveChannel(std::size_t channel, double start_rad, const std::vector<Move>& moves,
                 double rate_hz, Motion& motion) {
  GAUNTLET_ASSERT(rate_hz > 0.0);
  const Eigen::Index samples = motion.angle_rad.rows();
  HoldChannel(channel, 0.0, motion);
  auto angle = motion.angle_rad.col(static_cast<Eigen::Index>(channel));
  std::vector<double> finished_rad(static_cast<std::size_t>(samples) + 1, 0.0);
  for (const Move& move : moves) {
    const Eigen::Index begin = SampleAt(move.start_s, rate_hz, samples);
    const Eigen::Index end = SampleAt(move.start_s + move.duration_s, rate_hz, samples);
    for (Eigen::Index i = begin; i < end; ++i) {
      const double t = static_cast<double>(i) / rate_hz;
      angle[i] += move.delta_rad *
                  MinimumJerkAt(std::clamp((t - move.start_s) / move.duration_s, 0.0, 1.0));
    }
    finished_rad[static_cast<std::size_t>(end)] += move.delta_rad;
  }
  double base_rad = start_rad;
  for (Eigen::Index i = 0; i < samples; ++i) {
    base_rad += finished_rad[static_cast<std::size_t>(i)];
    angle[i] += base_rad;
  }
  TrimSignals();
}

MovePlan::MovePlan(std::vector<double> start_rad)
    : start_rad_(std::move(start_rad)), now_rad_(start_rad_), moves_(start_rad_.size()) {}

void MovePlan::MoveTo(double start_s, double duration_s, const std::vector<double>& target_rad,
                      const std::vector<double>& lag_s) {
  GAUNTLET_ASSERT(target_rad.size() == now_rad_.size());
  GAUNTLET_ASSERT(lag_s.empty() || lag_s.size() == now_rad_.size());
  for (std::size_t channel = 0; channel < now_rad_.size(); ++channel) {
    const double delta = target_rad[channel] - now_rad_[channel];
    if (delta == 0.0) continue;
    const double lag = lag_s.empty() ? 0.0 : lag_s[channel];
    moves_[channel].push_back({start_s + lag, duration_s, delta});
    now_rad_[channel] = target_rad[channel];
  }
}

Motion MovePlan::Fill(int samples, const MotionContext& context) const {
  Motion motion = StillMotion(samples);
  for (std::size_t channel = 0; channel < moves_.size(); ++channel) {
    MoveChannel(channel, start_rad_[channel], moves_[channel], context.rate_hz, motion);
  }
  return motion;
}

}  // namespace gauntlet::sim
