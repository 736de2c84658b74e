// Arrays in the orders, types and places that files have them: read, or left out by name. The
// files are made here by HDF5 and matio, or byte by byte.
#include <H5Cpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/array_files.h"
#include "sim/tables/array_table.h"
#include "sim/tables/file_format.h"
#include "sim/tables/json_arrays.h"
#include "sim/tables/text_lines.h"
#include "sim/tables/time_columns.h"
#include "tests/support/program.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// Numbers from 0, as many as an array of this shape has.
std::vector<double> Counted(std::size_t count) {
  std::vector<double> values(count);
  std::iota(values.begin(), values.end(), 0.0);
  return values;
}

NamedArray Arranged(const std::vector<std::size_t>& shape, ArrayOrder order) {
  std::size_t count = 1;
  for (const std::size_t size : shape) count *= size;
  NamedArray array{.name = "a", .values = {}};
  SetValues(array, Counted(count), shape, order);
  return array;
}

TEST(SetValues, KeepsTheLastDimensionTogetherInBothOrders) {
  const NamedArray rows = Arranged({2, 2, 3}, ArrayOrder::kRows);
  EXPECT_THAT(rows.values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11));
  // Element (i, j, k) is the number i + 2 j + 4 k.
  const NamedArray columns = Arranged({2, 2, 3}, ArrayOrder::kColumns);
  EXPECT_EQ(columns.rows, 2U);
  EXPECT_THAT(columns.values, ElementsAre(0, 4, 8, 2, 6, 10, 1, 5, 9, 3, 7, 11));
  EXPECT_THAT(Arranged({2, 2}, ArrayOrder::kColumns).values, ElementsAre(0, 2, 1, 3));
}

TEST(SetValues, TakesTheLongestOfThreeDimensionsForRows) {
  // Point j at time i has the coordinates 3 * 100 * axis .. in front or behind.
  for (const ArrayOrder order : {ArrayOrder::kRows, ArrayOrder::kColumns}) {
    const NamedArray array = Arranged({3, 5, 100}, order);
    EXPECT_EQ(array.rows, 100U);
    ASSERT_EQ(array.columns, 15U);
    for (std::size_t time : {0U, 7U, 99U}) {
      for (std::size_t point = 0; point < 5; ++point) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const std::size_t expected = order == ArrayOrder::kRows ? time + 100 * (point + 5 * axis)
                                                                  : axis + 3 * (point + 5 * time);
          EXPECT_EQ(array.values[time * 15 + point * 3 + axis], static_cast<double>(expected));
        }
      }
    }
  }
  EXPECT_EQ(Arranged({2, 100, 21, 3}, ArrayOrder::kRows).rows, 100U);
  EXPECT_EQ(Arranged({10, 2, 21, 3}, ArrayOrder::kRows).rows, 10U);  // short, and not turned
}

