#include "controller/filters/kalman_steady_filter.h"

#include <optional>
#include <variant>

#include "controller/filters/check_filter.h"
#include "controller/filters/constant_gain_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/kalman_variances.h"
#include "controller/filters/riccati.h"
#include "controller/filters/steady_gains.h"

namespace gauntlet::controller {
namespace {

/// The gain of one channel. The equation is solved for R = 1, to which every R can be scaled.
Eigen::VectorXd SteadyGain(const ProcessNoiseFactors& f, double q_over_r, int states) {
  Eigen::Matrix3d transition;
  transition << 1.0, 1.0, 0.5, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0;
  Eigen::Matrix3d noise;
  noise << f.q11, f.q12, f.q13, f.q12, f.q22, f.q23, f.q13, f.q23, f.q33;
  const Eigen::MatrixXd h = Eigen::MatrixXd::Identity(1, states);
  const Eigen::MatrixXd r = Eigen::MatrixXd::Identity(1, 1);
  const Eigen::MatrixXd p = SolveRiccati(transition.topLeftCorner(states, states), h,
                                         q_over_r * noise.topLeftCorner(states, states), r);
  return p.col(0) / (p(0, 0) + 1.0);
}

}  // namespace

void KalmanSteadyConfig::Visit(SettingsVisitor& visitor) {
  VisitStart(visitor, start);
  noise.Visit(visitor);
  VisitStates(visitor, states);
}

Eigen::ArrayXXd SteadyGains(const KalmanSteadyConfig& config, int channel_count, double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  const Eigen::ArrayXd r = MeasurementVariance(config.noise, channel_count);
  const Eigen::ArrayXd q = ProcessVariance(config.noise, channel_count);
  if (!(q.minCoeff() > 0.0)) throw SettingError("q", "is 0, must be above 0 for a settled gain");
  const ProcessNoiseFactors factors =
      FactorsOf(config.noise.process_noise, config.states, 1.0 / rate_hz);
  Eigen::ArrayXXd gains(channel_count, config.states);
  for (int i = 0; i < channel_count; ++i) {
    const bool same_as_before = i > 0 && q[i] == q[i - 1] && r[i] == r[i - 1];
    gains.row(i) = same_as_before
                       ? gains.row(i - 1).eval()
                       : SteadyGain(factors, q[i] / r[i], config.states).transpose().array().eval();
  }
  return gains;
}

std::optional<Eigen::ArrayXXd> ConstantGains(const FilterSettings& settings, int channel_count,
                                             double rate_hz) {
  Eigen::ArrayXXd gains = Eigen::ArrayXXd::Zero(channel_count, 3);
  if (const auto* exponential = std::get_if<ExponentialConfig>(&settings)) {
    gains.col(0) = exponential->alpha;
  } else if (const auto* alpha_beta = std::get_if<AlphaBetaConfig>(&settings)) {
    gains.col(0) = alpha_beta->alpha;
    gains.col(1) = alpha_beta->beta;
  } else if (const auto* with_gamma = std::get_if<AlphaBetaGammaConfig>(&settings)) {
    gains.col(0) = with_gamma->alpha;
    gains.col(1) = with_gamma->beta;
    gains.col(2) = 2.0 * with_gamma->gamma;
  } else if (const auto* kalman = std::get_if<KalmanSteadyConfig>(&settings);
             kalman != nullptr && kalman->start == Start::kFirst) {
    gains.leftCols(kalman->states) = SteadyGains(*kalman, channel_count, rate_hz);
  } else if (std::holds_alternative<NoFilterConfig>(settings)) {
    gains.col(0) = 1.0;  // passes its input on
  } else {
    return std::nullopt;
  }
  return gains;
}

std::unique_ptr<Filter> MakeFilter(const KalmanSteadyConfig& config, int channel_count,
                                   double rate_hz) {
  return MakeConstantGainFilter(SteadyGains(config, channel_count, rate_hz), config.start);
}

}  // namespace gauntlet::controller
