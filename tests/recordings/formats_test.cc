// Recordings that are not text, made here byte by byte.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/array_files.h"
#include "sim/tables/array_table.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/file_format.h"
#include "sim/tables/json_arrays.h"
#include "tests/support/program.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim {
namespace {

using namespace std::string_literals;
using testing::ElementsAre;
using testing::HasSubstr;

std::string Npy(const std::string& header, const std::string& data) {
  return "\x93NUMPY\x01\x00"s + static_cast<char>(header.size()) + '\0' + header + data;
}

std::string AllOf(const CsvReader::Source& source) {
  std::string text;
  char buffer[7];  // small, so that every boundary is met
  while (const std::size_t got = source(buffer, sizeof buffer)) text.append(buffer, got);
  return text;
}

template <class Call>
std::string ErrorOf(const Call& call) {
  try {
    call();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Npy, IsReadInEveryOrderOfBytesAndDimensions) {
  const NamedArray big = ReadNpy(Npy("{'descr': '>i2', 'fortran_order': False, 'shape': (2, 3), }",
                                     "\0\1\0\2\0\3\0\4\xff\xff\1\0"s),
                                 "a");
  EXPECT_EQ(big.rows, 2U);
  EXPECT_EQ(big.columns, 3U);
  EXPECT_THAT(big.values, ElementsAre(1, 2, 3, 4, -1, 256));
  const NamedArray turned = ReadNpy(
      Npy("{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3), }", "\1\4\2\5\3\6"), "a");
  EXPECT_THAT(turned.values, ElementsAre(1, 2, 3, 4, 5, 6));
  const NamedArray scalar =
      ReadNpy(Npy("{'descr': '<f4', 'fortran_order': False, 'shape': (), }", "\0\0\xc0\x3f"s), "a");
  EXPECT_THAT(scalar.values, ElementsAre(1.5));
  const NamedArray cube = ReadNpy(
      Npy("{'descr': '|i1', 'fortran_order': False, 'shape': (1, 2, 2), }", "\1\2\3\xfc"), "a");
  EXPECT_EQ(cube.columns, 4U);
  EXPECT_EQ(cube.values[3], -4.0);
}

TEST(Npy, OfTextsThatAreNamesNamesColumns) {
  const std::string letters =
      "I\0\0\0"
      "2\0\0\0"
      "M\0\0\0"
      "\0\0\0\0"s;
  const std::string file =
      Npy("{'descr': '<U2', 'fortran_order': False, 'shape': (2,), }", letters);
  EXPECT_THAT(ReadNpy(file, "joint_names").texts, ElementsAre("I2", "M"));
  EXPECT_EQ(ReadNpy(file, "notes").left_out, "texts");
}

TEST(Npy, OfNoNumbersIsLeftOutWithTheReason) {
  const auto reason_of = [](const std::string& descr, const std::string& shape) {
    const std::string header =
        fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': {}, }}", descr, shape);
    return ReadNpy(Npy(header, "12345678"), "a").left_out;
  };
  EXPECT_EQ(reason_of("'<f8'", "(2, 0)"), "empty");
  EXPECT_EQ(reason_of("'|O'", "(1,)"), "objects of Python");
  EXPECT_EQ(reason_of("'<U2'", "(1,)"), "texts");
  EXPECT_EQ(reason_of("'<c8'", "(1,)"), "complex numbers");
  EXPECT_EQ(reason_of("[('t', '<f8')]", "(1,)"), "records");
}

TEST(Npy, ThatIsDamagedIsRefused) {
  const auto error_of = [](const std::string& header, const std::string& data) {
    return ErrorOf([&] { ReadNpy(Npy(header, data), "a"); });
  };
  const std::string good = "{'descr': '<f8', 'fortran_order': False, 'shape': ";
  EXPECT_THAT(error_of(good + "(9,), }", "12345678"), HasSubstr("larger than the file"));
  EXPECT_THAT(error_of(good + "(1, 99999999999999999999, 8), }", "12345678"), HasSubstr("damaged"));
  EXPECT_THAT(error_of(good + "(4294967296, 4294967296, 4294967296), }", ""), HasSubstr("larger"));
  EXPECT_THAT(ErrorOf([] { ReadNpy("\x93NUMPY\x01\x00\xff\xff{"s, "a"); }), HasSubstr("too early"));
  EXPECT_THAT(ErrorOf([] { ReadNpz("PK\x03\x04"); }), HasSubstr("directory of the ZIP is missing"));
}

std::string TableOf(const std::vector<NamedArray>& arrays, std::string_view chosen = "") {
  return test::TextFromPipe([&](PipeWriter& pipe) { WriteTable(arrays, chosen, pipe); });
}

TEST(WriteTable, PutsArraysOfTheSameLengthSideBySide) {
  EXPECT_EQ(TableOf({{.name = "t", .rows = 2, .values = {0, 0.1}},
                     {.name = "other", .rows = 3, .values = {7, 8, 9}},
                     {.name = "my angles", .rows = 2, .columns = 2, .values = {1, 2, 3, 4e-300}}}),
            "t,my_angles_1,my_angles_2\n0,1,2\n0.1,3,4e-300\n");
}

TEST(WriteTable, TurnsWhatLiesOnItsSideAndMakesATimeOfARate) {
  NamedArray turned{.name = "f", .rows = 2, .columns = 100, .values = {}};
  for (int i = 0; i < 200; ++i) turned.values.push_back(i);
  const std::string text = TableOf({turned, {.name = "Fs", .rows = 1, .values = {50}}});
  EXPECT_THAT(text, testing::StartsWith("time_s,f_1,f_2\n0,0,100\n0.02,1,101\n"));
}

TEST(WriteTable, NeedsTwoRows) {
  EXPECT_THAT(ErrorOf([] { TableOf({{.name = "a", .rows = 1, .values = {1}}}); }),
              HasSubstr("no array of numbers with two rows"));
}

/// Two systems in one file, the second with more values.
std::vector<NamedArray> TwoSystems() {
  return {{.name = "glove_t", .rows = 2, .values = {0, 0.1}},
          {.name = "glove_angles", .rows = 2, .columns = 2, .values = {1, 2, 3, 4}},
          {.name = "glove_raw", .rows = 2, .values = {5, 6}},
          {.name = "mocap_t", .rows = 3, .values = {0, 0.2, 0.4}},
          {.name = "mocap_angles", .rows = 3, .columns = 2, .values = {1, 2, 3, 4, 5, 6}},
          {.name = "Fs", .rows = 1, .values = {50}}};
}

TEST(WriteTable, TakesTheArrayOrTheGroupThatIsChosenWithItsTime) {
  EXPECT_THAT(TableOf(TwoSystems()), testing::StartsWith("time_s,mocap_t,mocap_angles_1"));
  EXPECT_EQ(TableOf(TwoSystems(), "glove_angles"),
            "t,glove_angles_1,glove_angles_2\n0,1,2\n0.1,3,4\n");
  EXPECT_EQ(TableOf(TwoSystems(), "glove/raw"), "t,glove_raw\n0,5\n0.1,6\n");
  EXPECT_THAT(TableOf(TwoSystems(), "glove"), testing::StartsWith("t,angles_1,angles_2,raw\n"));
}

TEST(WriteTable, OfAnArrayThatLacksATimeTakesThatWithAsManyRows) {
  std::vector<NamedArray> arrays = TwoSystems();
  arrays.push_back({.name = "left", .rows = 3, .values = {7, 8, 9}});
  EXPECT_THAT(TableOf(arrays, "left"), testing::StartsWith("t,left\n0,7\n0.2,8\n"));
  // Times as many as rows in two groups: the own group's.
  arrays.push_back({.name = "right_time_s", .rows = 3, .values = {0, 1, 2}});
  arrays.push_back({.name = "right_hand", .rows = 3, .values = {1, 1, 1}});
  EXPECT_THAT(TableOf(arrays, "right_hand"), testing::StartsWith("time_s,right_hand\n"));
}

// Wrong: the IMU, which sends more numbers than the glove.
TEST(WriteTable, TakesTheGloveBesideAnInertialSensor) {
  std::vector<NamedArray> arrays = TwoSystems();
  arrays[3].name = "imu_t";
  arrays[4].name = "imu_acceleration";
  EXPECT_THAT(TableOf(arrays), testing::StartsWith("time_s,glove_t,glove_angles_1"));
  arrays.erase(arrays.begin(), arrays.begin() + 3);
  EXPECT_THAT(TableOf(arrays), HasSubstr("imu_acceleration_1,imu_acceleration_2"));
}

TEST(ListArrays, NamesAllThatThereAreWhereOneIsUnknown) {
  EXPECT_EQ(ErrorOf([] { ListArrays(TwoSystems(), "hand"); }),
            "holds no array hand, but glove_t (2 x 1), glove_angles (2 x 2), glove_raw (2 x 1), "
            "mocap_t (3 x 1), mocap_angles (3 x 2), Fs (1 x 1)");
  std::string taken;
  for (const ListedArray& array : ListArrays(TwoSystems(), "mocap_angles")) {
    if (array.is_taken) taken += array.name + " ";
  }
  EXPECT_EQ(taken, "mocap_t mocap_angles ");
  EXPECT_THAT(ErrorOf([] { ListArrays(TwoSystems(), "Fs"); }), HasSubstr("with two rows"));
}

TEST(Json, OfEveryShapeIsATable) {
  const auto table_of = [](const char* json) { return TableOf(ReadJsonArrays(json)); };
  EXPECT_EQ(table_of("[[1, 2], [3, 4]]"), "value_1,value_2\n1,2\n3,4\n");
  EXPECT_EQ(table_of(R"({"t": [0, 1], "f": [[1, 2], [3, 4]]})"), "t,f_1,f_2\n0,1,2\n1,3,4\n");
  EXPECT_EQ(
      table_of(R"([{"t": 0, "f": {"a": 1, "b": [2, 3]}}, {"t": "1", "f": {"b": [4, null]}}])"),
      "t,f_a,f_b_1,f_b_2\n0,1,2,3\n1,nan,4,nan\n");
  EXPECT_EQ(table_of(R"({"glove": "left", "frames": [{"t": "00:00:01.5"}, {"t": "00:00:02"}]})"),
            "frames_t\n1.5\n2\n");
  EXPECT_EQ(table_of("{\"t\": 0, \"a\": 1}\n\n{\"t\": 1, \"a\": true}\n"), "t,a\n0,1\n1,1\n");
}

// to_json() of pandas 3.1.1, by default and with orient="index". Wrong: no array of two rows.
TEST(Json, OfPandasIsATable) {
  const auto table_of = [](const char* json) { return TableOf(ReadJsonArrays(json)); };
  EXPECT_EQ(table_of(R"({"time":{"0":0.0,"1":0.01},"a":{"0":1,"1":null},"b":{"0":"x","1":"y"}})"),
            "time,a\n0,1\n0.01,nan\n");
  EXPECT_EQ(table_of(R"({"a":{"1764410400003":1,"1764410400013":2}})"),
            "index,a\n1764410400003,1\n1764410400013,2\n");
  EXPECT_EQ(table_of(R"({"0":{"time":0.0,"a":1},"1":{"time":0.01,"a":2}})"),
            "time,a\n0,1\n0.01,2\n");
  EXPECT_EQ(table_of(R"({"1970-01-01T00:00:01.500":{"a":1},"1970-01-01T00:00:02.000":{"a":2}})"),
            "index,a\n1.5,1\n2,2\n");
  EXPECT_EQ(table_of(R"({"1":{"a":[1,2]},"2":{"a":[3,4]}})"), "1_a,2_a\n1,3\n2,4\n");
}

TEST(Json, KeepsTheRowsOfHandsAndOfPersonsApart) {
  const auto table_of = [](const char* json) { return TableOf(ReadJsonArrays(json)); };
  EXPECT_EQ(table_of("{\"hand\": \"Right\", \"a\": 1}\n{\"hand\": \"left\", \"a\": 2}\n"
                     "{\"hand\": \"left\", \"a\": 3}\n{\"hand\": \"Right\", \"a\": 4}\n"),
            "left_a,right_a\n2,1\n3,4\n");
  EXPECT_EQ(table_of(R"([{"side": "right", "a": 1}, {"side": "right", "a": 2}])"), "a\n1\n2\n");
  EXPECT_EQ(table_of(R"([{"hand": "both", "a": 1}, {"hand": "none", "a": 2}])"), "a\n1\n2\n");
  EXPECT_EQ(
      table_of(R"([{"person": "B", "a": 1}, {"person": "A", "a": 2}, {"person": "B", "a": 3}])"),
      "person,a\n0,1\n1,2\n0,3\n");
}

TEST(Json, AsksForOneOfRecordingsOfUnequalLength) {
  const auto frames = [](int count) {
    std::string text;
    for (int k = 0; k < count; ++k) {
      text += fmt::format("{}{{\"t\": {}, \"index_mcp_deg\": {}}}", k > 0 ? "," : "", k, 20 + k);
    }
    return "[" + text + "]";
  };
  const auto table_of = [](const std::string& json, const std::string& chosen = {}) {
    return TableOf(ReadJsonArrays(json), chosen);
  };
  const std::string persons =
      R"({"persons": [{"frames": )" + frames(30) + R"(}, {"frames": )" + frames(20) + "}]}";
  EXPECT_THAT(ErrorOf([&] { table_of(persons); }), HasSubstr("has 2 recordings in persons: "));
  EXPECT_THAT(table_of(persons, "persons_2"),
              testing::StartsWith("frames_t,frames_index_mcp_deg\n0,20\n1,21\n"));
  const std::string hands = R"({"left": )" + frames(20) + R"(, "right": )" + frames(30) + "}";
  EXPECT_THAT(ErrorOf([&] { table_of(hands); }), HasSubstr("--array left takes one"));
  const std::string columns = R"([{"t": [0,1,2,3,4,5,6,7,8,9], "a": [0,1,2,3,4,5,6,7,8,9]},)"
                              R"({"t": [0,1,2,3,4,5,6,7,8,9,10], "a": [0,1,2,3,4,5,6,7,8,9,9]}])";
  EXPECT_THAT(ErrorOf([&] { table_of(columns); }), HasSubstr("has 2 recordings in the file: "));
  // One without frames is no rival.
  const std::string one = R"({"persons": [{"frames": )" + frames(30) + R"(}, {"frames": []}]})";
  EXPECT_THAT(table_of(one),
              testing::StartsWith("persons_1_frames_t,persons_1_frames_index_mcp_deg\n0,20"));
}

TEST(Json, KnowsAHandByEveryKeyOfTrackers) {
  const auto names = [](const std::string& hand) {
    const std::string text = TableOf(ReadJsonArrays(fmt::format(
        R"([{{"t": 0, "hands": [{{"x": 1, {}}}]}}, {{"t": 1, "hands": [{{"x": 2, {}}}]}}])", hand,
        hand)));
    return text.substr(0, text.find('\n'));
  };
  for (const char* key : {"handedness", "hand", "side", "label", "categoryName", "category_name",
                          "displayName", "classification"}) {
    EXPECT_THAT(names(fmt::format(R"("{}": "Left")", key)), HasSubstr("hands_left_x")) << key;
    EXPECT_THAT(names(fmt::format(R"("{}": [{{"score": 1, "label": "RIGHT"}}])", key)),
                HasSubstr("hands_right_x"))
        << key;
  }
  EXPECT_THAT(names(R"("name": "left")"), HasSubstr("hands_1_x"));
  EXPECT_THAT(names(R"("hand": "both")"), HasSubstr("hands_1_x"));
  // In four lists at most.
  EXPECT_THAT(names(R"("hand": [[["left"]]])"), HasSubstr("hands_left_"));
  EXPECT_THAT(names(R"("hand": [[[["left"]]]])"), HasSubstr("hands_1_"));
  // Beside the list, one for each of its items.
  const auto beside = [](const std::string& hands) {
    const std::string text = TableOf(ReadJsonArrays(fmt::format(
        R"([{{"handedness": {0}, "p": [[1, 2], [3, 4]]}}, {{"handedness": {0}, "p": [[1, 2], [3, 4]]}}])",
        hands)));
    return text.substr(0, text.find('\n'));
  };
  EXPECT_EQ(beside(R"(["Left", "Right"])"), "p_left_1,p_left_2,p_right_1,p_right_2");
  EXPECT_EQ(beside(R"(["Left", "Left"])"), "p_1_1,p_1_2,p_2_1,p_2_2");
  EXPECT_EQ(beside(R"(["Left"])"), "p_1_1,p_1_2,p_2_1,p_2_2");
}

TEST(Json, HasNoNumbersWhereThereAreNone) {
  const auto table_of = [](const std::string& json) { return TableOf(ReadJsonArrays(json)); };
  EXPECT_EQ(
      table_of(R"([{"a": NaN, "b": "NaN, he said"}, {"a": -Infinity}, {"a": 1}, {"a": nan}])"),
      "a\nnan\nnan\n1\nnan\n");
  EXPECT_EQ(table_of(R"([{"a": "1", "n\"NaN": 2}, {"a": "2.5", "n\"NaN": NaN}])"),
            "a,n_NaN\n1,2\n2.5,nan\n");
  EXPECT_EQ(table_of(R"([{"a": 1, "b": null}, {"a": 2, "b": "x"}])"), "a\n1\n2\n");
}

