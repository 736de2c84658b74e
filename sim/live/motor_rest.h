#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "controller/tendon_map.h"
#include "controller/timing.h"
#include "sim/trial/link/link_config.h"
#include "sim/trial/link/watchdog.h"

namespace gauntlet::sim {

/// Brings real motors to their rest positions, and back to the commands, at a limited speed: the
/// one of the hand's own watchdog, if it has one. So they also go on after a gap of the samples,
/// whatever watchdog the glove's link has. Of the control thread.
class MotorRest {
 public:
  MotorRest(const LinksConfig& links, const controller::TendonTransmission& hand,
            const controller::Timing& timing);

  /// The motors are at these counts, and follow the first frames at the limited speed.
  void Reset(std::span<const std::int32_t> counts);
  /// The frame that the motors get at this tick, in place of that of the loop: empty if none is
  /// due. `may_follow`: false turns them to rest.
  std::span<const std::int32_t> Frame(std::int64_t tick, std::span<const std::int32_t> frame,
                                      bool may_follow) noexcept;
  /// The loop has a new sample, at a time of the real clock.
  void NoteSample(std::int64_t now_ns) noexcept;
  /// A tick that was skipped.
  void Skip(bool may_follow) noexcept { watchdog_.Watch(may_follow); }

  /// The loop has had a command.
  bool has_command() const noexcept { return has_wanted_; }
  /// Times that the motors were brought to rest.
  std::int64_t rests() const noexcept { return rests_; }

 private:
  Watchdog watchdog_;
  double event_ticks_;
  std::int64_t longest_gap_ns_;  // between samples
  std::int64_t return_ticks_;
  std::int64_t sample_ns_ = 0;        // of the last sample; 0: none
  std::vector<std::int32_t> wanted_;  // last frame of the loop
  bool has_wanted_ = false;
  bool was_resting_ = false;
  std::int64_t rests_ = 0;
  std::int64_t sent_tick_ = 0;
};

}  // namespace gauntlet::sim
