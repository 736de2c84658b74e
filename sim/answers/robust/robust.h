#pragma once

#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/answers/sweep/sweep_result.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {

/// Something about wearer, glove, link and hand that is not known exactly: settings that grow and
/// shrink by one factor.
struct RobustParameter {
  std::string name;  // "friction"
  std::string help;  // what its settings are
};

/// Options of `gauntlet robust`.
struct RobustOptions {
  std::vector<std::string> controllers = {};  // of the scenario; empty: all
  int hands = 32;
  int seeds = 0;  // 0: 8, or one for each repetition
  double within_percent = 30.0;
  int design_seed = 1;  // of the hands
};

/// A sweep whose cells are hands. All have the same seeds and the same controllers, with every
/// setting as the scenario resolves it:
///
///     cell 0               the nominal hand
///     cells 1 + 2p, 2 + 2p parameter p low, and high: its factor 1 -+ within, the others 1
///     then `hands` cells   every parameter's factor uniform in [1 - within, 1 + within], each for
///                          itself
struct RobustPlan {
  SweepPlan sweep;
  std::vector<RobustParameter> parameters;
  std::vector<std::string> not_varied;       // names of those whose settings are all 0
  std::vector<std::vector<double>> factors;  // cell by cell, of the parameters
  int hands = 0;
  double within_percent = 0.0;

  static std::int64_t LowCell(std::size_t parameter) {
    return 1 + 2 * static_cast<std::int64_t>(parameter);
  }
  static std::int64_t HighCell(std::size_t parameter) { return LowCell(parameter) + 1; }
  std::int64_t FirstHand() const { return LowCell(parameters.size()); }
};

/// Errors: UserError, SettingError; among them fewer than two controllers.
RobustPlan MakeRobustPlan(const ScenarioSource& source, const RobustOptions& options);

/// One controller in one score, over the hands that were drawn.
struct RobustController {
  std::string name;
  Share best;       // hands on which no mean is better
  Share near_best;  // hands on which its mean is equivalent to the best one
};

/// Effect of one parameter on the difference between the two best controllers of the scenario's
/// hand.
struct TornadoBar {
  std::size_t parameter = 0;
  MeanInterval low;   // first - second, where the parameter is low; 95 %
  MeanInterval high;  // where it is high
  /// high - low, seed by seed. kEqual: below the smallest relevant one; kUndecided; else above.
  Comparison change;
  std::string problem;  // why one of the two cells has no scores
};

struct RobustScore {
  std::size_t metric = 0;                     // in Metrics()
  std::vector<RobustController> controllers;  // in the order of the scenario
  std::vector<std::size_t> two_best;          // on the scenario's hand; fewer: there are none
  std::vector<TornadoBar> bars;               // the largest change first
};

struct RobustResult {
  Summary nominal;                  // the verdict of a comparison on the nominal hand
  std::vector<RobustScore> scores;  // that have values there
  int not_built = 0;                // of the hands that were drawn
  int failed = 0;                   // controllers of these, of which a trial failed
  std::string first_problem;
};

/// From the cells in the database. All intervals of the tornado are simultaneous, 95 %
/// (Bonferroni); those of shares hold each by itself, for other draws of hands and the same seeds.
/// Errors: RunError if cells are missing, or the nominal hand has no scores.
RobustResult ConcludeRobust(const RobustPlan& plan, SweepDatabase& database);

}  // namespace gauntlet::sim
