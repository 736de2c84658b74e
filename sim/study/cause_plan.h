#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>

#include "sim/study/study.h"

namespace gauntlet::sim {

/// Seeds of which the causes of the error are found. kAuto: of the first one, as far as the trials
/// for it take a quarter of the time of all others.
enum class CauseSeeds { kNone, kAuto, kFirst, kAll };
/// By its name: none, auto, first or all. Errors: UserError `causes` for another.
CauseSeeds CauseSeedsOf(const std::string& name);

/// The trials for the causes of the error that a study runs.
struct CausePlan {
  bool switched = false;  // with one of kSwitchedCauses off at a time, and with the arm at rest
  bool chain = false;     // without one cause after the other, see ErrorCause
  int seeds = 0;          // of these, the first ones
  std::optional<std::size_t> controller = {};  // of this one alone
  std::optional<Eigen::Index> ticks = {};      // the first of the motion; none: all
  std::optional<double> stretch_s = {};        // the same
  double trials = 0.0;         // for one seed and controller; one that is cut counts as a part
  bool is_left_out = false;    // kAuto, and nothing is planned
  double cost_of_first = 0.0;  // trial time with CauseSeeds::kFirst in that without causes

  bool Has(std::size_t seed_index, std::size_t controller_index) const {
    return seed_index < static_cast<std::size_t>(seeds) &&
           controller.value_or(controller_index) == controller_index;
  }
};

/// The plan for this many seeds. The trials of kAuto take 0.25 of the time of the other trials at
/// most, noise-free reference runs included, as simulated seconds:
///
///     stretch = 0.25 * simulated time of the other trials / number of trials for causes
///
/// The stretch is the begin of the motion. Of it 4 s count, or it is the whole motion. Its RMS
/// speed is that of the motion, within 20 %. From there on, ratios of errors differ by 0.01 from
/// those of the whole motion (median over nine scenarios, at most 0.10; without the rule for the
/// speed 0.29). It is that of all controllers, else of the baseline alone; else nothing is planned.
/// A controller whose tracking error in the stretch is not that of its whole trial, within 20 %, is
/// left out.
CausePlan PlanCauses(const Study& study, int seeds, CauseSeeds asked);

/// Trials with one cause switched off, and with the arm at rest, of one controller and seed.
int SwitchedTrialsOf(const Study& study, int seed);
/// Trials without one cause after the other, of one controller and seed, without the noise-free
/// one.
int ChainTrialsOf(const Study& study);

}  // namespace gauntlet::sim
