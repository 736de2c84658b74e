#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "sim/glove/glove.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// Writes `trace.h5`: HDF5, a group `/glove` and one group per controller below `/controllers`;
/// every signal is a dataset, rows x columns, of 32-bit floats or integers (flags: 8 bits), with
/// the attributes `unit`, `rate_hz` (of its rows: ticks, for `/glove/counts` samples) and `columns`
/// (their names). `/glove/faults` and `/glove/segments` are tables: what was wrong with the glove
/// in which samples, and which ticks of the motion the scenario labels; `/glove/masked`, where
/// there is any, which ticks of a recording are unknown, and why. The file appears when
/// Commit() has been called. Errors: RunError with the path when the disk does not take it.
class TraceWriter {
 public:
  TraceWriter(const std::filesystem::path& target, const GloveSignal& glove,
              const Signal& reference_angle_rad, const HandModel& hand, const std::string& scenario,
              int seed);
  ~TraceWriter();

  /// `twin`: of the same trial, as `noise_free_..` beside the signals; null if there is none.
  /// `angles`: as `without_glove_hand_angle_rad`, `without_link_loss_..` and so on,
  /// `asked_angle_rad` and `arm_at_rest_hand_angle_rad`; the first of them is that of the twin.
  void Add(const Trace& trace, const NoiseFreeTwin* twin = nullptr, const CauseAngles& angles = {});
  void Commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The signals of a trace file as CSV, one file per controller: `t_s`, then `signal.column` per
/// column. Counts are empty between the samples of the glove.
void WriteTraceCsv(const std::filesystem::path& target, const GloveSignal& glove,
                   const HandModel& hand, const Trace& trace);

/// The signals of all controllers as an MCAP file for Foxglove, PlotJuggler and rerun. Messages are
/// those of ROS 2 in CDR, because all of these programs plot sensor_msgs/JointState. Angles [rad]
/// are its positions, speeds [rad/s] its velocities; names are those of joints, channels or motors.
/// Other signals are of the type gauntlet/Signal, whose definition is in the file. Topics:
/// `/wearer/true_angle_rad`, `/glove/counts`, `/reference_angle_rad`, and `/CONTROLLER/SIGNAL` for
/// each controller. The time of a message is that of the trial, from 0. Errors: RunError.
void WriteTraceMcap(const std::filesystem::path& target, const GloveSignal& glove,
                    const Signal& reference_rad, const HandModel& hand,
                    std::span<const Trace> traces);

}  // namespace gauntlet::sim