template <class Value>
std::string Bytes(const std::vector<Value>& values) {
  std::string bytes(values.size() * sizeof(Value), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::string Npy(const std::string& type, const std::string& shape, const std::string& data) {
  const std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  return "\x93NUMPY\x01\x00"s + static_cast<char>(header.size()) + '\0' + header + data;
}

TEST(Npy, HasHalfPrecision) {
  const std::vector<std::uint16_t> bits = {0x3c00, 0xc000, 0x3555, 0x0001, 0x7bff, 0x7c00, 0xfe00};
  const NamedArray array = ReadNpy(Npy("<f2", "(7,)", Bytes(bits)), "a");
  ASSERT_EQ(array.rows, 7U);
  EXPECT_THAT(std::vector(array.values.begin(), array.values.begin() + 5),
              ElementsAre(1.0, -2.0, 0.333251953125, std::ldexp(1.0, -24), 65504.0));
  EXPECT_TRUE(std::isinf(array.values[5]));
  EXPECT_TRUE(std::isnan(array.values[6]));
  EXPECT_THAT(ReadNpy(Npy(">f2", "(1,)", "\xc0\0"s), "a").values, ElementsAre(-2.0));
}

TEST(Npy, OfDatesIsATimeInItsUnit) {
  const std::string data = Bytes<std::int64_t>({20, 30, std::numeric_limits<std::int64_t>::min()});
  const auto read = [&](const std::string& type, const std::string& name) {
    return ReadNpy(Npy(type, "(3,)", data), name);
  };
  const NamedArray array = read("<M8[ms]", "time");
  EXPECT_EQ(array.name, "time_ms");
  EXPECT_EQ(array.values[1], 30.0);
  EXPECT_TRUE(std::isnan(array.values[2]));  // NaT
  EXPECT_EQ(read("<m8[ns]", "moment").name, "moment_time_ns");
  EXPECT_EQ(read("<M8[10us]", "glove_t").name, "glove_t_us");
  EXPECT_EQ(read("<M8[10us]", "t").values[0], 200.0);
  EXPECT_EQ(read("<M8[m]", "t").values[0], 1200.0);
  EXPECT_EQ(read("<M8[M]", "t").left_out, "dates without a clock");
}

TEST(WriteTable, ListsWhatIsLeftOutUnlessAnArrayIsChosen) {
  const std::vector<NamedArray> arrays = {
      {.name = "a", .rows = 3, .values = {1, 2, 3}},
      {.name = "label", .values = {}, .left_out = "texts"},
      {.name = "note", .values = {}, .left_out = "texts"},
      {.name = "field", .values = {}, .left_out = "complex numbers"}};
  const auto table_of = [&](std::string_view chosen) {
    return test::TextFromPipe([&](PipeWriter& pipe) { WriteTable(arrays, chosen, pipe); });
  };
  EXPECT_EQ(table_of(""), "a\n1\n2\n" + test::RemarkLine("left out: field (complex numbers)") +
                              test::RemarkLine("left out: label, note (texts)") + "3\n");
  EXPECT_EQ(table_of("a"), "a\n1\n2\n3\n");
  try {
    table_of("field");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_STREQ(error.what(), "holds field, which is left out (complex numbers)");
  }
  try {
    ListArrays({arrays[1]}, "");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_STREQ(error.what(), "holds no array of numbers with two rows; left out: label (texts)");
  }
}

TEST(Json, TakesNaNAndInfinityOfPythonForMissing) {
  const std::vector<NamedArray> arrays = ReadJsonArrays(
      R"([{"a": NaN, "NaN \" NaN": 1}, {"a": -Infinity, "NaN \" NaN": 2}, {"a": 3}])");
  ASSERT_EQ(arrays.size(), 2U);
  EXPECT_TRUE(std::isnan(arrays[0].values[0]));
  EXPECT_TRUE(std::isnan(arrays[0].values[1]));
  EXPECT_EQ(arrays[0].values[2], 3.0);
  EXPECT_EQ(arrays[1].name, "NaN \" NaN");
  EXPECT_EQ(ReadJsonArrays("{\"a\": 1}\n{\"a\": Infinity}\n")[0].rows, 2U);
  EXPECT_THROW(ReadJsonArrays("{\"a\": None}"), UserError);
}

