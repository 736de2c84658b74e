#include <fmt/format.h>
#include <snappy-c.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/tables/array_files.h"
#include "sim/tables/array_table.h"
#include "sim/tables/arrow_schema.h"
#include "sim/tables/byte_reader.h"
#include "sim/tables/checksum.h"
#include "sim/tables/thrift_value.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kMagic = "PAR1";
constexpr std::int64_t kMostPageBytes = std::int64_t{1} << 28;
constexpr std::int64_t kMostPageValues = std::int64_t{1} << 26;   // half a gigabyte of numbers
constexpr std::string_view kNamelessIndex = "__index_level_0__";  // of pandas
constexpr std::string_view kTexts = "texts";
constexpr std::string_view kDecimals = "decimals in bytes; write them as doubles";
constexpr double kNull = std::numeric_limits<double>::quiet_NaN();

// Numbers of parquet.thrift.
enum PhysicalType {
  kParquetBoolean = 0,
  kParquetInt32 = 1,
  kParquetInt64 = 2,
  kParquetInt96 = 3,
  kParquetFloat = 4,
  kParquetDouble = 5,
  kParquetBytes = 6,
  kParquetFixedBytes = 7
};
enum Repetition { kRequired = 0, kOptional = 1, kRepeated = 2 };
enum PageType { kDataPage = 0, kDictionaryPage = 2, kDataPageV2 = 3 };
enum Encoding { kPlain = 0, kPlainDictionary = 2, kRle = 3, kRleDictionary = 8 };

std::string_view NameIn(std::span<const std::string_view> names, std::int64_t number) {
  return number >= 0 && number < std::ssize(names) ? names[static_cast<std::size_t>(number)]
                                                   : "an unknown one";
}
constexpr std::array<std::string_view, 8> kCodecs = {"none",   "snappy", "gzip", "LZO",
                                                     "brotli", "LZ4",    "zstd", "LZ4_RAW"};
constexpr std::array<std::string_view, 10> kEncodings = {
    "PLAIN",          "GROUP_VAR_INT",       "PLAIN_DICTIONARY",        "RLE",
    "BIT_PACKED",     "DELTA_BINARY_PACKED", "DELTA_LENGTH_BYTE_ARRAY", "DELTA_BYTE_ARRAY",
    "RLE_DICTIONARY", "BYTE_STREAM_SPLIT"};

/// A column of the schema. Levels: how many optional or repeated nodes on its way there are.
struct Leaf {
  std::string name;
  std::int64_t type = 0;
  bool is_unsigned = false;
  bool is_interval = false;   // months, days and ms
  bool is_time_text = false;  // texts, which may be dates or clocks by the name
  double factor = 1.0;        // from whole numbers to values of a decimal
  std::string left_out = {};  // why it is not read; empty: it is
  int repeated = 0;           // repeated nodes
  unsigned most_defined = 0;  // the level of a value
  unsigned item_defined = 0;  // from this level on there is an item in the list
};

/// True for an INTERVAL of Parquet, as DuckDB writes it.
bool IsInterval(const ThriftValue& element) {
  constexpr std::int64_t kInterval = 21, kBytes = 12;
  return element.NumberOr(6, -1) == kInterval && element.NumberOr(1, -1) == kParquetFixedBytes &&
         element.NumberOr(2, 0) == kBytes;
}

/// Why a column of the schema is not read, by its converted_type and logicalType; empty if it is.
std::string_view ReasonToLeaveOut(const ThriftValue& element) {
  constexpr std::int64_t kDecimal = 5, kDate = 6, kHalf = 15;
  const std::int64_t type = element.NumberOr(1, -1);
  const std::int64_t converted = element.NumberOr(6, -1);
  const bool is_decimal = converted == kDecimal || element[10].Has(5);
  if (converted == kDate || element[10].Has(6)) return "dates without a clock";
  if (type == kParquetFixedBytes) {
    const bool is_half = element[10].Has(kHalf) && element.NumberOr(2, 0) == 2;
    if (is_half || IsInterval(element)) return "";
    return is_decimal ? kDecimals : std::string_view("bytes");
  }
  if (type == kParquetBytes) return is_decimal ? kDecimals : kTexts;
  const bool is_number = type >= kParquetBoolean && type <= kParquetDouble;
  return is_number ? "" : "no numbers";
}

