#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "controller/prediction/fitted_prediction.h"

namespace gauntlet::controller {

struct PredictorFitOptions {
  std::vector<double> horizon_ms = {100.0};  // one for all channels or one for each
  int order = 40;
  double tap_ms = 5.0;
  /// The fit is made as if the noise had so many times its variance: a larger one trembles less and
  /// gives away some of the delay.
  double caution = 3.0;
  int components = 0;  // below the number of channels
};

struct PredictorFit {
  FittedPredictionConfig predictor;
  // Per channel.
  Eigen::ArrayXd noise_variance;  // [unit^2]
  Eigen::ArrayXd hold_rms;        // of z(k + h) - z(k), noise included [unit]
  Eigen::ArrayXd fit_rms;         // of z(k + h) - y(k), on the data of the fit [unit]
  // The same of each fifth of the data by weights that were fitted to the others; NaN where they
  // determine none. The components are those of all data.
  Eigen::ArrayXd held_out_rms;
};

/// Weights that look ahead by least squares, channel by channel, over recordings of motions like
/// those that will come:
///
///     p_i = z(k - i tap) - z(k),  i = 1 .. order,     t = z(k + h) - z(k)
///     w = (mean of p p' + e r (I + 1 1'))^-1 (mean of p t + e r 1),   e = caution - 1
///
/// r: the variance of white noise, a sixth of the mean square of the second differences of
/// neighbours. What is added is what noise of e times that variance would add by itself. A glove
/// that is slow against the motion has differences of its own there: then the fit is more cautious.
///
/// With components p goes on with the differences of each of them, and the noise that is added is
/// that of what they are sums of. They are the principal components of the changes
/// z(k) - z(k - order tap).
///
/// Without components the weights are the same in counts and in angles, as far as the curve between
/// them is straight. Components add channels up, so they are to be fitted in the unit in which the
/// predictor will see them: angles.
/// Shapes: samples x channels, one matrix per recording.
/// Errors: SettingError for values that are not finite, recordings of other numbers of channels,
/// fewer than ten samples of the fit per weight, and for a channel that does not move at all.
PredictorFit FitPredictor(std::span<const Eigen::MatrixXd> recordings, double rate_hz,
                          const PredictorFitOptions& options);

}  // namespace gauntlet::controller
