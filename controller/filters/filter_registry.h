#pragma once

#include <memory>
#include <span>
#include <string>

#include "controller/export.h"
#include "controller/filters/filter.h"
#include "controller/filters/filter_config.h"

namespace gauntlet::controller {

/// Errors: SettingError for a setting that is not allowed or does not fit the number of channels,
/// and for channels that there are not.
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const FilterConfig& config,
                                                std::span<const std::string> channel_names,
                                                double rate_hz);
/// Filter for channels that have only numbers. Errors: as above.
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const FilterConfig& config, int channel_count,
                                                double rate_hz);

// Filter of each kind.
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const NoFilterConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const MovingAverageConfig& config,
                                                int channel_count, double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const MedianConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const HampelConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const ExponentialConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const ButterworthConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const SavitzkyGolayConfig& config,
                                                int channel_count, double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const OneEuroConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const JerkLimitConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const AlphaBetaConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const AlphaBetaGammaConfig& config,
                                                int channel_count, double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const KalmanConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const KalmanSteadyConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const KalmanAdaptiveConfig& config,
                                                int channel_count, double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const KalmanDenseConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const FixedLagConfig& config, int channel_count,
                                                double rate_hz);
GAUNTLET_API std::unique_ptr<Filter> MakeFilter(const ExternalConfig& config, int channel_count,
                                                double rate_hz);

/// Makes the filters of a caller, from outside this library.
class GAUNTLET_API FilterMaker {
 public:
  virtual ~FilterMaker() = default;
  /// `channel_names`: those that it filters, as many as the filter has channels.
  /// Errors: SettingError.
  virtual std::unique_ptr<Filter> Make(const ExternalConfig& config,
                                       std::span<const std::string> channel_names,
                                       double rate_hz) const = 0;
};

/// A Kalman filter that also takes the acceleration input u of the paper's model.
class GAUNTLET_API KalmanFilter : public Filter {
 public:
  /// As Step(), with the acceleration of every channel since the last sample
  /// [unit of the input / step^2].
  void StepWithAcceleration(std::span<const double> input, std::span<const double> acceleration,
                            std::span<double> output) noexcept {
    if (Fits(input.size()) && Fits(acceleration.size()) && Fits(output.size())) {
      StepWithAccelerationChecked(input, acceleration, output);
    }
  }
  /// The state behind the last sample: the velocity [unit / step] of one channel.
  virtual double velocity(int channel) const noexcept = 0;

 protected:
  using Filter::Filter;

 private:
  virtual void StepWithAccelerationChecked(std::span<const double> input,
                                           std::span<const double> acceleration,
                                           std::span<double> output) noexcept = 0;
};
GAUNTLET_API std::unique_ptr<KalmanFilter> MakeKalmanFilter(const KalmanConfig& config,
                                                            int channel_count, double rate_hz);

/// The filter, with what it has learned.
class GAUNTLET_API KalmanAdaptiveFilter : public Filter {
 public:
  virtual double r(int channel) const noexcept = 0;
  virtual double q(int channel) const noexcept = 0;

 protected:
  using Filter::Filter;
};
GAUNTLET_API std::unique_ptr<KalmanAdaptiveFilter> MakeKalmanAdaptiveFilter(
    const KalmanAdaptiveConfig& config, int channel_count, double rate_hz);

}  // namespace gauntlet::controller
