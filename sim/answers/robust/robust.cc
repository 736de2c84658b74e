#include "sim/answers/robust/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "controller/number.h"
#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

/// A parameter and the settings that it scales.
struct ScaledSettings {
  const char* name;
  const char* help;
  std::vector<std::string> keys;
  bool inverse = false;  // the parameter is one over the setting
};

const std::vector<ScaledSettings>& AllScaledSettings() {
  static const std::vector<ScaledSettings> kAll = {
      {"friction",
       "dry and load friction of all motors, and of the cables on their guides",
       {"hand.servo.friction_scale", "hand.servo.load_friction", "hand.arm_servo.friction_scale",
        "hand.arm_servo.load_friction", "hand.cable.capstan_friction"}},
      {"stiffness", "stiffness of the cables", {"hand.cable.stiffness_scale"}},
      {"inertia",
       "inertia of the motors behind their gears",
       {"hand.servo.inertia_scale", "hand.arm_servo.inertia_scale"}},
      {"servo_gain",
       "gain of the servos: stall torque over the error that calls for it",
       {"hand.servo.full_torque_error_deg", "hand.arm_servo.full_torque_error_deg"},
       true},
      {"delay",
       "delay of the link, and dead time of the motors",
       {"event.delay_ms", "hand.servo.dead_time_ms", "hand.arm_servo.dead_time_ms"}},
      {"wearer",
       "how far the glove's sensors are off on this wearer: gain, offset, bow, cross-talk, play",
       {"glove.sensor.gain_deviation_percent", "glove.sensor.offset_deviation_percent",
        "glove.sensor.curvature_deviation_percent", "glove.sensor.cross_talk_percent",
        "glove.sensor.hysteresis_deg"}},
      {"noise",
       "variance of the glove's noise, white and 1/f",
       {"glove.noise.variance_scale", "glove.noise.pink_variance_counts2"}},
  };
  return kAll;
}

/// A setting that is varied: its value on the nominal hand, and by which factor.
struct VariedSetting {
  double nominal = 0.0;
  std::size_t parameter = 0;
  bool inverse = false;
};

/// The number at this key; 0 for one that the scenario does not have.
double NumberAt(const std::map<std::string, std::string>& settings, const std::string& key) {
  const auto found = settings.find(key);
  return found == settings.end() ? 0.0 : controller::ParseNumber(found->second).value_or(0.0);
}

/// The values of all axes for these factors of the parameters.
std::vector<std::string> CellOf(const std::vector<VariedSetting>& settings,
                                const std::vector<double>& factors) {
  std::vector<std::string> values;
  for (const VariedSetting& setting : settings) {
    const double factor = factors[setting.parameter];
    values.push_back(
        fmt::format("{:.6g}", setting.nominal * (setting.inverse ? 1.0 / factor : factor)));
  }
  return values;
}

std::vector<VariedSetting> AddAxes(const Scenario& scenario, RobustPlan& plan) {
  std::map<std::string, std::string> known;
  for (const SettingValue& setting : SettingValues(scenario)) known[setting.key] = setting.value;
  std::vector<VariedSetting> varied;
  for (const ScaledSettings& scaled : AllScaledSettings()) {
    const std::size_t before = varied.size();
    for (const std::string& key : scaled.keys) {
      const double nominal = NumberAt(known, key);
      if (nominal == 0.0) continue;
      varied.push_back({nominal, plan.parameters.size(), scaled.inverse});
      SweepAxis& axis = plan.sweep.file.axes.emplace_back();
      axis.key = key;
    }
    if (varied.size() == before) {
      plan.not_varied.emplace_back(scaled.name);
    } else {
      plan.parameters.push_back({scaled.name, scaled.help});
    }
  }
  return varied;
}

void AddCells(const std::vector<VariedSetting>& settings, const RobustOptions& options,
              RobustPlan& plan) {
  const double within = 0.01 * options.within_percent;
  const std::vector<double> nominal(plan.parameters.size(), 1.0);
  plan.factors.push_back(nominal);
  for (std::size_t p = 0; p < plan.parameters.size(); ++p) {
    for (const double factor : {1.0 - within, 1.0 + within}) {
      std::vector<double> factors = nominal;
      factors[p] = factor;
      plan.factors.push_back(std::move(factors));
    }
  }
  for (int hand = 0; hand < options.hands; ++hand) {
    RandomStream stream(static_cast<std::uint64_t>(options.design_seed), "robust hand",
                        static_cast<std::uint64_t>(hand));
    std::vector<double> factors = nominal;
    for (double& factor : factors) factor = stream.Uniform(1.0 - within, 1.0 + within);
    plan.factors.push_back(std::move(factors));
  }
  for (const std::vector<double>& factors : plan.factors) {
    plan.sweep.listed.push_back(CellOf(settings, factors));
  }
}

/// The results of one cell by controller, in the order of the scenario; empty if it was not built.
using HandResults = std::vector<CellResult>;

