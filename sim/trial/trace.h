#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sim/base/signal.h"
#include "sim/hand/hand.h"
#include "sim/score/error_causes.h"

namespace gauntlet::sim {

/// 1 where something is the case, else 0.
using FlagSignal = SignalOf<std::uint8_t>;

/// Type in trace.h5 of a value in memory. Signals are kept with 24 significant bits: 1e-7 of an
/// angle is far below what any joint can show, every count of an ADC is exact, and a long trace
/// takes half the disk and half the time. They are rounded when they are recorded, so a score that
/// is computed again from the file begins with the same numbers.
template <class Scalar>
using Stored = std::conditional_t<std::is_same_v<Scalar, double>, float, Scalar>;

/// Everything that happened in one trial, one row per tick.
struct Trace {
  std::string controller_name;
  Signal linearised_angle_rad;   // ticks x channels: before the filter; held between samples
  Signal filtered_angle_rad;     // ticks x channels
  Signal target_angle_rad;       // ticks x joints: what the motors were last asked for
  IntegerSignal command_counts;  // ticks x motors: the frame that the servos hold
  Signal spool_angle_rad;        // ticks x motors
  Signal spool_speed_rad_s;      // ticks x motors
  FlagSignal motor_at_limit;     // ticks x motors: actuator saturation
  Signal hand_angle_rad;         // ticks x joints
  Signal measured_angle_rad;     // ticks x joints: by their sensors; no columns without them
  Signal tension_n;              // ticks x cables
  Signal grip_force_n;           // ticks x 1; no columns without an object
  Signal digit_overlap_m;        // ticks x 1; no columns without digits
  Signal palm_velocity_m_s;      // ticks x 3, in the world; no columns where the palm stands still
  Signal object_pose;            // ticks x 7: position [m] and quaternion; as above
  Signal object_in_palm;         // the same in the frame of the palm
  Signal object_force_n;         // ticks x 2: carried by the hand, by the support; as above
  Signal sample_age_s;           // ticks x 1: of the glove sample behind the command; no columns
                                 // without links
  FlagSignal watchdog_tier;      // ticks x 1: 0 follow, 1 hold, 2 relax, 3 off; as above
  std::vector<std::int64_t> untrusted_samples;  // per channel
  HandHealth health;  // not ok: the signals end at the moment of the problem
};

/// Motion of the same trial with a noise-free glove, tick by tick: what remains without it is the
/// noise's.
struct NoiseFreeTwin {
  Signal hand_angle_rad;     // ticks x joints
  Signal spool_speed_rad_s;  // ticks x motors
};
/// The signals of a trace that it is made of.
inline constexpr std::string_view kTwinSignals[] = {"hand_angle_rad", "spool_speed_rad_s"};

/// The hand's angles of the trials for the causes of the error, ticks x joints; without columns
/// where there is no such trial.
struct CauseAngles {
  /// One cause after the other is taken away, see ErrorCause: the last are what the controller asks
  /// for.
  std::array<Signal, kCauseTrialCount> without;
  /// One of kSwitchedCauses is off. That of noise is in the noise-free twin.
  std::array<Signal, kSwitchedCauseCount> switched_off;
  Signal arm_at_rest;  // of the trial in which nothing is wrong but that the arm stands still
  Eigen::Index switched_off_ticks = 0;  // of these and of arm_at_rest; 0: they did not run
};

}  // namespace gauntlet::sim
