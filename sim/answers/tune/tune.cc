#include "sim/answers/tune/tune.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "controller/number.h"
#include "sim/answers/tune/tune_bench.h"
#include "sim/base/error.h"
#include "sim/base/optimise.h"
#include "sim/base/text.h"
#include "sim/score/priority.h"
#include "sim/score/statistics/result_cells.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostVerdicts = 10;

}  // namespace

std::string SettingsText(const TunePlan& plan, const std::vector<std::string>& values) {
  std::string text;
  for (std::size_t a = 0; a < values.size(); ++a) {
    const std::string& key = plan.free[a].key;
    text += fmt::format("{}{}={}", a == 0 ? "" : ", ", key.substr(key.rfind('.') + 1), values[a]);
  }
  return text;
}

namespace {

/// A score that is to be good, within bounds of others.
struct Aim {
  std::size_t minimise = 0;  // in Metrics()
  std::vector<Constraint> constraints;
};

/// The objective and the bounds of a setting for the search.
Measured MeasuredOf(const Aim& aim, const TuneResult& result, const TunedSetting& setting) {
  if (!setting.problem.empty()) return {.objective = kNaN};
  const double mean = setting.scores[PlaceOfMetric(result.metrics, aim.minimise)].mean;
  Measured measured{.objective = Metrics()[aim.minimise].lower_is_better ? mean : -mean};
  for (const Constraint& constraint : aim.constraints) {
    const double score = setting.scores[PlaceOfMetric(result.metrics, constraint.metric)].mean;
    const double beyond = constraint.at_most ? score - constraint.bound : constraint.bound - score;
    const double size = std::max(std::abs(constraint.bound), 1e-9);
    if (std::isnan(score)) measured.objective = score;
    measured.violation += std::max(0.0, beyond) / size;
  }
  return measured;
}

Aim AimOf(const TunePlan& plan) { return {plan.minimise, plan.constraints}; }

/// The bounds that a front keeps: those of other scores than its own two.
std::vector<Constraint> BoundsOfFront(const TunePlan& plan) {
  std::vector<Constraint> bounds = plan.constraints;
  std::erase_if(bounds, [](const Constraint& constraint) {
    return constraint.metric == MetricIndex("delay_ms") ||
           constraint.metric == MetricIndex("jitter_rms_deg");
  });
  return bounds;
}

/// Tries settings, each once, within a number of evaluations.
class SettingSearch {
 public:
  SettingSearch(const TunePlan& plan, const TuneBench& bench, const TuneBench::Progress& progress,
                TuneResult& result)
      : plan_(plan), bench_(bench), progress_(progress), result_(result) {}

  /// Errors: Cancelled.
  void Run() {
    const int dimensions = static_cast<int>(plan_.free.size());
    const Aim own = AimOf(plan_);
    if (dimensions == 0) {
      Try({});
    } else if (plan_.front_jitter_deg.empty()) {
      Minimise(dimensions, plan_.evaluations, For(own));
    } else {
      LookEverywhere(dimensions, (plan_.evaluations + 1) / 2, For(own));
      std::vector<Aim> aims = {own};
      for (const double level : plan_.front_jitter_deg) {
        Aim aim{MetricIndex("delay_ms"), BoundsOfFront(plan_)};
        aim.constraints.push_back({.metric = MetricIndex("jitter_rms_deg"), .bound = level});
        aims.push_back(std::move(aim));
      }
      for (std::size_t i = 0; i < aims.size(); ++i) {
        const int left = (plan_.evaluations - count_) / static_cast<int>(aims.size() - i);
        LookAround(BestPlace(aims[i]), left, For(aims[i]));
      }
    }
  }

 private:
  const TunedSetting& Try(const std::vector<double>& place) {
    std::vector<std::string> values;
    for (std::size_t a = 0; a < place.size(); ++a) {
      values.push_back(plan_.free[a].ValueAt(place[a]));
    }
    const auto [at, is_new] = known_.insert({values, result_.tried.size()});
    if (is_new) {
      result_.tried.push_back(bench_.Run(values, progress_));
      places_.push_back(place);
    }
    ++count_;
    return result_.tried[at->second];
  }
  std::function<Measured(const std::vector<double>&)> For(const Aim& aim) {
    return [this, aim](const std::vector<double>& place) {
      return MeasuredOf(aim, result_, Try(place));
    };
  }
  std::vector<double> BestPlace(const Aim& aim) const {
    std::vector<MeasuredPoint> points;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      points.push_back({places_[i], MeasuredOf(aim, result_, result_.tried[i])});
    }
    return BestOf(points).place;
  }

  const TunePlan& plan_;
  const TuneBench& bench_;
  const TuneBench::Progress& progress_;
  TuneResult& result_;
  std::map<std::vector<std::string>, std::size_t> known_;  // whole numbers come again
  std::vector<std::vector<double>> places_;                // of result_.tried
  int count_ = 0;
};

