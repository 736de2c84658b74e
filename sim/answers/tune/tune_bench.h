#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/answers/tune/tune.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {

/// Runs one controller of a scenario with other values, always on the same seeds.
class TuneBench {
 public:
  using Progress = std::function<bool(double done, int all)>;

  /// From seed `first_seed` on. `metrics` are the scores of every TunedSetting, those of
  /// the plan's constraints among them.
  /// Errors: UserError, SettingError for a scenario that cannot be built.
  TuneBench(const TunePlan& plan, std::vector<std::size_t> metrics, int first_seed, int seeds,
            int jobs);

  /// The controller with these values of plan.free; as the scenario has it if there are none.
  /// Errors: UserError if it cannot be read.
  NamedController ControllerWith(const std::vector<std::string>& values) const;

  /// One that cannot be built has that as its problem.
  TunedSetting Run(const std::vector<std::string>& values, const Progress& progress) const;

 private:
  void Score(const StudyResult& result, TunedSetting& setting) const;

  const TunePlan& plan_;
  std::vector<std::size_t> metrics_;
  int seeds_;
  int jobs_;
  ScenarioSource source_;
  Study study_;
};

/// The scores of a plan: the minimised one, those of the constraints, delay, jitter and tracking.
std::vector<std::size_t> TuneMetrics(const TunePlan& plan);

}  // namespace gauntlet::sim
