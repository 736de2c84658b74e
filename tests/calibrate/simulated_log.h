#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

namespace gauntlet::sim::simulated_log {

using Values = std::vector<double>;

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kFine_hz = 1000.0;

/// A motion of a hand at 1000 Hz: reaches to random postures, with rests.
inline Values Reaches(double seconds, std::mt19937& random) {
  std::uniform_real_distribution<double> target(-40.0, 40.0), time(0.4, 1.6), rest(0.0, 1.0);
  Values motion;
  double from = 0.0;
  while (motion.size() < seconds * kFine_hz) {
    const double to = target(random);
    const auto rows = static_cast<int>(time(random) * kFine_hz);
    for (int i = 0; i < rows; ++i) {
      motion.push_back(from + (to - from) * 0.5 * (1.0 - std::cos(kPi * i / rows)));
    }
    motion.insert(motion.end(), static_cast<std::size_t>(rest(random) * kFine_hz), to);
    from = to;
  }
  return motion;
}

/// A servo: dead time, a lag of first order, play, and gravity's offset.
inline Values ServoAnswer(const Values& target, double delay_s, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.2, 0.8), play(0.0, 1.5), offset(-3.0, 3.0);
  const double dead_s = share(random) * delay_s;
  const double alpha = 1.0 - std::exp(-1.0 / (kFine_hz * std::max(delay_s - dead_s, 1e-3)));
  const auto dead = static_cast<std::size_t>(dead_s * kFine_hz);
  const double half = 0.5 * play(random), beside = offset(random);
  double lagged = target.front(), angle = lagged;
  Values answer;
  for (std::size_t n = 0; n < target.size(); ++n) {
    lagged += alpha * (target[n < dead ? 0 : n - dead] - lagged);
    angle = std::clamp(angle, lagged - half, lagged + half);
    answer.push_back(angle + beside);
  }
  return answer;
}

/// A servo with a speed limit: dead time, and a lag of first order below the limit.
inline Values SpeedLimited(const Values& target, double dead_s, double limit_deg_s, double lag_s) {
  const auto dead = static_cast<std::size_t>(dead_s * kFine_hz);
  const double most = limit_deg_s / kFine_hz;
  double angle = target.front();
  Values answer;
  for (std::size_t n = 0; n < target.size(); ++n) {
    const double wanted = target[n < dead ? 0 : n - dead] - angle;
    angle += std::clamp(wanted / (lag_s * kFine_hz), -most, most);
    answer.push_back(angle);
  }
  return answer;
}

inline Values Thinned(const Values& fine, double rate_hz) {
  Values rows;
  for (double at = 0.0; at < static_cast<double>(fine.size()); at += kFine_hz / rate_hz) {
    rows.push_back(fine[static_cast<std::size_t>(at)]);
  }
  return rows;
}

inline Values Measured(Values angle, double noise, double step, std::mt19937& random) {
  std::normal_distribution<double> gauss(0.0, 1.0);
  for (double& value : angle) {
    value += noise * gauss(random);
    if (step > 0.0) value = step * std::round(value / step);
  }
  return angle;
}

inline Values Rounded(Values values, double step) {
  for (double& value : values) value = step * std::round(value / step);
  return values;
}

/// The value `rows` later, the last one at the end.
inline Values Later(const Values& values, int rows) {
  Values later;
  for (int n = 0; n < std::ssize(values); ++n) {
    later.push_back(values[static_cast<std::size_t>(
        std::clamp(n + rows, 0, static_cast<int>(std::ssize(values)) - 1))]);
  }
  return later;
}

inline Values Scaled(Values values, double gain, double offset) {
  for (double& value : values) value = gain * value + offset;
  return values;
}

/// The change to the row after the next `late` ones.
inline Values Changes(const Values& angle, int late) {
  const Values to = Later(angle, late + 1), from = Later(angle, late);
  Values changes;
  for (std::size_t n = 0; n < angle.size(); ++n) changes.push_back(to[n] - from[n]);
  return changes;
}

}  // namespace gauntlet::sim::simulated_log
