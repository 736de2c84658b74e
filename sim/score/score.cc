#include "sim/score/score.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "sim/score/fourier.h"
#include "sim/score/jitter.h"
#include "sim/score/metrics.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {
namespace {

constexpr int kLongTrial = 500'000;  // rows

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

/// The columns' spans of a signal that may be missing.
template <class Matrix>
auto ColumnOrNothing(const Matrix* signal, std::size_t column, int rows) {
  using Span = decltype(Column(*signal, 0, 0));
  return signal == nullptr ? Span() : Column(*signal, static_cast<int>(column), rows);
}

/// Fills in the metrics that are measured on this kind of part.
template <class Part>
void Score(const Part& part, std::vector<double>& values) {
  using PartMeasure = double (*)(const Part&);
  for (std::size_t m = 0; m < values.size(); ++m) {
    const auto* measure = std::get_if<PartMeasure>(&MetricRows()[m].measure);
    if (measure != nullptr) values[m] = (*measure)(part);
  }
}

/// Mean over the rows that have a value, per metric.
std::vector<double> MeansOver(const std::vector<std::vector<double>>& rows) {
  std::vector<double> means;
  for (std::size_t metric = 0; metric < Metrics().size(); ++metric) {
    double sum = 0.0;
    int count = 0;
    for (const std::vector<double>& row : rows) {
      if (!std::isfinite(row[metric])) continue;
      sum += row[metric];
      ++count;
    }
    means.push_back(count == 0 ? kNoScore : sum / count);
  }
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

Scores NoScores(const ScoreRows& rows) {
  const std::vector<double> none(Metrics().size(), kNoScore);
  return {.summary = none, .channels = {rows.names.size(), none}};
}

Scores ComputeScores(const ScoreInput& input, const ScoreRows& table) {
  CheckShapes(input, table);
  const int rows = static_cast<int>(input.hand_angle_rad->rows());
  // A long trial's transforms take much memory: those of one trial at a time.
  static std::mutex long_trials;
  std::unique_lock lock(long_trials, std::defer_lock);
  if (rows >= kLongTrial) lock.lock();
  Fourier fourier;
  const FilteredSignal trembling = Trembling(*input.hand_angle_rad, input.rate_hz, fourier);

  Scores scores = NoScores(table);
  for (std::size_t joint = 0; rows > 0 && joint < table.joints.size(); ++joint) {
    Score(ScoredJoint(input, static_cast<int>(joint), trembling, fourier),
          scores.channels[table.joints[joint]]);
    TrimSignals();
  }
  for (std::size_t motor = 0; rows > 0 && motor < table.motors.size(); ++motor) {
    ScoredMotor scored{.rate_hz = input.rate_hz,
                       .command_counts = ColumnOrNothing(input.command_counts, motor, rows),
                       .speed_rad_s = ColumnOrNothing(input.motor_speed_rad_s, motor, rows),
                       .saturation_share = {},
                       .fourier = fourier};
    if (!input.saturation_share.empty()) scored.saturation_share = input.saturation_share[motor];
    Score(scored, scores.channels[table.motors[motor]]);
    TrimSignals();
  }
  for (std::size_t cable = 0; rows > 0 && cable < table.cables.size(); ++cable) {
    Score(ScoredCable{ColumnOrNothing(input.tension_n, cable, rows)},
          scores.channels[table.cables[cable]]);
    TrimSignals();
  }
  scores.summary = MeansOver(scores.channels);
  Score(ScoredHand{.rate_hz = input.rate_hz,
                   .grip_force_n = ColumnOrNothing(input.grip_force_n, 0, rows),
                   .fourier = fourier},
        scores.summary);
  return scores;
}

}  // namespace gauntlet::sim
