// Every type of number that NPY, NPZ and MAT files have, and the names and limits of arrays.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/array_files.h"
#include "sim/tables/array_table.h"
#include "sim/tables/file_format.h"
#include "tests/support/program.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

template <class Value>
std::string BytesOf(Value value, bool is_big = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (is_big) std::ranges::reverse(bytes);
  return bytes;
}

std::string ErrorOf(const auto& call) {
  try {
    call();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

std::string NpyHeader(const std::string& type, const std::string& shape) {
  return fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
}

std::string Npy(const std::string& header, const std::string& data) {
  return "\x93NUMPY\x01\x00"s + BytesOf(static_cast<std::uint16_t>(header.size())) + header + data;
}

template <class Value>
void ExpectNpyType(const std::string& type) {
  const std::array<Value, 3> values = {std::numeric_limits<Value>::lowest(), Value{1},
                                       std::numeric_limits<Value>::max()};
  for (const bool is_big : {false, true}) {
    std::string data;
    for (const Value value : values) data += BytesOf(value, is_big);
    const std::string order = sizeof(Value) == 1 ? "|" : is_big ? ">" : "<";
    EXPECT_THAT(ReadNpy(Npy(NpyHeader(order + type, "(3,)"), data), "a").values,
                ElementsAre(static_cast<double>(values[0]), 1.0, static_cast<double>(values[2])))
        << order << type;
  }
}

TEST(Npy, HasEveryTypeOfNumberInBothOrdersOfBytes) {
  ExpectNpyType<double>("f8");
  ExpectNpyType<float>("f4");
  ExpectNpyType<std::int8_t>("i1");
  ExpectNpyType<std::int16_t>("i2");
  ExpectNpyType<std::int32_t>("i4");
  ExpectNpyType<std::int64_t>("i8");
  ExpectNpyType<std::uint8_t>("u1");
  ExpectNpyType<std::uint16_t>("u2");
  ExpectNpyType<std::uint32_t>("u4");
  ExpectNpyType<std::uint64_t>("u8");
  EXPECT_THAT(ReadNpy(Npy(NpyHeader("|b1", "(2,)"), "\1\0"s), "a").values, ElementsAre(1, 0));
  for (const auto& [type, reason] : {std::pair("<f16", "numbers of more than 64 bits"),
                                     {"|V8", "no numbers"},
                                     {"|S3", "texts"},
                                     {"<m8", "dates without a clock"},
                                     {"<M8[Y]", "dates without a clock"},
                                     {"<M8[x]", "dates without a clock"}}) {
    EXPECT_EQ(ReadNpy(Npy(NpyHeader(type, "(1,)"), std::string(16, '\0')), "a").left_out, reason)
        << type;
  }
  for (const auto& [unit, value] : {std::pair("ns", 2.0),
                                    {"us", 2.0},
                                    {"ms", 2.0},
                                    {"s", 2.0},
                                    {"m", 120.0},
                                    {"h", 7200.0},
                                    {"D", 172800.0},
                                    {"W", 1209600.0},
                                    {"25s", 50.0}}) {
    const std::string type = fmt::format(">m8[{}]", unit);
    EXPECT_THAT(ReadNpy(Npy(NpyHeader(type, "(1,)"), BytesOf(std::int64_t{2}, true)), "t").values,
                ElementsAre(value))
        << type;
  }
}

TEST(Npy, HasHeadersOfEveryVersion) {
  const std::string header = NpyHeader("|u1", "(2,)"), data = "\3\4";
  for (const char version : {'\2', '\3'}) {
    const std::string bytes = "\x93NUMPY"s + version + '\0' +
                              BytesOf(static_cast<std::uint32_t>(header.size())) + header + data;
    EXPECT_THAT(ReadNpy(bytes, "a").values, ElementsAre(3, 4));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_NE(ErrorOf([&] { ReadNpy(bytes.substr(0, size), "a"); }), "") << size;
    }
  }
  for (const auto& [text, problem] :
       {std::pair("{'fortran_order': False, 'shape': (1,), }", "its header has no descr"),
        {"{'descr': '|u1', 'fortran_order': False, }", "its header has no shape"},
        {"{'descr': '|u1', 'shape': (1,), }", "its header has no fortran_order"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape' (1,)}", "its header is no dictionary"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': 1, }", "its shape is no tuple"},
        {"{'descr': '', 'fortran_order': False, 'shape': (1,), }", "its header has no type"}}) {
    EXPECT_THAT(ErrorOf([&, text = text] { ReadNpy(Npy(text, "1"), "a"); }), HasSubstr(problem));
  }
}

/// A file of a ZIP.
struct ZipFile {
  std::string name;
  std::string content;
  std::uint16_t method = 0;  // 8: deflated
};

std::string Deflated(const std::string& content) {
  std::string bytes(content.size() + 100, '\0');
  z_stream stream = {};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

/// APPNOTE 6.3: local files, each behind its head, then the directory, then its end. `extra` stands
/// behind the names, other lengths of it in the heads and in the directory.
std::string Zip(const std::vector<ZipFile>& files) {
  const auto u16 = [](std::size_t value) { return BytesOf(static_cast<std::uint16_t>(value)); };
  const auto u32 = [](std::size_t value) { return BytesOf(static_cast<std::uint32_t>(value)); };
  std::string zip, directory;
  for (const ZipFile& file : files) {
    const std::string packed = file.method == 8 ? Deflated(file.content) : file.content;
    const std::string facts = u16(20) + u16(0) + u16(file.method) + u32(0) + u32(0) +
                              u32(packed.size()) + u32(file.content.size()) + u16(file.name.size());
    directory += "PK\1\2" + u16(20) + facts + u16(5) + u16(3) + u16(0) + u16(0) + u32(0) +
                 u32(zip.size()) + file.name + "extra" + "say";
    zip += "PK\3\4" + facts + u16(4) + file.name + "more" + packed;
  }
  return zip + directory + "PK\5\6" + u16(0) + u16(0) + u16(files.size()) + u16(files.size()) +
         u32(directory.size()) + u32(zip.size()) + u16(0);
}

TEST(Npz, HasStoredAndDeflatedArrays) {
  std::string many;
  for (int i = 0; i < 500; ++i) many += BytesOf(0.5 * i);
  const std::string zip = Zip({{"a.npy", Npy(NpyHeader("<f8", "(500,)"), many), 8},
                               {"note.txt", "of no array", 0},
                               {"b.npy", Npy(NpyHeader("|u1", "(2,)"), "\3\4"), 0}});
  const std::vector<NamedArray> arrays = ReadNpz(zip);
  ASSERT_EQ(arrays.size(), 2U);
  EXPECT_EQ(arrays[0].name, "a");
  ASSERT_EQ(arrays[0].values.size(), 500U);
  EXPECT_EQ(arrays[0].values[499], 249.5);
  EXPECT_EQ(arrays[1].name, "b");
  EXPECT_THAT(arrays[1].values, ElementsAre(3, 4));
  EXPECT_EQ(FormatOfBytes(zip), FileFormat::kNpz);
  for (std::size_t size = 0; size < zip.size(); size += 13) {
    EXPECT_NE(ErrorOf([&] { ReadNpz(zip.substr(0, size)); }), "") << size;
  }
}

TEST(Npz, ThatIsNotReadSaysWhy) {
  const std::string content = Npy(NpyHeader("|u1", "(2,)"), "\3\4");
  EXPECT_THAT(ErrorOf([&] {
                ReadNpz(Zip({{"a.npy", content, 12}}));
              }),
              HasSubstr("is packed in a way that is not read"));
  const std::string whole = Zip({{"a.npy", content, 8}});
  const std::size_t entry = whole.find("PK\1\2");
  const auto with = [&](std::size_t place, std::uint32_t value) {
    std::string zip = whole;
    zip.replace(entry + place, 4, BytesOf(value));
    return ErrorOf([&] { ReadNpz(zip); });
  };
  for (const std::size_t place : {20, 24, 42}) {  // packed size, size, place in the file
    EXPECT_THAT(with(place, 0xffffffffU), HasSubstr("is larger than 4 GB"));
  }
  EXPECT_THAT(with(24, (1U << 28) + 1), HasSubstr("holds an array of 256 MB, must be at most 256"));
  EXPECT_THAT(with(24, 1U << 20), HasSubstr("a size in it is wrong"));
  const auto size = static_cast<std::uint32_t>(content.size());
  EXPECT_THAT(with(24, size + 1), HasSubstr("an array in it cannot be unpacked"));
  EXPECT_THAT(with(24, size - 1), HasSubstr("an array in it cannot be unpacked"));
  EXPECT_THAT(with(0, 0), HasSubstr("the directory of the ZIP is broken"));
}

TEST(FormatOfBytes, KnowsAZipByItsFirstFile) {
  for (const char* name : {"[Content_Types].xml", "xl/a.xml", "_rels/a", "docProps/a"}) {
    EXPECT_EQ(FormatOfBytes(Zip({{name, "x", 0}})), FileFormat::kXlsx) << name;
  }
  EXPECT_EQ(FormatOfBytes(Zip({{"a.csv", "x", 0}})), FileFormat::kZip);
  EXPECT_EQ(FormatOfBytes("PK\3\4"), FileFormat::kZip);
}

// --- MAT -----------------------------------------------------------------------------------------

class MatTypes : public testing::Test {
 protected:
  using Variables = std::vector<matvar_t*>;
  fs::path Write(const Variables& variables, mat_ft version = MAT_FT_MAT5) const {
    const fs::path file = folder_.path() / "a.mat";
    fs::remove(file);
    mat_t* const mat = Mat_CreateVer(file.c_str(), nullptr, version);
    for (matvar_t* variable : variables) {
      EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
      Mat_VarFree(variable);
    }
    Mat_Close(mat);
    return file;
  }
  std::string Table(const Variables& variables, const std::string& chosen = {}) const {
    return test::TextOf(TableSource(Write(variables), chosen));
  }
  std::string Error(const Variables& variables) const {
    return ErrorOf([&] { Table(variables); });
  }
  template <class Value>
  static matvar_t* Matrix(const char* name, matio_classes kind, matio_types type,
                          std::vector<Value> values, std::size_t columns = 1) {
    std::array<std::size_t, 2> size = {values.size() / columns, columns};
    return Mat_VarCreate(name, kind, type, 2, size.data(), values.data(), 0);
  }
  static matvar_t* Doubles(const char* name, std::vector<double> values, std::size_t columns = 1) {
    return Matrix<double>(name, MAT_C_DOUBLE, MAT_T_DOUBLE, std::move(values), columns);
  }
  static matvar_t* Letters(const char* name, const std::string& text, std::size_t columns) {
    return Matrix<char>(name, MAT_C_CHAR, MAT_T_UINT8, {text.begin(), text.end()}, columns);
  }
  static matvar_t* Cells(const char* name, std::array<std::size_t, 2> size,
                         std::vector<matvar_t*> cells) {
    return Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, size.data(), cells.data(), 0);
  }
  test::TemporaryDirectory folder_;
};

TEST_F(MatTypes, AreAllReadAsNumbers) {
  const auto check = [this](auto one, matio_classes kind, matio_types type) {
    using Value = decltype(one);
    const Value least = std::numeric_limits<Value>::lowest();
    const Value most = std::numeric_limits<Value>::max();
    EXPECT_EQ(Table({Matrix<Value>("a", kind, type, {least, one, most})}),
              fmt::format("a\n{}\n1\n{}\n", static_cast<double>(least), static_cast<double>(most)))
        << kind;
  };
  check(1.0, MAT_C_DOUBLE, MAT_T_DOUBLE);
  check(1.0F, MAT_C_SINGLE, MAT_T_SINGLE);
  check(std::int8_t{1}, MAT_C_INT8, MAT_T_INT8);
  check(std::uint8_t{1}, MAT_C_UINT8, MAT_T_UINT8);
  check(std::int16_t{1}, MAT_C_INT16, MAT_T_INT16);
  check(std::uint16_t{1}, MAT_C_UINT16, MAT_T_UINT16);
  check(std::int32_t{1}, MAT_C_INT32, MAT_T_INT32);
  check(std::uint32_t{1}, MAT_C_UINT32, MAT_T_UINT32);
  check(std::int64_t{1}, MAT_C_INT64, MAT_T_INT64);
  check(std::uint64_t{1}, MAT_C_UINT64, MAT_T_UINT64);
}

TEST_F(MatTypes, ThatAreNoRealNumbersAreLeftOut) {
  std::array<std::size_t, 2> size = {2, 1};
  std::array<double, 2> real = {1, 2}, imaginary = {3, 4};
  mat_complex_split_t parts = {real.data(), imaginary.data()};
  EXPECT_EQ(Table({Doubles("a", {7, 8}), Mat_VarCreate("z", MAT_C_DOUBLE, MAT_T_DOUBLE, 2,
                                                       size.data(), &parts, MAT_F_COMPLEX)}),
            "a\n7\n8\n" + test::RemarkLine("left out: z (complex numbers)"));
  EXPECT_EQ(Table({Doubles("a", {7, 8}), Doubles("empty", {})}), "a\n7\n8\n");
}

TEST_F(MatTypes, OfLettersNameTheColumnsBesideThem) {
  const std::vector<double> values = {1, 2, 3, 4, 5, 6};
  // A matrix of letters goes by columns: "ab " and "cde".
  EXPECT_EQ(Table({Doubles("g_data", values, 2), Letters("g_names", "acbd e", 3)}),
            "ab,cde\n1,4\n2,5\n3,6\n");
  EXPECT_EQ(
      Table({Doubles("g_data", values, 2),
             Cells("g_labels", {1, 2}, {Letters(nullptr, "tip", 3), Letters(nullptr, "ip", 2)}),
             Letters("g_unit", "rad", 3)}),
      "tip_rad,ip_rad\n1,4\n2,5\n3,6\n");
}

TEST_F(MatTypes, InCellsAreRecordingsOfTheirOwn) {
  const auto cells = [](std::array<std::size_t, 2> size) {
    std::vector<matvar_t*> all;
    for (std::size_t i = 0; i < size[0] * size[1]; ++i) {
      const double from = 10.0 * static_cast<double>(i);
      all.push_back(Doubles(nullptr, {from, from + 1}));
    }
    return Cells("c", size, std::move(all));
  };
  for (const std::array<std::size_t, 2> size : {std::array<std::size_t, 2>{1, 3}, {3, 1}}) {
    EXPECT_THAT(Error({cells(size)}),
                HasSubstr("has 3 recordings in c: c_1 (2 x 1), c_2 (2 x 1), c_3 (2 x 1)"));
    EXPECT_EQ(Table({cells(size)}, "c_3"), "c_3\n20\n21\n");
  }
  EXPECT_THAT(Error({cells({2, 2})}),
              HasSubstr("c_1_1 (2 x 1), c_2_1 (2 x 1), c_1_2 (2 x 1), c_2_2"));
  EXPECT_EQ(Table({cells({2, 2})}, "c_2_1"), "c_2_1\n10\n11\n");
}

/// Level 4 has the order of bytes in its type, and a head of five words.
TEST_F(MatTypes, OfLevel4HaveBothOrdersOfBytesAndEveryWidth) {
  const auto file_of = [this](const std::string& bytes) {
    const fs::path file = folder_.path() / "four.mat";
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  };
  const auto variable = [](const std::string& name, std::uint32_t kind, bool is_big, auto... all) {
    std::string bytes;
    const auto rows = static_cast<std::uint32_t>(sizeof...(all));
    for (const std::uint32_t word : {(is_big ? 1000U : 0U) + 10 * kind, rows, 1U, 0U,
                                     static_cast<std::uint32_t>(name.size() + 1)}) {
      bytes += BytesOf(word, is_big);
    }
    bytes += name + '\0';
    ((bytes += BytesOf(all, is_big)), ...);
    return bytes;
  };
  using I16 = std::int16_t;
  for (const bool is_big : {false, true}) {
    const std::string bytes =
        variable("d", 0, is_big, 1.5, -2.0) + variable("f", 1, is_big, 1.5F, -2.0F) +
        variable("i", 2, is_big, 7, -8) + variable("h", 3, is_big, I16{7}, I16{-8}) +
        variable("u", 4, is_big, std::uint16_t{7}, std::uint16_t{65535}) +
        variable("b", 5, is_big, std::uint8_t{7}, std::uint8_t{255});
    EXPECT_EQ(FormatOfBytes(bytes), FileFormat::kMat);
    EXPECT_EQ(test::TextOf(TableSource(file_of(bytes))),
              "d,f,i,h,u,b\n1.5,1.5,7,7,7,7\n-2,-2,-8,-8,65535,255\n")
        << is_big;
    for (std::size_t lost : {1, 2, 10, 30}) {
      EXPECT_THAT(ErrorOf([&] {
                    test::TextOf(TableSource(file_of(bytes.substr(0, bytes.size() - lost))));
                  }),
                  HasSubstr("it ends too early"))
          << lost;
    }
  }
}

TEST(IsMat4, NeedsATypeAndANameThatEnds) {
  const auto head = [](std::uint32_t type, std::uint32_t complex, std::uint32_t name_size,
                       const std::string& name) {
    return BytesOf(type) + BytesOf(2U) + BytesOf(1U) + BytesOf(complex) + BytesOf(name_size) +
           name + std::string(8, '\1');
  };
  EXPECT_TRUE(IsMat4(head(0, 0, 2, "a\0"s)));
  EXPECT_TRUE(IsMat4(head(52, 1, 4, "a_1\0"s)));
  EXPECT_TRUE(IsMat4(head(0, 0, 64, std::string(63, 'a') + '\0')));
  for (const std::string& other :
       {head(53, 0, 2, "a\0"s), head(60, 0, 2, "a\0"s), head(3, 0, 2, "a\0"s),
        head(0, 2, 2, "a\0"s), head(0, 0, 1, "\0"s), head(0, 0, 65, std::string(64, 'a') + '\0'),
        head(0, 0, 3, "a \0"s), head(0, 0, 2, "ab"), head(0, 0, 20, "a\0"s),
        std::string(19, '\0')}) {
    EXPECT_FALSE(IsMat4(other));
  }
}

// --- Names and limits ----------------------------------------------------------------------------

std::string TableOf(const std::vector<NamedArray>& arrays, std::string_view chosen = "") {
  return test::TextFromPipe([&](PipeWriter& pipe) { WriteTable(arrays, chosen, pipe); });
}

NamedArray Column(const std::string& name, std::size_t rows, std::size_t columns = 1) {
  return {.name = name,
          .rows = rows,
          .columns = columns,
          .values = std::vector<double>(rows * columns, 1.0)};
}

TEST(WriteTable, KnowsRatesAndPeriodsByName) {
  const auto step = [](const char* name, double value) {
    const std::string text =
        TableOf({{.name = name, .rows = 1, .values = {value}}, Column("a", 3)});
    if (!text.starts_with("time_s,")) return std::string("none");
    const std::size_t at = text.find("\n0,1\n") + 5;
    return text.substr(at, text.find(',', at) - at);
  };
  for (const char* rate : {"fs", "Fps", "my_rate", "rate_hz", "fsample", "sample_freq",
                           "sampling freq", "glove_frequency"}) {
    EXPECT_EQ(step(rate, 50.0), "0.02") << rate;
  }
  for (const char* period :
       {"frame_duration", "SamplePeriod", "sampling_period", "sample time", "sampling_interval"}) {
    EXPECT_EQ(step(period, 0.1), "0.1") << period;
    EXPECT_EQ(step(period, 1.0), "0.001") << period;
    EXPECT_EQ(step(period, 1000.0), "1") << period;
    for (const double other : {0.0, -0.1, 0.11, 0.99, 1001.0}) {
      EXPECT_EQ(step(period, other), "none") << period << other;
    }
  }
  for (const char* other : {"offs", "heart", "duration", "fsx"}) {
    EXPECT_EQ(step(other, 50.0), "none") << other;
  }
  // A rate counts more than a period, and a time more than both.
  const NamedArray rate{.name = "fs", .rows = 1, .values = {50}};
  const NamedArray period{.name = "frame_duration", .rows = 1, .values = {0.05}};
  for (const auto& both :
       {std::vector{rate, period, Column("a", 2)}, {period, rate, Column("a", 2)}}) {
    EXPECT_EQ(TableOf(both), "time_s,a\n0,1\n0.02,1\n");
  }
  EXPECT_EQ(TableOf({rate, Column("t", 2), Column("a", 2)}), "t,a\n1,1\n1,1\n");
}

TEST(WriteTable, TurnsWhatHasFarMoreColumnsThanAnyGlove) {
  const auto rows = [](std::size_t count, std::size_t columns) {
    const std::string text = TableOf({Column("a", count, columns)});
    return std::ranges::count(text, '\n') - 1;
  };
  EXPECT_EQ(rows(2, 65), 65);
  EXPECT_EQ(rows(2, 64), 2);
  EXPECT_EQ(rows(64, 129), 129);
  EXPECT_EQ(rows(64, 128), 64);
  EXPECT_EQ(rows(65, 200), 65);
  EXPECT_EQ(rows(1, 3), 3);
  NamedArray deep = Column("a", 2, 100);
  deep.is_flat = false;
  EXPECT_EQ(std::ranges::count(TableOf({deep}), '\n'), 3);
}

TEST(WriteTable, ListsTheFirstOfManyNames) {
  std::vector<NamedArray> arrays = {Column("a", 2)};
  for (int i = 0; i < 9; ++i) {
    arrays.push_back({.name = fmt::format("n{}", i), .values = {}, .left_out = "texts"});
  }
  EXPECT_THAT(TableOf(arrays),
              HasSubstr("left out: n0, n1, n2, n3, n4, n5, n6, n7 and 1 more (texts)"));
  arrays.pop_back();
  EXPECT_THAT(TableOf(arrays), HasSubstr("left out: n0, n1, n2, n3, n4, n5, n6, n7 (texts)"));
  std::vector<ListedArray> listed;
  for (int i = 0; i < 21; ++i) {
    listed.push_back({.name = fmt::format("n{}", i), .rows = 2, .columns = 1});
  }
  EXPECT_THAT(TextOf(listed), testing::EndsWith("n18 (2 x 1), n19 (2 x 1) and 1 more"));
  listed.pop_back();
  EXPECT_THAT(TextOf(listed), testing::EndsWith("n18 (2 x 1), n19 (2 x 1)"));
  EXPECT_THAT(TextOf(listed), StartsWith("n0 (2 x 1), n1 (2 x 1)"));
}

TEST(SetValues, NumbersThePointsOfHands) {
  const auto names = [](const std::vector<std::size_t>& shape) {
    std::size_t count = 1;
    for (const std::size_t size : shape) count *= size;
    NamedArray array{.name = "p", .values = {}};
    SetValues(array, std::vector<double>(count), shape, ArrayOrder::kRows);
    const std::vector<std::string>& all = array.column_names;
    return all.empty() ? "" : fmt::format("{} {} {}", all.size(), all.front(), all.back());
  };
  EXPECT_EQ(names({5, 21, 3}), "63 p_1_x p_21_z");
  EXPECT_EQ(names({5, 27, 3}), "81 p_1_x p_27_z");
  EXPECT_EQ(names({5, 21, 2}), "42 p_1_x p_21_y");
  EXPECT_EQ(names({5, 2, 21, 3}), "126 p_1_1_x p_2_21_z");
  EXPECT_EQ(names({5, 1, 26, 3}), "78 p_1_x p_26_z");
  EXPECT_EQ(names({5, 3, 21}), "63 p_1_x p_21_z");  // coordinates in front
  for (const std::vector<std::size_t>& other : {std::vector<std::size_t>{5, 63},
                                                {5, 20, 3},
                                                {5, 28, 3},
                                                {5, 22, 2},
                                                {5, 21, 4},
                                                {5, 21, 1},
                                                {2, 2, 2, 21, 3}}) {
    EXPECT_EQ(names(other), "") << other.size();
  }
}

TEST(WithFacts, KnowsUnitsByTheirNames) {
  for (const auto& [text, end] : {std::pair("rad", "_rad"),
                                  {"Radian", "_rad"},
                                  {"radians", "_rad"},
                                  {"deg", "_deg"},
                                  {"degree", "_deg"},
                                  {"Degrees", "_deg"},
                                  {"mV", ""},
                                  {"", ""}}) {
    for (const char* name : {"g_unit", "g_angleunits"}) {
      const std::vector<NamedArray> found = WithFacts(
          {Column("g_a", 3, 2), {.name = name, .columns = 0, .values = {}, .texts = {text}}});
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(TableOf(found).substr(0, 14),
                fmt::format("g_a_1{0},g_a_2{0}\n1,1", end).substr(0, 14))
          << text;
    }
  }
  // Two arrays with as many sensors: the names begin with that of the array.
  const std::vector<NamedArray> two =
      WithFacts({Column("g_a", 3, 2),
                 Column("g_b", 3, 2),
                 {.name = "g_names", .columns = 0, .values = {}, .texts = {"x", "y"}}});
  EXPECT_THAT(two[0].column_names, ElementsAre("g_a_x", "g_a_y"));
  EXPECT_THAT(two[1].column_names, ElementsAre("g_b_x", "g_b_y"));
  // Names of an array that lies on its side are those of its rows.
  const std::vector<NamedArray> turned = WithFacts(
      {Column("a", 2, 100), {.name = "names", .columns = 0, .values = {}, .texts = {"x", "y"}}});
  EXPECT_THAT(TableOf(turned), StartsWith("x,y\n"));
}

}  // namespace
}  // namespace gauntlet::sim
