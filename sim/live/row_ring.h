#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <span>
#include <vector>

#include "controller/assert.h"

namespace gauntlet::sim {

/// Rows from one thread to another, in order: one thread pushes, one pops. Neither waits for the
/// other, takes a lock or allocates. A row is a head, which is plain data, and `width` values.
template <class Head>
class RowRing {
 public:
  RowRing(std::size_t rows, std::size_t width)
      : width_(width),
        mask_(std::bit_ceil(rows) - 1),
        heads_(mask_ + 1),
        values_(heads_.size() * width) {}

  std::size_t width() const noexcept { return width_; }

  /// False if the ring is full: the row is left out.
  bool Push(const Head& head, std::span<const double> values) noexcept {
    GAUNTLET_ASSERT(values.size() == width_);
    const std::size_t pushed = pushed_.load(std::memory_order_relaxed);
    if (pushed - popped_.load(std::memory_order_acquire) > mask_) return false;
    const std::size_t place = pushed & mask_;
    heads_[place] = head;
    for (std::size_t i = 0; i < width_; ++i) values_[place * width_ + i] = values[i];
    pushed_.store(pushed + 1, std::memory_order_release);
    return true;
  }

  /// Calls use(head, values) for the oldest row, if there is one.
  template <class Use>
  bool Pop(const Use& use) {
    const std::size_t popped = popped_.load(std::memory_order_relaxed);
    if (popped == pushed_.load(std::memory_order_acquire)) return false;
    const std::size_t place = popped & mask_;
    use(heads_[place], std::span<const double>(values_).subspan(place * width_, width_));
    popped_.store(popped + 1, std::memory_order_release);
    return true;
  }

  /// Rows that wait. Exact for the thread that pops.
  std::size_t waiting() const noexcept {
    return pushed_.load(std::memory_order_acquire) - popped_.load(std::memory_order_acquire);
  }

 private:
  static constexpr std::size_t kCacheLine = 64;

  std::size_t width_;
  std::size_t mask_;
  std::vector<Head> heads_;
  std::vector<double> values_;
  alignas(kCacheLine) std::atomic<std::size_t> pushed_ = 0;
  alignas(kCacheLine) std::atomic<std::size_t> popped_ = 0;
};

}  // namespace gauntlet::sim
