#include "sim/answers/sweep/cell_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/stop.h"
#include "sim/base/threads.h"
#include "sim/study/study_identity.h"

namespace gauntlet::sim {
namespace {

/// Cells that are run together: enough to share a glove and, without a hand, its guard; few enough
/// for their results.
constexpr std::int64_t kBlockCells = 2500;

/// One cell, read from its settings.
struct ReadCell {
  Scenario scenario;
  std::vector<std::string> settings;  // hashes, per controller
  std::string problem;                // why there is nothing else; empty: none
};

/// Does a part of what a cell needs to be built, if it still can be.
template <class Part>
void Try(ReadCell& cell, Part part) {
  if (!cell.problem.empty()) return;
  try {
    part();
  } catch (const UserError& error) {
    cell.problem = error.what();
  } catch (const controller::SettingError& error) {
    cell.problem = error.what();
  }
}

/// Builds the controllers of a cell for the study, to find errors, and hashes their settings.
void Check(const Study& study, ReadCell& cell) {
  for (const NamedController& named : cell.scenario.controllers) {
    CheckController(study, named);
    cell.settings.push_back(HashOfSettings(named));
  }
}

/// Adds the controllers of a cell to the block's study. Gives their places there.
std::vector<std::size_t> AddControllers(const ReadCell& cell, CellBlock& block) {
  std::vector<std::size_t> places;
  for (std::size_t c = 0; c < cell.settings.size(); ++c) {
    const auto known = std::ranges::find(block.settings, cell.settings[c]);
    places.push_back(static_cast<std::size_t>(known - block.settings.begin()));
    if (known != block.settings.end()) continue;
    block.settings.push_back(cell.settings[c]);
    block.study->scenario.controllers.push_back(cell.scenario.controllers[c]);
  }
  return places;
}

}  // namespace

Study PrepareShared(Scenario scenario) {
  scenario.controllers.clear();
  scenario.baseline.clear();
  return PrepareStudy(std::move(scenario));
}

std::string HashOfShared(const SweepPlan& plan, const Study& study) {
  Hash hash;
  hash.Add(HashOfStudy(study));
  hash.Add(plan.file.physics ? "physics" : "filters");
  for (const std::size_t metric : plan.metrics) {
    hash.Add(fmt::format(" {}", Metrics()[metric].key));
  }
  return hash.Text();
}

CellBlocks::CellBlocks(const SweepPlan& plan)
    : plan_(plan), text_(ParseScenarioText(plan.scenario.file, plan.scenario.text)) {}

Scenario CellBlocks::BaseScenario() const { return ScenarioWith({}); }

Scenario CellBlocks::ScenarioWith(const std::vector<std::string>& of_cell) const {
  std::vector<std::string> overrides = plan_.scenario.overrides;
  overrides.insert(overrides.end(), of_cell.begin(), of_cell.end());
  Scenario scenario = ParseScenario(text_, overrides);
  KeepControllers(plan_.file.controllers, scenario);
  return scenario;
}

std::vector<std::string> CellBlocks::SharedValues(std::int64_t cell) const {
  std::vector<std::string> shared;
  const std::vector<std::string> values = plan_.ValuesOf(cell);
  for (std::size_t a = 0; a < values.size(); ++a) {
    if (!plan_.file.axes[a].of_controller()) shared.push_back(values[a]);
  }
  return shared;
}

CellRange CellBlocks::BlockFrom(const CellRange& cells) const {
  const std::vector<std::string> shared = SharedValues(cells.first);
  std::int64_t end = cells.first + 1;
  while (end < cells.end && end - cells.first < kBlockCells && SharedValues(end) == shared) {
    ++end;
  }
  return {cells.first, end};
}

const CellBlocks::SharedStudy& CellBlocks::SharedOf(std::int64_t cell, const Scenario& scenario) {
  std::vector<std::string> values = SharedValues(cell);
  if (shared_ && shared_->values == values) return *shared_;
  shared_.reset();
  Study study = PrepareShared(scenario);
  std::string hash = HashOfShared(plan_, study);
  return shared_.emplace(SharedStudy{std::move(values), std::move(study), std::move(hash)});
}

CellBlock CellBlocks::Build(const CellRange& cells, int jobs) {
  CellBlock block;
  const std::vector<std::int64_t> numbers = cells.Numbers();
  std::vector<ReadCell> read(numbers.size());
  const auto for_each = [&](const std::function<void(std::size_t)>& part) {
    ForEachOnThreads(static_cast<std::size_t>(std::max(1, jobs)), read.size(),
                     [&](std::size_t i) { Try(read[i], [&] { part(i); }); });
  };
  for_each([&](std::size_t i) {
    ThrowIfStopped();
    read[i].scenario = ScenarioWith(plan_.OverridesOf(numbers[i]));
  });
  for (std::size_t i = 0; i < read.size() && !block.study; ++i) {
    Try(read[i], [&] {
      const SharedStudy& shared = SharedOf(numbers[i], read[i].scenario);
      block.study = shared.study;
      block.study_hash = shared.hash;
    });
  }
  for_each([&](std::size_t i) { Check(*block.study, read[i]); });
  for (std::size_t i = 0; i < read.size(); ++i) {
    CellBlock::Cell& cell = block.cells.emplace_back();
    cell.number = numbers[i];
    cell.problem = std::move(read[i].problem);
    if (cell.problem.empty()) cell.controllers = AddControllers(read[i], block);
  }
  return block;
}

}  // namespace gauntlet::sim
