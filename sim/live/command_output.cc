#include "sim/live/command_output.h"

#include <algorithm>
#include <vector>

#include "sim/live/device/device_clock.h"
#include "sim/live/real_time.h"
#include "sim/live/session_threads.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kRows = 64;

}  // namespace

CommandOutput::CommandOutput(FrameSink* sink, std::size_t motors, LiveView* view)
    : commands_(kRows, motors), sink_(sink), clock_(view) {}

void CommandOutput::Begin() {
  if (has_motors()) thread_ = StartThread([this] { SendAll(); });
}

void CommandOutput::Send(const OutputHead& head, std::span<const double> counts) noexcept {
  if (!has_motors()) return clock_.Add(head, head.due_ns);
  commands_.Push(head, counts);
  Wake();
}

void CommandOutput::Wake() noexcept {
  calls_.fetch_add(1, std::memory_order_release);
  calls_.notify_one();
}

void CommandOutput::End() noexcept {
  if (!thread_.joinable()) return;
  ends_.store(true, std::memory_order_release);
  Wake();
  thread_.join();
}

void CommandOutput::SendAll() {
  RaisePriority(kOutputPriority);
  std::vector<double> counts(commands_.width());
  OutputHead head;
  for (;;) {
    const std::uint32_t calls = calls_.load(std::memory_order_acquire);
    const bool is_last = ends_.load(std::memory_order_acquire);
    std::int64_t found = 0;
    while (commands_.Pop([&](const OutputHead& next, std::span<const double> values) {
      head = next;
      std::ranges::copy(values, counts.begin());
    })) {
      ++found;
    }
    if (found > 0) {
      replaced_ += found - 1;
      SendNewest(head, counts);
    } else if (is_last) {
      return;
    } else {
      calls_.wait(calls, std::memory_order_acquire);
    }
  }
}

void CommandOutput::SendNewest(const OutputHead& head, std::span<const double> counts) {
  const FrameSink::Result sent =
      sink_->Send({.number = head.number, .time_ns = head.due_ns, .values = counts});
  // Without a listener the system reports every other packet only.
  constexpr int kGoodSends = 5;
  good_sends_ = sent == FrameSink::Result::kGone ? 0 : good_sends_ + 1;
  if (good_sends_ == 0 || good_sends_ >= kGoodSends) {
    is_gone_.store(good_sends_ == 0, std::memory_order_relaxed);
  }
  clock_.Add(head, MonotonicNow_ns());
}

void CommandOutput::AddFacts(LiveFacts& facts) const {
  facts.stages = clock_.stages;
  facts.total = clock_.total;
  facts.age_ms = clock_.age_ms.trend();
  facts.replaced_commands = replaced_;
  if (has_motors()) facts.sink = sink_->counts();
}

}  // namespace gauntlet::sim
