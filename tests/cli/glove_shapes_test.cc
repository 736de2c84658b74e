// Recordings in 78 shapes through whole commands: each is right, or asks. The table of answers is
// printed; a wrong one that is not called assumed beside its result fails.
#include "tests/cli/glove_shapes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "sim/base/csv_line.h"
#include "tests/support/program.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;

enum class Answer { kRight, kAssumed, kAsks, kWrong };

struct Judged {
  Answer answer;
  std::string reason;
};

/// Rows of a map by the channel, with the keys of its header.
std::map<std::string, std::map<std::string, std::string>> RowsOfMap(const fs::path& map) {
  std::ifstream file(map);
  std::vector<std::string> keys;
  std::map<std::string, std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    const auto cells = sim::SplitCells(line);
    if (keys.empty()) {
      keys.assign(cells.begin(), cells.end());
      continue;
    }
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < cells.size(); ++i) row[keys[i]] = cells[i];
    if (row["channel"] != "time" && row["channel"] != "ignore") rows[row["column"]] = row;
  }
  return rows;
}

/// What is wrong about the map, and whether the map itself says that it is assumed.
Judged JudgeMap(const GloveShape& shape, const fs::path& map, const nlohmann::json& found) {
  std::string wrong, assumed;
  const auto note = [&](bool is_right, const std::string& row_assumed, const std::string& word,
                        const std::string& what) {
    const bool is_assumed = row_assumed.find(word) != std::string::npos;
    if (is_assumed) assumed = word;
    if (!is_right && !is_assumed && wrong.empty()) wrong = what;
  };
  const auto rows = RowsOfMap(map);
  std::map<std::string, std::string> joints;
  for (const auto& [column, row] : rows) {
    const std::string& words = row.at("assumed");
    const auto truth = shape.joints.find(column);
    const bool is_joint = truth != shape.joints.end() && truth->second == row.at("channel");
    note(is_joint, words, "joint", column + " is not " + row.at("channel"));
    note(found["unit"] == shape.unit, words, "unit", "unit " + found["unit"].get<std::string>());
    const bool is_inverted = row.at("sign") == "-1";
    note(is_inverted == shape.is_inverted || row.at("channel").find("abd") != std::string::npos,
         words, "sign", column + " has sign " + row.at("sign"));
    const double rate_hz = found["rate_hz"];
    note(std::abs(rate_hz - shape.rate_hz) < 0.02 * shape.rate_hz, words, "rate",
         fmt::format("{} Hz", rate_hz));
  }
  if (wrong.empty() && rows.size() != shape.joints.size()) {
    wrong = fmt::format("{} joints of {}", rows.size(), shape.joints.size());
  }
  if (!wrong.empty()) return {Answer::kWrong, wrong};
  return {assumed.empty() ? Answer::kRight : Answer::kAssumed, assumed};
}

/// The answer of inspect and compare.
Judged Judge(const GloveShape& shape) {
  const TemporaryDirectory folder;
  std::ofstream(folder.path() / "glove.csv", std::ios::binary) << shape.text;
  const auto run = [&folder](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return RunProgram(arguments, {.working_directory = folder.path()});
  };
  std::vector<std::string> inspect = {"inspect", "glove.csv", "--json", "--write-scenario",
                                      "s.yaml"};
  inspect.insert(inspect.end(), shape.options.begin(), shape.options.end());
  const ProgramResult looked = run(inspect);
  if (looked.exit_code == 2) {
    const auto last = looked.standard_error.rfind("gauntlet: ");
    const std::string line = last == std::string::npos ? "" : looked.standard_error.substr(last);
    const bool is_asked =
        line.find(shape.question) != std::string::npos && std::ranges::count(line, '\n') == 1;
    const bool names_map = line.find("--map") != std::string::npos;
    if (names_map && !shape.map_answers) return {Answer::kWrong, "a map does not help: " + line};
    return {is_asked ? Answer::kAsks : Answer::kWrong, line};
  }
  if (looked.exit_code != 0) return {Answer::kWrong, looked.standard_error};
  if (!shape.question.empty()) return {Answer::kWrong, "no question: " + shape.question};
  const ProgramResult compared = run({"compare", "s.yaml", "--controllers", "raw", "--out", "out"});
  if (compared.exit_code == 2) return {Answer::kAsks, compared.standard_error};
  if (compared.exit_code != 0) return {Answer::kWrong, compared.standard_error};
  const Judged judged =
      JudgeMap(shape, folder.path() / "s.map.csv", nlohmann::json::parse(looked.standard_output));
  const std::string beside = compared.standard_output + compared.standard_error;
  if (judged.answer == Answer::kAssumed && beside.find("assumed") == std::string::npos) {
    return {Answer::kWrong, judged.reason + " is not called assumed beside the result"};
  }
  return judged;
}

TEST(GloveShapes, AreRightOrAsk) {
  std::map<Answer, int> answers;
  const auto shapes = GloveShapes();
  ASSERT_EQ(shapes.size(), 114U);
  int answerable = 0, asked_in_vain = 0;
  for (const GloveShape& shape : shapes) {
    const Judged judged = Judge(shape);
    ++answers[judged.answer];
    answerable += shape.question.empty() ? 1 : 0;
    asked_in_vain += shape.question.empty() && judged.answer == Answer::kAsks ? 1 : 0;
    EXPECT_NE(judged.answer, Answer::kWrong) << shape.name << ": " << judged.reason;
    constexpr const char* kWords[] = {"right", "right, parts assumed", "asks", "WRONG"};
    fmt::print("{:<20} {}: {}\n", shape.name, kWords[static_cast<int>(judged.answer)],
               judged.reason);
  }
  fmt::print("right {}, right with assumed parts {}, asks {}, wrong {}\n", answers[Answer::kRight],
             answers[Answer::kAssumed], answers[Answer::kAsks], answers[Answer::kWrong]);
  EXPECT_GE(answers[Answer::kRight] + answers[Answer::kAssumed], 36);
  EXPECT_EQ(asked_in_vain, 0) << "of " << answerable;
}

}  // namespace
}  // namespace gauntlet::test
