#pragma once

#include <zlib.h>

#include <cstdint>
#include <string_view>

namespace gauntlet::sim {

/// CRC-32 as gzip, MCAP and Parquet have it, of bytes behind those with the sum `before`.
inline std::uint32_t Crc32Of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace gauntlet::sim
