#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include "sim/base/error.h"
#include "sim/tables/array_files.h"
#include "sim/tables/byte_reader.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

// More than an hour of any glove; a ZIP can say that it holds anything.
constexpr std::size_t kMostBytes = std::size_t{1} << 28;

/// A little-endian number.
template <class Number>
Number At(std::string_view bytes, std::size_t place) {
  if (place > bytes.size() || bytes.size() - place < sizeof(Number)) {
    FailAsDamaged("it ends too early");
  }
  Number number;
  std::memcpy(&number, bytes.data() + place, sizeof number);
  return number;
}

std::string_view Part(std::string_view bytes, std::size_t place, std::size_t size) {
  if (place > bytes.size() || bytes.size() - place < size) FailAsDamaged("it ends too early");
  return bytes.substr(place, size);
}

/// Values from here on.
using Reader = void (*)(const char* place, bool swapped, std::span<double> values);

template <class Number>
void ReadValues(const char* place, bool swapped, std::span<double> values) {
  for (double& value : values) {
    std::array<char, sizeof(Number)> bytes;
    std::copy_n(place, bytes.size(), bytes.begin());
    if (swapped) std::ranges::reverse(bytes);
    value = static_cast<double>(std::bit_cast<Number>(bytes));
    place += sizeof(Number);
  }
}

void ReadHalves(const char* place, bool swapped, std::span<double> values) {
  for (double& value : values) {
    const auto first = static_cast<std::uint8_t>(place[swapped ? 1 : 0]);
    const auto second = static_cast<std::uint8_t>(place[swapped ? 0 : 1]);
    value = ValueOfHalf(static_cast<std::uint16_t>(first | second << 8));
    place += 2;
  }
}

/// Dates and durations: the smallest number is none (NaT).
void ReadTimes(const char* place, bool swapped, std::span<double> values) {
  ReadValues<std::int64_t>(place, swapped, values);
  constexpr auto kNone = static_cast<double>(std::numeric_limits<std::int64_t>::min());
  std::ranges::replace(values, kNone, kMissing);
}

/// By kind and size, as `f8`.
Reader ReaderOf(std::string_view type) {
  struct Known {
    std::string_view type;
    Reader reader;
  };
  static constexpr std::array<Known, 14> kKnown = {{{"f8", ReadValues<double>},
                                                    {"f4", ReadValues<float>},
                                                    {"f2", ReadHalves},
                                                    {"i1", ReadValues<std::int8_t>},
                                                    {"i2", ReadValues<std::int16_t>},
                                                    {"i4", ReadValues<std::int32_t>},
                                                    {"i8", ReadValues<std::int64_t>},
                                                    {"u1", ReadValues<std::uint8_t>},
                                                    {"u2", ReadValues<std::uint16_t>},
                                                    {"u4", ReadValues<std::uint32_t>},
                                                    {"u8", ReadValues<std::uint64_t>},
                                                    {"b1", ReadValues<std::uint8_t>},
                                                    {"M8", ReadTimes},
                                                    {"m8", ReadTimes}}};
  const auto found = std::ranges::find(kKnown, type, &Known::type);
  return found == kKnown.end() ? nullptr : found->reader;
}

/// Unit of dates and durations, as `ms` and 10 of `M8[10ms]`.
struct DateUnit {
  std::string_view name;  // of a column of time
  double factor = 1.0;    // to values in this unit
};

/// None for months and years, and for dates without a unit.
std::optional<DateUnit> DateUnitOf(std::string_view type) {
  struct Known {
    std::string_view unit;
    DateUnit is;
  };
  static constexpr std::array<Known, 8> kKnown = {{{"ns", {"ns"}},
                                                   {"us", {"us"}},
                                                   {"ms", {"ms"}},
                                                   {"s", {"s"}},
                                                   {"m", {"s", 60.0}},
                                                   {"h", {"s", 3600.0}},
                                                   {"D", {"s", 86400.0}},
                                                   {"W", {"s", 604800.0}}}};
  const std::size_t open = type.find('[');
  if (open == std::string_view::npos || !type.ends_with(']')) return std::nullopt;
  std::string_view unit = type.substr(open + 1, type.size() - open - 2);
  double count = 1.0;
  const auto [rest, error] = std::from_chars(unit.data(), unit.data() + unit.size(), count);
  if (error == std::errc()) unit.remove_prefix(static_cast<std::size_t>(rest - unit.data()));
  const auto found = std::ranges::find(kKnown, unit, &Known::unit);
  if (found == kKnown.end()) return std::nullopt;
  return DateUnit{.name = found->is.name, .factor = count * found->is.factor};
}

