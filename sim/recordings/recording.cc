#include "sim/recordings/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/few_signals_on_heap.h"
#include "sim/recordings/glitches.h"
#include "sim/recordings/pchip.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/missing.h"
#include "sim/tables/recording_problem.h"

namespace gauntlet::sim {
namespace {

// Rows before and behind a stretch that are read with it: a glitch at its end is known by them.
constexpr std::size_t kRowsBeside = 3;
// Times in files are often rounded to the microsecond: a row so little after a sample is there.
constexpr double kSameMoment_s = 1e-6;

/// Rows of angles, as many as come, in blocks: see SignalStorage.
class RowTable {
 public:
  explicit RowTable(Eigen::Index width) : width_(width) {}

  void Add(const std::vector<double>& row) {
    const Eigen::Index place = rows_++ % kBlockRows;
    if (place == 0) {
      if (blocks_.size() == kBlocksOnHeap) few_on_heap_.emplace();
      blocks_.emplace_back(width_, kBlockRows);
    }
    std::ranges::copy(row, blocks_.back().col(place).begin());
    if (place == 0) TrimSignals();
  }
  /// While there are few.
  void RemoveFirst() {
    for (Eigen::Index row = 1; row < rows_; ++row) {
      blocks_.front().col(row - 1) = blocks_.front().col(row);
    }
    --rows_;
  }
  /// All of them; then there are none.
  Signal Take() {
    Signal all(rows_, width_);
    for (Eigen::Index block = 0; block < std::ssize(blocks_); ++block) {
      const Eigen::Index first = block * kBlockRows;
      const Eigen::Index count = std::min(kBlockRows, rows_ - first);
      all.middleRows(first, count) = blocks_[block].leftCols(count).transpose();
      blocks_[block] = {};
      TrimSignals();
    }
    rows_ = 0;
    blocks_.clear();
    return all;
  }

