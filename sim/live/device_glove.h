#pragma once

#include <atomic>
#include <exception>
#include <stop_token>
#include <string>
#include <thread>

#include "sim/live/frame_arrivals.h"
#include "sim/live/frame_channels.h"
#include "sim/live/grid_follower.h"
#include "sim/live/live_glove.h"
#include "sim/live/row_ring.h"

namespace gauntlet::sim {

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
  void AcceptFrame(const Head& head, std::span<const double> counts, const LiveTick& tick,
                   HandLoop& loop) noexcept;
  void FollowGlove(HandLoop& loop) noexcept;
  void Read(const std::stop_token& stop);
  bool MayGetNames(std::int64_t arrival_ns);

  const LiveSetup& setup_;
  const controller::Timing& timing_;
  std::string source_;
  RowRing<Head> frames_;
  std::atomic<bool> has_ended_ = false;

  // Of the control thread.
  Head first_;
  std::vector<double> first_counts_;
  bool has_first_ = false;          // waits for the first tick, outside the ring
  std::vector<SampleTimes> times_;  // of the last frames, by number
  std::int64_t step_begin_ns_ = 0;
  std::int64_t logged_number_ = -1;
  GridFollower grid_;
  std::int64_t grid_phase_ = 0;  // ticks by which the sampling grid was shifted
  std::int64_t grid_shifts_ = 0;
  std::int64_t most_waiting_ = 0;

  // Of the thread that reads.
  FrameChannels channels_;
  FrameArrivals arrivals_;
  std::int64_t first_arrival_ns_ = 0;
  std::int64_t overruns_ = 0;
  std::exception_ptr error_;  // before has_ended_
  std::jthread thread_;       // last: it ends before what it uses
};

}  // namespace gauntlet::sim
