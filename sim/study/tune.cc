#include "sim/study/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/settings/yaml_writer.h"
#include "sim/study/optimise.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostVerdicts = 10;

/// The seeds of one study, and the settings that were run on them.
class Bench {
 public:
  Bench(const TunePlan& plan, const std::vector<std::size_t>& metrics, int first_seed, int seeds,
        int jobs)
      : plan_(plan), metrics_(metrics), seeds_(seeds), jobs_(jobs), source_(plan.scenario) {
    source_.overrides.push_back(fmt::format("seed={}", first_seed));
    study_ = PrepareShared(ParseScenario(source_));
  }

  /// The controller with these values; as the scenario has it if there are none.
  /// Errors: UserError, SettingError if it cannot be built.
  NamedController ControllerWith(const std::vector<std::string>& values) const {
    ScenarioSource source = source_;
    for (std::size_t a = 0; a < values.size(); ++a) {
      source.overrides.push_back(plan_.free[a].key + "=" + values[a]);
    }
    Scenario scenario = ParseScenario(source);
    KeepControllers({plan_.controller}, scenario);
    return scenario.controllers.front();
  }

  TunedSetting Run(const std::vector<std::string>& values,
                   const std::function<bool(double, int)>& progress) const {
    TunedSetting setting;
    setting.values = values;
    setting.scores.resize(metrics_.size());
    Study study = study_;
    try {
      study.scenario.controllers = {ControllerWith(values)};
      controller::WithinSetting("controllers." + plan_.controller, [&] {
        return controller::Controller(
            RobotOf(study.scenario, *study.hand, study.scenario.controllers.front().config));
      });
    } catch (const UserError& error) {
      setting.problem = error.what();
      return setting;
    } catch (const controller::SettingError& error) {
      setting.problem = error.what();
      return setting;
    }
    Score(RunStudy(study, {.seeds = seeds_,
                           .jobs = jobs_,
                           .progress = progress,
                           .keep_first_traces = false,
                           .keep_rows = false,
                           .physics = plan_.physics,
                           .store = nullptr,
                           .scores = metrics_}),
          setting);
    return setting;
  }

 private:
  void Score(const StudyResult& result, TunedSetting& setting) const {
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
    for (std::size_t m = 0; m < metrics_.size(); ++m) {
      setting.scores[m] = EstimateMean(values[m], setting.motions).IntervalAt();
    }
    setting.minimised = values.front();
    for (const Constraint& constraint : plan_.constraints) {
      const auto place = std::ranges::find(metrics_, constraint.metric) - metrics_.begin();
      setting.met = std::max(setting.met, IsMet(constraint, setting.scores[place]));
    }
  }

  const TunePlan& plan_;
  const std::vector<std::size_t>& metrics_;
  int seeds_;
  int jobs_;
  ScenarioSource source_;
  Study study_;
};

std::vector<std::size_t> MetricsOf(const TunePlan& plan) {
  std::vector<std::size_t> metrics = {plan.minimise};
  const auto add = [&metrics](std::size_t metric) {
    if (std::ranges::find(metrics, metric) == metrics.end()) metrics.push_back(metric);
  };
  for (const Constraint& constraint : plan.constraints) add(constraint.metric);
  add(MetricIndex("delay_ms"));
  add(MetricIndex("jitter_rms_deg"));
  return metrics;
}

}  // namespace

std::size_t PlaceOfMetric(const TuneResult& result, std::size_t metric) {
  return static_cast<std::size_t>(std::ranges::find(result.metrics, metric) -
                                  result.metrics.begin());
}

namespace {

/// What the search sees of a setting.
Measured MeasuredOf(const TunePlan& plan, const TuneResult& result, const TunedSetting& setting) {
  if (!setting.problem.empty()) return {.objective = std::numeric_limits<double>::quiet_NaN()};
  const double mean = setting.scores.front().mean;
  Measured measured{.objective = Metrics()[plan.minimise].lower_is_better ? mean : -mean};
  for (const Constraint& constraint : plan.constraints) {
    const double score = setting.scores[PlaceOfMetric(result, constraint.metric)].mean;
    const double beyond = constraint.at_most ? score - constraint.bound : constraint.bound - score;
    const double size = std::max(std::abs(constraint.bound), 1e-9);
    if (std::isnan(score)) measured.objective = score;
    measured.violation += std::max(0.0, beyond) / size;
  }
  return measured;
}

/// Places in `tried` of different settings that keep all bounds, the best first.
std::vector<std::size_t> BestFirst(const TunePlan& plan, const TuneResult& result) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < result.tried.size(); ++i) {
    if (result.tried[i].KeepsBounds() && std::isfinite(result.tried[i].scores.front().mean)) {
      order.push_back(i);
    }
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) {
    return MeasuredOf(plan, result, result.tried[i]).objective;
  });
  return order;
}

