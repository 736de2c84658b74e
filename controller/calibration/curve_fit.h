#pragma once

#include <Eigen/Core>
#include <vector>

#include "controller/linearisation/linearisation_config.h"

namespace gauntlet::controller {

/// A curve from counts to bending angle with how well it fits its data.
struct CurveFit {
  ChannelCurve curve;
  double rms_error_deg = 0.0;
  double largest_error_deg = 0.0;
  /// Half widths of the 95 % confidence interval: of each angle of a table, or of each coefficient
  /// of a polynomial. NaN where there are no more data than unknowns.
  std::vector<double> half_width_95_deg;
};

/// A table from samples of known poses: one corner per different angle, at the mean of its counts.
///
/// Shapes: one value per sample. Units: counts and deg.
/// Errors: SettingError for fewer than two poses, or counts that do not follow the angle one way.
CurveFit FitTable(const Eigen::VectorXd& counts, const Eigen::VectorXd& angle_deg);

/// The straight line through the poses with the smallest and the largest angle, as a table of two
/// corners. The errors are those over all samples. Errors: as FitTable().
CurveFit FitTwoPoint(const Eigen::VectorXd& counts, const Eigen::VectorXd& angle_deg);

/// A polynomial by least squares (QR), in u = (counts - center) / scale with u from -1 to 1 over
/// the data.
///
/// Errors: SettingError for a degree that the data cannot determine, or a polynomial that turns
/// back within the data; use a lower degree then.
CurveFit FitPolynomial(const Eigen::VectorXd& counts, const Eigen::VectorXd& angle_deg, int degree);

}  // namespace gauntlet::controller
