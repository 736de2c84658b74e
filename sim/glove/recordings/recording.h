#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/base/signal.h"

namespace gauntlet::sim {

/// A file of joint angles as it was recorded: at its own times.
struct Recording {
  std::string name;               // of the file, for messages
  std::vector<double> time_s;     // rises strictly
  Signal angle_rad;               // rows x channels of GloveChannels()
  std::vector<bool> has_channel;  // per channel
};

/// Reads a recording: a header with `time_s` and any of the glove's channels by name, in degrees.
/// Errors: UserError `file:row:column: ...` in one line.
Recording LoadRecording(const std::filesystem::path& file);

}  // namespace gauntlet::sim
