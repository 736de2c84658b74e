#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/answers/sweep/sweep_plan.h"
#include "sim/study/study.h"

namespace gauntlet::sim {

/// The controllers of a range of cells as one study, each once however many cells have it.
struct CellBlock {
  std::optional<Study> study;  // none: it could not be built
  std::string study_hash;
  std::vector<std::string> settings;  // hashes, per controller of the study
  struct Cell {
    std::int64_t number = 0;
    std::vector<std::size_t> controllers;  // places in the study
    std::string problem;
  };
  std::vector<Cell> cells;
};

/// The study of a scenario without its controllers: glove, hand and all that controllers share.
/// Errors: UserError, SettingError.
Study PrepareShared(Scenario scenario);

/// Hash of what the trials of a study share, and of the scores that a sweep keeps. So its trials
/// are not mistaken for those of a comparison, which keep more.
std::string HashOfShared(const SweepPlan& plan, const Study& study);

/// Divides the cells of a sweep into blocks and builds these. Cells of a block differ in
/// controllers alone: they share glove and hand.
class CellBlocks {
 public:
  explicit CellBlocks(const SweepPlan& plan);

  /// The scenario of the sweep, without what a cell changes.
  Scenario BaseScenario() const;
  /// The longest block that begins with the first of these cells.
  CellRange BlockFrom(const CellRange& cells) const;
  /// Reads the cells on `jobs` threads. A cell that cannot be built has a problem.
  /// Errors: Cancelled.
  CellBlock Build(const CellRange& cells, int jobs);

 private:
  /// A study without controllers, of all cells that have these values of the axes that controllers
  /// share.
  struct SharedStudy {
    std::vector<std::string> values;
    Study study;
    std::string hash;
  };

  std::vector<std::string> SharedValues(std::int64_t cell) const;
  /// The study that the cells of a block share. Successive blocks often share the same, down to the
  /// signal of the glove.
  const SharedStudy& SharedOf(std::int64_t cell, const Scenario& scenario);
  Scenario ScenarioWith(const std::vector<std::string>& of_cell) const;

  const SweepPlan& plan_;
  const ScenarioText text_;
  std::optional<SharedStudy> shared_;  // of the block before
};

}  // namespace gauntlet::sim
