#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "sim/tables/damaged_file.h"

namespace gauntlet::sim {

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
  std::uint64_t Varint();  // little-endian groups of seven bits
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

}  // namespace gauntlet::sim
