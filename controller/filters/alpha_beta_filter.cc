#include "controller/filters/alpha_beta_filter.h"

#include "controller/filters/check_filter.h"
#include "controller/filters/constant_gain_filter.h"
#include "controller/filters/filter_registry.h"

namespace gauntlet::controller {
namespace {

void VisitGain(SettingsVisitor& visitor, std::string_view key, std::string_view help, double max,
               double& value) {
  visitor.Number({.key = key, .help = help, .min = 0, .max = max, .open_range = true}, value);
}

}  // namespace

void AlphaBetaConfig::Visit(SettingsVisitor& visitor) {
  VisitGain(visitor, "alpha", "gain on the position; 2 alpha + beta must stay below 4", 2, alpha);
  VisitGain(visitor, "beta", "gain on the velocity per sample", 4, beta);
}

void AlphaBetaGammaConfig::Visit(SettingsVisitor& visitor) {
  VisitGain(visitor, "alpha", "gain on the position; 2 alpha + beta must stay below 4", 2, alpha);
  VisitGain(visitor, "beta", "gain on the velocity per sample", 4, beta);
  VisitGain(visitor, "gamma",
            "half the gain on the acceleration per sample squared; must stay below "
            "alpha beta / (2 - alpha)",
            8, gamma);
}

std::unique_ptr<Filter> MakeFilter(const AlphaBetaConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  if (!(2.0 * config.alpha + config.beta < 4.0)) {
    throw SettingError("beta", "must be below 4 - 2 alpha, or the filter is not stable");
  }
  Eigen::ArrayXXd gains(channel_count, 2);
  gains.col(0) = config.alpha;
  gains.col(1) = config.beta;
  return MakeConstantGainFilter(gains, Start::kFirst);
}

std::unique_ptr<Filter> MakeFilter(const AlphaBetaGammaConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  if (!(2.0 * config.alpha + config.beta < 4.0)) {
    throw SettingError("beta", "must be below 4 - 2 alpha, or the filter is not stable");
  }
  // Jury's criterion of the poles of (I - K H) A.
  if (!(config.gamma < config.alpha * config.beta / (2.0 - config.alpha))) {
    throw SettingError("gamma",
                       "must be below alpha beta / (2 - alpha), or the filter is not stable");
  }
  Eigen::ArrayXXd gains(channel_count, 3);
  gains.col(0) = config.alpha;
  gains.col(1) = config.beta;
  gains.col(2) = 2.0 * config.gamma;
  return MakeConstantGainFilter(gains, Start::kFirst);
}

}  // namespace gauntlet::controller
