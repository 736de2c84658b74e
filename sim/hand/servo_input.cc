#include "sim/hand/servo_input.h"

#include <algorithm>
#include <cmath>

#include "sim/base/normal_pair.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

/// Part of a frame by which the motor's own frames are late.
double PhaseOf(int motor) { return RandomStream(1, "servo frame", motor).Uniform(); }

RandomStream NoiseOf(int motor) { return {1, "servo sensor", static_cast<std::uint64_t>(motor)}; }

}  // namespace

ServoInput::ServoInput(const ServoNumbers& numbers, const controller::Timing& timing, int motor)
    : motor_(motor),
      free_running_(numbers.free_running),
      first_frame_tick_(static_cast<int>(PhaseOf(motor) * timing.TicksOf(numbers.frame_ms))),
      sensor_step_rad_(numbers.sensor_bits == 0
                           ? 0.0
                           : numbers.travel_deg * kRadPerDeg / ((1 << numbers.sensor_bits) - 1)),
      sensor_noise_rad_(numbers.sensor_noise_deg * kRadPerDeg),
      frame_(std::max(1.0, timing.TicksOf(numbers.frame_ms))),
      taken_rad_(1 + std::lround(timing.TicksOf(numbers.dead_time_ms))),
      noise_(NoiseOf(motor)) {}

void ServoInput::Reset(double target_rad) {
  frame_.Reset();
  tick_ = 0;
  std::ranges::fill(taken_rad_, target_rad);
  noise_ = NoiseOf(motor_);
}

double ServoInput::Step(double command_rad, bool commanded) noexcept {
  const bool running = free_running_ ? tick_ >= first_frame_tick_ : commanded;
  if (!running) ++tick_;
  double taken_rad = taken_rad_[now_];
  if (running && frame_.Tick()) taken_rad = command_rad;
  now_ = (now_ + 1) % taken_rad_.size();
  taken_rad_[now_] = taken_rad;
  return taken_rad_[(now_ + 1) % taken_rad_.size()];
}

double ServoInput::SensorError(double angle_rad) noexcept {
  double reading = angle_rad;
  if (sensor_noise_rad_ > 0.0) reading += sensor_noise_rad_ * BoxMuller(noise_).first;
  if (sensor_step_rad_ > 0.0) reading = sensor_step_rad_ * std::round(reading / sensor_step_rad_);
  return reading - angle_rad;
}

}  // namespace gauntlet::sim
