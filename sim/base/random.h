#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "controller/assert.h"

namespace gauntlet::sim {

/// A stream of random numbers, fixed by a seed, a purpose and an index (for example a channel). So
/// the order in which streams are made or read never changes their numbers.
///
/// xoshiro256++ (Blackman, Vigna 2021); SplitMix64 fills its state from the three.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view purpose, std::uint64_t index = 0);

  /// 64 independent bits.
  std::uint64_t Bits() {
    const std::uint64_t result = RotateLeft(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = RotateLeft(state_[3], 45);
    return result;
  }

  /// Uniform in [0, 1), 53 bits.
  double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1.0p-53; }
  /// Uniform in (0, 1], for logarithms.
  double UniformAboveZero() { return (static_cast<double>(Bits() >> 11) + 1.0) * 0x1.0p-53; }
  /// Uniform in [low, high).
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  /// Uniform in 0 .. count - 1, for a count far below 2^64.
  std::uint64_t Index(std::uint64_t count) {
    GAUNTLET_ASSERT(count > 0);
    return static_cast<std::uint64_t>((static_cast<Wide>(Bits()) * count) >> 64);
  }

 private:
  __extension__ using Wide = unsigned __int128;
  static std::uint64_t RotateLeft(std::uint64_t value, int shift) {
    return (value << shift) | (value >> (64 - shift));
  }
  std::array<std::uint64_t, 4> state_;
};

}  // namespace gauntlet::sim
