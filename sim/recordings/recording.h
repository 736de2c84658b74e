#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/signal.h"
#include "sim/recordings/recording_reader.h"

namespace gauntlet::sim {

/// A value that no hand can have: a glitch.
struct WildValue {
  Eigen::Index row = 0;
  Eigen::Index channel = 0;
  double angle_rad = 0.0;
};

/// A stretch of a recording, at its own times.
struct Recording {
  std::string name;                   // of the file, for messages
  std::vector<double> time_s;         // rises strictly; 0 is the first row of the file
  Signal angle_rad;                   // rows x channels of KnownChannels(); NaN is missing
  std::vector<bool> has_channel;      // per channel
  std::vector<OwnCounts> own_counts;  // channels in counts of the glove
  std::vector<WildValue> wild;        // NaN in angle_rad
  std::vector<double> restart_s;      // rows behind which the clock had started anew
  std::vector<std::string> remarks;   // what was repaired
};

/// Reads from start_s for duration_s (0: to the end). Rows before the stretch are passed over and
/// reading ends behind it, so memory grows with the stretch and not with the file.
///
/// Glitches (see FindGlitches) are a problem like all that RecordingReader finds: strict reading
/// stops at the first of the stretch. Otherwise they and angles far beyond the joint's range are
/// NaN in `angle_rad` and kept in `wild`. A remark tells where a channel hardly
/// ever changes: a slow device that was polled fast, a clipped sensor.
///
/// Errors: UserError in one line, also if the stretch has fewer than two rows, and where more than
/// repair_budget_percent of the rows would need a repair: with what most likely is wrong then.
Recording LoadRecording(const std::filesystem::path& file, const RecordingFormat& format,
                        double start_s = 0.0, double duration_s = 0.0);

/// How a sample between two rows of a recording is made.
enum class Resampling {
  kHold,   // the newest good value, as a fast loop reads a slow glove
  kCubic,  // shape-preserving interpolation, which looks ahead to the next rows
};
inline constexpr std::array<std::string_view, 2> kResamplingNames = {"hold", "cubic"};

/// One channel brought to another rate.
/// `gap_s`: where neighbouring good values are further apart, `mask` is set to true.
struct Resampled {
  std::vector<double> value;
  std::vector<bool> mask;
};
/// The good values of `channel` at start_s + i / rate_hz. A sample before the first has its value.
/// Errors: UserError if the channel has no good value.
Resampled Resample(const Recording& recording, Eigen::Index channel, double start_s, double rate_hz,
                   std::size_t samples, double gap_s, Resampling how = Resampling::kCubic);

}  // namespace gauntlet::sim
