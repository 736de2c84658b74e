#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/fit/chain_log.h"

namespace gauntlet::test {

/// A servo by its own equations: pure delay, lag of first order in steps of 1 ms, dead zone, and an
/// object in the way.
struct MadeUpServo {
  double dead_time_s = 0.04;
  double lag_s = 0.06;
  double gain = 0.95;
  double offset_deg = 2.0;
  double backlash_deg = 1.0;  // whole width
  double noise_deg = 0.05;
  double object_deg = 1e3;  // it cannot go beyond
};

/// An episode of a joint at 100 Hz: sum of four sines, drawn by the number of the motion.
inline sim::ChainLog MakeUpEpisode(const MadeUpServo& servo, int motion, int noise,
                                   double duration_s = 12.0) {
  constexpr double kRowsPerSecond = 100.0;
  sim::RandomStream of_motion(static_cast<std::uint64_t>(motion), "motion");
  sim::RandomStream of_noise(static_cast<std::uint64_t>(noise), "noise");
  std::vector<double> phase, frequency_hz;
  for (int i = 0; i < 4; ++i) {
    phase.push_back(2.0 * std::numbers::pi * of_motion.Uniform());
    frequency_hz.push_back(0.15 * (i + 1) * (0.8 + 0.4 * of_motion.Uniform()));
  }
  const auto command = [&](double t_s) {
    double sum = 30.0;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += 12.0 / (static_cast<double>(i) + 1.0) *
             std::sin(2.0 * std::numbers::pi * frequency_hz[i] * t_s + phase[i]);
    }
    return sum;
  };
  const auto rows = static_cast<Eigen::Index>(duration_s * kRowsPerSecond);
  sim::ChainLog log;
  log.name = "log";
  log.parts = {"joint"};
  log.rate_hz = kRowsPerSecond;
  log.episode = motion;
  log.command_deg = log.angle_deg = sim::Signal(rows, 1);
  double motor = servo.gain * command(-servo.dead_time_s), joint = motor;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double t_s = static_cast<double>(row) / kRowsPerSecond;
    log.command_deg(row, 0) = command(t_s);
    log.angle_deg(row, 0) = std::min(joint + servo.offset_deg, servo.object_deg) +
                            servo.noise_deg * sim::BoxMuller(of_noise).first;
    for (int step = 0; step < 10; ++step) {
      const double wanted = servo.gain * command(t_s + 1e-3 * step - servo.dead_time_s);
      motor += 1e-3 / servo.lag_s * (wanted - motor);
      joint = std::clamp(joint, motor - 0.5 * servo.backlash_deg, motor + 0.5 * servo.backlash_deg);
    }
  }
  return log;
}

}  // namespace gauntlet::test
