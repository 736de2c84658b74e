#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"
#include "sim/score/priority.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {

/// One setting that a sweep varies: a list of values, or a range.
struct SweepAxis {
  enum class Spacing { kLinear, kLog };

  std::string key;                  // as --set takes it: controllers.tuned.filter.q
  std::vector<std::string> values;  // YAML texts, as behind the = of --set; empty: a range
  double low = kNaN;
  double high = kNaN;
  int count = 0;  // of values of a range in a grid
  Spacing spacing = Spacing::kLinear;
  bool whole = false;  // rounded to whole numbers
  int digits = 6;      // significant, of values of a range

  bool is_range() const { return values.empty(); }
  /// True if it changes only a controller, and nothing that controllers share.
  bool of_controller() const { return key.starts_with("controllers."); }
  /// The value at a place in [0, 1], both ends included: of a list the item that this place is in,
  /// of a range with some significant digits, or the whole number of the range that is next to it.
  std::string ValueAt(double place) const;

  /// Significant digits that tell a hundred values of the range apart, three at least.
  int FewDigits() const;

  /// The sentence for a range of whole numbers that has none; empty if all is well.
  std::string WholeProblem() const;

  void Visit(controller::SettingsVisitor& visitor);
};

/// A study file as it is written: which cells there are, and what is asked of them. A cell is the
/// base scenario with one value for each axis.
struct SweepFile {
  enum class Design { kGrid, kRandom, kSobol };

  std::string name;  // the file's stem unless it says otherwise
  std::string question;
  std::string scenario;                  // path of the base scenario
  std::vector<std::string> set;          // --set for all cells
  std::vector<std::string> controllers;  // empty: all of the scenario
  int seeds = 8;        // the scenario's and those after it, the same for all cells
  bool physics = true;  // see StudyOptions
  Design design = Design::kGrid;
  int cells = 0;  // of a random or a Sobol design
  int design_seed = 1;
  std::vector<SweepAxis> axes;
  std::vector<std::string> scores;  // that are kept
  std::string best_by = "tracking_rmse_deg";
  std::vector<std::string> subject_to;

  void Visit(controller::SettingsVisitor& visitor);
};

/// A study file that has been read and checked, with its base scenario's text.
struct SweepPlan {
  SweepFile file;
  ScenarioSource scenario;           // with `set` as overrides
  std::vector<std::size_t> metrics;  // that are kept, in the order of Metrics()
  std::size_t best_by = 0;           // in Metrics()
  std::vector<Constraint> constraints;
  std::vector<std::string> axis_places;  // `file:line:column` of each axis
  /// The cells themselves, each with a value for each axis; empty: those of the file's design.
  std::vector<std::vector<std::string>> listed;

  std::int64_t cell_count() const;
  /// The value of each axis. Cells are numbered so that settings which controllers share vary
  /// slowest: neighbours have the same glove and hand.
  std::vector<std::string> ValuesOf(std::int64_t cell) const;
  /// Values of the axes as overrides, `key=value`.
  std::vector<std::string> OverridesOf(std::int64_t cell) const;
};

/// Options of the command line that replace keys of a study file.
struct SweepOverrides {
  std::optional<int> seeds;
  bool filter_only = false;
  std::vector<std::string> set;
};

/// Reads strictly. A relative path is one from the study file; so is a value of an axis that names
/// a file there. Errors: UserError with the place in the file for what is unknown, missing or empty
/// or contradictory; also for an axis of which no value can be built.
SweepPlan LoadSweepPlan(const std::filesystem::path& file, const SweepOverrides& overrides = {});
/// Plan from the text of a file. Errors: as LoadSweepPlan().
SweepPlan ParseSweepPlan(const std::filesystem::path& file, std::string_view text,
                         const SweepOverrides& overrides = {});

/// Cells from `first` to before `end`.
struct CellRange {
  std::int64_t first = 0;
  std::int64_t end = 0;

  std::vector<std::int64_t> Numbers() const;
};

/// Part `number` (from 1) of `count` parts of all cells, equal but for one cell.
CellRange ShardOf(const SweepPlan& plan, int number, int count);

}  // namespace gauntlet::sim
