#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/trial/loop/hand_loop.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// Kind of the columns of a signal.
enum class TraceColumns {
  kChannels,
  kJoints,
  kMotors,
  kCables,
  kGrip,
  kPose,
  kForces,
  kDigits,
  kSensors,
  kLinks,
  kPalm
};

/// Names of the columns of all signals of one glove and hand.
class TraceColumnNames {
 public:
  TraceColumnNames(std::vector<std::string> channels, const HandModel& hand, bool has_links = true)
      : names_{std::move(channels), hand.joint_names(), hand.motor_names(), hand.cable_names()} {
    if (hand.transmission().joint_sensors)
      names_[Place(TraceColumns::kSensors)] = hand.joint_names();
    if (hand.digits().exist()) names_[Place(TraceColumns::kDigits)] = {"deepest"};
    if (hand.moving_palm() >= 0) names_[Place(TraceColumns::kPalm)] = {"x", "y", "z"};
    if (has_links) names_[Place(TraceColumns::kLinks)] = {"link"};
    if (!hand.grasp().exists()) return;
    names_[Place(TraceColumns::kGrip)] = {"object"};
    names_[Place(TraceColumns::kForces)] = {"hand", "support"};
    names_[Place(TraceColumns::kPose)] = {"x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"};
  }
  /// Nothing for what the hand does not have: an object, digits, joint sensors, a palm that moves;
  /// and for links that there are not.
  const std::vector<std::string>& Of(TraceColumns columns) const { return names_[Place(columns)]; }

 private:
  static std::size_t Place(TraceColumns columns) { return static_cast<std::size_t>(columns); }
  std::vector<std::string> names_[11];
};

/// One signal of a trace: what it is, and how its values of this tick are read from the loop.
template <class Scalar>
struct TraceSignal {
  std::string_view name;
  std::string_view unit;
  TraceColumns columns;
  void (*read)(const HandLoop& loop, std::span<Scalar> row);
};

/// Shows every signal of a trace once: `visit(TraceSignal, matrix)`. The one list that the
/// recorder, the writers and the reader of trace files share: a signal is a field of Trace and a
/// row here. Those of an object, of digits, of joint sensors, of a moving palm or of links have
/// no columns, and no place in a file, unless there are any.
template <class TraceType, class Visit>
void ForEachSignal(TraceType& trace, Visit&& visit) {
  using Loop = const HandLoop&;
  using Row = std::span<double>;
  const auto number = [&](std::string_view name, std::string_view unit, TraceColumns columns,
                          auto& matrix, void (*read)(Loop, Row)) {
    visit(TraceSignal<double>{name, unit, columns, read}, matrix);
  };
  number("linearised_angle_rad", "rad", TraceColumns::kChannels, trace.linearised_angle_rad,
         [](Loop loop, Row row) {
           std::ranges::copy(loop.controller().linearised_angle_rad(), row.begin());
         });
  number("filtered_angle_rad", "rad", TraceColumns::kChannels, trace.filtered_angle_rad,
         [](Loop loop, Row row) {
           std::ranges::copy(loop.controller().filtered_angle_rad(), row.begin());
         });
  number("target_angle_rad", "rad", TraceColumns::kJoints, trace.target_angle_rad,
         [](Loop loop, Row row) {
           std::ranges::copy(loop.controller().target_angle_rad(), row.begin());
         });
  visit(TraceSignal<int>{"command_counts", "counts", TraceColumns::kMotors,
                         [](Loop loop, std::span<int> row) {
                           std::ranges::copy(loop.hand().command(), row.begin());
                         }},
        trace.command_counts);
  number("spool_angle_rad", "rad", TraceColumns::kMotors, trace.spool_angle_rad,
         [](Loop loop, Row row) { loop.hand().ReadSpoolAngles(row); });
  number("spool_speed_rad_s", "rad/s", TraceColumns::kMotors, trace.spool_speed_rad_s,
         [](Loop loop, Row row) { loop.hand().ReadSpoolSpeeds(row); });
  visit(TraceSignal<std::uint8_t>{"motor_at_limit", "1 or 0", TraceColumns::kMotors,
                                  [](Loop loop, std::span<std::uint8_t> row) {
                                    loop.hand().ReadSaturation(row);
                                  }},
        trace.motor_at_limit);
  number("hand_angle_rad", "rad", TraceColumns::kJoints, trace.hand_angle_rad,
         [](Loop loop, Row row) { loop.hand().ReadJointAngles(row); });
  number("measured_angle_rad", "rad", TraceColumns::kSensors, trace.measured_angle_rad,
         [](Loop loop, Row row) { std::ranges::copy(loop.measured_angle_rad(), row.begin()); });
  number("tension_n", "N", TraceColumns::kCables, trace.tension_n,
         [](Loop loop, Row row) { loop.hand().ReadCableTensions(row); });
  number("grip_force_n", "N", TraceColumns::kGrip, trace.grip_force_n,
         [](Loop loop, Row row) { row[0] = loop.hand().GripForce(); });
  number("object_pose", "m, quaternion", TraceColumns::kPose, trace.object_pose,
         [](Loop loop, Row row) { loop.hand().ReadObjectPose(row); });
  number("object_in_palm", "m, quaternion", TraceColumns::kPose, trace.object_in_palm,
         [](Loop loop, Row row) { loop.hand().ReadObjectInPalm(row); });
  number("object_force_n", "N", TraceColumns::kForces, trace.object_force_n,
         [](Loop loop, Row row) {
           const ObjectForces forces = loop.hand().Forces();
           row[0] = forces.carried_n;
           row[1] = forces.support_n;
         });
  number("palm_velocity_m_s", "m/s", TraceColumns::kPalm, trace.palm_velocity_m_s,
         [](Loop loop, Row row) { loop.hand().ReadPalmVelocity(row); });
  number("digit_overlap_m", "m", TraceColumns::kDigits, trace.digit_overlap_m,
         [](Loop loop, Row row) { row[0] = loop.hand().DigitOverlap(); });
  number("sample_age_s", "s", TraceColumns::kLinks, trace.sample_age_s,
         [](Loop loop, Row row) { row[0] = loop.sample_age_s(); });
  visit(TraceSignal<std::uint8_t>{"watchdog_tier", "0 follow, 1 hold, 2 relax, 3 off",
                                  TraceColumns::kLinks,
                                  [](Loop loop, std::span<std::uint8_t> row) {
                                    row[0] = static_cast<std::uint8_t>(loop.watchdog_tier());
                                  }},
        trace.watchdog_tier);
}

}  // namespace gauntlet::sim