TEST(OctaveText, HasMatricesRangesAndCells) {
  const std::string text =
      "# Created by Octave 7.3.0, Sat Nov 28 2026 <a@b>\n"
      "# name: time\n# type: double_range\n# base, limit, increment\n0 0.3 0.1\n\n\n"
      "# name: m\n# type: matrix\n# rows: 2\n# columns: 3\n 1 2 3\n 4 NaN -Inf\n\n\n"
      "# name: cube\n# type: matrix\n# ndims: 3\n 2 1 2\n 1\n 2\n 3\n 4\n\n\n"
      "# name: count\n# type: int32 scalar\n7\n\n\n"
      "# name: label\n# type: string\n# elements: 1\n# length: 2\nab\n\n\n"
      "# name: z\n# type: complex scalar\n(1,2)\n\n\n"
      "# name: c\n# type: cell\n# rows: 1\n# columns: 2\n"
      "# name: <cell-element>\n# type: scalar\n5\n\n\n"
      "# name: <cell-element>\n# type: scalar\n6\n\n\n\n";
  EXPECT_EQ(FormatOfBytes(text), FileFormat::kOctave);
  const std::vector<NamedArray> arrays = ReadOctaveText(text);
  ASSERT_EQ(arrays.size(), 7U);
  EXPECT_EQ(arrays[0].name, "time");
  ASSERT_EQ(arrays[0].values.size(), 4U);
  EXPECT_EQ(arrays[0].values[2], 0.2);
  EXPECT_EQ(arrays[0].values[3], 0.3);  // 3 * 0.1 is above the limit
  EXPECT_EQ(arrays[1].rows, 2U);
  EXPECT_EQ(arrays[1].values[3], 4.0);
  EXPECT_TRUE(std::isnan(arrays[1].values[4]));
  EXPECT_THAT(arrays[2].values, ElementsAre(1, 3, 2, 4));
  EXPECT_THAT(arrays[3].values, ElementsAre(7));
  EXPECT_EQ(arrays[4].name, "z");
  EXPECT_EQ(arrays[4].left_out, "complex scalar");
  EXPECT_EQ(arrays[6].name, "c_2");
  EXPECT_EQ(arrays[6].cells_of, "c");
  for (const char* damaged : {"# name: m\n# type: matrix\n# rows: 2\n# columns: 2\n 1 2\n",
                              "# name: m\n# type: matrix\n# ndims: 2\n 2 2\n 1\n 2\n",
                              "# name: m\n# type: matrix\n# rows: 1\n# columns: 2\n 1 b\n",
                              "# name: m\n# type: matrix\n# ndims: 3\n 2 -2\n",
                              "# name: r\n# type: range\n# base\n1 2\n"}) {
    EXPECT_THROW(ReadOctaveText(damaged), UserError) << damaged;
  }
}

