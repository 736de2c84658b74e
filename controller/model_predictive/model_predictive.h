#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "controller/controller_config.h"
#include "controller/model_predictive/plan_solver.h"

namespace gauntlet::controller {

/// Commands that bring a joint, whose servo is late and slow, to where the wearer will be. Once per
/// event, of length T, and for each joint by itself:
///
///     y'' = w^2 (u(t - dead_time) - y - lag y'),    w = 2 pi natural_frequency
///
///     min  sum_j (y(t + dead_time + j T) - r_j)^2 + change_weight sum_k (u_k - u_k-1)^2
///
///     joint_min <= u_k <= joint_max,   |u_k - u_k-1| <= speed_limit T
///     |u_1 - y(t + dead_time)| <= lead_limit       as far as the others allow
///
/// for j, k = 1 .. steps, where r_j is where the wearer is expected when y is there. The first
/// command of the plan is sent. What a servo can pull is proportional to how far the command leads
/// the joint: lead_limit bounds the torque.
///
/// The model is exact for commands that stay between two events, for any dead time: its state is
/// kept dead_time ahead, where the commands that are on their way have arrived. It follows what
/// motors were really told (Sent()), rounded and limited, and needs no joint sensors.
///
/// If no plan is found within `iterations`, the joint's last command stays, which is within all
/// limits, and the failure is counted.
///
/// Source: Maciejowski, Predictive Control with Constraints (2002), chapters 2 and 3.
/// Units: rad. Shapes: one value per joint.
/// Errors: SettingError for a list of other than one value or one for each joint.
class ModelPredictive {
 public:
  ModelPredictive(const ModelPredictiveConfig& config, const TendonTransmission& hand,
                  double events_per_s);

  bool on() const noexcept { return config_.kind != ModelPredictiveKind::kNone; }

  /// How many angles of each joint a plan needs: those of now, in one event, in two, ..
  int path_length() const noexcept { return path_length_; }
  /// One event. `path_rad`: path_length() rows with a value per joint; between two of them the
  /// wearer is on the parabola through the three that are nearest.
  void Step(std::span<const double> path_rad, std::span<double> command_rad) noexcept;
  /// Takes the commands as they reached the motors: the hand is sent to `sent_rad` instead of
  /// `wanted_rad`. NaN: not known, so as wanted.
  void Sent(std::span<const double> wanted_rad, std::span<const double> sent_rad) noexcept;
  /// As new, the hand long since here.
  void Reset(std::span<const double> angle_rad) noexcept;
  /// Goes on where another one for the same hand stands, whose last target was this. Settings stay.
  void SwapMemory(ModelPredictive& from, std::span<const double> angle_rad) noexcept;

  /// How often each joint's last command had to stay since Reset(), for want of a plan. Empty where
  /// nothing is planned; the memory is there all the same, for those who read it before.
  std::span<const std::int64_t> failed_plans() const noexcept {
    return on() ? std::span<const std::int64_t>(failed_plans_) : std::span<const std::int64_t>();
  }

 private:
  struct Joint {
    double min_rad = 0.0;
    double max_rad = 0.0;
    Eigen::Matrix2d state_to_state;    // over an event
    Eigen::Vector2d command_to_state;  // the same
    PlanMatrix plan_to_path;           // y_1 .. y_n of u_1 .. u_n
    Eigen::Matrix<double, Eigen::Dynamic, 2, 0, kMostPlanSteps, 2> state_to_path;
    int first_row = 0;  // of the path: where the dead time ends
    Eigen::Vector3d row_weights;
    PlanSolver solver;
  };
  struct Memory {
    Eigen::Vector2d state = Eigen::Vector2d::Zero();  // angle and speed, dead_time ahead
    double command_rad = 0.0;
  };

  Joint MakeJoint(double dead_time_s, double lag_s, double frequency_hz, double min_rad,
                  double max_rad) const;
  /// True if there is a plan; its first command becomes the joint's last.
  bool Plan(Joint& joint, std::size_t index, std::span<const double> path_rad,
            Memory& memory) noexcept;

  ModelPredictiveConfig config_;
  double event_s_;
  double change_limit_rad_;
  double lead_limit_rad_;
  int path_length_ = 0;
  std::vector<Joint> joints_;
  std::vector<Memory> memory_;
  std::vector<std::int64_t> failed_plans_;
};

}  // namespace gauntlet::controller