/// Unit of a column of times, by converted_type or logicalType; empty for others.
std::string_view TimeUnitOf(const ThriftValue& element) {
  constexpr std::int64_t kTimeMs = 7, kTimeUs = 8, kMomentMs = 9, kMomentUs = 10;
  const ThriftValue& logical = element[10];
  const ThriftValue& time = logical.Has(7) ? logical[7] : logical[8];
  const ThriftValue& unit = time[2];
  if (unit.Has(3) || element.NumberOr(1, -1) == kParquetInt96) return "ns";
  const std::int64_t converted = element.NumberOr(6, -1);
  if (IsInterval(element)) return "ms";
  if (unit.Has(1) || converted == kTimeMs || converted == kMomentMs) return "ms";
  if (unit.Has(2) || converted == kTimeUs || converted == kMomentUs) return "us";
  return "";
}

/// Reads the schema, a tree written depth first. `durations`: columns with a unit of time that the
/// schema does not have.
class SchemaReader {
 public:
  SchemaReader(const std::vector<ThriftValue>& elements,
               std::vector<std::pair<std::string, std::string_view>> durations)
      : elements_(elements), durations_(std::move(durations)) {
    if (elements_.empty()) FailAsDamaged("it has no schema");
    const std::int64_t children = elements_[next_++].NumberOr(5, 0);
    for (std::int64_t i = 0; i < children; ++i) Read("", {}, false, 0);
  }
  std::vector<Leaf> leaves() && { return std::move(leaves_); }

 private:
  /// `is_only_item`: of a list.
  void Read(const std::string& parent, Leaf leaf, bool is_only_item, int depth) {
    constexpr int kMostNested = 32;
    if (next_ >= elements_.size() || depth > kMostNested) FailAsDamaged("its schema is cut off");
    const ThriftValue& element = elements_[next_++];
    const std::string own(element[4].bytes);
    const std::int64_t repetition = element.NumberOr(3, kRequired);
    if (repetition != kRequired) ++leaf.most_defined;
    if (repetition == kRepeated) {
      leaf.item_defined = leaf.most_defined;
      ++leaf.repeated;
    }
    // The nodes of a list have names that no person gave: the repeated one and its only child.
    std::string name = parent.empty() ? own : fmt::format("{}_{}", parent, own);
    if ((repetition == kRepeated || is_only_item) && !parent.empty()) name = parent;
    const std::int64_t children = element.NumberOr(5, 0);
    const bool has_only_item = repetition == kRepeated && children == 1;
    if (children > 0) {
      for (std::int64_t i = 0; i < children; ++i) Read(name, leaf, has_only_item, depth + 1);
      return;
    }
    constexpr std::int64_t kFirstUnsigned = 11, kLastUnsigned = 14;
    const std::int64_t converted = element.NumberOr(6, -1);
    leaf.type = element.NumberOr(1, -1);
    std::string_view time_unit = TimeUnitOf(element);
    for (const auto& [duration, unit] : durations_) {
      if (duration == name && leaf.type == kParquetInt64) time_unit = unit;
    }
    if (name == kNamelessIndex) name = time_unit.empty() ? "nameless" : "index";
    leaf.name = time_unit.empty() ? name : NameOfTimes(name, time_unit);
    leaf.is_unsigned = (converted >= kFirstUnsigned && converted <= kLastUnsigned) ||
                       (element[10][10].Has(2) && element[10][10][2].number == 0);
    if (leaf.type == kParquetInt32 || leaf.type == kParquetInt64) {
      const ThriftValue& decimal = element[10][5];
      leaf.factor = std::pow(10.0, -decimal.NumberOr(1, element.NumberOr(7, 0)));
    }
    leaf.is_interval = IsInterval(element);
    leaf.left_out = ReasonToLeaveOut(element);
    if (leaf.left_out == kTexts && leaf.repeated == 0 && (TimeScaleS(name) || MayBeTime(name))) {
      leaf.is_time_text = true;
      leaf.left_out.clear();
    }
    leaves_.push_back(std::move(leaf));
  }

