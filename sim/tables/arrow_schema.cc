#include "sim/tables/arrow_schema.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>

namespace gauntlet::sim {
namespace {

std::string BytesOf(std::string_view base64) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char letter : base64) {
    const std::size_t digit = kDigits.find(letter);
    if (digit == kDigits.npos) break;  // = at the end
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 0xff));
  }
  return bytes;
}

/// A number at a place of a FlatBuffer; 0, which no place of a part is, outside of it.
template <class Number>
Number At(std::string_view buffer, std::size_t place) {
  Number number = 0;
  if (place > buffer.size() || buffer.size() - place < sizeof number) return 0;
  std::memcpy(&number, buffer.data() + place, sizeof number);
  return number;
}

/// The place that the offset at `place` points to.
std::size_t Behind(std::string_view buffer, std::size_t place) {
  return place + At<std::uint32_t>(buffer, place);
}

/// A table of a FlatBuffer: its fields are where its vtable says, or absent.
struct FlatTable {
  std::string_view buffer;
  std::size_t place = 0;

  /// The place of a field; 0: it is absent.
  std::size_t Field(std::size_t number) const {
    // The vtable: its size, that of the table, and the distance of each field from the table.
    const auto vtable = static_cast<std::size_t>(static_cast<std::int64_t>(place) -
                                                 At<std::int32_t>(buffer, place));
    const std::size_t entry = 4 + 2 * number;
    if (entry + 2 > At<std::uint16_t>(buffer, vtable)) return 0;
    const std::size_t distance = At<std::uint16_t>(buffer, vtable + entry);
    return distance == 0 ? 0 : place + distance;
  }
  std::optional<FlatTable> Table(std::size_t number) const {
    const std::size_t field = Field(number);
    if (field == 0) return std::nullopt;
    return FlatTable{buffer, Behind(buffer, field)};
  }
};

}  // namespace

std::vector<std::pair<std::string, std::string_view>> DurationsOf(std::string_view base64) {
  // Numbers of fields and types in Message.fbs and Schema.fbs.
  constexpr std::size_t kHeaderType = 1, kHeader = 2, kFields = 1;
  constexpr std::size_t kName = 0, kType = 2, kTypeTable = 3, kUnit = 0;
  constexpr std::uint8_t kSchema = 1, kDuration = 18;
  constexpr std::array<std::string_view, 4> kUnits = {"s", "ms", "us", "ns"};
  constexpr std::uint16_t kUnitIfAbsent = 1;
  const std::string bytes = BytesOf(base64);
  // The size of the message stands in front, since Arrow 0.15 behind four bytes of ones.
  const std::size_t front = At<std::uint32_t>(bytes, 0) == UINT32_MAX ? 8 : 4;
  if (bytes.size() < front) return {};
  const std::string_view buffer = std::string_view(bytes).substr(front);
  const FlatTable message{buffer, Behind(buffer, 0)};
  const std::optional<FlatTable> schema = message.Table(kHeader);
  if (!schema || At<std::uint8_t>(buffer, message.Field(kHeaderType)) != kSchema) return {};
  std::vector<std::pair<std::string, std::string_view>> durations;
  const std::size_t fields = schema->Field(kFields);
  if (fields == 0) return durations;
  const std::size_t list = Behind(buffer, fields);
  const std::size_t count = At<std::uint32_t>(buffer, list);
  for (std::size_t i = 0; i < count && list + 4 * (i + 1) < buffer.size(); ++i) {
    const FlatTable field{buffer, Behind(buffer, list + 4 * (i + 1))};
    const std::size_t type = field.Field(kType);
    if (type == 0 || At<std::uint8_t>(buffer, type) != kDuration) continue;
    const std::optional<FlatTable> duration = field.Table(kTypeTable);
    const std::size_t name = field.Field(kName);
    if (!duration || name == 0) continue;
    const std::size_t unit_at = duration->Field(kUnit);
    const std::uint16_t unit = unit_at == 0 ? kUnitIfAbsent : At<std::uint16_t>(buffer, unit_at);
    const std::size_t text = Behind(buffer, name);
    const std::size_t length = At<std::uint32_t>(buffer, text);
    if (unit >= kUnits.size() || text + 4 > buffer.size() || buffer.size() - text - 4 < length) {
      continue;
    }
    durations.emplace_back(buffer.substr(text + 4, length), kUnits[unit]);
  }
  return durations;
}

}  // namespace gauntlet::sim
