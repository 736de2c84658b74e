#include "sim/sweep/sweep_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/stop.h"
#include "sim/base/threads.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/study/study_identity.h"
#include "sim/sweep/early_stop.h"

namespace gauntlet::sim {
namespace {

/// Cells that are run together: enough to share a glove and, without a hand, its guard; few enough
/// for their results.
constexpr std::int64_t kBlockCells = 2500;

std::vector<std::string> OverridesOf(const SweepPlan& plan, std::int64_t cell) {
  std::vector<std::string> overrides = plan.scenario.overrides;
  for (std::string& override : plan.OverridesOf(cell)) overrides.push_back(std::move(override));
  return overrides;
}

/// Of what the trials of a study share, and of what a sweep keeps of them: so they are not mistaken
/// for a comparison's, which keep more.
std::string HashOfShared(const SweepPlan& plan, const Study& study) {
  Hash hash;
  hash.Add(HashOfStudy(study));
  hash.Add(plan.file.physics ? "physics" : "filters");
  for (const std::size_t metric : plan.metrics) {
    hash.Add(fmt::format(" {}", Metrics()[metric].key));
  }
  return hash.Text();
}

/// The controllers of a block of cells as one study, each once however many cells have it.
struct Block {
  CellRange cells;
  std::optional<Study> study;  // none: it could not be built
  std::string study_hash;
  std::vector<std::string> settings;  // hashes, per controller of the study
  struct Cell {
    std::int64_t number = 0;
    std::vector<std::size_t> controllers;  // places in the study
    std::string problem;
  };
  std::vector<Cell> built;
};

/// What is read of one cell.
struct ReadCell {
  Scenario scenario;
  std::vector<std::string> settings;  // hashes, per controller
  std::string problem;                // why there is nothing else; empty: none
};

/// Adds the controllers of a cell to the block's study. Gives their places there.
std::vector<std::size_t> AddControllers(const ReadCell& cell, Block& block) {
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

/// A study without controllers, of all cells that have these values of the axes that controllers
/// share.
struct SharedStudy {
  std::vector<std::string> values;
  Study study;
  std::string hash;
};

/// Trials of one block in the database of the sweep.
class BlockStore final : public TrialStore {
 public:
  BlockStore(const Block& block, SweepDatabase& database) : block_(block), database_(database) {}

  TrialKey KeyOf(int seed, std::size_t controller) const {
    return {.study = block_.study_hash,
            .controller = block_.study->scenario.controllers[controller].name,
            .settings = block_.settings[controller],
            .seed = seed};
  }
  bool Has(int seed, std::size_t controller) override { return Take(seed, controller).has_value(); }
  std::optional<TrialOutcome> Take(int seed, std::size_t controller) override {
    return std::move(database_.Read(KeyOf(seed, controller)).front());
  }
  void Keep(int seed, std::size_t controller, const TrialOutcome& outcome) override {
    database_.Keep(KeyOf(seed, controller), outcome);
  }

 private:
  const Block& block_;
  SweepDatabase& database_;
};

class Sweep {
 public:
  Sweep(const SweepPlan& plan, SweepDatabase& database, const SweepOptions& options)
      : plan_(plan),
        text_(ParseScenarioText(plan.scenario.file, plan.scenario.text)),
        database_(database),
        options_(options) {
    Scenario scenario = ParseScenario(text_, plan.scenario.overrides);
    KeepControllers(plan.file.controllers, scenario);
    first_seed_ = scenario.seed;
    const bool twins = scenario.score.noise_free_twin && !IsWithoutNoise(scenario.glove) &&
                       std::ranges::any_of(plan.metrics, NeedsNoiseFreeTwin);
    per_trial_ = twins ? 2.0 : 1.0;
    controllers_ = std::ssize(scenario.controllers);
    all_ = per_trial_ * plan.file.seeds *
           static_cast<double>(controllers_ * (options.cells.end - options.cells.first));
  }

  void Run() {
    const std::vector<int> looks =
        plan_.early_stop ? LooksOf(plan_.file.seeds) : std::vector<int>();
    for (const int seeds : looks) {
      RunSeeds(seeds);
      StopWhatCannotWin(looks.size());
    }
    RunSeeds(plan_.file.seeds);
    ForgetSeedsBehindStops();
    database_.Flush();
  }

 private:
  static std::vector<std::int64_t> Numbers(const CellRange& cells) {
    std::vector<std::int64_t> numbers;
    for (std::int64_t cell = cells.first; cell < cells.end; ++cell) numbers.push_back(cell);
    return numbers;
  }

  /// The first so many seeds of all that is not stopped.
  void RunSeeds(int seeds) {
    const double before = std::exchange(seeds_, seeds);
    for (std::int64_t first = options_.cells.first; first < options_.cells.end;) {
      ThrowIfStopped();
      const CellRange cells = BlockFrom(first);
      const std::vector<std::int64_t> numbers = Numbers(cells);
      if (!std::ranges::all_of(numbers, [this](auto cell) { return IsKnown(cell); })) {
        RunBlock(cells);
      }
      for (const std::int64_t cell : numbers) {
        done_ +=
            per_trial_ * (seeds - before) * static_cast<double>(controllers_ - StoppedIn(cell));
      }
      Progress(0.0);
      first = cells.end;
    }
  }

  std::int64_t StoppedIn(std::int64_t cell) const {
    return std::distance(stopped_.lower_bound({cell, ""}), stopped_.lower_bound({cell + 1, ""}));
  }
  bool IsStopped(std::int64_t cell, const std::string& controller) const {
    return stopped_.contains({cell, controller});
  }

  void StopWhatCannotWin(std::size_t looks) {
    std::vector<CellResult> alive;
    ForEachCell(plan_, database_, options_.cells, [&](CellResult result) {
      if (result.controller.empty() || IsStopped(result.number, result.controller)) return;
      KeepSeeds(plan_, static_cast<std::size_t>(seeds_), result);
      alive.push_back(std::move(result));
    });
    if (candidates_ == 0) candidates_ = alive.size();
    const std::vector<bool> cannot = CannotWin(plan_, alive, candidates_, looks);
    for (std::size_t i = 0; i < alive.size(); ++i) {
      if (!cannot[i]) continue;
      stopped_[{alive[i].number, alive[i].controller}] = seeds_;
      all_ -= per_trial_ * (plan_.file.seeds - seeds_);
    }
  }

  /// Another schedule, a shard or a run with all seeds may have brought more than the test gives.
  void ForgetSeedsBehindStops() {
    for (const auto& [candidate, seeds] : stopped_) {
      for (SweepCellRecord& record : database_.CellAt(candidate.first)) {
        if (record.controller != candidate.second || std::ssize(record.motions) <= seeds) continue;
        record.motions.resize(static_cast<std::size_t>(seeds));
        database_.AddCell(record, ValuesByKey(candidate.first));
      }
    }
  }

  bool Progress(double more) {
    return !options_.progress || options_.progress(std::min(done_ + more, all_), all_);
  }

  /// The values of axes that controllers share.
  std::vector<std::string> SharedValues(std::int64_t cell) const {
    std::vector<std::string> shared;
    const std::vector<std::string> values = plan_.ValuesOf(cell);
    for (std::size_t a = 0; a < values.size(); ++a) {
      if (!plan_.file.axes[a].of_controller()) shared.push_back(values[a]);
    }
    return shared;
  }

  CellRange BlockFrom(std::int64_t first) const {
    const std::vector<std::string> shared = SharedValues(first);
    std::int64_t end = first + 1;
    while (end < options_.cells.end && end - first < kBlockCells && SharedValues(end) == shared) {
      ++end;
    }
    return {first, end};
  }

  /// Whether the file holds the cell and all its trials.
  bool IsKnown(std::int64_t cell) {
    const std::vector<SweepCellRecord> records = database_.CellAt(cell);
    return !records.empty() && std::ranges::all_of(records, [&](const SweepCellRecord& record) {
      if (!record.problem.empty() || IsStopped(cell, record.controller)) return true;
      if (std::ssize(record.motions) < seeds_) return false;
      const auto trials =
          database_.Read({record.study, record.controller, record.settings, first_seed_}, seeds_);
      return std::ranges::all_of(trials, [](const auto& trial) { return trial.has_value(); });
    });
  }

  /// What the cells of a block share. Blocks that follow each other often share the same, down to
  /// the glove's signal.
  const SharedStudy& SharedOf(std::int64_t cell, const Scenario& scenario) {
    std::vector<std::string> values = SharedValues(cell);
    if (shared_ && shared_->values == values) return *shared_;
    shared_.reset();
    Study study = PrepareShared(scenario);
    std::string hash = HashOfShared(plan_, study);
    return shared_.emplace(SharedStudy{std::move(values), std::move(study), std::move(hash)});
  }

  /// Does a part of what a cell needs to be built, if it still can be.
  template <class Part>
  static void Try(ReadCell& cell, Part part) {
    if (!cell.problem.empty()) return;
    try {
      part();
    } catch (const UserError& error) {
      cell.problem = error.what();
    } catch (const controller::SettingError& error) {
      cell.problem = error.what();
    }
  }

  void Read(std::int64_t number, ReadCell& cell) const {
    ThrowIfStopped();
    cell.scenario = ParseScenario(text_, OverridesOf(plan_, number));
    KeepControllers(plan_.file.controllers, cell.scenario);
    std::erase_if(cell.scenario.controllers,
                  [&](const NamedController& named) { return IsStopped(number, named.name); });
  }

  /// Whether its controllers can be built for the study, and what distinguishes their settings.
  static void Check(const Study& study, ReadCell& cell) {
    for (const NamedController& named : cell.scenario.controllers) {
      controller::WithinSetting("controllers." + named.name, [&] {
        return controller::Controller(RobotOf(study.scenario, *study.hand, named.config));
      });
      cell.settings.push_back(HashOfSettings(named));
    }
  }

  Block Build(const CellRange& cells) {
    Block block{.cells = cells, .study = {}, .study_hash = {}, .settings = {}, .built = {}};
    const std::vector<std::int64_t> numbers = Numbers(cells);
    std::vector<ReadCell> read(numbers.size());
    const auto for_each = [&](const std::function<void(std::size_t)>& part) {
      ForEachOnThreads(static_cast<std::size_t>(std::max(1, options_.jobs)), read.size(),
                       [&](std::size_t i) { Try(read[i], [&] { part(i); }); });
    };
    for_each([&](std::size_t i) { Read(numbers[i], read[i]); });
    for (std::size_t i = 0; i < read.size() && !block.study; ++i) {
      Try(read[i], [&] {
        const SharedStudy& shared = SharedOf(numbers[i], read[i].scenario);
        block.study = shared.study;
        block.study_hash = shared.hash;
      });
    }
    for_each([&](std::size_t i) { Check(*block.study, read[i]); });
    for (std::size_t i = 0; i < read.size(); ++i) {
      Block::Cell& cell = block.built.emplace_back();
      cell.number = numbers[i];
      cell.problem = std::move(read[i].problem);
      if (cell.problem.empty()) cell.controllers = AddControllers(read[i], block);
    }
    return block;
  }

  StudyOptions OptionsFor(BlockStore& store) const {
    return {.seeds = seeds_,
            .jobs = options_.jobs,
            .progress = {},
            .remark = options_.remark,
            .keep_first_traces = false,
            .keep_rows = false,
            .physics = plan_.file.physics,
            .store = &store,
            .scores = plan_.metrics};
  }

  /// Times the first trials that are to be run, as many as run together or enough to know.
  void Forecast(const Block& block, BlockStore& store) {
    if (forecast_done_ || !options_.forecast) return;
    StudyOptions options = OptionsFor(store);
    options.jobs = 1;
    constexpr std::size_t kEnough = 32;
    const std::size_t most = std::min(ControllersTogether(options, block.settings.size()), kEnough);
    for (int i = 0; i < seeds_ && !forecast_done_; ++i) {
      Block some = block;
      some.study->scenario.controllers.clear();
      some.settings.clear();
      for (std::size_t c = 0; c < block.settings.size() && some.settings.size() < most; ++c) {
        if (store.Has(first_seed_ + i, c)) continue;
        some.study->scenario.controllers.push_back(block.study->scenario.controllers[c]);
        some.settings.push_back(block.settings[c]);
      }
      if (some.settings.empty()) continue;
      forecast_done_ = true;
      BlockStore of_some(some, database_);
      options.store = &of_some;
      options.seeds = i + 1;
      options.progress = [this](double, int) { return Progress(0.0); };
      const double known = per_trial_ * static_cast<double>(database_.TrialCount());
      const double trials = per_trial_ * static_cast<double>(some.settings.size());
      const auto start = std::chrono::steady_clock::now();
      RunStudy(*some.study, options);
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      const double left = std::max(0.0, all_ - known - trials);
      options_.forecast({.trials = left, .seconds = left / trials * took.count() / options_.jobs});
      database_.Flush();
    }
  }

  void RunBlock(const CellRange& cells) {
    Block block = Build(cells);
    std::vector<int> motions;
    if (!block.settings.empty()) {
      BlockStore store(block, database_);
      database_.AddStudy(block.study_hash, SharedSettings(*block.study));
      Forecast(block, store);
      StudyOptions options = OptionsFor(store);
      const double in_block = per_trial_ * seeds_ * static_cast<double>(block.settings.size());
      options.progress = [this, in_block](double done, int total) {
        return Progress(in_block * done / std::max(total, 1));
      };
      for (const SeedOutcome& seed : RunStudy(*block.study, options).seeds) {
        motions.push_back(seed.motion);
      }
    }
    for (const Block::Cell& cell : block.built) AddCell(block, cell, motions);
    database_.Flush();
  }

  std::vector<std::pair<std::string, std::string>> ValuesByKey(std::int64_t cell) const {
    std::vector<std::pair<std::string, std::string>> values;
    const std::vector<std::string> texts = plan_.ValuesOf(cell);
    for (std::size_t a = 0; a < texts.size(); ++a) {
      values.emplace_back(plan_.file.axes[a].key, texts[a]);
    }
    return values;
  }

  void AddCell(const Block& block, const Block::Cell& cell, const std::vector<int>& motions) {
    const auto values = ValuesByKey(cell.number);
    SweepCellRecord record{.number = cell.number,
                           .controller = {},
                           .study = {},
                           .settings = {},
                           .motions = {},
                           .problem = cell.problem};
    if (!cell.problem.empty()) return database_.AddCell(record, values);
    for (const std::size_t c : cell.controllers) {
      record.controller = block.study->scenario.controllers[c].name;
      record.study = block.study_hash;
      record.settings = block.settings[c];
      record.motions = motions;
      database_.AddCell(record, values);
    }
  }

  const SweepPlan& plan_;
  const ScenarioText text_;
  SweepDatabase& database_;
  const SweepOptions& options_;
  int first_seed_ = 0;
  double per_trial_ = 1.0;        // runs: with a twin two
  std::int64_t controllers_ = 1;  // of each cell
  int seeds_ = 0;                 // that are run now, from the first on
  std::size_t candidates_ = 0;    // for the best, at the first look
  /// Cell and controller of what gets no more seeds, and how many it has.
  std::map<std::pair<std::int64_t, std::string>, int> stopped_;
  double all_ = 0.0;
  double done_ = 0.0;  // of blocks that are finished
  bool forecast_done_ = false;
  std::optional<SharedStudy> shared_;  // of the block before
};

}  // namespace

Study PrepareShared(Scenario scenario) {
  scenario.controllers.clear();
  scenario.baseline.clear();
  return PrepareStudy(std::move(scenario));
}

CellRange ShardOf(const SweepPlan& plan, int number, int count) {
  const std::int64_t cells = plan.cell_count();
  return {.first = cells * (number - 1) / count, .end = cells * number / count};
}

std::string HashOfSweep(const SweepPlan& plan) {
  Scenario scenario = ParseScenario(plan.scenario);
  KeepControllers(plan.file.controllers, scenario);
  Hash hash;
  for (const NamedController& named : scenario.controllers) hash.Add(HashOfSettings(named));
  hash.Add(HashOfShared(plan, PrepareShared(std::move(scenario))));
  hash.Add(fmt::format("{} {} {}\n", static_cast<int>(plan.file.design), plan.file.cells,
                       plan.file.design_seed));
  for (const SweepAxis& axis : plan.file.axes) {
    hash.Add(fmt::format("{}\n{} {} {} {} {}\n", axis.key, axis.low, axis.high, axis.count,
                         static_cast<int>(axis.spacing), axis.whole));
    for (const std::string& value : axis.values) {
      std::error_code ignored;
      const bool is_file = std::filesystem::is_regular_file(value, ignored);
      hash.Add((is_file ? HashOfFile(value) : value) + "\n");
    }
  }
  for (const std::vector<std::string>& values : plan.listed) {
    hash.Add(fmt::format("{}\n", fmt::join(values, " ")));
  }
  return hash.Text();
}

void RunSweep(const SweepPlan& plan, SweepDatabase& database, const SweepOptions& options) {
  Sweep(plan, database, options).Run();
}

}  // namespace gauntlet::sim
