#pragma once

#include <vector>

#include "controller/periodic_clock.h"
#include "controller/timing.h"
#include "sim/base/random.h"
#include "sim/hand/servo_config.h"

namespace gauntlet::sim {

/// Knowledge of one servo: the command that it holds, and where it takes its spool to be.
///
/// Frames begin with the first command or, if they run free, at a tick of the first frame that the
/// motor's number decides. A command counts from the first frame that finds it, and after the dead
/// time. The sensor's noise is the same in every run, too.
class ServoInput {
 public:
  ServoInput(const ServoNumbers& numbers, const controller::Timing& timing, int motor);

  /// Holds the command since long ago.
  void Reset(double target_rad);
  /// One tick: the command that counts now. `commanded`: there has been one since the Reset().
  double Step(double command_rad, bool commanded) noexcept;
  /// One tick: what the sensor says beyond the true angle [rad].
  double SensorError(double angle_rad) noexcept;

 private:
  int motor_;
  bool free_running_;
  int first_frame_tick_;
  double sensor_step_rad_;  // 0: exact
  double sensor_noise_rad_;
  controller::PeriodicClock frame_;
  int tick_ = 0;                   // since Reset(), up to the first frame
  std::vector<double> taken_rad_;  // by the frames, over the ticks of the dead time; a ring
  std::size_t now_ = 0;            // its place in it
  RandomStream noise_;
};

}  // namespace gauntlet::sim
