#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// A score of a controller as the end of a video shows it.
struct ScoreBoardCell {
  enum class Tone { kPlain, kAsGoodAsBest, kWorseThanBaseline };
  std::string value;   // 6.44°
  std::string detail;  // how far from the best, with its interval; may be empty
  Tone tone = Tone::kPlain;
};

struct ScoreBoardRow {
  std::string controller;
  std::vector<ScoreBoardCell> cells;  // of each column
};

/// What a run or comparison found, for people who look for two seconds.
struct ScoreBoard {
  std::vector<std::string> columns;
  std::vector<ScoreBoardRow> rows;
  std::string remark;  // what the numbers stand on
};

/// From `scores.json`, of some controllers and in their order. Errors: UserError for a file that is
/// none, or that lacks one of them.
ScoreBoard ReadScoreBoard(const std::filesystem::path& file,
                          const std::vector<std::string>& controllers);

}  // namespace gauntlet::sim
