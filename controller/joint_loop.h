#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controller/joint_loop_config.h"
#include "controller/tendon_map.h"

namespace gauntlet::controller {

/// Moves commanded joint angles so that measured ones come where they shall, once per event.
///
///     e         = target, expected_delay ago - measured, as far as it is beyond the dead band
///     I         = I + integral_per_s e dt         not while the correction is at its limit and e
///                                                 pushes on
///     corrected = target + clamp(proportional e + I + friction s, +-max_correction)
///     s         = -1, 0, 1: where the target last went; it has turned when it has come back by
///                 friction_turn_deg
///
/// and targets and what is corrected stay within the joint's range, which is a limit, too. Against
/// the target of now, every motion would be an error, since the hand is late; against that of then,
/// only what the hand does not do is one.
///
/// friction s is the inverse of play: to turn back, a command first crosses all the width of the
/// hysteresis loop, so friction_deg is half of it. Small noise of a target does not turn s.
///
/// An integral and dry friction together hunt: the joint sticks, the integral grows, the joint
/// jumps beyond. So errors within the dead band do nothing. It is half of what one motor count
/// turns the joint, as less could not be reached, and dead_band_deg for what the sensor is unsure
/// of.
///
/// Without a reading that is at most `stale_after_ms` old, e is 0 and the integral stays. Joints
/// whose angle the motors alone do not decide are left as they are.
///
/// Source: PI loop with conditional integration in orcahand/orca_core PR #83; inverse of play: Tao,
/// Kokotovic, Adaptive control of systems with backlash, Automatica 29, 323-335 (1993).
/// With both gains 0 nothing is measured: only friction is compensated, on any hand.
///
/// Units: rad. Shapes: one value per joint. Errors: SettingError for gains on a hand that measures
/// no joints, or a list of other than one value or one for each joint.
class JointLoop {
 public:
  JointLoop(const JointLoopConfig& config, const TendonTransmission& hand, double events_per_s);

  bool on() const noexcept { return config_.kind != JointLoopKind::kNone; }

  /// Takes the angles of the joint sensors; NaN for a joint that cannot be read.
  void SetMeasuredAngles(std::span<const double> measured_rad) noexcept;
  /// One event.
  void Step(std::span<const double> target_rad, std::span<double> corrected_rad) noexcept;
  /// As new, the target long since here.
  void Reset(std::span<const double> target_rad) noexcept;
  /// Goes on where another loop of the same hand stands, whose last target was this one. Settings
  /// stay. A loop that was off has nothing to go on with.
  void SwapMemory(JointLoop& from, std::span<const double> target_rad) noexcept;

 private:
  struct Joint {
    double friction_rad = 0.0;
    double dead_band_rad = 0.0;
    double min_rad = 0.0;
    double max_rad = 0.0;
    bool decided = true;  // by the motors alone
  };
  struct Memory {
    double measured_rad = 0.0;
    double integral_rad = 0.0;
    double turn_rad = 0.0;  // the target, as far as it has not only turned a little
    double direction = 0.0;
  };

  double ReferenceOf(std::size_t joint) const noexcept;
  /// How far the command is moved; `least_rad` and `most_rad` are how far it may be.
  double CorrectionOf(const Joint& joint, double error_rad, double least_rad, double most_rad,
                      Memory& memory) const noexcept;

  JointLoopConfig config_;
  double event_s_;
  double delay_events_;
  double stale_events_;
  double limit_rad_;
  double half_turn_rad_;
  std::vector<Joint> joints_;
  std::vector<Memory> memory_;
  double events_since_reading_ = 0.0;
  std::vector<double> targets_rad_;  // of the last events, one row each; a ring
  std::size_t newest_row_ = 0;
};

}  // namespace gauntlet::controller
