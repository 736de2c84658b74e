#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/live/live_report.h"
#include "sim/live/live_session.h"
#include "sim/live/session_scores.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {

/// A session that was run, and what it was made from.
struct LiveRecord {
  const LiveSetup* setup = nullptr;
  const Study* study = nullptr;
  const ScenarioSource* source = nullptr;
};

/// Results of a session besides its measurements.
struct LiveOutcome {
  std::optional<FinishedStudy> finished;  // as of `gauntlet run`; nothing of a session too short
  std::vector<ShadowScore> shadows;       // the controller that drove first; empty without shadows
  std::string remark;                     // why there is no study, or what its trace lacks
};

/// How much of a session its trace has: `seconds`, or the whole of a simulated motion, or the first
/// two minutes; at most ten minutes.
double TraceLength_s(double seconds, double motion_s);

/// Scores of the session's trace, as of a run: against the wearer's true angles where the glove was
/// simulated, else against the smoothed recording, whose scenario it then is. Moves the trace out
/// of `result`. Errors: UserError for a recording that cannot be read back.
LiveOutcome ScoreSession(const LiveRecord& record, const std::filesystem::path& recording,
                         const std::filesystem::path& folder, LiveResult& result);

/// How the running scores of a page are to be computed: as those above.
RunningScoring RunningScoringOf(const Study& study, const LiveSetup& setup);

/// Writes the files that `gauntlet report` and `render` open.
void WriteSession(const std::filesystem::path& folder, const FinishedStudy& finished);

}  // namespace gauntlet::sim
