#pragma once

#include <filesystem>
#include <string>

#include "sim/study/summary.h"

namespace gauntlet::sim {

/// `scores.json` of one run (one seed: values) or of a comparison (several: means and intervals).
std::string ScoresJson(const Study& study, const StudyResult& result, const Summary& summary,
                       bool comparison);

/// `scores.csv`: one row per seed, controller and channel (`summary` for all), a column per metric.
std::string ScoresCsv(const StudyResult& result);

/// The scenario with every value used, versions and model hash.
std::string ResolvedScenario(const Study& study);

struct StudyFileOptions {
  bool comparison = false;
  bool trace_csv = false;  // a CSV per controller beside trace.h5
};

/// Writes scores.json, scores.csv, scenario.resolved.yaml and trace.h5 (of the first seed), each
/// whole or not at all. The video and trace tables of another scenario, which the folder held
/// before, are removed. Errors: RunError.
void WriteStudyFiles(const std::filesystem::path& folder, const Study& study,
                     const StudyResult& result, const Summary& summary,
                     const StudyFileOptions& options);

}  // namespace gauntlet::sim
