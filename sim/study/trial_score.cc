#include "sim/study/trial_score.h"

#include <algorithm>
#include <vector>

#include "sim/study/counted_parts.h"

namespace gauntlet::sim {
namespace {

/// Of each measured cable what its motor pulls with at stall [N].
std::vector<double> StallTensions(const Study& study) {
  std::vector<double> tensions;
  for (const int motor : study.measured_motors) {
    const Drive& drive = study.hand->drives()[static_cast<std::size_t>(motor)];
    tensions.insert(tensions.end(), drive.cables.size(),
                    drive.servo.stall_torque_nm / drive.drum_radius_m);
  }
  return tensions;
}

/// Per measured joint the places among the measured motors of those that turn it.
std::vector<std::vector<int>> MotorsOfJoints(const Study& study) {
  const controller::TendonTransmission& hand = study.hand->transmission();
  std::vector<std::vector<int>> motors_of_joints;
  for (const int joint : study.measured_joints) {
    std::vector<int>& motors = motors_of_joints.emplace_back();
    for (std::size_t i = 0; i < study.measured_motors.size(); ++i) {
      const int motor = study.measured_motors[i];
      if (hand.coupling[motor * study.joint_count + joint] != 0.0) {
        motors.push_back(static_cast<int>(i));
      }
    }
  }
  return motors_of_joints;
}

/// Per measured motor the share of the ticks that count in which it gives all that it has.
std::vector<double> SaturationShares(const Study& study, const FlagSignal& at_limit,
                                     const std::optional<CountedParts>& counted) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < study.measured_motors.size(); ++i) {
    const CountedTicks ticks =
        counted ? counted->motors[i] : CountedTicks{{0, static_cast<int>(at_limit.rows())}};
    const auto column = at_limit.col(study.measured_motors[i]).cast<std::int64_t>();
    std::int64_t sum = 0;
    for (const auto& [begin, end] : ticks) sum += column.segment(begin, end - begin).sum();
    shares.push_back(static_cast<double>(sum) / std::max(CountOf(ticks), 1));
  }
  return shares;
}

/// Whether the trial had a hand; else there are only angles.
bool HadMotors(const Trace& trace) { return trace.spool_speed_rad_s.cols() > 0; }

/// What the motors and cables of a trial did, and of its twin, if there is one.
struct MeasuredMotors {
  MeasuredMotors(const Study& study, const Trace& trace, const std::optional<NoiseFreeTwin>& twin,
                 const std::optional<CountedParts>& counted)
      : command(trace.command_counts, study.measured_motors),
        speed(trace.spool_speed_rad_s, study.measured_motors),
        tension(trace.tension_n, study.measured_cables),
        stall_tension_n(StallTensions(study)),
        saturation_share(SaturationShares(study, trace.motor_at_limit, counted)),
        motors_of_joint(MotorsOfJoints(study)) {
    if (!twin) return;
    twin_speed.emplace(twin->spool_speed_rad_s, study.measured_motors);
    twin_at_limit = twin->motor_at_limit(Eigen::all, study.measured_motors).cast<int>();
  }

  void PutInto(ScoreInput& input) const {
    input.command_counts = &*command;
    input.motor_speed_rad_s = &*speed;
    input.tension_n = &*tension;
    input.saturation_share = saturation_share;
    input.stall_tension_n = stall_tension_n;
    input.motors_of_joint = motors_of_joint;
    if (!twin_speed) return;
    input.noise_free_motor_speed_rad_s = &**twin_speed;
    input.noise_free_motor_at_limit = &twin_at_limit;
  }

  Columns<IntegerSignal> command;
  Columns<Signal> speed;
  Columns<Signal> tension;
  std::vector<double> stall_tension_n;
  std::vector<double> saturation_share;
  std::vector<std::vector<int>> motors_of_joint;
  std::optional<Columns<Signal>> twin_speed;
  IntegerSignal twin_at_limit;
};

}  // namespace

Scores ScoreTrial(const Study& study, const GloveSignal& glove, const Signal& reference_rad,
                  const Trace& trace, const std::optional<NoiseFreeTwin>& twin,
                  std::span<const std::size_t> metrics) {
  const Columns reference(reference_rad, study.measured_joints);
  const Columns hand(trace.hand_angle_rad, study.measured_joints);
  const std::optional<CountedParts> counted =
      CountedPartsOf(study, glove.masked, static_cast<int>(trace.hand_angle_rad.rows()));
  std::optional<MeasuredMotors> motors;
  if (HadMotors(trace)) motors.emplace(study, trace, twin, counted);
  std::optional<Columns<Signal>> twin_hand;
  if (twin) twin_hand.emplace(twin->hand_angle_rad, study.measured_joints);
  ScoreInput input;
  if (counted) input.counted = &*counted;
  input.rate_hz = glove.tick_rate_hz;
  input.reference_angle_rad = &*reference;
  input.hand_angle_rad = &*hand;
  if (motors) motors->PutInto(input);
  if (twin_hand) input.noise_free_hand_angle_rad = &**twin_hand;
  if (trace.grip_force_n.cols() > 0) input.grip_force_n = &trace.grip_force_n;
  if (trace.digit_overlap_m.cols() > 0) input.digit_overlap_m = &trace.digit_overlap_m;
  input.segments = glove.segments;
  const HandConfig& hand_config = study.scenario.hand;
  input.frame_ms = std::max({study.scenario.event.period_ms, hand_config.servo.numbers().frame_ms,
                             hand_config.arm_servo.numbers().frame_ms});
  input.jitter_above_hz = study.scenario.score.jitter_above_hz;
  Scores scores = ComputeScores(input, study.rows, metrics);
  // No score is -0.0, which SQLite keeps as 0.0.
  for (double& score : scores.summary) score += 0.0;
  for (std::vector<double>& channel : scores.channels) {
    for (double& score : channel) score += 0.0;
  }
  return scores;
}

}  // namespace gauntlet::sim
