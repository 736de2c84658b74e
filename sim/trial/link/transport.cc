#include "sim/trial/link/transport.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

RandomStream Stream(std::uint64_t seed, std::string_view link, std::string_view purpose) {
  return {seed, std::string("link/").append(link).append("/").append(purpose)};
}

/// No frame is on its way for longer [ms].
double LongestWayMs(const TransportConfig& config) {
  const auto* constant = std::get_if<ConstantDelay>(&config.delay.settings);
  return config.batch_ms + (constant == nullptr ? kLongestDelayMs : constant->delay_ms);
}

std::size_t PoolSize(const TransportConfig& config, const LinkEnds& ends,
                     const controller::Timing& timing) {
  const double ticks = ends.fixed_delay_ticks + timing.TicksOf(LongestWayMs(config));
  const double flights = ticks / std::max(1.0, std::floor(ends.period_ticks)) + 3.0;
  return static_cast<std::size_t>(flights) + ends.waiting_frames;
}

}  // namespace

Transport::Transport(const TransportConfig& config, const LinkEnds& ends,
                     const controller::Timing& timing, std::uint64_t seed)
    : config_(config),
      timing_(timing),
      fixed_delay_ticks_(ends.fixed_delay_ticks),
      waiting_frames_(ends.waiting_frames),
      seed_(seed),
      name_(ends.name),
      frame_ticks_(timing.TicksOf(config.frame_ms)),
      batch_ticks_(timing.TicksOf(config.batch_ms)),
      delay_(config.delay, Stream(seed, ends.name, "delay")),
      loss_(config.loss, Stream(seed, ends.name, "loss")),
      pool_(PoolSize(config, ends, timing), ends.values) {
  GAUNTLET_ASSERT(ends.values > 0 && ends.period_ticks > 0.0 && ends.waiting_frames > 0);
  flights_.resize(PoolSize(config, ends, timing));
  waiting_.reserve(waiting_frames_);
  Reset();
}

void Transport::Reset() {
  delay_ = DelayDraw(config_.delay, Stream(seed_, name_, "delay"));
  loss_ = LossDraw(config_.loss, Stream(seed_, name_, "loss"));
  batch_phase_ticks_ = batch_ticks_ * Stream(seed_, name_, "batch phase").Uniform();
  pool_.Reset();
  first_flight_ = flight_count_ = 0;
  waiting_.clear();
  free_tick_ = last_arrival_ = 0.0;
  next_number_ = lost_frames_ = 0;
}

void Transport::Send(std::int64_t tick, std::int64_t origin_tick,
                     std::span<const double> values) noexcept {
  const auto now = static_cast<double>(tick);
  const LinkFrame frame{
      .number = next_number_++, .origin_tick = origin_tick, .stamp_ticks = now, .values = values};
  const bool is_lost = loss_.Next();
  const double delay_ms = delay_.Next();  // of a lost frame, too: the next draws stay theirs
  if (is_lost || delay_ms > kLongestDelayMs) {
    ++lost_frames_;
    return;
  }
  const double delay_ticks = timing_.TicksOf(delay_ms);
  const int place = pool_.Keep(frame);
  if (place < 0) {
    ++lost_frames_;
    return;
  }
  if (frame_ticks_ == 0.0) return Start(now, delay_ticks, place);
  const Waiting added{.sent_tick = now, .delay_ticks = delay_ticks, .place = place};
  StartWaiting(tick);
  if (waiting_.size() < waiting_frames_) {
    waiting_.push_back(added);
  } else if (waiting_frames_ == 1) {
    Lose(waiting_.back().place);
    waiting_.back() = added;
  } else {
    Lose(place);
  }
  StartWaiting(tick);
}

void Transport::Lose(int place) noexcept {
  ++lost_frames_;
  pool_.Release(place);
}

void Transport::StartWaiting(std::int64_t tick) noexcept {
  while (!waiting_.empty() && free_tick_ <= static_cast<double>(tick)) {
    const Waiting next = waiting_.front();
    waiting_.erase(waiting_.begin());
    const double start = std::max(free_tick_, next.sent_tick);
    free_tick_ = start + frame_ticks_;
    Start(start, next.delay_ticks, next.place);
  }
}

void Transport::Start(double start_tick, double delay_ticks, int place) noexcept {
  constexpr double kRounding = 1e-6;
  double arrival = start_tick + delay_ticks;
  if (batch_ticks_ > 0.0) {
    const double intervals = std::ceil((arrival - batch_phase_ticks_) / batch_ticks_ - kRounding);
    arrival = batch_phase_ticks_ + intervals * batch_ticks_;
  }
  arrival = last_arrival_ = std::max(arrival, last_arrival_);
  flights_[(first_flight_ + flight_count_++) % flights_.size()] = {
      .arrival_tick =
          static_cast<std::int64_t>(std::ceil(arrival - kRounding)) + fixed_delay_ticks_,
      .place = place};
}

}  // namespace gauntlet::sim
