// Recordings in many shapes through whole commands: each is right, or asks. The table of answers is
// printed; a wrong one that is not called assumed beside its result fails.
#include "tests/cli/glove_shapes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
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
    const std::set<std::string> kNone = {"time", "ignore", "left", "right"};
    if (!kNone.contains(row["channel"])) rows[row["column"]] = row;
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
    const bool is_scaled = row.contains("scale") && row.at("scale") == "0.001";
    note(is_scaled == (shape.unit == "mrad"), "", "-", column + " has another scale");
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
  ASSERT_EQ(shapes.size(), 173U);
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

/// Options that a question names, with their values; HZ is 100.
std::vector<std::vector<std::string>> RecipesIn(const std::string& line) {
  std::vector<std::vector<std::string>> recipes;
  const std::regex recipe("--(unit|time-unit|hand|preset|rate) ([a-zA-Z0-9_]+)");
  for (std::sregex_iterator found(line.begin(), line.end(), recipe), end; found != end; ++found) {
    if ((*found)[2] == "NAME") continue;
    recipes.push_back({"--" + (*found)[1].str(), (*found)[2] == "HZ" ? "100" : (*found)[2].str()});
  }
  return recipes;
}

/// The map with a channel of its own in place of each `ignore`, as long as there are channels.
/// The time is in ms where its unit is asked for.
void FillIn(const fs::path& map, const std::string& question) {
  std::vector<std::string> channels = {"thumb_ip",   "index_pip",  "middle_pip", "ring_pip",
                                       "little_pip", "index_mcp",  "middle_mcp", "ring_mcp",
                                       "little_mcp", "middle_dip", "ring_dip",   "little_dip"};
  std::ifstream before(map);
  std::string text;
  for (std::string line; std::getline(before, line);) {
    const std::size_t ignored = line.find(",ignore,");
    if (ignored != std::string::npos && !line.starts_with('#') && !channels.empty()) {
      line.replace(ignored + 1, 6, channels.back());
      channels.pop_back();
    }
    const std::size_t time = line.find(",time,s,");
    if (time != std::string::npos && question.find("rows per second") != std::string::npos) {
      line.replace(time, 8, ",time,ms,");
    }
    text += line + "\n";
  }
  std::ofstream(map) << text;
}

/// Advice answers its question: the next one, if any, is another.
TEST(GloveShapes, LeadOnByEachRecipeOfTheirQuestions) {
  int recipes = 0, maps = 0, answered = 0;
  for (const GloveShape& shape : GloveShapes()) {
    if (shape.question.empty()) continue;
    const TemporaryDirectory folder;
    std::ofstream(folder.path() / "glove.csv", std::ios::binary) << shape.text;
    const auto inspect = [&](const std::vector<std::string>& options) {
      std::vector<std::string> command = {GAUNTLET_PROGRAM, "inspect", "glove.csv"};
      command.insert(command.end(), shape.options.begin(), shape.options.end());
      command.insert(command.end(), options.begin(), options.end());
      return RunProgram(command, {.working_directory = folder.path()});
    };
    const ProgramResult asked = inspect({"--write-map", "map.csv"});
    ASSERT_EQ(asked.exit_code, 2) << shape.name;
    const std::string& line = asked.standard_error;
    std::vector<std::vector<std::string>> ways = RecipesIn(line);
    recipes += static_cast<int>(ways.size());
    if (line.find("fill in map.csv, then --map map.csv") != std::string::npos) {
      FillIn(folder.path() / "map.csv", line);
      ways.push_back({"--map", "map.csv"});
      ++maps;
    }
    for (const std::vector<std::string>& way : ways) {
      const ProgramResult next = inspect(way);
      EXPECT_TRUE(next.exit_code == 0 || next.exit_code == 2) << shape.name;
      EXPECT_EQ(next.standard_error.find(shape.question), std::string::npos)
          << shape.name << " " << way[0] << " " << way[1] << ": " << next.standard_error;
      answered += next.exit_code == 0 ? 1 : 0;
    }
  }
  fmt::print("{} recipes and {} maps, of which {} answer all\n", recipes, maps, answered);
  EXPECT_GE(recipes, 5);
  EXPECT_GE(maps, 15);
  EXPECT_GE(answered, 20);
}

}  // namespace
}  // namespace gauntlet::test
