#pragma once

#include <span>
#include <vector>

#include "controller/export.h"
#include "controller/linearisation/linearisation_config.h"

namespace gauntlet::controller {

/// A curve from counts to bending angle with how well it fits its data.
struct GAUNTLET_API CurveFit {
  ChannelCurve curve;
  double rms_error_deg = 0.0;
  double largest_error_deg = 0.0;
  /// Half widths of the 95 % confidence interval: of each angle of a table, or of each coefficient
  /// of a polynomial. NaN where there are no more data than unknowns. Those of a table hold for
  /// noise that is correlated, too (see ChannelNoise); those of a polynomial are for white noise.
  std::vector<double> half_width_95_deg;
};

/// A table from samples of known poses: one corner per different angle, at the mean of its counts.
///
/// Counts that were rounded to steps of `resolution_counts` have means with errors up to half a
/// step, times exp(-2 pi^2 variance / step^2): the half widths have it on top.
/// Source: Widrow, Kollar (2008), Quantization Noise.
/// Shapes: one value per sample, in the order of time. Units: counts and deg.
/// Errors: SettingError for fewer than two poses, or counts that do not follow the angle one way.
GAUNTLET_API CurveFit FitTable(std::span<const double> counts, std::span<const double> angle_deg,
                               double resolution_counts = 0.0);

/// The straight line through the poses with the smallest and the largest angle, as a table of two
/// corners. The errors are those over all samples. Errors: as FitTable().
GAUNTLET_API CurveFit FitTwoPoint(std::span<const double> counts, std::span<const double> angle_deg,
                                  double resolution_counts = 0.0);

/// A polynomial by least squares (QR), in u = (counts - center) / scale with u from -1 to 1 over
/// the data.
///
/// Errors: SettingError for a degree that the data cannot determine, or a polynomial that turns
/// back within the data; use a lower degree then.
GAUNTLET_API CurveFit FitPolynomial(std::span<const double> counts,
                                    std::span<const double> angle_deg, int degree);

}  // namespace gauntlet::controller
