#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/signal.h"
#include "sim/calibrate/chain_fit.h"

namespace gauntlet::sim {

/// What parts of a hand (joints or motors) were told, and what they did.
///
/// Shapes: samples x parts, at an even rate, finite.
struct ChainLog {
  std::string name;  // of the file, for messages
  std::vector<std::string> parts;
  double rate_hz = 1000.0;
  Signal command_deg;
  Signal angle_deg;
  Signal motor_deg;          // of any scale, zero and sense; NaN for a part without, empty: of none
  bool from_wearer = false;  // the command is what the wearer did, not what a motor was told
  bool held = false;         // each row's command until the next where no other frames are seen
  std::size_t values_missing = 0;  // a straight line goes over them
};

/// Reads a table of any format of TableSource with a header and a column of time (see TimeScaleS).
/// Per part `NAME_command_deg` (or `_rad`), and `NAME_deg` (or `_rad`) for the angle that was
/// measured; where its motor was in `NAME_motor_deg` (or `_rad`), if known; or the CSV of a trace:
/// `true_angle_rad.NAME` and `hand_angle_rad.NAME`, whose other signals are left out. Other columns
/// are an error. Times need not be even: values are brought to the median rate on straight lines,
/// commands that step (see FindFrameClock()) to that of the nearest row.
/// `array` chooses of a file with arrays, see ListArrays().
/// Errors: UserError `file:row:column: ...`, also for a gap of more than 100 ms and ten rows.
ChainLog LoadChainLog(const std::filesystem::path& file, const std::string& array = {});

/// Of each part the clock of its command's frames: that of all commands together, or its own, where
/// they have none; none where none is seen.
std::vector<std::optional<FrameClock>> FramesOf(const ChainLog& log);

/// What hysteresis is of, in one sentence, as far as the log's parts tell it apart.
std::string WhatHysteresisIs(const std::vector<ChainFit>& fits);

/// How the commands come, in one sentence; empty where no frames are seen.
std::string WhatFramesAre(const ChainLog& log, const std::vector<ChainFit>& fits);

/// Fits every part.
/// Errors: UserError if no part of the log can be fitted, with the problem of the first.
std::vector<ChainFit> FitChains(const ChainLog& log);

}  // namespace gauntlet::sim
