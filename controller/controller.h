#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controller/controller_config.h"
#include "controller/sample_guard.h"

namespace gauntlet::controller {

/// What the motors are told. The memory is the controller's: there as long as it is, also over
/// Swap() and Load(); the next Step() or Reset() may write other counts into it.
///
/// Shapes: one value per motor. Units: motor counts, always within the motor's range.
struct Command {
  std::span<const std::int32_t> motor_counts;
  bool event = false;  // a frame is due: `motor_counts` are new and are to be sent now
};

/// From glove to motors: linearisation, filters, prediction, joint map and tendon map, in one call
/// per tick of the control loop.
///
///     counts -> [filter] -> linearisation -> [filter] -> [prediction]     per channel
///            -> joint map                                                 per joint
///            -> [model predictive control]                                per joint
///            -> [joint loop, with measured joint angles]                  per joint
///            -> tendon map -> whole counts                                per motor
///
/// Call Step() once per tick (1 ms by default, see Timing): with the glove's sample where it has
/// brought a new one, without where it has not. It neither throws, allocates, locks nor reads a
/// clock. Events have a clock of their own, which begins with the first tick: only there does the
/// command change. Filters step at each new sample, or at each event. A value that cannot be
/// trusted (see Untrusted) never reaches a motor: its channel holds the last good value and counts
/// the event; before the first good value the joint that it moves holds its reference angle.
/// Prediction steps when the filter does.
///
/// The first command leads on from where the motors are: at their centers, or where Reset() says.
/// From there on no two commands differ by more than the speed limit and the rounding.
///
/// One thread at a time may use a controller; Prepare() alone may be called from any other thread
/// meanwhile. A controller that was moved from has no channels and gives empty commands.
///
/// Errors: the constructor throws SettingError, which names the key and the allowed range.
class Controller {
 public:
  /// `config` says what the controller does; the others what it is connected to, and when.
  Controller(const ControllerConfig& config, const GloveCalibration& glove,
             const TendonTransmission& hand, const Timing& timing = {},
             const JointMapConfig& joint_map = {});
  explicit Controller(const RobotConfig& robot);
  ~Controller();
  Controller(Controller&&) noexcept;
  Controller& operator=(Controller&&) noexcept;

  /// A tick with a new sample of the glove.
  Command Step(const GloveSample& sample) noexcept;
  /// A tick without one.
  Command Step() noexcept;
  /// The joint angles that the hand has measured [rad, per joint; NaN where there is none], as soon
  /// as they are there: the next event uses them. Only a joint loop does; it takes nothing of
  /// another number of values.
  void TakeJointAngles(std::span<const double> measured_rad) noexcept;
  /// Forgets the glove: filters, counters of untrusted samples and clocks begin anew. The hand
  /// stays where it is, which is where the last command has sent it; channels that are switched off
  /// stay off and hold their joint there.
  void Reset() noexcept;
  /// The same with the motors at these counts, as the robot reads them: to be called before the
  /// first Step() where the hand is not in its reference posture. With other than one value per
  /// motor it is Reset().
  void Reset(std::span<const std::int32_t> motor_counts) noexcept;

  /// Other settings, in two parts, so that the control loop neither waits nor allocates.
  ///
  /// Prepare() makes a controller of other settings for the same glove, hand and timing; any thread
  /// may call it at any time. Allocates. Errors: SettingError.
  ///
  /// Swap() takes its settings over, in the thread that calls Step(), between two of its calls:
  /// from the next sample on. `next` has the old settings then, to be destroyed in any other thread
  /// or to be swapped in again. Filters of the same kind, unit and step go on where they were, so
  /// that channels whose settings stay the same keep every bit; others start where the joint is.
  /// False, and nothing is changed, if `next` was not prepared by this controller.
  Controller Prepare(const ControllerConfig& config) const;
  bool Swap(Controller& next) noexcept;
  /// Both at once, where nothing waits for Step().
  void Load(const ControllerConfig& config);

  /// A channel that is switched off holds its joint where it is; switched on again its filters
  /// start at the next sample. The other channels do not notice. A channel that there is not is
  /// switched off and stays so.
  void SetChannelActive(int channel, bool active) noexcept;
  bool channel_active(int channel) const noexcept;

  int channel_count() const noexcept;
  int joint_count() const noexcept;
  int motor_count() const noexcept;

  /// Angles as they are after the last Step() [rad]: per channel before the filter, behind it and
  /// behind prediction, and per joint behind the joint map, which is what the hand is to do. The
  /// memory of these spans is there as long as that of a Command.
  std::span<const double> linearised_angle_rad() const noexcept;
  std::span<const double> filtered_angle_rad() const noexcept;
  std::span<const double> predicted_angle_rad() const noexcept;
  std::span<const double> target_angle_rad() const noexcept;
  /// How many samples of each channel could not be trusted since Reset(), in all or for one reason.
  std::span<const std::int64_t> untrusted_samples() const noexcept;
  std::span<const std::int64_t> untrusted_samples(Untrusted kind) const noexcept;
  /// How often each joint's last command had to stay since Reset(), because no plan was found in
  /// time (see ModelPredictive); empty where nothing is planned.
  std::span<const std::int64_t> failed_plans() const noexcept;

 private:
  struct State;
  Controller(std::shared_ptr<const RobotConfig> robot, const ControllerConfig& config);

  std::shared_ptr<const RobotConfig> robot_;  // what it is connected to: never changes
  std::unique_ptr<State> state_;
};

}  // namespace gauntlet::controller
