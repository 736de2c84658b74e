#include "sim/study/trial_score.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/base/few_signals_on_heap.h"
#include "sim/study/counted_parts.h"
#include "sim/trial/latency_of_trace.h"

namespace gauntlet::sim {
namespace {

/// Tension of each measured cable while its motor stalls [N].
std::vector<double> StallTensions(const Study& study) {
  std::vector<double> tensions;
  for (const int motor : study.measured_motors) {
    const Drive& drive = study.hand->drives()[static_cast<std::size_t>(motor)];
    tensions.insert(tensions.end(), drive.cables.size(),
                    drive.servo.stall_torque_nm / drive.drum_radius_m);
  }
  return tensions;
}

/// Per measured motor the share of the ticks that count in which it is saturated.
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

/// Some columns of a signal that may not be recorded.
template <class Matrix>
class RecordedColumns {
 public:
  RecordedColumns(const Matrix& whole, const std::vector<int>& columns) {
    if (whole.cols() > 0) columns_.emplace(whole, columns);
  }
  /// Null if it is not.
  const Matrix* get() const { return columns_ ? &**columns_ : nullptr; }

 private:
  std::optional<Columns<Matrix>> columns_;
};

/// Recorded signals of the motors and cables of a trial and of its twin.
struct MeasuredMotors {
  MeasuredMotors(const Study& study, const Trace& trace, const std::optional<NoiseFreeTwin>& twin,
                 const std::optional<CountedParts>& counted)
      : command(trace.command_counts, study.measured_motors),
        speed(trace.spool_speed_rad_s, study.measured_motors),
        tension(trace.tension_n, study.measured_cables) {
    if (tension.get() != nullptr) stall_tension_n = StallTensions(study);
    if (trace.sample_age_s.cols() > 0) {
      for (const int motor : study.measured_motors) {
        const auto place = static_cast<std::size_t>(motor);
        deg_per_count.push_back(
            std::abs(kDegPerRad / study.hand->transmission().counts_per_rad[place]));
      }
    }
    if (trace.motor_at_limit.cols() > 0) {
      saturation_share = SaturationShares(study, trace.motor_at_limit, counted);
    }
    if (!twin || twin->spool_speed_rad_s.cols() == 0) return;
    twin_speed.emplace(twin->spool_speed_rad_s, study.measured_motors);
  }

  void PutInto(ScoreInput& input) const {
    input.command_counts = command.get();
    input.motor_speed_rad_s = speed.get();
    input.tension_n = tension.get();
    input.saturation_share = saturation_share;
    input.deg_per_count = deg_per_count;
    input.stall_tension_n = stall_tension_n;
    if (twin_speed) input.noise_free_motor_speed_rad_s = &**twin_speed;
  }

  RecordedColumns<IntegerSignal> command;
  RecordedColumns<Signal> speed;
  RecordedColumns<Signal> tension;
  std::vector<double> stall_tension_n;
  std::vector<double> saturation_share;
  std::vector<double> deg_per_count;  // empty without links
  std::optional<Columns<Signal>> twin_speed;
};

/// Takes ticks away from all parts.
void LeaveOut(const Study& study, std::span<const TickRange> left_out, const Trace& trace,
              std::optional<CountedParts>& counted) {
  if (left_out.empty()) return;
  if (!counted) {
    const CountedTicks all = {{0, static_cast<int>(trace.hand_angle_rad.rows())}};
    counted = CountedParts{.joints = {study.measured_joints.size(), all},
                           .motors = {study.measured_motors.size(), all},
                           .cables = {study.measured_cables.size(), all},
                           .hand = all};
  }
  for (const TickRange& ticks : left_out) {
    for (std::vector<CountedTicks>* parts :
         {&counted->joints, &counted->motors, &counted->cables}) {
      for (CountedTicks& part : *parts) part = Without(part, ticks);
    }
    counted->hand = Without(counted->hand, ticks);
  }
}

/// The signals that a metric of such a part needs.
std::vector<std::string_view> SignalsOf(ScoredPart part) {
  switch (part) {
    case ScoredPart::kJoint:
      return {"hand_angle_rad"};
    case ScoredPart::kMotor:
      return {"command_counts", "spool_speed_rad_s", "motor_at_limit", "sample_age_s",
              "watchdog_tier"};
    case ScoredPart::kCable:
      return {"tension_n"};
    case ScoredPart::kHand:
      return {"grip_force_n",      "object_pose",     "object_in_palm", "object_force_n",
              "palm_velocity_m_s", "digit_overlap_m", "sample_age_s",   "watchdog_tier"};
  }
  return {};
}

/// Null if the signal is not recorded.
template <class Scalar>
const SignalOf<Scalar>* Recorded(const SignalOf<Scalar>& signal) {
  return signal.cols() > 0 ? &signal : nullptr;
}

/// Fingertips of a hand and of the wearer, as the kinematics of the hand give them.
class MeasuredFingertips {
 public:
  MeasuredFingertips(const Study& study, const Signal& reference_rad, const Signal& hand_rad,
                     double rate_hz)
      : ticks_per_row_(std::max(1, static_cast<int>(std::lround(rate_hz / kFingertipRate_hz)))),
        hand_m_(study.fingertips->Places(hand_rad, ticks_per_row_)),
        reference_m_(study.fingertips->Places(reference_rad, ticks_per_row_)) {
    const int tips = std::ssize(study.fingertips->names());
    const auto is_measured = [&study](int tip) {
      return std::ranges::any_of(study.measured_joints, [&](int joint) {
        return study.fingertips->Moves(joint, static_cast<std::size_t>(tip));
      });
    };
    for (int tip = 0; tip < tips; ++tip) {
      if (is_measured(tip)) measured_.push_back(tip);
      if (tip > 0 && (is_measured(0) || is_measured(tip))) pinches_.emplace_back(0, tip);
    }
  }

