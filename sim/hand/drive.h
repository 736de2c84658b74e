#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "sim/hand/hand_config.h"
#include "sim/hand/servo.h"

namespace gauntlet::sim {

/// A joint without a motor of its own that follows another one:
///
///     angle = zero + sum_k coefficient[k] (leader - leader_zero)^k
struct Follower {
  int qpos = 0;
  int dof = 0;
  int leader_qpos = 0;
  int leader_dof = 0;
  double zero_rad = 0.0;
  double leader_zero_rad = 0.0;
  double coefficient[5] = {};

  double Angle(double leader_rad) const noexcept;
  double Slope(double leader_rad) const noexcept;
};

/// A joint that a cable passes on its way, in the order from the drum.
struct Crossing {
  int dof = 0;
  int qpos = 0;
  bool own = false;            // the joint that the cable is made for, or one that follows it
  double reference_rad = 0.0;  // joint angle for which the next three hold
  double moment_arm_m = 0.0;   // how the cable's length grows with the joint's angle
  double bend_rad = 0.0;       // how far the cable has bent from the drum to behind this joint
  double bend_per_rad = 0.0;   // how that grows with this joint's angle: +1 or -1
};

/// A cable from its drum to its joint.
struct Cable {
  int tendon = 0;
  double stiffness_n_m = 0.0;
  double damping_n_s_m = 0.0;
  double natural_length_m = 0.0;  // beyond the drum, with the spool at 0
  double bend_rad = 0.0;          // the whole of it at the reference
  std::vector<Crossing> crossings;
};

/// A motor: servo, spool and two cables.
struct Drive {
  std::string name;
  int actuator = 0;
  int spool_qpos = 0;
  int spool_dof = 0;
  double drum_radius_m = 0.0;
  Servo servo;
  Cable flexor;    // wound up by a positive spool angle
  Cable extensor;  // paid out by it
};

/// Joints of the model that follow another by an equality constraint.
std::vector<Follower> FindFollowers(const mjModel& model);

/// All positions with the channels' joints as given, [rad], followers included, spools at 0.
std::vector<double> PostureOf(const mjModel& model, const std::vector<int>& channel_joints,
                              const std::vector<double>& joint_angle_rad,
                              const std::vector<Follower>& followers);

/// The drives of the channels, in their order; the reference of cables is `reference_rad`.
/// Errors: UserError that names what the model lacks.
std::vector<Drive> FindDrives(const mjModel& model, const HandConfig& config,
                              const std::vector<std::string>& channel_names,
                              const std::vector<int>& channel_joints,
                              const std::vector<double>& reference_rad,
                              const std::vector<Follower>& followers);

/// How a cable's length grows with a joint's angle, here and now [m/rad].
double MomentArm(const mjModel& model, const mjData& data, int tendon, int dof) noexcept;

/// Index of a named part of the model; UserError with the nearest name if there is none.
int FindInModel(const mjModel& model, mjtObj type, const std::string& name);

}  // namespace gauntlet::sim
