#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "controller/prediction/fitted_prediction.h"
#include "controller/prediction/fitted_to_others_prediction.h"

namespace gauntlet::controller {

/// A fitted prediction and its errors. z is the signal, y its prediction, h the horizon.
struct PredictorFit {
  FittedPredictionConfig predictor;
  // Per channel.
  Eigen::ArrayXd noise_variance;  // [unit^2]
  Eigen::ArrayXd hold_rms;        // of z(k + h) - z(k), noise included [unit]
  Eigen::ArrayXd fit_rms;         // of z(k + h) - y(k), on the data of the fit [unit]
  // As fit_rms, of each fifth of the data by weights that were fitted to the others; NaN where they
  // determine none.
  Eigen::ArrayXd held_out_rms;
};

/// How far off a prediction is, per channel, where all of its past and the future are known.
struct PredictionErrors {
  Eigen::ArrayXd hold_rms;  // of z(k + h) - z(k) [unit]
  Eigen::ArrayXd left_rms;  // of z(k + h) - y(k) [unit]
};

/// A motion in stretches, samples x channels each, across whose ends nothing is foreseen.
using RecordedMotion = std::vector<Eigen::MatrixXd>;

/// Weights that look ahead by least squares, channel by channel, over recordings of motions like
/// those that will come, at one sample in each tap:
///
///     p = (m_i(k) - z(k), i = 1 .. order, and positions, slopes and 1 as they are looked at)
///     t = z(k + h) - z(k)
///     w = (mean of p p' + e N)^-1 (mean of p t + e n),   e = caution - 1
///
/// m_i: see FittedPredictionConfig, with means over taps. N and n are what white noise of each
/// channel would add to both means; its variance r is a sixth of the mean square of the second
/// differences of neighbours. A glove that is slow against the motion has differences of its own
/// there: then the fit is more cautious.
///
/// Without `offset` the weights are the same in counts and in angles, as far as the curve between
/// them is straight. With it they are to be fitted to angles [deg].
/// Errors: SettingError for values that are not finite, recordings of other numbers of channels,
/// fewer than ten samples of the fit per weight, and for a channel that does not move at all.
PredictorFit FitPredictor(std::span<const Eigen::MatrixXd> recordings, double rate_hz,
                          const FittedToOthersPredictionConfig& wanted);

/// Errors of the weights, without their fallback, on recordings, perhaps others than those of the
/// fit: samples x channels, in its unit.
/// Errors: SettingError for recordings of other numbers of channels, or that are too short.
PredictionErrors JudgePredictor(const FittedPredictionConfig& predictor,
                                std::span<const Eigen::MatrixXd> recordings, double rate_hz);

/// For each motion such weights, fitted to all the others. Errors: the same.
std::vector<FittedPredictionConfig> FitPredictorsToOthers(
    std::span<const RecordedMotion> motions, double rate_hz,
    const FittedToOthersPredictionConfig& wanted);

}  // namespace gauntlet::controller
