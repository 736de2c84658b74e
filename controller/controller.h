#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "controller/controller_config.h"
#include "controller/export.h"
#include "controller/sample_guard_config.h"

namespace gauntlet::controller {

/// Output of one tick. The memory belongs to the controller: it is valid as long as the controller
/// exists, also after Swap() and Load(). The next Step() or Reset() may change its values.
///
/// Shapes: one value per motor. Units: motor counts, always within the motor's range.
struct GAUNTLET_API Command {
  std::span<const std::int32_t> motor_counts;  // of the last command frame
  bool event = false;  // a frame is due: `motor_counts` are new and are to be sent now
  GloveStatus glove = GloveStatus::kGood;
  LoopStatus loop = LoopStatus::kInTime;  // see Controller::TakeElapsedTime()
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
/// Call Step() once per tick (1 ms by default, see Timing), with the glove's sample if there is a
/// new one. It neither throws, allocates, locks nor reads a clock. The command changes only at
/// command frames, whose clock begins with the first tick. Filters and prediction step at each new
/// sample, or at each command frame. An untrusted value (see Untrusted) never reaches a motor: its
/// channel holds the last valid value and counts the sample. So does every channel when a sample is
/// overdue by half its period, and `SampleGuardConfig::lost_after_ms` says what follows. Before the
/// first valid value the joint of a channel stays where Reset() says that the motors are.
///
/// The first command begins at the motors' centers, or at the counts of Reset(). Two successive
/// commands never differ by more than the speed limit and the rounding.
///
/// One thread at a time may use a controller; only Prepare() may be called from another thread
/// meanwhile. A moved-from controller has no channels and returns empty commands.
///
/// Errors: the constructor throws SettingError, which names the key and the allowed range.
class GAUNTLET_API Controller {
 public:
  /// `config` sets filters and maps; `glove` and `hand` describe the connected devices.
  Controller(const ControllerConfig& config, const GloveCalibration& glove,
             const TendonTransmission& hand, const Timing& timing = {},
             const JointMapConfig& joint_map = {});
  /// Controller from one file of `gauntlet export`.
  explicit Controller(const RobotConfig& robot);
  ~Controller();
  Controller(Controller&&) noexcept;
  Controller& operator=(Controller&&) noexcept;

  /// A tick with a new sample of the glove.
  Command Step(const GloveSample& sample) noexcept;
  /// A tick without one.
  Command Step() noexcept;
  /// Measured joint angles of the hand [rad, per joint; NaN: not measured], for the joint loop. The
  /// next command frame uses them. Another number of values is ignored.
  void TakeJointAngles(std::span<const double> measured_rad) noexcept;
  /// Time between the last step and the next one [ms], as the loop measured it; call it before the
  /// Step(). A controller reads no clock: with it, steps that come late are counted, and a loop at
  /// another rate than Timing says is reported (Command::loop). It changes no command.
  void TakeElapsedTime(double elapsed_ms) noexcept;
  /// Resets filters, counters of untrusted samples and clocks. The motors stay at the last command.
  /// Inactive channels stay inactive and hold their joint there.
  void Reset() noexcept;
  /// As Reset(), with the motors at these counts. Call it before the first Step() if the hand is
  /// not in its reference posture. With another number of values it is Reset().
  void Reset(std::span<const std::int32_t> motor_counts) noexcept;

  /// A controller with other settings for the same glove, hand and timing, for Swap(). Any thread
  /// may call it at any time. Allocates. Errors: SettingError.
  Controller Prepare(const ControllerConfig& config) const;
  /// Takes over the settings of `next`, without waiting or allocation, from the next sample on.
  /// Call it in the thread of Step(). `next` has the old settings afterwards; it can be destroyed
  /// in another thread, or swapped in again. Filters of the same kind, unit and step keep their
  /// state, so channels with unchanged settings keep every bit; others start at the joint's angle.
  /// False, without a change, if `next` is not from Prepare() of this controller.
  bool Swap(Controller& next) noexcept;
  /// Prepare() and Swap(). Allocates. Errors: SettingError.
  void Load(const ControllerConfig& config);

  /// An inactive channel holds its joint at the present angle. When it is active again, its filters
  /// start at the next sample. Other channels do not change. A channel out of range is ignored.
  void SetChannelActive(int channel, bool active) noexcept;
  /// False also for a channel out of range.
  bool channel_active(int channel) const noexcept;

  /// Number of sensors of the glove.
  int channel_count() const noexcept;
  /// Number of joints of the hand.
  int joint_count() const noexcept;
  /// Number of motors of the hand.
  int motor_count() const noexcept;

  /// Angle of each channel before the filter, after the last Step() [rad]. The memory of this and
  /// the next spans is valid as long as that of a Command.
  std::span<const double> linearised_angle_rad() const noexcept;
  /// Angle of each channel after the filter [rad].
  std::span<const double> filtered_angle_rad() const noexcept;
  /// Angle of each channel after the prediction [rad].
  std::span<const double> predicted_angle_rad() const noexcept;
  /// Angle of each joint after the joint map: the command to the hand [rad].
  std::span<const double> target_angle_rad() const noexcept;
  /// Number of untrusted samples of each channel since Reset().
  std::span<const std::int64_t> untrusted_samples() const noexcept;
  /// Number of untrusted samples of each channel since Reset() for one reason.
  std::span<const std::int64_t> untrusted_samples(Untrusted kind) const noexcept;
  /// Reason why the last Step() did not trust the value of a channel: of its sample, or `kMissing`
  /// if a sample was overdue. None if it was trusted, no sample was due, or the channel is out of
  /// range.
  std::optional<Untrusted> untrusted(int channel) const noexcept;
  /// Time since the last trusted value of a channel [ms], in ticks of the loop; since Reset() if
  /// there was none. NaN for a channel out of range.
  double sample_age_ms(int channel) const noexcept;
  /// Number of steps since Reset() that came half a tick late or more, of those whose time is
  /// known.
  std::int64_t overruns() const noexcept;
  /// Rate of the loop over the last 256 steps whose time is known [Hz]; NaN before.
  double measured_tick_rate_hz() const noexcept;
  /// Number of command frames since Reset() in which a joint's command stayed, because no plan was
  /// found in time (see ModelPredictive); empty without planned commands.
  std::span<const std::int64_t> failed_plans() const noexcept;

 private:
  struct Robot;
  struct State;
  Controller(const Robot* robot, State* state) noexcept : robot_(robot), state_(state) {}

  const Robot* robot_;  // what it is connected to: never changes; its state owns it
  State* state_;        // owned; null when moved from
};

}  // namespace gauntlet::controller