TEST(Json, HasLimits) {
  const auto row = [](int count) {
    std::string text = "{";
    for (int i = 0; i < count; ++i) text += fmt::format("{}\"c{}\": 1", i > 0 ? "," : "", i);
    return text + "}";
  };
  EXPECT_EQ(ErrorOf([&] { ReadJsonArrays("[" + row(1000) + "," + row(1000) + "]"); }), "");
  EXPECT_EQ(ErrorOf([&] { ReadJsonArrays("[" + row(1001) + "]"); }),
            "has rows of more than 1000 values");
  const auto nested = [](int depth) {
    std::string text = "1";
    for (int i = 0; i < depth; ++i) text = "{\"a\": " + text + "}";
    return text;
  };
  EXPECT_EQ(ErrorOf([&] { ReadJsonArrays(nested(100)); }), "");
  EXPECT_EQ(ErrorOf([&] { ReadJsonArrays(nested(101)); }), "is nested too deeply");
  EXPECT_EQ(ErrorOf([&] { ReadJsonArrays("[" + nested(100) + "]"); }), "");
  EXPECT_EQ(ErrorOf([&] { ReadJsonArrays("[" + nested(101) + "]"); }), "is nested too deeply");
}

TEST(ReadJsonRow, KeepsEveryColumn) {
  const std::vector<NamedArray> row = ReadJsonRow(R"({"a": 1, "b": null, "c": [2, 3]})");
  ASSERT_EQ(row.size(), 4U);
  EXPECT_EQ(row[1].name, "b");
  EXPECT_TRUE(std::isnan(row[1].values.at(0)));
  EXPECT_EQ(row[3].name, "c_2");
  EXPECT_EQ(row[3].values.at(0), 3.0);
  EXPECT_EQ(ErrorOf([] { ReadJsonRow("{"); }), "is no JSON");
}

