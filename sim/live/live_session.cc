#include "sim/live/live_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <optional>
#include <thread>
#include <utility>

#include "controller/assert.h"
#include "controller/controller.h"
#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/device/device_clock.h"
#include "sim/live/controller_switch.h"
#include "sim/live/grid_follower.h"
#include "sim/live/row_ring.h"
#include "sim/live/session_threads.h"
#include "sim/live/stage_clock.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/trace_recorder.h"

namespace gauntlet::sim {
namespace {

constexpr int kControlPriority = 80;
constexpr int kOutputPriority = 79;
constexpr int kInputPriority = 78;
constexpr auto kLook = std::chrono::milliseconds(20);  // of threads that wait for something
constexpr std::size_t kInputRows = 1024;
constexpr std::size_t kOutputRows = 64;
constexpr std::size_t kLogRows = 8192;
constexpr int kTraceBlocks = 128;

/// A frame on its way to the control thread; its values are counts of the channels.
struct InputHead {
  std::int64_t number = 0;
  double stamp_s = 0.0;
  std::int64_t arrival_ns = 0;
  std::int64_t decoded_ns = 0;
};

/// Speed limits of the motors at begin and end, and while their sink is gone: those of the hand's
/// own watchdog, if it has one.
WatchdogConfig RestOf(const LinksConfig& links) {
  TieredWatchdog tiers;
  if (links.hand) {
    if (const auto* own = std::get_if<TieredWatchdog>(&links.hand->watchdog.settings)) tiers = *own;
  }
  constexpr double kHold_ms = 50.0;
  constexpr double kRelax_ms = 100.0;
  constexpr double kNever_ms = 100'000.0;
  tiers.hold_after_ms = kHold_ms;
  tiers.relax_after_ms = kRelax_ms;
  tiers.off_after_ms = kNever_ms;
  return {.settings = tiers};
}

std::vector<controller::ControllerConfig> ControllersOf(std::span<const ShadowSetup> shadows) {
  std::vector<controller::ControllerConfig> configs;
  for (const ShadowSetup& shadow : shadows) configs.push_back(shadow.controller);
  return configs;
}

class Session {
 public:
  explicit Session(const LiveSetup& setup);

  LiveResult Run();

 private:
  // Each is the work of a thread.
  void Input();
  void Control();
  void Output();
  void Log();

  bool MayGetNames(std::int64_t arrival_ns);
  bool WaitForGlove(const std::string& source);
  void ResetToFirstSample();
  std::int64_t StartTime() const;
  void StartMotorsFromRest();
  void TakeFrames() noexcept;
  bool StepGlove(std::span<const std::int32_t>& frame) noexcept;
  void NoteSample() noexcept;
  void SendCommand(std::span<const std::int32_t> frame) noexcept;
  std::span<const std::int32_t> AtRestOr(std::span<const std::int32_t> frame) noexcept;
  void StepShadows() noexcept;
  void Skip(std::int64_t ticks) noexcept;
  void WatchTiers() noexcept;
  void SwitchIfAsked() noexcept;
  void MarkIfAsked() noexcept;
  void KeepStill();
  double Time_s() const noexcept {
    return static_cast<double>(loop_.tick()) / timing_.tick_rate_hz;
  }
  void ShowMoment(std::int64_t lateness_ns) noexcept;
  bool IsTraced() const noexcept { return !is_ending_ && result_.facts.switch_count == 0; }
  void Tick(const PeriodicWake::Woken& woken) noexcept;
  bool IsDone() noexcept;
  void BeginEnd(LiveEnd end) noexcept;
  void MoveLog();
  void RunLoop();
  void Gather();

  RowRing<InputHead> input_;
  RowRing<OutputHead> output_;
  RowRing<double> samples_;        // to the log: time [s] and counts
  RowRing<std::int64_t> targets_;  // to the log: tick; shadows x joints

  const LiveSetup& setup_;
  const controller::Timing& timing_;
  HandLoop loop_;
  Watchdog rest_;
  std::vector<controller::Controller> shadows_;
  ControllerSwitch switch_;
  FrameChannels channels_;

