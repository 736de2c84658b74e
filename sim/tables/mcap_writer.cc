#include "sim/tables/mcap_writer.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "controller/assert.h"
#include "sim/base/error.h"
#include "sim/tables/checksum.h"

namespace gauntlet::sim {
namespace {

/// Little-endian bytes of a number.
template <class Number>
std::string Little(Number number) {
  static_assert(std::endian::native == std::endian::little);
  const auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  return {bytes.data(), bytes.size()};
}

std::string McapText(std::string_view text) {
  return Little(static_cast<std::uint32_t>(text.size())) + std::string(text);
}

std::string Record(McapOpcode opcode, std::string_view content) {
  return static_cast<char>(opcode) + Little(std::uint64_t{content.size()}) + std::string(content);
}

std::string EntriesOf(const std::map<std::uint16_t, std::uint64_t>& numbers) {
  std::string entries;
  for (const auto& [channel, number] : numbers) entries += Little(channel) + Little(number);
  return McapText(entries);
}

}  // namespace

McapWriter::McapWriter(Write write) : write_(std::move(write)) {
  Put(kMcapMagic);
  Put(Record(McapOpcode::kHeader, McapText("ros2") + McapText("gauntlet")));
}

std::uint16_t McapWriter::AddTopic(std::string_view name, std::string_view type,
                                   std::string_view definition) {
  GAUNTLET_ASSERT(counts_.size() < 65535);
  auto known = std::ranges::find(schema_names_, type);
  const auto schema = static_cast<std::uint16_t>(known - schema_names_.begin() + 1);
  if (known == schema_names_.end()) {
    schema_names_.emplace_back(type);
    schemas_.push_back(Record(McapOpcode::kSchema, Little(schema) + McapText(type) +
                                                       McapText("ros2msg") + McapText(definition)));
    chunk_ += schemas_.back();
  }
  const auto channel = static_cast<std::uint16_t>(counts_.size());
  channels_.push_back(
      Record(McapOpcode::kChannel,
             Little(channel) + Little(schema) + McapText(name) + McapText("cdr") + McapText("")));
  chunk_ += channels_.back();
  counts_.push_back(0);
  return channel;
}

void McapWriter::AddMessage(std::uint16_t topic, std::int64_t time_ns, std::string_view message) {
  constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
  if (index_.empty()) place_.first_ns = place_.last_ns = time_ns;
  place_.first_ns = std::min(place_.first_ns, time_ns);
  place_.last_ns = std::max(place_.last_ns, time_ns);
  index_[topic] += Little(time_ns) + Little(std::uint64_t{chunk_.size()});
  const auto number = static_cast<std::uint32_t>(counts_[topic]++);
  chunk_ += Record(McapOpcode::kMessage, Little(topic) + Little(number) + Little(time_ns) +
                                             Little(time_ns) + std::string(message));
  if (chunk_.size() >= kChunkBytes) FinishChunk();
}

void McapWriter::Finish() {
  FinishChunk();
  Put(Record(McapOpcode::kDataEnd, Little(std::uint32_t{0})));
  const std::uint64_t summary_at = written_;
  std::string summary;
  for (const std::string& record : schemas_) summary += record;
  for (const std::string& record : channels_) summary += record;
  std::uint64_t messages = 0;
  std::int64_t first_ns = 0, last_ns = 0;
  for (const ChunkPlace& place : places_) {
    if (!place.index_offsets.empty()) {
      first_ns = messages == 0 ? place.first_ns : std::min(first_ns, place.first_ns);
      last_ns = messages == 0 ? place.last_ns : std::max(last_ns, place.last_ns);
      messages = 1;
    }
    summary += Record(McapOpcode::kChunkIndex,
                      Little(place.first_ns) + Little(place.last_ns) + Little(place.offset) +
                          Little(place.length) + EntriesOf(place.index_offsets) +
                          Little(place.index_length) + McapText("zstd") +
                          Little(place.compressed_size) + Little(place.size));
  }
  messages = 0;
  std::map<std::uint16_t, std::uint64_t> counts;
  for (std::size_t c = 0; c < counts_.size(); ++c) {
    messages += counts_[c];
    counts[static_cast<std::uint16_t>(c)] = counts_[c];
  }
  summary +=
      Record(McapOpcode::kStatistics,
             Little(messages) + Little(static_cast<std::uint16_t>(schemas_.size())) +
                 Little(static_cast<std::uint32_t>(channels_.size())) + Little(std::uint32_t{0}) +
                 Little(std::uint32_t{0}) + Little(static_cast<std::uint32_t>(places_.size())) +
                 Little(first_ns) + Little(last_ns) + EntriesOf(counts));
  // The checksum is that of all bytes from the summary up to itself.
  summary += static_cast<char>(McapOpcode::kFooter) + Little(kMcapFooterBytes) +
             Little(summary_at) + Little(std::uint64_t{0});
  Put(summary + Little(Crc32Of(summary)));
  Put(kMcapMagic);
}

void McapWriter::Put(std::string_view bytes) {
  write_(bytes);
  written_ += bytes.size();
}

void McapWriter::FinishChunk() {
  if (chunk_.empty()) return;
  std::string stored(ZSTD_compressBound(chunk_.size()), '\0');
  constexpr int kFast = 1;
  const std::size_t size =
      ZSTD_compress(stored.data(), stored.size(), chunk_.data(), chunk_.size(), kFast);
  if (ZSTD_isError(size) != 0) throw RunError("zstd cannot compress");
  stored.resize(size);
  place_.offset = written_;
  place_.size = chunk_.size();
  place_.compressed_size = size;
  Put(Record(McapOpcode::kChunk, Little(place_.first_ns) + Little(place_.last_ns) +
                                     Little(place_.size) + Little(Crc32Of(chunk_)) +
                                     McapText("zstd") + Little(place_.compressed_size) + stored));
  place_.length = written_ - place_.offset;
  for (const auto& [channel, entries] : index_) {
    place_.index_offsets[channel] = written_;
    Put(Record(McapOpcode::kMessageIndex, Little(channel) + McapText(entries)));
  }
  place_.index_length = written_ - place_.offset - place_.length;
  places_.push_back(std::exchange(place_, {}));
  chunk_.clear();
  index_.clear();
}

CdrWriter::CdrWriter() : bytes_("\0\1\0\0", 4) {}

template <class Number>
void CdrWriter::Put(Number number) {
  constexpr std::size_t kHead = 4;
  while ((bytes_.size() - kHead) % sizeof(Number) != 0) bytes_.push_back('\0');
  bytes_ += Little(number);
}

void CdrWriter::Time(std::int64_t ns) {
  constexpr std::int64_t kSecond = 1000000000;
  Put(static_cast<std::int32_t>(ns / kSecond));
  Put(static_cast<std::uint32_t>(ns % kSecond));
}

void CdrWriter::Text(std::string_view text) {
  Put(static_cast<std::uint32_t>(text.size() + 1));
  bytes_.append(text).push_back('\0');
}

void CdrWriter::Texts(const std::vector<std::string>& texts) {
  Put(static_cast<std::uint32_t>(texts.size()));
  for (const std::string& text : texts) Text(text);
}

void CdrWriter::Numbers(std::span<const double> numbers) {
  Put(static_cast<std::uint32_t>(numbers.size()));
  for (const double number : numbers) Put(number);
}

}  // namespace gauntlet::sim
