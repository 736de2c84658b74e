#include "sim/recordings/recording_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/recordings/column_scale.h"
#include "sim/tables/missing.h"
#include "sim/tables/recording_problem.h"

namespace gauntlet::sim {
namespace {

// Further outside the joint's range than this share of it no hand and no bad calibration gets.
constexpr double kGlitchShare = 0.5;
// Files are rounded: pi/2 as 1.571 is a hundredth of a degree more.
constexpr double kRangeRounding_deg = 0.1;

/// Errors: UserError without a rate and a time; a strict reading also refuses both.
void CheckRate(const CsvReader& csv, const ColumnMap& map, const RecordingFormat& format,
               std::vector<std::string>& notes) {
  const bool has_rate = format.rate_hz > 0.0;
  if (map.time.empty() && !has_rate) {
    csv.Fail(1, fmt::format("there is no column of time; without one {} must be given",
                            format.rate_key));
  }
  if (map.time.empty() || !has_rate) return;
  if (format.handling == ProblemHandling::kStrict) {
    csv.Fail(map.time.front().column + 1,
             fmt::format("is a column of time, {} must not be given", format.rate_key));
  }
  notes.push_back(fmt::format("{} not used beside a column of time", format.rate_key));
}

}  // namespace

RecordingReader::RecordingReader(std::string name, TableInput input, const RecordingFormat& format)
    : handling_(format.handling), longest_gap_s_(1e-3 * format.longest_gap_ms) {
  csv_ = std::make_unique<CsvReader>(
      std::move(name), std::move(input), format.handling,
      [this](RecordingProblem problem, std::size_t row) { Note(problem, row); },
      format.skipped_lines);
  row_ = csv_->row();
  std::vector<std::string> left_out;
  map_ = format.map.empty() ? MapByHeader(*csv_, format.handling, left_out)
                            : ReadColumnMap(format.map, *csv_);
  for (const std::string& column : left_out) {
    notes_.push_back(fmt::format("unknown column {} left out", csv_->Quoted(column)));
  }
  CheckRate(*csv_, map_, format, notes_);
  if (std::string assumed = AssumptionsOf(map_); !assumed.empty()) notes_.push_back(assumed);
  if (map_.time.empty()) row_period_s_ = 1.0 / format.rate_hz;
  values_.resize(csv_->column_count());
  next_values_.resize(csv_->column_count());
  has_channel_.assign(KnownChannels().size(), false);
  std::vector<bool> used(csv_->column_count(), false);
  for (const TimeMapping& time : map_.time) {
    used[time.column] = true;
    if (time.is_text) csv_->ReadAsTime(time.column);
  }
  midnight_ = MidnightClock(map_.time);
  own_counts_ = OwnCountsOf(map_, format.nominal);
  for (const ColumnMapping& mapping : map_.channels) {
    used[mapping.column] = true;
    has_channel_[mapping.channel] = true;
  }
  AddChannels(format);
  for (std::size_t column = 0; column < used.size(); ++column) {
    if (!used[column]) csv_->Ignore(column);
  }
  if (map_.hand) KeepHand(*map_.hand, *csv_);
}

void RecordingReader::AddChannels(const RecordingFormat& format) {
  keeps_to_range_ = format.keeps_to_range;
  std::map<std::size_t, ChannelValues::Parts> parts;
  for (const ColumnMapping& mapping : map_.channels) {
    std::erase(channels_, mapping.channel);
    channels_.push_back(mapping.channel);
    parts[mapping.channel].push_back(
        PartOf(mapping, format.nominal[PlaceInList(mapping.channel, format.nominal.size())]));
  }
  std::vector<ChannelValues::Parts> of_channels;
  for (const std::size_t channel : channels_) of_channels.push_back(parts[channel]);
  angles_ = ChannelValues(std::move(of_channels));
  for (const std::string& envelope : EnvelopesOf(map_)) notes_.push_back(envelope);
}

RecordingReader::Count& RecordingReader::Note(RecordingProblem problem, std::size_t row) {
  Count& count = problems_[problem];
  if (count.rows++ == 0) count.first_row = row;
  if (NeedsRepair(problem) && row != last_repaired_row_) {
    ++repaired_rows_;  // one row, whatever is wrong with it
    last_repaired_row_ = row;
  }
  return count;
}

void RecordingReader::ReportHere(RecordingProblem problem, std::size_t column,
                                 const std::string& message) {
  if (handling_ == ProblemHandling::kStrict) csv_->FailInRow(row_, column, message);
  Note(problem, row_);
}

void RecordingReader::Report(RecordingProblem problem, std::size_t row, std::size_t channel,
                             const std::string& message) {
  if (handling_ == ProblemHandling::kStrict) {
    const auto place = std::ranges::find(channels_, channel) - channels_.begin();
    csv_->FailInRow(row, angles_.parts(place).front().column + 1, message);
  }
  ++Note(problem, row).rows_of_channel[channel];
}

namespace {

double BeyondRangeDeg(const Channel& joint, double angle_deg) {
  return std::max(joint.min_deg - angle_deg, angle_deg - joint.max_deg);
}

}  // namespace

bool IsFarBeyondRange(const Channel& joint, double angle_rad) {
  return BeyondRangeDeg(joint, angle_rad * kDegPerRad) >
         kGlitchShare * (joint.max_deg - joint.min_deg);
}

void RecordingReader::CheckRange(std::size_t channel, double angle_rad) {
  const Channel& joint = KnownChannels()[channel];
  const double angle_deg = angle_rad * kDegPerRad;
  const double beyond_deg = BeyondRangeDeg(joint, angle_deg);
  const bool is_glitch = IsFarBeyondRange(joint, angle_rad);
  if (!is_glitch && !(keeps_to_range_ && beyond_deg > kRangeRounding_deg)) return;
  Report(is_glitch ? RecordingProblem::kFarBeyondRange : RecordingProblem::kBeyondRange, row_,
         channel,
         fmt::format("{} is {:.6g} deg, the joint has {} to {} deg", joint.name, angle_deg,
                     joint.min_deg, joint.max_deg));
}

bool RecordingReader::FixTime(double& time_s) {
  if (map_.time.empty()) {
    time_s = good_rows_ * row_period_s_;
    return true;
  }
  const std::size_t column = map_.time.back().column + 1;
  const double given_s = TimeOfRow(map_.time, values_);
  if (!std::isfinite(given_s)) return false;  // the CSV reader has reported it
  if (std::abs(given_s) > 1e12) {
    ReportHere(RecordingProblem::kTimeOutOfRange, column, fmt::format("the time is {} s", given_s));
    return false;
  }
  time_s = midnight_.Add(given_s) + clock_offset_s_;
  if (good_rows_ == 0) return true;
  const double step_s = time_s - last_time_s_;
  if (GoesOn(handling_) && IsWildTime(step_s)) {
    Note(RecordingProblem::kWildTime, row_);
    return false;
  }
  constexpr std::size_t kMostCopies = 3;  // of a row; more are a clock that stands still
  if (step_s == 0.0 && GoesOn(handling_) && AreSame(values_, last_values_) &&
      doubled_rows_ < kMostCopies * good_rows_) {
    ++doubled_rows_;
    return false;
  }
  if (step_s > 0.0) {
    if (step_s > longest_gap_s_) {
      ReportHere(RecordingProblem::kGap, column,
                 fmt::format("nothing for {:.6g} ms", 1e3 * step_s));
    }
    return true;
  }
  const std::string message =
      fmt::format("the time is {} s, must be above {} s of the row before", time_s, last_time_s_);
  if (step_s > -kClockRestart_s) {
    ReportHere(step_s == 0.0 ? RecordingProblem::kRepeatedTime : RecordingProblem::kOutOfOrder,
               column, message);
    return false;
  }
  ReportHere(RecordingProblem::kClockRestart, column, message);
  restarted_ = true;
  const double expected_s = last_time_s_ + (last_step_s_ > 0.0 ? last_step_s_ : 0.01);
  clock_offset_s_ += expected_s - time_s;
  time_s = expected_s;
  return time_s > last_time_s_;
}

bool RecordingReader::IsWildTime(double step_s) {
  // The longest way from one row to the next but one, also in a slow recording.
  const double longest_step_s = std::max(longest_gap_s_, 3.0 * last_step_s_);
  const bool is_far = step_s > longest_step_s || step_s <= -kClockRestart_s;
  if (!is_far || good_rows_ < 2) return false;
  if (!has_next_) {
    has_next_ = csv_->NextRow(next_values_);
    next_row_ = csv_->row();
  }
  if (!has_next_) return std::abs(step_s) > kClockRestart_s;
  const double next_s =
      MidnightClock(midnight_).Add(TimeOfRow(map_.time, next_values_)) + clock_offset_s_;
  const double next_step_s = next_s - last_time_s_;
  return next_step_s > 0.0 && next_step_s <= longest_step_s;
}

bool RecordingReader::ReadRow() {
  if (has_next_) {
    std::swap(values_, next_values_);
    row_ = next_row_;
    has_next_ = false;
    return true;
  }
  if (!csv_->NextRow(values_)) return false;
  row_ = csv_->row();
  return true;
}

bool RecordingReader::NextRow(double& time_s, std::span<double> angle_rad) {
  while (ReadRow()) {
    double now_s = 0.0;
    restarted_ = false;
    if (!FixTime(now_s)) continue;
    if (good_rows_++ > 0) last_step_s_ = now_s - last_time_s_;
    last_time_s_ = time_s = now_s;
    last_values_ = values_;
    for (std::size_t c = 0; c < angle_rad.size(); ++c) angle_rad[c] = kMissing;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      double& angle = angle_rad[channels_[i]];
      angle = angles_.Next(i, now_s, values_);
      CheckRange(channels_[i], angle);
    }
    return true;
  }
  return false;
}

