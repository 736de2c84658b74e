#include "sim/score/score.h"

#include <cmath>
#include <stdexcept>

#include "sim/score/channel_scores.h"
#include "sim/score/delay.h"
#include "sim/score/fourier.h"
#include "sim/score/jitter.h"
#include "sim/score/tracking.h"

namespace gauntlet::sim {
namespace {

template <class Matrix>
auto Column(const Matrix& signal, int column, int rows) {
  return std::span(signal.col(column).data(), static_cast<std::size_t>(rows));
}

void CheckShapes(const ScoreInput& input) {
  if (input.reference_angle_rad == nullptr || input.hand_angle_rad == nullptr) {
    throw std::invalid_argument("ComputeScores: reference and hand angles are needed");
  }
  const Signal& hand = *input.hand_angle_rad;
  const Signal& reference = *input.reference_angle_rad;
  if (hand.cols() != reference.cols() || hand.rows() > reference.rows()) {
    throw std::invalid_argument("ComputeScores: the reference has another shape than the hand");
  }
  const IntegerSignal* command = input.command_counts;
  if (command != nullptr && (command->rows() < hand.rows() || command->cols() != hand.cols())) {
    throw std::invalid_argument("ComputeScores: the command has another shape than the hand");
  }
}

/// How near the hand is to the wearer, with and without its delay.
void ScoreTracking(const ScoreInput& input, int channel, Fourier& fourier, ChannelScores& scores) {
  const int rows = static_cast<int>(input.hand_angle_rad->rows());
  const auto reference = Column(*input.reference_angle_rad, channel, rows);
  const auto hand = Column(*input.hand_angle_rad, channel, rows);
  scores.tracking_rmse_deg = kDegPerRad * RmsDifference(reference, hand);
  scores.peak_error_deg = kDegPerRad * PeakDifference(reference, hand);
  scores.aligned_rmse_deg = scores.tracking_rmse_deg;
  if (const auto delay = DelaySamples(reference, hand, input.rate_hz, fourier)) {
    scores.delay_ms = 1000.0 * *delay / input.rate_hz;
    scores.aligned_rmse_deg = kDegPerRad * AlignedRms(reference, hand, *delay);
  }
}

/// Mean over the values that exist.
double Mean(const std::vector<std::vector<double>>& channels, std::size_t metric) {
  double sum = 0.0;
  int count = 0;
  for (const auto& values : channels) {
    if (!std::isfinite(values[metric])) continue;
    sum += values[metric];
    ++count;
  }
  return count == 0 ? kNoScore : sum / count;
}

}  // namespace

Scores ComputeScores(const ScoreInput& input) {
  CheckShapes(input);
  const int rows = static_cast<int>(input.hand_angle_rad->rows());
  const int channels = static_cast<int>(input.hand_angle_rad->cols());
  const std::size_t metrics = Metrics().size();

  Fourier fourier;
  const Trembling trembling = HighPass(*input.hand_angle_rad, input.rate_hz, fourier);
  const int trembling_rows = static_cast<int>(trembling.angle_rad.rows());

  Scores scores;
  for (int channel = 0; channel < channels; ++channel) {
    ChannelScores one;
    if (rows > 0) ScoreTracking(input, channel, fourier, one);
    one.jitter_rms_deg = kDegPerRad * Rms(Column(trembling.angle_rad, channel, trembling_rows));
    if (input.command_counts != nullptr) {
      one.command_reversals_per_s =
          ReversalsPerSecond(Column(*input.command_counts, channel, rows), input.rate_hz);
    }
    auto& values = scores.channels.emplace_back(metrics);
    for (std::size_t i = 0; i < metrics; ++i) values[i] = one.*MetricField(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < metrics; ++i) scores.summary.push_back(Mean(scores.channels, i));
  return scores;
}

}  // namespace gauntlet::sim
