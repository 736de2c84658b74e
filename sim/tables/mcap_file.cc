#include <fmt/format.h>
#include <lz4frame.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "sim/tables/byte_reader.h"
#include "sim/tables/checksum.h"
#include "sim/tables/mcap_writer.h"
#include "sim/tables/message_file.h"

namespace gauntlet::sim {
namespace {

using enum McapOpcode;

constexpr std::uint64_t kMostRecordBytes = std::uint64_t{1} << 28;

std::string_view TakeText(ByteReader& bytes) { return bytes.Take(bytes.Little<std::uint32_t>()); }

/// Parts of a file through a window that moves forward.
class FileWindow {
 public:
  explicit FileWindow(const std::filesystem::path& path)
      : file_(std::fopen(InputFile(path).c_str(), "rb"), &std::fclose) {
    if (file_ == nullptr) throw UserError("cannot be opened");
    std::fseek(file_.get(), 0, SEEK_END);
    size_ = static_cast<std::uint64_t>(std::max(std::ftell(file_.get()), 0L));
  }

  /// A window over all bytes.
  explicit FileWindow(std::string bytes)
      : file_(nullptr, &std::fclose), size_(bytes.size()), bytes_(std::move(bytes)) {}

  std::uint64_t size() const { return size_; }
  bool Has(std::uint64_t offset, std::uint64_t size) const {
    return offset <= size_ && size <= size_ - offset;
  }
  /// Valid until the next call. Errors: UserError beyond the end.
  std::string_view At(std::uint64_t offset, std::uint64_t size) {
    if (!Has(offset, size) || size > kMostRecordBytes) FailAsDamaged("it ends too early");
    const bool is_inside = offset >= begin_ && offset - begin_ <= bytes_.size() &&
                           size <= bytes_.size() - static_cast<std::size_t>(offset - begin_);
    if (!is_inside) Fill(offset, size);
    return std::string_view(bytes_).substr(static_cast<std::size_t>(offset - begin_),
                                           static_cast<std::size_t>(size));
  }

