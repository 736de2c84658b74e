#include "sim/live/frame_arrivals.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/number.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

/// Numbers and times of a damaged frame may be anything: their sums and differences wrap.
std::int64_t Sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
std::int64_t Difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

}  // namespace

double ArrivalFacts::PerSecond(std::int64_t count) const {
  return frames < 2 || last_ns <= first_ns ? controller::kNaN
                                           : static_cast<double>(count - 1) / duration_s();
}

double ArrivalFacts::Rate_hz() const {
  const std::int64_t intervals = different + lost - waited - lost_in_silences - silences - 1;
  const std::int64_t time_ns = last_ns - std::max(first_ns, rate_from_ns) - silence_ns;
  return intervals < 1 || time_ns <= 0
             ? controller::kNaN
             : static_cast<double>(intervals) / (1e-9 * static_cast<double>(time_ns));
}

void FrameArrivals::BeginRate() {
  facts_.waited = facts_.different + facts_.lost;
  facts_.silences = facts_.silence_ns = facts_.lost_in_silences = 0;
  rate_begins_ = true;
}

/// A gap in which the device was silent, rather than one of a slow or jittery one.
bool FrameArrivals::IsSilence(std::int64_t gap_ns) const {
  constexpr std::int64_t kLeast_ns = 250'000'000;
  constexpr int kTimesUsual = 10;
  constexpr std::int64_t kLeastFrames = 10;
  if (facts_.frames < kLeastFrames || gap_ns < kLeast_ns) return false;
  return gap_ns > kTimesUsual * (facts_.last_ns - facts_.first_ns) / (facts_.frames - 1);
}

FrameArrivals::Numbered FrameArrivals::Add(const DeviceFrame& frame) {
  bool was_silent = false;
  const std::int64_t lost = facts_.lost;
  const bool begins = std::exchange(rate_begins_, false);
  if (begins) facts_.rate_from_ns = frame.arrival_ns;
  if (facts_.frames == 0) {
    facts_.first_ns = frame.arrival_ns;
  } else {
    const std::int64_t gap_ns = frame.arrival_ns - facts_.last_ns;
    facts_.gaps.Add(gap_ns);
    was_silent = !begins && IsSilence(gap_ns);
    if (was_silent) {
      ++facts_.silences;
      facts_.silence_ns += gap_ns;
    }
  }
  facts_.last_ns = std::max(facts_.last_ns, frame.arrival_ns);
  ++facts_.frames;
  if (facts_.frames == 1 || !AreSame(frame.values, last_values_)) {
    ++facts_.different;
    last_values_.assign(frame.values.begin(), frame.values.end());
  }
  const std::int64_t restarts = facts_.restarts;
  const std::int64_t number = NumberOf(frame);
  if (was_silent) facts_.lost_in_silences += facts_.lost - lost;
  return {.number = number, .stamp_s = StampOf(frame, facts_.restarts > restarts)};
}

std::int64_t FrameArrivals::NumberOf(const DeviceFrame& frame) {
  if (!frame.number) return ++highest_;
  facts_.has_numbers = true;
  if (!first_number_) {
    first_number_ = *frame.number;
    offset_ = Difference(0, *frame.number);
  }
  constexpr std::int64_t kMostLost = 1'000'000;
  constexpr int kRisingOnes = 5;
  constexpr std::int64_t kSilence_ns = 50'000'000;
  std::int64_t number = Sum(*frame.number, offset_);
  const std::int64_t ahead = Difference(number, highest_);
  if (ahead > 0) {
    stale_frames_ = 0;
  } else {
    stale_frames_ = stale_frames_ > 0 && number > stale_number_ ? stale_frames_ + 1 : 1;
    stale_number_ = number;
  }
  const bool is_silent = frame.arrival_ns - highest_arrival_ns_ > kSilence_ns;
  if (ahead > kMostLost || (stale_frames_ >= kRisingOnes && is_silent)) {
    number = highest_ + 1;
    offset_ = Difference(number, *frame.number);
    stale_frames_ = 0;
    ++facts_.restarts;
  }
  CountNumber(number);
  if (number > highest_) {
    highest_ = number;
    highest_arrival_ns_ = frame.arrival_ns;
  }
  return number;
}

/// A frame that comes after all is not lost, as far as it is remembered.
void FrameArrivals::CountNumber(std::int64_t number) {
  if (number < 0) {
    ++facts_.out_of_order;
    return;
  }
  std::int64_t& seen = seen_[static_cast<std::size_t>(number) % kRemembered];
  if (number > highest_) {
    const std::int64_t lost = number - highest_ - 1;
    facts_.lost += lost;
    facts_.longest_loss = std::max(facts_.longest_loss, lost);
    if (lost > 0) {
      ++losses_[static_cast<std::size_t>(std::min<std::int64_t>(lost, kRemembered))];
    }
  } else if (seen == number) {
    ++facts_.repeated;
  } else {
    ++facts_.out_of_order;
    if (highest_ - number < static_cast<std::int64_t>(kRemembered)) --facts_.lost;
  }
  seen = number;
}

double FrameArrivals::StampOf(const DeviceFrame& frame, bool is_restart) {
  if (!frame.sender_time_ns) return 1e-9 * static_cast<double>(frame.arrival_ns);
  facts_.has_sender_times = true;
  std::int64_t transit_ns =
      Difference(frame.arrival_ns, Sum(*frame.sender_time_ns, clock_offset_ns_));
  if (is_restart) {  // a new clock: its first frame took as long as the last one before
    clock_offset_ns_ = Sum(clock_offset_ns_, Difference(transit_ns, transit_ns_));
    transit_ns = transit_ns_;
  }
  transit_ns_ = transit_ns;
  if (!least_transit_ns_ || transit_ns < *least_transit_ns_) least_transit_ns_ = transit_ns;
  const std::int64_t relative_ns = Difference(transit_ns, *least_transit_ns_);
  facts_.relative_delay.Add(relative_ns);
  trend_.Add(frame.arrival_ns, 1e-6 * static_cast<double>(relative_ns));
  return 1e-9 * static_cast<double>(Sum(*frame.sender_time_ns, clock_offset_ns_));
}

ArrivalFacts FrameArrivals::Facts() const {
  ArrivalFacts facts = facts_;
  facts.relative_delay_ms = trend_.trend();
  std::int64_t bursts = 0;
  for (const std::int64_t count : losses_) bursts += count;
  std::int64_t seen = 0;
  for (std::size_t length = 1; length < losses_.size() && bursts > 0; ++length) {
    seen += losses_[length];
    if (100 * seen >= 99 * bursts) {
      facts.p99_loss = static_cast<std::int64_t>(length);
      break;
    }
  }
  return facts;
}

}  // namespace gauntlet::sim
