#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// The step in which curves are kept in a page: below what a screen can show of a joint angle.
inline constexpr double kCurveStepDeg = 0.005;

/// How many points all curves of a page may have together. At about 2 bytes a point, text included,
/// a page of that many stays below 10 MB: phones open it, and mail takes it.
inline constexpr std::int64_t kCurvePoints = 3'200'000;

/// How many samples one bucket must hold so that `curves` curves of `samples` samples fit in
/// kCurvePoints with two points a bucket. 1: every sample fits as it is.
int SamplesPerBucket(std::int64_t samples, std::int64_t curves);

/// Fewer points without a lost peak: of every bucket its smallest and its largest value, in the
/// order in which they came. With 1 sample per bucket, the values themselves. A bucket without a
/// finite value gives NaN twice.
/// Shapes: 2 ceil(values / samples_per_bucket).
std::vector<double> KeepPeaks(std::span<const double> values, int samples_per_bucket);

/// A curve as text: differences of successive values in whole steps, zigzag, one added, as
/// little-endian groups of 7 bits, in base64. 0 is a value that is missing (NaN), and is passed
/// over by the differences. Rounding does not add up: it is at most half a step everywhere.
std::string EncodeCurve(std::span<const double> values, double step);

}  // namespace gauntlet::sim
