#include "controller/prediction/predictor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "controller/filters/end_point_fit.h"
#include "controller/filters/kalman_steady_filter.h"
#include "controller/filters/recursive_filter.h"
#include "controller/filters/sample_window.h"
#include "controller/filters/vectorise.h"

namespace gauntlet::controller {
namespace {

/// z(k) + steps slope: zero steps, or a window that is not full yet, pass samples through.
class LinearPredictor final : public Filter {
 public:
  LinearPredictor(int window, double horizon_steps, int channel_count)
      : weights_(horizon_steps * EndPointWeights(window, 1, 1)),
        window_(window, channel_count),
        ahead_(static_cast<std::size_t>(channel_count)) {
    weights_[0] += 1.0;
  }

  int channel_count() const noexcept override { return window_.channel_count(); }
  void Step(std::span<const double> input, std::span<double> output) noexcept override {
    window_.Push(input);
    WeightedSum(window_, weights_, ahead_.data());
    if (!window_.all_full()) {
      const double* newest = window_.Row(0);
      for (int i = 0; i < channel_count(); ++i) {
        if (window_.count(i) < window_.length()) ahead_[static_cast<std::size_t>(i)] = newest[i];
      }
    }
    std::copy(ahead_.begin(), ahead_.end(), output.begin());
  }
  void Reset() noexcept override { window_.Reset(); }
  void ResetChannel(int channel) noexcept override { window_.ResetChannel(channel); }
  bool CopyChannel(const Filter& from, int channel) noexcept override {
    const auto* other = dynamic_cast<const LinearPredictor*>(&from);
    if (other == nullptr || other->window_.length() != window_.length()) return false;
    window_.CopyChannel(other->window_, channel);
    return true;
  }

 private:
  Eigen::ArrayXd weights_;
  SampleWindow window_;
  std::vector<double> ahead_;
};

struct Parameters {
  double k1, k2;  // gains on position and velocity per step
  double horizon_steps;
};

GAUNTLET_VECTORISED void LookAhead(double* x, double* v, Parameters p, const double* z,
                                   double* output, int channel_count) {
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double prior = x[i] + v[i];
    const double innovation = z[i] - prior;
    const double position = prior + p.k1 * innovation;
    const double velocity = v[i] + p.k2 * innovation;
    x[i] = position;
    v[i] = velocity;
    output[i] = position + p.horizon_steps * velocity;
  }
}

class KalmanPredictor final : public RecursiveFilter {
 public:
  KalmanPredictor(Parameters parameters, int channel_count)
      : RecursiveFilter(2, channel_count), parameters_(parameters) {}

 private:
  void StepAll(const double* input, double* output) noexcept override {
    LookAhead(state(0), state(1), parameters_, input, output, channel_count());
  }
  void SettleAt(int channel, double value) noexcept override { state(0)[channel] = value; }

  Parameters parameters_;
};

}  // namespace

void PredictionConfig::Visit(SettingsVisitor& visitor) {
  static constexpr std::array<std::string_view, 3> kNames = {"none", "linear", "kalman"};
  VisitEnum(
      visitor,
      {.key = "kind",
       .help = "none; linear: along the slope of the last samples; kalman: along the velocity "
               "of a Kalman filter with white acceleration"},
      kNames, kind);
  visitor.Number({.key = "horizon_ms", .help = "how far to look ahead", .min = 0, .max = 1000},
                 horizon_ms);
  visitor.Number({.key = "window_ms",
                  .help = "samples from which the slope is taken (kind: linear)",
                  .min = 1,
                  .max = 1e4},
                 window_ms);
  visitor.Number({.key = "q_deg2_per_s3",
                  .help = "density of the white acceleration (kind: kalman)",
                  .min = 0,
                  .max = 1e12,
                  .open_range = true},
                 q_deg2_per_s3);
  visitor.Number({.key = "r_deg2",
                  .help = "variance of the noise that is still in the angle (kind: kalman)",
                  .min = 0,
                  .max = 1e6,
                  .open_range = true},
                 r_deg2);
}

std::unique_ptr<Filter> MakePredictor(const PredictionConfig& config, int channel_count,
                                      double rate_hz) {
  CheckSettings(config);
  const double horizon_steps = config.horizon_ms * 1e-3 * rate_hz;
  switch (config.kind) {
    case PredictionKind::kLinear: {
      const int window = static_cast<int>(std::lround(config.window_ms * 1e-3 * rate_hz));
      if (window < 2) {
        throw SettingError("window_ms", "must hold at least two steps of the filter, " +
                                            NumberText(2e3 / rate_hz) + " ms");
      }
      return std::make_unique<LinearPredictor>(window, horizon_steps, channel_count);
    }
    case PredictionKind::kKalman: {
      // Only the ratio of q to r matters, so degrees may stay.
      const KalmanSteadyConfig model = {.noise = {.r = {config.r_deg2},
                                                  .q = {config.q_deg2_per_s3},
                                                  .process_noise = ProcessNoise::kWhite}};
      const Eigen::ArrayXXd gains = SteadyGains(model, 1, rate_hz);
      return std::make_unique<KalmanPredictor>(Parameters{gains(0, 0), gains(0, 1), horizon_steps},
                                               channel_count);
    }
    case PredictionKind::kNone:
      break;
  }
  return nullptr;
}

}  // namespace gauntlet::controller