void FindEqualRanges(const TunePlan& plan, const std::vector<std::size_t>& order,
                     TuneResult& result) {
  const TunedSetting& chosen = result.tried[result.chosen];
  const auto count = static_cast<double>(order.size());
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    const auto number = [a](const TunedSetting& s) { return std::stod(s.values[a]); };
    const TunedSetting* low = &chosen;
    const TunedSetting* high = &chosen;
    for (const std::size_t i : order) {
      const TunedSetting& other = result.tried[i];
      const CellComparison comparison =
          ComparePaired(plan.minimise, other.minimised, chosen.minimised, other.motions,
                        0.5 * count * (count - 1));
      if (comparison.judgement != Judgement::kEqual) continue;
      if (number(other) < number(*low)) low = &other;
      if (number(other) > number(*high)) high = &other;
    }
    result.equal.push_back({low->values[a], high->values[a]});
  }
}

void FindFront(TuneResult& result) {
  const std::size_t delay = PlaceOfMetric(result, MetricIndex("delay_ms"));
  const std::size_t jitter = PlaceOfMetric(result, MetricIndex("jitter_rms_deg"));
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < result.tried.size(); ++i) {
    const TunedSetting& setting = result.tried[i];
    if (setting.problem.empty() && std::isfinite(setting.scores[delay].mean) &&
        std::isfinite(setting.scores[jitter].mean)) {
      order.push_back(i);
    }
  }
  const auto of = [&result](std::size_t i, std::size_t m) {
    return result.tried[i].scores[m].mean;
  };
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return std::pair(of(a, delay), of(a, jitter)) < std::pair(of(b, delay), of(b, jitter));
  });
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (of(i, jitter) >= least) continue;
    least = of(i, jitter);
    result.front.push_back(i);
  }
}

void ChooseByHeldOut(const TunePlan& plan, const Bench& bench,
                     const std::vector<std::size_t>& order,
                     const std::function<bool(double, int)>& progress, TuneResult& result) {
  for (std::size_t i = 0; i < std::min(order.size(), kMostVerdicts); ++i) {
    result.chosen = order[i];
    result.verdict = bench.Run(result.tried[order[i]].values, progress);
    if (result.verdict.problem.empty() && result.verdict.met < Met::kNo) return;
    ++result.refused;
  }
  std::vector<std::string> bounds;
  for (const Constraint& constraint : plan.constraints) bounds.push_back(constraint.Text());
  throw RunError(
      order.empty()
          ? fmt::format("no setting of {} that was tried keeps {}", result.tried.size(),
                        bounds.empty() ? "its hand going: " + result.tried.front().problem
                                       : fmt::format("{}", fmt::join(bounds, ", ")))
          : fmt::format("the {} best settings break {} on the held-out seeds by more than their "
                        "intervals; more --seeds tell more",
                        result.refused, fmt::join(bounds, ", ")));
}

}  // namespace

SweepAxis ParseFree(const std::string& text, const std::string& controller) {
  const auto fail = [&text](const std::string& problem) -> UserError {
    return UserError({.place = "--free", .key = Shown(text), .problem = problem});
  };
  const std::size_t equals = text.find('=');
  std::vector<std::string> parts;
  std::istringstream rest(equals == std::string::npos ? "" : text.substr(equals + 1));
  for (std::string part; std::getline(rest, part, ':');) parts.push_back(part);
  if (equals == 0 || parts.size() < 2)
    throw fail("must be KEY=LOW:HIGH, with :log or :whole behind");
  SweepAxis axis;
  axis.key = fmt::format("controllers.{}.{}", controller, text.substr(0, equals));
  for (double* bound : {&axis.low, &axis.high}) {
    const std::string& part = parts[bound == &axis.low ? 0 : 1];
    std::size_t length = 0;
    try {
      *bound = std::stod(part, &length);
    } catch (const std::exception&) {
      length = 0;
    }
    if (part.empty() || length != part.size() || !std::isfinite(*bound)) {
      throw fail(fmt::format("\"{}\" must be a finite number", Shown(part)));
    }
  }
  for (std::size_t i = 2; i < parts.size(); ++i) {
    if (parts[i] == "log") {
      axis.spacing = SweepAxis::Spacing::kLog;
    } else if (parts[i] == "whole") {
      axis.whole = true;
    } else {
      throw fail(fmt::format("\"{}\" must be log or whole", Shown(parts[i])));
    }
  }
  if (axis.low >= axis.high) throw fail("LOW must be below HIGH");
  if (axis.spacing == SweepAxis::Spacing::kLog && axis.low <= 0.0) {
    throw fail("LOW must be above 0 where spacing is log");
  }
  return axis;
}

