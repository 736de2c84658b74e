#include "sim/glove/motions/recorded_reference.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

constexpr double kSearchRate_hz = 100.0;  // hands move below 10 Hz
constexpr double kLargestOffset_s = 10.0;
constexpr double kLongestCompared_s = 60.0;
constexpr double kLeastCorrelation = 0.5;

/// Common channels at the search's rate, from start_s on, a column each.
Eigen::MatrixXd Sampled(const Recording& recording, const std::vector<Eigen::Index>& channels,
                        double start_s, Eigen::Index samples) {
  Eigen::MatrixXd values(samples, std::ssize(channels));
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const std::vector<double> column =
        Resample(recording, channels[i], start_s, kSearchRate_hz, samples, 1.0).value;
    values.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::VectorXd>(column.data(), samples);
  }
  return values;
}

}  // namespace

double FindReferenceOffset(const Recording& recording, const Recording& reference,
                           const PlayedStretch& stretch) {
  std::vector<Eigen::Index> common;
  for (std::size_t c = 0; c < recording.has_channel.size(); ++c) {
    if (recording.has_channel[c] && reference.has_channel[c]) {
      common.push_back(static_cast<Eigen::Index>(c));
    }
  }
  if (common.empty()) {
    throw UserError({.place = reference.name,
                     .problem = "has no channel of the recording: no offset can be found"});
  }
  const double length_s = static_cast<double>(stretch.ticks) / stretch.rate_hz;
  const auto compared =
      static_cast<Eigen::Index>(std::min(length_s, kLongestCompared_s) * kSearchRate_hz);
  const auto bound = static_cast<Eigen::Index>(kLargestOffset_s * kSearchRate_hz);
  const Eigen::MatrixXd x = Sampled(recording, common, stretch.start_s, compared);
  const Eigen::MatrixXd y =
      Sampled(reference, common, stretch.start_s - kLargestOffset_s, compared + 2 * bound);
  const Eigen::MatrixXd centred = x.rowwise() - x.colwise().mean();
  std::vector<double> correlations;
  for (Eigen::Index lag = 0; lag <= 2 * bound; ++lag) {
    const auto part = y.middleRows(lag, compared);
    const Eigen::MatrixXd other = part.rowwise() - part.colwise().mean();
    const double size = std::sqrt(centred.squaredNorm() * other.squaredNorm());
    correlations.push_back(size > 0.0 ? centred.cwiseProduct(other).sum() / size : 0.0);
  }
  const auto peak = std::ranges::max_element(correlations);
  if (!(*peak > kLeastCorrelation) || peak == correlations.begin() ||
      peak + 1 == correlations.end()) {
    throw UserError({.place = reference.name,
                     .problem = fmt::format("no offset to the recording within {:g} s can be found "
                                            "(largest correlation {:.2f}); give reference_offset_s",
                                            kLargestOffset_s, *peak)});
  }
  const double curvature = peak[-1] - 2.0 * peak[0] + peak[1];
  const double beside = curvature < 0.0 ? 0.5 * (peak[-1] - peak[1]) / curvature : 0.0;
  const auto lag = static_cast<double>(peak - correlations.begin() - bound);
  return (lag + beside) / kSearchRate_hz;
}

void CheckReferenceCovers(const Recording& reference, const PlayedStretch& stretch, double gap_s) {
  const double end_s = stretch.start_s + static_cast<double>(stretch.ticks - 1) / stretch.rate_hz;
  if (reference.time_s.front() <= stretch.start_s + gap_s &&
      reference.time_s.back() >= end_s - gap_s) {
    return;
  }
  throw UserError(
      {.place = reference.name,
       .problem = fmt::format(
           "the reference has {:.3f} to {:.3f} s, the recording's stretch needs {:.3f} to {:.3f} s "
           "of it: give start_s and duration_s, or reference_offset_s",
           reference.time_s.front(), reference.time_s.back(), stretch.start_s, end_s)});
}

}  // namespace gauntlet::sim
