#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/answers/compare/decisive_second.h"
#include "sim/show/video/frame_clock.h"

namespace gauntlet::sim {

/// A score of a controller as the end of a video shows it.
struct ScoreBoardCell {
  enum class Tone { kPlain, kBetter, kWorse };  // than the baseline
  std::string value;                            // 6.44°
  std::string detail;  // difference to the baseline, with its interval; may be empty
  Tone tone = Tone::kPlain;
};

struct ScoreBoardRow {
  std::string controller;
  std::vector<ScoreBoardCell> cells;  // of each column
  std::size_t series = 1;             // of its colour
};

/// Findings of a run or comparison, for people who look for two seconds.
struct ScoreBoard {
  std::string answer = {};  // sentences of the verdict
  std::vector<std::string> columns;
  std::vector<ScoreBoardRow> rows;
  std::string remark;  // what the numbers stand on
};

/// Entries of `scores.json` about a video, besides the scores.
struct VideoPlan {
  /// A controller, in the order of the verdict.
  struct Named {
    std::string name;
    std::string role;        // recommended, baseline; may be empty
    std::size_t series = 0;  // of its colour
  };
  std::vector<Named> controllers;
  std::vector<std::string> shown;  // by default
  std::optional<Excerpt> again;    // the decisive second, in slow motion
};

/// The decisive second as a video shows it.
Excerpt SlowMotionOf(const DecisiveSecond& second);

/// Errors: UserError for a file that is none.
VideoPlan ReadVideoPlan(const std::filesystem::path& file);

/// From `scores.json`, of some controllers and in their order. Differences only if the baseline is
/// one of them. Errors: UserError for a file that is
/// none, or that lacks one of them.
ScoreBoard ReadScoreBoard(const std::filesystem::path& file,
                          const std::vector<std::string>& controllers);

}  // namespace gauntlet::sim
