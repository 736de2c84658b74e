#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "controller/timing.h"
#include "sim/trial/link/frame_draws.h"
#include "sim/trial/link/frame_pool.h"
#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {

/// Between which ends a link is. Shapes: `values` per frame. Units: ticks.
struct LinkEnds {
  std::string_view name;  // of its random numbers: "glove", "hand"
  int values = 0;
  double period_ticks = 1.0;       // of the sender's frames
  int fixed_delay_ticks = 0;       // in addition to the delay that is drawn
  std::size_t waiting_frames = 1;  // that wait while the link is occupied; a newer one replaces the
                                   // last if there is room for one alone, else it is lost
};

/// The simulated way of frames: when a frame that is sent arrives, or that it never does.
///
///     start    = sent, or when the frame before has left the link (frame_ms)
///     arrival  = start + fixed delay + drawn delay;   with batches up to the next interval
///     and not before the frame sent before
///
/// A frame arrives at the first tick at or after its arrival. Its fate is drawn when it is sent, so
/// receivers of all kinds meet the same link. Neither Send() nor Deliver() throws or allocates.
class Transport {
 public:
  /// Errors: SettingError of the distribution of the delay.
  Transport(const TransportConfig& config, const LinkEnds& ends, const controller::Timing& timing,
            std::uint64_t seed);

  /// At most one frame per tick; ticks grow.
  void Send(std::int64_t tick, std::int64_t origin_tick, std::span<const double> values) noexcept;

  /// Calls receive(frame) for each frame that arrives at this tick. To be called at every tick,
  /// after Send().
  template <class Receive>
  void Deliver(std::int64_t tick, const Receive& receive) noexcept {
    StartWaiting(tick);
    while (flight_count_ > 0 && flights_[first_flight_].arrival_tick <= tick) {
      const int place = flights_[first_flight_].place;
      first_flight_ = (first_flight_ + 1) % flights_.size();
      --flight_count_;
      receive(pool_.At(place));
      pool_.Release(place);
    }
  }

  /// Nothing on its way, and the random numbers from their beginning.
  void Reset();

  std::int64_t lost_frames() const noexcept { return lost_frames_; }

 private:
  struct Flight {
    std::int64_t arrival_tick = 0;
    int place = 0;
  };
  struct Waiting {
    double sent_tick = 0.0;
    double delay_ticks = 0.0;
    int place = 0;
  };

  void StartWaiting(std::int64_t tick) noexcept;
  void Start(double start_tick, double delay_ticks, int place) noexcept;
  void Lose(int place) noexcept;

  TransportConfig config_;
  controller::Timing timing_;
  int fixed_delay_ticks_;
  std::size_t waiting_frames_;
  std::uint64_t seed_;
  std::string_view name_;
  double frame_ticks_;
  double batch_ticks_;
  double batch_phase_ticks_ = 0.0;
  DelayDraw delay_;
  LossDraw loss_;
  FramePool pool_;
  std::vector<Flight> flights_;  // a ring, in order
  std::size_t first_flight_ = 0;
  std::size_t flight_count_ = 0;
  std::vector<Waiting> waiting_;  // in order
  double free_tick_ = 0.0;        // when the link is free again
  double last_arrival_ = 0.0;     // of the frames that have started
  std::int64_t next_number_ = 0;
  std::int64_t lost_frames_ = 0;
};

}  // namespace gauntlet::sim