double MeanOf(const RobustPlan& plan, const CellResult& result, std::size_t metric) {
  if (!result.problem.empty()) return kNaN;
  return result.scores[PlaceOfMetric(plan.sweep.metrics, metric)].mean;
}

const std::vector<double>& BySeed(const RobustPlan& plan, const CellResult& result,
                                  std::size_t metric) {
  return result.by_seed[PlaceOfMetric(plan.sweep.metrics, metric)];
}

/// Places of the controllers that have this score, the best first.
std::vector<std::size_t> BestFirst(const RobustPlan& plan, const HandResults& hand,
                                   std::size_t metric) {
  std::vector<std::size_t> order;
  for (std::size_t c = 0; c < hand.size(); ++c) {
    if (std::isfinite(MeanOf(plan, hand[c], metric))) order.push_back(c);
  }
  const double sign = Metrics()[metric].lower_is_better ? 1.0 : -1.0;
  std::ranges::stable_sort(order, {},
                           [&](std::size_t c) { return sign * MeanOf(plan, hand[c], metric); });
  return order;
}

/// The verdict on the nominal hand, as a comparison gives it.
Summary SummariseNominal(const RobustPlan& plan, const HandResults& hand) {
  Study study;
  study.scenario = ParseScenario(plan.sweep.scenario);
  StudyResult result;
  for (const CellResult& controller : hand) {
    result.controller_names.push_back(controller.controller);
  }
  for (std::size_t i = 0; i < hand.front().motions.size(); ++i) {
    SeedOutcome& seed = result.seeds.emplace_back();
    seed.seed = study.scenario.seed + static_cast<int>(i);
    seed.motion = hand.front().motions[i];
    for (const CellResult& controller : hand) {
      TrialOutcome& trial = seed.controllers.emplace_back();
      trial.scores.summary.assign(Metrics().size(), kNaN);
      for (const std::size_t metric : plan.sweep.metrics) {
        trial.scores.summary[metric] = BySeed(plan, controller, metric)[i];
      }
      // A controller that failed once is in no pair, whichever of its trials it was.
      trial.health = {.ok = controller.problem.empty(), .problem = controller.problem};
    }
  }
  return Summarise(study, result);
}

std::vector<RobustController> CountBest(const RobustPlan& plan,
                                        const std::vector<HandResults>& hands, std::size_t metric) {
  struct Hits {
    int best = 0;
    int near_best = 0;
  };
  std::vector<Hits> hits(hands.front().size());
  int count = 0;
  for (std::size_t h = static_cast<std::size_t>(plan.FirstHand()); h < hands.size(); ++h) {
    const HandResults& hand = hands[h];
    const std::vector<std::size_t> order = BestFirst(plan, hand, metric);
    if (order.empty()) continue;
    ++count;
    const double best = MeanOf(plan, hand[order.front()], metric);
    for (const std::size_t c : order) {
      const double mean = MeanOf(plan, hand[c], metric);
      const double matters = RelevantDifferenceBetween(Metrics()[metric], mean, best);
      if (mean == best) ++hits[c].best;
      if (mean == best || std::abs(mean - best) < matters) ++hits[c].near_best;
    }
  }
  std::vector<RobustController> controllers;
  for (std::size_t c = 0; c < hits.size(); ++c) {
    controllers.push_back({.name = hands.front()[c].controller,
                           .best = EstimateShare(hits[c].best, count),
                           .near_best = EstimateShare(hits[c].near_best, count)});
  }
  return controllers;
}

/// first - second, seed by seed, of the two that are best on the scenario's hand; empty if one of
/// them has no scores on this one.
std::vector<double> DifferenceOfBest(const RobustPlan& plan, const HandResults& hand,
                                     const RobustScore& score) {
  std::vector<double> difference;
  if (hand.empty()) return difference;
  const CellResult& first = hand[score.two_best[0]];
  const CellResult& second = hand[score.two_best[1]];
  if (!first.problem.empty() || !second.problem.empty()) return difference;
  for (std::size_t i = 0; i < first.motions.size(); ++i) {
    difference.push_back(BySeed(plan, first, score.metric)[i] -
                         BySeed(plan, second, score.metric)[i]);
  }
  return difference;
}

std::string ProblemOf(const HandResults& hand) {
  for (const CellResult& controller : hand) {
    if (!controller.problem.empty()) return controller.problem;
  }
  return "could not be built";
}

