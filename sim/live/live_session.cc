#include "sim/live/live_session.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <thread>
#include <utility>

#include "controller/assert.h"
#include "controller/controller.h"
#include "sim/base/stop.h"
#include "sim/live/command_output.h"
#include "sim/live/device/device_clock.h"
#include "sim/live/further_controllers.h"
#include "sim/live/live_glove.h"
#include "sim/live/motor_rest.h"
#include "sim/live/session_log.h"
#include "sim/live/session_threads.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

std::vector<controller::ControllerConfig> ControllersOf(std::span<const ShadowSetup> shadows) {
  std::vector<controller::ControllerConfig> configs;
  for (const ShadowSetup& shadow : shadows) configs.push_back(shadow.controller);
  return configs;
}

/// The control thread, and what happens before and after it.
class Session {
 public:
  explicit Session(const LiveSetup& setup);

  LiveResult Run();

 private:
  void ResetToFirstSample();
  void RunLoop();
  void Gather();
  void KeepStill();

  // The control thread has these.
  void Control(PeriodicWake& wake);
  void Tick(const PeriodicWake& wake, const PeriodicWake::Woken& woken) noexcept;
  void Skip(std::int64_t ticks) noexcept;
  void SendCommand(std::span<const std::int32_t> frame) noexcept;
  void NoteQueue() noexcept;
  void WatchTiers() noexcept;
  void KeepTargets() noexcept;
  void SwitchIfAsked() noexcept;
  void MarkIfAsked() noexcept;
  std::span<const double> AskedAngles_rad() const noexcept;
  void ShowTick() noexcept;
  void ShowMoment(const PeriodicWake::Woken& woken) noexcept;
  bool IsDone() noexcept;
  void BeginEnd(LiveEnd end) noexcept;
  double Time_s() const noexcept {
    return static_cast<double>(loop_.tick()) / timing_.tick_rate_hz;
  }
  bool MayFollow() const noexcept { return !is_ending_ && !output_.is_gone(); }
  bool IsTraced() const noexcept { return !is_ending_ && result_.facts.switch_count == 0; }

  CommandOutput output_;
  const LiveSetup& setup_;
  const controller::Timing& timing_;
  LiveResult result_;
  HandLoop loop_;
  std::unique_ptr<LiveGlove> glove_;
  std::unique_ptr<SessionLog> log_;

  // The control thread has these.
  Shadows shadows_;
  ControllerSwitch switch_;
  MotorRest rest_;
  std::vector<std::int32_t> sent_;
  std::vector<double> sent_values_;
  std::vector<double> hand_rad_;
  std::atomic<bool> has_started_ = false;  // the thread, with its priority
  bool has_sent_ = false;
  bool is_ending_ = false;
  bool is_still_ = false;
  int rest_frames_ = 0;  // at the end
  Watchdog::Tier tier_ = Watchdog::Tier::kFollow;
  std::int64_t tier_ticks_ = 0;
  std::int64_t end_tick_ = 0;
  std::int64_t last_sample_number_ = -1;
  std::int64_t noted_sample_ = -1;
  std::int64_t shown_sample_ = -1;
  std::int64_t ticks_to_show_ = 0;
  std::int64_t largest_lateness_ns_ = 0;  // since the moment that was shown last
};

Session::Session(const LiveSetup& setup)
    : output_(setup.sink, setup.trial.hand->transmission().motor_names.size(), setup.view),
      setup_(setup),
      timing_(setup.trial.hand->timing().controller),
      loop_(setup.trial.controller, setup.trial.calibration, setup.trial.joint_map,
            setup.trial.hand, setup.trial.links),
      glove_(MakeLiveGlove(setup)),
      shadows_(setup),
      switch_(loop_, ControllersOf(setup.shadows)),
      rest_(setup.trial.links.config, setup.trial.hand->transmission(), timing_),
      sent_(setup.trial.hand->transmission().motor_names.size()),
      sent_values_(sent_.size()),
      hand_rad_(setup.trial.hand->joint_names().size()) {
  result_.trace.controller_name = setup.trial.controller_name;
  result_.shadows.resize(setup.shadows.size());
  result_.facts.switches.reserve(kMostSwitches);
  result_.facts.still.reserve(kMostSwitches);
}

