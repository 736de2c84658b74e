#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/live/device/frame.h"
#include "sim/live/duration_histogram.h"
#include "sim/live/trend.h"

namespace gauntlet::sim {

/// Facts about the frames of a source. Counts of numbers are of frames that have one.
struct ArrivalFacts {
  std::int64_t frames = 0;
  std::int64_t different = 0;     // whose values are not those of the frame before
  std::int64_t repeated = 0;      // number that came already
  std::int64_t out_of_order = 0;  // number below that of an earlier frame
  std::int64_t lost = 0;          // numbers that never came
  std::int64_t longest_loss = 0;  // of them in a row
  std::int64_t p99_loss = 0;      // of the losses, in frames in a row
  std::int64_t restarts = 0;      // of the sender's numbers
  std::int64_t silences = 0;      // of a quarter of a second or more, and far above the usual gap
  std::int64_t silence_ns = 0;    // of all of them
  std::int64_t lost_in_silences = 0;
  std::int64_t waited = 0;         // different or lost ones before the time of the next
  std::int64_t rate_from_ns = -1;  // -1: from the first frame on
  bool has_numbers = false;
  bool has_sender_times = false;
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  DurationHistogram gaps;            // between arrivals
  DurationHistogram relative_delay;  // arrival - sender's time, above the least so far
  Trend relative_delay_ms;           // over the time of arrival [min]

  double duration_s() const { return 1e-9 * static_cast<double>(last_ns - first_ns); }
  double PerSecond(std::int64_t count) const;
  /// Rate of the device, with what was lost, without what it repeated and its silences; NaN: none.
  double Rate_hz() const;
};

/// Numbers the frames of a source for a receiver, and counts what happened to them on their way.
///
/// Numbers that go back and stay there are those of a sender that started anew: the fifth rising
/// one, if nothing new came for 50 ms, goes on behind the last. Without numbers frames are numbered
/// in the order of arrival; then repeated or reordered ones are unknown.
class FrameArrivals {
 public:
  struct Numbered {
    std::int64_t number = 0;  // from 0; that of the sender, continued over restarts
    double stamp_s = 0.0;     // by the sender's clock, without one the arrival; of any origin
  };

  Numbered Add(const DeviceFrame& frame);
  /// Frames up to now had waited: their arrivals tell nothing of the device's rate.
  void BeginRate();
  /// Facts of the frames so far.
  ArrivalFacts Facts() const;

 private:
  bool IsSilence(std::int64_t gap_ns) const;
  std::int64_t NumberOf(const DeviceFrame& frame);
  void CountNumber(std::int64_t number);
  double StampOf(const DeviceFrame& frame, bool is_restart);

  static constexpr std::size_t kRemembered = 4096;

  ArrivalFacts facts_;
  std::vector<double> last_values_;
  std::vector<std::int64_t> seen_ = std::vector<std::int64_t>(kRemembered, -1);
  std::vector<std::int64_t> losses_ = std::vector<std::int64_t>(kRemembered + 1);  // by length
  bool rate_begins_ = false;  // with the next frame
  std::optional<std::int64_t> first_number_;
  std::int64_t offset_ = 0;
  std::int64_t highest_ = -1;
  std::int64_t highest_arrival_ns_ = 0;
  std::int64_t stale_number_ = 0;
  int stale_frames_ = 0;
  std::optional<std::int64_t> least_transit_ns_;
  std::int64_t transit_ns_ = 0;
  std::int64_t clock_offset_ns_ = 0;
  TrendOfSeconds trend_;
};

}  // namespace gauntlet::sim
