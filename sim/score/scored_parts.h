#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/score/error_causes.h"
#include "sim/score/fingertip_error.h"
#include "sim/score/fourier.h"
#include "sim/score/grasp.h"
#include "sim/score/link_scores.h"
#include "sim/score/low_pass.h"
#include "sim/score/score.h"
#include "sim/score/smoothness.h"
#include "sim/score/wearer.h"

namespace gauntlet::sim {

// What the metrics see of one part of a trial. Views: the signals outlive them. What takes time is
// found when the first metric asks for it, so who wants few scores does not pay for all.

/// A value that is found when it is first asked for.
template <class Value>
class Lazy {
 public:
  explicit Lazy(std::function<Value()> find) : find_(std::move(find)) {}
  const Value& operator()() const {
    if (!value_) value_.emplace(find_());
    return *value_;
  }

 private:
  std::function<Value()> find_;
  mutable std::optional<Value> value_;
};

/// Findings on all joints together.
struct AllJoints {
  AllJoints(const ScoreInput& input, Fourier& fourier);
  AllJoints(const AllJoints&) = delete;  // its parts refer to it
  AllJoints& operator=(const AllJoints&) = delete;

  /// Counted ticks of a part: its own, or all where nothing is left out.
  CountedTicks CountedOf(const std::vector<CountedTicks> CountedParts::*parts, int part) const;
  CountedTicks CountedOfHand() const;
  /// Mean over the joints of a group of the RMS of their jitter, within the first `ticks`; kNoScore
  /// for a group without one.
  double GroupJitter_rad(const FilteredSignal& jitter, std::span<const ScoredGroup> groups,
                         ScoredGroup group, Eigen::Index ticks) const;
  /// Ticks of the trial in which the arm rests: the first of the trial, or all.
  Eigen::Index TicksAtRest() const;

  const ScoreInput& input;
  Lazy<FilteredSignal> trembling;              // of the hand above jitter_above_hz
  Lazy<FilteredSignal> trembling_at_rest;      // while the arm rests; no rows: not known
  Lazy<FilteredSignal> trembling_beside_rest;  // of the hand in the same ticks
  Lazy<std::vector<double>> noise_jitter_rad;  // RMS of what noise adds to it; empty: not known
};

/// One joint. What several metrics need is found once.
struct ScoredJoint {
  ScoredJoint(const ScoreInput& input, int column, const AllJoints& all, Fourier& fourier);
  ScoredJoint(const ScoredJoint&) = delete;  // its parts refer to each other
  ScoredJoint& operator=(const ScoredJoint&) = delete;

  double rate_hz;
  std::span<const double> reference_rad;
  std::span<const double> hand_rad;
  CountedTicks counted;
  Lazy<std::vector<double>> error_rad;  // hand - reference
  Lazy<WearerMotion> wearer;
  Lazy<std::optional<double>> delay_ticks;
  Lazy<Smoothness> smoothness;
  Lazy<std::optional<ErrorByCauses>> error_parts;

  double jitter_rad() const;        // RMS of the jitter, above jitter_above_hz
  double noise_jitter_rad() const;  // kNoScore: not known

  /// RMS of the error while the wearer does this [rad].
  double ErrorDuring(Regime regime) const;
  /// RMS of the jitter while the wearer does this [rad].
  double TremblingDuring(Regime regime) const;
  /// Part of the mean square error [rad^2], kNoScore if it is not known.
  double PartOfError(ErrorCause cause) const;
  /// RMS of the error in the ticks of the trials with one cause switched off [rad]; kNoScore
  /// without such trials.
  double ErrorWithAll() const;
  /// RMS of the error without this cause, one of kSwitchedCauses.
  double ErrorWithout(ErrorCause cause) const;

 private:
  /// RMS of hand - reference in the ticks of the trials with one cause switched off [rad].
  double ErrorOfSwitched(const Signal* hand) const;
  /// Motion of the hand above jitter_above_hz; the first belongs to a tick of `all_`.
  std::span<const double> trembling_rad() const;

  int column_;
  const AllJoints& all_;
  CountedTicks trembling_counted_;
};

/// One motor. A signal that is not there is empty.
struct ScoredMotor {
  double rate_hz;
  std::span<const int> command_counts;
  std::span<const double> speed_rad_s;
  std::vector<double> noise_rad_s;  // speed less that with a noise-free glove
  std::optional<double> saturation_share;
  std::optional<double> deg_per_count;  // of its spool; none without links
  CountedTicks counted;
  Fourier& fourier;
};

/// One cable; empty without tensions.
struct ScoredCable {
  std::span<const double> tension_n;
  std::optional<double> stall_tension_n;
  CountedTicks counted;
};

/// Signals of the hand as a whole; empty where it holds nothing, or has no digits.
struct ScoredHand {
  const AllJoints& all;
  std::span<const ScoredGroup> joint_groups;
  double rate_hz;
  double jitter_above_hz;
  std::span<const double> grip_force_n;
  GraspSignals grasp;
  FingertipSignals fingertips;
  const Signal* palm_velocity_m_s;
  std::span<const double> digit_overlap_m;
  LinkSignals link;
  CountedTicks counted;
  Fourier& fourier;

  double JitterOf_rad(ScoredGroup group) const {
    return all.GroupJitter_rad(all.trembling(), joint_groups, group,
                               all.input.hand_angle_rad->rows());
  }
  /// Share of the fingers' jitter that is not there in the trial in which the arm rests; kNoScore:
  /// not known.
  double ArmShareOfJitter() const {
    const auto of_fingers = [this](const FilteredSignal& jitter) {
      return all.GroupJitter_rad(jitter, joint_groups, ScoredGroup::kFinger, all.TicksAtRest());
    };
    return 1.0 - of_fingers(all.trembling_at_rest()) / of_fingers(all.trembling_beside_rest());
  }
};

}  // namespace gauntlet::sim
