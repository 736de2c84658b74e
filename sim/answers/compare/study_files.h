#pragma once

#include <filesystem>
#include <string>

#include "sim/answers/compare/summary.h"

namespace gauntlet::sim {

class Json;

/// A difference as `scores.json` and the page have it. `replicates`: the key of their number.
Json JsonOf(const Comparison& comparison, const std::string& replicates);
/// "blocks" of a single recording, or "seeds".
std::string ReplicatesOf(const Summary& summary);

/// `scores.json` of one run (one seed: values) or of a comparison (several: means and intervals).
/// `channels` has an entry per scored joint, motor and cable, with the scores that it can have.
std::string ScoresJson(const FinishedStudy& finished);

/// `scores.csv`: one row per seed, controller and scored joint, motor or cable (`summary` for all),
/// a column per metric.
std::string ScoresCsv(const StudyResult& result);

/// The scenario with every value used, versions, hashes of the model and of the files that it
/// names. Errors: RunError for one that cannot be read.
std::string ResolvedScenario(const FinishedStudy& finished);

/// Formats of the traces that are written beside trace.h5.
struct TraceFormats {
  bool csv = false;   // a file per controller
  bool mcap = false;  // trace.mcap
};

/// Writes scores.json, scores.csv, scenario.resolved.yaml and trace.h5 (of the first seed) into
/// `folder`, which should be that of OutputFiles: so they appear together. Errors: RunError.
void WriteStudyFiles(const std::filesystem::path& folder, const FinishedStudy& finished,
                     const TraceFormats& formats = {});

/// Writes them as the last use of the traces: the signals of a controller go as soon as they are
/// written, so that the disk need not hold all of them twice.
void WriteLastStudyFiles(const std::filesystem::path& folder, FinishedStudy& finished,
                         const TraceFormats& formats = {});

}  // namespace gauntlet::sim
