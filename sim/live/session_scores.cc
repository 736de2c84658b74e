#include "sim/live/session_scores.h"

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
      values_rad_(static_cast<std::size_t>(capacity_) * (2 + how_.earliest_delay_s.size()) *
                  joints_),
      has_sample_(static_cast<std::size_t>(capacity_)) {}

/// The row of a tick: angles of the joints by the glove, then those that were asked for.
std::span<double> ScoreWindow::RowOf(std::int64_t tick) {
  const std::size_t width = values_rad_.size() / static_cast<std::size_t>(capacity_);
  return std::span(values_rad_).subspan(width * static_cast<std::size_t>(tick % capacity_), width);
}

void ScoreWindow::Add(const ShownTick& tick, std::span<const double> values_rad) {
  const std::size_t asked = values_rad.size() - channels_;
  GAUNTLET_ASSERT(joints_ + asked == RowOf(0).size());
  constexpr double kMostRepeated_s = 0.1;
  const bool is_new =
      end_ == first_ || tick.number < end_ ||
      static_cast<double>(tick.number - end_) > kMostRepeated_s * how_.scoring.rate_hz;
  if (is_new) first_ = end_ = driving_since_ = tick.number;
  for (; end_ < tick.number; ++end_) {
    std::ranges::copy(RowOf(end_ - 1), RowOf(end_).begin());
    has_sample_[static_cast<std::size_t>(end_ % capacity_)] = false;
  }
  if (is_new || tick.driving != driving_) driving_since_ = end_;
  driving_ = tick.driving;
  const std::span<double> row = RowOf(end_);
  how_.joint_map.ToJoints(values_rad.first(channels_), row.first(joints_));
  std::ranges::copy(values_rad.last(asked), row.subspan(joints_).begin());
  has_sample_[static_cast<std::size_t>(end_ % capacity_)] = tick.has_sample;
  ++end_;
}

void ScoreWindow::TakeMemory() {
  constexpr double kMotion_hz = 0.7;
  std::vector<double> values_rad(RowOf(0).size() - joints_ + channels_);
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

/// A value of the rows from this one on.
Signal ScoreWindow::ValueFrom(Index first, std::size_t value) const {
  const std::size_t width = values_rad_.size() / static_cast<std::size_t>(capacity_);
  Signal values(end_ - begin() - first, 1);
  for (Index row = 0; row < values.rows(); ++row) {
    const auto place = static_cast<std::size_t>((begin() + first + row) % capacity_);
    values(row, 0) = values_rad_[width * place + value];
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

/// Reference of one joint of the hand.
Signal ScoreWindow::Reference(int joint, const CountedTicks& with_samples) const {
  const Index rows = end_ - begin();
  if (how_.simulated_glove) {
    Signal reference_rad(rows, 1);
    reference_rad.setConstant(how_.joint_map.offset_rad(joint));
    for (const auto& term : how_.joint_map.terms(joint)) {
      reference_rad +=
          term.weight *
          how_.simulated_glove->true_angle_rad.col(term.channel).segment(begin(), rows);
    }
    return reference_rad;
  }
  Signal reference_rad = ValueFrom(0, static_cast<std::size_t>(joint));
  for (const TickRange& range : with_samples) {
    Index before = range.begin;
    for (Index row = range.begin + 1; row < range.end; ++row) {
      if (!has_sample_[static_cast<std::size_t>((begin() + row) % capacity_)]) continue;
      JoinRows(before, row, reference_rad);
      before = row;
    }
    SmoothZeroPhase(
        how_.smoothing_hz, how_.scoring.rate_hz,
        {reference_rad.data() + range.begin, static_cast<std::size_t>(range.end - range.begin)});
  }
  return reference_rad;
}

/// Rows that count, of the joint in this place among those that count.
CountedTicks ScoreWindow::Counted(std::size_t place, const CountedTicks& with_samples) const {
  const Index rows = end_ - begin();
  if (how_.simulated_glove) {
    return how_.counted ? Within((*how_.counted)[place], begin(), rows)
                        : CountedTicks{{0, static_cast<int>(rows)}};
  }
  const int recovery = static_cast<int>(how_.recovery_s * how_.scoring.rate_hz);
  CountedTicks counted;
  for (const TickRange& range : with_samples) {
    const int from = range.begin + (&range == &with_samples.front() ? 0 : recovery);
    if (from < range.end) counted.push_back({from, range.end});
  }
  return counted;
}

/// Scores controllers by the rows from `first` on; one that drives by what it drove.
void ScoreWindow::ScoreFrom(Index first, std::span<const std::size_t> controllers,
                            std::vector<RunningScore>& running) const {
  if (controllers.empty()) return;
  const Index rows = end_ - begin() - first;
  const CountedTicks with_samples = WithSamples();
  std::vector<AskingController> asking;
  for (const std::size_t controller : controllers) {
    const std::size_t part = static_cast<int>(controller) == driving_ ? 1 : 2 + controller;
    const auto joint_of = [&, part](std::size_t place) {
      const int joint = how_.scoring.joints[place];
      const Signal reference_rad = Reference(joint, with_samples);
      return AskedAngle{
          .reference_rad = reference_rad.bottomRows(rows),
          .asked_rad = ValueFrom(first, part * joints_ + static_cast<std::size_t>(joint)),
          .counted = Within(Counted(place, with_samples), first, rows)};
    };
    asking.push_back({.joint = joint_of, .earliest_delay_s = how_.earliest_delay_s[controller]});
  }
  const double over_s = static_cast<double>(rows) / how_.scoring.rate_hz;
  const std::vector<TargetScores> scores = ScoreTargets(how_.scoring, asking);
  for (std::size_t i = 0; i < controllers.size(); ++i) {
    running[controllers[i]] = {.over_s = over_s,
                               .jitter_rms_deg = scores[i].jitter_rms_deg,
                               .delay_ms = over_s < kLeastDelay_s ? kNaN : scores[i].delay_ms};
  }
}

std::vector<RunningScore> ScoreWindow::Scores() const {
  std::vector<RunningScore> running(how_.earliest_delay_s.size(), {0.0, kNaN, kNaN});
  if (end_ == first_) return running;
  const Index driven_from = std::max<std::int64_t>(driving_since_ - begin(), 0);
  std::vector<std::size_t> whole, since_switch;
  for (std::size_t i = 0; i < running.size(); ++i) {
    const bool is_short = static_cast<int>(i) == driving_ && driven_from > 0;
    (is_short ? since_switch : whole).push_back(i);
  }
  ScoreFrom(0, whole, running);
  ScoreFrom(driven_from, since_switch, running);
  return running;
}

SessionScores::SessionScores(RunningScoring how, LiveView& view)
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
