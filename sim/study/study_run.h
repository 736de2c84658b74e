#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/few_signals_on_heap.h"
#include "sim/study/cause_plan.h"
#include "sim/study/elsewhere.h"
#include "sim/study/study.h"

namespace gauntlet::sim {

/// The result of one trial.
struct TrialOutcome {
  Scores scores;  // none, all NaN, of a hand that was stopped
  HandHealth health;
  std::vector<std::int64_t> untrusted_samples;  // per channel
  std::vector<Scores> without = {};  // one block of StudyOptions::blocks each, not in a store
};

/// The finished trials of a study; `controller` is the place in the study. Any thread may call it.
class TrialStore {
 public:
  virtual ~TrialStore() = default;
  /// True if Take() gives this trial. Changes nothing.
  virtual bool Has(int seed, std::size_t controller) = 0;
  /// Hands a finished trial over; nothing if there is none. RunStudy() takes each trial once and
  /// asks nothing of it afterwards, so a store need not hold it any longer.
  virtual std::optional<TrialOutcome> Take(int seed, std::size_t controller) = 0;
  virtual void Keep(int seed, std::size_t controller, const TrialOutcome& outcome) = 0;
};

/// All trials of one seed: the same glove signal and the same hand for every controller.
struct SeedOutcome {
  int seed = 0;
  int motion = 0;  // number of what the wearer did, from 0: the same where the true angles are
  std::vector<TrialOutcome> controllers;  // in the order of the scenario
};

struct StudyOptions {
  int seeds = 1;  // seed, seed + 1, ...
  int jobs = 1;
  /// Gets trials done (with fractions of the running ones) and trials in all, twins counted. Called
  /// from any thread, one at a time. False stops: RunStudy throws Cancelled.
  std::function<bool(double, int)> progress = {};
  /// Gets a line for the user about what went otherwise than asked and changes no result. May be
  /// empty.
  std::function<void(const std::string&)> remark = {};
  /// Keep the glove signal and the traces of the first seed.
  bool keep_first_traces = true;
  /// The caller lets them go as it writes them, see WriteLastStudyFiles(): less disk is needed.
  bool traces_go = false;
  /// Keep the scores of every joint, motor and cable; false: only their means, in a thousandth of
  /// the memory.
  bool keep_rows = true;
  /// False: what the controller asks the joints for is scored as if a hand had done it, see
  /// RunFilterTrial().
  bool physics = true;
  CauseSeeds causes = CauseSeeds::kNone;
  TrialStore* store = nullptr;  // null: none
  /// In Metrics(): only these scores, and no twin where none of them needs one; empty: all. Causes
  /// that are named here are found of all seeds.
  std::vector<std::size_t> scores = {};
  /// Per repetition the ticks that no score counts; empty: all count.
  std::vector<CountedTicks> left_out = {};
  /// Per repetition blocks of the other ticks: a trial is scored again without each of them.
  std::vector<std::vector<TickRange>> blocks = {};
};

struct StudyResult {
  std::shared_ptr<const FewSignalsOnHeap> few_on_heap;  // of a long study: see CheckRoom()
  std::vector<std::string> controller_names;
  std::vector<std::string> row_names;  // of the scores: see ScoreRows
  std::string reference_name;
  std::vector<SeedOutcome> seeds;  // in the order of seeds, whatever the schedule
  /// Nothing is drawn at random: one seed of each repetition was run, the others would be the same.
  bool seeds_alike = false;
  double shortest_s = 0.0;  // of the trials, as far as the wearer's motion goes
  double longest_s = 0.0;
  CausePlan causes;  // of which trials causes were found
  std::shared_ptr<const GloveSignal> first_glove;
  Signal first_reference_rad;  // ticks x joints of the hand
  std::vector<Trace> first_traces;
  std::vector<std::optional<NoiseFreeTwin>> first_twins;  // of these trials, where they have one
  std::vector<CauseAngles> first_others;                  // of these trials, if causes are found
};

/// `seeds`, or one for each repetition where nothing is drawn at random: see RunStudy().
int SeedsThatDiffer(const Study& study, int seeds);

/// Number of trials of so many seeds, twins and those of causes included, cut ones as parts.
int TrialCount(const Study& study, int seeds, CauseSeeds causes = CauseSeeds::kNone);

/// Runs every controller on every seed, `jobs` trials at a time; repetitions take turns. Where
/// nothing is drawn at random, as with the recording of a real glove, one seed of each repetition
/// stands for all. Before a trial its noise-free twin runs, which the scores need: see ScoreInput.
/// The result does not depend on jobs. Errors: RunError, before the first trial, where the signals
/// find no room: see SignalStorage.
StudyResult RunStudy(const Study& study, const StudyOptions& options);

/// Runs some of the trials that RunStudy() would run, for the store of the options. They are
/// numbered from 0, seed by seed, and within a seed in the order of the controllers. Errors: as of
/// RunStudy().
void RunSomeTrials(const Study& study, const StudyOptions& options, const WorkRange& trials);

}  // namespace gauntlet::sim
