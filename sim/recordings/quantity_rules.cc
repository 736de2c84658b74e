#include <algorithm>
#include <array>
#include <numbers>

#include "sim/recordings/quantities.h"
#include "sim/tables/name_words.h"

namespace gauntlet::sim {
namespace {

using enum Quantity;
using Unit = RawUnit;
using Facts = FamilyFacts;

// Limits of the rules. Each has its reason in the row that uses it.
constexpr double kMostVolts = 5.3;  // a supply of 5 V and its tolerance
constexpr double kMostJoint_deg = 200.0;

bool Any(const Facts&) { return true; }
bool IsText(const Facts& facts) { return facts.is_text; }
bool IsEmpty(const Facts& facts) { return facts.is_empty; }
bool NamesNoFinger(const Facts& facts) { return !facts.names_fingers; }
bool IsRate(const Facts& facts) { return !facts.names_fingers && facts.low >= 0.0; }
bool IsNamedNumber(const Facts& facts) { return !facts.names_fingers && facts.is_whole; }
bool IsCounter(const Facts& facts) {
  return !facts.names_fingers && facts.is_counting && facts.moving > 0;
}
bool IsNamedLabel(const Facts& facts) {
  return !facts.names_fingers && (facts.is_whole || facts.moving == 0);
}
bool IsQuaternion(const Facts& facts) { return facts.axes == "wxyz"; }
bool HasTurns(const Facts& facts) { return facts.axes == "rpy"; }
bool IsVector(const Facts& facts) { return facts.axes == "xyz"; }
bool IsInPlane(const Facts& facts) { return facts.axes == "xy"; }
/// The action of a glove or leader that LeRobot records names joints.
bool IsCommand(const Facts& facts) {
  return !facts.names_fingers || !HasWordOf(facts.words, "action actions");
}
bool IsForeign(const Facts& facts) {
  return !facts.names_fingers && !facts.words.empty() &&
         std::ranges::none_of(facts.words, [](const std::string& word) {
           return IsSensorWord(word) || IsJointWord(word);
         });
}
bool IsNotNegative(const Facts& facts) { return facts.low >= -0.01; }
bool AreShares(const Facts& facts) { return IsNotNegative(facts) && facts.high <= 1.05; }
/// Joints of a robot within 0 and 1 may be in radians, unless they reach both ends.
bool ReachShares(const Facts& facts) {
  return AreShares(facts) && (!facts.names_joints || (facts.low <= 0.05 && facts.high >= 0.95));
}
bool ArePercent(const Facts& facts) { return IsNotNegative(facts) && facts.high <= 105.0; }
bool HitPercents(const Facts& facts) { return facts.full_percent >= 2 && ArePercent(facts); }
bool AreTurning(const Facts& facts) {
  return facts.turns > 0 && facts.reach <= 400.0 && facts.turning_span <= 361.0;
}
bool AreCounts(const Facts& facts) {
  return facts.is_whole && facts.low >= 0.0 &&
         (facts.reach > 180.0 || (facts.low > 20.0 && facts.reach > 100.0));
}
/// Shares and volts are not negative, and not called by a joint.
bool FitHalfTurn(const Facts& facts) {
  return (facts.names_joints || !IsNotNegative(facts)) && facts.reach <= std::numbers::pi;
}
bool FitJoints(const Facts& facts) {
  return facts.reach <= kMostJoint_deg && (facts.names_joints || facts.reach > kMostVolts);
}

constexpr std::string_view kDegWords = "deg degree degrees";
constexpr std::string_view kRadWords = "rad radian radians";

constexpr QuantityRule kRules[] = {
    {"text", kText, Unit::kUnknown, false, "", IsText, "text", "entries without a number"},
    {"empty", kNothing, Unit::kUnknown, false, "", IsEmpty, "empty", "no value in any row"},
    {"clock_by_name", kTime, Unit::kUnknown, false,
     "time timestamp timestamps stamp date clock tick ticks elapsed epoch millis micros sec nsec "
     "secs "
     "nsecs nanosec",
     NamesNoFinger, "another time, by its name", "header.stamp of ROS, timestamp of LeRobot"},
    {"rate", kRate, Unit::kUnknown, false,
     "rate hz fps sampling frequency freq dt interval period latency", IsRate,
     "a rate or interval of rows, by its name", "sampling_hz of flex glove logs"},
    {"number_by_name", kNumber, Unit::kUnknown, false,
     "index idx id frame sample row seq sequence episode trial task repetition rerepetition rep "
     "session subject iteration packet number num nr counter step",
     IsNamedNumber, "a number of a row, episode or person, by its name",
     "frame_index, episode_index, task_index of LeRobot; repetition of Ninapro"},
    {"number_by_values", kNumber, Unit::kUnknown, false, "", IsCounter,
     "a counter: it rises by 1 and seldom starts anew", "index of pandas; packet counters"},
    {"label_by_name", kLabel, Unit::kUnknown, false,
     "label labels gesture class stimulus restimulus letter pose posture activity movement "
     "exercise "
     "phase marker trigger event annotation object",
     IsNamedLabel, "a label, by its name", "stimulus, exercise of Ninapro"},
    {"quaternion_axes", kOrientation, Unit::kUnknown, false, "", IsQuaternion,
     "an orientation: w, x, y, z", "quaternions of motion sensors"},
    {"orientation_by_name", kOrientation, Unit::kUnknown, false,
     "quat quaternion quaternions orientation orient euler rpy heading azimuth attitude direction "
     "directions normal",
     Any, "an orientation, by its name", "pose.orientation of ROS, Euler angles of motion sensors"},
    {"roll_pitch_yaw", kOrientation, Unit::kUnknown, false, "", HasTurns,
     "an orientation: roll, pitch, yaw", "angles of a motion sensor on the back of the hand"},
    {"acceleration", kAcceleration, Unit::kUnknown, false,
     "acc accel acceleration accelerometer accelerations gravity imu", Any,
     "an acceleration, by its name", "motion sensors"},
    {"angular_rate", kAngularRate, Unit::kUnknown, false, "gyr gyro gyroscope omega angvel", Any,
     "an angular rate, by its name", "motion sensors"},
    {"magnetic_field", kMagneticField, Unit::kUnknown, false, "mag magnetometer magnetic", Any,
     "a magnetic field, by its name", "motion sensors"},
    {"velocity", kVelocity, Unit::kUnknown, false,
     "velocity velocities vel speed qvel dq qd dot dps rpm", Any, "a velocity, by its name",
     "velocity of JointState of ROS"},
    {"force", kForce, Unit::kUnknown, false,
     "force forces torque torques moment moments effort efforts eff tau load pressure fsr touch "
     "tactile contact grip n newton newtons nm mnm gf kgf lbf tension loadcell "
     "pa kpa hpa mbar bar psi stiffness",
     Any, "a force or pressure, by its name", "effort of JointState of ROS; touch sensors"},
    {"current", kCurrent, Unit::kUnknown, false, "current currents ma amps ampere amperes", Any,
     "a current, by its name", "current_mA of servo logs"},
    {"temperature", kTemperature, Unit::kUnknown, false,
     "temp temperature celsius degc degf kelvin", Any, "a temperature, by its name",
     "logs of microcontrollers"},
    {"battery", kBattery, Unit::kUnknown, false, "battery bat vbat batt", Any,
     "the battery, by its name", "logs of microcontrollers"},
    {"muscle", kMuscle, Unit::kUnknown, false, "emg semg exg muscle myo uv", Any,
     "a muscle's signal, by its name", "emg of Ninapro; EXG channels of OpenBCI"},
    {"quality", kQuality, Unit::kUnknown, false,
     "confidence conf probability prob score quality valid validity status flag error err std var "
     "variance weight tracked",
     Any, "a confidence or state, by its name", "confidence of hand trackers"},
    {"command", kCommand, Unit::kUnknown, false,
     "command commands commanded cmd target targets goal desired setpoint action actions pwm duty",
     IsCommand, "a command, by its name", "action of LeRobot, goal_position of Dynamixel"},
    {"distance", kPosition, Unit::kUnknown, false,
     "distance dist length m mm cm metre metres meter meters aperture height width", Any,
     "a distance, by its name", "apertures of motion capture"},
    {"rotation_axes", kOrientation, Unit::kUnknown, false, "rotation rotations rot", IsVector,
     "a rotation about x, y and z", "RightDigit2Proximal_rotation_x of Rokoko"},
    {"position", kPosition, Unit::kUnknown, false, "", IsVector, "a vector in space: x, y, z",
     "Thumb_MCP_Position_X of Manus, landmarks of MediaPipe"},
    {"plane", kPosition, Unit::kUnknown, false, "", IsInPlane, "a point in a plane: x, y",
     "landmarks in an image, sticks of controllers"},
    {"foreign_name", kUnknown, Unit::kUnknown, false, "", IsForeign,
     "its name is neither a finger's nor a glove's", "columns of other devices"},

    {"deg_by_name", kSensor, Unit::kDegrees, false, kDegWords, Any, "the names say degrees",
     "suffixes of column names"},
    {"rad_by_name", kSensor, Unit::kRadians, false, kRadWords, Any, "the names say radians",
     "suffixes of column names"},
    {"mrad_by_name", kSensor, Unit::kMilliradians, false, "mrad milliradian milliradians", Any,
     "the names say thousandths of radians", "suffixes of column names"},
    {"other_unit", kSensor, Unit::kUnknown, false,
     "ohm ohms kohm mohm resistance resistances ph pf nf uf farad capacitance siemens us mdeg cdeg "
     "ddeg grad gon rev revs turns revolutions cos cosine sin sine tan",
     Any, "in a unit by their names whose angles are unknown", "resistances of flex sensors"},
    {"volts_by_name", kSensor, Unit::kVolts, false, "v volt volts voltage mv", Any,
     "the names say volts", "suffixes of column names"},
    {"counts_by_name", kSensor, Unit::kCounts, false, "counts count adc raw", IsNotNegative,
     "the names say counts", "suffixes of column names"},
    {"share_by_name", kSensor, Unit::kShare, false,
     "norm normalized normalised share ratio percent", AreShares,
     "the names say share, within 0 and 1", "ch0_norm of textile gloves"},
    {"percent_by_name", kSensor, Unit::kShare, false,
     "percent pct norm normalized normalised share", ArePercent,
     "the names say share, within 0 and 100", "percent of a joint's range"},
    {"turns", kSensor, Unit::kDegrees, false, "", AreTurning, "it jumps by 360, as degrees do",
     "wrist_roll of LeRobot"},
    {"counts", kSensor, Unit::kCounts, false, "", AreCounts,
     "whole numbers, more than an angle has", "converters give whole numbers from 0"},
    {"percent", kSensor, Unit::kShare, true, "", HitPercents, "from exactly 0 to exactly 100",
     "curl of hand trackers in percent"},
    {"share", kSensor, Unit::kShare, true, "", ReachShares, "within 0 and 1",
     "normalised sensors of data gloves"},
    {"radians", kSensor, Unit::kRadians, true, "", FitHalfTurn,
     "no more than half a turn in radians", "joints of ROS and MuJoCo"},
    {"degrees", kSensor, Unit::kDegrees, true, "", FitJoints, "as many as a joint has degrees",
     "most gloves with a calibration"},
    {"unknown_unit", kSensor, Unit::kUnknown, false, "", Any, "of an unknown unit",
     "bend sensors at 3.3 or 5 V, filtered or scaled counts"},
};

}  // namespace

std::span<const QuantityRule> QuantityRules() { return kRules; }

std::string_view NameOf(RawUnit unit) {
  constexpr std::array<std::string_view, 7> kNames = {"counts", "share", "deg",    "rad",
                                                      "mrad",   "volts", "unknown"};
  return kNames[static_cast<std::size_t>(unit)];
}

std::string_view NameOf(Quantity quantity) {
  constexpr std::array<std::string_view, 21> kNames = {
      "text",        "nothing",      "time",         "rate",           "number",   "label",
      "orientation", "acceleration", "angular rate", "magnetic field", "position", "velocity",
      "force",       "current",      "temperature",  "battery",        "muscle",   "quality",
      "command",     "unknown",      "sensor"};
  return kNames[static_cast<std::size_t>(quantity)];
}

}  // namespace gauntlet::sim
