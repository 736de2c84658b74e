#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
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
#include "sim/tables/file_bytes.h"
#include "sim/tables/parquet_pages.h"
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
enum Repetition { kRequired = 0, kOptional = 1, kRepeated = 2 };
enum PageType { kDataPage = 0, kDictionaryPage = 2, kDataPageV2 = 3 };

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
  std::vector<ParquetLeaf> leaves() && { return std::move(leaves_); }

 private:
  /// `is_only_item`: of a list.
  void Read(const std::string& parent, ParquetLeaf leaf, bool is_only_item, int depth) {
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
  std::vector<ParquetLeaf> leaves_;
};

/// Pages of a column in one row group.
struct Chunk {
  std::uint64_t begin = 0;
  std::int64_t values = 0;  // with nulls
  std::int64_t codec = 0;
};

/// The description of a file at its end.
struct Description {
  FileBytes bytes;
  std::uint64_t end = 0;  // of the pages
  std::size_t rows = 0;
  std::vector<ParquetLeaf> leaves = {};
  std::vector<std::vector<Chunk>> chunks = {};  // of each leaf; none of those that are left out
};

/// One column of all row groups, from the first row on. One page is in memory.
class ColumnReader {
 public:
  /// `has_values`: false to read the levels alone.
  ColumnReader(std::shared_ptr<const Description> file, std::size_t column, bool has_values)
      : file_(std::move(file)),
        leaf_(file_->leaves[column]),
        chunks_(file_->chunks[column]),
        has_values_(has_values) {}