TEST(Json, ThatIsBrokenNamesItsLine) {
  EXPECT_THAT(ErrorOf([] { ReadJsonArrays("{\"a\": 1}\n{\"a\":"); }), HasSubstr("line 2"));
  const std::string deep(100'000, '[');
  EXPECT_NE(ErrorOf([&] { ReadJsonArrays(deep); }), "");
}

TEST(ReadDatasetInfo, TakesListsAndGroupsOfNames) {
  const DatasetInfo info = ReadDatasetInfo(
      R"({"fps": 30, "total_episodes": 5, "total_frames": 900, "features": {"action": {"names": ["a", "b"]},
          "state": {"names": {"motors": ["c"]}}, "index": {"names": null},
          "image": {"names": [1]}, "mask": {"shape": [1]}}})");
  EXPECT_EQ(info.names, (ListNames{{"action", {"a", "b"}}, {"state", {"c"}}}));
  EXPECT_EQ(info.rate_hz, 30.0);
  EXPECT_EQ(info.episodes, 5.0);
  EXPECT_EQ(info.rows, 900.0);
  for (const char* other : {"", "{", "[]", "{}", R"({"features": 1})", R"({"features": []})"}) {
    EXPECT_TRUE(ReadDatasetInfo(other).names.empty()) << other;
  }
}

