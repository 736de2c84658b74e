#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "controller/assert.h"

namespace gauntlet::controller {

/// Remembers which channels wait for their first sample, so that a filter can start each of them
/// there. None to begin with. Costs one comparison per step once all have started.
class FreshChannels {
 public:
  explicit FreshChannels(int channel_count) : fresh_(channel_count, 0) {}

  bool any() const noexcept { return count_ > 0; }

  void Add(int channel) noexcept {
    GAUNTLET_ASSERT(0 <= channel && channel < std::ssize(fresh_));
    std::uint8_t& fresh = fresh_[channel];
    count_ += fresh == 0;
    fresh = 1;
  }
  void AddAll() noexcept {
    std::fill(fresh_.begin(), fresh_.end(), 1);
    count_ = fresh_.size();
  }

  /// Calls start(channel, first sample) for each of them; afterwards none is left.
  template <class Start>
  void StartAll(std::span<const double> first_sample, Start start) noexcept {
    GAUNTLET_ASSERT(first_sample.size() == fresh_.size());
    for (std::size_t i = 0; i < fresh_.size(); ++i) {
      if (fresh_[i] == 1) start(i, first_sample[i]);
      fresh_[i] = 0;
    }
    count_ = 0;
  }

 private:
  std::vector<std::uint8_t> fresh_;
  int count_ = 0;
};

}  // namespace gauntlet::controller
