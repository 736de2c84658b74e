#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// Writes an MCAP file with an index, in chunks that are compressed by zstd.
/// Source: mcap.dev/spec.
class McapWriter {
 public:
  using Write = std::function<void(std::string_view bytes)>;

  explicit McapWriter(Write write);

  /// A topic with messages of this type of ROS 2, in CDR. Returns its number.
  std::uint16_t AddTopic(std::string_view name, std::string_view type, std::string_view definition);
  void AddMessage(std::uint16_t topic, std::int64_t time_ns, std::string_view message);
  /// Writes the rest and the index. Nothing may be added afterwards.
  void Finish();

 private:
  struct ChunkPlace {
    std::int64_t first_ns = 0;
    std::int64_t last_ns = 0;
    std::uint64_t offset = 0;
    std::uint64_t length = 0;
    std::uint64_t index_length = 0;
    std::uint64_t compressed_size = 0;
    std::uint64_t size = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets;
  };

  void Put(std::string_view bytes);
  void FinishChunk();

  Write write_;
  std::uint64_t written_ = 0;
  std::vector<std::string> schemas_;  // records
  std::vector<std::string> schema_names_;
  std::vector<std::string> channels_;
  std::vector<std::uint64_t> counts_;  // of messages by channel
  std::string chunk_;
  ChunkPlace place_;  // of the chunk to come
  std::map<std::uint16_t, std::string> index_;
  std::vector<ChunkPlace> places_;
};

/// Messages of ROS 2 in CDR, little endian, as McapWriter takes them.
class CdrWriter {
 public:
  CdrWriter();
  void Time(std::int64_t ns);  // builtin_interfaces/Time
  void Text(std::string_view text);
  void Texts(const std::vector<std::string>& texts);
  void Numbers(std::span<const double> numbers);
  std::string_view message() const { return bytes_; }

 private:
  template <class Number>
  void Put(Number number);
  std::string bytes_;
};

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
