#include "sim/study/trial_table/awaited_trials.h"

#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/study/trial_table/study_database.h"

namespace gauntlet::sim {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 20ms;  // between two looks for a stop

}  // namespace

AwaitedTrials::AwaitedTrials(const Study& study, int seeds, Elsewhere& elsewhere, TrialStore* kept,
                             const std::vector<std::string>& about)
    : study_(study),
      seeds_(SeedsThatDiffer(study, seeds)),
      identity_(IdentityOf(study)),
      elsewhere_(elsewhere),
      kept_(kept) {
  const std::int64_t controllers = std::ssize(study.scenario.controllers);
  for (const WorkRange& part :
       Divide({controllers, controllers * seeds_}, elsewhere.most_parts())) {
    const auto before = awaited_.size();
    for (std::int64_t number = part.first; number < part.end; ++number) {
      const Key key = KeyOf(number);
      if (kept_ == nullptr || !kept_->Has(key.first, key.second)) awaited_.insert(key);
    }
    if (awaited_.size() > before) parts_.push_back(part);
  }
  elsewhere_.Begin(parts_, about);
}

AwaitedTrials::Key AwaitedTrials::KeyOf(std::int64_t number) const {
  const std::int64_t controllers = std::ssize(study_.scenario.controllers);
  return {study_.scenario.seed + static_cast<int>(number / controllers),
          static_cast<std::size_t>(number % controllers)};
}

void AwaitedTrials::Receive(const Elsewhere::Part& part) {
  std::optional<StudyDatabase> database;
  if (!part.database.empty()) {
    database.emplace(part.database, study_, identity_, StudyDatabaseOptions{.seeds = seeds_});
  }
  const WorkRange& range = parts_.at(part.number);
  for (std::int64_t number = range.first; number < range.end; ++number) {
    const Key key = KeyOf(number);
    if (awaited_.erase(key) == 0 || !database) continue;
    auto outcome = database->Take(key.first, key.second);
    if (!outcome) throw RunError(kOtherBuild);
    if (kept_ != nullptr) kept_->Keep(key.first, key.second, *outcome);
    arrived_[key] = std::move(*outcome);
  }
}

bool AwaitedTrials::Has(int seed, std::size_t controller) {
  const std::lock_guard lock(mutex_);
  const Key key = {seed, controller};
  return awaited_.contains(key) || arrived_.contains(key) ||
         (kept_ != nullptr && kept_->Has(seed, controller));
}

std::optional<TrialOutcome> AwaitedTrials::Take(int seed, std::size_t controller) {
  const Key key = {seed, controller};
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (auto found = arrived_.extract(key); !found.empty()) return std::move(found.mapped());
      if (!awaited_.contains(key)) {
        return kept_ == nullptr ? std::nullopt : kept_->Take(seed, controller);
      }
    }
    ThrowIfStopped();
    const std::optional<Elsewhere::Part> part = elsewhere_.Next(kPatience);
    if (!part) continue;
    const std::lock_guard lock(mutex_);
    Receive(*part);
  }
}

void AwaitedTrials::Keep(int seed, std::size_t controller, const TrialOutcome& outcome) {
  if (kept_ == nullptr) return;
  kept_->Keep(seed, controller, outcome);
  // What has come meanwhile is kept before a stop, too.
  while (const std::optional<Elsewhere::Part> part = elsewhere_.Next(0ms)) {
    const std::lock_guard lock(mutex_);
    Receive(*part);
  }
}

}  // namespace gauntlet::sim