  std::atomic<std::uint32_t> output_calls_ = 0;
  int rest_frames_ = 0;  // this and the next six: of the control thread
  bool has_motors_;
  bool has_wanted_ = false;
  bool has_sent_ = false;
  bool is_ending_ = false;
  bool was_resting_ = false;
  Watchdog::Tier tier_ = Watchdog::Tier::kFollow;
  std::atomic<bool> ends_ = false;  // all threads are to end
  std::atomic<bool> stop_asked_ = false;
  std::atomic<bool> input_ended_ = false;
  std::atomic<bool> sink_is_gone_ = false;
  std::atomic<bool> has_started_ = false;  // the control thread, with its priority
  std::atomic<bool> control_ended_ = false;
  std::exception_ptr input_error_;  // before input_ended_

  LiveResult result_;
  std::optional<TraceRecorder> recorder_;
  StageClock clock_;        // of the output thread; without motors, of the control thread
  FrameArrivals arrivals_;  // of the input thread, with the next
  std::int64_t first_arrival_ns_ = 0;
  GridFollower grid_;
  std::optional<PeriodicWake> wake_;

  std::vector<double> logged_targets_;  // of the log thread
  std::size_t most_targets_ = 0;

  // Of the control thread.
  std::int64_t start_ns_ = 0;
  std::vector<SampleTimes> times_;  // of the last frames, by number
  SampleTimes sample_;              // that the controller has
  InputHead first_head_;
  std::vector<double> first_counts_;
  std::vector<double> glove_counts_;
  std::vector<std::int32_t> wanted_;  // last frame of the loop
  std::vector<std::int32_t> sent_;
  std::vector<double> sent_values_;
  std::vector<double> targets_row_;
  std::int64_t end_tick_ = 0;
  std::int64_t sent_tick_ = 0;
  std::int64_t command_number_ = 0;
  std::int64_t last_sample_number_ = -1;
  std::int64_t logged_number_ = -1;
  std::int64_t grid_phase_ = 0;  // ticks by which the sampling grid was shifted
  std::int64_t woken_ns_ = 0;
  std::int64_t step_begin_ns_ = 0;
  std::int64_t tier_ticks_ = 0;
  std::vector<double> hand_rad_;
  bool is_still_ = false;
  std::int64_t ticks_to_show_ = 0;
  std::int64_t largest_lateness_ns_ = 0;  // since the moment that was shown last
};

Session::Session(const LiveSetup& setup)
    : input_(kInputRows, setup.trial.calibration.channel_names.size()),
      output_(kOutputRows, setup.trial.hand->transmission().motor_names.size()),
      samples_(kLogRows, input_.width()),
      targets_(kLogRows, setup.shadows.size() * setup.trial.hand->joint_names().size()),
      setup_(setup),
      timing_(setup.trial.hand->timing().controller),
      loop_(setup.trial.controller, setup.trial.calibration, setup.trial.joint_map,
            setup.trial.hand, setup.trial.links),
      rest_(RestOf(setup.trial.links.config), setup.trial.hand->transmission(), timing_),
      switch_(loop_, ControllersOf(setup.shadows)),
      channels_(setup.channels),
      has_motors_(setup.sink != nullptr),
      clock_(setup.view),
      grid_(timing_.ticks_per_sample),
      times_(4096),
      first_counts_(input_.width(), controller::kNaN),
      glove_counts_(input_.width()),
      wanted_(output_.width()),
      sent_(output_.width()),
      sent_values_(output_.width()),
      targets_row_(targets_.width()),
      hand_rad_(setup.trial.hand->joint_names().size()) {
  for (const ShadowSetup& shadow : setup.shadows) {
    shadows_.emplace_back(shadow.controller, setup.trial.calibration,
                          setup.trial.hand->transmission(), timing_, setup.trial.joint_map);
  }
  result_.shadows.resize(shadows_.size());
  result_.facts.switches.reserve(kMostSwitches);
  result_.facts.still.reserve(kMostSwitches);
}

/// A sender of packets repeats the names of its columns once a second: until then a listener that
/// began later does not know what they are.
bool Session::MayGetNames(std::int64_t arrival_ns) {
  constexpr std::int64_t kPatience_ns = 1'200'000'000;
  if (!setup_.names_may_follow || !setup_.source->columns().names.empty()) return false;
  if (first_arrival_ns_ == 0) first_arrival_ns_ = arrival_ns;
  return arrival_ns - first_arrival_ns_ < kPatience_ns;
}

/// The frames that arrive, until the session ends.
void Session::Input() {
  RaisePriority(kInputPriority);
  try {
    while (!ends_.load(std::memory_order_relaxed)) {
      const FrameSource::State state = setup_.source->Wait(kLook, [&](const DeviceFrame& frame) {
        if (MayGetNames(frame.arrival_ns)) return;
        const FrameArrivals::Numbered numbered = arrivals_.Take(frame);
        const std::span<const double> counts =
            channels_.Counts(setup_.source->columns(), frame.values);
        const bool is_taken = input_.Push({.number = numbered.number,
                                           .stamp_s = numbered.stamp_s,
                                           .arrival_ns = frame.arrival_ns,
                                           .decoded_ns = MonotonicNow_ns()},
                                          counts);
        if (!is_taken) ++result_.facts.input_overruns;
      });
      if (state == FrameSource::State::kEnded) break;
    }
  } catch (...) {
    input_error_ = std::current_exception();
  }
  input_ended_.store(true, std::memory_order_release);
}

/// False if the session is to end before there is a frame. The source is the input thread's by now:
/// `source` describes it.
bool Session::WaitForGlove(const std::string& source) {
  if (setup_.simulated_glove) return true;
  if (setup_.say) setup_.say("waiting for frames from " + source);
  std::int64_t said_ns = MonotonicNow_ns();
  for (;;) {
    const bool has_ended = input_ended_.load(std::memory_order_acquire);
    if (input_.waiting() > 0) break;
    if (has_ended || StopAsked()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    constexpr std::int64_t kPatience_ns = 5 * kNanosecondsPerSecond;
    if (setup_.say && said_ns != 0 && MonotonicNow_ns() - said_ns > kPatience_ns) {
      setup_.say("no frame yet from " + source);
      said_ns = 0;
    }
  }
  input_.Pop([&](const InputHead& head, std::span<const double> counts) {
    first_head_ = head;
    std::ranges::copy(counts, first_counts_.begin());
  });
  return true;
}

/// A simulated hand begins in the posture that the first sample asks for, as a trial does; real
/// motors at rest.
void Session::ResetToFirstSample() {
  const controller::GloveCalibration& glove = setup_.trial.calibration;
  const controller::TendonTransmission& hand = setup_.trial.hand->transmission();
  std::vector<double> posture_rad(hand.reference_angle_rad);
  if (!has_motors_) {
    Signal angle_rad(1, std::ssize(glove.channel_names));
    for (std::size_t c = 0; c < glove.channel_names.size(); ++c) {
      const auto column = static_cast<Eigen::Index>(c);
      if (setup_.simulated_glove) {
        angle_rad(0, column) = setup_.simulated_glove->true_angle_rad(0, column);
        continue;
      }
      const double share =
          (first_counts_[c] - glove.low_counts[c]) / (glove.high_counts[c] - glove.low_counts[c]);
      angle_rad(0, column) =
          glove.low_angle_rad[c] + (std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0) *
                                       (glove.high_angle_rad[c] - glove.low_angle_rad[c]);
    }
    const controller::JointMap joint_map(setup_.trial.joint_map, glove.channel_names, hand);
    const Signal start_rad = JointAngles(joint_map, angle_rad).transpose();
    posture_rad.assign(start_rad.data(), start_rad.data() + start_rad.size());
  }
  loop_.Reset(posture_rad);
  auto target = targets_row_.begin();  // what a tick has that is skipped before the first one
  for (controller::Controller& shadow : shadows_) {
    shadow.Reset(loop_.hand().command());
    target = std::ranges::copy(shadow.target_angle_rad(), target).out;
  }
  std::ranges::copy(loop_.hand().command(), wanted_.begin());
  std::ranges::copy(loop_.hand().command(), sent_.begin());
  rest_.Reset(sent_);
  if (has_motors_) StartMotorsFromRest();
}

/// As after a gap: they follow the first frames at a limited speed.
void Session::StartMotorsFromRest() {
  rest_.Watch(true);
  while (rest_.tier() == Watchdog::Tier::kFollow) rest_.Watch(false);
  rest_.Command(wanted_);
}

/// A real glove's frames arrive a little before ticks.
std::int64_t Session::StartTime() const {
  constexpr std::int64_t kSoon_ns = 2'000'000;
  constexpr double kMost_ns = 2e6;
  const std::int64_t soon_ns = MonotonicNow_ns() + kSoon_ns;
  if (setup_.simulated_glove) return soon_ns;
  const double period_ns = 1e9 / timing_.sample_rate_hz();
  const double first_ns =
      static_cast<double>(first_head_.arrival_ns) + std::min(0.25 * period_ns, kMost_ns);
  const double periods = std::ceil((static_cast<double>(soon_ns) - first_ns) / period_ns);
  return std::llround(first_ns + periods * period_ns);
}

void Session::TakeFrames() noexcept {
  const auto waiting = static_cast<std::int64_t>(input_.waiting());
  result_.facts.most_waiting = std::max(result_.facts.most_waiting, waiting);
  const std::int64_t now_ns = MonotonicNow_ns();
  const std::int64_t tick = loop_.tick();
  const auto take = [&](const InputHead& head, std::span<const double> counts) {
    SampleTimes& times = times_[static_cast<std::size_t>(head.number) % times_.size()];
    if (times.number != head.number) {
      times = {.number = head.number,
               .arrival_ns = head.arrival_ns,
               .decoded_ns = head.decoded_ns,
               .taken_ns = now_ns};
    }
    loop_.TakeGloveFrame({.number = head.number,
                          .origin_tick = tick,
                          .stamp_ticks = head.stamp_s * timing_.tick_rate_hz,
                          .values = counts});
    if (head.number <= logged_number_) return;
    logged_number_ = head.number;
    if (!is_ending_) samples_.Push(1e-9 * static_cast<double>(head.arrival_ns - start_ns_), counts);
    if (timing_.ticks_per_sample == 1) return;
    const std::int64_t period = timing_.ticks_per_sample;
    const std::int64_t since = ((tick - grid_phase_) % period + period) % period;
    const int shift = grid_.Take(since == 0 ? 0 : period - since);
    loop_.ShiftSamples(shift);
    grid_phase_ += shift;
    result_.facts.grid_shifts += std::abs(shift);
  };
  if (first_head_.arrival_ns != 0) {
    take(first_head_, first_counts_);
    first_head_.arrival_ns = 0;
  }
  while (input_.Pop(take)) {
  }
}

/// The controller's half of a tick. False at the end of a simulated glove.
bool Session::StepGlove(std::span<const std::int32_t>& frame) noexcept {
  if (!setup_.simulated_glove) {
    TakeFrames();
    step_begin_ns_ = MonotonicNow_ns();
    frame = loop_.StepController();
    return true;
  }
  const GloveSignal& glove = *setup_.simulated_glove;
  const std::int64_t tick = loop_.tick();
  if (tick >= glove.true_angle_rad.rows()) return false;
  if (tick % glove.ticks_per_sample != 0) {
    frame = loop_.StepController();
    return true;
  }
  const Eigen::Index sample = tick / glove.ticks_per_sample;
  for (std::size_t c = 0; c < glove_counts_.size(); ++c) {
    glove_counts_[c] = glove.counts(sample, static_cast<Eigen::Index>(c));
  }
  frame = loop_.StepController({.counts = glove_counts_});
  return true;
}

/// After the controller's half: which sample it has, and since when.
void Session::NoteSample() noexcept {
  const Receiver* receiver = loop_.glove_receiver();
  if (receiver != nullptr) {
    result_.facts.most_queued =
        std::max(result_.facts.most_queued, static_cast<std::int64_t>(receiver->waiting_frames()));
  }
  if (setup_.simulated_glove) {
    const std::int64_t captured = loop_.sample_tick();
    if (loop_.taken_counts().empty() || captured == sample_.number) return;
    const std::int64_t capture_ns = wake_->NominalOf_ns(captured);
    sample_ = {.number = captured,
               .arrival_ns = capture_ns,
               .decoded_ns = capture_ns,
               .taken_ns = receiver == nullptr ? woken_ns_ : capture_ns,
               .used_ns = woken_ns_};
  } else {
    GAUNTLET_ASSERT(receiver != nullptr);
    const std::int64_t number = receiver->number();
    if (number < 0 || number == sample_.number) return;
    const SampleTimes& times = times_[static_cast<std::size_t>(number) % times_.size()];
    if (times.number != number) return;
    sample_ = times;
    sample_.used_ns = std::max(times.taken_ns, step_begin_ns_);
  }
  sample_.filtered_ns = MonotonicNow_ns();
}

/// The frame that real motors get: that of the loop, or on the way to rest and back.
std::span<const std::int32_t> Session::AtRestOr(std::span<const std::int32_t> frame) noexcept {
  const bool is_gone = sink_is_gone_.load(std::memory_order_relaxed);
  rest_.Watch(!is_gone && !is_ending_);
  const bool is_resting = rest_.tier() != Watchdog::Tier::kFollow;
  if (is_resting && !was_resting_ && (is_gone || is_ending_)) ++result_.facts.rests;
  was_resting_ = is_resting;
  if (!frame.empty()) {
    std::ranges::copy(frame, wanted_.begin());
    has_wanted_ = true;
  }
  const auto since = static_cast<double>(loop_.tick() - sent_tick_);
  const bool is_due =
      has_wanted_ && is_resting && since >= timing_.TicksOf(timing_.event_period_ms);
  return frame.empty() && !is_due ? std::span<const std::int32_t>() : rest_.Command(wanted_);
}

void Session::SendCommand(std::span<const std::int32_t> frame) noexcept {
  for (std::size_t motor = 0; motor < frame.size(); ++motor) {
    if (has_sent_ || has_motors_) {
      result_.facts.largest_step_counts =
          std::max(result_.facts.largest_step_counts, std::abs(frame[motor] - sent_[motor]));
    }
    sent_[motor] = frame[motor];
    sent_values_[motor] = frame[motor];
  }
  has_sent_ = true;
  if (is_ending_ && std::ranges::equal(sent_, setup_.trial.hand->transmission().center_counts)) {
    ++rest_frames_;
  }
  sent_tick_ = loop_.tick();
  ++result_.facts.commands;
  if (sample_.number == last_sample_number_) ++result_.facts.repeated_samples;
  last_sample_number_ = sample_.number;
  const OutputHead head{
      .sample = sample_, .number = command_number_++, .due_ns = MonotonicNow_ns()};
  if (!has_motors_) return clock_.Add(head, head.due_ns);
  output_.Push(head, sent_values_);
  output_calls_.fetch_add(1, std::memory_order_release);
  output_calls_.notify_one();
}

/// The same samples as the controller that drives the motors, after its command.
void Session::StepShadows() noexcept {
  if (shadows_.empty()) return;
  const std::span<const double> counts = loop_.taken_counts();
  auto target = targets_row_.begin();
  for (std::size_t i = 0; i < shadows_.size(); ++i) {
    const std::int64_t begin_ns = MonotonicNow_ns();
    if (counts.empty()) {
      shadows_[i].Step();
    } else {
      shadows_[i].Step({.counts = counts});
    }
    result_.shadows[i].step.Add(MonotonicNow_ns() - begin_ns);
    target = std::ranges::copy(shadows_[i].target_angle_rad(), target).out;
  }
  if (!is_ending_) targets_.Push(loop_.tick(), targets_row_);
}

void Session::WatchTiers() noexcept {
  const Watchdog::Tier tier = loop_.watchdog_tier();
  TierFacts& facts = result_.facts.tiers[static_cast<std::size_t>(tier)];
  if (tier != tier_) {
    tier_ = tier;
    tier_ticks_ = 0;
    ++facts.entered;
  }
  ++tier_ticks_;
  facts.longest_s =
      std::max(facts.longest_s, static_cast<double>(tier_ticks_) / timing_.tick_rate_hz);
}

void Session::BeginEnd(LiveEnd end) noexcept {
  if (is_ending_) return;
  is_ending_ = true;
  end_tick_ = loop_.tick();
  result_.facts.end = end;
}

/// A tick that was skipped repeats the row before.
void Session::Skip(std::int64_t ticks) noexcept {
  LiveFacts& facts = result_.facts;
  facts.skipped_ticks += ticks;
  facts.longest_skip_ticks = std::max(facts.longest_skip_ticks, ticks);
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    if (IsTraced()) recorder_->Record(loop_);
    if (!shadows_.empty() && !is_ending_) targets_.Push(loop_.tick() + tick, targets_row_);
    rest_.Watch(!sink_is_gone_.load(std::memory_order_relaxed) && !is_ending_);
  }
  loop_.Skip(ticks);
}

void Session::SwitchIfAsked() noexcept {
  if (setup_.view == nullptr || is_ending_) return;
  if (!switch_.To(setup_.view->TakeAsked(), loop_)) return;
  LiveFacts& facts = result_.facts;
  ++facts.switch_count;
  if (facts.switches.size() == kMostSwitches) return;  // what is reserved
  facts.switches.push_back({.time_s = Time_s(), .to = switch_.driving()});
}

void Session::MarkIfAsked() noexcept {
  if (setup_.view == nullptr) return;
  std::vector<StillTime>& still = result_.facts.still;
  const int mark = setup_.view->TakeMark();
  if (mark == 0 || is_ending_) is_still_ = false;
  if (mark == 1 && !is_still_ && !is_ending_ && still.size() < kMostSwitches) {  // what is reserved
    still.push_back({.begin_s = Time_s(), .end_s = Time_s()});
    is_still_ = true;
  }
  if (is_still_) still.back().end_s = Time_s();
}

void Session::ShowMoment(std::int64_t lateness_ns) noexcept {
  if (setup_.view == nullptr) return;
  largest_lateness_ns_ = std::max(largest_lateness_ns_, lateness_ns);
  if (--ticks_to_show_ > 0) return;
  ticks_to_show_ = std::llround(timing_.tick_rate_hz / LiveView::kRate_hz);
  const LiveFacts& facts = result_.facts;
  const Receiver* receiver = loop_.glove_receiver();
  const controller::Controller& controller = loop_.controller();
  loop_.hand().ReadJointAngles(hand_rad_);
  setup_.view->Show(
      {.time_s = Time_s(),
       .largest_lateness_s = 1e-9 * static_cast<double>(largest_lateness_ns_),
       .skipped_ticks = facts.skipped_ticks,
       .waiting_frames = static_cast<std::int64_t>(input_.waiting()),
       .queued_frames =
           receiver == nullptr ? 0 : static_cast<std::int64_t>(receiver->waiting_frames()),
       .commands = facts.commands,
       .repeated_samples = facts.repeated_samples,
       .driving = switch_.driving(),
       .is_still = is_still_,
       .tier = loop_.watchdog_tier(),
       .has_sink = !sink_is_gone_.load(std::memory_order_relaxed)},
      controller.linearised_angle_rad(), controller.target_angle_rad(), hand_rad_);
  largest_lateness_ns_ = 0;
}

void Session::Tick(const PeriodicWake::Woken& woken) noexcept {
  LiveFacts& facts = result_.facts;
  woken_ns_ = woken.nominal_ns + woken.lateness_ns;
  const std::int64_t cpu_begin_ns = NowOf_ns(CLOCK_THREAD_CPUTIME_ID);
  if (woken.skipped > 0) Skip(woken.skipped);
  SwitchIfAsked();
  MarkIfAsked();
  facts.lateness.Add(woken.lateness_ns);
  std::span<const std::int32_t> frame;
  if (!StepGlove(frame)) {
    BeginEnd(LiveEnd::kGloveEnded);
    if (!has_motors_) return;
    frame = loop_.StepController();
  }
  NoteSample();
  if (has_motors_) frame = AtRestOr(frame);
  if (!frame.empty()) SendCommand(frame);
  facts.step_cpu.Add(NowOf_ns(CLOCK_THREAD_CPUTIME_ID) - cpu_begin_ns);
  facts.step.Add(MonotonicNow_ns() - woken_ns_);
  StepShadows();
  loop_.StepHand(frame);
  WatchTiers();
  if (!is_ending_) {
    ++facts.ticks;
    if (IsTraced() && loop_.hand().health().ok) recorder_->Record(loop_);
  }
  ShowMoment(woken.lateness_ns);
  facts.tick_work.Add(MonotonicNow_ns() - woken_ns_);
}

bool Session::IsDone() noexcept {
  if (setup_.seconds > 0.0 &&
      static_cast<double>(loop_.tick()) >= setup_.seconds * timing_.tick_rate_hz) {
    BeginEnd(LiveEnd::kSeconds);
  }
  if (stop_asked_.load(std::memory_order_relaxed)) BeginEnd(LiveEnd::kStopped);
  if (!loop_.hand().health().ok) BeginEnd(LiveEnd::kHandStopped);
  if (setup_.source != nullptr && input_ended_.load(std::memory_order_acquire) &&
      input_.waiting() == 0) {
    BeginEnd(LiveEnd::kGloveEnded);
  }
  const bool is_gone = sink_is_gone_.load(std::memory_order_relaxed);
  if (has_motors_ && is_gone && !setup_.sink_comes_back) {
    BeginEnd(LiveEnd::kSinkGone);
    return true;
  }
  if (!is_ending_) return false;
  if (!has_motors_ || !has_wanted_) return true;
  constexpr double kMost_ms = 15'000.0;
  const bool is_long = static_cast<double>(loop_.tick() - end_tick_) > timing_.TicksOf(kMost_ms);
  constexpr int kRestFrames = 3;  // one may be lost on its way
  return is_long || rest_frames_ >= kRestFrames;
}

void Session::Control() {
  result_.facts.rights.has_priority = RaisePriority(kControlPriority);
  has_started_.store(true, std::memory_order_release);
  has_started_.notify_one();
  do {
    Tick(wake_->Wait());
  } while (!IsDone());
  control_ended_.store(true, std::memory_order_release);
  output_calls_.fetch_add(1, std::memory_order_release);
  output_calls_.notify_one();
}

/// Of several frames that wait, the newest: an old command is of no use.
void Session::Output() {
  RaisePriority(kOutputPriority);
  std::vector<double> counts(output_.width());
  OutputHead head;
  int good_sends = 0;
  for (;;) {
    const std::uint32_t calls = output_calls_.load(std::memory_order_acquire);
    const bool is_last = control_ended_.load(std::memory_order_acquire);
    std::int64_t found = 0;
    while (output_.Pop([&](const OutputHead& next, std::span<const double> values) {
      head = next;
      std::ranges::copy(values, counts.begin());
    })) {
      ++found;
    }
    if (found > 0) {
      result_.facts.replaced_commands += found - 1;
      const FrameSink::Result sent =
          setup_.sink->Send({.number = head.number, .time_ns = head.due_ns, .values = counts});
      // Without a listener the system reports every other packet only.
      constexpr int kGoodSends = 5;
      good_sends = sent == FrameSink::Result::kGone ? 0 : good_sends + 1;
      if (good_sends == 0 || good_sends >= kGoodSends) {
        sink_is_gone_.store(good_sends == 0, std::memory_order_relaxed);
      }
      clock_.Add(head, MonotonicNow_ns());
    } else if (is_last) {
      return;
    } else {
      output_calls_.wait(calls, std::memory_order_acquire);
    }
  }
}

void Session::MoveLog() {
  recorder_->MoveBlocks();
  while (samples_.Pop([&](double time_s, std::span<const double> counts) {
    if (!result_.recorded_time_s.empty() && time_s <= result_.recorded_time_s.back()) return;
    result_.recorded_time_s.push_back(std::max(0.0, time_s));
    result_.recorded_counts.insert(result_.recorded_counts.end(), counts.begin(), counts.end());
  })) {
  }
  while (targets_.Pop([&](std::int64_t, std::span<const double> targets) {
    if (logged_targets_.size() < most_targets_) {
      logged_targets_.insert(logged_targets_.end(), targets.begin(), targets.end());
    }
  })) {
  }
}

void Session::Log() {
  while (!ends_.load(std::memory_order_acquire)) {
    MoveLog();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  MoveLog();
}

void Session::RunLoop() {
  const auto trace_ticks =
      static_cast<Eigen::Index>(std::ceil(setup_.trace_s * timing_.tick_rate_hz));
  result_.facts.rights.has_locked_memory = LockMemory();
  result_.trace.controller_name = setup_.trial.controller_name;
  recorder_.emplace(result_.trace, trace_ticks,
                    TraceColumnNames(setup_.trial.calibration.channel_names, *setup_.trial.hand,
                                     setup_.trial.links.config.exist()),
                    std::span<const std::string_view>(), kTraceBlocks);
  most_targets_ = static_cast<std::size_t>(trace_ticks) * targets_.width();
  start_ns_ = StartTime();
  wake_.emplace(start_ns_, timing_.tick_rate_hz);
  Threads threads;
  if (has_motors_) threads.Start([this] { Output(); });
  threads.Start([this] { Log(); });
  threads.Start([this] { Control(); });
  has_started_.wait(false, std::memory_order_acquire);
  if (const std::string refusal = result_.facts.rights.Refusal(); !refusal.empty() && setup_.say) {
    setup_.say(refusal);
  }
  while (!control_ended_.load(std::memory_order_acquire)) {
    std::this_thread::sleep_for(kLook);
    if (StopAsked()) stop_asked_.store(true, std::memory_order_relaxed);
  }
  ends_.store(true, std::memory_order_release);
  threads.Join();
  UnlockMemory();
}

/// After the threads have ended.
/// Stretches within the recording, of half a second or more: shorter ones say little of noise.
void Session::KeepStill() {
  std::vector<StillTime>& still = result_.facts.still;
  const double last_s = result_.recorded_time_s.empty() ? Time_s() : result_.recorded_time_s.back();
  for (StillTime& stretch : still) stretch.end_s = std::min(stretch.end_s, last_s);
  constexpr double kLeast_s = 0.5;
  std::erase_if(
      still, [](const StillTime& stretch) { return stretch.end_s - stretch.begin_s < kLeast_s; });
}

void Session::Gather() {
  LiveFacts& facts = result_.facts;
  recorder_->Finish();
  result_.trace_rows_left_out = recorder_->left_out();
  result_.trace.health = loop_.hand().health();
  const auto untrusted = loop_.controller().untrusted_samples();
  facts.untrusted_samples.assign(untrusted.begin(), untrusted.end());
  result_.trace.untrusted_samples = facts.untrusted_samples;
  facts.duration_s = static_cast<double>(facts.ticks + facts.skipped_ticks) / timing_.tick_rate_hz;
  facts.stages = std::move(clock_.stages);
  facts.total = std::move(clock_.total);
  facts.age_ms = clock_.age_ms.trend();
  if (loop_.glove_receiver() != nullptr) facts.late_frames = loop_.glove_receiver()->late_frames();
  if (setup_.source != nullptr) {
    facts.arrivals = arrivals_.Facts();
    facts.source = setup_.source->counts();
    result_.columns_remark = channels_.remark();
  }
  KeepStill();
  if (setup_.sink != nullptr) facts.sink = setup_.sink->counts();
  if (shadows_.empty()) return;
  const std::size_t joints = targets_.width() / shadows_.size();
  const std::size_t rows = logged_targets_.size() / targets_.width();
  for (std::size_t i = 0; i < shadows_.size(); ++i) {
    Signal& target = result_.shadows[i].target_angle_rad;
    target = Signal(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(joints));
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t joint = 0; joint < joints; ++joint) {
        target(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(joint)) =
            logged_targets_[row * targets_.width() + i * joints + joint];
      }
    }
  }
}

LiveResult Session::Run() {
  Threads input;
  const std::string source = setup_.source == nullptr ? "" : setup_.source->Description();
  if (setup_.source != nullptr) input.Start([this] { Input(); });
  const bool has_glove = WaitForGlove(source);
  try {
    if (has_glove) {
      ResetToFirstSample();
      RunLoop();
    }
  } catch (...) {
    ends_.store(true, std::memory_order_release);
    input.Join();
    throw;
  }
  ends_.store(true, std::memory_order_release);
  input.Join();
  if (input_error_) std::rethrow_exception(input_error_);
  if (!has_glove) {
    ThrowIfStopped();
    throw UserError(
        {.place = setup_.channels.source, .problem = setup_.source->AdviceWithoutFrames()});
  }
  Gather();
  return std::move(result_);
}

}  // namespace

LiveResult RunLive(const LiveSetup& setup) {
  GAUNTLET_ASSERT((setup.simulated_glove == nullptr) != (setup.source == nullptr));
  GAUNTLET_ASSERT(setup.source == nullptr || setup.trial.links.config.glove);
  return std::make_unique<Session>(setup)->Run();
}

}  // namespace gauntlet::sim
