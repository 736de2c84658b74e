// Recordings as real ones are, changed at random: Inspect() refuses each in one line, or gives
// numbers that agree with each other.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/base/random.h"
#include "tests/inspect/inspected_text.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

std::string Join(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

struct Recording {
  std::vector<std::string> lines;
  std::size_t rows;
  std::size_t columns;
};

/// Recordings in the ways that programs write them.
const std::vector<Recording>& Recordings() {
  static const std::vector<Recording> kRecordings = {
      {{"time_s,index_mcp,index_pip", "0,1,2", "0.01,3,4", "0.02,5,6", "0.03,6,7"}, 4, 3},
      {{"Glove 2.1", "Serial,17", "", "t,flex1,flex2", "0,512,1", "1,513,2", "2,516,3"}, 3, 3},
      {{"Time\tThumb\tlabel", "[s]\t[deg]\t", "0\t1,5\t", "1\t2,5\t", "2\t3,5\t"}, 3, 3},
      {{"# t a b", "0 1 2", "1 2 3", "# pause", "2 3 4", "", "3 4 5"}, 4, 3},
      {{"0,01 1,5", "0,02 1,6", "0,03 1,7"}, 3, 2},
      {{"\"time\n(s)\",\"index\nmcp\"", "0,1", "0.01,2", "0.02,3"}, 3, 2},
      {{"Date;Time;a;b", "2024-05-31;12:00:00,1;5;6", "2024-05-31;12:00:00,2;6;7"}, 2, 4},
      {{",index_mcp,thumb_ip", "0,1,2", "1,1,nan", "2,,4"}, 3, 3},
      {{"t,a", "0,1,", "0.1,2,", "0.2,3,"}, 3, 2},
      {{"512,513,514", "515,516,517", "518,519,520"}, 3, 3}};
  return kRecordings;
}

/// Lines that stand in files without being rows of their table.
const std::vector<std::string>& OddLines() {
  static const std::vector<std::string> kLines = {"",
                                                  "# comment",
                                                  "\"",
                                                  "\"two\nlines\",1",
                                                  ",,,,",
                                                  "1",
                                                  "NaN,inf,1e308",
                                                  "a,b",
                                                  ";;",
                                                  "1;2;3",
                                                  "\t\t",
                                                  "1 2 3",
                                                  "-1e-300",
                                                  "'x",
                                                  "9999999999999,1,2"};
  return kLines;
}

std::string Changed(RandomStream& random) {
  const auto pick = [&random](const auto& list) { return list[random.Index(list.size())]; };
  std::vector<std::string> lines = pick(Recordings()).lines;
  for (auto changes = random.Index(4); changes > 0 && !lines.empty(); --changes) {
    const std::size_t at = random.Index(lines.size());
    std::string& line = lines[at];
    switch (random.Index(7)) {
      case 0:
        lines.erase(lines.begin() + at);
        break;
      case 1:
        lines.insert(lines.begin() + at, pick(OddLines()));
        break;
      case 2:
        lines.resize(at + 1);
        break;
      case 3:
        line += "," + pick(OddLines());
        break;
      case 4:
        line.resize(random.Index(line.size() + 1));
        break;
      case 5:
        for (char& letter : line) letter = letter == ',' ? ";\t ,"[random.Index(4)] : letter;
        break;
      default:
        if (!line.empty()) line[random.Index(line.size())] = "0;,\t \"'.#e"[random.Index(10)];
    }
  }
  std::string text = Join(lines);
  if (random.Index(4) == 0) text.resize(random.Index(text.size() + 1));
  return text;
}

TEST(Inspect, AgreesWithItselfOverChangedRecordings) {
  const test::TemporaryDirectory folder;
  RandomStream random(1, "inspect");
  int inspected = 0;
  constexpr int kTexts = 600;
  for (int i = 0; i < kTexts; ++i) {
    const std::string text = Changed(random);
    const InspectedText result = InspectText(text, folder.path());
    EXPECT_EQ(result.problem, "") << text;
    inspected += result.inspection ? 1 : 0;
  }
  EXPECT_GT(inspected, kTexts / 2);
  EXPECT_LT(inspected, kTexts);
}

TEST(Inspect, ReadsTheRecordingsBeforeTheyAreChanged) {
  const test::TemporaryDirectory folder;
  for (const auto& [lines, rows, columns] : Recordings()) {
    const InspectedText result = InspectText(Join(lines), folder.path());
    EXPECT_EQ(result.problem, "");
    ASSERT_TRUE(result.inspection) << lines.front();
    EXPECT_EQ(result.inspection->rows, rows) << lines.front();
    EXPECT_EQ(result.inspection->columns.size(), columns) << lines.front();
  }
}

}  // namespace
}  // namespace gauntlet::sim
