#include "sim/live/running_scores.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stop_token>
#include <utility>

#include "controller/assert.h"
#include "sim/live/session_threads.h"
#include "sim/recordings/zero_phase.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

using Index = Eigen::Index;

/// The ranges in ticks from `first` on, of `rows`.
CountedTicks Within(const CountedTicks& counted, std::int64_t first, Index rows) {
  CountedTicks within;
  for (const TickRange& range : counted) {
    const auto begin = std::max<std::int64_t>(range.begin - first, 0);
    const auto end = std::min<std::int64_t>(range.end - first, rows);
    if (begin < end) within.push_back({static_cast<int>(begin), static_cast<int>(end)});
  }
  return within;
}

/// A line from row `from` to row `to` of a signal.
void JoinRows(Index from, Index to, Signal& signal) {
  for (Index row = from + 1; row < to; ++row) {
    const double share = static_cast<double>(row - from) / static_cast<double>(to - from);
    signal.row(row) = (1.0 - share) * signal.row(from) + share * signal.row(to);
  }
}

/// Whatever stops a score, the session goes on, and brings its motors to rest: Ctrl-C ends long
/// computations by Cancelled, and there may be no memory.
void ShowScores(const ScoreWindow& window, LiveView& view) noexcept {
  try {
    view.ShowScores(window.time_s(), window.Scores());
  } catch (...) {
  }
}

void TakeMemoryOf(ScoreWindow& window) noexcept {
  try {
    window.TakeMemory();
  } catch (...) {
  }
}

}  // namespace

ScoreWindow::ScoreWindow(RunningScoring how)
    : how_(std::move(how)),
      channels_(static_cast<std::size_t>(how_.joint_map.channel_count())),
      joints_(static_cast<std::size_t>(how_.joint_map.joint_count())),
      capacity_(std::llround(kLength_s * how_.scoring.rate_hz)),
      values_rad_(static_cast<std::size_t>(capacity_) *
                  (channels_ + (1 + how_.earliest_delay_s.size()) * joints_)),
      has_sample_(static_cast<std::size_t>(capacity_)) {}

void ScoreWindow::Put(const ShownTick& tick, std::span<const double> values_rad) {
  const auto place = static_cast<std::size_t>(end_ % capacity_);
  std::ranges::copy(values_rad, values_rad_.begin() + std::ssize(values_rad) * (end_ % capacity_));
  has_sample_[place] = tick.has_sample;
  ++end_;
}

void ScoreWindow::Add(const ShownTick& tick, std::span<const double> values_rad) {
  GAUNTLET_ASSERT(values_rad.size() * static_cast<std::size_t>(capacity_) == values_rad_.size());
  constexpr double kMostRepeated_s = 0.1;
  const bool is_new =
      end_ == first_ || tick.number < end_ ||
      static_cast<double>(tick.number - end_) > kMostRepeated_s * how_.scoring.rate_hz;
  if (is_new) first_ = end_ = driving_since_ = tick.number;
  while (end_ < tick.number) {
    const std::ptrdiff_t width = std::ssize(values_rad);
    const auto last = values_rad_.begin() + width * ((end_ - 1) % capacity_);
    Put({}, std::vector<double>(last, last + width));
  }
  if (is_new || tick.driving != driving_) driving_since_ = end_;
  driving_ = tick.driving;
  Put(tick, values_rad);
}

void ScoreWindow::TakeMemory() {
  constexpr double kMotion_hz = 0.7;
  const std::size_t width = values_rad_.size() / static_cast<std::size_t>(capacity_);
  std::vector<double> values_rad(width);
  std::int64_t ticks = capacity_;
  if (how_.simulated_glove) {
    ticks = std::min<std::int64_t>(ticks, how_.simulated_glove->true_angle_rad.rows());
  }
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const double time_s = static_cast<double>(tick) / how_.scoring.rate_hz;
    std::ranges::fill(values_rad, std::sin(2.0 * std::numbers::pi * kMotion_hz * time_s));
    Add({.number = tick, .has_sample = true}, values_rad);
  }
  Scores();
  first_ = end_ = 0;
}

/// Columns of the ticks from this row on.
Signal ScoreWindow::ValuesFrom(Index first, std::size_t first_value, std::size_t count) const {
  const std::size_t width = values_rad_.size() / static_cast<std::size_t>(capacity_);
  Signal values(end_ - begin() - first, static_cast<Index>(count));
  for (Index row = 0; row < values.rows(); ++row) {
    const auto place = static_cast<std::size_t>((begin() + first + row) % capacity_);
    const double* const tick = values_rad_.data() + width * place + first_value;
    for (std::size_t i = 0; i < count; ++i) values(row, static_cast<Index>(i)) = tick[i];
  }
  return values;
}

/// Rows between samples that are near to each other.
CountedTicks ScoreWindow::WithSamples() const {
  CountedTicks ranges;
  const double longest = how_.longest_gap_s * how_.scoring.rate_hz;
  for (std::int64_t tick = begin(); tick < end_; ++tick) {
    if (!has_sample_[static_cast<std::size_t>(tick % capacity_)]) continue;
    const int row = static_cast<int>(tick - begin());
    if (ranges.empty() || row - (ranges.back().end - 1) > longest) ranges.push_back({row, row});
    ranges.back().end = row + 1;
  }
  return ranges;
}

