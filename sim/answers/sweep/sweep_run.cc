#include "sim/answers/sweep/sweep_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>

#include "sim/answers/sweep/cell_blocks.h"
#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/stop.h"
#include "sim/study/study_identity.h"

namespace gauntlet::sim {
namespace {

/// Trials of one block in the database of the sweep.
class BlockStore final : public TrialStore {
 public:
  BlockStore(const CellBlock& block, SweepDatabase& database)
      : block_(block), database_(database) {}

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
  const CellBlock& block_;
  SweepDatabase& database_;
};

class Sweep {
 public:
  Sweep(const SweepPlan& plan, SweepDatabase& database, const SweepOptions& options)
      : plan_(plan),
        blocks_(plan),
        database_(database),
        options_(options),
        seeds_(plan.file.seeds) {
    const Scenario scenario = blocks_.BaseScenario();
    first_seed_ = scenario.seed;
    const bool twins = scenario.score.noise_free_twin && !IsWithoutNoise(scenario.glove) &&
                       AnyNeeds(plan.metrics, &Metric::needs_twin);
    per_trial_ = twins ? 2.0 : 1.0;
    controllers_ = std::ssize(scenario.controllers);
    all_ = per_trial_ * seeds_ *
           static_cast<double>(controllers_ * (options.cells.end - options.cells.first));
  }

  void Run() {
    if (options_.elsewhere != nullptr) AwaitPartsFrom(*options_.elsewhere);
    for (std::int64_t first = options_.cells.first; first < options_.cells.end;) {
      ThrowIfStopped();
      const CellRange cells = blocks_.BlockFrom({first, options_.cells.end});
      if (!AllKnown(cells)) RunBlock(cells);
      done_ += per_trial_ * seeds_ * static_cast<double>(controllers_ * (cells.end - cells.first));
      Progress(0.0);
      first = cells.end;
    }
    database_.Flush();
  }

 private:
  bool Progress(double more) {
    if (!options_.progress) return true;
    return options_.progress(std::min(std::max(done_ + more, done_elsewhere_), all_), all_);
  }

  bool AllKnown(const CellRange& cells) {
    return std::ranges::all_of(cells.Numbers(), [this](auto cell) { return IsKnown(cell); });
  }

  /// Waits for the cells that are computed elsewhere. What does not come is lacking still.
  void AwaitPartsFrom(Elsewhere& elsewhere) {
    constexpr std::chrono::milliseconds kPatience{50};
    std::vector<WorkRange> parts =
        Divide({options_.cells.first, options_.cells.end}, elsewhere.most_parts());
    std::erase_if(parts, [&](const WorkRange& part) { return AllKnown({part.first, part.end}); });
    elsewhere.Begin(parts, {});
    for (std::size_t left = parts.size(); left > 0;) {
      ThrowIfStopped();
      const std::optional<Elsewhere::Part> part = elsewhere.Next(kPatience);
      if (!part) continue;
      --left;
      if (part->database.empty()) continue;
      const CellRange cells = {parts.at(part->number).first, parts.at(part->number).end};
      database_.Collect(part->database);
      if (!AllKnown(cells)) throw RunError(kOtherBuild);
      done_elsewhere_ +=
          per_trial_ * seeds_ * static_cast<double>(controllers_ * (cells.end - cells.first));
      Progress(0.0);
    }
  }

  /// True if the file has the cell and all its trials.
  bool IsKnown(std::int64_t cell) {
    const std::vector<SweepCellRecord> records = database_.CellAt(cell);
    return !records.empty() && std::ranges::all_of(records, [&](const SweepCellRecord& record) {
      if (!record.problem.empty()) return true;
      if (std::ssize(record.motions) < seeds_) return false;
      const auto trials =
          database_.Read({record.study, record.controller, record.settings, first_seed_}, seeds_);
      return std::ranges::all_of(trials, [](const auto& trial) { return trial.has_value(); });
    });
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

  /// Times the first trial that is to be run.
  void Forecast(const CellBlock& block, BlockStore& store) {
    if (forecast_done_ || !options_.forecast) return;
    StudyOptions options = OptionsFor(store);
    options.jobs = 1;
    for (int i = 0; i < seeds_ && !forecast_done_; ++i) {
      CellBlock some = block;
      some.study->scenario.controllers.clear();
      some.settings.clear();
      for (std::size_t c = 0; c < block.settings.size() && some.settings.empty(); ++c) {
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
      const auto start = std::chrono::steady_clock::now();
      RunStudy(*some.study, options);
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      const double left = std::max(0.0, all_ - known - per_trial_);
      options_.forecast(
          {.trials = left, .seconds = left / per_trial_ * took.count() / options_.jobs});
      database_.Flush();
    }
  }

  void RunBlock(const CellRange& cells) {
    const CellBlock block = blocks_.Build(cells, options_.jobs);
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
    for (const CellBlock::Cell& cell : block.cells) AddCell(block, cell, motions);
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

  void AddCell(const CellBlock& block, const CellBlock::Cell& cell,
               const std::vector<int>& motions) {
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
  CellBlocks blocks_;
  SweepDatabase& database_;
  const SweepOptions& options_;
  const int seeds_;
  int first_seed_ = 0;
  double per_trial_ = 1.0;        // runs: with a twin two
  std::int64_t controllers_ = 1;  // of each cell
  double all_ = 0.0;
  double done_ = 0.0;  // of blocks that are finished
  double done_elsewhere_ = 0.0;
  bool forecast_done_ = false;
};

}  // namespace

std::string HashOfSweep(const SweepPlan& plan) {
  Scenario scenario = CellBlocks(plan).BaseScenario();
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