  /// Appends the values of the next rows, of lists `width` in each.
  void Rows(std::size_t rows, std::size_t width, std::vector<double>& values) {
    for (; rows > 0 && leaf_.repeated > 0; --rows) {
      const std::size_t before = values.size();
      NextList([&] { values.push_back(values_[next_]); });
      if (values.size() == before) values.insert(values.end(), width, kNull);
    }
    while (rows > 0) {
      if (!HasNext()) FailWithoutRows();
      const std::size_t count = std::min(rows, values_.size() - next_);
      const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(next_);
      values.insert(values.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
      next_ += count;
      rows -= count;
    }
  }

  /// Calls `item` for each item of the list in the next row. False behind the last row.
  bool NextList(const std::function<void()>& item) {
    if (!HasNext()) return false;
    if (repeated_[next_] != 0) FailAsDamaged("a list begins with its second item");
    do {
      if (defined_[next_] >= leaf_.item_defined) item();
      ++next_;
    } while (HasNext() && repeated_[next_] != 0);
    return true;
  }
  /// The level of the item that NextList() gives: 1 for the first of an inner list.
  std::uint32_t repeated() const { return repeated_[next_]; }

  [[noreturn]] void FailWithoutRows() const {
    FailAsDamaged(fmt::format("column {} has not all rows", leaf_.name));
  }

 private:
  /// False at the end of the column.
  bool HasNext() {
    while (next_ == defined_.size()) {
      while (left_of_page_ == 0) {
        if (left_ == 0 && !NextChunk()) return false;
        if (left_ > 0) ReadPage();
      }
      ReadSlice();
    }
    return true;
  }

  bool NextChunk() {
    if (chunk_ == chunks_.size()) return false;
    dictionary_.clear();
    left_ = chunks_[chunk_].values;
    place_ = chunks_[chunk_++].begin;
    return true;
  }
  std::int64_t codec() const { return chunks_[chunk_ - 1].codec; }

  /// The header of the page at place_, which moves behind it.
  ThriftValue ReadHeader() {
    constexpr std::uint64_t kUsual = 1024, kMost = std::uint64_t{1} << 24;
    const std::uint64_t left = file_->end - place_;
    for (std::uint64_t size = kUsual;; size = kMost) {
      const auto count = static_cast<std::size_t>(std::min(size, left));
      ByteReader bytes(file_->bytes.At(place_, count, head_));
      try {
        ThriftValue header = ReadThrift(bytes);
        place_ += count - bytes.rest().size();
        return header;
      } catch (const UserError&) {  // it is longer, as one with long statistics, or damaged
        if (size == kMost || count == left) throw;
      }
    }
  }

  void ReadPage() {
    const ThriftValue header = ReadHeader();
    const std::int64_t size = header.NumberOr(2, -1);
    const std::int64_t stored = header.NumberOr(3, -1);
    if (size < 0 || size > kMostPageBytes || stored < 0) FailAsDamaged("a page has no size");
    if (static_cast<std::uint64_t>(stored) > file_->end - place_) {
      FailAsDamaged("it ends too early");
    }
    const std::string_view body =
        file_->bytes.At(place_, static_cast<std::size_t>(stored), stored_);
    place_ += static_cast<std::uint64_t>(stored);
    ++page_;
    // The sum is over the bytes as they are stored, without the header, in pages of all kinds.
    constexpr std::int64_t kSum = 4;
    if (header.Has(kSum) && Crc32Of(body) != static_cast<std::uint32_t>(header[kSum].number)) {
      FailAsDamaged(
          fmt::format("page {} of {} does not have its checksum", page_, OneLine(leaf_.name, 60)));
    }
    const std::int64_t type = header.NumberOr(1, -1);
    if (type == kDictionaryPage) {
      ReadDictionary(header[7], Unpacked(body, codec(), static_cast<std::size_t>(size)));
    } else if (type == kDataPage) {
      BeginDataPage(header[5], Unpacked(body, codec(), static_cast<std::size_t>(size)));
      if (codec() != 0) stored_ = {};  // as large as the page, in each column
    } else if (type == kDataPageV2) {
      BeginDataPageV2(header[8], body, static_cast<std::size_t>(size));
    }  // else of an index
  }

  /// In `body`, or in text_.
  std::string_view Unpacked(std::string_view body, std::int64_t codec, std::size_t size) {
    if (codec == 0) {
      if (body.size() != size) FailAsDamaged("a page has another size than it says");
      return body;
    }
    return text_ = DecompressedPage(body, codec, size);
  }

  std::size_t CountIn(const ThriftValue& header) const {
    const std::int64_t count = header.NumberOr(1, -1);
    if (count < 0 || count > left_) FailAsDamaged("a page has more values than its column");
    return static_cast<std::size_t>(count);
  }

  void ReadDictionary(const ThriftValue& header, std::string_view text) {
    const std::size_t count = CountIn(header);
    constexpr std::size_t kPart = 4096;  // memory follows what is there, not what it says
    PageValues values(text, kParquetPlain, leaf_, dictionary_);
    dictionary_.clear();
    while (dictionary_.size() < count) {
      const std::size_t before = dictionary_.size();
      dictionary_.resize(std::min(before + kPart, count));
      values.Next(std::span(dictionary_).subspan(before));
    }
  }

  void BeginDataPage(const ThriftValue& header, std::string_view text) {
    const std::size_t count = CountIn(header);
    ByteReader bytes(text);
    const auto levels = [&](unsigned most, std::int64_t encoding) {
      if (most == 0) return RunReader();
      if (encoding != kParquetRle) FailInEncoding(leaf_, encoding);
      return RunReader(bytes.Take(bytes.Little<std::uint32_t>()), WidthOf(most));
    };
    repetition_ = levels(static_cast<unsigned>(leaf_.repeated), header.NumberOr(4, kParquetRle));
    definition_ = levels(leaf_.most_defined, header.NumberOr(3, kParquetRle));
    Begin(count, bytes.rest(), header.NumberOr(2, -1));
  }

  void BeginDataPageV2(const ThriftValue& header, std::string_view body, std::size_t size) {
    const std::size_t count = CountIn(header);
    ByteReader bytes(body);
    const auto part = [&](std::int64_t field) {
      const std::int64_t length = header.NumberOr(field, 0);
      if (length < 0) FailAsDamaged("a page has levels of negative size");
      return bytes.Take(static_cast<std::size_t>(length));
    };
    const std::string_view repeated = part(6);
    const std::string_view defined = part(5);
    const std::size_t levels_size = repeated.size() + defined.size();
    if (levels_size > size) FailAsDamaged("a page has another size than it says");
    repetition_ = RunReader(repeated, WidthOf(static_cast<unsigned>(leaf_.repeated)));
    definition_ = RunReader(defined, WidthOf(leaf_.most_defined));
    const bool is_compressed = header.NumberOr(7, 1) != 0;
    Begin(count, Unpacked(bytes.rest(), is_compressed ? codec() : 0, size - levels_size),
          header.NumberOr(4, -1));
  }

  void Begin(std::size_t count, std::string_view bytes, std::int64_t encoding) {
    page_values_ = PageValues(bytes, encoding, leaf_, dictionary_);
    left_of_page_ = count;
    left_ -= static_cast<std::int64_t>(count);
  }

  /// Levels and values of the next part of the page.
  void ReadSlice() {
    constexpr std::size_t kSlice = 2048;
    const std::size_t count = std::min(kSlice, left_of_page_);
    left_of_page_ -= count;
    next_ = 0;
    repeated_.resize(count);
    defined_.resize(count);
    repetition_.Next(repeated_);
    definition_.Next(defined_);
    values_.resize(count);
    if (!has_values_) return;
    const auto good = static_cast<std::size_t>(std::ranges::count(defined_, leaf_.most_defined));
    page_values_.Next(std::span(values_).first(good));
    if (good == count) return;
    for (std::size_t i = count, from = good; i-- > 0;) {
      values_[i] = defined_[i] == leaf_.most_defined ? values_[--from] : kNull;
    }
  }

  static unsigned WidthOf(unsigned most) { return static_cast<unsigned>(std::bit_width(most)); }

  std::shared_ptr<const Description> file_;
  const ParquetLeaf& leaf_;
  const std::vector<Chunk>& chunks_;
  bool has_values_;
  std::size_t chunk_ = 0;    // the next one
  std::uint64_t place_ = 0;  // of the next page
  std::int64_t left_ = 0;    // values of the row group in pages that are not read
  int page_ = 0;             // from 1, of all row groups
  std::string head_, stored_, text_;
  std::vector<double> dictionary_;
  RunReader repetition_, definition_;
  PageValues page_values_;
  std::size_t left_of_page_ = 0;  // values behind the slice
  std::vector<std::uint32_t> repeated_, defined_;
  std::vector<double> values_;  // of the slice, with nulls
  std::size_t next_ = 0;        // in the slice
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
                 return encoding.number < kFirstOther || encoding.number == kParquetRleDictionary;
               });
  });
}

