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

void CheckShapes(const ScoreInput& input, const ScoreRows& table) {
  Check(input.reference_angle_rad != nullptr && input.hand_angle_rad != nullptr,
        "reference and hand angles are needed");
  const auto rows = input.hand_angle_rad->rows();
  const auto fits = [&](const auto* signal, std::size_t columns) {
    return signal == nullptr ||
           (signal->rows() >= rows && static_cast<std::size_t>(signal->cols()) == columns);
  };
  Check(fits(input.hand_angle_rad, table.joints.size()), "the hand has other joints than the rows");
  Check(fits(input.reference_angle_rad, table.joints.size()),
        "the reference has another shape than the hand");
  Check(fits(input.command_counts, table.motors.size()),
        "the command has other motors than the rows, or is shorter than the hand's angles");
  Check(fits(input.motor_speed_rad_s, table.motors.size()),
        "the motor speed has other motors than the rows, or is shorter than the hand's angles");
  Check(input.saturation_share.empty() || input.saturation_share.size() == table.motors.size(),
        "a saturation share is needed per motor");
  Check(fits(input.tension_n, table.cables.size()),
        "the tensions have other cables than the rows, or are shorter than the hand's angles");
  Check(fits(input.grip_force_n, 1), "the grip force is no column as long as the hand's angles");
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

/// Commands and motions of one motor.
void ScoreMotor(const ScoreInput& input, std::size_t motor, int rows, Fourier& fourier,
                ChannelScores& scores) {
  const int column = static_cast<int>(motor);
  if (input.command_counts != nullptr) {
    scores.command_reversals_per_s =
        ReversalsPerSecond(Column(*input.command_counts, column, rows), input.rate_hz);
  }
  if (input.motor_speed_rad_s != nullptr) {
    const auto speed = Column(*input.motor_speed_rad_s, column, rows);
    scores.motor_speed_rms_deg_s = kDegPerRad * Rms(speed);
    scores.motor_speed_centroid_hz = SpectralCentroid(speed, input.rate_hz, fourier);
  }
  if (!input.saturation_share.empty()) scores.saturation_share = input.saturation_share[motor];
}

void ScoreCable(const ScoreInput& input, std::size_t cable, int rows, ChannelScores& scores) {
  if (input.tension_n == nullptr) return;
  const auto tension = Column(*input.tension_n, static_cast<int>(cable), rows);
  scores.slack_share = SlackShare(tension);
  scores.tension_peak_n = *std::max_element(tension.begin(), tension.end());
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

ScoreRows::ScoreRows(std::span<const std::string> joint_names,
                     std::span<const std::string> motor_names,
                     std::span<const std::string> cable_names) {
  const auto row_of = [this](const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    const auto row = static_cast<std::size_t>(found - names.begin());
    if (found == names.end()) names.push_back(name);
    return row;
  };
  for (const std::string& name : joint_names) joints.push_back(row_of(name));
  for (const std::string& name : motor_names) motors.push_back(row_of(name));
  for (const std::string& name : cable_names) cables.push_back(row_of(name));
}

Scores ComputeScores(const ScoreInput& input, const ScoreRows& table) {
  CheckShapes(input, table);
  const int rows = static_cast<int>(input.hand_angle_rad->rows());
  Fourier fourier;
  const FilteredSignal trembling = Trembling(*input.hand_angle_rad, input.rate_hz, fourier);

  std::vector<ChannelScores> all(table.names.size());
  for (std::size_t index = 0; rows > 0 && index < table.joints.size(); ++index) {
    const int column = static_cast<int>(index);
    Channel channel{.index = column,
                    .rate_hz = input.rate_hz,
                    .reference = Column(*input.reference_angle_rad, column, rows),
                    .hand = Column(*input.hand_angle_rad, column, rows),
                    .wearer = {}};
    channel.wearer = AnalyseWearer(channel.reference, input.rate_hz, input.segments);
    ChannelScores& one = all[table.joints[index]];
    ScoreTracking(channel, fourier, one);
    ScoreRegimes(channel, trembling, one);
    ScoreMovements(channel, fourier, one);
  }
  for (std::size_t motor = 0; rows > 0 && motor < table.motors.size(); ++motor) {
    ScoreMotor(input, motor, rows, fourier, all[table.motors[motor]]);
  }
  for (std::size_t cable = 0; rows > 0 && cable < table.cables.size(); ++cable) {
    ScoreCable(input, cable, rows, all[table.cables[cable]]);
  }

  Scores scores;
  std::vector<std::size_t> every_row;
  for (const ChannelScores& one : all) {
    every_row.push_back(scores.channels.size());
    auto& values = scores.channels.emplace_back();
    for (std::size_t i = 0; i < Metrics().size(); ++i) {
      values.push_back(one.*MetricField(static_cast<int>(i)));
    }
  }
  scores.summary = MeansOver(scores, every_row);
  if (input.grip_force_n != nullptr) {
    scores.summary[MetricIndex("grip_force_ripple_n")] =
        GripForceRipple(Column(*input.grip_force_n, 0, rows), input.rate_hz, fourier);
  }
  return scores;
}

}  // namespace gauntlet::sim
