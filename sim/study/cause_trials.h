#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <utility>

#include "sim/study/cause_plan.h"
#include "sim/study/study.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// The trials for the causes of the error. Any thread may call it.
class CauseTrials {
 public:
  explicit CauseTrials(const Study& study) : study_(study) {}

  /// A trial of one controller with the glove of a seed, whose causes are found.
  struct Subject {
    const NamedController& named;
    int seed;
    const GloveSignal& glove;
    /// The hand in the trial without noise, ticks x joints; empty for a recorded glove, of which
    /// neither noise nor errors are known.
    const Signal& noise_free;
    const std::function<bool(double)>& progress;  // gets parts of trials; false: Cancelled
  };
  /// The trials of a plan. A hand that is stopped is missing.
  CauseAngles Run(const CausePlan& plan, const Subject& subject);

 private:
  using Causes = std::set<ErrorCause>;

  void RunSwitched(const Subject& subject, CauseAngles& angles);
  void RunChain(const Subject& subject, CauseAngles& angles);
  /// The hand without some of the causes from kLink on. A controller that filters at events keeps
  /// their period, which its filter depends on.
  std::shared_ptr<const HandModel> HandWithout(const Causes& causes, bool keeps_events);

  const Study& study_;
  std::mutex mutex_;
  std::map<std::pair<Causes, bool>, std::shared_ptr<const HandModel>> hands_;
};

}  // namespace gauntlet::sim
