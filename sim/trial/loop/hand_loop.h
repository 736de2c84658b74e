#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "controller/controller.h"
#include "sim/hand/hand.h"
#include "sim/hand/joint_sensors.h"
#include "sim/trial/link/link_config.h"
#include "sim/trial/link/receiver.h"
#include "sim/trial/link/transport.h"
#include "sim/trial/link/watchdog.h"

namespace gauntlet::sim {

/// The links of a loop, and the seed of their random numbers.
struct LoopLinks {
  LinksConfig config = {};
  std::uint64_t seed = 0;
};

/// Controller, links and hand as one: glove samples in, a moving hand out. The same loop runs in
/// trials and live; who calls Step() owns the time.
///
///     sample -> [link] -> controller -> (event) -> link -> (delay) -> servos, cables, joints
///                             ^---------- (delay) <- joint sensors, if there are any <----|
///
/// With a link from the glove, the controller gets at each of the glove's samples what the receiver
/// has then: so filters keep their rate.
class HandLoop {
 public:
  /// The clocks are those of `hand`. Errors: SettingError of the controller, or `link. ..`.
  HandLoop(const controller::ControllerConfig& config, const controller::GloveCalibration& glove,
           const controller::JointMapConfig& joint_map, std::shared_ptr<const HandModel> hand,
           const LoopLinks& links = {});

  /// Controller as new and told where the motors are, nothing on its way, the hand at rest in this
  /// posture [rad, per joint].
  void Reset(std::span<const double> joint_angle_rad);

  /// One tick, with a new sample of the glove or without one. Neither throws nor allocates. Once
  /// the hand's health is bad nothing happens any more.
  void Step(const controller::GloveSample& sample) noexcept { StepHand(StepController(sample)); }
  void Step() noexcept { StepHand(StepController()); }

  /// The two halves of Step(). The first returns the command frame that is to be sent at this tick,
  /// empty if there is none; the second gets what was sent, and moves the hand.
  std::span<const std::int32_t> StepController(const controller::GloveSample& sample) noexcept;
  std::span<const std::int32_t> StepController() noexcept;
  void StepHand(std::span<const std::int32_t> sent_counts) noexcept;

  /// With a link from the glove whose frames arrive from outside: one of them, before the Step()
  /// without a sample of the same tick. Its way is not simulated.
  void AcceptGloveFrame(const LinkFrame& frame) noexcept;
  /// From now on the receiver is asked so many ticks later (or earlier) than the sampling period
  /// says: the grid of samples follows a real glove, whose clock drifts. Less than a period.
  void ShiftSamples(int ticks) noexcept { first_sample_tick_ += ticks; }
  /// Ticks in which nothing was done: a real loop was late. Controller and hand stand still
  /// meanwhile, while frames grow older and the watchdogs count.
  void Skip(std::int64_t ticks) noexcept;

  /// The controller takes over other settings, as Controller::Swap() does.
  bool Swap(controller::Controller& next) noexcept { return controller_.Swap(next); }

  const controller::Controller& controller() const noexcept { return controller_; }
  const Hand& hand() const noexcept { return hand_; }
  /// Last reading of the joint sensors, as the controller has it; NaN before the first one, empty
  /// without sensors. Shape: one per joint. Units: rad.
  std::span<const double> measured_angle_rad() const noexcept { return measured_angle_rad_; }

  /// Time since the capture of the glove sample behind the command that the servos hold, after the
  /// last Step() [s]; before the first command since Reset().
  double sample_age_s() const noexcept;
  /// Tick of the next Step(); capture of the sample that the controller has.
  std::int64_t tick() const noexcept { return tick_; }
  std::int64_t sample_tick() const noexcept { return sample_tick_; }
  /// Counts of the sample that the controller got at the last tick; empty: none.
  std::span<const double> taken_counts() const noexcept { return taken_counts_; }
  /// The receiver of a link from the glove, or nullptr.
  const Receiver* glove_receiver() const noexcept {
    return glove_link_ ? &glove_link_->receiver : nullptr;
  }
  /// The higher tier of the two watchdogs.
  Watchdog::Tier watchdog_tier() const noexcept;

 private:
  /// One way: what happens to its frames, and what is done with them.
  struct Link {
    Link(const LinkConfig& config, const LinkEnds& ends, const HandModel& hand, std::uint64_t seed);

    void Receive(std::int64_t tick) noexcept;

    Transport way;
    Receiver receiver;
    Watchdog watchdog;
  };

  static Link LinkToHand(const LoopLinks& links, const HandModel& hand);
  std::span<const std::int32_t> StepBehindLink() noexcept;
  std::span<const std::int32_t> FrameToSend(const controller::Command& command) noexcept;
  void ReceiveCommand() noexcept;
  void ObeyWatchdog() noexcept;
  void ReadSensors() noexcept;

  controller::Controller controller_;
  std::optional<Link> glove_link_;
  Link hand_link_;
  Hand hand_;
  JointSensors sensors_;
  std::vector<double> joint_angle_rad_;
  std::vector<double> measured_angle_rad_;
  std::vector<double> sample_counts_;        // of the glove, per channel
  std::vector<double> sent_counts_;          // per motor
  std::vector<std::int32_t> wanted_counts_;  // per motor, of the last frame that was received
  std::vector<double> spool_counts_;         // per motor, where it is
  std::span<const double> taken_counts_;
  std::int64_t tick_ = 0;
  std::int64_t first_sample_tick_ = 0;
  std::int64_t sample_tick_ = 0;  // capture of the sample that the controller has
  std::int64_t held_tick_ = 0;    // of the one behind the command that the servos hold
  bool has_command_ = false;
  bool has_power_ = true;
};

}  // namespace gauntlet::sim