/// For a person: the content of an array that is not read, by its kind.
std::string_view NameOfKind(std::string_view type) {
  if (type.starts_with('c')) return "complex numbers";
  if (type.starts_with('U') || type.starts_with('S')) return "texts";
  if (type.starts_with('O')) return "objects of Python";
  if (type.starts_with('M') || type.starts_with('m')) return "dates without a clock";
  if (type.starts_with('f')) return "numbers of more than 64 bits";
  return "no numbers";
}

/// Value behind `'key':` in the header, a dictionary as Python writes it.
std::string_view ValueOf(std::string_view header, std::string_view key) {
  const std::size_t place = header.find(fmt::format("'{}'", key));
  if (place == std::string_view::npos) FailAsDamaged(fmt::format("its header has no {}", key));
  const std::size_t colon = header.find(':', place);
  if (colon == std::string_view::npos) FailAsDamaged("its header is no dictionary");
  std::string_view value = header.substr(colon + 1);
  value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
  return value;
}

std::vector<std::size_t> ShapeOf(std::string_view header) {
  std::string_view text = ValueOf(header, "shape");
  if (!text.starts_with('(')) FailAsDamaged("its shape is no tuple");
  text = text.substr(1, text.find(')') - 1);
  std::vector<std::size_t> shape;
  while (!text.empty()) {
    std::size_t size = 0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), size);
    if (error != std::errc()) {
      text.remove_prefix(1);
      continue;
    }
    shape.push_back(size);
    text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
  }
  return shape;
}

/// Texts of one dimension, for names of columns: letters beyond ASCII become `?`. All others are
/// left out.
NamedArray TextsIn(std::string_view data, std::string_view type, bool swapped,
                   const std::vector<std::size_t>& shape, const std::string& name) {
  constexpr std::size_t kMostTexts = 4096, kLongest = 256;
  NamedArray array{.name = name, .columns = 0, .values = {}};
  std::size_t length = 0;
  std::from_chars(type.data() + 1, type.data() + type.size(), length);
  const std::size_t per_letter = type.front() == 'U' ? 4 : 1;
  if (shape.size() != 1 || shape[0] > kMostTexts || length > kLongest) {
    array.columns = 1;
    array.left_out = "texts";
    return array;
  }
  Part(data, 0, shape[0] * length * per_letter);
  for (std::size_t row = 0; row < shape[0]; ++row) {
    std::string& text = array.texts.emplace_back();
    for (std::size_t i = 0; i < length; ++i) {
      const char* const place = data.data() + (row * length + i) * per_letter;
      const char letter = place[swapped && per_letter == 4 ? 3 : 0];
      if (letter == '\0') break;
      text += letter >= ' ' && letter < 127 ? letter : '?';
    }
  }
  array.rows = array.texts.size();
  return array;
}

std::string Inflate(std::string_view packed, std::size_t size) {
  if (size > kMostBytes) {
    throw UserError(fmt::format("holds an array of {} MB, must be at most {}; write it as CSV",
                                size >> 20, kMostBytes >> 20));
  }
  constexpr std::size_t kMostPerPackedByte = 1032;  // that deflate can do
  if (size / kMostPerPackedByte > packed.size()) FailAsDamaged("a size in it is wrong");
  std::string bytes(size, '\0');
  z_stream stream = {};
  constexpr int kWithoutHead = -15;
  if (inflateInit2(&stream, kWithoutHead) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  const int result = inflate(&stream, Z_FINISH);
  const bool is_whole = result == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  if (!is_whole) FailAsDamaged("an array in it cannot be unpacked");
  return bytes;
}

/// One file of a ZIP, by its entry in the directory.
std::string FileAt(std::string_view zip, std::string_view entry) {
  const auto method = At<std::uint16_t>(entry, 10);
  const auto packed_size = At<std::uint32_t>(entry, 20);
  const auto size = At<std::uint32_t>(entry, 24);
  const auto place = At<std::uint32_t>(entry, 42);
  if (std::max({packed_size, size, place}) == std::numeric_limits<std::uint32_t>::max()) {
    throw UserError("is larger than 4 GB; write a part of it as CSV");
  }
  const std::size_t head = 30 + std::size_t{At<std::uint16_t>(zip, std::size_t{place} + 26)} +
                           At<std::uint16_t>(zip, std::size_t{place} + 28);
  const std::string_view packed = Part(zip, place + head, packed_size);
  if (method == 0) return std::string(packed);
  if (method == 8) return Inflate(packed, size);
  throw UserError("is packed in a way that is not read; write it by numpy.savez");
}

}  // namespace

