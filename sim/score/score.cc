#include "sim/score/score.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/score/channel_scores.h"
#include "sim/score/delay.h"
#include "sim/score/fourier.h"
#include "sim/score/grip.h"
#include "sim/score/jitter.h"
#include "sim/score/motors.h"
#include "sim/score/smoothness.h"
#include "sim/score/steps.h"
#include "sim/score/tracking.h"
#include "sim/score/wearer.h"

namespace gauntlet::sim {
namespace {

template <class Matrix>
auto Column(const Matrix& signal, int column, int rows) {
  return std::span(signal.col(column).data(), static_cast<std::size_t>(rows));
}

void Check(bool fits, const char* problem) {
  if (!fits) throw std::invalid_argument(std::string("ComputeScores: ") + problem);
}

void CheckShapes(const ScoreInput& input) {
  Check(input.reference_angle_rad != nullptr && input.hand_angle_rad != nullptr,
        "reference and hand angles are needed");
  const auto rows = input.hand_angle_rad->rows();
  const auto channels = input.hand_angle_rad->cols();
  const auto fits = [&](const auto* signal) {
    return signal == nullptr || (signal->rows() >= rows && signal->cols() == channels);
  };
  Check(fits(input.reference_angle_rad), "the reference has another shape than the hand");
  Check(fits(input.command_counts), "the command has another shape than the hand");
  Check(fits(input.motor_speed_rad_s), "the motor speed has another shape than the hand");
  Check(input.saturation_share.empty() ||
            static_cast<Eigen::Index>(input.saturation_share.size()) == channels,
        "a saturation share is needed per motor");
  Check(input.grip_force_n == nullptr ||
            (input.grip_force_n->rows() >= rows && input.grip_force_n->cols() == 1),
        "the grip force is no column as long as the hand's angles");
  if (input.tension_n != nullptr) {
    Check(input.tension_n->rows() >= rows, "the tensions are shorter than the hand's angles");
    Check(static_cast<Eigen::Index>(input.cable_channel.size()) == input.tension_n->cols(),
          "each cable needs its channel");
  }
}

/// One channel of a trial, as far as several groups of scores need it.
struct Channel {
  int index = 0;
  double rate_hz = 0.0;
  std::span<const double> reference;
  std::span<const double> hand;
  WearerMotion wearer;
  double delay_samples = 0.0;  // 0 where there is none
};

/// How near the hand is to the wearer, with and without its delay.
void ScoreTracking(Channel& channel, Fourier& fourier, ChannelScores& scores) {
  scores.tracking_rmse_deg = kDegPerRad * RmsDifference(channel.reference, channel.hand);
  scores.peak_error_deg = kDegPerRad * PeakDifference(channel.reference, channel.hand);
  scores.aligned_rmse_deg = scores.tracking_rmse_deg;
  const auto delay = DelaySamples(channel.reference, channel.hand, channel.rate_hz, fourier);
  if (!delay) return;
  channel.delay_samples = *delay;
  scores.delay_ms = 1000.0 * *delay / channel.rate_hz;
  scores.aligned_rmse_deg = kDegPerRad * AlignedRms(channel.reference, channel.hand, *delay);
}

/// RMS of some values within ranges; value 0 belongs to sample `first_sample`.
double RmsWithin(std::span<const double> values, int first_sample,
                 const std::vector<Range>& ranges) {
  double squares = 0.0;
  int count = 0;
  for (const Range& range : ranges) {
    const int begin = std::max(0, range.begin - first_sample);
    const int end = std::min(static_cast<int>(values.size()), range.end - first_sample);
    for (int n = begin; n < end; ++n) squares += values[n] * values[n];
    count += std::max(0, end - begin);
  }
  return count == 0 ? kNoScore : std::sqrt(squares / count);
}

/// Standard deviation about the mean of each range, pooled.
double PooledDeviation(std::span<const double> values, const std::vector<Range>& ranges) {
  double squares = 0.0;
  int count = 0;
  for (const Range& range : ranges) {
    const auto part = values.subspan(range.begin, range.end - range.begin);
    double mean = 0.0;
    for (const double value : part) mean += value;
    mean /= static_cast<double>(part.size());
    for (const double value : part) squares += (value - mean) * (value - mean);
    count += static_cast<int>(part.size());
  }
  return count == 0 ? kNoScore : std::sqrt(squares / count);
}

/// Tracking and trembling, split by what the wearer does.
void ScoreRegimes(const Channel& channel, const FilteredSignal& trembling, ChannelScores& scores) {
  std::vector<double> error(channel.hand.size());
  for (std::size_t n = 0; n < error.size(); ++n) error[n] = channel.hand[n] - channel.reference[n];
  const auto high =
      Column(trembling.values, channel.index, static_cast<int>(trembling.values.rows()));

  const auto split = [&](Regime regime, double& tracking, double* jitter) {
    const std::vector<Range>& ranges = channel.wearer.Of(regime);
    tracking = kDegPerRad * RmsWithin(error, 0, ranges);
    if (jitter) *jitter = kDegPerRad * RmsWithin(high, trembling.first_sample, ranges);
  };
  split(Regime::kRest, scores.rest_tracking_rmse_deg, nullptr);
  split(Regime::kSlow, scores.slow_tracking_rmse_deg, &scores.slow_jitter_rms_deg);
  split(Regime::kFast, scores.fast_tracking_rmse_deg, &scores.fast_jitter_rms_deg);
  split(Regime::kOnset, scores.onset_tracking_rmse_deg, &scores.onset_jitter_rms_deg);
  split(Regime::kReversal, scores.reversal_tracking_rmse_deg, &scores.reversal_jitter_rms_deg);
  scores.jitter_rms_deg = kDegPerRad * Rms(high);
  scores.rest_jitter_deg =
      kDegPerRad * PooledDeviation(channel.hand, channel.wearer.Of(Regime::kRest));
}

/// How the hand makes single movements.
void ScoreMovements(const Channel& channel, Fourier& fourier, ChannelScores& scores) {
  const auto& movements = channel.wearer.movements;
  const Smoothness smoothness =
      MovementSmoothness(channel.hand, channel.rate_hz, movements, channel.delay_samples, fourier);
  scores.sparc = smoothness.sparc;
  scores.ldlj = smoothness.ldlj;
  scores.overshoot_deg = kDegPerRad * Overshoot(channel.reference, channel.hand, channel.rate_hz,
                                                movements, channel.delay_samples);
  scores.onset_delay_ms = 1000.0 / channel.rate_hz *
                          OnsetDelay(channel.reference, channel.hand, channel.rate_hz, movements);
}

/// Commands, motors and cables.
void ScoreDrive(const ScoreInput& input, const Channel& channel, Fourier& fourier,
                ChannelScores& scores) {
  const int rows = static_cast<int>(channel.hand.size());
  if (input.command_counts != nullptr) {
    scores.command_reversals_per_s =
        ReversalsPerSecond(Column(*input.command_counts, channel.index, rows), channel.rate_hz);
  }
  if (input.motor_speed_rad_s != nullptr) {
    const auto speed = Column(*input.motor_speed_rad_s, channel.index, rows);
    scores.motor_speed_rms_deg_s = kDegPerRad * Rms(speed);
    scores.motor_speed_centroid_hz = SpectralCentroid(speed, channel.rate_hz, fourier);
  }
  if (!input.saturation_share.empty()) {
    scores.saturation_share = input.saturation_share[channel.index];
  }
  double slack = 0.0;
  double peak = 0.0;
  int cables = 0;
  for (std::size_t cable = 0; cable < input.cable_channel.size(); ++cable) {
    if (input.cable_channel[cable] != channel.index || input.tension_n == nullptr) continue;
    const auto tension = Column(*input.tension_n, static_cast<int>(cable), rows);
    slack += SlackShare(tension);
    peak = std::max(peak, *std::max_element(tension.begin(), tension.end()));
    ++cables;
  }
  if (cables == 0) return;
  scores.slack_share = slack / cables;
  scores.tension_peak_n = peak;
}

/// Mean over the channels that have a value.
template <class Channels>
double MeanOver(const Scores& scores, const Channels& channels, std::size_t metric) {
  double sum = 0.0;
  int count = 0;
  for (const auto channel : channels) {
    const double value = scores.channels[channel][metric];
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return count == 0 ? kNoScore : sum / count;
}

std::vector<double> MeansOver(const Scores& scores, const std::vector<std::size_t>& channels) {
  std::vector<double> means;
  for (std::size_t i = 0; i < Metrics().size(); ++i) means.push_back(MeanOver(scores, channels, i));
  return means;
}

}  // namespace

Scores ComputeScores(const ScoreInput& input) {
  CheckShapes(input);
  const int rows = static_cast<int>(input.hand_angle_rad->rows());
  Fourier fourier;
  const FilteredSignal trembling = Trembling(*input.hand_angle_rad, input.rate_hz, fourier);

  Scores scores;
  std::vector<std::size_t> all;
  for (int index = 0; index < input.hand_angle_rad->cols(); ++index) {
    ChannelScores one;
    if (rows > 0) {
      Channel channel{.index = index,
                      .rate_hz = input.rate_hz,
                      .reference = Column(*input.reference_angle_rad, index, rows),
                      .hand = Column(*input.hand_angle_rad, index, rows),
                      .wearer = {}};
      channel.wearer = AnalyseWearer(channel.reference, input.rate_hz, input.segments);
      ScoreTracking(channel, fourier, one);
      ScoreRegimes(channel, trembling, one);
      ScoreMovements(channel, fourier, one);
      ScoreDrive(input, channel, fourier, one);
    }
    auto& values = scores.channels.emplace_back();
    for (std::size_t i = 0; i < Metrics().size(); ++i) {
      values.push_back(one.*MetricField(static_cast<int>(i)));
    }
    all.push_back(static_cast<std::size_t>(index));
  }
  scores.summary = MeansOver(scores, all);
  if (input.grip_force_n != nullptr) {
    scores.summary[MetricIndex("grip_force_ripple_n")] =
        GripForceRipple(Column(*input.grip_force_n, 0, rows), input.rate_hz, fourier);
  }
  return scores;
}

std::vector<FingerScores> ScoresPerFinger(const Scores& scores,
                                          std::span<const std::string> channel_names) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> fingers;
  for (std::size_t c = 0; c < channel_names.size(); ++c) {
    const std::string name = channel_names[c].substr(0, channel_names[c].find('_'));
    auto finger = std::find_if(fingers.begin(), fingers.end(),
                               [&](const auto& known) { return known.first == name; });
    if (finger == fingers.end()) finger = fingers.insert(finger, {name, {}});
    finger->second.push_back(c);
  }
  std::vector<FingerScores> result;
  for (const auto& [name, channels] : fingers)
    result.push_back({name, MeansOver(scores, channels)});
  return result;
}

}  // namespace gauntlet::sim