/// The number of values in the list of each row.
/// Errors: UserError for lists of several lengths, and for lists in lists of several shapes.
std::size_t LengthOfLists(const std::shared_ptr<const Description>& file, std::size_t column) {
  const ParquetLeaf& leaf = file->leaves[column];
  ColumnReader lists(file, column, false);
  std::size_t rows = 0, length = 0, longest = 0;
  bool is_even = true;
  while (lists.NextList([&length] { ++length; })) {
    ++rows;
    is_even = is_even && (length == 0 || longest == 0 || length == longest);
    longest = std::max(longest, std::exchange(length, 0));
  }
  if (rows != file->rows) lists.FailWithoutRows();
  if (is_even && leaf.repeated < 2) return longest;
  ColumnReader again(file, column, false);
  std::vector<std::uint32_t> first, levels;  // which inner list each value begins
  for (std::size_t row = 1; again.NextList([&] { levels.push_back(again.repeated()); }); ++row) {
    if (levels.empty()) continue;
    if (levels.size() != longest) {
      throw UserError(
          fmt::format("row {} of column {} has {} values and others {}; each must "
                      "have as many",
                      row, leaf.name, levels.size(), longest));
    }
    if (first.empty()) first = levels;
    if (first != levels && leaf.repeated > 1) {
      throw UserError(
          fmt::format("row {} of column {} has lists of other lengths; each must "
                      "have as many",
                      row, leaf.name));
    }
    levels.clear();
  }
  return longest;
}

/// Errors: UserError for what no file has.
Chunk ChunkOf(const ThriftValue& column, const ParquetLeaf& leaf, std::uint64_t end) {
  if (!column[1].bytes.empty()) throw UserError("has its columns in other files");
  const ThriftValue& meta = column[3];
  const std::int64_t values = meta.NumberOr(5, -1);
  const std::int64_t data_at = meta.NumberOr(9, -1);
  const std::int64_t dictionary_at = meta.NumberOr(11, 0);
  const std::int64_t begin = dictionary_at > 0 && dictionary_at < data_at ? dictionary_at : data_at;
  if (meta.NumberOr(1, -1) != leaf.type || values < 0 || values > kMostPageValues || begin < 0 ||
      static_cast<std::uint64_t>(begin) > end) {
    FailAsDamaged(fmt::format("the description of column {}", leaf.name));
  }
  return {
      .begin = static_cast<std::uint64_t>(begin), .values = values, .codec = meta.NumberOr(4, -1)};
}

