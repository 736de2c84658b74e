// Parquet: files of another implementation (parquet/write.mjs), and pages of version 1 as pyarrow
// writes them, made here byte by byte.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/array_files.h"
#include "sim/tables/arrow_schema.h"
#include "sim/tables/checksum.h"
#include "sim/tables/text_lines.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim {
namespace {

using namespace std::string_literals;
using testing::ElementsAre;
using testing::HasSubstr;

std::string Shipped(const std::string& name) {
  std::ifstream file(SourceDir() + "/tests/recordings/parquet/" + name, std::ios::binary);
  EXPECT_TRUE(file) << name;
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Parquet, OfAnotherImplementationIsReadInEveryCompression) {
  for (const char* name : {"uncompressed.parquet", "snappy.parquet", "gzip.parquet"}) {
    SCOPED_TRACE(name);
    const std::vector<NamedArray> arrays = ReadParquet(Shipped(name));
    std::vector<std::string> names;
    for (const NamedArray& array : arrays) {
      if (!array.left_out.empty()) {
        EXPECT_EQ(array.name + ": " + array.left_out, "task: texts");
        continue;
      }
      names.push_back(array.name);
      ASSERT_EQ(array.rows, 60U);
      ASSERT_EQ(array.values.size(), 60 * array.columns);
    }
    ASSERT_THAT(names, ElementsAre("action", "timestamp", "frame_index", "episode_index", "is_done",
                                   "force"));
    ASSERT_EQ(arrays[0].columns, 3U);
    for (int k = 0; k < 60; ++k) {
      const auto row = static_cast<std::size_t>(k);
      EXPECT_EQ(arrays[0].values[3 * row], k);
      EXPECT_EQ(arrays[0].values[3 * row + 1], 0.5 * k);
      const double third = arrays[0].values[3 * row + 2];
      EXPECT_TRUE(k == 7 ? std::isnan(third) : third == -k);
      EXPECT_EQ(arrays[1].values[row], static_cast<float>(k % 30 / 30.0));
      EXPECT_EQ(arrays[2].values[row], k % 30);
      EXPECT_EQ(arrays[3].values[row], k < 30 ? 0 : 1);
      EXPECT_EQ(arrays[4].values[row], k % 30 == 29);
      const double force = arrays[6].values[row];
      EXPECT_TRUE(k == 3 ? std::isnan(force) : force == 0.1 * k);
    }
  }
}

std::string ErrorOfFolder(const std::filesystem::path& folder) {
  try {
    test::TextOf(TableSource(folder));
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Parquet, OfADataSetHasItsNamesAndExactTimes) {
  test::TemporaryDirectory folder;
  const std::filesystem::path chunk = folder.path() / "data" / "chunk-000";
  std::filesystem::create_directories(chunk);
  std::filesystem::create_directory(folder.path() / "meta");
  std::ofstream(folder.path() / "meta" / "info.json")
      << R"({"fps": 30, "features": {"action": {"names": ["wrist.pos", "tip.pos", "grip.pos"]}}})";
  std::ofstream(chunk / "file-000.parquet", std::ios::binary) << Shipped("snappy.parquet");
  std::ofstream(chunk / "file-001.parquet", std::ios::binary) << Shipped("gzip.parquet");
  const std::string text = test::TextOf(TableSource(folder.path()));
  EXPECT_THAT(text, testing::StartsWith("action_wrist_pos,action_tip_pos,action_grip_pos,"));
  EXPECT_EQ(std::ranges::count(text, '\n'), 122);
  EXPECT_THAT(text, HasSubstr(test::RemarkLine("left out: task (texts)")));
  EXPECT_THAT(text, HasSubstr(fmt::format("\n31,15.5,-31,{},", 1.0 / 30)));
  // Other writers put the names into another list or object.
  for (const char* names : {R"([["a", "b", "c"]])", R"({"motors": ["a", "b", "c"]})"}) {
    std::ofstream(folder.path() / "meta" / "info.json")
        << fmt::format(R"({{"features": {{"action": {{"names": {}}}}}}})", names);
    EXPECT_THAT(test::TextOf(TableSource(folder.path())),
                testing::StartsWith("action_a,action_b,"));
  }
  std::ofstream(chunk / "file-001.parquet") << "version https://git-lfs.github.com/spec/v1\n";
  EXPECT_THAT(ErrorOfFolder(folder.path()),
              HasSubstr("file-001.parquet, which is a pointer of Git LFS"));
}

// Thrift's compact protocol, as far as a file needs it. Fields are given with their distance.
std::string Varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  return bytes + static_cast<char>(value);
}
std::string Number(int distance, std::int64_t value) {
  return static_cast<char>(distance << 4 | 5) + Varint(static_cast<std::uint64_t>(value) << 1);
}
std::string Text(int distance, const std::string& text) {
  return static_cast<char>(distance << 4 | 8) + Varint(text.size()) + text;
}
std::string Group(int distance, const std::string& fields) {
  return static_cast<char>(distance << 4 | 12) + fields + '\0';
}
std::string List(int distance, const std::vector<std::string>& structures) {
  const std::size_t size = std::min<std::size_t>(structures.size(), 15);
  std::string bytes = {static_cast<char>(distance << 4 | 9), static_cast<char>(size << 4 | 12)};
  if (size == 15) bytes += Varint(structures.size());
  for (const std::string& structure : structures) bytes += structure + '\0';
  return bytes;
}
template <class Value>
std::string Little(Value value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}
std::string WithLength(const std::string& bytes) {
  return Little(static_cast<std::uint32_t>(bytes.size())) + bytes;
}

struct V1Column {
  std::int64_t codec = 0;
  std::int64_t encoding = 8;  // RLE_DICTIONARY
  std::string levels;
  std::string values;
  std::string dictionary;     // of doubles
  std::int64_t count = 0;     // levels in the page
  bool is_v2 = false;         // pages of version 2: levels have no length
  bool is_stored = false;     // version 2: without the codec
  bool has_sums = false;      // of pages
  std::size_t lost = 0;       // bytes at the end of the data page as it is stored
  std::string repeated = {};  // levels of version 2
  std::string defined = {};
};

/// Field 4 of a page's header behind field 3, and the distance of the field behind it.
std::string Sum(const V1Column& column, const std::string& stored) {
  return column.has_sums ? Number(1, static_cast<std::int32_t>(Crc32Of(stored))) : "";
}

std::string Packed(std::int64_t codec, const std::string& body) {
  constexpr std::int64_t kGzip = 2, kZstd = 6;
  std::string bytes(2 * body.size() + 128, '\0');
  if (codec == kZstd) {
    bytes.resize(ZSTD_compress(bytes.data(), bytes.size(), body.data(), body.size(), 3));
  } else if (codec == kGzip) {
    z_stream stream = {};
    EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(body.data()));
    stream.avail_in = static_cast<uInt>(body.size());
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_out = static_cast<uInt>(bytes.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    bytes.resize(stream.total_out);
    deflateEnd(&stream);
  } else {
    return body;
  }
  return bytes;
}

/// A column's pages, and its description in a row group.
struct V1Chunk {
  std::string pages;
  std::string meta;
};

/// `at`: place of the pages in the file.
V1Chunk ChunkOf(const V1Column& column, std::int64_t rows, std::int64_t type, std::int64_t at) {
  std::string pages;
  if (!column.dictionary.empty()) {
    const std::string body = Packed(column.codec, column.dictionary);
    pages += Number(1, 2) + Number(1, std::ssize(column.dictionary)) + Number(1, std::ssize(body)) +
             Sum(column, body) +
             Group(column.has_sums ? 3 : 4,
                   Number(1, std::ssize(column.dictionary) / 8) + Number(1, 0)) +
             '\0' + body;
  }
  const std::int64_t data_at = at + std::ssize(pages);
  const std::int64_t codec = column.is_stored ? 0 : column.codec;
  const std::string levels = column.is_v2 ? column.repeated + column.defined : column.levels;
  const std::string whole = levels + column.values;
  std::string body = column.is_v2 ? levels + Packed(codec, column.values) : Packed(codec, whole);
  body.resize(body.size() - column.lost);
  pages += Number(1, column.is_v2 ? 3 : 0) + Number(1, std::ssize(whole)) +
           Number(1, std::ssize(body)) + Sum(column, body);
  const int behind = column.has_sums ? 4 : 3;  // number of the last field
  if (column.is_v2) {
    const std::string stored = column.is_stored ? std::string{0x12} : "";  // field 7, false
    pages +=
        Group(8 - behind, Number(1, column.count) + Number(1, 0) + Number(1, rows) +
                              Number(1, column.encoding) + Number(1, std::ssize(column.defined)) +
                              Number(1, std::ssize(column.repeated)) + stored);
  } else {
    pages += Group(5 - behind, Number(1, column.count) + Number(1, column.encoding) + Number(1, 3) +
                                   Number(1, 3));
  }
  pages += '\0' + body;
  std::string meta =
      Number(1, type) + Number(3, column.codec) + Number(1, column.count) + Number(4, data_at);
  if (!column.dictionary.empty()) meta += Number(2, at);
  return {.pages = std::move(pages), .meta = std::move(meta)};
}

/// A file with one column of this schema, in row groups of as many rows each.
std::string V1File(const std::vector<V1Column>& groups, std::int64_t rows_of_each,
                   std::vector<std::string> schema, std::int64_t type,
                   const std::string& arrow_schema = "") {
  std::string file = "PAR1";
  std::vector<std::string> described;
  for (const V1Column& column : groups) {
    const V1Chunk chunk = ChunkOf(column, rows_of_each, type, std::ssize(file));
    file += chunk.pages;
    described.push_back(List(1, {Group(3, chunk.meta)}));
  }
  schema.insert(schema.begin(), Text(4, "root") + Number(1, 1));
  const std::string facts =
      arrow_schema.empty() ? "" : List(1, {Text(1, "ARROW:schema") + Text(1, arrow_schema)});
  const std::string description = Number(1, 1) + List(1, schema) +
                                  Number(1, rows_of_each * std::ssize(groups)) +
                                  List(1, described) + facts + '\0';
  return file + description + Little(static_cast<std::uint32_t>(description.size())) + "PAR1";
}

std::string V1File(const V1Column& column, std::int64_t rows, std::vector<std::string> schema,
                   std::int64_t type, const std::string& arrow_schema = "") {
  return V1File(std::vector{column}, rows, std::move(schema), type, arrow_schema);
}

const std::string kListNode = Number(3, 2) + Text(1, "list") + Number(1, 1);

/// A column `f`, a list of doubles or, without `is_list`, a double.
std::string V1File(const V1Column& column, std::int64_t rows, bool is_list) {
  if (!is_list) return V1File(column, rows, {Number(1, 5) + Number(2, 1) + Text(1, "f")}, 5);
  return V1File(column, rows,
                {Number(3, 1) + Text(1, "f") + Number(1, 1) + Number(1, 3), kListNode,
                 Number(1, 5) + Number(2, 1) + Text(1, "element")},
                5);
}

/// Rows {1, 2}, null, {1, null}, {1, 2} by a dictionary of 1 and 2.
V1Column Lists() {
  // Repetition 0 1 0 0 1 0 1, definition 3 3 0 3 2 3 3: one packed group each.
  return {.levels = WithLength(std::string{3, 0b01010010}) +
                    WithLength(std::string{3, static_cast<char>(0b11001111),
                                           static_cast<char>(0b00111110)}),
          .values = std::string{1, 3, 0b00010010},
          .dictionary = Little(1.0) + Little(2.0),
          .count = 7};
}

TEST(Parquet, ListsOfVersionOneHaveNullsAndADictionary) {
  for (const std::int64_t codec : {0, 6}) {
    V1Column column = Lists();
    column.codec = codec;
    const std::vector<NamedArray> arrays = ReadParquet(V1File(column, 4, true));
    ASSERT_EQ(arrays.size(), 1U);
    EXPECT_EQ(arrays[0].name, "f");
    EXPECT_EQ(arrays[0].columns, 2U);
    EXPECT_THAT(arrays[0].values,
                ElementsAre(1, 2, testing::IsNan(), testing::IsNan(), 1, testing::IsNan(), 1, 2));
  }
}

/// Lists() in pages of version 2.
V1Column NewerLists() {
  V1Column column = Lists();
  column.is_v2 = true;
  column.repeated = column.levels.substr(4, 2);
  column.defined = column.levels.substr(10);
  return column;
}

TEST(Parquet, PagesOfBothVersionsHaveTheSameValuesInEveryCodec) {
  const std::vector<double> expected = ReadParquet(V1File(Lists(), 4, true))[0].values;
  for (V1Column column : {Lists(), NewerLists()}) {
    for (const std::int64_t codec : {0, 2, 6}) {
      for (const bool is_stored : {false, true}) {
        column.codec = codec;
        column.is_stored = column.is_v2 && is_stored;
        const std::vector<double> found = ReadParquet(V1File(column, 4, true))[0].values;
        EXPECT_TRUE(std::ranges::equal(found, expected, [](double a, double b) {
          return a == b || (std::isnan(a) && std::isnan(b));
        })) << codec;
      }
    }
  }
}

std::string ErrorIn(const std::string& bytes) {
  try {
    ReadParquet(bytes);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

// A bit of any page: of the dictionary, which is page 1, or of the values.
TEST(Parquet, ThatHasChecksumsIsRefusedWhereAPageChanged) {
  for (V1Column column : {Lists(), NewerLists()}) {
    for (const std::int64_t codec : {0, 2, 6}) {
      SCOPED_TRACE(codec);
      column.codec = codec;
      column.has_sums = true;
      const std::string whole = V1File(column, 4, true);
      ASSERT_EQ(ErrorIn(whole), "");
      const std::string dictionary = Packed(codec, column.dictionary);
      const std::string values =
          Packed(codec, column.is_v2 ? column.values : column.levels + column.values);
      int page = 0;
      for (const std::string& body : {dictionary, values}) {
        ++page;
        const std::size_t at = whole.find(body);
        ASSERT_NE(at, std::string::npos);
        for (std::size_t i = 0; i < body.size(); ++i) {
          std::string damaged = whole;
          damaged[at + i] = static_cast<char>(damaged[at + i] ^ 1);
          EXPECT_THAT(
              ErrorIn(damaged),
              HasSubstr(fmt::format("is damaged: page {} of f does not have its checksum", page)));
        }
      }
      if (!column.is_v2) continue;
      std::string damaged = whole;
      char& level = damaged[damaged.find(column.repeated + column.defined)];
      level = static_cast<char>(level ^ 1);
      EXPECT_THAT(ErrorIn(damaged), HasSubstr("does not have its checksum"));
    }
  }
}

// A page that is not whole is damage, and no zeros.
TEST(Parquet, OfAPageThatIsNotWholeNothingIsRead) {
  for (const bool is_v2 : {false, true}) {
    V1Column column = {.encoding = 0, .levels = "", .values = "", .dictionary = "", .count = 500};
    column.is_v2 = is_v2;
    for (int k = 0; k < 500; ++k) column.values += Little(std::sin(0.1 * k));
    for (const std::int64_t codec : {2, 6}) {
      column.codec = codec;
      const std::string leaf = Number(1, 5) + Number(2, 0) + Text(1, "f");
      column.lost = 0;
      EXPECT_EQ(ErrorIn(V1File(column, 500, {leaf}, 5)), "");
      // From the last bytes, which are gzip's own checksum and size, to half of the page.
      const std::size_t half = Packed(codec, column.values).size() / 2;
      for (column.lost = 1; column.lost < half; column.lost += column.lost < 12 ? 1 : 97) {
        EXPECT_THAT(ErrorIn(V1File(column, 500, {leaf}, 5)),
                    HasSubstr("is damaged: a page is not whole"))
            << column.lost;
      }
    }
  }
}

TEST(Parquet, PlainValuesOfVersionOneHaveRunsOfLevels) {
  // 300 values of which the last 100 are null: definition 1 x 200, 0 x 100.
  std::string values;
  for (int k = 0; k < 200; ++k) values += Little(0.25 * k);
  const V1Column column = {.encoding = 0,
                           .levels = WithLength(Varint(400) + '\1' + Varint(200) + '\0'),
                           .values = values,
                           .dictionary = "",
                           .count = 300};
  const std::vector<NamedArray> arrays = ReadParquet(V1File(column, 300, false));
  ASSERT_EQ(arrays.size(), 1U);
  EXPECT_EQ(arrays[0].values[199], 49.75);
  EXPECT_TRUE(std::isnan(arrays[0].values[200]));
}

/// Rows of two lists each, of doubles from 0; `repeated`: packed levels of the second row.
std::string ListsOfLists(char repeated) {
  std::string values;
  for (int k = 0; k < 8; ++k) values += Little(1.0 * k);
  // Repetition 0 2 1 2 in the first row, definition 3 eight times.
  return V1File({.encoding = 0,
                 .levels = WithLength(std::string{3, static_cast<char>(0b10011000), repeated}) +
                           WithLength(std::string{16, 3}),
                 .values = values,
                 .dictionary = "",
                 .count = 8},
                2,
                {Number(3, 1) + Text(1, "f") + Number(1, 1), kListNode,
                 Number(3, 0) + Text(1, "element") + Number(1, 1), kListNode,
                 Number(1, 5) + Number(2, 0) + Text(1, "element")},
                5);
}

TEST(Parquet, ListsOfListsAreReadIfAllHaveOneShape) {
  const std::vector<NamedArray> arrays = ReadParquet(ListsOfLists(static_cast<char>(0b10011000)));
  ASSERT_EQ(arrays.size(), 1U);
  EXPECT_EQ(arrays[0].name, "f");
  EXPECT_EQ(arrays[0].columns, 4U);
  EXPECT_THAT(arrays[0].values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  // Repetition 0 2 2 1: as many values in lists of three and one.
  EXPECT_THAT(ErrorIn(ListsOfLists(0b01101000)),
              HasSubstr("row 2 of column f has lists of other lengths"));
}

/// Two values of a required column with this physical type, written plainly.
NamedArray PlainColumn(std::int64_t type, const std::string& leaf, const std::string& values,
                       const std::string& arrow_schema = "") {
  const V1Column column = {
      .encoding = 0, .levels = "", .values = values, .dictionary = "", .count = 2};
  const std::vector<NamedArray> arrays = ReadParquet(V1File(column, 2, {leaf}, type, arrow_schema));
  EXPECT_EQ(arrays.size(), 1U);
  return arrays.front();
}

// Each beside the signed column of the same bytes.
TEST(Parquet, UnsignedColumnsHaveNoNegativeNumbers) {
  const std::string whole32 = Little(std::uint32_t{0x8000'0001}) + Little(std::uint32_t{7});
  const std::string whole64 =
      Little(std::uint64_t{0x8000'0000'0000'0000}) + Little(std::uint64_t{7});
  const auto leaf = [](std::int64_t type, const std::string& is) {
    return Number(1, type) + Number(2, 0) + Text(1, "f") + is;
  };
  // converted_type, field 6: UINT_8 to UINT_64 are 11 to 14, INT_8 to INT_64 are 15 to 18.
  for (const std::int64_t converted : {11, 12, 13}) {
    EXPECT_THAT(PlainColumn(1, leaf(1, Number(2, converted)), whole32).values,
                ElementsAre(2147483649.0, 7.0));
  }
  EXPECT_THAT(PlainColumn(1, leaf(1, Number(2, 17)), whole32).values,
              ElementsAre(-2147483647.0, 7.0));
  EXPECT_THAT(PlainColumn(2, leaf(2, Number(2, 14)), whole64).values,
              ElementsAre(9223372036854775808.0, 7.0));
  EXPECT_THAT(PlainColumn(2, leaf(2, Number(2, 18)), whole64).values,
              ElementsAre(-9223372036854775808.0, 7.0));
  // logicalType, field 10: an integer is its field 10, whose field 2 is true for a signed one.
  for (const bool is_signed : {false, true}) {
    const std::string integer =
        Group(6, Group(10, std::string{0x13, 32} + (is_signed ? '\x11' : '\x12')));
    EXPECT_THAT(PlainColumn(1, leaf(1, integer), whole32).values,
                ElementsAre(is_signed ? -2147483647.0 : 2147483649.0, 7.0));
  }
}

// Values are numbers of the dictionary of their own row group.
TEST(Parquet, EachRowGroupHasItsDictionary) {
  const auto group = [](double first, double second) {
    return V1Column{.levels = "",
                    .values = std::string{1, 3, 0b00000010},  // the first, then the second
                    .dictionary = Little(first) + Little(second),
                    .count = 2};
  };
  const std::string leaf = Number(1, 5) + Number(2, 0) + Text(1, "f");
  const std::vector<NamedArray> arrays =
      ReadParquet(V1File(std::vector{group(1, 2), group(3, 4), group(5, 6)}, 2, {leaf}, 5));
  EXPECT_THAT(arrays[0].values, ElementsAre(1, 2, 3, 4, 5, 6));
  // One without a dictionary has none of the group before.
  V1Column without = group(3, 4);
  without.dictionary.clear();
  EXPECT_THAT(ErrorIn(V1File(std::vector{group(1, 2), without}, 2, {leaf}, 5)),
              HasSubstr("not in its dictionary"));
}

/// Rows 0, 0.5 .. of a column `f`, each row group with its dictionary; one in nine is null.
std::string Halves(int groups, int rows_of_each, std::int64_t codec) {
  std::vector<V1Column> columns;
  for (int group = 0; group < groups; ++group) {
    V1Column& column = columns.emplace_back();
    column.codec = codec;
    column.encoding = 0;
    column.count = rows_of_each;
    column.has_sums = true;
    std::string levels;
    for (int i = 0; i < rows_of_each; ++i) {
      const int row = group * rows_of_each + i;
      levels += std::string{2, static_cast<char>(row % 9 != 0)};
      if (row % 9 != 0) column.values += Little(0.5 * row);
    }
    column.levels = WithLength(levels);
  }
  return V1File(columns, rows_of_each, {Number(1, 5) + Number(2, 1) + Text(1, "f")}, 5);
}

// Far more rows than a block of the table and a part of a page have.
TEST(Parquet, InManyRowGroupsIsReadAsInOne) {
  constexpr int kRows = 90'000;
  test::TemporaryDirectory folder;
  const auto text_of = [&](int groups, std::int64_t codec) {
    const std::filesystem::path file = folder.path() / "f.parquet";
    std::ofstream(file, std::ios::binary) << Halves(groups, kRows / groups, codec);
    return test::TextOf(TableSource(file));
  };
  const std::string whole = text_of(1, 0);
  EXPECT_THAT(whole, testing::StartsWith("f\nnan\n0.5\n1\n"));
  EXPECT_THAT(whole, testing::EndsWith("\n44999.5\n"));
  EXPECT_EQ(std::ranges::count(whole, '\n'), kRows + 1);
  EXPECT_EQ(text_of(10, 0), whole);
  EXPECT_EQ(text_of(9, 6), whole);
}

TEST(Parquet, IsHereABlockAtATime) {
  test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "f.parquet";
  std::ofstream(file, std::ios::binary) << Halves(2, 100'000, 6);
  const auto stream = std::get<std::shared_ptr<TableStream>>(TableSource(file));
  EXPECT_EQ(stream->all_rows(), 200'000U);
  std::size_t rows = stream->table().rows;  // the first block may be here
  while (stream->Advance()) {
    EXPECT_LE(stream->table().rows, 40'000U);
    rows += stream->table().rows;
  }
  EXPECT_EQ(rows, 200'000U);
}

// It is found where it is read, with the name of the file.
TEST(Parquet, OfWhichTheLastPageChangedIsReadUpToIt) {
  test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "f.parquet";
  std::string bytes = Halves(10, 40'000, 0);
  const std::size_t last = bytes.rfind(Little(0.5 * 399'999));
  ASSERT_NE(last, std::string::npos);
  bytes[last] = static_cast<char>(bytes[last] ^ 1);
  std::ofstream(file, std::ios::binary) << bytes;
  CsvReader reader(file.string(), TableSource(file), ProblemHandling::kAllowMissing);
  std::vector<double> row(1);
  std::size_t rows = 0;
  try {
    while (reader.NextRow(row)) ++rows;
    ADD_FAILURE() << "is read";
  } catch (const UserError& error) {
    EXPECT_EQ(error.place(), file.string());
    EXPECT_THAT(error.what(), HasSubstr("is damaged: page 10 of f does not have its checksum"));
  }
  EXPECT_GT(rows, 300'000U);
}

TEST(Parquet, HalvesDecimalsAndOldTimesAreNumbers) {
  const std::string half =
      Number(1, 7) + Number(1, 2) + Number(1, 0) + Text(1, "f") + Group(6, Group(15, ""));
  EXPECT_THAT(PlainColumn(7, half, "\x00\x3c\x00\xc0"s).values, ElementsAre(1.0, -2.0));
  const std::string decimal =
      Number(1, 1) + Number(2, 0) + Text(1, "f") + Number(2, 5) + Number(1, 2) + Number(1, 9);
  EXPECT_THAT(PlainColumn(1, decimal, Little(125) + Little(-5)).values, ElementsAre(1.25, -0.05));
  // INT96: nanoseconds of the day, then the day; 2440588 is 1 January 1970.
  const auto stamp = [](std::int64_t time_ns, std::uint32_t day) {
    return Little(time_ns) + Little(day);
  };
  const NamedArray time = PlainColumn(3, Number(1, 3) + Number(2, 0) + Text(1, "time"),
                                      stamp(7, 2440588) + stamp(0, 2440589));
  EXPECT_EQ(time.name, "time_ns");
  const std::string moment = Number(1, 2) + Number(2, 0) + Text(1, "recorded") + Number(2, 10);
  EXPECT_EQ(PlainColumn(2, moment, Little(std::int64_t{1}) + Little(std::int64_t{2})).name,
            "recorded_time_us");
  EXPECT_THAT(time.values, ElementsAre(7.0, 86400e9));
  const std::string date = Number(1, 1) + Number(2, 0) + Text(1, "day") + Number(2, 6);
  EXPECT_EQ(PlainColumn(1, date, "").left_out, "dates without a clock");
}

// Without a value there is no width of numbers either.
TEST(Parquet, PagesOfNullsAloneMayBeEmpty) {
  V1Column column = {.levels = WithLength(Varint(3 << 1) + '\0'),
                     .values = "",
                     .dictionary = Little(1.0),
                     .count = 3};
  for (const std::int64_t encoding : {0, 2, 8}) {
    column.encoding = encoding;
    EXPECT_THAT(ReadParquet(V1File(column, 3, false))[0].values, testing::Each(testing::IsNan()));
  }
}

// Numbers of the dictionary in every width, as packed groups of eight and then as a run.
TEST(Parquet, DictionariesOfEverySizeAreRead) {
  const std::string leaf = Number(1, 5) + Number(2, 0) + Text(1, "f");
  for (unsigned width = 1; width <= 12; ++width) {
    const std::uint32_t size = std::uint32_t{1} << width;
    std::string dictionary;
    for (std::uint32_t i = 0; i < size; ++i) dictionary += Little(0.5 * i);
    std::vector<double> expected;
    std::string packed(3 * width, '\0');
    for (std::uint32_t i = 0; i < 24; ++i) {
      const std::uint32_t place = (size - 1 - 7 * i) % size;
      expected.push_back(0.5 * place);
      for (unsigned bit = 0; bit < width; ++bit) {
        char& byte = packed[(i * width + bit) / 8];
        byte = static_cast<char>(byte | (place >> bit & 1) << (i * width + bit) % 8);
      }
    }
    expected.insert(expected.end(), size, 0.5 * (size - 1));
    const V1Column column = {.levels = "",
                             .values = static_cast<char>(width) + Varint(3 << 1 | 1) + packed +
                                       Varint(size << 1) +
                                       Little(size - 1).substr(0, (width + 7) / 8),
                             .dictionary = dictionary,
                             .count = 24 + size};
    EXPECT_EQ(ReadParquet(V1File(column, 24 + size, {leaf}, 5))[0].values, expected) << width;
  }
  V1Column wide = Lists();
  wide.values = std::string{33, 3};
  EXPECT_THAT(ErrorIn(V1File(wide, 4, true)), HasSubstr("a number of more than 32 bits"));
  wide.values = std::string{1, 0, 0};
  EXPECT_THAT(ErrorIn(V1File(wide, 4, true)), HasSubstr("a run of no values"));
  wide.values = std::string{1, 9, 0};
  EXPECT_THAT(ErrorIn(V1File(wide, 4, true)), HasSubstr("a run is longer than its page"));
}

TEST(Parquet, FlagsAreBitsOrRuns) {
  const std::string leaf = Number(1, 0) + Number(2, 0) + Text(1, "f");
  V1Column column = {.encoding = 0,
                     .levels = "",
                     .values = std::string{static_cast<char>(0b10110010), 0b01},
                     .dictionary = "",
                     .count = 10};
  const std::vector<double> flags = {0, 1, 0, 0, 1, 1, 0, 1, 1, 0};
  EXPECT_EQ(ReadParquet(V1File(column, 10, {leaf}, 0))[0].values, flags);
  column.encoding = 3;
  column.values = WithLength(Varint(2 << 1 | 1) + column.values);
  EXPECT_EQ(ReadParquet(V1File(column, 10, {leaf}, 0))[0].values, flags);
  EXPECT_THAT(
      ErrorIn(V1File(
          {.encoding = 3, .levels = "", .values = column.values, .dictionary = "", .count = 2}, 2,
          {Number(1, 5) + Number(2, 0) + Text(1, "f")}, 5)),
      HasSubstr("column f has the encoding RLE, which is not read"));
}

TEST(Parquet, TimesHaveTheirUnitInTheirName) {
  const std::string leaf = Number(1, 2) + Number(2, 0) + Text(1, "t");
  const std::string values = Little(std::int64_t{5}) + Little(std::int64_t{-6});
  for (const auto& [converted, name] :
       {std::pair(7, "t_ms"), {8, "t_us"}, {9, "t_ms"}, {10, "t_us"}, {18, "t"}}) {
    const NamedArray found = PlainColumn(2, leaf + Number(2, converted), values);
    EXPECT_EQ(found.name, name);
    EXPECT_THAT(found.values, ElementsAre(5, -6));
  }
  // logicalType: TIME is its field 7, TIMESTAMP its field 8; the unit is field 2 of both.
  for (const int kind : {7, 8}) {
    for (const auto& [unit, name] : {std::pair(1, "t_ms"), {2, "t_us"}, {3, "t_ns"}}) {
      const std::string logical =
          Group(6, Group(kind, std::string{0x11} + Group(1, Group(unit, ""))));
      EXPECT_EQ(PlainColumn(2, leaf + logical, values).name, name) << kind;
    }
  }
}

TEST(Parquet, LeavesOutWhatIsNoNumberOfAtMost64Bits) {
  const auto reason = [](std::int64_t type, const std::string& is) {
    return PlainColumn(type, Number(1, type) + Number(2, 0) + Text(1, "f") + is, "").left_out;
  };
  const std::string decimal = Group(6, Group(5, Number(1, 2) + Number(1, 30)));
  EXPECT_EQ(reason(6, ""), "texts");
  EXPECT_EQ(reason(7, ""), "bytes");
  for (const std::int64_t type : {6, 7}) {
    EXPECT_EQ(reason(type, decimal), "decimals in bytes; write them as doubles");
    EXPECT_EQ(reason(type, Number(2, 5)), "decimals in bytes; write them as doubles");
  }
  EXPECT_EQ(reason(1, Group(6, Group(6, ""))), "dates without a clock");
  EXPECT_EQ(reason(8, ""), "no numbers");
  // A half is two bytes.
  for (const std::int64_t size : {1, 4}) {
    const std::string half =
        Number(1, 7) + Number(1, size) + Number(1, 0) + Text(1, "f") + Group(6, Group(15, ""));
    EXPECT_EQ(PlainColumn(7, half, "").left_out, "bytes");
  }
  for (const auto& [type, values] : {std::pair(1, Little(125) + Little(-5)),
                                     {2, Little(std::int64_t{125}) + Little(std::int64_t{-5})}}) {
    EXPECT_THAT(
        PlainColumn(type, Number(1, type) + Number(2, 0) + Text(1, "f") + decimal, values).values,
        ElementsAre(1.25, -0.05));
  }
}

TEST(Parquet, ThatIsBrokenSaysWhere) {
  const std::string good = V1File(Lists(), 4, true);
  const std::size_t size_at = good.size() - 8;
  std::string file = good;
  file.replace(size_at, 4, Little(static_cast<std::uint32_t>(good.size() - 12)));
  EXPECT_THAT(ErrorIn(file), testing::Not(HasSubstr("its description is too long")));
  file.replace(size_at, 4, Little(static_cast<std::uint32_t>(good.size() - 11)));
  EXPECT_THAT(ErrorIn(file), HasSubstr("its description is too long"));
  EXPECT_THAT(ErrorIn(good.substr(0, good.size() - 1) + "E"), HasSubstr("is encrypted"));
  EXPECT_THAT(ErrorIn(good.substr(0, good.size() - 1) + "X"), HasSubstr("its end is missing"));
  EXPECT_THAT(ErrorIn("PAR1\1\0\0PAR1"), HasSubstr("it ends too early"));
  // One value more in a page than in its column, and one fewer in the dictionary.
  for (const std::int64_t codec : {-1, 8}) {
    V1Column column = Lists();
    column.codec = codec;
    EXPECT_THAT(ErrorIn(V1File(column, 4, true)), HasSubstr("is compressed by an unknown one"));
  }
  V1Column column = NewerLists();
  column.defined += std::string(100, '\0');
  EXPECT_EQ(ErrorIn(V1File(column, 4, true)), "");  // levels may have bytes behind them
  column = Lists();
  column.encoding = 10;
  EXPECT_THAT(ErrorIn(V1File(column, 4, true)), HasSubstr("has the encoding an unknown one"));
  // A list that begins with a second item.
  column = Lists();
  column.levels.replace(5, 1, std::string{0b01010011});
  EXPECT_THAT(ErrorIn(V1File(column, 4, true)), HasSubstr("a list begins with its second item"));
}

TEST(Parquet, NamesOfGroupsStandBeforeThoseOfColumns) {
  const V1Column two = {.encoding = 0,
                        .levels = "",
                        .values = Little(1.0) + Little(2.0),
                        .dictionary = "",
                        .count = 2};
  const std::string leaf = Number(1, 5) + Number(2, 0) + Text(1, "x");
  const auto name = [&](const std::vector<std::string>& schema) {
    return ReadParquet(V1File(two, 2, schema, 5))[0].name;
  };
  const std::string group = Number(3, 0) + Text(1, "hand") + Number(1, 1);
  EXPECT_EQ(name({leaf}), "x");
  EXPECT_EQ(name({group, leaf}), "hand_x");
  EXPECT_EQ(name({group, Number(3, 0) + Text(1, "tip") + Number(1, 1), leaf}), "hand_tip_x");
  // Up to 32 levels.
  std::vector<std::string> deep(32, group);
  deep.push_back(leaf);
  EXPECT_EQ(name(deep).substr(0, 10), "hand_hand_");
  deep.insert(deep.begin(), group);
  EXPECT_THAT(ErrorIn(V1File(two, 2, deep, 5)), HasSubstr("its schema is cut off"));
  EXPECT_THAT(ErrorIn(V1File(two, 2, {group}, 5)), HasSubstr("its schema is cut off"));
}

/// Columns t (duration in us) and joint (double), by polars 2.1.0 (PyPI), write_parquet().
constexpr const char* kSchemaOfPolars =
    "/////54AAAAEAAAA8v///xQAAAAEAAEAAAAKAAsACAAKAAQA+P///wwAAAAIAAgAAAAEAAIAAAA0AAAABAAAAMD///8cAA"
    "AAEAAAAAgAAAABAwAAAAAAAL7///8CAAAABQAAAGpvaW50AAAA7P///zAAAAAgAAAAGAAAAAESAAAQABIABAAQABEACAAA"
    "AAwAAAAAAPr///8CAAYABgAEAAEAAAB0AA==";
/// Columns a_s, b_ms, joint (double), c_us and d_ns, by pyarrow 26.0.1 (PyPI), write_table().
constexpr const char* kSchemaOfArrow =
    "/////zgBAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAUAAADUAAAAlAAAAGQAAAA0AA"
    "AABAAAAFD///8AAAESEAAAABgAAAAEAAAAAAAAAAQAAABkX25zAAAAAEL///8AAAMAfP///wAAARIQAAAAGAAAAAQAAAAA"
    "AAAABAAAAGNfdXMAAAAAbv///wAAAgCo////AAABAxAAAAAYAAAABAAAAAAAAAAFAAAAam9pbnQAAACa////AAACANT///"
    "8AAAESEAAAABwAAAAEAAAAAAAAAAQAAABiX21zAAAAAAQABAAEAAAAEAAUAAgABgAHAAwAAAAQABAAAAAAAAESEAAAABwA"
    "AAAEAAAAAAAAAAMAAABhX3MAAAAGAAgABgAGAAAAAAAAAAAAAAA=";

// Wrong: whole numbers without a unit, so that a recording of 100 Hz has a rate that is assumed.
TEST(Parquet, DurationsHaveTheUnitOfTheSchemaOfArrow) {
  using testing::Pair;
  EXPECT_THAT(DurationsOf(kSchemaOfPolars), ElementsAre(Pair("t", "us")));
  EXPECT_THAT(DurationsOf(kSchemaOfArrow), ElementsAre(Pair("a_s", "s"), Pair("b_ms", "ms"),
                                                       Pair("c_us", "us"), Pair("d_ns", "ns")));
  const std::string values = Little(std::int64_t{0}) + Little(std::int64_t{10000});
  const std::string leaf = Number(1, 2) + Number(2, 0) + Text(1, "t");
  const NamedArray time = PlainColumn(2, leaf, values, kSchemaOfPolars);
  EXPECT_EQ(time.name, "t_us");
  EXPECT_THAT(time.values, ElementsAre(0.0, 10000.0));
  EXPECT_EQ(PlainColumn(2, leaf, values).name, "t");
  // Damage has no units, or others, and reads nothing outside.
  const std::string whole = kSchemaOfArrow;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    DurationsOf(whole.substr(0, i));
    for (const char digit : {'A', 'P', 'f', '/'}) {
      std::string damaged = whole;
      damaged[i] = digit;
      DurationsOf(damaged);
    }
  }
}

// df.to_parquet() of pandas 3.1.1 with a DatetimeIndex: the last column, __index_level_0__.
TEST(Parquet, IndexOfPandasWithoutANameMayBeATime) {
  const std::string values = Little(std::int64_t{0}) + Little(std::int64_t{10000});
  const std::string name = Number(1, 2) + Number(2, 0) + Text(1, "__index_level_0__");
  EXPECT_EQ(PlainColumn(2, name + Number(2, 10), values).name, "index_time_us");
  EXPECT_EQ(PlainColumn(2, name, values).name, "nameless");
}

// Wrong: left out, so that the rate was assumed.
TEST(Parquet, TextsOfTimesAndIntervalsAreTimes) {
  const auto texts = [](const std::string& name, const std::string& first,
                        const std::string& second) {
    return PlainColumn(6, Number(1, 6) + Number(2, 0) + Text(1, name) + Number(2, 0),
                       WithLength(first) + WithLength(second));
  };
  const NamedArray time = texts("time", "1970-01-01T00:00:01.5Z", "1970-01-02 00:00:00");
  EXPECT_EQ(time.name, "time");
  EXPECT_THAT(time.values, ElementsAre(1.5, 86400.0));
  EXPECT_EQ(texts("time", "noon", "later").left_out, "texts");
  EXPECT_EQ(texts("task", "00:00:01", "00:00:02").left_out, "texts");
  // INTERVAL as DuckDB 2.0.1 (PyPI) writes it: months, days and ms.
  const auto interval = [](std::uint32_t months, std::uint32_t days, std::uint32_t ms) {
    return Little(months) + Little(days) + Little(ms);
  };
  const std::string leaf =
      Number(1, 7) + Number(1, 12) + Number(1, 0) + Text(1, "time") + Number(2, 21);
  const NamedArray elapsed = PlainColumn(7, leaf, interval(0, 0, 10) + interval(0, 1, 20));
  EXPECT_EQ(elapsed.name, "time_ms");
  EXPECT_THAT(elapsed.values, ElementsAre(10.0, 86400020.0));
  EXPECT_TRUE(std::isnan(PlainColumn(7, leaf, interval(1, 0, 0) + interval(0, 0, 1)).values[0]));
}

TEST(Parquet, ThatIsNotReadSaysWhy) {
  V1Column column = Lists();
  column.codec = 4;
  EXPECT_THAT(ErrorIn(V1File(column, 4, true)), HasSubstr("brotli"));
  column = Lists();
  column.encoding = 9;
  EXPECT_THAT(ErrorIn(V1File(column, 4, true)),
              HasSubstr("column f has the encoding BYTE_STREAM_SPLIT"));
  EXPECT_THAT(ErrorIn(V1File(Lists(), 5, true)), HasSubstr("column f has not all rows"));
  column = Lists();
  column.dictionary = Little(1.0);
  EXPECT_THAT(ErrorIn(V1File(column, 4, true)), HasSubstr("not in its dictionary"));
  // Repetition 0 0 0 0 1 0 1: the first lists have one value.
  column = Lists();
  column.levels.replace(5, 1, std::string{0b01010000});
  EXPECT_THAT(ErrorIn(V1File(column, 5, true)), HasSubstr("row 1 of column f has 1 values"));
  EXPECT_THAT(ErrorIn("PAR1PAR1"), HasSubstr("is damaged"));
}

// Every byte of a file, changed in several ways, and every length of it.
TEST(Parquet, ThatIsDamagedIsReadOrRefused) {
  for (const std::string& whole :
       {V1File(Lists(), 4, true), ListsOfLists(static_cast<char>(0b10011000)),
        Shipped("snappy.parquet"), Shipped("uncompressed.parquet")}) {
    const std::size_t step = whole.size() < 1000 ? 1 : 7;
    for (std::size_t i = 0; i < whole.size(); i += step) {
      for (const int change : {1, 0x80, 0xff}) {
        std::string damaged = whole;
        damaged[i] = static_cast<char>(damaged[i] ^ change);
        ErrorIn(damaged);
      }
      EXPECT_NE(ErrorIn(whole.substr(0, i)), "") << i;
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