 private:
  void Fill(std::uint64_t offset, std::uint64_t size) {
    constexpr std::uint64_t kWindowBytes = std::uint64_t{1} << 18;
    bytes_.resize(static_cast<std::size_t>(std::min(std::max(size, kWindowBytes), size_ - offset)));
    begin_ = offset;
    for (std::size_t got = 0; got < bytes_.size();) {
      const ssize_t more = pread(fileno(file_.get()), bytes_.data() + got, bytes_.size() - got,
                                 static_cast<off_t>(offset + got));
      if (more <= 0) throw UserError("cannot be read to its end");
      got += static_cast<std::size_t>(more);
    }
  }

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::uint64_t size_ = 0;
  std::string bytes_;
  std::uint64_t begin_ = 0;
};

/// Errors: UserError unless there are as many bytes as `text` has room for.
void ExpandLz4(std::string_view bytes, std::string& text) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) {
    throw UserError("lz4 cannot begin");
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(
      context, &LZ4F_freeDecompressionContext);
  std::size_t from = 0, to = 0, hint = 1;
  while (hint != 0) {
    std::size_t taken = bytes.size() - from;
    std::size_t given = text.size() - to;
    hint = LZ4F_decompress(context, text.data() + to, &given, bytes.data() + from, &taken, nullptr);
    from += taken;
    to += given;
    if (LZ4F_isError(hint) != 0 || (taken == 0 && given == 0 && hint != 0)) {
      FailAsDamaged("a chunk is not whole");
    }
  }
  if (to != text.size() || from != bytes.size()) {
    FailAsDamaged("a chunk has another size than it says");
  }
}

/// Records of a chunk, and what it says of them.
struct Chunk {
  std::string_view compression;
  std::uint64_t size = 0;
  std::uint32_t crc = 0;
  std::string_view stored;
};

Chunk ChunkIn(std::string_view content) {
  ByteReader bytes(content);
  bytes.Take(16);  // times of the first and the last message
  Chunk chunk;
  chunk.size = bytes.Little<std::uint64_t>();
  chunk.crc = bytes.Little<std::uint32_t>();
  chunk.compression = TakeText(bytes);
  chunk.stored = bytes.Take(static_cast<std::size_t>(bytes.Little<std::uint64_t>()));
  if (chunk.size > kMostRecordBytes) {
    throw UserError(fmt::format("has a chunk of {} MB, must be at most {}", chunk.size >> 20,
                                kMostRecordBytes >> 20));
  }
  return chunk;
}

/// The records in a chunk; `room` keeps them.
std::string_view RecordsOf(const Chunk& chunk, std::string& room) {
  const auto size = static_cast<std::size_t>(chunk.size);
  std::string_view records = chunk.stored;
  if (!chunk.compression.empty()) {
    room.resize(size);
    if (chunk.compression == "lz4") {
      ExpandLz4(chunk.stored, room);
    } else if (chunk.compression == "zstd") {
      const std::size_t found =
          ZSTD_decompress(room.data(), size, chunk.stored.data(), chunk.stored.size());
      if (ZSTD_isError(found) != 0 || found != size) FailAsDamaged("a chunk is not whole");
    } else {
      throw UserError(
          fmt::format("is compressed by {}, which is not read; write it with lz4 or zstd",
                      Shown(chunk.compression)));
    }
    records = room;
  }
  if (records.size() != size) FailAsDamaged("a chunk has another size than it says");
  if (chunk.crc != 0 && Crc32Of(records) != chunk.crc) {
    FailAsDamaged("a chunk does not have its checksum");
  }
  return records;
}

/// Place of a chunk, and the channels that have messages in it.
struct ChunkPlace {
  std::uint64_t first_ns = 0;
  std::uint64_t last_ns = 0;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::map<std::uint16_t, std::uint64_t> index_offsets;  // of message indexes, by channel
};

class McapFile : public MessageFile {
 public:
  explicit McapFile(FileWindow file) : file_(std::move(file)) {
    if (file_.size() < kMcapMagic.size() || file_.At(0, kMcapMagic.size()) != kMcapMagic) {
      FailAsDamaged("it does not begin as MCAP");
    }
    if (!ReadSummary()) {
      topics_.clear();
      by_name_.clear();
      channels_.clear();
      schemas_.clear();
      chunks_.clear();
      Scan();
    }
  }

  void ForEachMessage(std::size_t topic, const Visit& visit) override {
    std::uint64_t messages = 0;
    const auto take = [&](std::uint16_t channel, std::uint64_t log_ns, std::string_view data) {
      const auto found = channels_.find(channel);
      if (found == channels_.end() || found->second != topic) return;
      ++messages;
      visit(static_cast<std::int64_t>(log_ns), data);
    };
    if (chunks_.empty()) {
      Walk(take);
    } else {
      for (const ChunkPlace& place : chunks_) {
        if (MayHave(place, topic)) WalkChunk(ContentOf(place), take);
      }
    }
    if (messages != topics_[topic].messages) {
      FailAsDamaged(fmt::format("its index counts {} messages of {}, it has {}",
                                topics_[topic].messages, OneLine(topics_[topic].name, 60),
                                messages));
    }
  }

 private:
  struct Schema {
    std::string name;
    std::string encoding;
    std::string data;
  };

  void AddSchema(ByteReader bytes) {
    const auto id = bytes.Little<std::uint16_t>();
    Schema schema;
    schema.name = TakeText(bytes);
    schema.encoding = TakeText(bytes);
    schema.data = TakeText(bytes);
    schemas_.try_emplace(id, std::move(schema));
  }

