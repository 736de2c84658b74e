#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sim/glove/glove.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// Writes `trace.h5`: HDF5, a group `/glove` and one group per controller below `/controllers`;
/// every signal is a dataset, rows x columns, of 32-bit floats or integers, with the attributes
/// `unit`, `rate_hz` (of its rows: ticks, for `/glove/counts` samples) and `columns` (their names).
/// `/glove/faults` and `/glove/segments` are tables: what was wrong with the glove in which
/// samples, and which ticks of the motion the scenario labels. The file appears when Commit() has
/// been called. Errors: RunError with the path when the disk does not take it.
class TraceWriter {
 public:
  TraceWriter(const std::filesystem::path& target, const GloveSignal& glove,
              const Signal& reference_angle_rad, const HandModel& hand, const std::string& scenario,
              int seed);
  ~TraceWriter();

  void Add(const Trace& trace);
  void Commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What `trace.h5` says.
struct TraceFile {
  std::string scenario;
  int seed = 0;
  double tick_rate_hz = 1000.0;
  std::vector<std::string> channel_names;
  std::vector<std::string> joint_names;
  Signal true_angle_rad;       // ticks x channels
  Signal reference_angle_rad;  // ticks x joints: what the wearer's angles ask of the hand
  Signal counts;               // samples x channels
  std::vector<Trace> traces;   // in the order of writing
};

/// Reads a whole trace file. Errors: UserError if it is missing or is not a trace file of Gauntlet.
/// Of the controllers named in `only`, or of all if it is empty.
TraceFile ReadTraceFile(const std::filesystem::path& file,
                        const std::vector<std::string>& only = {});

}  // namespace gauntlet::sim
