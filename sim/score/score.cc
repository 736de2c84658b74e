#include "sim/score/score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "controller/assert.h"
#include "sim/base/stop.h"
#include "sim/score/fourier.h"
#include "sim/score/jitter.h"
#include "sim/score/metrics.h"
#include "sim/score/no_score.h"
#include "sim/score/tracking.h"

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

template <class Fits>
void CheckNoiseFree(const ScoreInput& input, const ScoreRows& table, const Fits& fits) {
  Check(fits(input.noise_free_hand_angle_rad, table.joints.size()),
        "the noise-free hand has another shape than the hand");
  Check(fits(input.noise_free_motor_speed_rad_s, table.motors.size()),
        "the noise-free motor speed has another shape than the motors'");
  for (const Signal* const without : input.without) {
    Check(fits(without, table.joints.size()),
          "the hand without a cause has another shape than the hand");
  }
  const int ticks = input.switched_off_ticks;
  for (const Signal* const one : input.switched_off) {
    Check(one == nullptr || (static_cast<std::size_t>(one->cols()) == table.joints.size() &&
                             0 < ticks && ticks <= one->rows()),
          "the hand with a cause switched off has other joints, or is shorter than its ticks");
  }
  Check(0 <= ticks && ticks <= input.hand_angle_rad->rows(),
        "the hand is shorter than its trials with a cause switched off");
}

void CheckFingertips(const FingertipSignals& tips, Eigen::Index ticks) {
  if (!tips.exist()) return;
  const Eigen::Index step = tips.ticks_per_row;
  Check(step > 0 && tips.reference_m != nullptr &&
            tips.hand_m->cols() == tips.reference_m->cols() &&
            tips.hand_m->rows() * step >= ticks && tips.reference_m->rows() * step >= ticks,
        "the fingertips of hand and reference do not fit the hand's angles or each other");
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
  Check(
      fits(input.object_force_n, 2) && fits(input.object_pose, 7) && fits(input.object_in_palm, 7),
      "the object's signals have other columns, or are shorter than the hand's angles");
  CheckFingertips(input.fingertips, rows);
  Check(fits(input.digit_overlap_m, 1),
        "the overlap of digits is no column as long as the hand's angles");
  Check(fits(input.palm_velocity_m_s, 3), "the palm's velocity has other columns, or is shorter");
  const Signal* const at_rest = input.arm_at_rest_angle_rad;
  Check(at_rest == nullptr || static_cast<std::size_t>(at_rest->cols()) == table.joints.size(),
        "the hand with the arm at rest has other joints than the hand");
  Check(table.joint_groups.empty() || table.joint_groups.size() == table.joints.size(),
        "a group is needed per joint");
  Check(fits(input.sample_age_s, 1) && fits(input.watchdog_tier, 1) &&
            (input.sample_age_s == nullptr) == (input.watchdog_tier == nullptr),
        "age of the samples and watchdog tier are two columns as long as the hand's angles");
  Check(input.deg_per_count.empty() || input.deg_per_count.size() == table.motors.size(),
        "an angle per count is needed per motor");
  Check(input.stall_tension_n.empty() || input.stall_tension_n.size() == table.cables.size(),
        "a stall tension is needed per cable");
  Check(input.jitter_above_hz > 0.0, "jitter begins above 0 Hz");
  Check(input.counted == nullptr || (input.counted->joints.size() == table.joints.size() &&
                                     input.counted->motors.size() == table.motors.size() &&
                                     input.counted->cables.size() == table.cables.size()),
        "what counts is needed of every joint, motor and cable");
  CheckNoiseFree(input, table, fits);
}

/// The columns' spans of a signal that may be missing.
template <class Matrix>
auto ColumnOrNothing(const Matrix* signal, std::size_t column, int rows) {
  using Span = decltype(Column(*signal, 0, 0));
  return signal == nullptr ? Span() : Column(*signal, static_cast<int>(column), rows);
}

/// Nothing unless all are recorded.
GraspSignals GraspOf(const ScoreInput& input, int rows) {
  if (input.grip_force_n == nullptr || input.object_force_n == nullptr ||
      input.object_pose == nullptr || input.object_in_palm == nullptr) {
    return {};
  }
  return {.rate_hz = input.rate_hz,
          .grip_force_n = Column(*input.grip_force_n, 0, rows),
          .carried_force_n = Column(*input.object_force_n, 0, rows),
          .support_force_n = Column(*input.object_force_n, 1, rows),
          .pose = input.object_pose,
          .pose_in_palm = input.object_in_palm,
          .friction = input.object_friction};
}

/// Fills in the metrics that are measured on this kind of part, and wanted.
template <class Part>
void Score(const Part& part, const std::vector<bool>& wanted, std::vector<double>& values) {
  using PartMeasure = double (*)(const Part&);
  for (std::size_t m = 0; m < values.size(); ++m) {
    const auto* measure = std::get_if<PartMeasure>(&MetricRows()[m].measure);
    if (measure != nullptr && wanted[m]) values[m] = (*measure)(part);
  }
}

/// Per metric; nothing named is all.
std::vector<bool> Wanted(std::span<const std::size_t> metrics) {
  std::vector<bool> wanted(Metrics().size(), metrics.empty());
  for (const std::size_t metric : metrics) {
    GAUNTLET_ASSERT(metric < wanted.size());
    wanted[metric] = true;
  }
  return wanted;
}

