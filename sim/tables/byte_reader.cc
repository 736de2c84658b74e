#include "sim/tables/byte_reader.h"

namespace gauntlet::sim {

std::uint64_t ByteReader::Varint() {
  constexpr int kBits = 64;
  std::uint64_t value = 0;
  for (int shift = 0; shift < kBits; shift += 7) {
    const auto byte = Little<std::uint8_t>();
    value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
    if (byte < 0x80) return value;
  }
  FailAsDamaged("a number in it has too many digits");
}

}  // namespace gauntlet::sim
