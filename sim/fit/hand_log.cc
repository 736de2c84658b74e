#include <vector>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/fit/chain_log.h"
#include "sim/tables/file_format.h"
#include "sim/trial/trace_reader.h"

namespace gauntlet::sim {
namespace {

/// One controller of a trace, the whole hand.
ChainLog LogOfTrace(const std::filesystem::path& file, const HandLogOptions& options) {
  const auto& [controller, from_wearer, table] = options;
  std::vector<std::string> only;
  if (!controller.empty()) only = {controller};
  const TraceFile trace_file = ReadTraceFile(file, {.only = only});
  if (trace_file.traces.empty()) {
    throw UserError({.place = file.string(),
                     .problem = controller.empty() ? "holds no controller"
                                                   : "holds no controller " + Shown(controller)});
  }
  const Trace& trace = trace_file.traces.front();
  if (!from_wearer && trace.target_angle_rad.cols() == 0) {
    throw UserError({.place = file.string(), .problem = "is too old: it holds no targets"});
  }
  const Signal& command = from_wearer ? trace_file.reference_angle_rad : trace.target_angle_rad;
  const Eigen::Index ticks = trace.hand_angle_rad.rows();
  ChainLog log;
  log.name = OneLine(file.string());
  log.parts = trace_file.joint_names;
  log.rate_hz = trace_file.tick_rate_hz;
  log.from_wearer = from_wearer;
  log.command_deg = command.topRows(ticks) * kDegPerRad;
  log.angle_deg = trace.hand_angle_rad * kDegPerRad;
  return log;
}

}  // namespace

ChainEpisodes LoadHandLog(const std::filesystem::path& log, const HandLogOptions& options) {
  const bool is_output = std::filesystem::is_directory(log) && DataSetFiles(log).empty();
  const std::filesystem::path trace = is_output ? log / "trace.h5" : log;
  if (trace.extension() == ".h5" && options.table.array.empty()) {
    try {
      return {.logs = {LogOfTrace(trace, options)}, .left_out = {}};
    } catch (const UserError&) {
      // HDF5 of other programs is a table.
      if (is_output || trace.filename() == "trace.h5" || !options.controller.empty()) throw;
    }
  }
  if (!options.controller.empty()) {
    throw UserError({.place = "--controller " + options.controller,
                     .problem = "is for an output folder or its trace.h5, a CSV has but one"});
  }
  return LoadChainEpisodes(log, options.table);
}

}  // namespace gauntlet::sim