/// Mean over the rows that have a value, per metric; none where the rows are not alike.
std::vector<double> MeansOver(const std::vector<std::vector<double>>& rows) {
  std::vector<double> means;
  for (std::size_t metric = 0; metric < Metrics().size(); ++metric) {
    double sum = 0.0;
    int count = 0;
    for (const std::vector<double>& row : rows) {
      if (!Metrics()[metric].alike || !std::isfinite(row[metric])) continue;
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

bool AnyNeeds(std::span<const std::size_t> metrics, bool Metric::*need) {
  return std::ranges::any_of(metrics,
                             [need](std::size_t metric) { return Metrics()[metric].*need; });
}

std::string WhyNoValue(std::size_t metric, double jitter_above_hz, double longest_s) {
  constexpr double kTick_hz = 1000.0;  // to a millisecond, whatever the rate
  const Metric& is = Metrics()[metric];
  if (is.needs_stretch) {
    const double least_s =
        static_cast<double>(TremblingTicks(kTick_hz, jitter_above_hz)) / kTick_hz;
    if (longest_s >= least_s) return "";
    return fmt::format("it needs {:.2g} s of motion without a gap, and there are {:.2g} s", least_s,
                       longest_s);
  }
  // A quarter of the motion is searched, and a delay is a maximum inside it.
  constexpr double kShort_s = 4.0;
  if (is.key == "delay_ms" && longest_s < kShort_s) {
    return fmt::format(
        "it is searched in a quarter of the motion, {:.2g} s, and is not inside or not clear",
        0.25 * longest_s);
  }
  return "";
}

Scores ComputeScores(const ScoreInput& input, const ScoreRows& table,
                     std::span<const std::size_t> metrics) {
  CheckShapes(input, table);
  const int rows = static_cast<int>(input.hand_angle_rad->rows());
  // A long trial's transforms take much memory: those of one trial at a time.
  static std::mutex long_trials;
  std::unique_lock lock(long_trials, std::defer_lock);
  if (rows >= kLongTrial) lock.lock();
  Fourier fourier;
  const AllJoints all(input, fourier);

  const std::vector<bool> wanted = Wanted(metrics);
  Scores scores = NoScores(table);
  for (std::size_t joint = 0; rows > 0 && joint < table.joints.size(); ++joint) {
    ThrowIfStopped();
    Score(ScoredJoint(input, static_cast<int>(joint), all, fourier), wanted,
          scores.channels[table.joints[joint]]);
    TrimSignals();
  }
  for (std::size_t motor = 0; rows > 0 && motor < table.motors.size(); ++motor) {
    ScoredMotor scored{.rate_hz = input.rate_hz,
                       .command_counts = ColumnOrNothing(input.command_counts, motor, rows),
                       .speed_rad_s = ColumnOrNothing(input.motor_speed_rad_s, motor, rows),
                       .noise_rad_s = {},
                       .saturation_share = {},
                       .deg_per_count = {},
                       .counted = all.CountedOf(&CountedParts::motors, static_cast<int>(motor)),
                       .fourier = fourier};
    scored.noise_rad_s = Differences(
        scored.speed_rad_s, ColumnOrNothing(input.noise_free_motor_speed_rad_s, motor, rows));
    if (!input.saturation_share.empty()) scored.saturation_share = input.saturation_share[motor];
    if (!input.deg_per_count.empty()) scored.deg_per_count = input.deg_per_count[motor];
    Score(scored, wanted, scores.channels[table.motors[motor]]);
    TrimSignals();
  }
  for (std::size_t cable = 0; rows > 0 && cable < table.cables.size(); ++cable) {
    ScoredCable scored{.tension_n = ColumnOrNothing(input.tension_n, cable, rows),
                       .stall_tension_n = {},
                       .counted = all.CountedOf(&CountedParts::cables, static_cast<int>(cable))};
    if (!input.stall_tension_n.empty()) scored.stall_tension_n = input.stall_tension_n[cable];
    Score(scored, wanted, scores.channels[table.cables[cable]]);
    TrimSignals();
  }
  scores.summary = MeansOver(scores.channels);
  Score(ScoredHand{.all = all,
                   .joint_groups = table.joint_groups,
                   .rate_hz = input.rate_hz,
                   .jitter_above_hz = input.jitter_above_hz,
                   .grip_force_n = ColumnOrNothing(input.grip_force_n, 0, rows),
                   .grasp = GraspOf(input, rows),
                   .fingertips = input.fingertips,
                   .palm_velocity_m_s = input.palm_velocity_m_s,
                   .digit_overlap_m = ColumnOrNothing(input.digit_overlap_m, 0, rows),
                   .link = {.sample_age_s = ColumnOrNothing(input.sample_age_s, 0, rows),
                            .watchdog_tier = ColumnOrNothing(input.watchdog_tier, 0, rows),
                            .ticks_per_command = input.ticks_per_command},
                   .counted = all.CountedOfHand(),
                   .fourier = fourier},
        wanted, scores.summary);
  return scores;
}

void UseCommonParts(std::span<Scores* const> trials) {
  for (std::size_t metric = 0; metric < Metrics().size(); ++metric) {
    if (!Metrics()[metric].alike || Metrics()[metric].part == ScoredPart::kHand) continue;
    std::vector<Scores*> with_value;
    for (Scores* const trial : trials) {
      if (std::isfinite(trial->summary[metric]) && !trial->channels.empty()) {
        with_value.push_back(trial);
        trial->summary[metric] = 0.0;
      }
    }
    int common = 0;
    for (std::size_t row = 0; !with_value.empty() && row < with_value[0]->channels.size(); ++row) {
      const auto has_value = [&](const Scores* trial) {
        return std::isfinite(trial->channels[row][metric]);
      };
      if (!std::ranges::all_of(with_value, has_value)) continue;
      ++common;
      for (Scores* const trial : with_value) trial->summary[metric] += trial->channels[row][metric];
    }
    for (Scores* const trial : with_value) {
      trial->summary[metric] = common == 0 ? kNoScore : trial->summary[metric] / common;
    }
  }
}

}  // namespace gauntlet::sim