 private:
  static constexpr Eigen::Index kBlockRows = 1 << 16;
  static constexpr std::size_t kBlocksOnHeap = 2;  // some 10 MB each
  Eigen::Index width_;
  Eigen::Index rows_ = 0;
  std::vector<Signal> blocks_;                   // a column per row, so that it is in one piece
  std::optional<FewSignalsOnHeap> few_on_heap_;  // of a long recording
};

[[noreturn]] void FailAsTooShort(const RecordingReader& reader, const Recording& recording,
                                 double start_s) {
  std::string problem =
      recording.time_s.size() < 2
          ? fmt::format("the recording has {} good rows, must have at least 2",
                        recording.time_s.size())
          : fmt::format("the recording is {:.6g} s long, must be longer than start_s {:.6g}",
                        recording.time_s.back(), start_s);
  const std::string found = reader.MostFrequentProblem();
  if (!found.empty()) problem += fmt::format(" (found: {})", found);
  if (const auto repair = reader.MostFrequentRepair()) {
    const std::string cause = LikelyCause(*repair, kMissing);
    if (!cause.empty()) problem += "; " + cause;
  }
  throw UserError(
      {.place = fmt::format("{}:{}:1", recording.name, std::max<std::size_t>(reader.row(), 1)),
       .problem = problem});
}

/// Reports them in the order of rows and makes them NaN. `rows` are lines of the file.
void HandleGlitches(RecordingReader& reader, const std::vector<std::size_t>& rows, StretchEnds ends,
                    Recording& recording) {
  constexpr double kFarthest_rad = 1e6;  // of any converter; sums of larger ones overflow
  const auto leave_out = [&recording](const WildValue& wild) {
    recording.angle_rad(wild.row, wild.channel) = kMissing;
    recording.wild.push_back(wild);
  };
  std::vector<WildValue> glitches;
  for (Eigen::Index c = 0; c < recording.angle_rad.cols(); ++c) {
    const Channel& joint = KnownChannels()[c];
    if (!recording.has_channel[c]) continue;
    for (Eigen::Index row = 0; row < recording.angle_rad.rows(); ++row) {
      const double angle_rad = recording.angle_rad(row, c);
      if (!IsFarBeyondRange(joint, angle_rad)) continue;
      leave_out({row, c, std::clamp(angle_rad, -kFarthest_rad, kFarthest_rad)});
    }
    for (const Eigen::Index place :
         FindGlitches(recording.time_s, {recording.angle_rad.col(c).data(), rows.size()},
                      (joint.max_deg - joint.min_deg) * kRadPerDeg, ends)) {
      glitches.push_back({place, c, recording.angle_rad(place, c)});
    }
    TrimSignals();
  }
  std::ranges::stable_sort(glitches, {}, &WildValue::row);
  for (const WildValue& wild : glitches) {
    reader.Report(RecordingProblem::kGlitch, rows[wild.row], wild.channel,
                  fmt::format("{} jumps to {:.6g} deg and back, faster than a hand",
                              KnownChannels()[wild.channel].name, wild.angle_rad * kDegPerRad));
    leave_out(wild);
  }
}

/// Radians in columns of degrees are no problem to a reader: a hand that hardly moves.
void RemarkRadians(Recording& recording) {
  constexpr double kHalfTurn = 3.2;   // as a number
  constexpr double kLeastSpan = 0.3;  // likewise
  double largest = 0.0;
  double span = 0.0;
  for (Eigen::Index c = 0; c < recording.angle_rad.cols(); ++c) {
    if (!recording.has_channel[c]) continue;
    double low = 0.0;
    double high = 0.0;
    bool any = false;
    for (const double angle_rad : recording.angle_rad.col(c)) {
      if (!std::isfinite(angle_rad)) continue;
      const double angle_deg = angle_rad * kDegPerRad;
      low = any ? std::min(low, angle_deg) : angle_deg;
      high = any ? std::max(high, angle_deg) : angle_deg;
      any = true;
    }
    largest = std::max({largest, -low, high});
    span = std::max(span, high - low);
    TrimSignals();
  }
  if (largest > kHalfTurn || span < kLeastSpan) return;
  recording.remarks.push_back(
      fmt::format("{}: no angle is above {:.2g} deg: are they radians? A column map says unit rad",
                  recording.name, largest));
}

/// Errors: UserError if nearly all angles of a channel are beyond its joint's range.
void CheckRanges(const Recording& recording) {
  constexpr double kMostBeyond = 0.95;
  constexpr double kRounding_deg = 0.1;
  for (Eigen::Index c = 0; c < recording.angle_rad.cols(); ++c) {
    const Channel& joint = KnownChannels()[c];
    double beyond = 0.0, all = 0.0;
    for (const double angle_rad : recording.angle_rad.col(c)) {
      if (!std::isfinite(angle_rad)) continue;
      const double deg = angle_rad * kDegPerRad;
      all += 1.0;
      if (deg < joint.min_deg - kRounding_deg || deg > joint.max_deg + kRounding_deg) beyond += 1.0;
    }
    TrimSignals();
    if (all == 0.0 || beyond < kMostBeyond * all) continue;
    throw UserError({.place = recording.name,
                     .problem = fmt::format(
                         "{}: {:.0f} % of its angles are outside {:g} to {:g} deg; the unit or "
                         "the joint is another",
                         joint.name, 100.0 * beyond / all, joint.min_deg, joint.max_deg)});
  }
}

/// More repairs than that are no accident of a glove, but a mistake about the file.
void CheckBudget(const RecordingReader& reader, const Recording& recording, double budget_percent) {
  const double repaired_percent = 100.0 * reader.RepairedShare();
  if (repaired_percent <= budget_percent) return;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < recording.time_s.size(); ++i) {
    steps_s.push_back(recording.time_s[i] - recording.time_s[i - 1]);
  }
  const RecordingProblem problem = *reader.MostFrequentRepair();
  const std::string cause = LikelyCause(problem, controller::MedianOf(steps_s));
  throw UserError(
      {.place = recording.name,
       .problem = fmt::format(
           "{:.2g} % of its rows would need repair, mostly \"{}\"; at most {:g} % "
           "may (repair_budget_percent){}{}",
           repaired_percent, NameOf(problem), budget_percent, cause.empty() ? "" : "; ", cause)});
}

/// True for rows in which no channel changes.
std::vector<bool> UnchangedRows(const Recording& recording) {
  std::vector<bool> is_unchanged(recording.time_s.size(), true);
  is_unchanged[0] = false;
  bool any = false;
  for (Eigen::Index c = 0; c < recording.angle_rad.cols(); ++c) {
    if (!recording.has_channel[c]) continue;
    any = true;
    const auto angle = recording.angle_rad.col(c);
    for (Eigen::Index i = 1; i < angle.size(); ++i) {
      if (!(angle[i] == angle[i - 1])) is_unchanged[i] = false;
    }
    TrimSignals();
  }
  if (!any) is_unchanged.assign(is_unchanged.size(), false);
  return is_unchanged;
}

/// A glove that hangs repeats its last row. Such stretches are missing, if elsewhere nearly every
/// row is a new one.
void LeaveOutFrozen(Recording& recording) {
  constexpr std::size_t kFewestRows = 10;
  constexpr double kShortest_s = 0.25;
  constexpr double kMostElsewhere = 0.02;  // of the rows; slow gloves repeat rows all the time
  const std::vector<bool> is_unchanged = UnchangedRows(recording);
  const std::size_t rows = is_unchanged.size();
  std::vector<std::pair<std::size_t, std::size_t>> stretches;
  std::size_t elsewhere = 0, frozen = 0;
  double frozen_s = 0.0;
  for (std::size_t i = 0; i < rows;) {
    std::size_t end = i;
    while (end < rows && is_unchanged[end]) ++end;
    const double length_s = end > i ? recording.time_s[end - 1] - recording.time_s[i - 1] : 0.0;
    if (end - i >= kFewestRows && length_s >= kShortest_s) {
      stretches.emplace_back(i, end);
      frozen += end - i;
      frozen_s += length_s;
    } else {
      elsewhere += end - i;
    }
    i = std::max(end, i + 1);
  }
  const auto others = static_cast<double>(rows - frozen);
  if (stretches.empty() || static_cast<double>(elsewhere) > kMostElsewhere * others ||
      frozen + kFewestRows > rows) {
    return;
  }
  for (const auto& [begin, end] : stretches) {
    const auto count = static_cast<Eigen::Index>(end - begin);
    recording.angle_rad.middleRows(static_cast<Eigen::Index>(begin), count).setConstant(kMissing);
  }
  recording.remarks.push_back(
      fmt::format("{}: frozen, all channels at once, {} times, {:.4g} s in total: left out",
                  recording.name, stretches.size(), frozen_s));
}

/// One line for all channels that hardly ever change. Angles may stay at a limit of their
/// joint; a sensor there is clipped.
void RemarkRepeats(bool has_angles, Recording& recording) {
  std::string found;
  Eigen::Index longest = 0;
  for (Eigen::Index c = 0; c < recording.angle_rad.cols(); ++c) {
    if (!recording.has_channel[c]) continue;
    const auto angle = recording.angle_rad.col(c);
    const Channel& channel = KnownChannels()[c];
    const auto is_limit = [&](double angle_rad) {
      const double angle_deg = angle_rad * kDegPerRad;
      if (!has_angles) return false;
      return angle_deg < channel.min_deg + 1e-6 || angle_deg > channel.max_deg - 1e-6;
    };
    Eigen::Index repeats = 0, run = 0, longest_here = 0;
    for (Eigen::Index i = 1; i < angle.size(); ++i) {
      run = angle[i] == angle[i - 1] && !is_limit(angle[i]) ? run + 1 : 0;
      if (run > 0) ++repeats;
      longest_here = std::max(longest_here, run);
    }
    TrimSignals();
    if (2 * repeats < angle.size()) continue;
    longest = std::max(longest, longest_here);
    found += fmt::format("{}{} {:.3g} %", found.empty() ? "" : ", ", channel.name,
                         100.0 * static_cast<double>(repeats) / static_cast<double>(angle.size()));
  }
  if (found.empty()) return;
  recording.remarks.push_back(
      fmt::format("{}: rows that repeat the value before: {} (at most {} in a row)", recording.name,
                  found, longest));
}

/// The values of one channel that are not missing.
struct GoodValues {
  std::vector<double> time_s, value;
  double first_s, last_s;  // of all rows

