#include "sim/live/live_glove.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <limits>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/live/device/device_clock.h"
#include "sim/live/frame_arrivals.h"
#include "sim/live/frame_channels.h"
#include "sim/live/row_ring.h"
#include "sim/live/session_threads.h"

namespace gauntlet::sim {
namespace {

/// A simulated glove, whose samples are captured at the nominal times of the ticks.
class SimulatedGlove final : public LiveGlove {
 public:
  explicit SimulatedGlove(const LiveSetup& setup);

  bool WaitForFirst() override { return true; }
  std::vector<double> FirstAngles_rad() const override;
  std::int64_t StartTime_ns(std::int64_t soon_ns) const override { return soon_ns; }
  bool HasEnded(std::int64_t tick) const noexcept override;

 private:
  std::span<const std::int32_t> Step(const LiveTick& tick, HandLoop& loop) noexcept override;
  std::optional<SampleTimes> TimesOf(const LiveTick& tick, const HandLoop& loop,
                                     std::int64_t before) const noexcept override;

  const TrialSetup& trial_;
  std::shared_ptr<const GloveSignal> glove_;
  std::vector<double> counts_;
  Eigen::Index recorded_ = 0;  // samples
};

SimulatedGlove::SimulatedGlove(const LiveSetup& setup)
    : trial_(setup.trial),
      glove_(setup.simulated_glove),
      counts_(static_cast<std::size_t>(glove_->counts.cols())) {}

std::vector<double> SimulatedGlove::FirstAngles_rad() const {
  const Signal angle_rad = FirstAngles(trial_, *glove_);
  return {angle_rad.data(), angle_rad.data() + angle_rad.size()};
}

bool SimulatedGlove::HasEnded(std::int64_t tick) const noexcept {
  return tick >= glove_->true_angle_rad.rows();
}

std::span<const std::int32_t> SimulatedGlove::Step(const LiveTick& now, HandLoop& loop) noexcept {
  const std::int64_t tick = loop.tick();
  if (HasEnded(tick) || tick % glove_->ticks_per_sample != 0) return loop.StepController();
  // Skipped ticks may have had samples, too.
  const Eigen::Index sample = tick / glove_->ticks_per_sample;
  for (; recorded_ <= sample; ++recorded_) {
    for (std::size_t c = 0; c < counts_.size(); ++c) {
      counts_[c] = glove_->counts(recorded_, static_cast<Eigen::Index>(c));
    }
    if (now.log != nullptr) {
      now.log->AddSample(static_cast<double>(recorded_) / glove_->rate_hz, counts_);
    }
  }
  return loop.StepController({.counts = counts_});
}

std::optional<SampleTimes> SimulatedGlove::TimesOf(const LiveTick& tick, const HandLoop& loop,
                                                   std::int64_t before) const noexcept {
  const std::int64_t captured = loop.sample_tick();
  if (loop.taken_counts().empty() || captured == before) return std::nullopt;
  const std::int64_t capture_ns = tick.wake.NominalOf_ns(captured);
  return SampleTimes{.number = captured,
                     .arrival_ns = capture_ns,
                     .decoded_ns = capture_ns,
                     .taken_ns = loop.glove_receiver() == nullptr ? tick.woken_ns : capture_ns,
                     .used_ns = tick.woken_ns};
}

/// Lets the grid of samples follow a real glove so that `kInTime` of the frames arrive before the
/// tick that uses them: the Robbins-Monro search of a quantile.
class GridFollower {
 public:
  explicit GridFollower(int ticks_per_sample) : period_(ticks_per_sample) {}

  /// A frame arrived `wait_ticks` before the next sample, 0 to the period - 1. Returns by how much
  /// the grid is to be shifted.
  int Step(std::int64_t wait_ticks) noexcept {
    constexpr double kInTime = 0.95;
    constexpr int kCoarse = 4;
    if (period_ < kCoarse) return 0;
    if (wait_ticks == 0) return 0;
    const bool is_late = 2 * wait_ticks > period_;
    phase_ += is_late ? kInTime : kInTime - 1.0;
    const int shift = phase_ >= 1.0 ? 1 : phase_ <= -1.0 ? -1 : 0;
    phase_ -= shift;
    return shift;
  }

