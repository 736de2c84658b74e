#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/base/signal.h"
#include "sim/fit/chain_fit.h"
#include "sim/fit/command_kind.h"
#include "sim/fit/episode_rows.h"

namespace gauntlet::sim {

/// Commands and measured angles of the parts (joints or motors) of a hand.
///
/// Shapes: samples x parts, at a constant rate, finite.
struct ChainLog {
  std::string name;            // of the file, for messages
  std::optional<int> episode;  // of a file with several
  std::vector<std::string> parts;
  double rate_hz = 1000.0;
  Signal command_deg;
  Signal angle_deg;
  Signal motor_deg;  // any scale, offset and sign; NaN for a part without, empty: none
  std::vector<CommandKind> kinds = {};  // of the commands, part by part; empty: all are targets
  bool from_wearer = false;             // the command is the wearer's motion, not a motor command
  bool held = false;                    // rows hold their command if no other frames are found
  std::size_t values_missing = 0;       // interpolated
  std::vector<std::string> columns_ignored;
  bool unit_known = true;  // false: `_deg` values have the unit of the file
  std::string unit_note;   // how the unit is known, or that it is not; empty: from the names
};

/// The episodes of a file; a file without episodes has one.
struct ChainEpisodes {
  std::vector<ChainLog> logs;         // at least one
  std::vector<std::string> left_out;  // "episode 7: ..", where one cannot be read and others can
};

/// Reads a table of any format of TableSource with a header and a time (see TimeByName).
/// Each part has a column with its command, one with its measured angle, and optionally
/// `NAME_motor_deg` (or `_rad`) with the angle of its motor: see FindChainColumns(). The CSV of a
/// trace is also accepted: `true_angle_rad.NAME` and `hand_angle_rad.NAME`. Other columns are
/// ignored. Times may be uneven: values are interpolated linearly at the median rate, commands in
/// steps (see FindCommandClock() and StepsOf()) by the nearest row. Episodes as in EpisodeReader.
/// Errors: UserError `file:row:column: ...`, also for a gap of more than 100 ms and ten rows in all
/// episodes, and for a chosen episode that does not exist.
ChainEpisodes LoadChainEpisodes(const std::filesystem::path& file,
                                const ChainLogOptions& options = {});

/// A part of a signal of the log.
inline std::span<const double> ColumnOf(const Signal& signal, std::size_t part) {
  return {signal.col(static_cast<Eigen::Index>(part)).data(),
          static_cast<std::size_t>(signal.rows())};
}

/// Value between two rows, by a straight line; constant beyond the ends.
double ValueAt(std::span<const double> values, double row);

/// Clock of the command frames for each part: the common clock of all commands, or the part's own
/// if there is no common one. None if no clock is found.
std::vector<std::optional<CommandClock>> FramesOf(const ChainLog& log);

/// Name of the log's file for results, without the folders above; of a trace with its own folder.
std::string FileNameOf(const ChainLog& log);

/// The remarks on a part in one text, in the unit of the log; empty if there are none.
std::string RemarksOf(const ChainLog& log, const ChainFit& fit);

/// One sentence about the causes of the hysteresis, as far as the log distinguishes them.
std::string WhatHysteresisIs(const std::vector<ChainFit>& fits);

/// One sentence about the timing of the commands; empty if no frames are found.
std::string WhatFramesAre(const ChainLog& log, const std::vector<ChainFit>& fits);

/// Hears how many of the parts are fitted; called by one thread at a time.
using ChainProgress = std::function<void(int done, int parts)>;

/// Fits every part, on all processors.
/// Errors: UserError if no part of the log can be fitted, with the problem of the first.
std::vector<ChainFit> FitChains(const ChainLog& log, const ChainProgress& progress = {},
                                ChainDetail detail = ChainDetail::kAll);

struct HandLogOptions {
  std::string controller = {};  // of a trace; empty: the first
  bool from_wearer = true;      // of a trace: commands are the wearer's angles, else the targets
  ChainLogOptions table = {};   // of any other log
};

/// The log of a hand: an output folder of `gauntlet run`, its trace.h5 (one controller, the whole
/// hand), or a table as LoadChainEpisodes() reads it.
/// Errors: UserError; as ReadTraceFile() and LoadChainEpisodes().
ChainEpisodes LoadHandLog(const std::filesystem::path& log, const HandLogOptions& options);

}  // namespace gauntlet::sim
