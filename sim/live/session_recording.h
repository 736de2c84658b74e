#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/controller_config.h"
#include "sim/base/growing_file.h"

namespace gauntlet::sim {

/// Files of a session that are written as it runs; none where a path is empty.
struct RecordingPlaces {
  std::filesystem::path angles;  // `time_s`, then `NAME_deg` per channel, as every command takes
  std::filesystem::path counts;  // `time_s`, then `NAME_counts` per channel, as they came
};

/// Samples of a recording, and those of them that the disk has.
struct RecordedFacts {
  std::int64_t samples = 0;  // that came
  std::int64_t kept = 0;
  double last_time_s = 0.0;  // of the last that is kept
  std::string problem;       // why some are not; empty: all are
};

/// The samples of a glove, which cannot be made again: they are on the disk within a second and
/// readable whatever happens then. While the session runs, a file beside it (unfinished_mark.h)
/// says so, and what else came of the session. Of one thread, which may wait for a disk.
class SessionRecording {
 public:
  /// Errors: UserError for a file that exists already; RunError.
  SessionRecording(const controller::GloveCalibration& glove, double period_s,
                   RecordingPlaces places);
  /// Keeps what there is, and the mark if it says more than that the session did not end well.
  ~SessionRecording();
  SessionRecording(const SessionRecording&) = delete;
  SessionRecording& operator=(const SessionRecording&) = delete;

  /// Counts of the channels; NaN for what did not come. Samples that arrived together, as some
  /// devices bundle them, were captured one after the other: at most `period_s` apart.
  void Add(double time_s, std::span<const double> counts);
  /// A line for the mark: what the samples do not say.
  void Note(double time_s, std::string_view what);
  /// A sample for which the disk was too slow.
  void AddLost() { ++facts_.samples; }
  /// Brings all of it to the disk, as far as it takes it. To be called twice a second.
  void Flush();
  /// Ends the files, and the mark with them.
  void End();

  const RecordedFacts& facts() const { return facts_; }

 private:
  const GrowingFile* First() const;
  void KeepFacts();
  void AddBundle();
  void AddSample(double time_s, std::span<const double> counts);
  bool AddRow(double time_s, std::span<const double> values, std::string_view unit,
              GrowingFile& file);

  const controller::GloveCalibration& glove_;
  RecordingPlaces places_;
  std::optional<GrowingFile> angles_;
  std::optional<GrowingFile> counts_;
  std::optional<GrowingFile> mark_;
  RecordedFacts facts_;
  bool has_notes_ = false;
  std::int64_t added_ = 0;
  double period_s_;
  double time_s_ = 0.0;            // of the last sample that was added
  double bundle_time_s_ = 0.0;     // of the samples that follow it
  std::vector<double> bundle_;     // their counts
  std::vector<double> waiting_s_;  // times of those that wait for the disk
  std::vector<double> angles_deg_;
  std::string row_;
};

}  // namespace gauntlet::sim
