#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "sim/study/study.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// Trials for the causes of the error that are no link, per controller and seed, without the
/// noise-free one.
inline constexpr int kCauseHands = 5;
/// Those and the trials for the links of a scenario, and for the arm of its hand.
int CauseTrialsOf(const Study& study);

/// The trials in which one cause of the error after the other is taken away, in the order of
/// ErrorCause, and the one in which the arm rests. Any thread may call it.
class CauseTrials {
 public:
  explicit CauseTrials(const Study& study) : study_(study) {}

  /// Trials of one controller with the glove of a seed. `noise_free`: the hand in the trial without
  /// noise, ticks x joints; empty for a recorded glove, of which neither noise nor errors are
  /// known. A hand that is stopped, too, is missing. `keep_going`: see TrialOptions; false:
  /// Cancelled.
  CauseAngles Run(const NamedController& named, int seed, const GloveSignal& glove,
                  const Signal& noise_free, const std::function<bool(double)>& progress);

 private:
  /// The hand without the causes up to this one, from kLink on. A controller that filters at events
  /// keeps their period, which its filter depends on.
  std::shared_ptr<const HandModel> HandWithout(ErrorCause cause, bool keeps_events);

  const Study& study_;
  std::mutex mutex_;
  std::map<std::pair<ErrorCause, bool>, std::shared_ptr<const HandModel>> hands_;
};

}  // namespace gauntlet::sim