  /// From the good value before to that of index k. Beyond the ends of the recording a gap of
  /// `gap_s` is assumed.
  double GapBefore(std::size_t k, double gap_s) const {
    const double before = k > 0 ? time_s[k - 1] : first_s - gap_s;
    const double after = k < time_s.size() ? time_s[k] : last_s + gap_s;
    return after - before;
  }
};

GoodValues GoodValuesOf(const Recording& recording, Eigen::Index channel) {
  GoodValues good{.time_s = {},
                  .value = {},
                  .first_s = recording.time_s.front(),
                  .last_s = recording.time_s.back()};
  for (std::size_t i = 0; i < recording.time_s.size(); ++i) {
    const double angle = recording.angle_rad(static_cast<Eigen::Index>(i), channel);
    if (!std::isfinite(angle)) continue;
    good.time_s.push_back(recording.time_s[i]);
    good.value.push_back(angle);
  }
  if (good.value.empty()) {
    throw UserError(
        {.place = recording.name,
         .problem = fmt::format("{} has no good value", KnownChannels()[channel].name)});
  }
  return good;
}

/// Each sample has the newest good value. In a long gap only the sample that first knows the value
/// before the gap is not masked.
void Hold(const GoodValues& good, double start_s, double rate_hz, double gap_s, Resampled& result) {
  std::size_t known = 0;  // good values up to the sample
  for (std::size_t i = 0; i < result.value.size(); ++i) {
    const double t = start_s + static_cast<double>(i) / rate_hz;
    while (known < good.time_s.size() && good.time_s[known] <= t + kSameMoment_s) ++known;
    result.value[i] = good.value[known > 0 ? known - 1 : 0];
    const bool is_new = known > 0 && t - good.time_s[known - 1] < 1.0 / rate_hz - kSameMoment_s;
    result.mask[i] = !is_new && good.GapBefore(known, gap_s) > gap_s + 1e-9;
  }
}

/// Lines of the file that were read, and the ends of the file among them.
struct ReadLines {
  std::vector<std::size_t> rows;
  StretchEnds ends = {.at_first_row = true, .at_last_row = true};
};

/// Reads the rows from `start_s` on, and some beside them.
ReadLines ReadAngles(RecordingReader& reader, double start_s, double duration_s,
                     Recording& recording) {
  ReadLines lines;
  const std::size_t width = KnownChannels().size();
  std::vector<double> angles(width);
  RowTable table(width);
  double first_s = kMissing;
  double time_s = 0.0;
  std::size_t rows_behind = 0;
  while (reader.NextRow(time_s, angles)) {
    if (std::isnan(first_s)) first_s = time_s;
    const double since_start_s = time_s - first_s;
    if (reader.restarted()) recording.restart_s.push_back(since_start_s);
    if (since_start_s <= start_s && lines.rows.size() == kRowsBeside) {
      recording.time_s.erase(recording.time_s.begin());
      lines.rows.erase(lines.rows.begin());
      table.RemoveFirst();
      lines.ends.at_first_row = false;
    }
    recording.time_s.push_back(since_start_s);
    lines.rows.push_back(reader.row());
    table.Add(angles);
    if (duration_s > 0.0 && since_start_s >= start_s + duration_s && ++rows_behind == kRowsBeside) {
      lines.ends.at_last_row = false;
      break;
    }
  }
  recording.angle_rad = table.Take();
  return lines;
}

}  // namespace