NamedArray ReadNpy(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("\x93NUMPY")) FailAsDamaged("it does not begin as NPY does");
  const bool is_first_version = At<std::uint8_t>(bytes, 6) == 1;
  const std::size_t length =
      is_first_version ? At<std::uint16_t>(bytes, 8) : At<std::uint32_t>(bytes, 8);
  const std::size_t start = is_first_version ? 10 : 12;
  const std::string_view header = Part(bytes, start, length);
  std::string_view type = ValueOf(header, "descr");
  if (type.size() < 2 || type.front() != '\'') {
    return {.name = name, .values = {}, .left_out = "records"};
  }
  type = type.substr(1, type.find('\'', 1) - 1);
  const bool swapped = type.starts_with('>');
  if (type.empty()) FailAsDamaged("its header has no type");
  type.remove_prefix(1);
  const bool is_date = type.starts_with('M') || type.starts_with('m');
  if (IsNameOfNames(name) && (type.starts_with('U') || type.starts_with('S'))) {
    return TextsIn(bytes.substr(start + length), type, swapped, ShapeOf(header), name);
  }
  const std::optional<DateUnit> date = DateUnitOf(is_date ? type : "");
  const Reader reader = is_date ? ReaderOf(type.substr(0, 2)) : ReaderOf(type);
  if (reader == nullptr || (is_date && !date)) {
    return {.name = name, .values = {}, .left_out = std::string(NameOfKind(type))};
  }
  const std::vector<std::size_t> shape = ShapeOf(header);
  const std::string_view data = bytes.substr(start + length);
  const std::size_t most = data.size() / static_cast<std::size_t>(type[1] - '0');
  if (std::ranges::find(shape, 0U) != shape.end()) {
    return {.name = name, .values = {}, .left_out = "empty"};
  }
  std::size_t count = 1;
  for (const std::size_t size : shape) {
    if (size > most / count) FailAsDamaged("its shape is larger than the file");
    count *= size;
  }
  if (count > most) FailAsDamaged("its shape is larger than the file");
  std::vector<double> values(count);
  reader(data.data(), swapped, values);
  NamedArray array{.name = date ? NameOfTimes(name, date->name) : name, .values = {}};
  if (date && date->factor != 1.0) {
    for (double& value : values) value *= date->factor;
  }
  const bool by_columns = ValueOf(header, "fortran_order").starts_with("True");
  SetValues(array, std::move(values), shape, by_columns ? ArrayOrder::kColumns : ArrayOrder::kRows);
  return array;
}

std::vector<NamedArray> ReadNpz(std::string_view bytes) {
  constexpr std::string_view kEndOfDirectory = "PK\x05\x06";
  constexpr std::string_view kEntry = "PK\x01\x02";
  const std::size_t end = bytes.rfind(kEndOfDirectory);
  if (end == std::string_view::npos) FailAsDamaged("the directory of the ZIP is missing");
  const auto count = At<std::uint16_t>(bytes, end + 10);
  std::size_t place = At<std::uint32_t>(bytes, end + 16);
  std::vector<NamedArray> arrays;
  for (int i = 0; i < count; ++i) {
    const std::string_view entry = bytes.substr(std::min(place, bytes.size()));
    if (!entry.starts_with(kEntry)) FailAsDamaged("the directory of the ZIP is broken");
    const auto name_size = At<std::uint16_t>(entry, 28);
    std::string name(Part(entry, 46, name_size));
    place +=
        46 + std::size_t{name_size} + At<std::uint16_t>(entry, 30) + At<std::uint16_t>(entry, 32);
    if (!name.ends_with(".npy")) continue;
    name.resize(name.size() - 4);
    arrays.push_back(ReadNpy(FileAt(bytes, entry), name));
  }
  return arrays;
}

}  // namespace gauntlet::sim
