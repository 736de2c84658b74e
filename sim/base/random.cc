#include "sim/base/random.h"

#include "sim/base/hash.h"

namespace gauntlet::sim {
namespace {

std::uint64_t SplitMix64(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15u;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view purpose, std::uint64_t index) {
  Hash name;
  name.Add(purpose);
  std::uint64_t mixer = seed;
  mixer = SplitMix64(mixer) ^ name.value();
  mixer = SplitMix64(mixer) ^ index;
  for (std::uint64_t& word : state_) word = SplitMix64(mixer);
}

}  // namespace gauntlet::sim
