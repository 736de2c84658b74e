#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/segment.h"
#include "sim/base/signal.h"
#include "sim/score/counted_ticks.h"
#include "sim/score/error_causes.h"
#include "sim/score/fingertip_error.h"
#include "sim/score/score_config.h"

namespace gauntlet::sim {

/// Part that a score is measured on.
enum class ScoredPart { kJoint, kMotor, kCable, kHand };

/// Groups of joints whose jitter is told apart.
enum class ScoredGroup { kFinger, kWrist, kArm };

/// The rows of a table of scores: every scored joint, motor and cable, once by name. A motor that
/// is called like a joint shares its row, as no score is of both.
struct ScoreRows {
  ScoreRows() = default;
  ScoreRows(std::span<const std::string> joint_names, std::span<const std::string> motor_names,
            std::span<const std::string> cable_names);

  std::vector<std::string> names;
  // The row of each part, in the order of the signals' columns.
  std::vector<std::size_t> joints;
  std::vector<std::size_t> motors;
  std::vector<std::size_t> cables;
  std::vector<ScoredGroup> joint_groups = {};  // per joint; empty: not told apart
};

/// The signals of one trial that scores are made of, columns of scored parts only. Views: the owner
/// outlives the scoring. All but the two angles may be missing; the scores that need them are then
/// NaN.
struct ScoreInput {
  double rate_hz = 1000.0;                        // of ticks
  const Signal* reference_angle_rad = nullptr;    // ticks x joints, what the wearer asked for
  const Signal* hand_angle_rad = nullptr;         // ticks x joints, what the hand did
  const IntegerSignal* command_counts = nullptr;  // ticks x motors
  const Signal* motor_speed_rad_s = nullptr;      // ticks x motors
  const Signal* tension_n = nullptr;              // ticks x cables
  const Signal* grip_force_n = nullptr;           // ticks x 1: of the hand on an object
  const Signal* object_force_n = nullptr;         // ticks x 2: carried by hand, by support
  const Signal* object_pose = nullptr;            // ticks x 7, see GraspSignals
  const Signal* object_in_palm = nullptr;         // ticks x 7
  double object_friction = 0.0;                   // coefficient between hand and object
  const Signal* palm_velocity_m_s = nullptr;      // ticks x 3, in the world
  const Signal* arm_at_rest_angle_rad = nullptr;  // ticks x joints: the hand while the arm rests
  const Signal* digit_overlap_m = nullptr;        // ticks x 1: of the digits that are deepest
  const Signal* sample_age_s = nullptr;           // ticks x 1, see LinkSignals; null without links
  const SignalOf<std::uint8_t>* watchdog_tier = nullptr;  // ticks x 1
  double ticks_per_command = 20.0;                        // frames of the controller
  std::span<const double> deg_per_count = {};     // per motor: of its spool; empty without links
  FingertipSignals fingertips = {};               // nothing where they are not known
  std::span<const double> saturation_share = {};  // per motor
  std::span<const Segment> segments = {};         // win over the split by the wearer's speed
  const CountedParts* counted = nullptr;          // which ticks count; without it all do

