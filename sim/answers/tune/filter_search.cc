#include "sim/answers/tune/filter_search.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>

#include "controller/number.h"

namespace gauntlet::sim {
namespace {

constexpr double kLongest_s = 0.4;  // of smoothing: more delay than is useful

SweepAxis Range(const char* key, double low, double high, SweepAxis::Spacing spacing,
                bool whole = false) {
  SweepAxis axis;
  axis.key = key;
  const auto rounded = [](double value) {
    return controller::ParseNumber(fmt::format("{:.3g}", value)).value();
  };
  axis.low = rounded(low);
  axis.high = rounded(high);
  axis.spacing = spacing;
  axis.whole = whole;
  axis.digits = axis.FewDigits();
  return axis;
}
SweepAxis Log(const char* key, double low, double high) {
  return Range(key, low, high, SweepAxis::Spacing::kLog);
}
SweepAxis Whole(const char* key, double low, double high) {
  return Range(key, low, high, SweepAxis::Spacing::kLinear, true);
}
/// Numbers of samples.
SweepAxis Window(double low, double longest_s, const FilterInput& input) {
  const double high = std::max(low + 1.0, std::round(longest_s * input.rate_hz));
  return Range("window", low, high, SweepAxis::Spacing::kLog, true);
}
/// The gain of a first-order low pass with this time constant.
double GainOf(double tau_s, const FilterInput& input) {
  return 1.0 / (1.0 + tau_s * input.rate_hz);
}
/// A Kalman filter is decided by q / r. With Q = q I a step q = 10 r follows every sample, and
/// q = 1e-8 r averages over about 100 of them; slower rates need less.
SweepAxis ProcessVariance(const std::vector<double>& r) {
  const double mean = Eigen::Map<const Eigen::ArrayXd>(r.data(), std::ssize(r)).mean();
  return Log("q", 1e-8 * mean, 10.0 * mean);
}

FilterSearch SearchOf(const controller::NoFilterConfig&, const FilterInput&) { return {}; }
FilterSearch SearchOf(const controller::MovingAverageConfig&, const FilterInput& input) {
  return {{Window(1, kLongest_s, input)}};
}
FilterSearch SearchOf(const controller::MedianConfig&, const FilterInput& input) {
  return {{Window(1, kLongest_s, input)}};
}
FilterSearch SearchOf(const controller::HampelConfig&, const FilterInput& input) {
  return {{Window(3, kLongest_s, input),
           Range("threshold_sigma", 0.0, 6.0, SweepAxis::Spacing::kLinear)}};
}
FilterSearch SearchOf(const controller::ExponentialConfig&, const FilterInput& input) {
  return {{Log("alpha", GainOf(kLongest_s, input), 1.0)}};
}
FilterSearch SearchOf(const controller::ButterworthConfig&, const FilterInput& input) {
  return {{Log("cutoff_hz", 0.5, 0.45 * input.rate_hz), Whole("order", 1, 4)}};
}
FilterSearch SearchOf(const controller::SavitzkyGolayConfig&, const FilterInput& input) {
  return {{Window(5, 2.0 * kLongest_s, input), Whole("order", 0, 3)}};
}
FilterSearch SearchOf(const controller::OneEuroConfig&, const FilterInput& input) {
  // With a finger at 5 rad/s the cutoff opens by 0.005 to 50 Hz.
  return {{Log("min_cutoff_hz", 0.1, 0.45 * input.rate_hz),
           Log("beta", 1e-3 / input.unit_per_rad, 10.0 / input.unit_per_rad)}};
}
FilterSearch SearchOf(const controller::JerkLimitConfig&, const FilterInput& input) {
  // From a hand of 200 deg/s^2 that takes 0.2 s to reach it [rad/s^2, rad/s^3], to one that follows
  // every sample.
  constexpr double kLeastAcceleration = 3.5;
  constexpr double kLeastJerk = 17.0;
  const double most = input.unit_per_rad * input.rate_hz * input.rate_hz;
  return {{Log("max_acceleration_per_s2", kLeastAcceleration * input.unit_per_rad, most),
           Log("max_jerk_per_s3", kLeastJerk * input.unit_per_rad, most * input.rate_hz)}};
}
FilterSearch SearchOf(const controller::AlphaBetaConfig&, const FilterInput& input) {
  const double least = GainOf(kLongest_s, input);
  return {{Log("alpha", least, 1.0), Log("beta", 0.1 * least * least, 1.0)}};
}
FilterSearch SearchOf(const controller::AlphaBetaGammaConfig&, const FilterInput& input) {
  const double least = GainOf(kLongest_s, input);
  return {{Log("alpha", least, 1.0), Log("beta", 0.1 * least * least, 0.5),
           Log("gamma", 0.001 * least * least * least, 0.1)}};
}
FilterSearch SearchOf(const controller::KalmanConfig& config, const FilterInput&) {
  return {{ProcessVariance(config.noise.r)}};
}
FilterSearch SearchOf(const controller::KalmanSteadyConfig& config, const FilterInput&) {
  return {{ProcessVariance(config.noise.r), Whole("states", 2, 3)}};
}
FilterSearch SearchOf(const controller::KalmanAdaptiveConfig& config, const FilterInput& input) {
  return {{ProcessVariance(config.noise.r), Log("range", 1.0, 1e6),
           Log("memory", std::max(2.0, 0.1 * input.rate_hz), std::max(4.0, 10.0 * input.rate_hz))}};
}
FilterSearch SearchOf(const controller::KalmanDenseConfig&, const FilterInput&) {
  return {{},
          "gives what kalman gives, at hundreds of times the cost, where channels share nothing"};
}
FilterSearch SearchOf(const controller::FixedLagConfig& config, const FilterInput& input) {
  const double longest = std::min(1000.0, std::round(0.5 * kLongest_s * input.rate_hz));
  return {{ProcessVariance(config.noise.r), Whole("lag", 0, std::max(1.0, longest))}};
}
FilterSearch SearchOf(const controller::ExternalConfig&, const FilterInput&) {
  return {{}, "is a program: name the range of one of its parameters"};
}

}  // namespace

FilterSearch SearchOf(const controller::FilterConfig& filter, const FilterInput& input) {
  return std::visit([&input](const auto& config) { return SearchOf(config, input); },
                    filter.settings);
}

}  // namespace gauntlet::sim
