#include "sim/glove/recordings/recording.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "sim/base/error.h"
#include "sim/glove/channels.h"
#include "sim/glove/recordings/pchip.h"

namespace gauntlet::sim {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr double kGlitchJump = 0.25;    // of the joint's range
constexpr double kGlitchReturn = 0.10;  // of the joint's range

double RangeOf(Eigen::Index channel) {
  const Channel& joint = GloveChannels()[static_cast<std::size_t>(channel)];
  return (joint.max_deg - joint.min_deg) * kRadPerDeg;
}

}  // namespace

Recording LoadRecording(const std::filesystem::path& file, const RecordingFormat& format,
                        double start_s, double duration_s) {
  RecordingReader reader(file.string(), FileSource(file), format);
  Recording recording;
  recording.name = file.string();
  recording.has_channel = reader.has_channel();
  const std::size_t width = GloveChannels().size();
  std::vector<double> row(width);
  std::vector<double> rows;
  double first_s = kMissing;
  double time_s = 0.0;
  int rows_behind = 0;
  while (reader.NextRow(time_s, row)) {
    if (std::isnan(first_s)) first_s = time_s;
    const double since_start_s = time_s - first_s;
    // Two rows on either side of the stretch are kept: the slopes at its ends need them.
    if (since_start_s <= start_s && recording.time_s.size() == 2) {
      recording.time_s.erase(recording.time_s.begin());
      rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(width));
    }
    recording.time_s.push_back(since_start_s);
    rows.insert(rows.end(), row.begin(), row.end());
    if (duration_s > 0.0 && since_start_s >= start_s + duration_s && ++rows_behind == 2) break;
  }
  if (recording.time_s.size() < 2 || recording.time_s.back() <= start_s) {
    throw UserError(fmt::format(
        "{}:{}:1: the recording has {} rows after start_s {}, must have at least 2", recording.name,
        std::max<std::size_t>(reader.row(), 1), recording.time_s.size(), start_s));
  }
  const Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> table(
      rows.data(), static_cast<Eigen::Index>(recording.time_s.size()),
      static_cast<Eigen::Index>(width));
  recording.angle_rad = table;
  recording.remarks = reader.Remarks();
  return recording;
}

Resampled Resample(const Recording& recording, Eigen::Index channel, double start_s, double rate_hz,
                   std::size_t samples, double gap_s) {
  std::vector<double> time_s, value;
  for (std::size_t i = 0; i < recording.time_s.size(); ++i) {
    const double angle = recording.angle_rad(static_cast<Eigen::Index>(i), channel);
    if (!std::isfinite(angle)) continue;
    time_s.push_back(recording.time_s[i]);
    value.push_back(angle);
  }
  if (value.empty()) {
    throw UserError(fmt::format("{}: {} has no good value", recording.name,
                                GloveChannels()[static_cast<std::size_t>(channel)].name));
  }
  Resampled result{std::vector<double>(samples), std::vector<bool>(samples, false)};
  InterpolatePchip(time_s, value, start_s, rate_hz, result.value);
  std::size_t k = 0;  // first good value after the sample
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = start_s + static_cast<double>(i) / rate_hz;
    while (k < time_s.size() && time_s[k] < t) ++k;
    const double before = k > 0 ? time_s[k - 1] : recording.time_s.front() - gap_s;
    const double after = k < time_s.size() ? time_s[k] : recording.time_s.back() + gap_s;
    const bool on_a_value = k < time_s.size() && time_s[k] - t < 0.5 / rate_hz;
    result.mask[i] = !on_a_value && after - before > gap_s + 1e-9;
  }
  return result;
}

void RemoveGlitches(Recording& recording) {
  for (Eigen::Index channel = 0; channel < recording.angle_rad.cols(); ++channel) {
    if (!recording.has_channel[static_cast<std::size_t>(channel)]) continue;
    auto angle = recording.angle_rad.col(channel);
    const double range = RangeOf(channel);
    std::size_t count = 0;
    for (Eigen::Index i = 1; i + 1 < angle.size(); ++i) {
      const double back = angle[i] - angle[i - 1];
      const double ahead = angle[i] - angle[i + 1];
      if (std::min(std::abs(back), std::abs(ahead)) > kGlitchJump * range && back * ahead > 0.0 &&
          std::abs(ahead - back) < kGlitchReturn * range) {
        angle[i] = kMissing;
        ++count;
      }
    }
    if (count == 0) continue;
    recording.remarks.push_back(
        fmt::format("{}: {}: {} single wild values left out", recording.name,
                    GloveChannels()[static_cast<std::size_t>(channel)].name, count));
  }
}

void RemarkRepeats(Recording& recording) {
  for (Eigen::Index channel = 0; channel < recording.angle_rad.cols(); ++channel) {
    if (!recording.has_channel[static_cast<std::size_t>(channel)]) continue;
    const auto angle = recording.angle_rad.col(channel);
    Eigen::Index repeats = 0, run = 0, longest = 0;
    for (Eigen::Index i = 1; i < angle.size(); ++i) {
      run = angle[i] == angle[i - 1] ? run + 1 : 0;
      repeats += run > 0 ? 1 : 0;
      longest = std::max(longest, run);
    }
    if (2 * repeats < angle.size()) continue;
    recording.remarks.push_back(fmt::format(
        "{}: {}: {:.0f} % of the rows repeat the value before, {} rows in a row at most",
        recording.name, GloveChannels()[static_cast<std::size_t>(channel)].name,
        100.0 * static_cast<double>(repeats) / static_cast<double>(angle.size()), longest));
  }
}

}  // namespace gauntlet::sim