/// A simulated hand begins in the posture that the first sample asks for, as a trial does; real
/// motors at rest.
void Session::ResetToFirstSample() {
  const controller::TendonTransmission& hand = setup_.trial.hand->transmission();
  std::vector<double> posture_rad(hand.reference_angle_rad);
  if (!output_.has_motors()) {
    const std::vector<double> first_rad = glove_->FirstAngles_rad();
    const Signal angle_rad =
        Eigen::Map<const Eigen::RowVectorXd>(first_rad.data(), std::ssize(first_rad));
    const controller::JointMap joint_map(setup_.trial.joint_map,
                                         setup_.trial.calibration.channel_names, hand);
    const Signal start_rad = JointAngles(joint_map, angle_rad).transpose();
    posture_rad.assign(start_rad.data(), start_rad.data() + start_rad.size());
  }
  loop_.Reset(posture_rad);
  const std::span<const std::int32_t> counts = loop_.hand().command();
  std::ranges::copy(counts, sent_.begin());
  shadows_.Reset(counts);
  rest_.Reset(counts);
}

void Session::SendCommand(std::span<const std::int32_t> frame) noexcept {
  LiveFacts& facts = result_.facts;
  for (std::size_t motor = 0; motor < frame.size(); ++motor) {
    if (has_sent_ || output_.has_motors()) {
      facts.largest_step_counts =
          std::max(facts.largest_step_counts, std::abs(frame[motor] - sent_[motor]));
    }
    sent_[motor] = frame[motor];
    sent_values_[motor] = frame[motor];
  }
  has_sent_ = true;
  if (is_ending_ && std::ranges::equal(sent_, setup_.trial.hand->transmission().center_counts)) {
    ++rest_frames_;
  }
  const SampleTimes& sample = glove_->sample();
  if (sample.number == last_sample_number_) ++facts.repeated_samples;
  last_sample_number_ = sample.number;
  output_.Send({.sample = sample,
                .number = facts.commands++,
                .due_ns = MonotonicNow_ns(),
                .period_ns = std::llround(1e6 * timing_.event_period_ms)},
               sent_values_);
}

