#include "sim/live/device/binary_frames.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/tables/byte_reader.h"

namespace gauntlet::sim {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "\xF7GNT";
constexpr std::uint8_t kVersion = 1;
enum Kind : std::uint8_t { kNames = 0, kFloats = 1, kDoubles = 2 };
constexpr std::size_t kHeadBytes = 24;
constexpr std::size_t kCrcBytes = 4;
constexpr std::size_t kMostValues = 1024;  // far more than any glove has
constexpr std::size_t kMostNameBytes = std::numeric_limits<std::uint16_t>::max();
constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::min();

struct Head {
  std::uint8_t kind = 0;
  std::uint16_t count = 0;
  std::int64_t number = 0;
  std::int64_t time_ns = 0;
  std::size_t frame_bytes = 0;
};

/// The head at the front of the bytes; none if it can be none.
std::optional<Head> ReadHead(ByteReader bytes) {
  Head head;
  bytes.Take(kMagic.size());
  const auto version = bytes.Little<std::uint8_t>();
  head.kind = bytes.Little<std::uint8_t>();
  head.count = bytes.Little<std::uint16_t>();
  head.number = bytes.Little<std::int64_t>();
  head.time_ns = bytes.Little<std::int64_t>();
  if (version != kVersion || head.kind > kDoubles) return std::nullopt;
  if (head.kind != kNames && head.count > kMostValues) return std::nullopt;
  const std::size_t size = head.kind == kNames ? 1 : 4 * std::size_t{head.kind};
  head.frame_bytes = kHeadBytes + size * head.count + kCrcBytes;
  return head;
}

std::uint32_t Crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Length of the front of the bytes in which no frame begins.
std::size_t BytesBeforeMagic(std::string_view bytes) {
  const std::size_t found = bytes.find(kMagic);
  if (found != std::string_view::npos) return found;
  for (std::size_t part = std::min(kMagic.size() - 1, bytes.size()); part > 0; --part) {
    if (bytes.ends_with(kMagic.substr(0, part))) return bytes.size() - part;
  }
  return bytes.size();
}

template <class Number>
void Append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string Frame(Kind kind, std::size_t count, std::int64_t number, std::int64_t time_ns,
                  std::string_view content) {
  std::string frame(kMagic);
  Append(frame, kVersion);
  Append(frame, static_cast<std::uint8_t>(kind));
  Append(frame, static_cast<std::uint16_t>(count));
  Append(frame, number);
  Append(frame, time_ns);
  frame.append(content);
  Append(frame, Crc(frame));
  return frame;
}

}  // namespace

void BinaryFrames::Decode(std::string_view bytes, std::int64_t arrival_ns,
                          const FrameReceiver& receive) {
  buffer_.append(bytes);
  while (TakeFront(arrival_ns, receive)) {
  }
}

void BinaryFrames::Skip(std::size_t bytes) {
  if (bytes > 0 && !is_in_garbage_) {
    is_in_garbage_ = true;
    CountGarbage("bytes between frames");
  }
  buffer_.erase(0, bytes);
}

bool BinaryFrames::TakeFront(std::int64_t arrival_ns, const FrameReceiver& receive) {
  Skip(BytesBeforeMagic(buffer_));
  if (buffer_.size() < kHeadBytes) return false;
  const std::optional<Head> head = ReadHead(ByteReader(buffer_));
  if (head && buffer_.size() < head->frame_bytes) return false;
  const std::string_view frame = std::string_view(buffer_).substr(0, head ? head->frame_bytes : 0);
  const bool is_whole =
      head && ByteReader(frame.substr(frame.size() - kCrcBytes)).Little<std::uint32_t>() ==
                  Crc(frame.substr(0, frame.size() - kCrcBytes));
  if (!is_whole) {
    // The magic may be a part of values, or of a frame that lost bytes: the next one may follow.
    Skip(1);
    problem_ = head ? "a frame does not have its checksum" : "a frame of another version or kind";
    return true;
  }
  is_in_garbage_ = false;
  DecodeFrame(frame, arrival_ns, receive);
  buffer_.erase(0, frame.size());
  return true;
}

void BinaryFrames::DecodeFrame(std::string_view frame, std::int64_t arrival_ns,
                               const FrameReceiver& receive) {
  const Head head = *ReadHead(ByteReader(frame));
  ByteReader content(frame.substr(kHeadBytes));
  if (head.kind == kNames) {
    ReadNames(content.Take(head.count));
    return;
  }
  if (columns_.count == 0 && head.count > 0) {
    columns_.count = head.count;
    ++columns_.version;
    if (columns_.names.size() != head.count) NameColumns({});
  }
  if (head.count == 0 || head.count != columns_.count) {
    CountGarbage(
        fmt::format("a frame has {} values, the first one {}", head.count, columns_.count));
    return;
  }
  values_.resize(head.count);
  for (double& value : values_) {
    value = head.kind == kFloats ? content.Little<float>() : content.Little<double>();
  }
  DeviceFrame decoded{.arrival_ns = arrival_ns, .number = head.number};
  if (head.time_ns != kNoTime) decoded.sender_time_ns = head.time_ns;
  Emit(decoded, values_, receive);
}

void BinaryFrames::ReadNames(std::string_view text) {
  std::vector<std::string> names;
  for (const std::string_view name : SplitCells(text)) names.emplace_back(name);
  const bool fits = columns_.count == 0 || columns_.count == names.size();
  if (!TextProblem(text).empty() || !fits) {
    CountGarbage("names that do not fit the values");
    return;
  }
  if (names == columns_.names) return;
  columns_.names = std::move(names);  // number and time are in the head of a frame
  ++columns_.version;
}

void BinaryFrames::EndPacket(std::int64_t /*arrival_ns*/, const FrameReceiver& /*receive*/) {
  Restart();
}

void BinaryFrames::Restart() {
  if (!buffer_.empty()) CountHalf("a frame ends too early");
  buffer_.clear();
  is_in_garbage_ = false;
}

std::string BinaryFrame(const OutgoingFrame& frame) {
  std::string content;
  for (const double value : frame.values) Append(content, value);
  return Frame(kDoubles, frame.values.size(), frame.number, frame.time_ns, content);
}

std::string BinaryNames(const std::vector<std::string>& names) {
  const std::string text = fmt::format("{}", fmt::join(names, ","));
  const auto has_comma = [](const std::string& name) { return name.find(',') != name.npos; };
  if (std::ranges::any_of(names, has_comma) || text.size() > kMostNameBytes) {
    throw UserError("the binary format takes names without commas, of 65535 bytes in all");
  }
  return Frame(kNames, text.size(), 0, kNoTime, text);
}

}  // namespace gauntlet::sim