  void AddChannel(ByteReader bytes) {
    const auto id = bytes.Little<std::uint16_t>();
    if (channels_.contains(id)) return;
    const auto schema_id = bytes.Little<std::uint16_t>();
    Topic topic;
    topic.name = TakeText(bytes);
    topic.encoding = TakeText(bytes);
    if (const auto schema = schemas_.find(schema_id); schema != schemas_.end()) {
      topic.type = schema->second.name;
      topic.schema_encoding = schema->second.encoding;
      topic.schema = schema->second.data;
    } else if (schema_id != 0) {
      FailAsDamaged(fmt::format("the schema of {} is missing", OneLine(topic.name, 60)));
    }
    const auto [place, is_new] = by_name_.try_emplace(topic.name, topics_.size());
    channels_[id] = place->second;
    if (is_new) {
      topics_.push_back(std::move(topic));
    } else if (Topic* const known = &topics_[place->second]; known->type != topic.type ||
                                                             known->encoding != topic.encoding ||
                                                             known->schema != topic.schema) {
      known->problem = "its messages are of several types";
    }
  }

  /// Messages of channels in records of the data section or of a chunk.
  template <class Take>
  void ReadRecord(McapOpcode opcode, std::string_view content, const Take& take) {
    ByteReader bytes(content);
    if (opcode == kSchema) AddSchema(bytes);
    if (opcode == kChannel) AddChannel(bytes);
    if (opcode != kMessage) return;
    const auto channel = bytes.Little<std::uint16_t>();
    bytes.Take(4);  // its number
    const auto log_ns = bytes.Little<std::uint64_t>();
    bytes.Take(8);  // when it was published
    take(channel, log_ns, bytes.rest());
  }

  template <class Take>
  void WalkChunk(std::string_view content, const Take& take) {
    ByteReader records(RecordsOf(ChunkIn(content), room_));
    while (!records.rest().empty()) {
      const auto opcode = records.Little<McapOpcode>();
      const auto length = records.Little<std::uint64_t>();
      ReadRecord(opcode, records.Take(static_cast<std::size_t>(length)), take);
    }
  }

  /// All records of the data section. Sets is_cut_ where the file ends within them.
  template <class Take>
  void Walk(const Take& take) {
    const bool has_end =
        file_.size() >= 2 * kMcapMagic.size() &&
        file_.At(file_.size() - kMcapMagic.size(), kMcapMagic.size()) == kMcapMagic;
    for (std::uint64_t at = kMcapMagic.size();;) {
      if (!file_.Has(at, kMcapHeadBytes)) break;
      ByteReader head(file_.At(at, kMcapHeadBytes));
      const auto opcode = head.Little<McapOpcode>();
      const auto length = head.Little<std::uint64_t>();
      if (!file_.Has(at + kMcapHeadBytes, length)) break;
      if (opcode == kDataEnd || opcode == kFooter) {
        if (opcode == kDataEnd) CheckData(at, length);
        return;
      }
      if (opcode == kChunk || opcode == kMessage || opcode == kSchema || opcode == kChannel) {
        if (length > kMostRecordBytes) {
          throw UserError(fmt::format("has a record of {} MB, must be at most {}", length >> 20,
                                      kMostRecordBytes >> 20));
        }
        const std::string_view content = file_.At(at + kMcapHeadBytes, length);
        if (opcode == kChunk) {
          has_chunks_ = true;
          WalkChunk(content, take);
        } else {
          ReadRecord(opcode, content, take);
        }
      }
      at += kMcapHeadBytes + length;
    }
    if (has_end) FailAsDamaged("a record is longer than the file");
    is_cut_ = true;
  }

  /// Chunks have checksums of their own.
  void CheckData(std::uint64_t end, std::uint64_t length) {
    if (has_chunks_ || was_checked_ || length < 4) return;
    was_checked_ = true;
    const auto crc = ByteReader(file_.At(end + kMcapHeadBytes, 4)).Little<std::uint32_t>();
    if (crc == 0) return;
    constexpr std::uint64_t kBlock = std::uint64_t{1} << 18;
    std::uint32_t found = 0;
    for (std::uint64_t at = 0; at < end; at += kBlock) {
      found = Crc32Of(file_.At(at, std::min(kBlock, end - at)), found);
    }
    if (found != crc) FailAsDamaged("it does not have its checksum");
  }