  // Of the same trial with a noise-free glove: what noise adds.
  const Signal* noise_free_hand_angle_rad = nullptr;     // ticks x joints
  const Signal* noise_free_motor_speed_rad_s = nullptr;  // ticks x motors
  /// The hand in trials without one cause of the error after the other, ticks x joints; null where
  /// there is none.
  std::array<const Signal*, kCauseTrialCount> without = {};
  /// The hand in trials in which one of kSwitchedCauses is off and all others are on; null where
  /// there is none. Of these and of the trial with the arm at rest the first ticks may exist alone.
  std::array<const Signal*, kSwitchedCauseCount> switched_off = {};
  int switched_off_ticks = 0;     // scored in `switched_off`; 0: there are no such trials
  double earliest_delay_s = 0.0;  // see DelaySamples()
  double jitter_above_hz = ScoreConfig{}.jitter_above_hz;  // lower edge of jitter
  std::span<const double> stall_tension_n = {};            // per cable: of its motor at stall
};

/// The smallest difference between two values of a score that matters to a person: the larger of
/// an amount in the score's unit and a share of the smaller value's size.
struct RelevantDifference {
  double absolute = 0.0;
  double relative = 0.0;
  std::string_view reason;  // a source, or why; "a convention" where there is none
};

/// One score that Gauntlet knows. The unit is the suffix of the key.
struct Metric {
  std::string_view key;
  std::string_view name = {};  // for people, where tables or sentences show it
  std::string_view unit = {};  // the same
  std::string_view help;
  std::string_view definition;  // formula and source, one line
  bool lower_is_better = true;
  ScoredPart part = ScoredPart::kJoint;
  bool main = false;      // of the main question: a column of the table at the terminal
  bool detailed = false;  // a column of the detailed table, beside the main ones
  bool alike = true;      // false: a mean over parts would mix what is not alike, so there is none
  bool needs_twin = false;        // no value without the noise-free signals
  bool needs_chain = false;       // no value without the trials of ErrorCause, one after the other
  bool needs_switched = false;    // no value without those of one cause, or with the arm at rest
  bool needs_fingertips = false;  // no value without the fingertips
  bool needs_link = false;        // no value without a link that is set
  bool extreme = false;           // one moment decides it: no mean over time
  bool needs_stretch = false;     // no value without a stretch for the high pass of jitter
  RelevantDifference relevant_difference = {};
};

/// Smallest relevant difference of two values of the metric; NaN if one of them is.
double RelevantDifferenceBetween(const Metric& metric, double first, double second);

/// All metrics in the order of every table and file.
std::span<const Metric> Metrics();
/// Place of a key in Metrics(), if there is such a key.
std::optional<std::size_t> FindMetric(std::string_view key);
/// Place of a key that the program itself names. Errors: std::invalid_argument for a misspelt one.
std::size_t MetricIndex(std::string_view key);

/// A metric that belongs to a cause of the tracking error. They are of the joints.
struct CauseMetric {
  std::string_view key;
  std::string_view name;   // for pictures and tables: "motor limit"; also behind "without"
  std::size_t metric = 0;  // its place in Metrics()
};

/// Those into which the mean square error falls, in the order of ErrorCause: they sum to the square
/// of tracking_rmse_deg, their summaries to the mean of these squares. None has a value without the
/// trials of causes.
std::span<const CauseMetric> TrackingErrorParts();
/// The tracking errors with one cause switched off, in the order of kSwitchedCauses.
std::span<const CauseMetric> SwitchedErrors();
/// The metric that they are compared with: the tracking error with all causes, over the same time.
std::size_t ErrorWithAll();

/// Values in the order of Metrics(). NaN where a score does not exist (a joint that never moved has
/// no delay; a cable has no tracking error). A summary is the mean over the parts that have a
/// value.
struct Scores {
  std::vector<double> summary;                // metrics
  std::vector<std::vector<double>> channels;  // rows of ScoreRows x metrics
};

/// Scores of a trial that says nothing: all are NaN.
Scores NoScores(const ScoreRows& rows);

/// True if one of `metrics` needs what is named, as &Metric::needs_twin.
bool AnyNeeds(std::span<const std::size_t> metrics, bool Metric::*need);
/// Reason why a metric has no value where the longest motion takes `longest_s`, as the end of a
/// sentence: "it needs 1.4 s of motion without a gap, and there are 0.5 s". Empty if the length is
/// not the reason.
std::string WhyNoValue(std::size_t metric, double jitter_above_hz, double longest_s);

/// Pure: the same signals give the same scores, on any number of threads. A hand that was stopped
/// early is shorter than the reference; the rows that exist are scored. Only `metrics`, if there
/// are any (the others are NaN): few take a part of the time of all, and have the same values.
/// Errors: std::invalid_argument for signals that do not fit each other (the caller's mistake).
Scores ComputeScores(const ScoreInput& input, const ScoreRows& rows,
                     std::span<const std::size_t> metrics = {});

/// Makes the summaries of trials comparable that differ in their controller alone: of each metric
/// the mean over the parts in which all of them have a value. A trial without any value of a metric
/// keeps none and does not limit the others. Trials without rows stay as they are.
void UseCommonParts(std::span<Scores* const> trials);

}  // namespace gauntlet::sim
