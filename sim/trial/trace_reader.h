#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sim/base/masked_stretch.h"
#include "sim/base/segment.h"
#include "sim/trial/trace.h"
#include "sim/trial/trace_stream.h"

namespace gauntlet::sim {

/// Content of `trace.h5`. Sizes fit each other, controllers have different names, and every number
/// but those of `counts` and of a trial that ended badly is finite.
struct TraceFile {
  std::string scenario;
  int seed = 0;
  double tick_rate_hz = 1000.0;
  std::vector<std::string> channel_names;
  std::vector<std::string> joint_names;
  Signal true_angle_rad;              // ticks x channels
  Signal reference_angle_rad;         // ticks x joints: what the wearer's angles ask of the hand
  Signal counts;                      // samples x channels
  std::vector<Segment> segments;      // that a person labelled, in ticks
  std::vector<MaskedStretch> masked;  // of a recording: unknown motion, in ticks
  std::vector<Trace> traces;          // in the order of writing
};

/// Which part of a trace file is read, and how.
struct TraceReading {
  std::vector<std::string> only = {};     // these controllers; empty: all
  std::function<bool()> keep_going = {};  // asked now and then; false throws Cancelled
  double processor_s = 0.0;  // that the helper may take; 0: enough for any file of its size
};

/// Reads a trace file of any source. HDF5 crashes or hangs over some damaged files, so it runs in a
/// helper process with limits of time and memory.
/// Errors: UserError if it is missing, damaged, or not a trace file of Gauntlet.
TraceFile ReadTraceFile(const std::filesystem::path& file, const TraceReading& reading = {});

/// The part of it that happens in the program itself: makes a trace of what the helper sends.
/// `file_bytes`: the size of the file, which bounds all that is in it.
/// Errors: UserError without a place, and what `receive` throws.
TraceFile ReceiveTrace(const TraceReceiver::Receive& receive, std::uintmax_t file_bytes);

}  // namespace gauntlet::sim