  /// Finds the topics of a file without an index.
  void Scan() {
    Walk([this](std::uint16_t channel, std::uint64_t log_ns, std::string_view) {
      const auto found = channels_.find(channel);
      if (found == channels_.end()) FailAsDamaged("a message has an unknown channel");
      Count(topics_[found->second], static_cast<std::int64_t>(log_ns));
    });
  }

  static void Count(Topic& topic, std::int64_t log_ns) {
    topic.first_ns = topic.messages == 0 ? log_ns : std::min(topic.first_ns, log_ns);
    topic.last_ns = topic.messages == 0 ? log_ns : std::max(topic.last_ns, log_ns);
    ++topic.messages;
  }

  bool MayHave(const ChunkPlace& place, std::size_t topic) const {
    // A chunk without message indexes may have messages of every channel.
    return place.index_offsets.empty() ||
           std::ranges::any_of(place.index_offsets, [&](const auto& entry) {
             const auto found = channels_.find(entry.first);
             return found != channels_.end() && found->second == topic;
           });
  }

  std::string_view ContentOf(const ChunkPlace& place) {
    ByteReader head(file_.At(place.offset, kMcapHeadBytes));
    const auto opcode = head.Little<McapOpcode>();
    const auto length = head.Little<std::uint64_t>();
    if (opcode != kChunk || length + kMcapHeadBytes != place.length) {
      FailAsDamaged("its index names a chunk that is not there");
    }
    return file_.At(place.offset + kMcapHeadBytes, length);
  }

  /// Topics and chunks by the summary at the end. False without one, or if it is not complete.
  bool ReadSummary() {
    const std::uint64_t tail = kMcapHeadBytes + kMcapFooterBytes + kMcapMagic.size();
    if (file_.size() < kMcapMagic.size() + tail) return false;
    const std::uint64_t footer_at = file_.size() - tail;
    ByteReader footer(file_.At(footer_at, tail));
    if (footer.Little<McapOpcode>() != kFooter ||
        footer.Little<std::uint64_t>() != kMcapFooterBytes) {
      return false;
    }
    const auto begin = footer.Little<std::uint64_t>();
    footer.Take(8);  // begin of the summary offsets
    const auto crc = footer.Little<std::uint32_t>();
    if (footer.rest() != kMcapMagic || begin < kMcapMagic.size() || begin >= footer_at ||
        footer_at - begin > kMostRecordBytes) {
      return false;
    }
    // From the summary up to the checksum in the footer.
    const std::string summary(file_.At(begin, file_.size() - kMcapMagic.size() - 4 - begin));
    if (crc != 0 && Crc32Of(summary) != crc)
      FailAsDamaged("its summary does not have its checksum");
    return ReadSummaryRecords(std::string_view(summary).substr(0, footer_at - begin)) &&
           FindTimes();
  }

  bool ReadSummaryRecords(std::string_view summary) {
    std::map<std::uint16_t, std::uint64_t> counts;
    std::optional<std::uint32_t> chunk_count;
    ByteReader records(summary);
    while (!records.rest().empty()) {
      const auto opcode = records.Little<McapOpcode>();
      ByteReader bytes(records.Take(static_cast<std::size_t>(records.Little<std::uint64_t>())));
      if (opcode == kSchema) AddSchema(bytes);
      if (opcode == kChannel) AddChannel(bytes);
      if (opcode == kChunkIndex) AddChunk(bytes);
      if (opcode != kStatistics) continue;
      bytes.Take(8 + 2 + 4 + 4 + 4);  // messages, schemas, channels, attachments, metadata
      chunk_count = bytes.Little<std::uint32_t>();
      bytes.Take(16);  // times of the first and the last message
      ByteReader entries(TakeText(bytes));
      while (!entries.rest().empty()) {
        const auto channel = entries.Little<std::uint16_t>();
        counts[channel] = entries.Little<std::uint64_t>();
      }
    }
    if (!chunk_count || *chunk_count == 0 || *chunk_count != chunks_.size()) return false;
    for (const auto& [channel, count] : counts) {
      const auto found = channels_.find(channel);
      if (found == channels_.end()) return false;
      topics_[found->second].messages += count;
    }
    return true;
  }

