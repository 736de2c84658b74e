#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/segment.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {

/// The signals of one trial that scores are made of. Views: the owner outlives the scoring. All but
/// the two angles may be missing; the scores that need them are then NaN.
struct ScoreInput {
  double rate_hz = 1000.0;
  const Signal* reference_angle_rad = nullptr;    // samples x channels, what the wearer did
  const Signal* hand_angle_rad = nullptr;         // samples x channels, what the hand did
  const IntegerSignal* command_counts = nullptr;  // samples x motors, one motor per channel
  const Signal* motor_speed_rad_s = nullptr;      // samples x motors
  const Signal* tension_n = nullptr;              // samples x cables
  std::span<const int> cable_channel = {};        // per cable: the channel that it moves
  const Signal* grip_force_n = nullptr;           // samples x 1: of the hand on an object
  std::span<const double> saturation_share = {};  // per motor
  std::span<const Segment> segments = {};         // win over the split by the wearer's speed
};

/// One score that Gauntlet knows. The unit is the suffix of the key.
struct Metric {
  std::string_view key;
  std::string_view help;
  std::string_view definition;  // formula and source, one line
  bool lower_is_better = true;
};

/// All metrics in the order of every table and file.
std::span<const Metric> Metrics();
/// Place of a key in Metrics(), or their number if there is no such key.
std::size_t MetricIndex(std::string_view key);

/// Values in the order of Metrics(). NaN where a score does not exist (a channel that never moved
/// has no delay; a grip is of the whole hand and only in the summary). Channels that do not move at
/// all count in a summary where they have a value.
struct Scores {
  std::vector<double> summary;                // metrics
  std::vector<std::vector<double>> channels;  // channels x metrics
};

/// Pure: the same signals give the same scores, on any number of threads. A hand that was stopped
/// early is shorter than the reference; the rows that exist are scored.
/// Errors: std::invalid_argument for signals that do not fit each other (the caller's mistake).
Scores ComputeScores(const ScoreInput& input);

/// Scores of all channels that belong together.
struct FingerScores {
  std::string name;            // what their channels' names have before the first underscore
  std::vector<double> values;  // metrics: the mean over its channels, as in a summary
};

/// One entry per finger (or wrist, forearm, elbow, shoulder), in the order of the channels.
std::vector<FingerScores> ScoresPerFinger(const Scores& scores,
                                          std::span<const std::string> channel_names);

}  // namespace gauntlet::sim
