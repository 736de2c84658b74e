#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "controller/settings.h"
#include "sim/glove/motions/motion.h"
#include "sim/recordings/recording.h"
#include "sim/recordings/recording_reader.h"

namespace gauntlet::sim {

/// Meaning of a recording.
enum class RecordingUse {
  kTruth,     // the wearer's true motion, under the simulated glove
  kMeasured,  // what a real glove said: it goes to the converter as it is
};

/// Source of the reference's offset in time.
enum class ReferenceOffset {
  kGiven,  // reference_offset_s
  kAuto,   // found by correlation
};

/// Joint angles from a text file, brought to the sampling rate.
struct RecordedMotionConfig {
  static constexpr std::string_view kKind = "recording";
  static constexpr std::string_view kSummary = "joint angles or glove values from a file";

  std::string file = {};
  std::string map = {};
  std::string array = {};
  double file_rate_hz = 0.0;
  int skip_lines = 0;
  ProblemHandling problems = ProblemHandling::kStrict;
  double longest_gap_ms = 100.0;
  double repair_budget_percent = 5.0;
  double start_s = 0.0;
  double duration_s = 0.0;  // 0: to the end
  RecordingUse use = RecordingUse::kTruth;
  std::optional<Resampling> resample = {};  // none: what fits the use
  std::string reference = {};               // for measured: a recording of the truth
  std::string reference_map = {};           // of that file; empty: as `map`
  std::string reference_array = {};         // in that file; empty: as `array`
  double reference_rate_hz = 0.0;           // rows per second of that file; 0: as file_rate_hz
  ReferenceOffset reference_offset = ReferenceOffset::kGiven;
  double reference_offset_s = 0.0;  // by how much later the same moment is in that file
  double smoothing_hz = 5.0;        // for measured without one

  /// A person moves smoothly between two rows; a glove's newest row is all that is known of it.
  Resampling resampling() const {
    return resample.value_or(use == RecordingUse::kTruth ? Resampling::kCubic : Resampling::kHold);
  }
  void Visit(controller::SettingsVisitor& visitor);
};

/// The column map of the recording, or the map by the names of its columns. Errors: UserError.
ColumnMap ReadMapOf(const RecordedMotionConfig& config);

/// The measured angles of another file with the rows of `played`, the recording that these settings
/// play, as MakeMotion() would measure them; NaN in gaps. `map`: of this file, empty: that of the
/// settings. Errors: UserError for a file that cannot be read, or that lacks a row of `played`.
Motion MeasuredAgain(const RecordedMotionConfig& config, const std::string& file,
                     const std::string& map, const Recording& played, const MotionContext& context);

/// For `measured`, angle_rad is the reference, always by interpolation, and measured_rad what the
/// glove measured. Unknown motion is `masked`: gaps and restarts, of a measured recording also
/// clipped parts, and parts without a reference.
/// The columns in counts are those of the default sensor and converter unless given.
/// Errors: UserError for a file that cannot be read or is too short.
Motion MakeMotion(const RecordedMotionConfig& config, const MotionContext& context);

}  // namespace gauntlet::sim