/// The bars of all scores are one family of questions.
void AddBars(const RobustPlan& plan, const std::vector<HandResults>& hands, RobustResult& result) {
  std::vector<Question> questions;
  std::vector<TornadoBar*> asked;
  for (RobustScore& score : result.scores) {
    if (score.two_best.size() < 2) continue;
    const HandResults& own = hands.front();
    const Metric& metric = Metrics()[score.metric];
    const double matters =
        RelevantDifferenceBetween(metric, MeanOf(plan, own[score.two_best[0]], score.metric),
                                  MeanOf(plan, own[score.two_best[1]], score.metric));
    score.bars.reserve(plan.parameters.size());
    for (std::size_t p = 0; p < plan.parameters.size(); ++p) {
      const HandResults& low_hand = hands[static_cast<std::size_t>(RobustPlan::LowCell(p))];
      const HandResults& high_hand = hands[static_cast<std::size_t>(RobustPlan::HighCell(p))];
      const std::vector<double> low = DifferenceOfBest(plan, low_hand, score);
      const std::vector<double> high = DifferenceOfBest(plan, high_hand, score);
      TornadoBar& bar = score.bars.emplace_back();
      bar.parameter = p;
      if (low.empty()) bar.problem = "low: " + ProblemOf(low_hand);
      if (high.empty()) bar.problem = "high: " + ProblemOf(high_hand);
      if (!bar.problem.empty()) continue;
      const std::vector<int>& motions = own.front().motions;
      bar.low = EstimateMean(low, motions).IntervalAt();
      bar.high = EstimateMean(high, motions).IntervalAt();
      questions.push_back({.difference = EstimateDifference(high, low, motions),
                           .relevant_difference = matters,
                           .lower_is_better = metric.lower_is_better});
      asked.push_back(&bar);
    }
  }
  const std::vector<Comparison> answers = Judge(questions);
  for (std::size_t i = 0; i < answers.size(); ++i) asked[i]->change = answers[i];
  for (RobustScore& score : result.scores) {
    std::ranges::stable_sort(score.bars, std::greater<>(), [](const TornadoBar& bar) {
      return bar.problem.empty() ? std::abs(bar.change.difference.mean) : -1.0;
    });
  }
}

std::vector<HandResults> ReadHands(const RobustPlan& plan, SweepDatabase& database,
                                   RobustResult& result) {
  const Scenario scenario = ParseScenario(plan.sweep.scenario);
  std::vector<HandResults> hands(plan.sweep.listed.size());
  std::vector<bool> seen(hands.size(), false);
  ForEachCell(plan.sweep, database, ShardOf(plan.sweep, 1, 1), [&](const CellResult& cell) {
    const auto number = static_cast<std::size_t>(cell.number);
    seen[number] = true;
    if (!cell.problem.empty()) {
      if (cell.number >= plan.FirstHand()) {
        (cell.controller.empty() ? result.not_built : result.failed) += 1;
      }
      if (result.first_problem.empty()) {
        result.first_problem = fmt::format("hand {}: {}", cell.number, cell.problem);
      }
    }
    if (!cell.controller.empty()) hands[number].push_back(cell);
  });
  if (const auto missing = std::ranges::count(seen, false); missing > 0) {
    throw RunError(fmt::format("{} of {} hands have no result yet", missing, seen.size()));
  }
  for (HandResults& hand : hands) {
    std::ranges::sort(hand, {}, [&scenario](const CellResult& cell) {
      return std::ranges::find(scenario.controllers, cell.controller, &NamedController::name) -
             scenario.controllers.begin();
    });
  }
  if (hands.front().empty()) throw RunError("the nominal hand: " + result.first_problem);
  return hands;
}

}  // namespace

RobustPlan MakeRobustPlan(const ScenarioSource& source, const RobustOptions& options) {
  Scenario scenario = ParseScenario(source);
  KeepControllers(options.controllers, scenario);
  if (scenario.controllers.size() < 2) {
    throw UserError({.place = source.file.string(),
                     .key = "controllers",
                     .problem = "must be two at least: a verdict is between them"});
  }
  RobustPlan plan;
  plan.hands = options.hands;
  plan.within_percent = options.within_percent;
  constexpr int kFewest = 8;
  SweepFile& file = plan.sweep.file;
  file.name = scenario.name;
  file.question = scenario.question;
  file.scenario = source.file.string();
  file.seeds = options.seeds > 0
                   ? options.seeds
                   : std::max(kFewest, static_cast<int>(scenario.repetitions.gloves.size()));
  // Resolved, so that controllers stay as they are whatever glove and hand they get.
  plan.sweep.scenario = {.file = source.file, .text = ScenarioToYaml(scenario)};
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    if (Metrics()[m].main) plan.sweep.metrics.push_back(m);
  }
  plan.sweep.best_by = MetricIndex(file.best_by);
  AddCells(AddAxes(scenario, plan), options, plan);
  return plan;
}

RobustResult ConcludeRobust(const RobustPlan& plan, SweepDatabase& database) {
  RobustResult result;
  const std::vector<HandResults> hands = ReadHands(plan, database, result);
  result.nominal = SummariseNominal(plan, hands.front());
  for (const std::size_t metric : plan.sweep.metrics) {
    std::vector<std::size_t> order = BestFirst(plan, hands.front(), metric);
    if (order.empty()) continue;
    order.resize(std::min<std::size_t>(order.size(), 2));
    result.scores.push_back({.metric = metric,
                             .controllers = CountBest(plan, hands, metric),
                             .two_best = std::move(order),
                             .bars = {}});
  }
  AddBars(plan, hands, result);
  return result;
}

}  // namespace gauntlet::sim