TEST(Utf16, IsReadInBothOrdersOfBytes) {
  const std::u16string text = u"\uFEFFt\u00B0\u20AC\U0001F600\xD800x";
  std::string little, big;
  for (const char16_t unit : text) {
    little += {static_cast<char>(unit & 255), static_cast<char>(unit >> 8)};
    big += {static_cast<char>(unit >> 8), static_cast<char>(unit & 255)};
  }
  const std::string expected = "t\u00B0\u20AC\U0001F600\uFFFDx";
  EXPECT_EQ(AllOf(Utf8Of(TextSource(little))), expected);
  EXPECT_EQ(AllOf(Utf8Of(TextSource(big))), expected);
}

TEST(TableSource, GivesEveryNumberOfAnArrayToTheBit) {
  const test::TemporaryDirectory folder;
  const std::vector<double> values = {0.1, 1.0 / 3.0, -2.2250738585072014e-308, 1e300};
  std::string data(values.size() * sizeof(double), '\0');
  std::memcpy(data.data(), values.data(), data.size());
  const std::filesystem::path file = folder.path() / "a.csv";  // its name counts for nothing
  std::ofstream(file, std::ios::binary)
      << Npy("{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }", data);
  CsvReader csv("a", TableSource(file), ProblemHandling::kStrict);
  std::vector<double> row(1);
  for (const double value : values) {
    ASSERT_TRUE(csv.NextRow(row));
    EXPECT_EQ(row[0], value);
  }
  EXPECT_FALSE(csv.NextRow(row));
}

