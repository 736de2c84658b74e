#include "sim/trial/link/receiver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

constexpr double kTickRounding = 1e-6;
constexpr double kDefaultWindowMs = BufferReceiver{}.window_ms;

double WindowMs(const ReceiverSettings& settings) {
  return std::visit(
      [](const auto& config) {
        if constexpr (requires { config.window_ms; }) return config.window_ms;
        return kDefaultWindowMs;
      },
      settings);
}

/// Longest time for which a frame waits until it is due.
double LongestBufferMs(const ReceiverSettings& settings) {
  if (const auto* fixed = std::get_if<BufferReceiver>(&settings)) return fixed->delay_ms;
  if (const auto* adaptive = std::get_if<AdaptiveBufferReceiver>(&settings)) {
    return adaptive->longest_ms;
  }
  return 0.0;
}

std::size_t MostWaiting(const ReceiverSettings& settings, double period_ticks,
                        const controller::Timing& timing) {
  if (const auto* queue = std::get_if<QueueReceiver>(&settings)) {
    return static_cast<std::size_t>(queue->longest_frames);
  }
  const double frames = timing.TicksOf(LongestBufferMs(settings)) / period_ticks;
  return static_cast<std::size_t>(std::ceil(frames)) + 2;
}

std::size_t HistorySize(const GapConfig& gap, double period_ticks,
                        const controller::Timing& timing) {
  const auto* predict = std::get_if<PredictGap>(&gap.settings);
  if (predict == nullptr) return 0;
  return static_cast<std::size_t>(timing.TicksOf(predict->slope_ms) / period_ticks) + 2;
}

}  // namespace

Receiver::Receiver(const ReceiverConfig& config, int values, double period_ticks,
                   const controller::Timing& timing)
    : settings_(config.settings),
      gap_(config.gap),
      period_ticks_(period_ticks),
      timing_(timing),
      most_waiting_(MostWaiting(config.settings, period_ticks, timing)),
      part_ticks_(std::max(1.0, timing.TicksOf(WindowMs(config.settings)) / kWindowParts)),
      pool_(most_waiting_ + 1, values),
      history_size_(HistorySize(config.gap, period_ticks, timing)),
      history_values_(history_size_ * static_cast<std::size_t>(values)),
      history_stamps_(history_size_),
      slope_(static_cast<std::size_t>(values)),
      used_values_(static_cast<std::size_t>(values)),
      shown_(static_cast<std::size_t>(values)) {
  GAUNTLET_ASSERT(values > 0 && period_ticks > 0.0);
  controller::CheckSettings(config);
  waiting_.reserve(most_waiting_ + 1);
  if (const auto* adaptive = std::get_if<AdaptiveBufferReceiver>(&settings_)) {
    delay_shares_.resize(static_cast<std::size_t>(adaptive->longest_ms) + 1);
    forget_ = std::exp(-period_ticks / timing.TicksOf(adaptive->window_ms));
  }
  Reset();
}

void Receiver::Reset() {
  base_ticks_ = 0.0;
  least_transit_ticks_.fill(std::numeric_limits<double>::infinity());
  part_number_.fill(-1);
  const auto* fixed = std::get_if<BufferReceiver>(&settings_);
  buffer_ticks_ = fixed == nullptr ? 0.0 : timing_.TicksOf(fixed->delay_ms);
  weight_ = 1.0;
  std::ranges::fill(delay_shares_, 0.0);
  pool_.Reset();
  waiting_.clear();
  next_use_tick_ = 0.0;
  remembered_ = 0;
  remembered_number_ = -1;
  slopes_are_known_ = false;
  used_ = {.number = -1};
  used_tick_ = 0;
  has_used_ = false;
  std::ranges::fill(shown_, 0.0);
  arrived_frames_ = late_frames_ = 0;
}