 private:
  int period_;
  double phase_ = 0.0;
};

/// A real glove: its frames are read by a thread of their own, and wait in a ring for the control
/// thread. The receiver of `link.glove` decides which of them is a sample.
class DeviceGlove final : public LiveGlove {
 public:
  /// `setup` has a source, and lives longer.
  explicit DeviceGlove(const LiveSetup& setup);

  bool WaitForFirst() override;
  std::vector<double> FirstAngles_rad() const override;
  std::int64_t StartTime_ns(std::int64_t soon_ns) const override;
  bool HasEnded(std::int64_t tick) const noexcept override;
  std::int64_t waiting_frames() const noexcept override {
    return static_cast<std::int64_t>(frames_.waiting());
  }
  void End(LiveResult& result) override;

 private:
  /// A frame; its values are counts of the channels.
  struct Head {
    std::int64_t number = 0;
    double stamp_s = 0.0;
    std::int64_t arrival_ns = 0;
    std::int64_t decoded_ns = 0;
  };

  std::span<const std::int32_t> Step(const LiveTick& tick, HandLoop& loop) noexcept override;
  std::optional<SampleTimes> TimesOf(const LiveTick& tick, const HandLoop& loop,
                                     std::int64_t before) const noexcept override;
  int TakeFirst() noexcept;
  void SetFirst(const Head& head, std::span<const double> counts) noexcept;
  void AcceptFrame(const Head& head, std::span<const double> counts, const LiveTick& tick,
                   HandLoop& loop) noexcept;
  void FollowGlove(HandLoop& loop) noexcept;
  void Read(const std::stop_token& stop);
  bool MayGetNames(const DeviceFrame& frame);

  const LiveSetup& setup_;
  const controller::Timing& timing_;
  std::string source_;
  RowRing<Head> frames_;
  std::atomic<bool> has_ended_ = false;
  std::atomic<bool> has_begun_ = false;  // what came before had waited, and is not counted

  // The control thread has these.
  Head first_;
  std::vector<double> first_counts_;
  bool has_first_ = false;          // waits for the first tick, outside the ring
  bool is_silent_ = false;          // for as long as the session may last
  std::vector<SampleTimes> times_;  // of the last frames, by number
  std::int64_t step_begin_ns_ = 0;
  std::int64_t logged_number_ = -1;
  GridFollower grid_;
  std::int64_t grid_phase_ = 0;  // ticks by which the sampling grid was shifted
  std::int64_t grid_shifts_ = 0;
  std::int64_t most_waiting_ = 0;