TEST(TableSource, ChoosesAnArrayAndListsThemAll) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "a.json";
  std::ofstream(file)
      << R"({"a": {"t": [0, 1], "x": [3, 4]}, "b": {"x": [[1, 2], [3, 4], [5, 6]]}})";
  EXPECT_EQ(test::TextOf(TableSource(file)), "b_x_1,b_x_2\n1,2\n3,4\n5,6\n");
  EXPECT_EQ(test::TextOf(TableSource(file, "a.x")), "t,a_x\n0,3\n1,4\n");
  std::string listed;
  for (const ListedArray& array : OpenTable(file, "a").arrays) {
    listed += fmt::format("{}{} ", array.name, array.is_taken ? "+" : "");
  }
  EXPECT_EQ(listed, "a_t+ a_x+ b_x_1 b_x_2 ");
  EXPECT_THAT(ErrorOf([&] { test::TextOf(TableSource(file, "c")); }),
              HasSubstr("a.json: holds no array c, but a_t (2 x 1)"));
  const std::filesystem::path text = folder.path() / "a.csv";
  std::ofstream(text) << "t,x\n0,1\n";
  EXPECT_THAT(ErrorOf([&] { TableSource(text, "x"); }),
              HasSubstr("is text, which has no array or topic x"));
  EXPECT_TRUE(OpenTable(text).arrays.empty());
}