  void AddChunk(ByteReader bytes) {
    ChunkPlace place;
    place.first_ns = bytes.Little<std::uint64_t>();
    place.last_ns = bytes.Little<std::uint64_t>();
    place.offset = bytes.Little<std::uint64_t>();
    place.length = bytes.Little<std::uint64_t>();
    ByteReader entries(TakeText(bytes));
    while (!entries.rest().empty()) {
      const auto channel = entries.Little<std::uint16_t>();
      place.index_offsets[channel] = entries.Little<std::uint64_t>();
    }
    chunks_.push_back(std::move(place));
  }

  /// Times of each topic's first and last message, from the message indexes of the first and the
  /// last chunk that have any. False for a file without message indexes.
  bool FindTimes() {
    std::ranges::stable_sort(chunks_, {}, &ChunkPlace::offset);
    struct Ends {
      const ChunkPlace* first = nullptr;
      const ChunkPlace* last = nullptr;
    };
    std::vector<Ends> ends(topics_.size());
    for (const ChunkPlace& place : chunks_) {
      if (place.index_offsets.empty()) return false;
      for (const auto& [channel, offset] : place.index_offsets) {
        const auto found = channels_.find(channel);
        if (found == channels_.end()) continue;
        Ends& of = ends[found->second];
        if (of.first == nullptr || place.first_ns < of.first->first_ns) of.first = &place;
        if (of.last == nullptr || place.last_ns > of.last->last_ns) of.last = &place;
      }
    }
    std::vector<std::vector<std::uint16_t>> channels_of(topics_.size());
    for (const auto& [channel, topic] : channels_) channels_of[topic].push_back(channel);
    for (std::size_t topic = 0; topic < topics_.size(); ++topic) {
      if (topics_[topic].messages == 0) continue;
      const Ends& of = ends[topic];
      if (of.first == nullptr) {
        FailAsDamaged("its index names no chunk of a topic that has messages");
      }
      Topic times;
      for (const ChunkPlace* place : {of.first, of.last}) {
        for (const std::uint16_t channel : channels_of[topic]) {
          const auto found = place->index_offsets.find(channel);
          if (found != place->index_offsets.end()) CountIndex(found->second, times);
        }
      }
      topics_[topic].first_ns = times.first_ns;
      topics_[topic].last_ns = times.last_ns;
    }
    return true;
  }

  void CountIndex(std::uint64_t offset, Topic& times) {
    ByteReader head(file_.At(offset, kMcapHeadBytes));
    const auto opcode = head.Little<McapOpcode>();
    const auto length = head.Little<std::uint64_t>();
    if (opcode != kMessageIndex) FailAsDamaged("its index names a message index that is not there");
    ByteReader bytes(file_.At(offset + kMcapHeadBytes, length));
    bytes.Take(2);  // the channel
    ByteReader entries(TakeText(bytes));
    while (!entries.rest().empty()) {
      Count(times, static_cast<std::int64_t>(entries.Little<std::uint64_t>()));
      entries.Take(8);
    }
  }

  FileWindow file_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;  // the topic of each
  std::map<std::string, std::size_t> by_name_;     // topics
  std::vector<ChunkPlace> chunks_;                 // empty: read the whole file
  std::string room_;
  bool has_chunks_ = false;
  bool was_checked_ = false;
};

}  // namespace

std::unique_ptr<MessageFile> OpenMcap(const std::filesystem::path& file) {
  return std::make_unique<McapFile>(FileWindow(file));
}

std::unique_ptr<MessageFile> ReadMcap(std::string bytes) {
  return std::make_unique<McapFile>(FileWindow(std::move(bytes)));
}

}  // namespace gauntlet::sim
