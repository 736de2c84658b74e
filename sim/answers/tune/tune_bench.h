#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sim/answers/tune/tune.h"
#include "sim/study/elsewhere.h"
#include "sim/study/scenario/filter_input.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// Runs one controller of a scenario with other values, always on the same replicates.
class TuneBench {
 public:
  using Progress = std::function<bool(double done, int all)>;

  /// On one part of the split. `metrics` are the scores of every TunedSetting, those of the plan's
  /// constraints among them.
  /// Errors: UserError, SettingError for a scenario that cannot be built.
  TuneBench(const TunePlan& plan, std::vector<std::size_t> metrics, const TuneSplit& split,
            TunePart part, int jobs);

  /// The controller with these values of plan.free; as the scenario has it if there are none.
  /// Errors: UserError if it cannot be read.
  NamedController ControllerWith(const std::vector<std::string>& values) const;

  /// Input of the controller's filter.
  FilterInput Input() const;

  /// One that cannot be built has that as its problem. What plan.memo knows is not run.
  TunedSetting Run(const std::vector<std::string>& values, const Progress& progress) const;

  /// Runs some of the trials of Run() into a `study.db`. Errors: UserError, SettingError; RunError.
  void RunTrials(const std::vector<std::string>& values, const WorkRange& trials,
                 const std::filesystem::path& database) const;

 private:
  Study StudyWith(const std::vector<std::string>& values) const;
  StudyOptions Options(const Progress& progress) const;
  TunedSetting Measure(const std::vector<std::string>& values, const Progress& progress) const;
  void Score(const StudyResult& result, TunedSetting& setting) const;
  void ScoreBlocks(const StudyResult& result, TunedSetting& setting) const;

  const TunePlan& plan_;
  std::vector<std::size_t> metrics_;
  const TuneSplit& split_;
  int seeds_;
  std::vector<CountedTicks> left_out_;          // per repetition: the other part
  std::vector<std::vector<TickRange>> blocks_;  // of this part
  int jobs_;
  ScenarioSource source_;
  Study study_;
};

/// Runs some trials of one setting into a `study.db`, on one thread, in another process than its
/// search. `about` is the text that Elsewhere::Begin() got there. Errors: UserError, SettingError;
/// RunError.
void RunTrialsOfSetting(const TunePlan& plan, const std::vector<std::string>& about,
                        const WorkRange& trials, const std::filesystem::path& database);

/// The scores of a plan: the minimised one, those of the constraints, delay, jitter and tracking.
std::vector<std::size_t> TuneMetrics(const TunePlan& plan);

}  // namespace gauntlet::sim