  const std::vector<ThriftValue>& elements_;
  std::vector<std::pair<std::string, std::string_view>> durations_;
  std::size_t next_ = 0;
  std::vector<Leaf> leaves_;
};

std::string Inflated(std::string_view bytes, std::size_t size) {
  std::string text(size, '\0');
  z_stream stream = {};
  constexpr int kGzipToo = 32;
  if (inflateInit2(&stream, MAX_WBITS + kGzipToo) != Z_OK) FailAsDamaged("gzip cannot begin");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(size);
  const int result = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (result != Z_STREAM_END || stream.avail_out != 0) FailAsDamaged("a page is not whole");
  return text;
}

/// Errors: UserError for another codec, or if there are not `size` bytes.
std::string Decompressed(std::string_view bytes, std::int64_t codec, std::size_t size) {
  std::string text;
  switch (codec) {
    case 0:
      text = bytes;
      break;
    case 1: {
      std::size_t found = 0;
      if (snappy_uncompressed_length(bytes.data(), bytes.size(), &found) != SNAPPY_OK ||
          found != size) {
        FailAsDamaged("a page has another size than it says");
      }
      text.resize(size);
      if (snappy_uncompress(bytes.data(), bytes.size(), text.data(), &found) != SNAPPY_OK) {
        FailAsDamaged("a page is not whole");
      }
      break;
    }
    case 2:
      return Inflated(bytes, size);
    case 6: {
      text.resize(size);
      const std::size_t found =
          ZSTD_decompress(text.data(), text.size(), bytes.data(), bytes.size());
      if (ZSTD_isError(found) != 0 || found != size) FailAsDamaged("a page is not whole");
      break;
    }
    default:
      throw UserError(
          fmt::format("is compressed by {}, which is not read; write it with snappy, "
                      "gzip or zstd",
                      NameIn(kCodecs, codec)));
  }
  if (text.size() != size) FailAsDamaged("a page has another size than it says");
  return text;
}

/// Numbers of `width` bits as runs and as packed groups of eight.
std::vector<std::uint32_t> RunsAndGroups(ByteReader bytes, unsigned width, std::size_t count) {
  constexpr unsigned kMostWidth = 32;
  if (width > kMostWidth) FailAsDamaged("a number of more than 32 bits");
  std::vector<std::uint32_t> numbers;
  if (width == 0) {
    numbers.resize(count);
    return numbers;
  }
  while (numbers.size() < count) {
    const std::uint64_t header = bytes.Varint();
    const std::size_t missing = count - numbers.size();
    if (header % 2 == 0) {
      std::uint32_t value = 0;
      const std::string_view digits = bytes.Take((width + 7) / 8);
      for (std::size_t i = 0; i < digits.size(); ++i) {
        value |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(digits[i])) << (8 * i);
      }
      if (header == 0) FailAsDamaged("a run of no values");
      numbers.insert(numbers.end(), std::min<std::uint64_t>(header / 2, missing), value);
      continue;
    }
    const std::uint64_t groups = header / 2;
    if (groups == 0 || groups > bytes.rest().size()) FailAsDamaged("a run is longer than its page");
    const std::string_view packed = bytes.Take(groups * width);
    const std::uint64_t values = std::min<std::uint64_t>(8 * groups, missing);
    for (std::uint64_t i = 0; i < values; ++i) {
      std::uint64_t bits = 0;
      const std::uint64_t first = i * width;
      for (std::uint64_t byte = first / 8; byte <= (first + width - 1) / 8; ++byte) {
        bits |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(packed[byte]))
                << (8 * (byte - first / 8));
      }
      const std::uint64_t mask = (std::uint64_t{1} << width) - 1;
      numbers.push_back(static_cast<std::uint32_t>((bits >> (first % 8)) & mask));
    }
  }
  return numbers;
}