TuneResult Tune(const TunePlan& plan, int jobs,
                const std::function<bool(double done, double all)>& progress) {
  TuneResult result;
  result.metrics = MetricsOf(plan);
  const int first_seed = ParseScenario(plan.scenario).seed;
  const Bench search(plan, result.metrics, first_seed, plan.seeds, jobs);
  const Bench verdict(plan, result.metrics, first_seed + plan.seeds, plan.held_out, jobs);
  search.ControllerWith({});  // what is wrong with it is the user's mistake
  const double all = plan.evaluations + 2.0;
  double done = 0.0;
  const auto within = [&](double share, int of) { return progress(done + share / of, all); };
  std::map<std::vector<std::string>, std::size_t> known;  // whole numbers come again
  Minimise(static_cast<int>(plan.free.size()), plan.evaluations,
           [&](const std::vector<double>& place) {
             std::vector<std::string> values;
             for (std::size_t a = 0; a < place.size(); ++a) {
               values.push_back(plan.free[a].ValueAt(place[a]));
             }
             const auto [at, is_new] = known.insert({values, result.tried.size()});
             if (is_new) result.tried.push_back(search.Run(values, within));
             done += 1.0;
             return MeasuredOf(plan, result, result.tried[at->second]);
           });
  const std::vector<std::size_t> order = BestFirst(plan, result);
  ChooseByHeldOut(plan, verdict, order, within, result);
  result.before = verdict.Run({}, within);
  result.gain = ComparePaired(plan.minimise, result.verdict.minimised, result.before.minimised,
                              result.verdict.motions, 1.0);
  FindEqualRanges(plan, order, result);
  FindFront(result);
  result.controller = search.ControllerWith(result.tried[result.chosen].values);
  return result;
}

std::string ControllerYaml(const NamedController& controller) {
  NamedController copy = controller;  // a visitor may change what it sees
  std::istringstream settings(
      SettingsToYaml([&copy](controller::SettingsVisitor& visitor) { copy.Visit(visitor); }));
  std::string text = "controllers:\n  " + controller.name + ":\n";
  for (std::string line; std::getline(settings, line);) text += "    " + line + "\n";
  return text;
}

namespace {

nlohmann::ordered_json IntervalJson(const MeanInterval& interval) {
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
  };
  return {{"mean", number(interval.mean)},
          {"ci95_low", number(interval.low)},
          {"ci95_high", number(interval.high)}};
}

nlohmann::ordered_json SettingJson(const TunePlan& plan, const TuneResult& result,
                                   const TunedSetting& setting) {
  nlohmann::ordered_json json;
  for (std::size_t a = 0; a < setting.values.size(); ++a) {
    json["settings"][plan.free[a].key] = setting.values[a];
  }
  for (std::size_t m = 0; m < result.metrics.size(); ++m) {
    json["scores"][std::string(Metrics()[result.metrics[m]].key)] = IntervalJson(setting.scores[m]);
  }
  json["constraints_met"] = MetText(setting.met);
  if (!setting.problem.empty()) json["problem"] = setting.problem;
  return json;
}

}  // namespace

std::string TuneCsv(const TunePlan& plan, const TuneResult& result) {
  std::vector<std::string> head;
  for (const SweepAxis& axis : plan.free) head.push_back(axis.key);
  for (const std::size_t metric : result.metrics) {
    for (const char* ending : {"", "_low", "_high"}) {
      head.push_back(std::string(Metrics()[metric].key) + ending);
    }
  }
  head.insert(head.end(), {"constraints_met", "problem"});
  std::string text = CsvLine(head);
  for (const TunedSetting& setting : result.tried) {
    std::vector<std::string> row = setting.values;
    for (const MeanInterval& score : setting.scores) {
      for (const double value : {score.mean, score.low, score.high}) {
        row.push_back(NumberOrNothing(value));
      }
    }
    row.emplace_back(MetText(setting.met));
    row.push_back(setting.problem);
    text += CsvLine(row);
  }
  return text;
}

std::string TuneJson(const TunePlan& plan, const TuneResult& result) {
  nlohmann::ordered_json json;
  json["scenario"] = plan.scenario.file.string();
  json["controller"] = plan.controller;
  json["minimise"] = Metrics()[plan.minimise].key;
  json["physics"] = plan.physics;
  json["seeds"] = plan.seeds;
  json["held_out_seeds"] = plan.held_out;
  json["tried"] = result.tried.size();
  json["tuned"] = SettingJson(plan, result, result.verdict);
  json["before"] = SettingJson(plan, result, result.before);
  json["gain"] = IntervalJson(result.gain.difference);
  json["gain"]["verdict"] = JudgementText(result.gain.judgement);
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    json["as_good"][plan.free[a].key] = {result.equal[a].low, result.equal[a].high};
  }
  for (const std::size_t i : result.front) {
    json["front"].push_back(SettingJson(plan, result, result.tried[i]));
  }
  return json.dump(1) + "\n";
}

}  // namespace gauntlet::sim
