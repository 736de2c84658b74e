#include "sim/live/device_glove.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/live/device/device_clock.h"
#include "sim/live/session_threads.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kFrames = 1024;
constexpr std::size_t kTimes = 4096;

}  // namespace

DeviceGlove::DeviceGlove(const LiveSetup& setup)
    : setup_(setup),
      timing_(setup.trial.hand->timing().controller),
      source_(setup.source->Description()),
      frames_(kFrames, setup.trial.calibration.channel_names.size()),
      first_counts_(frames_.width(), controller::kNaN),
      times_(kTimes),
      grid_(timing_.ticks_per_sample),
      channels_(setup.channels) {}

/// A sender of packets repeats the names of its columns once a second: until then a listener that
/// began later does not know what they are.
bool DeviceGlove::MayGetNames(std::int64_t arrival_ns) {
  constexpr std::int64_t kPatience_ns = 1'200'000'000;
  if (!setup_.names_may_follow || !setup_.source->columns().names.empty()) return false;
  if (first_arrival_ns_ == 0) first_arrival_ns_ = arrival_ns;
  return arrival_ns - first_arrival_ns_ < kPatience_ns;
}

void DeviceGlove::Read(const std::stop_token& stop) {
  RaisePriority(kInputPriority);
  constexpr auto kLook = std::chrono::milliseconds(20);
  const auto take = [&](const DeviceFrame& frame) {
    if (MayGetNames(frame.arrival_ns)) return;
    const FrameArrivals::Numbered numbered = arrivals_.Add(frame);
    const std::span<const double> counts =
        channels_.Counts(setup_.source->columns(), numbered.stamp_s, frame.values);
    const bool is_taken = frames_.Push({.number = numbered.number,
                                        .stamp_s = numbered.stamp_s,
                                        .arrival_ns = frame.arrival_ns,
                                        .decoded_ns = MonotonicNow_ns()},
                                       counts);
    if (!is_taken) ++overruns_;
  };
  try {
    while (!stop.stop_requested() &&
           setup_.source->Wait(kLook, take) != FrameSource::State::kEnded) {
    }
  } catch (...) {
    error_ = std::current_exception();
  }
  has_ended_.store(true, std::memory_order_release);
}

