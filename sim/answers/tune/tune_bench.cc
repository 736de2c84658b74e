#include "sim/answers/tune/tune_bench.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "controller/assert.h"
#include "sim/answers/compare/recording_blocks.h"
#include "sim/answers/sweep/cell_blocks.h"
#include "sim/answers/tune/tune_memo.h"
#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/score/statistics/blocks.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/trial_table/awaited_trials.h"
#include "sim/study/trial_table/study_database.h"

namespace gauntlet::sim {
namespace {

/// All that another process has to know of a setting, but for the plan.
struct AboutSetting {
  int first_seed = 1;
  int seeds = 1;
  std::vector<std::size_t> metrics = {};
  std::vector<std::string> values = {};
};

std::vector<std::string> ToTexts(const AboutSetting& about) {
  std::vector<std::string> texts = {std::to_string(about.first_seed), std::to_string(about.seeds),
                                    std::to_string(about.metrics.size())};
  for (const std::size_t metric : about.metrics) texts.emplace_back(Metrics()[metric].key);
  texts.insert(texts.end(), about.values.begin(), about.values.end());
  return texts;
}

AboutSetting FromTexts(const std::vector<std::string>& texts) {
  AboutSetting about{.first_seed = std::stoi(texts.at(0)), .seeds = std::stoi(texts.at(1))};
  const auto values = texts.begin() + 3 + std::stol(texts.at(2));
  for (auto key = texts.begin() + 3; key < values; ++key) {
    about.metrics.push_back(MetricIndex(*key));
  }
  about.values = {values, texts.end()};
  return about;
}

}  // namespace

TuneBench::TuneBench(const TunePlan& plan, std::vector<std::size_t> metrics, const TuneSplit& split,
                     TunePart part, int jobs)
    : plan_(plan),
      metrics_(std::move(metrics)),
      split_(split),
      seeds_(part == TunePart::kFitted ? split.fitted : split.held_out),
      jobs_(jobs),
      source_(plan.scenario) {
  for (const Constraint& constraint : plan.constraints) {
    GAUNTLET_ASSERT(std::ranges::find(metrics_, constraint.metric) != metrics_.end());
  }
  const int first_seed = split.first_seed + (part == TunePart::kFitted ? 0 : split.fitted);
  source_.overrides.push_back(fmt::format("seed={}", first_seed));
  study_ = PrepareShared(ParseScenario(source_));
  KeepGloves(seeds_, study_);
  for (const DividedRecording& recording : split.divided) {
    const bool is_fitted = part == TunePart::kFitted;
    blocks_.push_back(is_fitted ? recording.fitted : recording.held_out);
    left_out_.push_back(is_fitted ? recording.held_out : recording.fitted);
  }
}

FilterInput TuneBench::Input() const { return InputOf(study_.scenario, ControllerWith({}).config); }

NamedController TuneBench::ControllerWith(const std::vector<std::string>& values) const {
  ScenarioSource source = source_;
  for (std::size_t a = 0; a < values.size(); ++a) {
    source.overrides.push_back(plan_.free[a].key + "=" + values[a]);
  }
  Scenario scenario = ParseScenario(source);
  KeepControllers({plan_.controller}, scenario);
  return scenario.controllers.front();
}

TunedSetting TuneBench::Run(const std::vector<std::string>& values,
                            const Progress& progress) const {
  if (plan_.memo == nullptr) return Measure(values, progress);
  const std::string question = fmt::format(
      "{}\n{}\n{}\n{} {} {}", fmt::join(source_.overrides, "\n"), fmt::join(values, " "),
      fmt::join(metrics_, " "), seeds_, plan_.physics, fmt::join(TextsOf(plan_.constraints), " "));
  if (auto known = plan_.memo->Find(question)) return *std::move(known);
  TunedSetting setting = Measure(values, progress);
  plan_.memo->Keep(question, setting);
  return setting;
}

Study TuneBench::StudyWith(const std::vector<std::string>& values) const {
  Study study = study_;
  study.scenario.controllers = {ControllerWith(values)};
  return study;
}

StudyOptions TuneBench::Options(const Progress& progress) const {
  return {.seeds = seeds_,
          .jobs = jobs_,
          .progress = progress,
          .keep_first_traces = false,
          .keep_rows = false,
          .physics = plan_.physics,
          .scores = metrics_,
          .left_out = left_out_,
          .blocks = blocks_};
}

TunedSetting TuneBench::Measure(const std::vector<std::string>& values,
                                const Progress& progress) const {
  TunedSetting setting;
  setting.values = values;
  setting.scores.resize(metrics_.size());
  Study study;
  try {
    study = StudyWith(values);
    CheckController(study, study.scenario.controllers.front());
  } catch (const UserError& error) {
    setting.problem = error.what();
    return setting;
  } catch (const controller::SettingError& error) {
    setting.problem = error.what();
    return setting;
  }
  StudyOptions options = Options(progress);
  std::optional<AwaitedTrials> awaited;
  if (plan_.elsewhere != nullptr && blocks_.empty()) {
    const std::vector<std::string> about = ToTexts({.first_seed = study_.scenario.seed,
                                                    .seeds = seeds_,
                                                    .metrics = metrics_,
                                                    .values = values});
    options.store = &awaited.emplace(study, seeds_, *plan_.elsewhere, nullptr, about);
  }
  Score(RunStudy(study, options), setting);
  return setting;
}

void TuneBench::RunTrials(const std::vector<std::string>& values, const WorkRange& trials,
                          const std::filesystem::path& database) const {
  const Study study = StudyWith(values);
  StudyDatabase store(database, study, {.seeds = seeds_});
  StudyOptions options = Options([](double, int) { return !StopAsked(); });
  options.store = &store;
  RunSomeTrials(study, options, trials);
  if (const auto not_kept = store.Finish()) throw RunError(*not_kept);
}

void TuneBench::ScoreBlocks(const StudyResult& result, TunedSetting& setting) const {
  for (std::size_t m = 0; m < metrics_.size(); ++m) {
    // Values of the blocks of each recording, as means over its seeds.
    std::map<int, std::vector<std::vector<double>>> recordings;
    std::vector<double> whole;
    bool has_blocks = HasBlockValues(Metrics()[metrics_[m]]);
    for (std::size_t i = 0; i < result.seeds.size(); ++i) {
      const TrialOutcome& outcome = result.seeds[i].controllers.front();
      const DividedRecording& recording = split_.divided[i % split_.divided.size()];
      whole.push_back(outcome.scores.summary[metrics_[m]]);
      std::vector<double> without;
      for (const Scores& scores : outcome.without) without.push_back(scores.summary[metrics_[m]]);
      const auto values = BlockValues(whole.back(), without, recording.widening);
      has_blocks = has_blocks && !values.empty() &&
                   std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
      recordings[recording.number].push_back(values);
    }
    std::vector<double> replicates;
    for (const auto& [number, seeds] : recordings) {
      for (std::size_t block = 0; has_blocks && block < seeds.front().size(); ++block) {
        std::vector<double> of_block;
        for (const std::vector<double>& values : seeds) of_block.push_back(values[block]);
        replicates.push_back(EstimateMean(of_block).mean);
      }
    }
    if (!has_blocks) replicates = {EstimateMean(whole).mean};
    setting.scores[m] = EstimateMean(replicates).IntervalAt();
    if (m == 0) {
      setting.motions.assign(replicates.size(), 0);
      setting.minimised = std::move(replicates);
    }
  }
}

void TuneBench::Score(const StudyResult& result, TunedSetting& setting) const {
  std::vector<std::vector<double>> values(metrics_.size());
  for (const SeedOutcome& seed : result.seeds) {
    const TrialOutcome& outcome = seed.controllers.front();
    setting.motions.push_back(seed.motion);
    if (!outcome.health.ok && setting.problem.empty()) {
      setting.problem = fmt::format("{} (seed {})", outcome.health.problem, seed.seed);
    }
    for (std::size_t m = 0; m < metrics_.size(); ++m) {
      values[m].push_back(outcome.scores.summary[metrics_[m]]);
    }
  }
  if (!split_.divided.empty()) {
    ScoreBlocks(result, setting);
  } else {
    for (std::size_t m = 0; m < metrics_.size(); ++m) {
      setting.scores[m] = EstimateMean(values[m], setting.motions).IntervalAt();
    }
    setting.minimised = values.front();
  }
  for (const Constraint& constraint : plan_.constraints) {
    setting.met = std::max(
        setting.met, IsMet(constraint, setting.scores[PlaceOfMetric(metrics_, constraint.metric)]));
  }
}

void RunTrialsOfSetting(const TunePlan& plan, const std::vector<std::string>& about,
                        const WorkRange& trials, const std::filesystem::path& database) {
  const AboutSetting setting = FromTexts(about);
  const TuneSplit split{.first_seed = setting.first_seed, .fitted = setting.seeds};
  TuneBench(plan, setting.metrics, split, TunePart::kFitted, 1)
      .RunTrials(setting.values, trials, database);
}

std::vector<std::size_t> TuneMetrics(const TunePlan& plan) {
  std::vector<std::size_t> metrics = {plan.minimise};
  const auto add = [&metrics](std::size_t metric) {
    if (std::ranges::find(metrics, metric) == metrics.end()) metrics.push_back(metric);
  };
  for (const Constraint& constraint : plan.constraints) add(constraint.metric);
  for (const char* key : {"delay_ms", "jitter_rms_deg", "tracking_rmse_deg"}) add(MetricIndex(key));
  return metrics;
}

}  // namespace gauntlet::sim
