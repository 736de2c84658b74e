#pragma once

#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/study/elsewhere.h"
#include "sim/study/study_identity.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// The trials of a comparison that are computed elsewhere: all but those of the first seed, whose
/// signals are wanted here. Take() waits for them. Trials whose part will not come are not there,
/// so that RunStudy() computes them.
///
/// Any thread may call it. Errors: Cancelled; RunError for a part of another study.
class AwaitedTrials final : public TrialStore {
 public:
  /// `kept`: where all trials are kept, and taken from if they are there; null: nowhere. `about`:
  /// see Elsewhere::Begin().
  AwaitedTrials(const Study& study, int seeds, Elsewhere& elsewhere, TrialStore* kept,
                const std::vector<std::string>& about = {});

  bool Has(int seed, std::size_t controller) override;
  std::optional<TrialOutcome> Take(int seed, std::size_t controller) override;
  void Keep(int seed, std::size_t controller, const TrialOutcome& outcome) override;

 private:
  using Key = std::pair<int, std::size_t>;  // seed, controller

  Key KeyOf(std::int64_t number) const;
  void Receive(const Elsewhere::Part& part);

  const Study& study_;
  const int seeds_;
  const StudyIdentity identity_;
  Elsewhere& elsewhere_;
  TrialStore* const kept_;
  std::vector<WorkRange> parts_;
  std::mutex mutex_;
  std::set<Key> awaited_;
  std::map<Key, TrialOutcome> arrived_;
};

}  // namespace gauntlet::sim