bool DeviceGlove::WaitForFirst() {
  thread_ = StartThread([this](const std::stop_token& stop) { Read(stop); });
  if (setup_.say) setup_.say("waiting for frames from " + source_);
  std::int64_t said_ns = MonotonicNow_ns();
  while (!has_first_) {
    const bool has_ended = has_ended_.load(std::memory_order_acquire);
    has_first_ = frames_.Pop([&](const Head& head, std::span<const double> counts) {
      first_ = head;
      std::ranges::copy(counts, first_counts_.begin());
    });
    if (has_first_) break;
    if (has_ended || StopAsked()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    constexpr std::int64_t kPatience_ns = 5 * kNanosecondsPerSecond;
    if (setup_.say && said_ns != 0 && MonotonicNow_ns() - said_ns > kPatience_ns) {
      setup_.say("no frame yet from " + source_);
      said_ns = 0;
    }
  }
  return true;
}

std::vector<double> DeviceGlove::FirstAngles_rad() const {
  const controller::GloveCalibration& glove = setup_.trial.calibration;
  std::vector<double> angles_rad;
  for (std::size_t c = 0; c < first_counts_.size(); ++c) {
    const double share =
        (first_counts_[c] - glove.low_counts[c]) / (glove.high_counts[c] - glove.low_counts[c]);
    angles_rad.push_back(glove.low_angle_rad[c] +
                         (std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0) *
                             (glove.high_angle_rad[c] - glove.low_angle_rad[c]));
  }
  return angles_rad;
}

/// Its frames arrive a little before ticks.
std::int64_t DeviceGlove::StartTime_ns(std::int64_t soon_ns) const {
  constexpr double kMost_ns = 2e6;
  const double period_ns = 1e9 / timing_.sample_rate_hz();
  const double first_ns =
      static_cast<double>(first_.arrival_ns) + std::min(0.25 * period_ns, kMost_ns);
  const double periods = std::ceil((static_cast<double>(soon_ns) - first_ns) / period_ns);
  return std::llround(first_ns + periods * period_ns);
}

bool DeviceGlove::HasEnded(std::int64_t /*tick*/) const noexcept {
  return has_ended_.load(std::memory_order_acquire) && frames_.waiting() == 0;
}

std::span<const std::int32_t> DeviceGlove::Step(const LiveTick& tick, HandLoop& loop) noexcept {
  most_waiting_ = std::max(most_waiting_, waiting_frames());
  if (has_first_) AcceptFrame(first_, first_counts_, tick, loop);
  has_first_ = false;
  while (frames_.Pop([&](const Head& head, std::span<const double> counts) {
    AcceptFrame(head, counts, tick, loop);
  })) {
  }
  step_begin_ns_ = MonotonicNow_ns();
  return loop.StepController();
}

void DeviceGlove::AcceptFrame(const Head& head, std::span<const double> counts,
                              const LiveTick& tick, HandLoop& loop) noexcept {
  SampleTimes& times = times_[static_cast<std::size_t>(head.number) % times_.size()];
  if (times.number != head.number) {
    times = {.number = head.number,
             .arrival_ns = head.arrival_ns,
             .decoded_ns = head.decoded_ns,
             .taken_ns = MonotonicNow_ns()};
  }
  loop.AcceptGloveFrame({.number = head.number,
                         .origin_tick = loop.tick(),
                         .stamp_ticks = head.stamp_s * timing_.tick_rate_hz,
                         .values = counts});
  if (head.number <= logged_number_) return;
  logged_number_ = head.number;
  if (tick.log != nullptr) {
    const std::int64_t since_start_ns = head.arrival_ns - tick.wake.NominalOf_ns(0);
    tick.log->AddSample(1e-9 * static_cast<double>(since_start_ns), counts);
  }
  if (timing_.ticks_per_sample > 1) FollowGlove(loop);
}

void DeviceGlove::FollowGlove(HandLoop& loop) noexcept {
  const std::int64_t period = timing_.ticks_per_sample;
  const std::int64_t since = ((loop.tick() - grid_phase_) % period + period) % period;
  const int shift = grid_.Step(since == 0 ? 0 : period - since);
  loop.ShiftSamples(shift);
  grid_phase_ += shift;
  grid_shifts_ += std::abs(shift);
}

std::optional<SampleTimes> DeviceGlove::TimesOf(const LiveTick& /*tick*/, const HandLoop& loop,
                                                std::int64_t before) const noexcept {
  GAUNTLET_ASSERT(loop.glove_receiver() != nullptr);
  const std::int64_t number = loop.glove_receiver()->number();
  if (number < 0 || number == before) return std::nullopt;
  SampleTimes times = times_[static_cast<std::size_t>(number) % times_.size()];
  if (times.number != number) return std::nullopt;
  times.used_ns = std::max(times.taken_ns, step_begin_ns_);
  return times;
}

void DeviceGlove::End(LiveResult& result) {
  thread_.request_stop();
  thread_.join();
  if (error_) std::rethrow_exception(error_);
  if (first_.arrival_ns == 0) {
    ThrowIfStopped();
    throw UserError(
        {.place = setup_.channels.source, .problem = setup_.source->AdviceWithoutFrames()});
  }
  LiveFacts& facts = result.facts;
  facts.arrivals = arrivals_.Facts();
  facts.source = setup_.source->counts();
  facts.input_overruns = overruns_;
  facts.most_waiting = most_waiting_;
  facts.grid_shifts = grid_shifts_;
  result.columns_remark = channels_.remark();
}

}  // namespace gauntlet::sim
