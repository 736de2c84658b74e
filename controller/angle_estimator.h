#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controller/assert.h"
#include "controller/controller_config.h"
#include "controller/filters/filter.h"
#include "controller/joint_map.h"
#include "controller/linearisation/linearisation.h"
#include "controller/prediction/motion_path.h"

namespace gauntlet::controller {

/// From counts that can be trusted to the angle expected of each channel:
///
///     counts -> [filter] -> linearisation -> [filter] -> [prediction]
///
/// An inactive channel is held at its last angle. The estimator has no clock: its caller decides
/// when filters step (see FilterAt).
///
/// Shapes: samples x channels, one sample after the other; one unless more are named. Units: counts
/// and rad. Nothing but the constructor allocates or throws. Errors: SettingError for filters or a
/// prediction that cannot be built; `robot` is one that a Controller takes.
class AngleEstimator {
 public:
  /// `path_rows`: of path(), for who plans ahead.
  AngleEstimator(const RobotConfig& robot, const ControllerConfig& config, int path_rows = 0);

  /// A sample, or several in a row: the same bits as one by one. `predicted_rad` is as long as
  /// `counts`, and another memory.
  void Step(std::span<const double> counts, std::span<double> predicted_rad) noexcept;
  /// A sample whose angles behind the linearisation are known, too.
  void StepLinearised(std::span<const double> counts,
                      std::span<const double> linearised_rad) noexcept;
  /// Its next sample is its first.
  void StartChannel(int channel) noexcept;
  void SetChannelActive(int channel, bool active) noexcept;
  bool channel_active(int channel) const noexcept {
    GAUNTLET_ASSERT(0 <= channel && channel < channel_count());
    return active_[static_cast<std::size_t>(channel)] == 1;
  }

  /// The channel is here until the next sample steps it.
  void Place(int channel, double angle_rad) noexcept;
  /// Puts all channels where the joints are at these angles, as far as one channel decides a joint;
  /// one that decides none is in the middle of its two known poses.
  void MoveTo(const JointMap& joint_map, std::span<const double> joint_angle_rad) noexcept;
  /// The counts of where they are.
  void ToCounts(std::span<double> counts) const noexcept {
    linearisation_->ToCounts(predicted_rad_, counts);
  }
  /// As new, and before the first sample at these counts.
  void Reset(std::span<const double> counts) noexcept;
  /// Goes on where `before` stands, which has as many channels; `counts` are what its filtered
  /// angles are here. The memory of what can be read from outside comes along.
  void SwapMemory(AngleEstimator& before, std::span<const double> counts) noexcept;

  int channel_count() const noexcept { return linearisation_->channel_count(); }
  const Linearisation& linearisation() const noexcept { return *linearisation_; }
  /// Per channel, the middle of its two known poses.
  std::span<const double> middle_rad() const noexcept { return middle_rad_; }
  /// As they are after the last sample: behind the filters, and behind prediction.
  std::span<const double> filtered_rad() const noexcept { return filtered_rad_; }
  std::span<const double> predicted_rad() const noexcept { return predicted_rad_; }
  const MotionPath& path() const noexcept { return path_; }

 private:
  /// All filters, one after the other.
  void Filtered(std::span<const double> input, std::span<double> output) noexcept;
  /// From what is filtered to what is predicted, of all samples.
  void Finish(std::span<double> predicted_rad) noexcept;
  /// Prediction step of one sample.
  void Predict(std::span<double> angle_rad) noexcept;
  void HoldInactiveChannels(std::span<double> angle_rad) noexcept;

  FilterOn filter_on_;
  double step_rate_hz_;
  std::unique_ptr<Linearisation> linearisation_;
  std::vector<std::unique_ptr<Filter>> chain_;
  std::unique_ptr<Filter> predictor_;  // may be null
  MotionPath path_;                    // empty where nothing is planned
  std::vector<double> middle_rad_;     // per channel, between its two known poses
  std::vector<std::uint8_t> active_;   // per channel
  int inactive_count_ = 0;
  std::vector<double> held_rad_;  // in place of what is predicted for inactive channels
  std::vector<double> filtered_rad_;
  std::vector<double> predicted_rad_;
};

}  // namespace gauntlet::controller