TEST(FormatOfBytes, KnowsTextFromWhatIsNone) {
  EXPECT_EQ(FormatOfBytes("[Header]\nrate=100\n"), FileFormat::kText);
  EXPECT_EQ(FormatOfBytes("[[1,2]]"), FileFormat::kJson);
  std::string one_zero = "1,2\n3,\0004\n"s;
  one_zero.append(50, '1');
  EXPECT_EQ(FormatOfBytes(one_zero), FileFormat::kText);
  EXPECT_EQ(FormatOfBytes(std::string(50, '\0')), FileFormat::kBinary);
  EXPECT_EQ(FormatOfBytes(""), FileFormat::kEmpty);
  // One zero in twenty bytes is text still.
  EXPECT_EQ(FormatOfBytes("\0"s + std::string(19, '1')), FileFormat::kText);
  EXPECT_EQ(FormatOfBytes("\0"s + std::string(18, '1')), FileFormat::kBinary);
}

TEST(FormatOfBytes, KnowsEveryFormatByItsBeginning) {
  const std::string mat = "MATLAB 5.0 MAT-file" + std::string(107, ' ');
  for (const auto& [bytes, format] : std::vector<std::pair<std::string, FileFormat>>{
           {"\x89HDF\r\n\x1a\n", FileFormat::kHdf5},
           {"\x93NUMPY", FileFormat::kNpy},
           {"\x1f\x8b\b", FileFormat::kGzip},
           {"\x28\xb5\x2f\xfd", FileFormat::kZstd},
           {"SQLite format 3\0"s, FileFormat::kSqlite},
           {"#ROSBAG V2.0", FileFormat::kRosBag},
           {"\x89MCAP0\r\n", FileFormat::kMcap},
           {"PAR1", FileFormat::kParquet},
           {"version https://git-lfs.github.com", FileFormat::kLfsPointer},
           {"\x1a\x45\xdf\xa3", FileFormat::kVideo},
           {"RIFF1234AVI LIST", FileFormat::kVideo},
           {"RIFF1234WEBPVP8", FileFormat::kText},
           {"\1\2\3\4ftypisom", FileFormat::kVideo},
           {"XDF:", FileFormat::kXdf},
           {"Kaydara FBX Binary", FileFormat::kFbx},
           {"\xff\xfe", FileFormat::kUtf16},
           {"\xfe\xff", FileFormat::kUtf16},
           {mat + "IM", FileFormat::kMat},
           {mat + "MI", FileFormat::kMat},
           {mat + "XX", FileFormat::kText},
           {mat + "I", FileFormat::kText},
           {"MATLAB 7.3 MAT-file" + std::string(107, ' ') + "IM", FileFormat::kHdf5},
           {"\2\x50" + std::string(20, '\0'), FileFormat::kC3d},
           {"\x10\x50" + std::string(20, '\0'), FileFormat::kBinary},
           {"\1\x50" + std::string(20, '\0'), FileFormat::kBinary},
           {"\2\x51" + std::string(20, '\0'), FileFormat::kBinary},
           {"\2\x50,1", FileFormat::kText},
           {"\n <?xml?><robot name='a'>", FileFormat::kUrdf},
           {"<html>", FileFormat::kText},
           {"t,<robot\n", FileFormat::kText},
           {" HIERARCHY\nROOT a", FileFormat::kBvh},
           {"hierarchy:", FileFormat::kBvh},
           {"hierarchical", FileFormat::kText},
           {"{\"a\": 1}", FileFormat::kJson},
           {" [ {", FileFormat::kJson},
           {"[1, 2]", FileFormat::kJson},
           {"[-1.5", FileFormat::kJson},
           {"[2026-04-27 02:16:12] 3,4", FileFormat::kText},
           {"[", FileFormat::kText},
           {" \n", FileFormat::kText},
       }) {
    EXPECT_EQ(FormatOfBytes(bytes), format) << bytes;
  }
}

