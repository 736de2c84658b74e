#pragma once

#include <span>
#include <vector>

namespace gauntlet::sim {

/// Integrated autocorrelation time of stationary series, in samples:
///
///     T = 1 + 2 sum_k r(k),   r(k) = sum over series of c(k) / sum over series of c(0)
///
/// so that the mean of n samples scatters as that of n / T independent ones. c is the sample
/// autocovariance: of several series those with the most scatter count most, so they need one
/// common unit. The sum takes pairs r(2 m) + r(2 m + 1) until the first that is not positive: under
/// white noise a slow part counts, too. m pairs on n samples have a bias by their common mean,
/// which the factor 1 + 2 m / n corrects. At least 1; 1 of equal values.
/// Shapes: series of the same length.
/// Sources: Geyer 1992, doi 10.1214/ss/1177011137 (initial positive sequence); Wolff 2004, doi
/// 10.1016/S0010-4655(03)00467-3, equation 49 (bias).
double AutocorrelationTime(std::span<const std::vector<double>> series);

/// Width of the bins over which a series is averaged before its autocorrelation time [s]. White
/// noise is then small against slow parts.
inline constexpr double kCorrelationBin_s = 1.0;

/// Division of a recording into consecutive blocks of equal length, which stand for replicates.
struct BlockPlan {
  int count = 0;  // of the blocks; 0: the recording is too short for a statement about chance
  double length_s = 0.0;
  double correlation_s = 0.0;  // the time that was given
  double needed_s = 0.0;       // the shortest recording with this correlation that has blocks

  /// Factor for the deviations of block values. Neighbouring blocks share what is correlated over
  /// their border, so the variance between blocks of length L is too small by 1 - T / (2 L).
  double Widening() const;
};

/// The fewest blocks of a single recording.
inline constexpr int kFewestBlocks = 8;

/// The plan for a recording: at most 16 blocks, each at least 5 s and 4 correlation times long.
/// If that leaves fewer than `fewest`, there are so many if each has 2 correlation times; else
/// none. Coverage: docs/evidence/measurements.md, blocks of a recording. Units: s.
BlockPlan PlanBlocks(double duration_s, double correlation_s, int fewest = kFewestBlocks);

/// Values of blocks whose mean is the score of the whole recording and whose standard error that of
/// the jackknife, which leaves out a block at a time:
///
///     v_i = whole + (B - 1) widening (mean_j(without_j) - without_i)
///
/// A score need not be a mean over time for that: a root of a mean square or a delay has values,
/// too. Shapes: `without` one score per block. NaN if one of them is.
/// Source: Kuensch 1989, doi 10.1214/aos/1176347265, for blocks side by side.
std::vector<double> BlockValues(double whole, std::span<const double> without, double widening);

}  // namespace gauntlet::sim