std::vector<std::string> RecordingReader::Remarks() const {
  std::vector<std::string> remarks = notes_;
  if (midnight_.midnights() > 0) remarks.emplace_back(kPastMidnight);
  if (doubled_rows_ > 0) {
    remarks.push_back(
        fmt::format("{} rows repeat the one before and its time: left out", doubled_rows_));
  }
  for (std::string& remark : csv_->remarks()) remarks.push_back(OneLine(remark));
  for (const auto& [problem, count] : problems_) remarks.push_back(Remark(problem, count));
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    for (std::size_t k = 0; k < angles_.parts(i).size(); ++k) {
      const std::size_t jumps = angles_.jumps(i, k);
      if (jumps == 0) continue;
      const ChannelValues::Part& part = angles_.parts(i)[k];
      remarks.push_back(fmt::format("column {} jumps by {:g}: {} jump{} removed ({})",
                                    part.column + 1, part.wraps_at, jumps, jumps == 1 ? "" : "s",
                                    KnownChannels()[channels_[i]].name));
    }
  }
  std::ranges::sort(remarks);
  for (std::string& remark : remarks) remark.insert(0, csv_->name() + ": ");
  return remarks;
}

std::optional<RecordingProblem> RecordingReader::MostFrequentRepair() const {
  std::size_t most = 0;
  std::optional<RecordingProblem> found;
  for (const auto& [problem, count] : problems_) {
    if (!NeedsRepair(problem)) continue;
    // Whatever else is wrong with time makes gaps, too.
    const std::size_t weight = problem == RecordingProblem::kGap ? count.rows / 10 : count.rows;
    if (found && weight <= most) continue;
    most = weight;
    found = problem;
  }
  return found;
}

double RecordingReader::RepairedShare() const {
  const std::size_t rows = std::max<std::size_t>(csv_->row() - csv_->first_row() + 1, 1);
  return static_cast<double>(repaired_rows_) / static_cast<double>(rows);
}

std::string RecordingReader::MostFrequentProblem() const {
  if (problems_.empty()) return "";
  const auto& [problem, count] =
      *std::ranges::max_element(problems_, {}, [](const auto& entry) { return entry.second.rows; });
  return Remark(problem, count);
}

std::string RecordingReader::Remark(RecordingProblem problem, const Count& count) const {
  std::string remark =
      fmt::format("{}: {} times, first in row {}", NameOf(problem), count.rows, count.first_row);
  const char* before = " (";
  for (const auto& [channel, rows] : count.rows_of_channel) {
    remark += fmt::format("{}{} {:.3g} %", before, KnownChannels()[channel].name,
                          100.0 * static_cast<double>(rows) / static_cast<double>(good_rows_));
    before = ", ";
  }
  return count.rows_of_channel.empty() ? remark : remark + " of the rows)";
}

}  // namespace gauntlet::sim
