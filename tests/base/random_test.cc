#include "sim/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace gauntlet::sim {
namespace {

constexpr int kDraws = 1'000'000;

TEST(RandomStream, IsFixedBySeedPurposeAndIndex) {
  RandomStream stream(1, "noise", 2), same(1, "noise", 2);
  std::set<std::uint64_t> firsts;
  for (int i = 0; i < 100; ++i) EXPECT_EQ(stream.Bits(), same.Bits());
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (const char* purpose : {"noise", "motion", "fault"}) {
      for (std::uint64_t index = 0; index < 10; ++index) {
        firsts.insert(RandomStream(seed, purpose, index).Bits());
      }
    }
  }
  EXPECT_EQ(firsts.size(), 300u);
}

TEST(RandomStream, IsXoshiro256PlusPlusSeededBySplitMix64) {
  // The same two published algorithms, written down again from their papers.
  const auto split_mix = [](std::uint64_t& state) {
    std::uint64_t z = (state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  };
  // The first output of SplitMix64 from 1234567, as its author's test gives it.
  std::uint64_t published = 1234567;
  EXPECT_EQ(split_mix(published), 6457827717110365317u);

  std::uint64_t hash = 0xCBF29CE484222325u;  // FNV-1a of "x"
  hash = (hash ^ 'x') * 0x100000001B3u;
  std::uint64_t mixer = 7;
  mixer = split_mix(mixer) ^ hash;
  mixer = split_mix(mixer) ^ 3;
  std::uint64_t s[4];
  for (std::uint64_t& word : s) word = split_mix(mixer);
  const auto rotate = [](std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); };
  RandomStream stream(7, "x", 3);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t expected = rotate(s[0] + s[3], 23) + s[0];
    const std::uint64_t t = s[1] << 17;
    s[2] ^= s[0], s[3] ^= s[1], s[1] ^= s[2], s[0] ^= s[3], s[2] ^= t;
    s[3] = rotate(s[3], 45);
    ASSERT_EQ(stream.Bits(), expected);
  }
}

TEST(RandomStream, UniformFillsItsIntervalEvenly) {
  RandomStream stream(3, "test");
  std::vector<int> bins(1000, 0);
  double lowest = 1.0, highest = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = stream.Uniform();
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
    ++bins[static_cast<std::size_t>(value * 1000)];
  }
  EXPECT_GE(lowest, 0.0);
  EXPECT_LT(highest, 1.0);
  double chi_square = 0.0;
  for (const int count : bins) chi_square += (count - 1000.0) * (count - 1000.0) / 1000.0;
  // 999 degrees of freedom: deviation 44.7; significance 1e-4 two-sided is 3.9 of them.
  EXPECT_NEAR(chi_square, 999.0, 3.9 * 44.7);
}

TEST(RandomStream, UniformAboveZeroMayBeGivenToALogarithm) {
  RandomStream stream(4, "test");
  for (int i = 0; i < kDraws; ++i) {
    const double value = stream.UniformAboveZero();
    ASSERT_GT(value, 0.0);
    ASSERT_LE(value, 1.0);
  }
}

TEST(RandomStream, IndexIsEvenAndInRange) {
  RandomStream stream(5, "test");
  std::vector<int> bins(7, 0);
  for (int i = 0; i < 700000; ++i) ++bins[stream.Index(7)];
  double chi_square = 0.0;
  for (const int count : bins) chi_square += (count - 1e5) * (count - 1e5) / 1e5;
  EXPECT_LT(chi_square, 27.9);  // 6 degrees of freedom, significance 1e-4
}

TEST(RandomStream, StreamsOfNeighboursAreNotCorrelated) {
  for (std::uint64_t index = 0; index < 20; ++index) {
    RandomStream a(1, "noise", index), b(1, "noise", index + 1);
    double sum = 0.0;
    for (int i = 0; i < 100000; ++i) sum += (a.Uniform() - 0.5) * (b.Uniform() - 0.5) * 12.0;
    EXPECT_LT(std::abs(sum / 100000.0), 4.4 / std::sqrt(100000.0)) << index;
  }
}

}  // namespace
}  // namespace gauntlet::sim