Signal ScoreWindow::Reference(const CountedTicks& with_samples) const {
  if (how_.simulated_glove) {
    return ReferenceAngles(
        how_.joint_map, how_.simulated_glove->true_angle_rad.middleRows(begin(), end_ - begin()));
  }
  Signal channels_rad = ValuesFrom(0, 0, channels_);
  for (const TickRange& range : with_samples) {
    Index before = range.begin;
    for (Index row = range.begin + 1; row < range.end; ++row) {
      if (!has_sample_[static_cast<std::size_t>((begin() + row) % capacity_)]) continue;
      JoinRows(before, row, channels_rad);
      before = row;
    }
    for (Index channel = 0; channel < channels_rad.cols(); ++channel) {
      const std::span column(channels_rad.col(channel).data(),
                             static_cast<std::size_t>(channels_rad.rows()));
      SmoothZeroPhase(how_.smoothing_hz, how_.scoring.rate_hz,
                      column.subspan(static_cast<std::size_t>(range.begin),
                                     static_cast<std::size_t>(range.end - range.begin)));
    }
  }
  return JointAngles(how_.joint_map, channels_rad);
}

/// Of the joints that count.
std::vector<CountedTicks> ScoreWindow::Counted(const CountedTicks& with_samples) const {
  const Index rows = end_ - begin();
  std::vector<CountedTicks> counted;
  for (std::size_t joint = 0; joint < how_.scoring.joints.size(); ++joint) {
    if (how_.simulated_glove) {
      counted.push_back(how_.counted ? Within((*how_.counted)[joint], begin(), rows)
                                     : CountedTicks{{0, static_cast<int>(rows)}});
      continue;
    }
    const int recovery = static_cast<int>(how_.recovery_s * how_.scoring.rate_hz);
    CountedTicks& own = counted.emplace_back();
    for (const TickRange& range : with_samples) {
      const int from = range.begin + (&range == &with_samples.front() ? 0 : recovery);
      if (from < range.end) own.push_back({from, range.end});
    }
  }
  return counted;
}

/// Scores controllers by the rows from `first` on; one that drives by what it drove.
void ScoreWindow::ScoreFrom(Index first, std::span<const std::size_t> controllers,
                            const Signal& whole_reference_rad,
                            std::span<const CountedTicks> counted,
                            std::vector<RunningScore>& running) const {
  const Index rows = whole_reference_rad.rows() - first;
  const Signal later_reference_rad =
      first == 0 ? Signal() : Signal(whole_reference_rad.bottomRows(rows));
  const Signal& reference_rad = first == 0 ? whole_reference_rad : later_reference_rad;
  std::vector<CountedTicks> counted_rows;
  for (const CountedTicks& joint : counted) counted_rows.push_back(Within(joint, first, rows));
  std::vector<Signal> asked_rad;
  for (const std::size_t controller : controllers) {
    const std::size_t place = static_cast<int>(controller) == driving_ ? 0 : 1 + controller;
    asked_rad.push_back(ValuesFrom(first, channels_ + place * joints_, joints_));
  }
  std::vector<AskedAngles> asked;
  for (std::size_t i = 0; i < controllers.size(); ++i) {
    asked.push_back({.reference_rad = &reference_rad,
                     .asked_rad = &asked_rad[i],
                     .counted = &counted_rows,
                     .earliest_delay_s = how_.earliest_delay_s[controllers[i]]});
  }
  const double over_s = static_cast<double>(rows) / how_.scoring.rate_hz;
  const std::vector<TargetScores> scores = ScoreTargets(how_.scoring, asked);
  for (std::size_t i = 0; i < controllers.size(); ++i) {
    running[controllers[i]] = {.over_s = over_s,
                               .jitter_rms_deg = scores[i].jitter_rms_deg,
                               .delay_ms = over_s < kLeastDelay_s ? kNaN : scores[i].delay_ms};
  }
}

std::vector<RunningScore> ScoreWindow::Scores() const {
  std::vector<RunningScore> running(how_.earliest_delay_s.size(), {0.0, kNaN, kNaN});
  if (end_ == first_) return running;
  const CountedTicks with_samples = WithSamples();
  const Signal reference_rad = Reference(with_samples);
  const std::vector<CountedTicks> counted = Counted(with_samples);
  const Index driven_from = std::max<std::int64_t>(driving_since_ - begin(), 0);
  std::vector<std::size_t> whole, since_switch;
  for (std::size_t i = 0; i < running.size(); ++i) {
    const bool is_short = static_cast<int>(i) == driving_ && driven_from > 0;
    (is_short ? since_switch : whole).push_back(i);
  }
  ScoreFrom(0, whole, reference_rad, counted, running);
  if (!since_switch.empty()) {
    ScoreFrom(driven_from, since_switch, reference_rad, counted, running);
  }
  return running;
}

RunningScores::RunningScores(RunningScoring how, LiveView& view)
    : thread_(StartThread(
          [window = ScoreWindow(std::move(how)), &view](const std::stop_token& stop) mutable {
            constexpr int kNice = 10;
            setpriority(PRIO_PROCESS, 0, kNice);  // on Linux of this thread alone
            TakeMemoryOf(window);
            constexpr int kLooksPerScore = 10;
            for (int look = 1; !stop.stop_requested(); ++look) {
              std::this_thread::sleep_for(std::chrono::milliseconds(50));
              while (view.NextTick([&](const ShownTick& tick, std::span<const double> values_rad) {
                window.Add(tick, values_rad);
              })) {
              }
              if (look % kLooksPerScore == 0) ShowScores(window, view);
            }
          })) {}

}  // namespace gauntlet::sim
