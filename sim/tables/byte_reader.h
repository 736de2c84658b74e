#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "sim/base/error.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {

/// For readers of bytes, which do not know the name of their file.
[[noreturn]] inline void FailAsDamaged(const std::string& what) {
  throw UserError("is damaged: " + what);
}

/// Bytes of a file, taken from the front. Errors: UserError without a place where they end.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  std::string_view Take(std::size_t size) {
    if (size > rest_.size()) FailAsDamaged("it ends too early");
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  /// Little-endian groups of seven bits.
  std::uint64_t Varint() {
    constexpr int kBits = 64;
    std::uint64_t value = 0;
    for (int shift = 0; shift < kBits; shift += 7) {
      const auto byte = Little<std::uint8_t>();
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    FailAsDamaged("a number in it has too many digits");
  }
  template <class Number>
  Number Little() {
    Number number;
    std::memcpy(&number, Take(sizeof number).data(), sizeof number);
    return number;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

/// Value of the bits of a 16-bit floating-point number. Source: IEEE 754, binary16.
inline double ValueOfHalf(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31;
  const int fraction = bits & 1023;
  double value =
      std::ldexp(exponent == 0 ? fraction : fraction + 1024, exponent == 0 ? -24 : exponent - 25);
  if (exponent == 31) value = fraction == 0 ? HUGE_VAL : kMissing;
  return bits >> 15 != 0 ? -value : value;
}

}  // namespace gauntlet::sim
