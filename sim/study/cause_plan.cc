#include "sim/study/cause_plan.h"

#include <cmath>

#include "sim/base/error.h"
#include "sim/study/cause_trials.h"
#include "sim/study/counted_parts.h"

namespace gauntlet::sim {
namespace {

constexpr double kMostOfTime = 0.25;
constexpr double kLeast_s = 4.0;
constexpr double kMostOfSpeed = 1.2;

double TicksOf(const Study& study, int seed_index) {
  const std::size_t repetition = static_cast<std::size_t>(seed_index) % study.repetitions.size();
  return static_cast<double>(study.repetitions[repetition].ticks);
}

/// Ticks of all trials that are not for causes.
double TicksOfTrials(const Study& study, int seeds) {
  double ticks = 0.0;
  for (int i = 0; i < seeds; ++i) {
    const bool twin = TwinOf(study, study.scenario.seed + i) == TwinSource::kTrial;
    ticks += (twin ? 2.0 : 1.0) * TicksOf(study, i);
  }
  return ticks * static_cast<double>(study.scenario.controllers.size());
}

/// True if the first ticks are as fast as the whole motion.
bool IsTypical(const Signal& angle_rad, Eigen::Index ticks) {
  const auto speed = [&](Eigen::Index rows) {
    double squares = 0.0;
    for (Eigen::Index c = 0; c < angle_rad.cols(); ++c) {
      const auto column = angle_rad.col(c);
      squares += (column.segment(1, rows - 1) - column.segment(0, rows - 1)).squaredNorm();
    }
    return std::sqrt(squares / static_cast<double>(rows - 1));
  };
  const double first = speed(ticks);
  const double whole = speed(angle_rad.rows());
  return first <= kMostOfSpeed * whole && whole <= kMostOfSpeed * first;
}

/// Time that counts of the first ticks of the first motion, a mean over joints.
double Counted_s(const Study& study, Eigen::Index ticks) {
  const double rate_hz = study.hand->timing().tick_rate_hz();
  const std::optional<CountedParts> counted = CountedPartsOf(
      study, study.repetitions.front().masked, static_cast<int>(study.repetitions.front().ticks));
  if (!counted) return static_cast<double>(ticks) / rate_hz;
  double sum = 0.0;
  for (const CountedTicks& joint : counted->joints) {
    sum += CountOf(Overlap({{0, static_cast<int>(ticks)}}, joint));
  }
  return sum / static_cast<double>(counted->joints.size()) / rate_hz;
}

/// Fills in the first seed as far as its trials take a quarter of the time of the others.
void PlanFirst(const Study& study, double ticks_of_trials, CausePlan& plan) {
  const double rate_hz = study.hand->timing().tick_rate_hz();
  const double whole = TicksOf(study, 0);
  const int trials = SwitchedTrialsOf(study, study.scenario.seed);
  const std::size_t controllers = study.scenario.controllers.size();
  for (const bool all : {true, false}) {
    const double stretch_s = std::floor(10.0 * kMostOfTime * ticks_of_trials / trials / rate_hz /
                                        (all ? static_cast<double>(controllers) : 1.0)) /
                             10.0;
    const bool is_whole = stretch_s * rate_hz >= whole;
    const auto ticks = static_cast<Eigen::Index>(std::lround(stretch_s * rate_hz));
    if (!is_whole && (stretch_s < kLeast_s || Counted_s(study, ticks) < kLeast_s ||
                      !IsTypical(study.gloves.front()->true_angle_rad, ticks))) {
      continue;
    }
    plan.switched = true;
    plan.seeds = 1;
    plan.trials = trials;
    if (!all) plan.controller = BaselineOf(study.scenario).value_or(0);
    if (is_whole) return;
    plan.stretch_s = stretch_s;
    plan.ticks = ticks;
    plan.trials *= static_cast<double>(ticks) / whole;
    return;
  }
  plan.is_left_out = true;
}

}  // namespace

CauseSeeds CauseSeedsOf(const std::string& name) {
  if (name == "none") return CauseSeeds::kNone;
  if (name == "auto") return CauseSeeds::kAuto;
  if (name == "first") return CauseSeeds::kFirst;
  if (name == "all") return CauseSeeds::kAll;
  throw UserError(
      {.place = "causes", .problem = "is " + name + ", must be none, auto, first or all"});
}

CausePlan PlanCauses(const Study& study, int seeds, CauseSeeds asked) {
  CausePlan plan;
  const double ticks_of_trials = TicksOfTrials(study, seeds);
  const int trials = SwitchedTrialsOf(study, study.scenario.seed) + ChainTrialsOf(study);
  plan.cost_of_first = 1.0 + TicksOf(study, 0) * trials *
                                 static_cast<double>(study.scenario.controllers.size()) /
                                 ticks_of_trials;
  if (asked == CauseSeeds::kAuto) PlanFirst(study, ticks_of_trials, plan);
  if (asked != CauseSeeds::kFirst && asked != CauseSeeds::kAll) return plan;
  plan.switched = plan.chain = true;
  plan.seeds = asked == CauseSeeds::kAll ? seeds : 1;
  plan.trials = trials;
  return plan;
}

}  // namespace gauntlet::sim
