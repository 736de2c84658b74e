#pragma once

#include <Eigen/Core>
#include <span>

#include "controller/filters/sample_window.h"

namespace gauntlet::controller {

/// Weights h with  sum over ages j of h(j) z(k-j)  = value (or derivative) at the newest sample of
/// the polynomial of degree `order` that fits the last `window` samples best (least squares).
///
/// Source: Savitzky, Golay, Analytical Chemistry 36 (1964), with the end point instead of the
/// middle. Units: derivatives are per sample. Shapes: `window` weights, the newest sample first.
Eigen::ArrayXd EndPointWeights(int window, int order, int derivative = 0);

/// Applies such weights to the window of every channel, oldest and newest in the same order
/// whatever the window's inner position, so that the same samples give the same bits.
void WeightedSum(const SampleWindow& window, const Eigen::ArrayXd& weights, double* sum) noexcept;

}  // namespace gauntlet::controller