/// True if a column of texts has one that is a time.
bool HasTimes(const std::shared_ptr<const Description>& file, std::size_t column) {
  constexpr std::size_t kRows = 4096;
  ColumnReader reader(file, column, true);
  std::vector<double> values;
  for (std::size_t row = 0; row < file->rows; row += kRows) {
    values.clear();
    reader.Rows(std::min(kRows, file->rows - row), 1, values);
    if (std::ranges::any_of(values, [](double value) { return !std::isnan(value); })) return true;
  }
  return false;
}

std::shared_ptr<const Description> Described(FileBytes bytes) {
  auto file = std::make_shared<Description>(Description{.bytes = std::move(bytes)});
  constexpr std::size_t kEnds = sizeof(std::uint32_t) + kMagic.size();
  const std::uint64_t size = file->bytes.size();
  if (size < kMagic.size() + kEnds) FailAsDamaged("it ends too early");
  std::string room;
  const std::string_view ends = file->bytes.At(size - kEnds, kEnds, room);
  if (ends.ends_with("PARE")) throw UserError("is encrypted, which is not read");
  if (!ends.ends_with(kMagic)) FailAsDamaged("its end is missing");
  const auto described = ByteReader(ends).Little<std::uint32_t>();
  if (described > size - kEnds - kMagic.size()) FailAsDamaged("its description is too long");
  file->end = size - kEnds - described;
  ByteReader description(file->bytes.At(file->end, described, room));
  const ThriftValue whole = ReadThrift(description);
  std::vector<std::pair<std::string, std::string_view>> durations;
  for (const ThriftValue& fact : whole[5].items) {
    if (fact[1].bytes == "ARROW:schema") durations = DurationsOf(fact[2].bytes);
  }
  file->leaves = SchemaReader(whole[2].items, std::move(durations)).leaves();
  for (std::size_t i = 0; i < file->leaves.size(); ++i) {
    ParquetLeaf& leaf = file->leaves[i];
    if (leaf.is_time_text && !HasPlainTexts(whole[4].items, i)) leaf.left_out = kTexts;
  }
  const std::int64_t rows = whole.NumberOr(3, -1);
  if (rows < 0 || rows > kMostPageValues) FailAsDamaged("it has no number of rows");
  file->rows = static_cast<std::size_t>(rows);
  file->chunks.resize(file->leaves.size());
  for (const ThriftValue& group : whole[4].items) {
    const std::vector<ThriftValue>& columns = group[1].items;
    if (columns.size() != file->leaves.size()) FailAsDamaged("a row group has not all columns");
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const ParquetLeaf& leaf = file->leaves[i];
      if (leaf.left_out.empty()) {
        file->chunks[i].push_back(ChunkOf(columns[i], leaf, file->end));
      }
    }
  }
  return file;
}

}  // namespace

std::vector<NamedArray> OpenParquet(FileBytes bytes) {
  const std::shared_ptr<const Description> file = Described(std::move(bytes));
  std::vector<NamedArray> arrays;
  for (std::size_t i = 0; i < file->leaves.size(); ++i) {
    const ParquetLeaf& leaf = file->leaves[i];
    if (!leaf.left_out.empty()) {
      arrays.push_back({.name = leaf.name, .values = {}, .left_out = leaf.left_out});
      continue;
    }
    std::uint64_t values = 0;
    for (const Chunk& chunk : file->chunks[i]) values += static_cast<std::uint64_t>(chunk.values);
    if (leaf.repeated == 0 && values != file->rows) ColumnReader(file, i, false).FailWithoutRows();
    if (leaf.is_time_text && !HasTimes(file, i)) {
      arrays.push_back({.name = leaf.name, .values = {}, .left_out = std::string(kTexts)});
      continue;
    }
    const std::size_t width = leaf.repeated > 0 ? LengthOfLists(file, i) : 1;
    arrays.push_back({.name = leaf.name, .rows = file->rows, .columns = width, .values = {}});
    arrays.back().is_flat = leaf.repeated < 2;
    arrays.back().open = [file, i, width]() -> NamedArray::NextRows {
      const auto column = std::make_shared<ColumnReader>(file, i, true);
      return [column, width](std::size_t rows, std::vector<double>& into) {
        column->Rows(rows, width, into);
      };
    };
  }
  return arrays;
}

std::vector<NamedArray> ReadParquet(std::string_view bytes) {
  std::vector<NamedArray> arrays = OpenParquet(FileBytes(std::string(bytes)));
  for (NamedArray& array : arrays) ReadValues(array);
  return arrays;
}

}  // namespace gauntlet::sim
