#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "controller/controller_config.h"
#include "controller/export.h"

namespace gauntlet::controller {

/// Keeps the last steps of a controller, to find the cause of a fault afterwards.
///
///     const Command command = controller.Step(sample);
///     recorder.Add(sample, controller, command);
///
/// After a fault, CopyTo() copies the steps as rows of numbers. Another thread can write them to a
/// file meanwhile, with column_names(); `sim/settings/steps_csv.h` makes CSV of them. A row has:
///
///     tick                     number of calls of Add() before this one
///     sample                   1: the tick had a sample; else 0
///     frame_number             of the glove; NaN without one
///     event                    1: a command frame was due; else 0
///     glove                    number of the GloveStatus
///     counts.CHANNEL           of the sample, as the glove gave them; NaN without a value
///     untrusted.CHANNEL        0: trusted, or no sample was due; else 1 + number of the Untrusted
///     target_angle_rad.JOINT   Controller::target_angle_rad()
///     command_counts.MOTOR     Command::motor_counts
///
/// Only the constructor allocates; no other function locks or reads a clock. One thread at a time
/// may use a recorder, but any may read column_names().
///
/// Units: as the names say. Precision: frame numbers beyond 2^53 are rounded to the next double.
/// Errors: SettingError for a number of steps outside 1 to 1,000,000.
class GAUNTLET_API StepRecorder {
 public:
  /// `robot`: what the controller is made from. 10,000 steps at 1 kHz are 10 s; with 18 channels,
  /// joints and motors they need 6.2 MB.
  StepRecorder(const RobotConfig& robot, int steps);
  StepRecorder(const StepRecorder&) = delete;
  StepRecorder& operator=(const StepRecorder&) = delete;

  /// Adds the step that `controller` has just done with this sample, in place of the oldest one.
  /// False, and not kept, if the controller has other numbers of channels, joints or motors than
  /// `robot`, or was moved from; its tick is counted.
  bool Add(const GloveSample& sample, const Controller& controller,
           const Command& command) noexcept {
    return Keep(&sample, controller, command);
  }
  /// Adds the step of a tick without a sample, likewise.
  bool Add(const Controller& controller, const Command& command) noexcept {
    return Keep(nullptr, controller, command);
  }

  /// Names of the values of a row. Shapes: as long as a row.
  const std::vector<std::string>& column_names() const noexcept { return column_names_; }
  /// Number of steps that are kept.
  std::size_t size() const noexcept { return size_; }
  /// Copies the newest steps, as many whole rows as fit into `rows`, the oldest of them first. The
  /// rest of `rows` does not change. Returns the number of rows.
  std::size_t CopyTo(std::span<double> rows) const noexcept;

 private:
  bool Keep(const GloveSample* sample, const Controller& controller,
            const Command& command) noexcept;

  int channel_count_;
  int joint_count_;
  int motor_count_;
  std::vector<std::string> column_names_;
  std::size_t steps_;
  std::vector<double> rows_;  // a ring of `steps_` rows
  std::size_t next_ = 0;      // row of the next step
  std::size_t size_ = 0;
  std::int64_t ticks_ = 0;
};

}  // namespace gauntlet::controller