class Containers : public ::testing::Test {
 protected:
  fs::path Path(const std::string& name) const { return folder_.path() / name; }
  static std::string TableOf(const fs::path& file, const std::string& array = "") {
    return test::TextOf(TableSource(file, array));
  }
  std::string ErrorOf(const fs::path& file, const std::string& array = "") const {
    try {
      TableOf(file, array);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
  const test::TemporaryDirectory folder_;
};

H5::DataSet AddNumbers(const H5::Group& group, const char* name, const std::vector<hsize_t>& shape,
                       const H5::DSetCreatPropList& how = H5::DSetCreatPropList::DEFAULT) {
  const H5::DataSpace space(static_cast<int>(shape.size()), shape.data());
  const H5::DataSet dataset = group.createDataSet(name, H5::PredType::NATIVE_DOUBLE, space, how);
  dataset.write(Counted(static_cast<std::size_t>(space.getSimpleExtentNpoints())).data(),
                H5::PredType::NATIVE_DOUBLE);
  return dataset;
}

TEST_F(Containers, Hdf5WithoutLinkedFilesHasItsOwnArrays) {
  const fs::path file = Path("links.h5");
  {
    const H5::H5File output(file.string(), H5F_ACC_TRUNC);
    AddNumbers(output, "a", {3});
    output.link(H5L_TYPE_SOFT, "/moved", "old");
    H5Lcreate_external("camera.h5", "/frames", output.getId(), "video", H5P_DEFAULT, H5P_DEFAULT);
  }
  EXPECT_EQ(TableOf(file),
            "a\n0\n1\n" + test::RemarkLine("left out: video (a link into another file)") +
                test::RemarkLine("left out: old (a link that leads nowhere)") + "2\n");
  EXPECT_THAT(ErrorOf(file, "old"), HasSubstr("holds old, which is left out (a link that leads"));
}

TEST_F(Containers, Hdf5WhoseValuesAreNotInTheFileIsLeftOut) {
  const fs::path file = Path("elsewhere.h5");
  {
    const H5::H5File output(file.string(), H5F_ACC_TRUNC);
    AddNumbers(output, "here", {3});
    const std::array<hsize_t, 1> size = {3};
    const H5::DataSpace space(1, size.data());
    const H5::PredType& number = H5::PredType::NATIVE_DOUBLE;
    H5::DSetCreatPropList virtual_data, chunked, raw;
    H5Pset_virtual(virtual_data.getId(), space.getId(), ".", "/here", space.getId());
    output.createDataSet("mapped", number, space, virtual_data);
    output.createDataSet("empty", number, space);
    raw.setExternal("raw.bin", 0, 3 * sizeof(double));
    output.createDataSet("raw", number, space, raw);
    const std::array<hsize_t, 1> block = {2};
    chunked.setChunk(1, block.data());
    const H5::DataSet half = output.createDataSet("half", number, space, chunked);
    const std::array<hsize_t, 1> first = {0}, two = {2};
    H5::DataSpace part(space);
    part.selectHyperslab(H5S_SELECT_SET, two.data(), first.data());
    half.write(Counted(2).data(), number, H5::DataSpace(1, two.data()), part);
    AddNumbers(output, "whole", {3}, chunked);
  }
  const std::string table = TableOf(file);
  EXPECT_THAT(table, StartsWith("here,whole\n0,0\n1,1\n"));
  for (const char* line : {"left out: mapped (virtual: its values are in other datasets or files)",
                           "left out: empty (its values were never written)",
                           "left out: raw (its values are in another file)",
                           "left out: half (blocks that were never written: 1)"}) {
    EXPECT_THAT(table, HasSubstr(test::RemarkLine(line)));
  }
}

void Note(const H5::H5Object& object, const char* name, double number) {
  object.createAttribute(name, H5::PredType::NATIVE_DOUBLE, H5::DataSpace(H5S_SCALAR))
      .write(H5::PredType::NATIVE_DOUBLE, &number);
}

void Note(const H5::H5Object& object, const char* name, const std::string& text) {
  const H5::StrType type(H5::PredType::C_S1, text.size());
  object.createAttribute(name, type, H5::DataSpace(H5S_SCALAR)).write(type, text);
}

/// The numbers of a table mean what the file notes beside them. Wrong: whole hundredths of a degree
/// as counts, and 50 Hz for a file that says 100.
TEST_F(Containers, Hdf5UsesTheUnitsScalesAndRatesThatItNotes) {
  const fs::path file = Path("noted.h5");
  {
    const H5::H5File output(file.string(), H5F_ACC_TRUNC);
    const H5::DataSet scaled = AddNumbers(output, "index_mcp", {4});
    Note(scaled, "units", "degrees");
    Note(scaled, "scale_factor", 0.5);
    Note(scaled, "add_offset", 10.0);
    Note(scaled, "_FillValue", 2.0);  // before the scale
    const H5::DataSet time = AddNumbers(output, "time", {4});
    Note(time, "units", "ms");
    const H5::DataSet speed = AddNumbers(output, "speed", {4});
    Note(speed, "units", "rad/s");
    Note(speed, "offset", 5.0);  // of anything
  }
  EXPECT_EQ(TableOf(file), "index_mcp_deg,speed,time_ms\n10,0,0\n10.5,1,1\nnan,2,2\n11.5,3,3\n");
  const fs::path rates = Path("rates.h5");
  {
    const H5::H5File output(rates.string(), H5F_ACC_TRUNC);
    AddNumbers(output, "q", {3, 2});
    Note(output, "fps", 100.0);
    Note(output, "learning_rate", 0.001);
    const H5::Group other = output.createGroup("camera");
    AddNumbers(other, "x", {2});
    Note(other, "fps", 30.0);
  }
  EXPECT_EQ(TableOf(rates), "time_s,q_1,q_2\n0,0,1\n0.01,2,3\n0.02,4,5\n");
  EXPECT_THAT(TableOf(rates, "camera_x"), StartsWith("time_s,camera_x\n0,0\n0.033"));
}

/// Stands for a compression that the reader does not have.
std::size_t Unchanged(unsigned, std::size_t, const unsigned*, std::size_t bytes, std::size_t*,
                      void**) {
  return bytes;
}

TEST_F(Containers, Hdf5OfAnUnknownFilterNamesArrayAndFilter) {
  constexpr H5Z_filter_t kFilter = 310;  // of those for tests
  const H5Z_class2_t known = {H5Z_CLASS_T_VERS, kFilter, 1,       1,
                              "squeeze",        nullptr, nullptr, Unchanged};
  H5Zregister(&known);
  const fs::path file = Path("filter.h5");
  {
    const H5::H5File output(file.string(), H5F_ACC_TRUNC);
    AddNumbers(output, "a", {3});
    H5::DSetCreatPropList how;
    const std::array<hsize_t, 1> block = {3};
    how.setChunk(1, block.data());
    how.setFilter(kFilter);
    AddNumbers(output, "b", {3}, how);
  }
  H5Zunregister(kFilter);
  EXPECT_THAT(TableOf(file), HasSubstr("left out: b (compressed by squeeze, which is not read"));
}

TEST_F(Containers, Hdf5OfMatlabAndOctaveHasItsDimensionsBack) {
  const fs::path file = Path("reversed.h5");
  {
    const H5::H5File output(file.string(), H5F_ACC_TRUNC);
    const H5::StrType text(H5::PredType::C_S1, 6);
    // 2 x 2 x 3 in MATLAB: element (i, j, k) is i + 2 j + 4 k.
    const H5::DataSet cube = AddNumbers(output, "cube", {3, 2, 2});
    cube.createAttribute("MATLAB_class", text, H5::DataSpace()).write(text, "double"s);
    const H5::Group variable = output.createGroup("m");
    const std::uint8_t is_new = 1;
    variable.createAttribute("OCTAVE_NEW_FORMAT", H5::PredType::NATIVE_UINT8, H5::DataSpace())
        .write(H5::PredType::NATIVE_UINT8, &is_new);
    AddNumbers(variable, "value", {3, 2});
  }
  EXPECT_EQ(TableOf(file),
            "cube_1,cube_2,cube_3,cube_4,cube_5,cube_6,m_value_1,m_value_2,m_value_3"
            "\n0,4,8,2,6,10,0,2,4\n1,5,9,3,7,11,1,3,5\n");
}

// to_netcdf() of xarray 2026.9.0 (PyPI). Wrong: a question, or seconds.
TEST_F(Containers, Hdf5OfNetcdfHasTheUnitOfItsTimes) {
  const fs::path file = Path("glove.nc");
  {
    const H5::H5File output(file.string(), H5F_ACC_TRUNC);
    const H5::StrType text(H5::PredType::C_S1, H5T_VARIABLE);
    const auto add = [&](const char* name, const std::string& units) {
      AddNumbers(output, name, {2})
          .createAttribute("units", text, H5::DataSpace())
          .write(text, units);
    };
    add("a_time", "milliseconds since 2025-11-29 10:00:00.003000");
    add("b_time", "microseconds");
    add("c_time", "seconds since 2025-11-29");
    add("d_time_ms", "nanoseconds");
    add("index_mcp", "milliseconds");
  }
  EXPECT_THAT(TableOf(file), StartsWith("a_time_ms,b_time_us,c_time,d_time_ms,index_mcp\n"));
}

// pynwb 4.2.0 (PyPI): TimeSeries with a rate, or with timestamps. Wrong: a rate that is assumed.
TEST_F(Containers, Hdf5OfNwbHasItsRateOrTimes) {
  const fs::path file = Path("glove.nwb");
  {
    const H5::H5File output(file.string(), H5F_ACC_TRUNC);
    const H5::Group series = output.createGroup("index_mcp");
    AddNumbers(series, "data", {3});
    const double rate_hz = 50.0;
    AddNumbers(series, "starting_time", {1})
        .createAttribute("rate", H5::PredType::NATIVE_DOUBLE, H5::DataSpace())
        .write(H5::PredType::NATIVE_DOUBLE, &rate_hz);
  }
  EXPECT_EQ(TableOf(file), "time_s,index_mcp_data\n0,0\n0.02,1\n0.04,2\n");
  EXPECT_EQ(TimeScaleS("timestamps"), 1.0);
}

TEST_F(Containers, Hdf5OfRecordsHasAColumnForEachMember) {
  struct Record {
    double time_s;
    float angles[2];
    std::int64_t count;
  };
  struct Range {
    double base, limit, increment;
  };
  const fs::path file = Path("records.h5");
  {
    const H5::H5File output(file.string(), H5F_ACC_TRUNC);
    const std::array<hsize_t, 1> two = {2};
    H5::CompType type(sizeof(Record));
    type.insertMember("time_s", offsetof(Record, time_s), H5::PredType::NATIVE_DOUBLE);
    type.insertMember("angles", offsetof(Record, angles),
                      H5::ArrayType(H5::PredType::NATIVE_FLOAT, 1, two.data()));
    type.insertMember("count", offsetof(Record, count), H5::PredType::NATIVE_INT64);
    const std::array<Record, 2> records = {{{0.5, {1, 2}, 3}, {0.75, {4, 5}, -6}}};
    output.createDataSet("log", type, H5::DataSpace(1, two.data())).write(records.data(), type);
    H5::CompType range(sizeof(Range));
    range.insertMember("base", offsetof(Range, base), H5::PredType::NATIVE_DOUBLE);
    range.insertMember("limit", offsetof(Range, limit), H5::PredType::NATIVE_DOUBLE);
    range.insertMember("increment", offsetof(Range, increment), H5::PredType::NATIVE_DOUBLE);
    const Range values = {10.0, 9.0, -1.0};
    output.createDataSet("falling", range, H5::DataSpace()).write(&values, range);
  }
  EXPECT_EQ(
      TableOf(file),
      "falling,log_time_s,log_angles_1,log_angles_2,log_count\n10,0.5,1,2,3\n9,0.75,4,5,-6\n");
}

void WriteMat(const fs::path& file, mat_ft version, const std::vector<matvar_t*>& variables) {
  mat_t* const mat = Mat_CreateVer(file.c_str(), nullptr, version);
  for (matvar_t* variable : variables) {
    Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE);
    Mat_VarFree(variable);
  }
  Mat_Close(mat);
}

template <class Value>
matvar_t* Variable(const char* name, matio_classes kind, matio_types type,
                   std::vector<std::size_t> size, std::vector<Value> values) {
  return Mat_VarCreate(name, kind, type, static_cast<int>(size.size()), size.data(), values.data(),
                       0);
}

TEST_F(Containers, MatHasWholeNumbersOf64BitsAndEveryDimension) {
  const fs::path file = Path("a.mat");
  WriteMat(file, MAT_FT_MAT5,
           {Variable<std::int64_t>("time_ms", MAT_C_INT64, MAT_T_INT64, {2, 1}, {0, 10}),
            Variable<double>("cube", MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 2, 1, 2}, Counted(8))});
  EXPECT_EQ(TableOf(file), "time_ms,cube_1,cube_2,cube_3,cube_4\n0,0,4,2,6\n10,1,5,3,7\n");
}

