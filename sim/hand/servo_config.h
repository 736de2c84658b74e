#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "controller/kinds.h"
#include "controller/settings.h"

namespace gauntlet::sim {

/// Which current a servo measures and limits.
enum class LimitedCurrent {
  kMotor,   // torque is limited in proportion
  kSupply,  // torque at stall goes as the square root of the limit
};

/// Numbers of any position servo on a spool. Stall torques, rotors and dry friction stand in the
/// model file, since a shoulder needs another motor than a finger; here stand the laws that motors
/// of one make share, and factors on the model's numbers.
///
/// The values here are those of the kind `standard`; other kinds set what they know better.
struct ServoNumbers {
  // Command input.
  int resolution_bits = 10;   // the command has 2^bits steps over the travel
  double travel_deg = 300.0;  // of the spool, end to end
  double frame_ms = 20.0;     // a new command is taken only at a frame; 0: at once
  bool free_running = false;  // frames of its own, out of step with commands and other motors
  double dead_time_ms = 0.0;  // from the frame until the motor knows of it
  // Sensor of the spool.
  int sensor_bits = 0;            // 2^bits steps over the travel; 0: exact
  double sensor_noise_deg = 0.0;  // standard deviation of a reading
  // Control law.
  double dead_band_deg = 0.2;          // errors up to this cause no torque, to either side
  double full_torque_error_deg = 1.5;  // gain: error beyond the dead band for the stall torque
  double damping_ms = 12.0;            // speed that is braked as much as an error is pulled
  // Motor and gear.
  double no_load_speed_deg_s = 400.0;  // back-EMF: torque falls linearly to zero at this speed
  double torque_scale = 1.0;           // on the stall torques of the model
  double stall_current_ma = 0.0;       // at the stall torque; 0: not known
  double current_limit_ma = 0.0;       // 0: none
  LimitedCurrent limited_current = LimitedCurrent::kMotor;
  double inertia_scale = 1.0;   // on the inertia of the model's spools
  double friction_scale = 1.0;  // on the dry friction of the model's spools
  double load_friction = 0.0;   // and so much of the torque that the cables ask for
  double play_deg = 0.0;        // of the gear, end to end

  void Visit(controller::SettingsVisitor& visitor);
};

/// Source: a common 10-bit RC servo (300 deg of travel, 0.15 s per 60 deg, one frame per 20 ms);
/// dead band, gain and damping are assumptions (docs/explanation/hand-model.md).
struct StandardServo : ServoNumbers {
  static constexpr std::string_view kKind = "standard";
  static constexpr std::string_view kSummary =
      "a lively 10-bit servo whose frames are in step with the commands";
};

/// Nothing but the motor's torque and rotor stands between command and spool.
struct IdealServo : ServoNumbers {
  static constexpr std::string_view kKind = "ideal";
  static constexpr std::string_view kSummary =
      "takes every command at once, in 16 bits, without friction, dead band or a limit of speed";
  IdealServo();
};

/// As the SG-90 of the measurements in docs/evidence/hand.md.
struct RcAnalogServo : ServoNumbers {
  static constexpr std::string_view kKind = "rc_analog";
  static constexpr std::string_view kSummary =
      "a small RC servo with analog electronics, as SG-90: late, quick, with a wide dead band";
  RcAnalogServo();
};

struct RcDigitalServo : ServoNumbers {
  static constexpr std::string_view kKind = "rc_digital";
  static constexpr std::string_view kSummary =
      "an RC servo that reads pulses every 20 ms, but corrects its position all the time";
  RcDigitalServo();
};

/// As the STS3215 of the measurements in docs/evidence/hand.md.
struct BusServo : ServoNumbers {
  static constexpr std::string_view kKind = "bus";
  static constexpr std::string_view kSummary =
      "a serial bus servo with its maker's soft gain, as STS3215: fine steps, follows late";
  BusServo();
};

struct DynamixelServo : ServoNumbers {
  static constexpr std::string_view kKind = "dynamixel";
  static constexpr std::string_view kSummary =
      "a serial bus servo of 12 bits whose friction grows with the load, as XL330, with its whole "
      "current";
  DynamixelServo();
};

/// DynamixelServo with four times the position gain, as an engineer sets it to overcome friction.
struct StiffDynamixelServo : DynamixelServo {
  static constexpr std::string_view kKind = "dynamixel_stiff";
  static constexpr std::string_view kSummary =
      "as dynamixel with four times the gain (P 2400, D 4000): friction leaves less of an error";
  StiffDynamixelServo();
};

/// DynamixelServo as the program of the LEAP Hand sets it.
struct LeapServo : DynamixelServo {
  static constexpr std::string_view kKind = "leap";
  static constexpr std::string_view kSummary =
      "as dynamixel with the settings of the LEAP Hand: P 600, D 200, current at most 350 mA";
  LeapServo();
};

/// DynamixelServo as the program of the ORCA hand sets it.
struct OrcaServo : DynamixelServo {
  static constexpr std::string_view kKind = "orca";
  static constexpr std::string_view kSummary =
      "as dynamixel with the settings of the ORCA hand: P 400, current at most 300 mA";
  OrcaServo();
};

/// Servos of elbow and shoulder, in parallel as far as the model's stall torque needs them.
struct MxServo : ServoNumbers {
  static constexpr std::string_view kKind = "dynamixel_mx";
  static constexpr std::string_view kSummary =
      "a serial bus servo for arms, as MX-106 with its maker's gain";
  MxServo();
};

/// Every kind of servo that there is. To add one: a struct of its numbers, and one entry here.
class ServoSettings
    : public std::variant<StandardServo, IdealServo, RcAnalogServo, RcDigitalServo, BusServo,
                          DynamixelServo, StiffDynamixelServo, LeapServo, OrcaServo, MxServo> {
 public:
  using variant::variant;
  ServoSettings();
  ServoSettings(const ServoSettings& other);
  ServoSettings(ServoSettings&& other) noexcept;
  ServoSettings& operator=(const ServoSettings& other);
  ServoSettings& operator=(ServoSettings&& other) noexcept;
  ~ServoSettings() = default;
};

/// Position servos of one kind. A kind brings all its numbers; what is said beside `kind`
/// replaces one of them.
struct ServoConfig {
  ServoSettings settings = DynamixelServo{};  // why: docs/explanation/hand-model.md

  std::string_view kind() const { return controller::KindName(settings); }
  const ServoNumbers& numbers() const;
  ServoNumbers& numbers();
  void Visit(controller::SettingsVisitor& visitor);
};

/// All kinds, in the order of every list.
using ServoKind = controller::Kind<ServoConfig>;
std::span<const ServoKind> ServoKinds();

}  // namespace gauntlet::sim
