#pragma once

#include <span>

#include "controller/number.h"

namespace gauntlet::sim {

/// A mean and the interval that holds the true mean with the confidence `level`. NaN where there
/// are too few values.
struct MeanInterval {
  double mean = controller::kNaN;
  double low = controller::kNaN;
  double high = controller::kNaN;
  int count = 0;  // of the values, or pairs, that it is made of; of two groups both together
  double level = 0.95;
  /// Share of the variance of a single value that comes from the motion, see EstimateMean(). The
  /// rest comes from noise. NaN: the two are not separable.
  double motion_share = controller::kNaN;
  double degrees_of_freedom = controller::kNaN;  // of the interval; NaN: not known
};

/// A mean before its interval has a level.
struct MeanEstimate {
  double mean = controller::kNaN;
  double standard_error = controller::kNaN;  // NaN: too few values
  double degrees_of_freedom = 0.0;
  int count = 0;
  double motion_share = controller::kNaN;  // as of a MeanInterval

  /// mean -+ t(level) standard_error. One value has no interval, equal values have one of no width.
  MeanInterval IntervalAt(double level = 0.95) const;
};

/// The mean of values of which those with the same number in `motions` share a motion of the wearer
/// and differ by noise alone. Values that are not finite do not count.
///
/// With values of one motion (or `motions` left out) the values are the replicates:
///
///     error = s / sqrt(n), n - 1 degrees of freedom
///
/// and the interval tells of noise alone. With several motions these are the replicates, not the
/// seeds on each of them: the mean, too, is that of the G means of the motions, each with the same
/// weight however many values it has,
///
///     mean = sum(m_g) / G,   error = s(m_g) / sqrt(G),   G - 1 degrees of freedom
///
/// If some motions have several values, the shares of the variance are those of the analysis of
/// variance in one way with random effects: MSW and MSB the mean squares within and between,
/// n_0 = (N - sum(n_g^2) / N) / (G - 1),
///
///     motion = max(0, (MSB - MSW) / n_0),   noise = MSW
///
/// Student's t and no bootstrap: 2,000 resamples do not reach the levels of many comparisons.
/// Coverage and false verdicts: docs/evidence/judgements.md.
/// Shapes: `motions` empty or as long as `values`.
/// Source: Searle, Casella, McCulloch 1992, Variance Components, section 3.6.
MeanEstimate EstimateMean(std::span<const double> values, std::span<const int> motions = {});

/// Mean of first - second, value by value: pairs share their seed, and with it the glove signal and
/// the hand, so what a seed makes hard for both cancels.
/// Shapes: the same length.
MeanEstimate EstimateDifference(std::span<const double> first, std::span<const double> second,
                                std::span<const int> motions = {});

/// Difference of the means of two groups that share no seeds, first - second, by Welch's t:
///
///     error^2 = s1^2 / n1 + s2^2 / n2
///
/// with error^4 / ((s1^2 / n1)^2 / (n1 - 1) + (s2^2 / n2)^2 / (n2 - 1)) degrees of freedom. No
/// interval where a group has one value. Source: Welch 1947, doi 10.1093/biomet/34.1-2.28.
MeanEstimate EstimateUnpairedDifference(std::span<const double> first,
                                        std::span<const double> second);

/// Effect size of a paired difference: Cohen's d_z = mean(d) / s(d), d = first -
/// second. 0.2 counts as small, 0.5 as medium, 0.8 as large. NaN below two pairs or without
/// scatter. Source: Cohen 1988, section 2.3.5; Lakens 2013, doi 10.3389/fpsyg.2013.00863.
double PairedEffectSize(std::span<const double> first, std::span<const double> second);

/// Relative frequency of an event, and the interval that contains the true share with at least 95
/// %.
struct Share {
  int hits = 0;
  int count = 0;
  double low = 0.0;
  double high = 1.0;

  double value() const { return count > 0 ? static_cast<double>(hits) / count : 0.0; }
};

/// Exact interval for independent draws: at `low` so many hits or more have a chance of 2.5 %, at
/// `high` so many or fewer. Source: Clopper, Pearson 1934, doi 10.1093/biomet/26.4.404.
Share EstimateShare(int hits, int count);

}  // namespace gauntlet::sim