  FingertipSignals Signals() const {
    return {.hand_m = &hand_m_,
            .reference_m = &reference_m_,
            .ticks_per_row = ticks_per_row_,
            .measured = measured_,
            .pinches = pinches_};
  }

 private:
  static constexpr double kFingertipRate_hz = 100.0;

  int ticks_per_row_;
  Signal hand_m_;
  Signal reference_m_;
  std::vector<int> measured_;
  std::vector<std::pair<int, int>> pinches_;
};

/// No score is -0.0, which SQLite keeps as 0.0.
Scores WithoutSign(Scores scores) {
  for (double& score : scores.summary) score += 0.0;
  for (std::vector<double>& channel : scores.channels) {
    for (double& score : channel) score += 0.0;
  }
  return scores;
}

}  // namespace

std::vector<std::string_view> SignalsOfScores(std::span<const std::size_t> metrics) {
  std::vector<std::string_view> signals = SignalsOf(ScoredPart::kJoint);  // tell how long it was
  const auto add = [&signals](std::span<const std::string_view> more) {
    for (const std::string_view signal : more) {
      if (std::ranges::find(signals, signal) == signals.end()) signals.push_back(signal);
    }
  };
  const auto add_metric = [&](const Metric& metric) {
    add(SignalsOf(metric.part));
    if (metric.needs_twin) add(kTwinSignals);
  };
  for (const std::size_t metric : metrics) add_metric(Metrics()[metric]);
  if (metrics.empty()) std::ranges::for_each(Metrics(), add_metric);
  return signals;
}

Scores ScoreTrial(const Study& study, const controller::ControllerConfig& controller,
                  const GloveSignal& glove, const Signal& reference_rad, const Trace& trace,
                  const std::optional<NoiseFreeTwin>& twin, std::span<const std::size_t> metrics,
                  const CauseAngles& others, std::span<const TickRange> left_out) {
  ReturnFreedMemory();  // of the trial, or of other scores
  const Columns reference(reference_rad, study.measured_joints);
  const Columns hand(trace.hand_angle_rad, study.measured_joints);
  const std::optional<CountedParts> counted =
      CountedPartsOf(study, glove.masked, static_cast<int>(trace.hand_angle_rad.rows()));
  const MeasuredMotors motors(study, trace, twin, counted);
  std::optional<Columns<Signal>> twin_hand;
  if (twin) twin_hand.emplace(twin->hand_angle_rad, study.measured_joints);
  std::optional<CountedParts> scored = counted;
  LeaveOut(study, left_out, trace, scored);
  ScoreInput input;
  if (scored) input.counted = &*scored;
  input.rate_hz = glove.tick_rate_hz;
  input.reference_angle_rad = &*reference;
  input.hand_angle_rad = &*hand;
  motors.PutInto(input);
  if (twin_hand) input.noise_free_hand_angle_rad = &**twin_hand;
  input.grip_force_n = Recorded(trace.grip_force_n);
  input.object_force_n = Recorded(trace.object_force_n);
  input.object_pose = Recorded(trace.object_pose);
  input.object_in_palm = Recorded(trace.object_in_palm);
  input.object_friction = study.hand->config().object.friction;
  input.palm_velocity_m_s = Recorded(trace.palm_velocity_m_s);
  input.digit_overlap_m = Recorded(trace.digit_overlap_m);
  input.sample_age_s = Recorded(trace.sample_age_s);
  input.watchdog_tier = Recorded(trace.watchdog_tier);
  const controller::Timing& timing = study.hand->timing().controller;
  input.ticks_per_command = timing.TicksOf(timing.event_period_ms);
  std::optional<MeasuredFingertips> fingertips;
  if (study.fingertips && (metrics.empty() || AnyNeeds(metrics, &Metric::needs_fingertips))) {
    fingertips.emplace(study, reference_rad, trace.hand_angle_rad, glove.tick_rate_hz);
    input.fingertips = fingertips->Signals();
  }
  input.segments = glove.segments;
  std::array<std::optional<Columns<Signal>>, kCauseTrialCount> measured_without;
  for (std::size_t i = 0; i < kCauseTrialCount; ++i) {
    if (others.without[i].cols() == 0) continue;
    measured_without[i].emplace(others.without[i], study.measured_joints);
    input.without[i] = &**measured_without[i];
  }
  std::array<std::optional<Columns<Signal>>, kSwitchedCauseCount> measured_switched;
  input.switched_off_ticks = static_cast<int>(others.switched_off_ticks);
  for (std::size_t i = 0; i < kSwitchedCauseCount; ++i) {
    if (others.switched_off[i].cols() == 0) continue;
    measured_switched[i].emplace(others.switched_off[i], study.measured_joints);
    input.switched_off[i] = &**measured_switched[i];
  }
  static_assert(kSwitchedCauses.front() == ErrorCause::kNoise);
  if (input.switched_off_ticks > 0) input.switched_off[0] = input.noise_free_hand_angle_rad;
  const RecordedColumns<Signal> arm_at_rest(others.arm_at_rest, study.measured_joints);
  input.arm_at_rest_angle_rad = arm_at_rest.get();
  input.earliest_delay_s = EarliestDelay_s(*study.hand, controller);
  input.jitter_above_hz = study.scenario.score.jitter_above_hz;
  return WithoutSign(ComputeScores(input, study.rows, metrics));
}

}  // namespace gauntlet::sim