/// Places in `tried` of different settings that keep all bounds, the best first.
std::vector<std::size_t> BestFirst(const TunePlan& plan, const TuneResult& result) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < result.tried.size(); ++i) {
    if (result.tried[i].KeepsBounds() && std::isfinite(result.tried[i].scores.front().mean)) {
      order.push_back(i);
    }
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) {
    return MeasuredOf(AimOf(plan), result, result.tried[i]).objective;
  });
  return order;
}

/// Settings equivalent to the best before the others: those whose jitter is the least or equivalent
/// by its mean first, by their delay. The rule is that of a comparison.
std::vector<std::size_t> EquivalentFirst(const TunePlan& plan, const TuneResult& result,
                                         std::vector<std::size_t> order) {
  if (!IsPrimary(plan.minimise)) return order;
  if (order.empty()) return order;
  const auto count = static_cast<double>(order.size());
  const TunedSetting& best = result.tried[order.front()];
  const auto others = std::stable_partition(order.begin(), order.end(), [&](std::size_t i) {
    const TunedSetting& setting = result.tried[i];
    return &setting == &best || ComparePaired(plan.minimise, setting.minimised, best.minimised,
                                              setting.motions, PairsOf(count))
                                        .judgement == Judgement::kEqual;
  });
  const auto sort_by = [&](std::size_t metric, auto begin, auto end) {
    const std::size_t place = PlaceOfMetric(result.metrics, metric);
    std::stable_sort(begin, end, [&result, place](std::size_t a, std::size_t b) {
      const double first = result.tried[a].scores[place].mean;
      const double second = result.tried[b].scores[place].mean;
      return first < second || (std::isnan(second) && !std::isnan(first));
    });
  };
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  sort_by(jitter, order.begin(), others);
  const auto jitter_of = [&](std::size_t i) {
    return result.tried[i].scores[PlaceOfMetric(result.metrics, jitter)].mean;
  };
  const double least = jitter_of(order.front());
  const auto more = std::find_if(order.begin(), others, [&](std::size_t i) {
    return !(jitter_of(i) - least <=
             RelevantDifferenceBetween(Metrics()[jitter], jitter_of(i), least));
  });
  sort_by(MetricIndex("delay_ms"), order.begin(), more);
  return order;
}

void FindEqualRanges(const TunePlan& plan, const std::vector<std::size_t>& order,
                     TuneResult& result) {
  const TunedSetting& chosen = result.tried[result.chosen];
  const auto count = static_cast<double>(order.size());
  for (std::size_t a = 0; a < plan.free.size(); ++a) {
    const auto number = [a](const TunedSetting& s) {
      return controller::ParseNumber(s.values[a]).value();
    };
    const TunedSetting* low = &chosen;
    const TunedSetting* high = &chosen;
    for (const std::size_t i : order) {
      const TunedSetting& other = result.tried[i];
      const Comparison comparison = ComparePaired(plan.minimise, other.minimised, chosen.minimised,
                                                  other.motions, PairsOf(count));
      if (comparison.judgement != Judgement::kEqual) continue;
      if (number(other) < number(*low)) low = &other;
      if (number(other) > number(*high)) high = &other;
    }
    result.equal.push_back({low->values[a], high->values[a]});
  }
}

