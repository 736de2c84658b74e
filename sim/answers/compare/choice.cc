#include "sim/answers/compare/choice.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace gauntlet::sim {

Choice::Choice(const Summary& summary) : summary_(summary) {
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    if (summary.controllers[c].has_score[PrimaryScores().front().metric]) all_.push_back(c);
  }
  for (const PrimaryScore& score : PrimaryScores()) {
    const bool whole = std::ranges::all_of(
        all_, [&](std::size_t c) { return summary.controllers[c].has_score[score.metric]; });
    (whole ? scores_ : left_out_).push_back(score.metric);
  }
  const std::optional<std::size_t>& baseline = summary.baseline;
  if (baseline && std::ranges::count(all_, *baseline) > 0 && KeepsBounds(*baseline)) {
    baseline_ = baseline;
  }
  if (summary.one_run) return;
  for (const std::size_t metric : scores_) {
    if (const auto candidate = CandidateFor(metric)) candidates_.emplace_back(metric, *candidate);
  }
  best_ = For(summary_.priority.metric);
  if (!best_) return;
  for (const std::size_t c : all_) {
    if (*best_ != c && KeepsBounds(c) && !IsBetter(*best_, c)) not_beaten_.push_back(c);
  }
  std::ranges::copy_if(not_beaten_, std::back_inserter(equivalent_),
                       [&](std::size_t c) { return IsEquivalent(*best_, c); });
}

std::optional<std::size_t> Choice::recommended() const {
  const bool is_earned =
      baseline_ || std::ranges::all_of(not_beaten_, [&](std::size_t c) {
        return std::ranges::count(equivalent_, c) > 0 && HasFewerReversals(*best_, c);
      });
  return is_earned ? best_ : std::nullopt;
}

Places Choice::any_of() const {
  if (!best_ || recommended() || not_beaten_.size() != equivalent_.size()) return {};
  Places any = {*best_};
  any.insert(any.end(), equivalent_.begin(), equivalent_.end());
  std::ranges::sort(any);
  return any;
}

Places Choice::not_beaten() const {
  if (!best_ || recommended()) return {};
  Places open = not_beaten_;
  open.push_back(*best_);
  std::ranges::sort(open);
  return open;
}

std::vector<std::pair<std::size_t, std::size_t>> Choice::alternatives() const {
  std::vector<std::pair<std::size_t, std::size_t>> better;
  const std::optional<std::size_t> best = recommended();
  for (const auto& [metric, c] : candidates_) {
    const bool is_new =
        std::ranges::find(better, c, &std::pair<std::size_t, std::size_t>::second) == better.end();
    if (best && is_new && JudgementOf(metric, c, *best) == Judgement::kBetter) {
      better.emplace_back(metric, c);
    }
  }
  return better;
}

double Choice::MostWorse(std::size_t metric, std::size_t c, std::size_t other) const {
  const MeanInterval& difference = summary_.Of(metric, c, other).difference;
  return Metrics()[metric].lower_is_better ? difference.high : -difference.low;
}

bool Choice::KeepsBounds(std::size_t c) const {
  return std::ranges::all_of(summary_.priority.bounds, [&](const Constraint& bound) {
    return bound.IsMetBy(summary_.controllers[c].summary[bound.metric].mean);
  });
}

bool Choice::IsBetter(std::size_t c, std::size_t other) const {
  return std::ranges::any_of(
      scores_, [&](std::size_t m) { return JudgementOf(m, c, other) == Judgement::kBetter; });
}

std::ptrdiff_t Choice::ScoresBelowBaseline(std::size_t c) const {
  if (!baseline_) return 0;
  return std::ranges::count_if(
      scores_, [&](std::size_t m) { return JudgementOf(m, c, *baseline_) == Judgement::kWorse; });
}

bool Choice::IsEquivalent(std::size_t c, std::size_t other) const {
  return std::ranges::all_of(
      scores_, [&](std::size_t m) { return JudgementOf(m, c, other) == Judgement::kEqual; });
}

bool Choice::IsNoWorse(std::size_t metric, std::size_t c, std::size_t other) const {
  const Judgement judgement = JudgementOf(metric, c, other);
  if (judgement != Judgement::kUndecided) return judgement != Judgement::kWorse;
  return MostWorse(metric, c, other) <= 2.0 * summary_.Of(metric, c, other).relevant_difference;
}

bool Choice::IsDominated(std::size_t c) const {
  return std::ranges::any_of(all_, [&](std::size_t other) {
    return KeepsBounds(other) && IsBetter(other, c) &&
           std::ranges::all_of(scores_, [&](std::size_t m) { return IsNoWorse(m, other, c); });
  });
}

std::optional<std::size_t> Choice::CandidateFor(std::size_t metric) const {
  Places left;
  for (const std::size_t c : all_) {
    const bool below_baseline =
        summary_.baseline && JudgementOf(metric, c, *summary_.baseline) == Judgement::kWorse;
    const bool is_earned = !baseline_ || c == *baseline_ || IsBetter(c, *baseline_);
    const bool is_candidate = KeepsBounds(c) && is_earned && !below_baseline && !IsDominated(c) &&
                              std::ranges::all_of(all_, [&](std::size_t other) {
                                return !KeepsBounds(other) || IsNoWorse(metric, c, other);
                              });
    if (is_candidate) left.push_back(c);
  }
  for (const std::size_t score : Places(scores_.rbegin(), scores_.rend())) {
    if (score != metric) KeepBest(score, left);
  }
  if (left.empty()) return std::nullopt;
  if (baseline_ && std::ranges::count(left, *baseline_) > 0) return baseline_;
  // Means of equals are chance, and change with the seeds. Of those that cost least against the
  // baseline, reversals differ if anything does.
  const std::size_t best = *Best(metric, left);
  std::erase_if(left, [&](std::size_t c) { return c != best && !IsEquivalent(c, best); });
  const std::ptrdiff_t least = ScoresBelowBaseline(
      *std::ranges::min_element(left, {}, [&](std::size_t c) { return ScoresBelowBaseline(c); }));
  std::erase_if(left, [&](std::size_t c) { return ScoresBelowBaseline(c) > least; });
  return *Best(reversals_, left);
}

Places::const_iterator Choice::Best(std::size_t metric, const Places& places) const {
  const double sign = Metrics()[metric].lower_is_better ? 1.0 : -1.0;
  return std::ranges::min_element(places, {}, [&](std::size_t c) {
    const double mean = summary_.controllers[c].summary[metric].mean;
    return std::isfinite(mean) ? sign * mean : std::numeric_limits<double>::infinity();
  });
}

void Choice::KeepBest(std::size_t metric, Places& places) const {
  if (places.empty()) return;
  const std::size_t best = *Best(metric, places);
  std::erase_if(places, [&](std::size_t c) { return !IsNoWorse(metric, c, best); });
}

std::optional<std::size_t> Choice::For(std::size_t metric) const {
  const auto found =
      std::ranges::find(candidates_, metric, &std::pair<std::size_t, std::size_t>::first);
  if (found == candidates_.end()) return std::nullopt;
  return found->second;
}

}  // namespace gauntlet::sim