std::vector<double> PlainValues(ByteReader bytes, const Leaf& leaf, std::size_t count) {
  std::vector<double> values;
  std::uint8_t flags = 0;
  for (std::size_t i = 0; i < count; ++i) {
    switch (leaf.type) {
      case kParquetBoolean:
        if (i % 8 == 0) flags = bytes.Little<std::uint8_t>();
        values.push_back(flags >> (i % 8) & 1);
        break;
      case kParquetInt32:
        values.push_back(leaf.is_unsigned ? static_cast<double>(bytes.Little<std::uint32_t>())
                                          : bytes.Little<std::int32_t>());
        break;
      case kParquetInt64:
        values.push_back(leaf.is_unsigned ? static_cast<double>(bytes.Little<std::uint64_t>())
                                          : static_cast<double>(bytes.Little<std::int64_t>()));
        break;
      case kParquetInt96: {  // time of day [ns] and day, as Spark writes them
        constexpr double kDay1970 = 2440588.0;
        const auto time_ns = static_cast<double>(bytes.Little<std::int64_t>());
        const double day = bytes.Little<std::uint32_t>() - kDay1970;
        values.push_back(day * 86400e9 + time_ns);
        break;
      }
      case kParquetFloat:
        values.push_back(bytes.Little<float>());
        break;
      case kParquetBytes:
        values.push_back(SecondsOfText(bytes.Take(bytes.Little<std::uint32_t>())).value_or(kNull));
        break;
      case kParquetFixedBytes:
        if (leaf.is_interval) {
          constexpr double kDay_ms = 86400e3;
          const auto months = bytes.Little<std::uint32_t>();
          const double days = bytes.Little<std::uint32_t>();
          const double time_ms = days * kDay_ms + bytes.Little<std::uint32_t>();
          values.push_back(months == 0 ? time_ms : kNull);
          break;
        }
        values.push_back(ValueOfHalf(bytes.Little<std::uint16_t>()));
        break;
      default:
        values.push_back(bytes.Little<double>());
        break;
    }
    if (leaf.factor != 1.0) values.back() *= leaf.factor;
  }
  return values;
}

/// One column of all row groups.
class ColumnReader {
 public:
  explicit ColumnReader(const Leaf& leaf) : leaf_(leaf) {}

  /// Pages of one row group. `bytes`: the file up to its description.
  void ReadChunk(std::string_view bytes, const ThriftValue& column) {
    const ThriftValue& meta = column[3];
    codec_ = meta.NumberOr(4, -1);
    const std::int64_t values = meta.NumberOr(5, -1);
    const std::int64_t data_at = meta.NumberOr(9, -1);
    const std::int64_t dictionary_at = meta.NumberOr(11, 0);
    const std::int64_t begin =
        dictionary_at > 0 && dictionary_at < data_at ? dictionary_at : data_at;
    if (meta.NumberOr(1, -1) != leaf_.type || values < 0 || values > kMostPageValues || begin < 0 ||
        begin > std::ssize(bytes)) {
      FailAsDamaged(fmt::format("the description of column {}", leaf_.name));
    }
    dictionary_.clear();
    ByteReader pages(bytes.substr(static_cast<std::size_t>(begin)));
    for (left_ = values; left_ > 0;) left_ -= ReadPage(pages);
  }