TEST_F(Containers, MatOfLevel4IsReadAndRefusedWhereItIsCut) {
  const fs::path file = Path("a.mat");
  WriteMat(file, MAT_FT_MAT4,
           {Variable<double>("time_s", MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 1}, {0.0, 0.5}),
            Variable<double>("a", MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 2}, Counted(4))});
  EXPECT_EQ(OpenTable(file).format, FileFormat::kMat);
  EXPECT_EQ(TableOf(file), "time_s,a_1,a_2\n0,0,2\n0.5,1,3\n");
  fs::resize_file(file, fs::file_size(file) - 8);
  EXPECT_THAT(ErrorOf(file), HasSubstr("is damaged: it ends too early"));
}

TEST_F(Containers, MatOfSeveralTrialsAsksForOne) {
  const fs::path file = Path("a.mat");
  std::array<const char*, 2> fields = {"t", "a"};
  std::array<std::size_t, 2> size = {1, 2};
  matvar_t* const trials = Mat_VarCreateStruct("trials", 2, size.data(), fields.data(), 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const double from = 10.0 * static_cast<double>(i);
    Mat_VarSetStructFieldByName(
        trials, "t", i, Variable<double>(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 1}, {0.0, 0.5}));
    Mat_VarSetStructFieldByName(
        trials, "a", i,
        Variable<double>(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, {2, 1}, {from, from + 1.0}));
  }
  WriteMat(file, MAT_FT_MAT5, {trials});
  EXPECT_THAT(ErrorOf(file), HasSubstr("has 2 recordings in trials: trials_1_t (2 x 1), "));
  EXPECT_THAT(ErrorOf(file), HasSubstr("--array trials_1 takes one"));
  EXPECT_EQ(TableOf(file, "trials_2"), "t,a\n0,10\n0.5,11\n");
}

}  // namespace
}  // namespace gauntlet::sim
