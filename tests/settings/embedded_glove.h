#pragma once

#include <cstdint>

namespace gauntlet::test {

/// Converters of other ranges for the same glove: 10 bits, 12 bits, and signed 16 bits with a
/// sensor that is wired the other way round, in turn. The counts are offset + factor (counts of
/// 10 bits).
constexpr std::int32_t MixedFactor(int channel) {
  return channel % 3 == 0 ? 1 : channel % 3 == 1 ? 4 : -64;
}
constexpr std::int32_t MixedOffset(int channel) { return channel % 3 == 2 ? 32704 : 0; }
template <class Scalar>
void ToMixedConverters(Scalar* counts, int channel_count) {
  for (int i = 0; i < channel_count; ++i) {
    counts[i] =
        static_cast<Scalar>(MixedOffset(i)) + static_cast<Scalar>(MixedFactor(i)) * counts[i];
  }
}

/// Whole counts of a moving, noisy glove that every machine can compute: a triangle per channel and
/// noise of 12 counts, with a value at full scale (1023) now and then, from integers alone.
class EmbeddedGlove {
 public:
  template <class Scalar>
  void Next(Scalar* counts, int channel_count) {
    ++sample_;
    for (int i = 0; i < channel_count; ++i) {
      const std::int32_t period = 1500 + 400 * i;
      const std::int32_t place = sample_ % period;
      const std::int32_t rising = place < period / 2 ? place : period - place;
      const auto noise = static_cast<std::int32_t>(Random() % 25U) - 12;
      const bool glitch = Random() % 1000U == 0U;
      counts[i] = static_cast<Scalar>(glitch ? 1023 : 300 + 800 * rising / period + noise);
    }
  }

 private:
  std::uint32_t Random() {
    random_ = random_ * 1664525U + 1013904223U;
    return random_ >> 16U;
  }
  std::int32_t sample_ = 0;
  std::uint32_t random_ = 1;
};

}  // namespace gauntlet::test
