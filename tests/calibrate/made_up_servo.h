#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/fit/chain_log.h"
#include "tests/calibrate/simulated_log.h"

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

/// Steps of random size up to `most_deg` between rests, or between two levels, and the answer of a
/// servo of 60 deg in 0.2 s. Commands are sent `late` rows before the row that has them.
inline sim::ChainLog LimitedSteps(double most_deg, bool two_levels, double dead_s, double rate_hz,
                                  double late, std::mt19937& random, double seconds = 30.0) {
  using namespace sim::simulated_log;
  std::uniform_real_distribution<double> rest_s(0.5, 1.2), level(-0.5, 0.5);
  const auto row = static_cast<std::size_t>(kFine_hz / rate_hz);
  const auto early = static_cast<std::size_t>(late * static_cast<double>(row));
  Values target;
  for (double to = 0.5 * most_deg; target.size() < seconds * kFine_hz;
       to = two_levels ? -to : most_deg * level(random)) {
    // Commands change with the rows.
    const auto rows = static_cast<std::size_t>(rest_s(random) * rate_hz);
    target.insert(target.end(), rows * row - (target.empty() ? early : 0), to);
  }
  target.resize(static_cast<std::size_t>(seconds * kFine_hz));
  const Values command = Thinned(target, rate_hz);
  const Values angle =
      Measured(Thinned(SpeedLimited(target, dead_s, 300.0, 0.015), rate_hz), 0.1, 0.0, random);
  sim::ChainLog log;
  log.name = "log";
  log.parts = {"servo"};
  log.rate_hz = rate_hz;
  log.command_deg = log.angle_deg = sim::Signal(std::ssize(command), 1);
  for (Eigen::Index n = 0; n < log.command_deg.rows(); ++n) {
    log.command_deg(n, 0) = command[static_cast<std::size_t>(n)];
    log.angle_deg(n, 0) = angle[static_cast<std::size_t>(n)];
  }
  return log;
}

}  // namespace gauntlet::test
