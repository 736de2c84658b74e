#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "sim/live/duration_histogram.h"
#include "sim/live/live_view.h"
#include "sim/live/trend.h"

namespace gauntlet::sim {

/// Stages of the time between the arrival of a sample and its command.
enum class Stage : std::uint8_t {
  kInput,     // arrival until the input thread has decoded it
  kTick,      // until the control thread takes it, at its next tick
  kReceiver,  // until the receiver uses it: sampling grid, buffer, queue
  kFilter,    // until the controller has it
  kHeld,      // beyond the period of the command frames: no newer sample came
  kEvent,     // until a command frame is due
  kSend,      // until the frame has been handed to the system
};
inline constexpr std::size_t kStages = 7;
/// As in live.json and for people.
struct StageName {
  std::string_view key;
  std::string_view text;
};
inline constexpr std::array<StageName, kStages> kStageNames = {{
    {"input", "input thread"},
    {"tick", "wait for the tick"},
    {"receiver", "receiver: grid, buffer, queue"},
    {"filter", "filter and maps"},
    {"held", "no newer sample"},
    {"event", "wait for the command frame"},
    {"send", "send"},
}};

/// When what happened to the sample behind a command.
struct SampleTimes {
  std::int64_t number = -1;
  std::int64_t arrival_ns = 0;
  std::int64_t decoded_ns = 0;
  std::int64_t taken_ns = 0;
  std::int64_t used_ns = 0;
  std::int64_t filtered_ns = 0;
};

/// A command frame on its way to the motors.
struct OutputHead {
  SampleTimes sample;
  std::int64_t number = 0;
  std::int64_t due_ns = 0;
  /// Period of the command frames. A new sample waits for no longer.
  std::int64_t period_ns = std::numeric_limits<std::int64_t>::max();
};

/// The stages of commands; of the thread that sends them.
class StageClock {
 public:
  explicit StageClock(LiveView* view) : view_(view) {}

  void Add(const OutputHead& head, std::int64_t sent_ns) noexcept {
    if (head.sample.number < 0) return;
    const SampleTimes& sample = head.sample;
    const std::int64_t held_until_ns =
        std::max(sample.filtered_ns, head.due_ns - std::min(head.due_ns, head.period_ns));
    const std::array times = {
        sample.arrival_ns,  sample.decoded_ns, sample.taken_ns, sample.used_ns,
        sample.filtered_ns, held_until_ns,     head.due_ns,     sent_ns};
    for (std::size_t stage = 0; stage < kStages; ++stage) {
      const std::int64_t duration_ns = times[stage + 1] - times[stage];
      stages[stage].Add(duration_ns);
      stages_us_[stage] = 1e-3 * static_cast<double>(duration_ns);
    }
    if (view_ != nullptr) view_->ShowStages(stages_us_);
    const std::int64_t age_ns = sent_ns - sample.arrival_ns;
    total.Add(age_ns);
    // A silent glove is no trend of the chain.
    const std::int64_t held_ns = held_until_ns - sample.filtered_ns;
    age_ms.Add(sent_ns, 1e-6 * static_cast<double>(age_ns - held_ns));
  }

  std::array<DurationHistogram, kStages> stages;
  DurationHistogram total;
  TrendOfSeconds age_ms;

 private:
  static_assert(kStages == LiveView::kStageRows);

  LiveView* view_;
  std::array<double, kStages> stages_us_ = {};
};

}  // namespace gauntlet::sim