void Receiver::Accept(std::int64_t tick, const LinkFrame& frame) noexcept {
  GAUNTLET_ASSERT(frame.values.size() == shown_.size());
  const double transit_ticks = static_cast<double>(tick) - frame.stamp_ticks;
  Measure(tick, transit_ticks);
  ++arrived_frames_;
  if (transit_ticks - base_ticks_ > buffer_ticks_ + kTickRounding) ++late_frames_;
  AdaptBuffer(transit_ticks - base_ticks_);
  Remember(frame);
  if (is_queue() || frame.number > used_.number) Keep(frame);
}

/// The least transit of the window, in parts that are forgotten one by one.
void Receiver::Measure(std::int64_t tick, double transit_ticks) noexcept {
  const auto number = static_cast<std::int64_t>(static_cast<double>(tick) / part_ticks_);
  const auto part = static_cast<std::size_t>(number) % kWindowParts;
  if (part_number_[part] != number) {
    part_number_[part] = number;
    least_transit_ticks_[part] = transit_ticks;
  }
  least_transit_ticks_[part] = std::min(least_transit_ticks_[part], transit_ticks);
  base_ticks_ = transit_ticks;
  for (std::size_t i = 0; i < kWindowParts; ++i) {
    if (part_number_[i] > number - static_cast<std::int64_t>(kWindowParts)) {
      base_ticks_ = std::min(base_ticks_, least_transit_ticks_[i]);
    }
  }
}

void Receiver::AdaptBuffer(double relative_ticks) noexcept {
  const auto* adaptive = std::get_if<AdaptiveBufferReceiver>(&settings_);
  if (adaptive == nullptr) return;
  const double ticks_per_ms = timing_.TicksOf(1.0);
  const double bucket = std::ceil(relative_ticks / ticks_per_ms - kTickRounding);
  const auto last = static_cast<double>(delay_shares_.size() - 1);
  delay_shares_[static_cast<std::size_t>(std::clamp(bucket, 0.0, last))] += weight_;
  weight_ /= forget_;
  double sum = 0.0;
  for (const double share : delay_shares_) sum += share;
  constexpr double kLargestWeight = 1e100;
  if (weight_ > kLargestWeight) {
    for (double& share : delay_shares_) share /= weight_;
    sum /= weight_;
    weight_ = 1.0;
  }
  double below = 0.0;
  std::size_t quantile = 0;
  for (; quantile + 1 < delay_shares_.size(); ++quantile) {
    below += delay_shares_[quantile];
    if (100.0 * below >= adaptive->quantile_percent * sum) break;
  }
  buffer_ticks_ = ticks_per_ms * static_cast<double>(quantile);
}

void Receiver::Remember(const LinkFrame& frame) noexcept {
  if (history_size_ == 0 || frame.number <= remembered_number_) return;
  const auto place = static_cast<std::size_t>(remembered_) % history_size_;
  std::ranges::copy(frame.values, history_values_.begin() +
                                      static_cast<std::ptrdiff_t>(place * frame.values.size()));
  history_stamps_[place] = frame.stamp_ticks;
  remembered_number_ = frame.number;
  ++remembered_;
  slopes_are_known_ = false;
}

void Receiver::Keep(const LinkFrame& frame) noexcept {
  if (is_queue()) {
    if (waiting_.size() < most_waiting_) waiting_.push_back(pool_.Keep(frame));
    return;
  }
  auto after = waiting_.end();
  while (after != waiting_.begin() && pool_.At(*(after - 1)).number > frame.number) --after;
  // Copies would push out frames that are not due yet.
  if (after != waiting_.begin() && pool_.At(*(after - 1)).number == frame.number) return;
  waiting_.insert(after, pool_.Keep(frame));
  if (waiting_.size() > most_waiting_) DropFirst(1);
}

void Receiver::DropFirst(std::size_t count) noexcept {
  const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(count);
  for (auto place = waiting_.begin(); place != end; ++place) pool_.Release(*place);
  waiting_.erase(waiting_.begin(), end);
}

