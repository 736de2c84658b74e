#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/scenario/scenario.h"
#include "sim/score/score.h"
#include "sim/trial/trial.h"

namespace gauntlet::sim {

/// A scenario whose parts have all been built once, so that nothing in it is wrong any more.
struct Study {
  Scenario scenario;
  std::shared_ptr<const HandModel> hand;
  controller::GloveCalibration calibration;
  std::vector<std::string> remarks;  // what was repaired in recordings, one line each
  std::string glove_hash;            // of the first seed's signal
};

/// Builds hand, glove (of the first seed) and every controller. Errors: UserError, SettingError.
Study PrepareStudy(Scenario scenario);

class StudyDatabase;

/// What one controller did with one seed.
struct TrialOutcome {
  Scores scores;
  HandHealth health;
  std::vector<std::int64_t> untrusted_samples;  // per channel
};

/// All trials of one seed: the same glove signal and the same hand for every controller.
struct SeedOutcome {
  int seed = 0;
  std::vector<TrialOutcome> controllers;  // in the order of the scenario
};

struct StudyOptions {
  int seeds = 1;  // seed, seed + 1, ...
  int jobs = 1;
  /// Gets trials done (with fractions of the running ones) and trials in all. Called from any
  /// thread, one at a time. False stops: RunStudy throws Cancelled.
  std::function<bool(double, int)> progress;
  /// Keep the glove signal and the traces of the first seed.
  bool keep_first_traces = true;
  /// Where finished trials are kept and looked for; null: nowhere.
  StudyDatabase* database = nullptr;
};

struct StudyResult {
  std::vector<std::string> controller_names;
  std::vector<std::string> channel_names;
  std::string reference_name;
  double rate_hz = 1000.0;
  std::vector<SeedOutcome> seeds;  // in the order of seeds, whatever the schedule
  GloveSignal first_glove;
  std::vector<Trace> first_traces;
};

/// Runs every controller on every seed, `jobs` trials at a time. The result does not depend on
/// jobs.
StudyResult RunStudy(const Study& study, const StudyOptions& options);

}  // namespace gauntlet::sim
