#include "sim/tables/numpy_file.h"

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

#include "sim/base/error.h"
#include "sim/tables/damaged_file.h"

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

template <class Number>
double Value(const char* place, bool swapped) {
  std::array<char, sizeof(Number)> bytes;
  std::copy_n(place, bytes.size(), bytes.begin());
  if (swapped) std::ranges::reverse(bytes);
  return static_cast<double>(std::bit_cast<Number>(bytes));
}

using Reader = double (*)(const char*, bool);

/// By kind and size, as `f8`.
Reader ReaderOf(std::string_view type) {
  struct Known {
    std::string_view type;
    Reader reader;
  };
  static constexpr std::array<Known, 11> kKnown = {{{"f8", Value<double>},
                                                    {"f4", Value<float>},
                                                    {"i1", Value<std::int8_t>},
                                                    {"i2", Value<std::int16_t>},
                                                    {"i4", Value<std::int32_t>},
                                                    {"i8", Value<std::int64_t>},
                                                    {"u1", Value<std::uint8_t>},
                                                    {"u2", Value<std::uint16_t>},
                                                    {"u4", Value<std::uint32_t>},
                                                    {"u8", Value<std::uint64_t>},
                                                    {"b1", Value<std::uint8_t>}}};
  const auto found = std::ranges::find(kKnown, type, &Known::type);
  return found == kKnown.end() ? nullptr : found->reader;
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
    throw UserError(fmt::format("{} is an array of records, which is not read", name));
  }
  type = type.substr(1, type.find('\'', 1) - 1);
  const bool swapped = type.starts_with('>');
  const Reader reader = type.size() < 3 ? nullptr : ReaderOf(type.substr(1));
  if (reader == nullptr) throw UserError(fmt::format("{} is no array of numbers", name));
  const std::vector<std::size_t> shape = ShapeOf(header);
  NamedArray array{.name = name, .rows = shape.empty() ? 1 : shape.front(), .values = {}};
  const std::string_view data = bytes.substr(start + length);
  const std::size_t width = static_cast<std::size_t>(type[2] - '0');
  const std::size_t most = data.size() / width;
  for (std::size_t i = 1; i < shape.size(); ++i) {
    if (shape[i] > most) FailAsDamaged("its shape is larger than the file");
    array.columns *= shape[i];
    if (array.columns > most) FailAsDamaged("its shape is larger than the file");
  }
  if (array.columns == 0 || array.rows > most / array.columns) {
    FailAsDamaged("its shape is larger than the file");
  }
  array.values.resize(array.rows * array.columns);
  const bool by_columns = ValueOf(header, "fortran_order").starts_with("True");
  for (std::size_t row = 0; row < array.rows; ++row) {
    for (std::size_t column = 0; column < array.columns; ++column) {
      const std::size_t place =
          by_columns ? column * array.rows + row : row * array.columns + column;
      array.values[row * array.columns + column] = reader(data.data() + place * width, swapped);
    }
  }
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
    const std::string file = FileAt(bytes, entry);
    try {
      arrays.push_back(ReadNpy(file, name));
    } catch (const UserError&) {  // texts and records beside the numbers
    }
  }
  return arrays;
}

}  // namespace gauntlet::sim