void FindFront(const TunePlan& plan, TuneResult& result) {
  const Aim aim{MetricIndex("delay_ms"), BoundsOfFront(plan)};
  const std::size_t delay = PlaceOfMetric(result.metrics, MetricIndex("delay_ms"));
  const std::size_t jitter = PlaceOfMetric(result.metrics, MetricIndex("jitter_rms_deg"));
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < result.tried.size(); ++i) {
    const TunedSetting& setting = result.tried[i];
    const Measured measured = MeasuredOf(aim, result, setting);
    if (std::isfinite(measured.objective) && measured.violation == 0.0 &&
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

/// Contribution of the glove's noise to the jitter of a setting, on the fitted part: no
/// filter takes away the rest. Empty where jitter has no bound.
std::string JitterOfNoise(const TunePlan& plan, const TuneResult& result,
                          const TunedSetting& setting, int jobs,
                          const TuneBench::Progress& progress) {
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  const bool is_bound = std::ranges::any_of(
      plan.constraints, [&](const Constraint& bound) { return bound.metric == jitter; });
  if (!is_bound) return "";
  std::vector<std::size_t> metrics = result.metrics;
  metrics.push_back(MetricIndex("noise_jitter_rms_deg"));
  const TuneBench bench(plan, metrics, result.split, TunePart::kFitted, jobs);
  const double noise_deg = bench.Run(setting.values, progress).scores.back().mean;
  if (!std::isfinite(noise_deg)) return "";
  return fmt::format(
      ". The glove's noise causes {:.3g} deg RMS of its jitter; no filter reduces the rest",
      noise_deg);
}

/// "; closest is q=0.001 with jitter_rms_deg 0.24 (0.22 to 0.26)", with a reason where
/// there is one; empty where nothing was scored.
std::string NearestText(const TunePlan& plan, const TuneResult& result, int jobs,
                        const TuneBench::Progress& progress) {
  if (!result.nearest) return "";
  const TunedSetting& nearest = result.tried[*result.nearest];
  std::string settings = SettingsText(plan, nearest.values);
  if (settings.empty()) settings = plan.controller;
  return fmt::format("; closest is {} with {}{}", settings, BoundScoresText(plan, result, nearest),
                     JitterOfNoise(plan, result, nearest, jobs, progress));
}

void FindNearest(const TunePlan& plan, TuneResult& result) {
  const auto violation = [&](const TunedSetting& setting) {
    return ViolationOf(plan, result, setting);
  };
  const auto nearest = std::ranges::min_element(result.tried, {}, violation);
  if (plan.constraints.empty() || !std::isfinite(violation(*nearest))) return;
  result.nearest = static_cast<std::size_t>(nearest - result.tried.begin());
}

/// Chooses, or says in result.problem why there is nothing to choose.
void ChooseByHeldOut(const TunePlan& plan, const TuneBench& bench,
                     const std::vector<std::size_t>& order, int jobs,
                     const TuneBench::Progress& progress, TuneResult& result) {
  for (std::size_t i = 0; i < std::min(order.size(), kMostVerdicts); ++i) {
    result.chosen = order[i];
    result.verdict = bench.Run(result.tried[order[i]].values, progress);
    if (result.verdict.problem.empty() && result.verdict.met < Met::kNo) return;
    ++result.refused;
  }
  const std::vector<std::string> bounds = TextsOf(plan.constraints);
  if (order.empty()) FindNearest(plan, result);
  result.problem =
      order.empty() ? fmt::format("no setting of {} that was tried keeps {}", result.tried.size(),
                                  bounds.empty() ? "its hand going: " + result.tried.front().problem
                                                 : fmt::format("{}", fmt::join(bounds, ", "))) +
                          NearestText(plan, result, jobs, progress)
                    : fmt::format(
                          "the {} best settings break {} on the held-out {} by more than "
                          "their intervals",
                          result.refused, fmt::join(bounds, ", "), result.split.Noun());
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
    const std::optional<double> number = controller::ParseNumber(part);
    if (!number) throw fail(fmt::format("\"{}\" must be a number", Shown(part)));
    *bound = *number;
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
  if (const std::string problem = axis.WholeProblem(); !problem.empty()) throw fail(problem);
  axis.digits = axis.FewDigits();
  return axis;
}

double ViolationOf(const TunePlan& plan, const TuneResult& result, const TunedSetting& setting) {
  const Measured measured = MeasuredOf(AimOf(plan), result, setting);
  return std::isnan(measured.objective) ? std::numeric_limits<double>::infinity()
                                        : measured.violation;
}

std::string BoundScoresText(const TunePlan& plan, const TuneResult& result,
                            const TunedSetting& setting) {
  std::vector<std::string> scores;
  for (const Constraint& bound : plan.constraints) {
    scores.push_back(
        fmt::format("{} {}", Metrics()[bound.metric].key,
                    IntervalText(setting.scores[PlaceOfMetric(result.metrics, bound.metric)])));
  }
  return fmt::format("{}", fmt::join(scores, ", "));
}

TuneResult SearchSettings(const TunePlan& plan, const TuneSplit& split, int jobs,
                          const std::function<bool(double done, double all)>& progress) {
  TuneResult result;
  result.split = split;
  result.metrics = TuneMetrics(plan);
  const TuneBench search(plan, result.metrics, result.split, TunePart::kFitted, jobs);
  const TuneBench verdict(plan, result.metrics, result.split, TunePart::kHeldOut, jobs);
  search.ControllerWith({});  // what is wrong with it is the user's mistake
  const double all = plan.evaluations + 2.0;
  double done = 0.0;
  const TuneBench::Progress within = [&](double share, int of) {
    return progress(std::min(done + share / of, all), all);
  };
  SettingSearch(
      plan, search,
      [&](double share, int of) {
        done = static_cast<double>(result.tried.size());
        return within(share, of);
      },
      result)
      .Run();
  done = plan.evaluations;
  std::vector<std::size_t> order = BestFirst(plan, result);
  if (plan.prefers_low_jitter) order = EquivalentFirst(plan, result, std::move(order));
  FindFront(plan, result);
  ChooseByHeldOut(plan, verdict, order, jobs, within, result);
  if (!result.problem.empty()) return result;
  result.before = verdict.Run({}, within);
  result.gain = ComparePaired(plan.minimise, result.verdict.minimised, result.before.minimised,
                              result.verdict.motions, result.refused + 1.0);
  FindEqualRanges(plan, order, result);
  result.controller = search.ControllerWith(result.tried[result.chosen].values);
  result.unit_per_rad = search.Input().unit_per_rad;
  return result;
}

TuneResult Tune(const TunePlan& plan, int jobs,
                const std::function<bool(double done, double all)>& progress) {
  const TuneSplit split = SplitOf(plan, jobs);
  TuneResult result = SearchSettings(plan, split, jobs, progress);
  if (!result.problem.empty()) throw RunError(result.problem);
  return result;
}

}  // namespace gauntlet::sim
