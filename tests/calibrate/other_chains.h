#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "tests/controller/test_signal.h"

namespace gauntlet::sim {

/// Kinds of hands that differ from the basic model of `gauntlet identify` (play, then a lag of
/// second order).
enum class OtherKind { kDahl, kLuGre, kThirdOrder, kZero, kSpeedLimit, kLoad };
inline constexpr std::array<const char*, 6> kOtherKindNames = {
    "Dahl", "LuGre", "third order", "with a zero", "speed limit", "load"};

/// True values of a log. NaN: the hand has no such value, so no interval can contain it.
struct OtherTruth {
  double dead_time_ms = 0.0;
  double lag_ms = 0.0;
  double natural_frequency_hz = 0.0;
  double damping_ratio = 0.0;
  double gain = 0.0;
  double offset_deg = 0.0;
  double hysteresis_deg = 0.0;
  double speed_limit_deg_s = std::numeric_limits<double>::quiet_NaN();
};

struct OtherLog {
  double rate_hz = 0.0;
  std::vector<double> command_deg;
  std::vector<double> angle_deg;
  OtherTruth truth;
};

/// Simulates a hand of another kind, in steps of 50 us by Euler's semi-implicit rule:
///
///     v = gain u(t - dead_time),   q = friction(v),   z'' = w^2 (q - z - d - load) - w^2 lag z'
///
/// Dahl: d' = (play - sgn(x') d) x' / stretch, where x is the motor's angle q (v = q + d) or, in
/// every second log, the moving mass z. LuGre: the same with a Stribeck curve of 20 to 50 % and
/// bristle damping. Third order: three equal first-order lags. Zero: (1 + T s) behind the lag.
/// Speed limit: of the command, or, in every second log, of the moving mass. Load: gravity,
/// load_deg sin(z + phase). Third order, zero and load have play or Dahl friction by turns.
///
/// Commands: twelve sines of 0.1 to 3 Hz; a quarter of the logs with a speed limit has steps.
/// Noise: white, 0.1 to 0.4 deg. Lag of the truth: the delay of slow motions besides the dead time.
/// With a load, gain, lag and hysteresis are those of small motions in the middle of the travel.
/// Sources: Dahl, AIAA J. 14, 1675-1682 (1976); Canudas de Wit et al., IEEE Trans. Autom. Control
/// 40, 419-425 (1995).
class OtherChain {
 public:
  OtherChain(OtherKind kind, std::uint64_t seed) : kind_(kind), random_(seed) {
    dead_s_ = Between(0.015, 0.08);
    lag_s_ = Between(0.025, 0.06);
    omega_ = 2.0 * std::numbers::pi * Between(4.0, 8.0);
    gain_ = Between(0.8, 1.1);
    offset_deg_ = Between(-5.0, 5.0);
    noise_deg_ = Between(0.1, 0.4);
    play_deg_ = 0.5 * Between(1.0, 8.0);
    stretch_deg_ = 2.0 * play_deg_ * Between(0.1, 0.5);
    stribeck_ = Between(0.2, 0.5);
    stribeck_deg_s_ = Between(5.0, 20.0);
    zero_s_ = lag_s_ * Between(0.2, 0.6);
    limit_deg_s_ = Between(40.0, 120.0);
    load_deg_ = Between(1.0, 6.0);
    load_phase_deg_ = Between(-90.0, 90.0);
    second_ = random_.Uniform() < 0.5;
    soft_ = kind == OtherKind::kDahl || random_.Uniform() < 0.5;
    steps_ = kind == OtherKind::kSpeedLimit && random_.Uniform() < 0.25;
    if (kind == OtherKind::kSpeedLimit) play_deg_ *= 0.3;
    MakeCommand();
  }

