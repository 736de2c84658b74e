#include "sim/hand/servo_config.h"

#include <array>

namespace gauntlet::sim {

using controller::SettingsVisitor;

void ServoNumbers::Visit(SettingsVisitor& visitor) {
  visitor.Integer(
      {"resolution_bits", "position commands have 2^bits counts over the travel", 6, 20},
      resolution_bits);
  visitor.Number({"travel_deg", "how far a spool turns, end to end", 30, 3600}, travel_deg);
  visitor.Number({"frame_ms",
                  "the servo takes a new command only at its own frames, which begin with the "
                  "first command unless they run free; 0: at once",
                  0, 1000},
                 frame_ms);
  visitor.Flag({"free_running",
                "each motor's frames are out of step with commands and with other motors, by a "
                "part of a frame that is the same in every run"},
               free_running);
  visitor.Number(
      {"dead_time_ms", "from the frame that takes a command until the motor knows of it", 0, 500},
      dead_time_ms);
  visitor.Integer({"sensor_bits",
                   "the servo reads its spool in 2^bits steps over the travel; 0: exactly", 0, 20},
                  sensor_bits);
  visitor.Number(
      {"sensor_noise_deg", "standard deviation of each reading of the spool, every 1 ms", 0, 5},
      sensor_noise_deg);
  visitor.Number(
      {"dead_band_deg", "spool errors up to this, to either side, cause no torque", 0, 30},
      dead_band_deg);
  visitor.Number({"full_torque_error_deg",
                  "spool error beyond the dead band that calls for the stall torque", 0.5, 90},
                 full_torque_error_deg);
  visitor.Number({"damping_ms", "velocity gain over position gain of the servo", 0, 100},
                 damping_ms);
  visitor.Number(
      {"no_load_speed_deg_s", "spool speed at which back-EMF leaves no torque", 1, 10000},
      no_load_speed_deg_s);
  visitor.Number({"torque_scale", "factor on the stall torques of the model", 1e-9, 10},
                 torque_scale);
  visitor.Number({"stall_current_ma", "current at the stall torque; 0: not known", 0, 100000},
                 stall_current_ma);
  visitor.Number(
      {"current_limit_ma",
       "limit of the current, at most stall_current_ma, which must be known; 0: none", 0, 100000},
      current_limit_ma);
  static constexpr std::array<std::string_view, 2> kCurrents = {"motor", "supply"};
  controller::VisitEnum(
      visitor,
      {"limited_current",
       "what the servo measures: the motor's current, to which torque is in proportion, or the "
       "supply's, of which the torque at stall is the square root"},
      kCurrents, limited_current);
  visitor.Number(
      {"inertia_scale", "factor on the inertia of the model's spools, rotors behind their gears",
       0.1, 100},
      inertia_scale);
  visitor.Number({"friction_scale", "factor on the dry friction of the model's spools", 0, 100},
                 friction_scale);
  visitor.Number(
      {"load_friction",
       "friction of the gear that grows with its load: share of the torque of the cables", 0, 0.9},
      load_friction);
  visitor.Number(
      {"play_deg", "backlash of the gear, end to end; adds to hand.cable.backlash_deg", 0, 30},
      play_deg);
}

// A number that is not said to come from somewhere is an assumption. Back-EMF of a motor that is
// driven by a voltage damps by full_torque_error / no_load_speed, which is in damping_ms.

IdealServo::IdealServo() {
  resolution_bits = 16;
  frame_ms = 0.0;
  dead_band_deg = 0.0;
  damping_ms = 9.0;               // critical for the model's finger motors
  no_load_speed_deg_s = 10000.0;  // the largest that is allowed
  friction_scale = 0.0;
}

// Fitted: dead time and motor to steps of 10 to 135 deg of an SG-90,
// JasperGrant/SG-90-Servo-Characterization (log.txt). Pulses come every 20 ms there.
RcAnalogServo::RcAnalogServo() {
  free_running = true;
  dead_time_ms = 24.0;           // fitted
  dead_band_deg = 0.5;           // half of the 10 us that sellers give, at 2 ms for 180 deg
  full_torque_error_deg = 15.0;  // fitted
  damping_ms = 35.0;             // fitted
  no_load_speed_deg_s = 690.0;   // fitted; sellers give 0.1 s for 60 deg
  inertia_scale = 7.0;           // fitted: a mechanical time constant of 56 ms for a finger
  play_deg = 0.5;                // plastic gears
}

RcDigitalServo::RcDigitalServo() {
  free_running = true;
  resolution_bits = 11;  // pulses to 1 us of 2 ms
  dead_time_ms = 3.0;    // the pulse, and one turn of its loop
  sensor_bits = 12;      // a converter on a potentiometer
  sensor_noise_deg = 0.05;
  dead_band_deg = 0.1;  // half of 2 us
  full_torque_error_deg = 5.0;
  damping_ms = 25.0;
  no_load_speed_deg_s = 500.0;  // 0.12 s for 60 deg
  inertia_scale = 6.0;          // time constant of 35 ms for a finger
  play_deg = 0.3;               // metal gears
}

// Motor and friction: Rhoban/bam, feetech_sts3215_7_4V, model M3: kt 1.26 V s, R 2.45 ohm, 0.0235
// kg m2, friction 0.056 N m and 0.21 of the load, 3.8 N m at stall; the finger motor is smaller by
// its stall torque. Travel and resolution: 4096 steps a turn.
BusServo::BusServo() {
  resolution_bits = 12;
  travel_deg = 360.0;
  frame_ms = 5.0;  // a bus of 17 servos takes 4.5 to 12 ms a turn: orcahand/orca_core, docs
  free_running = true;
  dead_time_ms = 27.0;  // fitted: 100 ms behind a sine, giacomoran/so101-data-collection
  sensor_bits = 12;
  dead_band_deg = 0.1;           // one step
  full_torque_error_deg = 18.0;  // bam: gain of 16, as teleoperation sets it
  damping_ms = 54.0;             // back-EMF
  no_load_speed_deg_s = 335.0;   // bam: 7.4 V / kt
  inertia_scale = 9.2;           // bam: a time constant of 36 ms
  friction_scale = 0.8;          // bam
  load_friction = 0.21;          // bam
  play_deg = 0.3;
}

// Motor and friction: Rhoban/bam, XL330: 2.0e-3 kg m2, 0.013 N m and 0.27 of the load, a mechanical
// time constant of 43 to 51 ms; ROBOTIS e-manual of XL330-M288: 4096 steps a turn, 103 rev/min;
// its gains P of 600 and D of 200 as the LEAP Hand sets them (leap-hand/LEAP_Hand_API, main.py).
DynamixelServo::DynamixelServo() {
  resolution_bits = 12;
  travel_deg = 360.0;
  frame_ms = 5.0;  // as above
  free_running = true;
  dead_time_ms = 2.0;  // its loop of 1 ms, and the bus
  sensor_bits = 12;
  dead_band_deg = 0.0;
  full_torque_error_deg = 16.6;  // e-manual: P of 600 reaches the largest PWM at 189 steps
  damping_ms = 30.0;             // back-EMF; 3 ms of them D, if it is of steps per ms
  no_load_speed_deg_s = 618.0;   // e-manual
  stall_current_ma = 1470.0;     // e-manual, at 5 V
  inertia_scale = 6.5;           // bam: 47 ms, which is 2.0e-3 kg m2 for a finger
  friction_scale = 1.6;          // bam
  load_friction = 0.27;          // bam
  play_deg = 0.25;
}

StiffDynamixelServo::StiffDynamixelServo() {
  full_torque_error_deg = 4.15;  // e-manual: P of 2400, of at most 16383
  damping_ms = 20.0;             // back-EMF, and 13 ms of D of 4000
}

// leap-hand/LEAP_Hand_API, main.py, of the version with XL330. Which current the servo measures is
// open: the manual gives torque over current as a line, Rhoban/bam found that of the supply.
LeapServo::LeapServo() { current_limit_ma = 350.0; }

// orcahand/orca_core, config of version 2 (version 1: 400 mA), which sets no gains.
OrcaServo::OrcaServo() {
  full_torque_error_deg = 24.9;  // e-manual: P of 400
  damping_ms = 40.3;             // back-EMF
  current_limit_ma = 300.0;
}

// Motor and friction: Rhoban/bam, mx106, model M3: kt 2.20 V s, R 2.65 ohm, 0.0248 kg m2, friction
// 0.113 N m and 0.11 of the load; its gain and largest duty by oscilloscope. At 15 V, as there, 12
// N m at stall: the arm's motors are 1.3 and 3.2 of them. ROBOTIS e-manual of MX-106: 4096 steps a
// turn, backlash of 20 minutes of arc.
MxServo::MxServo() {
  resolution_bits = 12;
  travel_deg = 360.0;
  frame_ms = 5.0;  // as above
  free_running = true;
  dead_time_ms = 2.0;  // as above
  sensor_bits = 12;
  dead_band_deg = 0.0;
  full_torque_error_deg = 10.9;  // bam: duty 0.158 x 32 per rad, at most 0.9625
  damping_ms = 29.0;             // back-EMF
  no_load_speed_deg_s = 375.0;   // bam; e-manual: 330 at 14.8 V
  inertia_scale = 1.6;           // bam: 2.1e-3 kg m2 for each N m of stall torque
  friction_scale = 1.0;          // bam: 0.94 % of the stall torque
  load_friction = 0.11;          // bam
  play_deg = 0.33;               // e-manual
}

const ServoNumbers& ServoConfig::numbers() const {
  return std::visit([](const ServoNumbers& numbers) -> const ServoNumbers& { return numbers; },
                    settings);
}

ServoNumbers& ServoConfig::numbers() {
  return std::visit([](ServoNumbers& numbers) -> ServoNumbers& { return numbers; }, settings);
}

ServoSettings::ServoSettings() = default;
ServoSettings::ServoSettings(const ServoSettings& other) = default;
ServoSettings::ServoSettings(ServoSettings&& other) noexcept = default;
ServoSettings& ServoSettings::operator=(const ServoSettings& other) = default;
ServoSettings& ServoSettings::operator=(ServoSettings&& other) noexcept = default;

void ServoConfig::Visit(SettingsVisitor& visitor) {
  controller::VisitKind(visitor, {"kind", "which servo the motors have"}, settings);
}

std::span<const ServoKind> ServoKinds() { return controller::AllKinds<ServoConfig>(); }

}  // namespace gauntlet::sim