Recording LoadRecording(const std::filesystem::path& file, const RecordingFormat& format,
                        double start_s, double duration_s) {
  RecordingReader reader(file.string(), TableSource(file, format.array), format);
  Recording recording;
  recording.name = file.string();
  recording.has_channel = reader.has_channel();
  recording.own_counts = reader.own_counts();
  const ReadLines lines = ReadAngles(reader, start_s, duration_s, recording);
  if (recording.time_s.size() < 2 || recording.time_s.back() <= start_s) {
    FailAsTooShort(reader, recording, start_s);
  }
  HandleGlitches(reader, lines.rows, lines.ends, recording);
  CheckBudget(reader, recording, format.repair_budget_percent);
  if (format.keeps_to_range) CheckRanges(recording);
  recording.remarks = reader.Remarks();
  if (GoesOn(format.handling)) LeaveOutFrozen(recording);
  if (format.keeps_to_range) RemarkRadians(recording);
  RemarkRepeats(format.map.empty(), recording);
  return recording;
}

Resampled Resample(const Recording& recording, Eigen::Index channel, double start_s, double rate_hz,
                   std::size_t samples, double gap_s, Resampling how) {
  const GoodValues good = GoodValuesOf(recording, channel);
  Resampled result{std::vector<double>(samples), std::vector<bool>(samples, false)};
  if (how == Resampling::kHold) {
    Hold(good, start_s, rate_hz, gap_s, result);
    return result;
  }
  InterpolatePchip(good.time_s, good.value, start_s, rate_hz, result.value);
  std::size_t k = 0;  // first good value after the sample
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = start_s + static_cast<double>(i) / rate_hz;
    while (k < good.time_s.size() && good.time_s[k] < t) ++k;
    const bool on_a_value = k < good.time_s.size() && good.time_s[k] - t < 0.5 / rate_hz;
    result.mask[i] = !on_a_value && good.GapBefore(k, gap_s) > gap_s + 1e-9;
  }
  return result;
}

}  // namespace gauntlet::sim
