#include "sim/live/session_recording.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <iterator>
#include <utility>

#include "sim/base/signal.h"
#include "sim/base/unfinished_mark.h"

namespace gauntlet::sim {

SessionRecording::SessionRecording(const controller::GloveCalibration& glove, double period_s,
                                   RecordingPlaces places)
    : glove_(glove),
      places_(std::move(places)),
      period_s_(period_s),
      angles_deg_(glove.channel_names.size()) {
  if (!places_.angles.empty()) {
    angles_.emplace(places_.angles);
    mark_.emplace(UnfinishedMark(places_.angles));
    mark_->Add(fmt::format(
        "gauntlet live writes {} and removes this file in the end. If it runs no more, it was "
        "killed: at most the last second of the recording is missing.\n",
        places_.angles.filename().string()));
    mark_->Flush();
  }
  if (!places_.counts.empty()) counts_.emplace(places_.counts);
}

bool SessionRecording::AddRow(double time_s, std::span<const double> values, std::string_view unit,
                              GrowingFile& file) {
  row_.clear();
  if (added_ == 1) {
    row_ = "time_s";
    for (const std::string& name : glove_.channel_names) row_.append(",").append(name).append(unit);
    row_ += '\n';
  }
  fmt::format_to(std::back_inserter(row_), "{:.6f}", time_s);
  for (const double value : values) {
    row_ += ',';
    if (!std::isnan(value)) fmt::format_to(std::back_inserter(row_), "{:.6g}", value);
  }
  row_ += '\n';
  return file.Add(row_);
}

void SessionRecording::Add(double time_s, std::span<const double> counts) {
  time_s = std::fmax(0.0, time_s);
  if (!bundle_.empty() && time_s > bundle_time_s_) AddBundle();
  if (bundle_.empty()) bundle_time_s_ = time_s;
  bundle_.insert(bundle_.end(), counts.begin(), counts.end());
  ++facts_.samples;
}

void SessionRecording::AddBundle() {
  if (bundle_.empty()) return;
  const std::size_t width = angles_deg_.size();
  const std::size_t count = bundle_.size() / width;
  // Nothing is known of the time before the first.
  const double since_s = added_ == 0 ? 0.0 : std::fmax(0.0, bundle_time_s_ - time_s_);
  const double step_s = std::fmin(since_s / static_cast<double>(count), period_s_);
  for (std::size_t i = 0; i < count; ++i) {
    double time_s = bundle_time_s_ - step_s * static_cast<double>(count - 1 - i);
    constexpr double kLeast_s = 1e-6;  // as times are written
    if (added_ > 0) time_s = std::fmax(time_s, time_s_ + kLeast_s);
    AddSample(time_s, std::span(bundle_).subspan(i * width, width));
  }
  bundle_.clear();
}

void SessionRecording::AddSample(double time_s, std::span<const double> counts) {
  ++added_;
  time_s_ = time_s;
  bool is_kept = counts_ && AddRow(time_s, counts, "_counts", *counts_);
  if (angles_) {
    for (std::size_t c = 0; c < counts.size(); ++c) {
      const double angle_rad =
          glove_.low_angle_rad[c] + (counts[c] - glove_.low_counts[c]) *
                                        (glove_.high_angle_rad[c] - glove_.low_angle_rad[c]) /
                                        (glove_.high_counts[c] - glove_.low_counts[c]);
      angles_deg_[c] = angle_rad * kDegPerRad;
    }
    is_kept = AddRow(time_s, angles_deg_, "_deg", *angles_);
  }
  if (is_kept) waiting_s_.push_back(time_s);
}

void SessionRecording::Note(double time_s, std::string_view what) {
  if (!mark_) return;
  mark_->Add(fmt::format("{:.6f} s: {}\n", time_s, what));
  has_notes_ = true;
}

void SessionRecording::Flush() {
  if (mark_) mark_->Flush();
  if (counts_) counts_->Flush();
  if (angles_) angles_->Flush();
  KeepFacts();
}

const GrowingFile* SessionRecording::First() const {
  return angles_ ? &*angles_ : counts_ ? &*counts_ : nullptr;
}

void SessionRecording::KeepFacts() {
  const GrowingFile* const file = First();
  if (file == nullptr) return;
  facts_.problem = file->problem();
  const std::int64_t news = file->lines() - 1 - facts_.kept;  // one is the names
  if (news <= 0) return;
  facts_.last_time_s = waiting_s_[static_cast<std::size_t>(news) - 1];
  facts_.kept += news;
  waiting_s_.erase(waiting_s_.begin(), waiting_s_.begin() + news);
}

void SessionRecording::End() {
  AddBundle();
  if (angles_) angles_->End();
  if (counts_) counts_->End();
  if (mark_) mark_->Remove();
  KeepFacts();
  const GrowingFile* const file = First();
  if (file == nullptr) return;
  if (facts_.problem.empty() && facts_.kept < facts_.samples) {
    facts_.problem = file->target().string() + ": the disk was too slow, or full for some time";
  }
  if (!facts_.problem.empty()) {
    facts_.problem += fmt::format("; {} of {} samples are kept, until {:.2f} s", facts_.kept,
                                  facts_.samples, facts_.last_time_s);
  } else if (counts_) {
    facts_.problem = counts_->problem();
  }
}

SessionRecording::~SessionRecording() {
  try {
    AddBundle();
    if (!mark_) return;
    angles_->End();
    if (angles_->lines() == 0 || !has_notes_) mark_->Remove();
  } catch (...) {
    // Without memory, what the disk has stays, and its mark.
    return;
  }
}

}  // namespace gauntlet::sim
