#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {

/// The summaries of a `scores.csv`, seed by seed.
struct ScoreFile {
  std::vector<int> seeds;
  std::vector<std::string> controllers;
  std::vector<std::string> channels;
  std::vector<bool> has_metric;  // per metric of Metrics(): an older version knew fewer
  /// By controller, metric of Metrics(), seed. NaN: no score.
  std::vector<std::vector<std::vector<double>>> summary;
};

/// The output folder of `run` or `compare`, as far as two of them can be compared.
struct StudyFolder {
  std::string name;
  Scenario scenario;
  ScoreFile scores;
  bool checked = false;  // by its manifest
};

/// Reads what ScoresCsv() wrote, also after a spreadsheet put a byte order mark and carriage
/// returns into it; `name` stands for the file in messages. A score is a finite number, or empty:
/// undefined; a column of Metrics() may be missing. Errors: UserError `file:row:column: ...`, also
/// for columns that are not those of Metrics().
ScoreFile ParseScoresCsv(const std::string& name, std::string_view text);

/// True if the scores of an output folder are those of a comparison.
bool HoldsComparison(const std::filesystem::path& folder);

/// Reads `scenario.resolved.yaml` and `scores.csv`, checked by the manifest. Errors: UserError in
/// one line.
StudyFolder ReadStudyFolder(const std::filesystem::path& folder);

}  // namespace gauntlet::sim