  // The thread that reads has these.
  FrameChannels channels_;
  FrameArrivals arrivals_;
  bool rate_has_begun_ = false;
  std::int64_t first_arrival_ns_ = 0;
  std::int64_t overruns_ = 0;
  std::exception_ptr error_;  // before has_ended_
  std::jthread thread_;       // last: it ends before what it uses
};

constexpr std::size_t kFrames = 1024;
constexpr std::size_t kTimes = 4096;

DeviceGlove::DeviceGlove(const LiveSetup& setup)
    : setup_(setup),
      timing_(setup.trial.hand->timing().controller),
      source_(setup.source->Description()),
      frames_(kFrames, setup.trial.calibration.channel_names.size()),
      first_counts_(frames_.width(), controller::kNaN),
      times_(kTimes),
      grid_(timing_.ticks_per_sample),
      channels_(setup.channels) {}

/// A sender that repeats the names of its columns does so once a second: until then a listener that
/// began later does not know what they are. Over a serial line few do, and a frame with a value for
/// each channel needs none.
bool DeviceGlove::MayGetNames(const DeviceFrame& frame) {
  constexpr std::int64_t kPatience_ns = 1'200'000'000;
  if (!setup_.names_may_follow || !setup_.source->columns().names.empty()) return false;
  const bool is_serial = setup_.source->address().kind == DeviceKind::kSerial;
  if (is_serial && frame.values.size() == frames_.width()) return false;
  if (first_arrival_ns_ == 0) first_arrival_ns_ = frame.arrival_ns;
  return frame.arrival_ns - first_arrival_ns_ < kPatience_ns;
}

void DeviceGlove::Read(const std::stop_token& stop) {
  RaisePriority(kInputPriority);
  constexpr auto kLook = std::chrono::milliseconds(20);
  constexpr std::int64_t kPatience_ns = 3 * kNanosecondsPerSecond;
  std::int64_t patience_end_ns = MonotonicNow_ns() + kPatience_ns;
  constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();
  const auto take = [&](const DeviceFrame& frame) {
    patience_end_ns = kNever_ns;
    if (MayGetNames(frame)) return;
    if (!rate_has_begun_ && has_begun_.load(std::memory_order_relaxed)) {
      rate_has_begun_ = true;
      arrivals_.BeginRate();
    }
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
      if (MonotonicNow_ns() < patience_end_ns) continue;
      patience_end_ns = kNever_ns;
      if (!setup_.say) continue;
      setup_.say(
          fmt::format("no frame yet from {}; {}", source_, setup_.source->AdviceWithoutFrames()));
    }
  } catch (...) {
    error_ = std::current_exception();
  }
  has_ended_.store(true, std::memory_order_release);
}

void DeviceGlove::SetFirst(const Head& head, std::span<const double> counts) noexcept {
  first_ = head;
  std::ranges::copy(counts, first_counts_.begin());
  has_first_ = true;
}

/// Takes the newest frame for the first: others in the queue are of the past. A file begins when it
/// is played. Returns how many frames it took.
int DeviceGlove::TakeFirst() noexcept {
  const bool has_past = setup_.source->address().kind != DeviceKind::kFile;
  int taken = 0;
  while ((has_past || !has_first_) &&
         frames_.Pop(
             [&](const Head& head, std::span<const double> counts) { SetFirst(head, counts); })) {
    ++taken;
  }
  return taken;
}

bool DeviceGlove::WaitForFirst() {
  thread_ = StartThread([this](const std::stop_token& stop) { Read(stop); });
  if (setup_.say) setup_.say("waiting for frames from " + source_);
  const std::int64_t begin_ns = MonotonicNow_ns();
  const auto end_ns = setup_.seconds > 0.0
                          ? begin_ns + static_cast<std::int64_t>(1e9 * setup_.seconds)
                          : std::numeric_limits<std::int64_t>::max();
  constexpr auto kLook = std::chrono::milliseconds(2);
  while (true) {
    const bool has_ended = has_ended_.load(std::memory_order_acquire);
    if (TakeFirst() > 0) break;
    is_silent_ = MonotonicNow_ns() >= end_ns;
    if (has_ended || StopAsked() || is_silent_) return false;
    std::this_thread::sleep_for(kLook);
  }
  // A queue is read faster than any glove sends.
  constexpr int kMostPerLook = 8;
  constexpr int kMostLooks = 50;
  for (int look = 0; look < kMostLooks; ++look) {
    std::this_thread::sleep_for(kLook);
    if (TakeFirst() <= kMostPerLook) break;
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
  const bool has_past = setup_.source->address().kind != DeviceKind::kFile;
  if (has_first_) has_begun_.store(has_past, std::memory_order_relaxed);
  const auto accept_first = [&] {
    if (has_first_) AcceptFrame(first_, first_counts_, tick, loop);
    has_first_ = false;
  };
  while (frames_.Pop([&](const Head& head, std::span<const double> counts) {
    // The recording begins at the start, with what the glove said last before it. What came since,
    // as the first tick may be late, are samples like all others.
    if (has_first_ && has_past && head.arrival_ns <= tick.wake.NominalOf_ns(0)) {
      SetFirst(head, counts);
      return;
    }
    accept_first();
    AcceptFrame(head, counts, tick, loop);
  })) {
  }
  accept_first();
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
    if (is_silent_) {
      throw RunError(fmt::format("no frame from {} within {:g} s; {}", source_, setup_.seconds,
                                 setup_.source->AdviceWithoutFrames()));
    }
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

}  // namespace

std::span<const std::int32_t> LiveGlove::StepController(const LiveTick& tick,
                                                        HandLoop& loop) noexcept {
  const std::span<const std::int32_t> frame = Step(tick, loop);
  if (const auto times = TimesOf(tick, loop, sample_.number)) {
    sample_ = *times;
    sample_.filtered_ns = MonotonicNow_ns();
  }
  return frame;
}

std::unique_ptr<LiveGlove> MakeLiveGlove(const LiveSetup& setup) {
  if (setup.simulated_glove) return std::make_unique<SimulatedGlove>(setup);
  return std::make_unique<DeviceGlove>(setup);
}

}  // namespace gauntlet::sim