void Session::NoteQueue() noexcept {
  const Receiver* receiver = loop_.glove_receiver();
  if (receiver == nullptr) return;
  result_.facts.most_queued =
      std::max(result_.facts.most_queued, static_cast<std::int64_t>(receiver->waiting_frames()));
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

void Session::KeepTargets() noexcept {
  if (shadows_.exist() && !is_ending_) log_->AddTargets(shadows_.targets_rad());
}

/// A tick that was skipped repeats the row before.
void Session::Skip(std::int64_t ticks) noexcept {
  LiveFacts& facts = result_.facts;
  facts.skipped_ticks += ticks;
  facts.longest_skip_ticks = std::max(facts.longest_skip_ticks, ticks);
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    if (IsTraced()) log_->AddTick(loop_);
    KeepTargets();
    rest_.Skip(MayFollow());
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
  log_->AddNote({.kind = SessionLog::Note::Kind::kDrives,
                 .time_s = Time_s(),
                 .controller = switch_.driving()});
}

void Session::MarkIfAsked() noexcept {
  if (setup_.view == nullptr) return;
  std::vector<StillTime>& still = result_.facts.still;
  const int mark = setup_.view->TakeMark();
  if (mark == 0 && is_still_) {
    log_->AddNote({.kind = SessionLog::Note::Kind::kMoves, .time_s = Time_s()});
  }
  if (mark == 0 || is_ending_) is_still_ = false;
  if (mark == 1 && !is_still_ && !is_ending_ && still.size() < kMostSwitches) {  // what is reserved
    still.push_back({.begin_s = Time_s(), .end_s = Time_s()});
    is_still_ = true;
    log_->AddNote({.kind = SessionLog::Note::Kind::kStill, .time_s = Time_s()});
  }
  if (is_still_) still.back().end_s = Time_s();
}

/// Angles that all controllers ask for, in the order of LiveView::Ask().
std::span<const double> Session::AskedAngles_rad() const noexcept {
  return shadows_.exist() ? shadows_.asked_rad() : loop_.controller().target_angle_rad();
}

/// Before the hand steps, as the tick ends there.
void Session::ShowTick() noexcept {
  if (setup_.view == nullptr || is_ending_) return;
  const std::int64_t sample = glove_->sample().number;
  setup_.view->ShowTick(
      {.number = loop_.tick(), .driving = switch_.driving(), .has_sample = sample != shown_sample_},
      loop_.controller().linearised_angle_rad(), loop_.controller().target_angle_rad(),
      AskedAngles_rad());
  shown_sample_ = sample;
}

void Session::ShowMoment(const PeriodicWake::Woken& woken) noexcept {
  if (setup_.view == nullptr) return;
  largest_lateness_ns_ = std::max(largest_lateness_ns_, woken.lateness_ns);
  if (--ticks_to_show_ > 0) return;
  ticks_to_show_ = std::llround(timing_.tick_rate_hz / LiveView::kRate_hz);
  const LiveFacts& facts = result_.facts;
  const Receiver* receiver = loop_.glove_receiver();
  const controller::Controller& controller = loop_.controller();
  const SampleTimes& sample = glove_->sample();
  const std::int64_t now_ns = woken.nominal_ns + woken.lateness_ns;
  loop_.hand().ReadJointAngles(hand_rad_);
  setup_.view->Show(
      {.time_s = Time_s(),
       .largest_lateness_s = 1e-9 * static_cast<double>(largest_lateness_ns_),
       .skipped_ticks = facts.skipped_ticks,
       .waiting_frames = glove_->waiting_frames(),
       .queued_frames =
           receiver == nullptr ? 0 : static_cast<std::int64_t>(receiver->waiting_frames()),
       .commands = facts.commands,
       .repeated_samples = facts.repeated_samples,
       .driving = switch_.driving(),
       .is_still = is_still_,
       .is_ending = is_ending_,
       .tier = loop_.watchdog_tier(),
       .silent_s = sample.number < 0 ? 0.0 : 1e-9 * static_cast<double>(now_ns - sample.arrival_ns),
       .has_sink = !output_.is_gone()},
      controller.linearised_angle_rad(), controller.target_angle_rad(), hand_rad_,
      AskedAngles_rad());
  largest_lateness_ns_ = 0;
}

void Session::Tick(const PeriodicWake& wake, const PeriodicWake::Woken& woken) noexcept {
  LiveFacts& facts = result_.facts;
  const std::int64_t woken_ns = woken.nominal_ns + woken.lateness_ns;
  const std::int64_t cpu_begin_ns = NowOf_ns(CLOCK_THREAD_CPUTIME_ID);
  if (woken.skipped > 0) Skip(woken.skipped);
  SwitchIfAsked();
  MarkIfAsked();
  facts.lateness.Add(woken.lateness_ns);
  if (glove_->HasEnded(loop_.tick())) {
    BeginEnd(LiveEnd::kGloveEnded);
    if (!output_.has_motors()) return;
  }
  const LiveTick tick = {
      .wake = wake, .woken_ns = woken_ns, .log = is_ending_ ? nullptr : log_.get()};
  std::span<const std::int32_t> frame = glove_->StepController(tick, loop_);
  NoteQueue();
  if (glove_->sample().number != noted_sample_) {
    noted_sample_ = glove_->sample().number;
    rest_.NoteSample(woken_ns);
  }
  if (output_.has_motors()) frame = rest_.Frame(loop_.tick(), frame, MayFollow());
  if (!frame.empty()) SendCommand(frame);
  facts.step_cpu.Add(NowOf_ns(CLOCK_THREAD_CPUTIME_ID) - cpu_begin_ns);
  facts.step.Add(MonotonicNow_ns() - woken_ns);
  // After the command, and with the same samples.
  shadows_.Step(loop_.taken_counts());
  KeepTargets();
  ShowTick();
  loop_.StepHand(frame);
  WatchTiers();
  if (!is_ending_) {
    ++facts.ticks;
    if (IsTraced() && loop_.hand().health().ok) log_->AddTick(loop_);
  }
  ShowMoment(woken);
  facts.tick_work.Add(MonotonicNow_ns() - woken_ns);
}

bool Session::IsDone() noexcept {
  if (setup_.seconds > 0.0 && Time_s() >= setup_.seconds) BeginEnd(LiveEnd::kSeconds);
  if (StopAsked()) BeginEnd(LiveEnd::kStopped);
  if (!loop_.hand().health().ok) BeginEnd(LiveEnd::kHandStopped);
  if (output_.is_gone() && !setup_.sink_comes_back) {
    BeginEnd(LiveEnd::kSinkGone);
    return true;
  }
  if (!is_ending_) return false;
  if (!output_.has_motors() || !rest_.has_command()) return true;
  constexpr double kMost_ms = 15'000.0;
  const bool is_long = static_cast<double>(loop_.tick() - end_tick_) > timing_.TicksOf(kMost_ms);
  constexpr int kRestFrames = 3;  // one may be lost on its way
  return is_long || rest_frames_ >= kRestFrames;
}

void Session::Control(PeriodicWake& wake) {
  result_.facts.rights.has_priority = RaisePriority(kControlPriority);
  has_started_.store(true, std::memory_order_release);
  has_started_.notify_one();
  do {
    Tick(wake, wake.Wait());
  } while (!IsDone());
}

void Session::RunLoop() {
  constexpr std::int64_t kSoon_ns = 2'000'000;
  result_.facts.rights.has_locked_memory = LockMemory();
  log_ = std::make_unique<SessionLog>(setup_, result_);
  output_.Begin();
  PeriodicWake wake(glove_->StartTime_ns(MonotonicNow_ns() + kSoon_ns), timing_.tick_rate_hz);
  std::jthread control = StartThread([this, &wake] { Control(wake); });
  has_started_.wait(false, std::memory_order_acquire);
  if (const std::string refusal = result_.facts.rights.Refusal(); !refusal.empty() && setup_.say) {
    setup_.say(refusal);
  }
  control.join();
  output_.End();
  log_->End();
  if (setup_.recording != nullptr) result_.recorded = setup_.recording->facts();
  UnlockMemory();
}

/// Stretches within the recording, of half a second or more: shorter ones say little of noise.
void Session::KeepStill() {
  std::vector<StillTime>& still = result_.facts.still;
  const double last_s = result_.recorded.kept == 0 ? Time_s() : result_.recorded.last_time_s;
  for (StillTime& stretch : still) stretch.end_s = std::min(stretch.end_s, last_s);
  constexpr double kLeast_s = 0.5;
  std::erase_if(
      still, [](const StillTime& stretch) { return stretch.end_s - stretch.begin_s < kLeast_s; });
}

/// After the threads have ended.
void Session::Gather() {
  LiveFacts& facts = result_.facts;
  result_.trace.health = loop_.hand().health();
  const auto untrusted = loop_.controller().untrusted_samples();
  facts.untrusted_samples.assign(untrusted.begin(), untrusted.end());
  result_.trace.untrusted_samples = facts.untrusted_samples;
  facts.duration_s = static_cast<double>(facts.ticks + facts.skipped_ticks) / timing_.tick_rate_hz;
  facts.rests = rest_.rests();
  if (loop_.glove_receiver() != nullptr) facts.late_frames = loop_.glove_receiver()->late_frames();
  output_.AddFacts(facts);
  KeepStill();
  for (std::size_t i = 0; i < result_.shadows.size(); ++i) {
    result_.shadows[i].step = shadows_.step(i);
  }
}

LiveResult Session::Run() {
  const bool has_glove = glove_->WaitForFirst();
  if (has_glove) {
    ResetToFirstSample();
    RunLoop();
  }
  glove_->End(result_);
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
