#pragma once

#include <filesystem>
#include <memory>
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

}  // namespace gauntlet::sim
