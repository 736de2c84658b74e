#pragma once

#include <cstdint>
#include <string_view>

namespace gauntlet::sim {

/// Facts of MCAP that its reader and its writer share. A record is an opcode (u8), a length (u64)
/// and as many bytes, all little endian. Source: mcap.dev/spec.
inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::uint64_t kMcapHeadBytes = 9;  // opcode and length
inline constexpr std::uint64_t kMcapFooterBytes = 20;

enum class McapOpcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kDataEnd = 0x0F,
};

}  // namespace gauntlet::sim