  NamedArray array(std::size_t rows) && {
    if (leaf_.repeated > 0) return ListArray(rows);
    if (values_.size() != rows)
      FailAsDamaged(fmt::format("column {} has not all rows", leaf_.name));
    return {.name = leaf_.name, .rows = rows, .columns = 1, .values = std::move(values_)};
  }

 private:
  /// Returns the number of values with their nulls.
  std::int64_t ReadPage(ByteReader& pages) {
    const ThriftValue header = ReadThrift(pages);
    const std::int64_t size = header.NumberOr(2, -1);
    const std::int64_t stored = header.NumberOr(3, -1);
    if (size < 0 || size > kMostPageBytes || stored < 0) FailAsDamaged("a page has no size");
    const std::string_view body = pages.Take(static_cast<std::size_t>(stored));
    ++page_;
    // The sum is over the bytes as they are stored, without the header, in pages of all kinds.
    constexpr std::int64_t kSum = 4;
    if (header.Has(kSum) && Crc32Of(body) != static_cast<std::uint32_t>(header[kSum].number)) {
      FailAsDamaged(
          fmt::format("page {} of {} does not have its checksum", page_, OneLine(leaf_.name, 60)));
    }
    const std::int64_t type = header.NumberOr(1, -1);
    if (type == kDictionaryPage) {
      const std::string text = Decompressed(body, codec_, static_cast<std::size_t>(size));
      dictionary_ = PlainValues(ByteReader(text), leaf_, CountIn(header[7]));
      return 0;
    }
    if (type == kDataPage) return ReadDataPage(header[5], body, static_cast<std::size_t>(size));
    if (type == kDataPageV2) return ReadDataPageV2(header[8], body, static_cast<std::size_t>(size));
    return 0;  // of an index
  }

  std::size_t CountIn(const ThriftValue& header) const {
    const std::int64_t count = header.NumberOr(1, -1);
    if (count < 0 || count > left_) FailAsDamaged("a page has more values than its column");
    return static_cast<std::size_t>(count);
  }

  std::int64_t ReadDataPage(const ThriftValue& header, std::string_view body, std::size_t size) {
    const std::size_t count = CountIn(header);
    const std::string text = Decompressed(body, codec_, size);
    ByteReader bytes(text);
    const auto levels = [&](unsigned most, std::int64_t encoding) {
      if (most == 0) return std::vector<std::uint32_t>(count);
      if (encoding != kRle) FailInEncoding(encoding);
      const std::string_view part = bytes.Take(bytes.Little<std::uint32_t>());
      return RunsAndGroups(ByteReader(part), WidthOf(most), count);
    };
    const auto repeated = levels(static_cast<unsigned>(leaf_.repeated), header.NumberOr(4, kRle));
    const auto defined = levels(leaf_.most_defined, header.NumberOr(3, kRle));
    Add(repeated, defined, bytes.rest(), header.NumberOr(2, -1));
    return static_cast<std::int64_t>(count);
  }

  std::int64_t ReadDataPageV2(const ThriftValue& header, std::string_view body, std::size_t size) {
    const std::size_t count = CountIn(header);
    ByteReader bytes(body);
    const auto part = [&](std::int64_t field) {
      const std::int64_t length = header.NumberOr(field, 0);
      if (length < 0) FailAsDamaged("a page has levels of negative size");
      return bytes.Take(static_cast<std::size_t>(length));
    };
    const std::string_view repeated_bytes = part(6);
    const std::string_view defined_bytes = part(5);
    const std::size_t levels_size = repeated_bytes.size() + defined_bytes.size();
    if (levels_size > size) FailAsDamaged("a page has another size than it says");
    const auto repeated = RunsAndGroups(ByteReader(repeated_bytes),
                                        WidthOf(static_cast<unsigned>(leaf_.repeated)), count);
    const auto defined =
        RunsAndGroups(ByteReader(defined_bytes), WidthOf(leaf_.most_defined), count);
    const bool is_compressed = header.NumberOr(7, 1) != 0;
    const std::string text =
        Decompressed(bytes.rest(), is_compressed ? codec_ : 0, size - levels_size);
    Add(repeated, defined, text, header.NumberOr(4, -1));
    return static_cast<std::int64_t>(count);
  }