TEST(FileFormats, HaveNamesAndAWayOutWhereTheyAreNotRead) {
  for (int i = 0; i <= static_cast<int>(FileFormat::kBinary); ++i) {
    const auto format = static_cast<FileFormat>(i);
    EXPECT_FALSE(NameOf(format).empty()) << i;
    EXPECT_FALSE(NameInProfiles(format).empty()) << i;
    EXPECT_EQ(HasTopics(format), format == FileFormat::kMcap || format == FileFormat::kSqlite ||
                                     format == FileFormat::kRosEcho);
  }
  for (const auto& [format, name] : {std::pair(FileFormat::kText, "text"),
                                     {FileFormat::kUtf16, "text"},
                                     {FileFormat::kJson, "json"},
                                     {FileFormat::kNpz, "npy"},
                                     {FileFormat::kMat, "mat"},
                                     {FileFormat::kHdf5, "hdf5"},
                                     {FileFormat::kSqlite, "bag"},
                                     {FileFormat::kRosEcho, "echo"},
                                     {FileFormat::kMcap, "mcap"},
                                     {FileFormat::kParquet, "parquet"},
                                     {FileFormat::kTrc, "other"}}) {
    EXPECT_EQ(NameInProfiles(format), name);
  }
}

TEST(FormatOfBytes, NamesAWayOutOfWhatIsNotRead) {
  const std::string edf = "0       " + std::string(160, 'x') + "01.01.2401.01.01768     ";
  for (const auto& [head, format] :
       {std::pair("ARROW1\0\0"s, FileFormat::kArrow),
        std::pair("\xff\xff\xff\xff\x10\2\0\0\x10"s, FileFormat::kArrow),
        std::pair("TDSm\x0e\0"s, FileFormat::kTdms), std::pair(edf, FileFormat::kEdf),
        std::pair("RIFF\1\1\0\0WAVEfmt "s, FileFormat::kWave),
        std::pair("\x80\4\x95\1\0"s, FileFormat::kPickle),
        std::pair("\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"s, FileFormat::kXls)}) {
    EXPECT_EQ(FormatOfBytes(head), format) << NameOf(format);
    EXPECT_NE(WayOut(format), "");
  }
}