/// Uses the frame whose time has come; false if there is none.
bool Receiver::UseDue(std::int64_t tick) noexcept {
  const auto now = static_cast<double>(tick) + kTickRounding;
  if (is_queue()) {
    if (waiting_.empty() || next_use_tick_ > now) return false;
    Use(tick, waiting_.front());
    DropFirst(1);
    if (next_use_tick_ <= now - period_ticks_) next_use_tick_ = static_cast<double>(tick);
    next_use_tick_ += period_ticks_;
    return true;
  }
  // Without a buffer what has arrived is due; the base may rise afterwards.
  const bool all = buffer_ticks_ == 0.0;
  std::size_t due = waiting_.size();
  while (due > 0 && !all &&
         pool_.At(waiting_[due - 1]).stamp_ticks + base_ticks_ + buffer_ticks_ > now) {
    --due;
  }
  if (due == 0) return false;
  Use(tick, waiting_[due - 1]);
  DropFirst(due);
  return true;
}

void Receiver::Use(std::int64_t tick, int place) noexcept {
  used_ = pool_.At(place);
  std::ranges::copy(used_.values, used_values_.begin());
  used_.values = used_values_;
  used_tick_ = tick;
  has_used_ = true;
}

/// Since when the frame after the one that is used is overdue, in whole periods.
double Receiver::OverdueTicks(std::int64_t tick) const noexcept {
  const auto now = static_cast<double>(tick);
  const double due = is_queue() ? static_cast<double>(used_tick_)
                                : used_.stamp_ticks + base_ticks_ + buffer_ticks_;
  return std::max(0.0, std::floor((now - due) / period_ticks_ + kTickRounding)) * period_ticks_;
}

Receiver::Found Receiver::Step(std::int64_t tick) noexcept {
  const bool is_new = UseDue(tick);
  if (!has_used_) return Found::kNothing;
  if (is_new) std::ranges::copy(used_values_, shown_.begin());
  const auto* predict = std::get_if<PredictGap>(&gap_.settings);
  const double overdue_ticks = predict == nullptr ? 0.0 : OverdueTicks(tick);
  if (overdue_ticks > 0.0) {
    FindSlopes();
    const double ahead = std::min(overdue_ticks, timing_.TicksOf(predict->longest_ms));
    for (std::size_t i = 0; i < shown_.size(); ++i) {
      shown_[i] = used_values_[i] + ahead * slope_[i];
    }
  }
  if (is_new) return Found::kNew;
  return overdue_ticks > 0.0 ? Found::kPredicted : Found::kHeld;
}

/// Least-squares slopes over the frames of the last slope_ms.
void Receiver::FindSlopes() noexcept {
  if (slopes_are_known_) return;
  slopes_are_known_ = true;
  std::ranges::fill(slope_, 0.0);
  const auto kept = std::min<std::size_t>(static_cast<std::size_t>(remembered_), history_size_);
  const auto place = [this](std::size_t back) {
    return (static_cast<std::size_t>(remembered_) - 1 - back) % history_size_;
  };
  const double slope_ticks = timing_.TicksOf(std::get<PredictGap>(gap_.settings).slope_ms);
  const double newest = history_stamps_[place(0)];
  std::size_t count = 0;
  double mean_stamp = 0.0;
  while (count < kept && newest - history_stamps_[place(count)] <= slope_ticks + kTickRounding) {
    mean_stamp += history_stamps_[place(count++)] - newest;
  }
  if (count < 2) return;
  mean_stamp /= static_cast<double>(count);
  double squares = 0.0;
  for (std::size_t back = 0; back < count; ++back) {
    const double off = history_stamps_[place(back)] - newest - mean_stamp;
    squares += off * off;
    const double* const row = &history_values_[place(back) * slope_.size()];
    for (std::size_t i = 0; i < slope_.size(); ++i) slope_[i] += off * row[i];
  }
  for (double& slope : slope_) slope /= squares;
}

}  // namespace gauntlet::sim