  static unsigned WidthOf(unsigned most) { return static_cast<unsigned>(std::bit_width(most)); }

  [[noreturn]] void FailInEncoding(std::int64_t encoding) const {
    throw UserError(
        fmt::format("column {} has the encoding {}, which is not read; write it with "
                    "PLAIN or a dictionary",
                    leaf_.name, NameIn(kEncodings, encoding)));
  }

  std::vector<double> Values(std::string_view bytes, std::int64_t encoding,
                             std::size_t count) const {
    if (encoding == kPlain) return PlainValues(ByteReader(bytes), leaf_, count);
    ByteReader reader(bytes);
    if (encoding == kRle && leaf_.type == kParquetBoolean) {
      const std::string_view part = reader.Take(reader.Little<std::uint32_t>());
      const auto flags = RunsAndGroups(ByteReader(part), 1, count);
      return {flags.begin(), flags.end()};
    }
    if (encoding != kPlainDictionary && encoding != kRleDictionary) FailInEncoding(encoding);
    std::vector<double> values;
    if (count == 0) return values;
    const unsigned width = reader.Little<std::uint8_t>();
    for (const std::uint32_t place : RunsAndGroups(reader, width, count)) {
      if (place >= dictionary_.size()) FailAsDamaged("a value is not in its dictionary");
      values.push_back(dictionary_[place]);
    }
    return values;
  }

  void Add(const std::vector<std::uint32_t>& repeated, const std::vector<std::uint32_t>& defined,
           std::string_view bytes, std::int64_t encoding) {
    const auto count = static_cast<std::size_t>(std::ranges::count(defined, leaf_.most_defined));
    const std::vector<double> values = Values(bytes, encoding, count);
    std::size_t next = 0;
    for (std::size_t i = 0; i < defined.size(); ++i) {
      if (leaf_.repeated > 0 && repeated[i] == 0) lengths_.push_back(0);
      if (leaf_.repeated > 0 && lengths_.empty())
        FailAsDamaged("a list begins with its second item");
      if (leaf_.repeated > 0 && defined[i] < leaf_.item_defined) continue;  // an empty list
      values_.push_back(defined[i] == leaf_.most_defined ? values[next++] : kNull);
      if (leaf_.repeated > 0) ++lengths_.back();
      if (leaf_.repeated > 1) levels_.push_back(repeated[i]);
    }
  }

  NamedArray ListArray(std::size_t rows) {
    if (lengths_.size() != rows) {
      FailAsDamaged(fmt::format("column {} has not all rows", leaf_.name));
    }
    const std::size_t length = rows == 0 ? 0 : std::ranges::max(lengths_);
    NamedArray array{.name = leaf_.name, .rows = rows, .columns = length, .values = {}};
    array.is_flat = leaf_.repeated < 2;
    std::size_t next = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      if (lengths_[row] == 0) {
        array.values.insert(array.values.end(), length, kNull);
        continue;
      }
      if (lengths_[row] != length) {
        throw UserError(
            fmt::format("row {} of column {} has {} values and others {}; each must "
                        "have as many",
                        row + 1, leaf_.name, lengths_[row], length));
      }
      if (leaf_.repeated > 1 &&
          !std::equal(levels_.begin(), levels_.begin() + static_cast<std::ptrdiff_t>(length),
                      levels_.begin() + static_cast<std::ptrdiff_t>(next))) {
        throw UserError(
            fmt::format("row {} of column {} has lists of other lengths; each must "
                        "have as many",
                        row + 1, leaf_.name));
      }
      const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(next);
      array.values.insert(array.values.end(), begin, begin + static_cast<std::ptrdiff_t>(length));
      next += length;
    }
    return array;
  }

  const Leaf& leaf_;
  std::int64_t codec_ = 0;
  std::int64_t left_ = 0;  // values of the row group that are not read
  int page_ = 0;           // from 1, of all row groups
  std::vector<double> dictionary_;
  std::vector<double> values_;         // of lists one after the other
  std::vector<std::size_t> lengths_;   // of the list in each row
  std::vector<std::uint32_t> levels_;  // of the values of lists in lists: which list each begins
};