/// Wrong: the rate of the last group for all.
TEST(WriteTable, TakesTheRateOfItsOwnGroup) {
  EXPECT_EQ(TableOf({{.name = "glove_angles", .rows = 3, .values = {7, 8, 9}},
                     {.name = "glove_fs", .rows = 1, .values = {50}},
                     {.name = "imu_fs", .rows = 1, .values = {200}}}),
            "time_s,glove_angles\n0,7\n0.02,8\n0.04,9\n");
}

TEST(WithFacts, NamesColumnsAndUnitsByTheTextsBesideThem) {
  const std::vector<double> five(3 * 2, 0.5);
  std::vector<NamedArray> arrays = {
      {.name = "glove_data", .rows = 3, .columns = 2, .values = five},
      {.name = "glove_sensornames", .columns = 0, .values = {}, .texts = {"Thumb IP", "Index"}},
      {.name = "glove_angleunit", .columns = 0, .values = {}, .texts = {"Radians"}},
      {.name = "other_data", .rows = 3, .columns = 2, .values = five},
      {.name = "glove_time", .rows = 3, .columns = 1, .values = {0, 1, 2}}};
  const std::vector<NamedArray> found = WithFacts(arrays);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_THAT(found[0].column_names, testing::ElementsAre("Thumb IP_rad", "Index_rad"));
  EXPECT_THAT(found[1].column_names, testing::IsEmpty());
  EXPECT_THAT(found[2].column_names, testing::IsEmpty());
  arrays[1].texts.emplace_back("Ring");  // fits no array
  EXPECT_THAT(WithFacts(arrays)[0].column_names,
              testing::ElementsAre("glove_data_1_rad", "glove_data_2_rad"));
}

TEST(WithFacts, NamesTheOnlyArrayThatHasAsManyColumns) {
  std::vector<NamedArray> arrays = {
      {.name = "q", .rows = 3, .columns = 2, .values = std::vector<double>(6, 0.5)},
      {.name = "joint_names", .columns = 0, .values = {}, .texts = {"a", "b"}}};
  EXPECT_THAT(WithFacts(arrays)[0].column_names, testing::ElementsAre("a", "b"));
  arrays.push_back({.name = "dq", .rows = 3, .columns = 2, .values = std::vector<double>(6, 0.5)});
  EXPECT_THAT(WithFacts(arrays)[0].column_names, testing::IsEmpty());  // or of dq
}

TEST(WriteTable, TakesTheRateFromAFrameDuration) {
  const auto first_line_of = [](const char* name, double value) {
    return TableOf({{.name = name, .rows = 1, .columns = 1, .values = {value}},
                    {.name = "a", .rows = 3, .columns = 1, .values = {7, 8, 9}}});
  };
  EXPECT_EQ(first_line_of("FrameDuration", 0.02), "time_s,a\n0,7\n0.02,8\n0.04,9\n");
  EXPECT_EQ(first_line_of("FrameDuration", 20.0), "time_s,a\n0,7\n0.02,8\n0.04,9\n");
  EXPECT_EQ(first_line_of("FrameDuration", 0.5), "a\n7\n8\n9\n");  // s or ms
}

}  // namespace
}  // namespace gauntlet::sim
