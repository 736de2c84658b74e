#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "tests/controller/test_signal.h"

namespace gauntlet::sim {

/// What a log shall hide, in the units that a fit gives.
struct HiddenChain {
  double dead_time_ms = 30.0;
  double lag_ms = 40.0;
  double natural_frequency_hz = 6.0;
  double gain = 1.0;
  double hysteresis_deg = 3.0;
  double offset_deg = 2.0;
  double lost_motion_deg = 0.0;  // a dead zone between motor and joint, end to end
};

/// How the log was made.
struct ChainRecording {
  double duration_s = 30.0;
  double rate_hz = 500.0;
  double held_s = 0.0;             // the command goes in steps, as frames do; 0: smooth
  double noise_deg = 0.3;          // of the measured angle
  double noise_correlation = 0.0;  // of neighbouring samples, first-order
  double motor_step_deg = 0.088;   // of the motor's encoder: 12 bits a turn
  double motor_noise_deg = 0.02;
};

struct SimulatedLog {
  std::vector<double> command_deg;
  std::vector<double> angle_deg;
  std::vector<double> motor_deg;
};

/// Twelve sines of 0.1 to 3 Hz as command; the chain in steps of 50 us by Euler's semi-implicit
/// rule, from a command that is known at all times: nothing is shared with what shall find it. Then
/// the joint, behind a dead zone.
inline SimulatedLog SimulateLog(const HiddenChain& chain, const ChainRecording& recording,
                                std::uint64_t seed) {
  controller::TestNoise random(seed);
  controller::TestNoise motor_random(seed + 1'000'000);
  struct Sine {
    double angular;
    double amplitude_deg;
    double phase;
  };
  std::array<Sine, 12> sines;
  for (std::size_t i = 0; i < sines.size(); ++i) {
    const double frequency_hz = 0.1 * std::pow(30.0, (i + random.Uniform()) / sines.size());
    sines[i] = {2.0 * std::numbers::pi * frequency_hz, 8.0 / (1.0 + frequency_hz),
                2.0 * std::numbers::pi * random.Uniform()};
  }
  const auto command = [&](double t) {
    constexpr double kRounding = 1e-6;  // of a frame
    if (recording.held_s > 0.0) {
      t = recording.held_s * std::floor(t / recording.held_s + kRounding);
    }
    double sum = 20.0;
    for (const Sine& s : sines) sum += s.amplitude_deg * std::sin(s.angular * t + s.phase);
    return sum;
  };
  constexpr double kStep_s = 5e-5;
  const double omega = 2.0 * std::numbers::pi * chain.natural_frequency_hz;
  const double play = 0.5 * chain.hysteresis_deg;
  const int steps_per_row = static_cast<int>(std::lround(1.0 / (recording.rate_hz * kStep_s)));
  const int rows = static_cast<int>(recording.duration_s * recording.rate_hz);
  SimulatedLog log;
  double t = -2.0;  // so that it has forgotten how it began
  double q = chain.gain * command(t - 1e-3 * chain.dead_time_ms);
  double z = q;
  double speed = 0.0;
  double joint = z;
  const double lost = 0.5 * chain.lost_motion_deg;
  const auto step = [&] {
    const double v = chain.gain * command(t - 1e-3 * chain.dead_time_ms);
    q = std::min(std::max(q, v - play), v + play);
    speed += kStep_s * omega * omega * (q - z - 1e-3 * chain.lag_ms * speed);
    z += kStep_s * speed;
    joint = std::min(std::max(joint, z - lost), z + lost);
    t += kStep_s;
  };
  for (int i = 0; i < 40'000; ++i) step();
  double noise = recording.noise_deg * random.Normal();
  const double c = recording.noise_correlation;
  for (int row = 0; row < rows; ++row) {
    t = row / recording.rate_hz;
    log.command_deg.push_back(command(t));
    log.angle_deg.push_back(joint + chain.offset_deg + noise);
    const double motor_deg = z + recording.motor_noise_deg * motor_random.Normal();
    log.motor_deg.push_back(recording.motor_step_deg *
                            std::round(motor_deg / recording.motor_step_deg));
    noise = c * noise + std::sqrt(1.0 - c * c) * recording.noise_deg * random.Normal();
    for (int i = 0; i < steps_per_row; ++i) step();
  }
  return log;
}

}  // namespace gauntlet::sim
