#include "sim/live/device/osc_packet.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

#include "sim/live/device/device_clock.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kAlignment = 4;
constexpr std::string_view kBundle = {"#bundle\0", 8};
constexpr int kDeepest = 8;  // bundles in bundles

/// Thrown within this file for bytes that are no OSC.
struct NoOsc {};

/// Takes big-endian parts from the front of bytes.
class OscReader {
 public:
  explicit OscReader(std::string_view bytes) : rest_(bytes) {}

  bool is_empty() const { return rest_.empty(); }
  std::string_view Take(std::size_t size) {
    if (size > rest_.size()) throw NoOsc{};
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  /// A text with its NUL, padded with NULs.
  std::string_view Text() {
    const std::string_view text = rest_.substr(0, rest_.find('\0'));
    const std::size_t padded = (text.size() / kAlignment + 1) * kAlignment;
    if (Take(padded).find_first_not_of('\0', text.size()) != std::string_view::npos) throw NoOsc{};
    return text;
  }
  std::uint64_t Big(std::size_t size) {
    std::uint64_t number = 0;
    for (const char byte : Take(size)) number = number << 8 | static_cast<unsigned char>(byte);
    return number;
  }
  std::int32_t Int() { return static_cast<std::int32_t>(Big(4)); }

 private:
  std::string_view rest_;
};

void PassOverBlob(OscReader& bytes) {
  const std::int32_t size = bytes.Int();
  if (size < 0) throw NoOsc{};
  const std::size_t length = static_cast<std::size_t>(size);
  bytes.Take((length + kAlignment - 1) / kAlignment * kAlignment);
}

OscMessage ReadMessage(OscReader bytes) {
  OscMessage message{.address = std::string(bytes.Text()), .numbers = {}};
  if (!message.address.starts_with('/')) throw NoOsc{};
  if (bytes.is_empty()) return message;  // old senders leave out the types of no arguments
  const std::string_view types = bytes.Text();
  if (!types.starts_with(',')) throw NoOsc{};
  std::vector<double>& numbers = message.numbers;
  for (const char type : types.substr(1)) {
    switch (type) {
      case 'i':
        numbers.push_back(bytes.Int());
        break;
      case 'h':
        numbers.push_back(static_cast<double>(static_cast<std::int64_t>(bytes.Big(8))));
        break;
      case 'f':
        numbers.push_back(std::bit_cast<float>(bytes.Int()));
        break;
      case 'd':
        numbers.push_back(std::bit_cast<double>(bytes.Big(8)));
        break;
      case 'T':
      case 'F':
        numbers.push_back(type == 'T' ? 1.0 : 0.0);
        break;
      case 'N':
        numbers.push_back(kMissing);
        break;
      case 's':
      case 'S':
        bytes.Text();
        break;
      case 'b':
        PassOverBlob(bytes);
        break;
      case 't':
        bytes.Take(8);
        break;
      case 'c':
      case 'r':
      case 'm':
        bytes.Take(4);
        break;
      case 'I':
      case '[':
      case ']':
        break;
      default:
        throw NoOsc{};
    }
  }
  if (!bytes.is_empty()) throw NoOsc{};
  return message;
}

/// Seconds since 1900 and their fraction, as NTP has them.
std::optional<std::int64_t> TimeOf_ns(std::uint64_t tag) {
  constexpr std::int64_t kSeconds1900To1970 = 2'208'988'800;
  constexpr std::uint64_t kAtOnce = 1;
  if (tag <= kAtOnce) return std::nullopt;
  const auto seconds = static_cast<std::int64_t>(tag >> 32) - kSeconds1900To1970;
  const std::uint64_t fraction_ns = (tag & 0xFFFFFFFFu) * kNanosecondsPerSecond >> 32;
  return seconds * kNanosecondsPerSecond + static_cast<std::int64_t>(fraction_ns);
}

void ReadElement(std::string_view element, int depth, OscPacket& packet) {
  OscReader bytes(element);
  if (!element.starts_with(kBundle)) {
    packet.messages.push_back(ReadMessage(bytes));
    return;
  }
  if (depth == kDeepest) throw NoOsc{};
  bytes.Take(kBundle.size());
  const auto time_ns = TimeOf_ns(bytes.Big(8));
  if (depth == 0) packet.time_ns = time_ns;
  packet.is_bundle = true;
  while (!bytes.is_empty()) {
    const std::int32_t size = bytes.Int();
    if (size <= 0) throw NoOsc{};
    ReadElement(bytes.Take(static_cast<std::size_t>(size)), depth + 1, packet);
  }
}

void AppendBig(std::string& bytes, std::uint64_t number, int size) {
  for (int i = size - 1; i >= 0; --i) bytes.push_back(static_cast<char>(number >> 8 * i));
}

void AppendText(std::string& bytes, std::string_view text) {
  bytes.append(text).append(kAlignment - text.size() % kAlignment, '\0');
}

bool FitsInt(double value) {
  constexpr double kLargest = std::numeric_limits<std::int32_t>::max();
  return std::abs(value) <= kLargest && value == std::floor(value);
}

}  // namespace

std::optional<OscPacket> ReadOscPacket(std::string_view bytes) {
  if (bytes.empty() || bytes.size() % kAlignment != 0) return std::nullopt;
  OscPacket packet;
  try {
    ReadElement(bytes, 0, packet);
  } catch (const NoOsc&) {
    return std::nullopt;
  }
  return packet;
}

std::string OscMessageBytes(std::string_view address, const std::vector<double>& numbers) {
  std::string types = ",";
  std::string arguments;
  for (const double number : numbers) {
    if (std::isnan(number)) {
      types += 'N';
    } else if (FitsInt(number)) {
      types += 'i';
      AppendBig(arguments, static_cast<std::uint32_t>(static_cast<std::int32_t>(number)), 4);
    } else {
      types += 'f';
      AppendBig(arguments, std::bit_cast<std::uint32_t>(static_cast<float>(number)), 4);
    }
  }
  std::string bytes;
  AppendText(bytes, address);
  AppendText(bytes, types);
  return bytes + arguments;
}

std::string OscBundleBytes(const std::vector<OscMessage>& messages) {
  std::string bytes(kBundle);
  AppendBig(bytes, 1, 8);  // at once
  for (const OscMessage& message : messages) {
    const std::string element = OscMessageBytes(message.address, message.numbers);
    AppendBig(bytes, element.size(), 4);
    bytes += element;
  }
  return bytes;
}

}  // namespace gauntlet::sim