  OtherLog Simulate(double rate_hz, double duration_s = 30.0) {
    const int steps_per_row = static_cast<int>(std::lround(1.0 / (rate_hz * kStep_s)));
    OtherLog log{.rate_hz = 1.0 / (steps_per_row * kStep_s),
                 .command_deg = {},
                 .angle_deg = {},
                 .truth = Truth()};
    t_s_ = -2.0;
    v_ = limited_ = q_ = z_ = first_ = second_lag_ = gain_ * Command(t_s_);
    for (int i = 0; i < 40'000; ++i) Step();
    for (int row = 0; row < static_cast<int>(duration_s * rate_hz); ++row) {
      log.command_deg.push_back(Command(t_s_));
      log.angle_deg.push_back(Output() + offset_deg_ + noise_deg_ * random_.Normal());
      for (int i = 0; i < steps_per_row; ++i) Step();
    }
    return log;
  }

 private:
  static constexpr double kStep_s = 5e-5;

  double Between(double low, double high) { return low + (high - low) * random_.Uniform(); }

  void MakeCommand() {
    for (std::size_t i = 0; i < sines_.size(); ++i) {
      const double frequency_hz = 0.1 * std::pow(30.0, (i + random_.Uniform()) / sines_.size());
      sines_[i] = {2.0 * std::numbers::pi * frequency_hz, 8.0 / (1.0 + frequency_hz),
                   2.0 * std::numbers::pi * random_.Uniform()};
    }
    for (double& level : levels_deg_) level = Between(-20.0, 60.0);
  }

  double Command(double t_s) const {
    if (steps_) return levels_deg_[static_cast<std::size_t>(std::floor(t_s / 1.3 + 10.0))];
    double sum = 20.0;
    for (const auto& [angular, amplitude_deg, phase] : sines_) {
      sum += amplitude_deg * std::sin(angular * t_s + phase);
    }
    return sum;
  }

  bool FrictionInMass() const {
    return kind_ == OtherKind::kLuGre || (kind_ == OtherKind::kDahl && second_);
  }

  /// Change of the friction d for a motion of dx in dt.
  void Rub(double dx) {
    double width = play_deg_;
    if (kind_ == OtherKind::kLuGre) {
      const double speed = dx / kStep_s / stribeck_deg_s_;
      width *= 1.0 + stribeck_ * std::exp(-speed * speed);
    }
    const double stiffness = play_deg_ / stretch_deg_;
    d_ += stiffness * (dx - std::abs(dx) * d_ / width);
  }

  void Friction() {
    if (FrictionInMass()) {
      q_ = limited_;
    } else if (soft_) {
      const double change = limited_ - q_ - d_;  // of v, since v = q + d
      const double direction = change > 0.0 ? 1.0 : -1.0;
      const double slope = (play_deg_ - direction * d_) / stretch_deg_;
      const double dx = change / (1.0 + std::max(slope, 0.0));
      q_ += dx;
      d_ = limited_ - q_;
    } else {
      q_ = std::min(std::max(q_, limited_ - play_deg_), limited_ + play_deg_);
    }
  }

  void Step() {
    v_ = gain_ * Command(t_s_ - dead_s_);
    const double most = limit_deg_s_ * kStep_s;
    const bool limits_command = kind_ == OtherKind::kSpeedLimit && !second_;
    limited_ = limits_command ? std::clamp(v_, limited_ - most, limited_ + most) : v_;
    Friction();
    double target = q_;
    if (kind_ == OtherKind::kThirdOrder) {
      first_ += kStep_s / (lag_s_ / 3.0) * (q_ - first_);
      second_lag_ += kStep_s / (lag_s_ / 3.0) * (first_ - second_lag_);
      z_ += kStep_s / (lag_s_ / 3.0) * (second_lag_ - z_);
      t_s_ += kStep_s;
      return;
    }
    if (FrictionInMass()) target -= d_;
    if (kind_ == OtherKind::kLoad) target -= Load();
    speed_ += kStep_s * omega_ * omega_ * (target - z_ - lag_s_ * speed_);
    if (kind_ == OtherKind::kSpeedLimit && second_) {
      speed_ = std::clamp(speed_, -limit_deg_s_, limit_deg_s_);
    }
    z_ += kStep_s * speed_;
    if (FrictionInMass()) Rub(kStep_s * speed_);
    t_s_ += kStep_s;
  }

  double Load() const {
    return load_deg_ * std::sin((z_ + load_phase_deg_) * std::numbers::pi / 180.0);
  }

  double Output() const { return kind_ == OtherKind::kZero ? z_ + zero_s_ * speed_ : z_; }

  OtherTruth Truth() const {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    OtherTruth truth{.dead_time_ms = 1e3 * dead_s_,
                     .lag_ms = 1e3 * lag_s_,
                     .natural_frequency_hz = omega_ / (2.0 * std::numbers::pi),
                     .damping_ratio = 0.5 * lag_s_ * omega_,
                     .gain = gain_,
                     .offset_deg = offset_deg_,
                     .hysteresis_deg = 2.0 * play_deg_};
    if (kind_ == OtherKind::kThirdOrder) truth.natural_frequency_hz = truth.damping_ratio = kNone;
    if (kind_ == OtherKind::kZero) truth.lag_ms -= 1e3 * zero_s_;
    if (kind_ == OtherKind::kSpeedLimit) truth.speed_limit_deg_s = limit_deg_s_;
    if (kind_ != OtherKind::kLoad) return truth;
    const double angle = (gain_ * 20.0 + load_phase_deg_) * std::numbers::pi / 180.0;
    const double stiffness = 1.0 + load_deg_ * std::cos(angle) * std::numbers::pi / 180.0;
    truth.gain /= stiffness;
    truth.lag_ms /= stiffness;
    truth.hysteresis_deg /= stiffness;
    truth.natural_frequency_hz *= std::sqrt(stiffness);
    truth.damping_ratio /= std::sqrt(stiffness);
    truth.offset_deg = kNone;
    return truth;
  }

  struct Sine {
    double angular;
    double amplitude_deg;
    double phase;
  };

  OtherKind kind_;
  controller::TestNoise random_;
  double dead_s_, lag_s_, omega_, gain_, offset_deg_, noise_deg_, play_deg_, stretch_deg_;
  double stribeck_, stribeck_deg_s_, zero_s_, limit_deg_s_, load_deg_, load_phase_deg_;
  bool second_, soft_, steps_;
  std::array<Sine, 12> sines_{};
  std::array<double, 64> levels_deg_{};
  double t_s_ = 0.0, v_ = 0.0, limited_ = 0.0, q_ = 0.0, d_ = 0.0, z_ = 0.0, speed_ = 0.0;
  double first_ = 0.0, second_lag_ = 0.0;
};

}  // namespace gauntlet::sim