/// True if all texts of a column are written plainly or by a dictionary; others have no reader.
bool HasPlainTexts(const std::vector<ThriftValue>& groups, std::size_t column) {
  constexpr std::int64_t kFirstOther = 5;
  constexpr std::int64_t kEncodingsOfColumn = 2;
  return std::ranges::all_of(groups, [column](const ThriftValue& group) {
    const std::vector<ThriftValue>& chunks = group[1].items;
    return column < chunks.size() &&
           std::ranges::all_of(
               chunks[column][3][kEncodingsOfColumn].items, [](const ThriftValue& encoding) {
                 return encoding.number < kFirstOther || encoding.number == kRleDictionary;
               });
  });
}

}  // namespace

std::vector<NamedArray> ReadParquet(std::string_view bytes) {
  const std::size_t ends = sizeof(std::uint32_t) + kMagic.size();
  if (bytes.size() < kMagic.size() + ends) FailAsDamaged("it ends too early");
  if (bytes.ends_with("PARE")) throw UserError("is encrypted, which is not read");
  if (!bytes.ends_with(kMagic)) FailAsDamaged("its end is missing");
  const auto size = ByteReader(bytes.substr(bytes.size() - ends)).Little<std::uint32_t>();
  if (size > bytes.size() - ends - kMagic.size()) FailAsDamaged("its description is too long");
  const std::string_view pages = bytes.substr(0, bytes.size() - ends - size);
  ByteReader description(bytes.substr(pages.size(), size));
  const ThriftValue file = ReadThrift(description);
  std::vector<std::pair<std::string, std::string_view>> durations;
  for (const ThriftValue& fact : file[5].items) {
    if (fact[1].bytes == "ARROW:schema") durations = DurationsOf(fact[2].bytes);
  }
  const std::vector<Leaf> leaves = SchemaReader(file[2].items, std::move(durations)).leaves();
  const std::int64_t rows = file.NumberOr(3, -1);
  if (rows < 0 || rows > kMostPageValues) FailAsDamaged("it has no number of rows");
  std::vector<NamedArray> arrays;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (!leaves[i].left_out.empty()) {
      arrays.push_back({.name = leaves[i].name, .values = {}, .left_out = leaves[i].left_out});
      continue;
    }
    if (leaves[i].is_time_text && !HasPlainTexts(file[4].items, i)) {
      arrays.push_back({.name = leaves[i].name, .values = {}, .left_out = std::string(kTexts)});
      continue;
    }
    ColumnReader column(leaves[i]);
    for (const ThriftValue& group : file[4].items) {
      const std::vector<ThriftValue>& chunks = group[1].items;
      if (chunks.size() != leaves.size()) FailAsDamaged("a row group has not all columns");
      if (!chunks[i][1].bytes.empty()) throw UserError("has its columns in other files");
      column.ReadChunk(pages, chunks[i]);
    }
    NamedArray array = std::move(column).array(static_cast<std::size_t>(rows));
    const bool is_empty =
        std::ranges::all_of(array.values, [](double value) { return std::isnan(value); });
    if (leaves[i].is_time_text && is_empty) {
      array = {.name = leaves[i].name, .values = {}, .left_out = std::string(kTexts)};
    }
    arrays.push_back(std::move(array));
  }
  return arrays;
}

}  // namespace gauntlet::sim
