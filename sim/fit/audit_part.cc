#include "sim/fit/audit_part.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/quantile.h"
#include "sim/fit/chain_episodes.h"
#include "sim/fit/chain_log.h"
#include "sim/tables/name_words.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The command with which a FollowFit compares row `n` of a part.
double DelayedCommand(const FollowRows& rows, Index n, double delay_rows) {
  const auto count = static_cast<std::size_t>(rows.command.size());
  return ValueAt({rows.command.data(), count}, static_cast<double>(n) - delay_rows);
}

constexpr double kStretch_s = 10.0;
constexpr double kShortest_s = 5.0;   // of a stretch
constexpr double kLeastRest_s = 2.5;  // of what is left at the end
constexpr double kMovingShare = 0.2;  // of the longest: the stretch counts
constexpr double kAnswer_s = 1.5;     // within which an angle moves after its command
constexpr double kMovesOn = 0.1;      // of the longest: a command that an angle does not follow
constexpr double kLook = 0.9;         // severity of what may have its reasons
constexpr Index kFewestRows = 20;
constexpr std::size_t kMostSamples = 8192;

double RangeOf(const VectorXd& values) {
  return values.size() == 0 ? 0.0 : values.maxCoeff() - values.minCoeff();
}

FollowRows Piece(const FollowRows& rows, Index first, Index count) {
  return {rows.command.segment(first, count), rows.angle.segment(first, count)};
}

/// Pieces of about 10 s; one for rows below 20 s. Each begins and ends `overlap_s` within its
/// neighbours.
std::vector<FollowRows> Pieces(const FollowRows& rows, double rate_hz, double overlap_s) {
  const Index count = rows.command.size();
  const Index overlap = std::lround(overlap_s * rate_hz);
  const double duration_s = static_cast<double>(count) / rate_hz;
  const auto pieces = std::max<Index>(1, static_cast<Index>(duration_s / kStretch_s));
  std::vector<FollowRows> result;
  for (Index i = 0; i < pieces; ++i) {
    const Index first = std::max<Index>(0, i * count / pieces - overlap);
    const Index end = std::min(count, (i + 1) * count / pieces + overlap);
    result.push_back(Piece(rows, first, end - first));
  }
  return result;
}

/// "in 4 of 50 episodes (3, 7, 9, 12)"; empty for the only one.
std::string EpisodesText(const std::set<double>& some, std::size_t all) {
  if (all == 1) return "";
  if (some.size() == all) return fmt::format(" in all {} episodes", all);
  return fmt::format(" in {} of {} episodes ({})", some.size(), all, NumbersText(some));
}

/// Some stretches of a data set.
struct Places {
  std::set<double> episodes;
  double first_s = HUGE_VAL, last_s = -HUGE_VAL;  // in their episodes

  void Add(const std::vector<double>& its_episodes, double its_first_s, double length_s) {
    episodes.insert(its_episodes.begin(), its_episodes.end());
    first_s = std::min(first_s, its_first_s);
    last_s = std::max(last_s, its_first_s + length_s);
  }
};

/// EpisodesText(); of one episode " from 200 to 300 s".
std::string PlacesText(const Places& places, std::size_t episodes) {
  return episodes == 1 ? fmt::format(" from {:.0f} to {:.0f} s", places.first_s, places.last_s)
                       : EpisodesText(places.episodes, episodes);
}

bool IsOpposite(const FollowFit& fit) {
  constexpr double kClearly = 0.8;
  constexpr double kBetter = 0.05;
  return fit.opposite > kClearly && fit.opposite > fit.correlation + kBetter;
}

/// "17.0 deg", "0.0512 units"
std::string ShortValue(double value, const std::string& unit) {
  return unit == "deg" ? fmt::format("{:.1f} deg", value) : fmt::format("{:.3g} {}", value, unit);
}

constexpr double kExplained = 0.7;  // of the variance: a line or a jump
constexpr double kAsGood = 0.1;     // of the same: a jump before a line

/// Values over something, as a line and as two levels.
struct Course {
  double line = 0.0, jump = 0.0;      // share of the variance that each explains
  double first = 0.0, last = 0.0;     // mean of the first and the last quarter
  double before = 0.0, behind = 0.0;  // levels of the jump
  std::ptrdiff_t at = 0;              // first value behind it
};

Course CourseOf(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr std::ptrdiff_t kFewest = 6;
  Course course;
  const std::ptrdiff_t count = std::ssize(y);
  if (count < kFewest) return course;
  std::vector<std::pair<double, double>> sorted;
  for (std::size_t i = 0; i < y.size(); ++i) sorted.emplace_back(x[i], y[i]);
  std::ranges::stable_sort(sorted, {}, &std::pair<double, double>::first);
  const auto mean_of = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
    double sum = 0.0;
    for (auto i = from; i < to; ++i) sum += sorted[static_cast<std::size_t>(i)].second;
    return sum / static_cast<double>(to - from);
  };
  const double mean = mean_of(0, count);
  double mean_x = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (const auto& [place, value] : sorted) mean_x += place / static_cast<double>(count);
  for (const auto& [place, value] : sorted) {
    xx += (place - mean_x) * (place - mean_x);
    xy += (place - mean_x) * (value - mean);
    yy += (value - mean) * (value - mean);
  }
  if (!(xx > 0.0) || !(yy > 0.0)) return course;
  course.line = xy * xy / xx / yy;
  course.first = mean_of(0, count / 4 + 1);
  course.last = mean_of(count - count / 4 - 1, count);
  for (std::ptrdiff_t at = 2; at + 2 <= count; ++at) {
    const double before = mean_of(0, at), behind = mean_of(at, count);
    const auto left = static_cast<double>(at), right = static_cast<double>(count - at);
    const double share =
        (left * (before - mean) * (before - mean) + right * (behind - mean) * (behind - mean)) / yy;
    if (share <= course.jump) continue;
    course.jump = share;
    course.before = before;
    course.behind = behind;
    course.at = at;
  }
  return course;
}

}  // namespace

std::string NumbersText(const std::set<double>& numbers) {
  constexpr std::size_t kMost = 4;
  std::vector<std::string> texts;
  for (const double number : numbers) {
    if (texts.size() == kMost && numbers.size() > kMost + 1) {
      texts.emplace_back("..");
      break;
    }
    texts.push_back(fmt::format("{:g}", number));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

void PartAudit::Add(const PartInRows& rows) {
  JudgeKind(rows);
  if (rows.stretches.empty()) empty_.insert(rows.episode);
  for (const FollowRows& whole : rows.stretches) {
    const double duration_s = static_cast<double>(whole.command.size()) / rows.rate_hz;
    longest_travel_ = std::max(longest_travel_, RangeOf(whole.command));
    if (duration_s < kShortest_s) {
      if (whole.command.size() < kFewestRows) continue;
      pending_.push_back(whole);
      pending_episodes_.push_back(rows.episode);
      pending_s_ += duration_s;
      pending_rate_hz_ = rows.rate_hz;
      if (pending_s_ >= kShortest_s) FinishPending();
      continue;
    }
    // An angle may move after the command did, or a command before the angle does.
    const std::vector<FollowRows> pieces = Pieces(whole, rows.rate_hz, kAnswer_s);
    const double length_s = duration_s / static_cast<double>(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      Fit({pieces[i]}, {rows.episode}, rows.rate_hz,
          rows.first_s + length_s * static_cast<double>(i), length_s);
    }
  }
}

void PartAudit::FinishPending() {
  if (pending_.empty()) return;
  Fit(pending_, pending_episodes_, pending_rate_hz_, 0.0, pending_s_);
  pending_.clear();
  pending_episodes_.clear();
  pending_s_ = 0.0;
}

void PartAudit::JudgeKind(const PartInRows& rows) {
  if (rows.raw.command.size() < kFewestRows) return;
  double first_s = rows.first_s;
  for (const FollowRows& piece : Pieces(rows.raw, rows.rate_hz, 0.0)) {
    const auto count = static_cast<std::size_t>(piece.command.size());
    const double from_s =
        std::exchange(first_s, first_s + static_cast<double>(count) / rows.rate_hz);
    const double travel = RangeOf(piece.command);
    if (!(travel > 0.0) || !(RangeOf(piece.angle) > 0.0)) continue;
    const std::span<const double> command(piece.command.data(), count);
    const std::span<const double> angle(piece.angle.data(), count);
    judged_.push_back({.kind = FindCommandKind(command, angle, rows.rate_hz),
                       .episode = rows.episode,
                       .travel = travel,
                       .copied = FindCopiedRows(command, angle),
                       .first_s = from_s,
                       .row_s = 1.0 / rows.rate_hz,
                       .rows = count});
  }
}

void PartAudit::Fit(const std::vector<FollowRows>& rows, const std::vector<double>& episodes,
                    double rate_hz, double first_s, double length_s) {
  Stretch stretch{
      .episodes = episodes, .first_s = first_s, .length_s = length_s, .rate_hz = rate_hz};
  for (const FollowRows& part : rows) {
    stretch.travel = std::max(stretch.travel, RangeOf(part.command));
    stretch.angle_travel = std::max(stretch.angle_travel, RangeOf(part.angle));
    const Index answered = std::min<Index>(std::lround(kAnswer_s * rate_hz), part.angle.size() / 2);
    stretch.later_travel =
        std::max(stretch.later_travel, RangeOf(part.angle.tail(part.angle.size() - answered)));
  }
  if (stretch.travel > 0.0 && stretch.angle_travel > 0.0) {
    stretch.fit = FitFollowing(rows, rate_hz);
    if (!correlation_) correlation_.emplace(rate_hz);
    for (const FollowRows& part : rows) correlation_->Add(part);
  }
  if (stretch.fit.is_known) {
    constexpr double kStill = 0.005;  // of the travel
    constexpr double kStill_s = 0.3;
    const auto settled = static_cast<Index>(
        std::max(kStill_s * rate_hz, 2.0 * std::abs(stretch.fit.delay_rows)) + 1.0);
    double squares = 0.0;
    std::vector<double> errors;
    for (const FollowRows& part : rows) {
      for (Index n = 0; n < part.command.size(); ++n) {
        errors.push_back(part.angle[n] - DelayedCommand(part, n, stretch.fit.delay_rows));
      }
    }
    stretch.offset = controller::MedianOf(errors);
    for (const FollowRows& part : rows) {
      stretch.place += part.command.sum() / static_cast<double>(errors.size());
    }
    std::vector<double> sizes;
    for (const double error : errors) sizes.push_back(std::abs(error));
    stretch.least_error = Quantile(std::move(sizes), 0.05);
    auto error_of_row = errors.begin();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const FollowRows& part = rows[i];
      Index still_since = 0;
      for (Index n = 0; n < part.command.size(); ++n) {
        if (std::abs(part.command[n] - part.command[still_since]) > kStill * stretch.travel) {
          still_since = n;
        }
        const double error = *error_of_row++;
        squares += error * error;
        if (n - still_since < settled) continue;
        stretch.rest_squares += std::pow(error - stretch.offset, 2);
        stretch.rest_rows += 1.0;
      }
      FindFreezes(part, episodes[i], rate_hz, stretch.fit);
      AddSamples(part, stretch.fit);
    }
    stretch.residual = std::sqrt(squares / static_cast<double>(errors.size()));
    if (stretch.residual > worst_residual_) {
      worst_residual_ = stretch.residual;
      worst_ = rows.front();
      worst_episode_ = episodes.front();
      worst_rate_hz_ = rate_hz;
    }
  }
  stretches_.push_back(std::move(stretch));
}

/// Runs of one angle in which the command moves on, far longer than the usual ones.
void PartAudit::FindFreezes(const FollowRows& rows, double episode, double rate_hz,
                            const FollowFit& fit) {
  constexpr double kShortestFreeze_s = 0.3;
  constexpr double kUsual = 4.0;  // times the median run
  struct Run {
    Index first, length;
    double travel;
  };
  std::vector<Run> runs;
  std::vector<double> lengths;
  for (Index n = 0; n < rows.angle.size();) {
    Index end = n + 1;
    double low = DelayedCommand(rows, n, fit.delay_rows), high = low;
    while (end < rows.angle.size() && rows.angle[end] == rows.angle[n]) {
      const double command = DelayedCommand(rows, end, fit.delay_rows);
      low = std::min(low, command);
      high = std::max(high, command);
      ++end;
    }
    const Run run{n, end - n, high - low};
    // A run of one row, too, counts where the command moves on to the next.
    const double next = DelayedCommand(rows, std::min(end, rows.angle.size() - 1), fit.delay_rows);
    if (next != low || next != high) lengths.push_back(static_cast<double>(run.length));
    if (run.travel > 0.0) runs.push_back(run);
    n = end;
  }
  if (lengths.empty()) return;
  const double least =
      std::max(kShortestFreeze_s * rate_hz, kUsual * controller::MedianOf(lengths));
  for (const Run& run : runs) {
    if (static_cast<double>(run.length) < least) continue;
    freezes_.push_back({episode, static_cast<double>(run.length) / rate_hz, run.travel});
  }
}

void PartAudit::AddSamples(const FollowRows& rows, const FollowFit& fit) {
  for (Index n = 0; n < rows.angle.size(); ++n) {
    if (sample_next_++ % sample_step_ != 0) continue;
    samples_.emplace_back(DelayedCommand(rows, n, fit.delay_rows), rows.angle[n]);
    if (samples_.size() < kMostSamples) continue;
    for (std::size_t i = 0; 2 * i < samples_.size(); ++i) samples_[i] = samples_[2 * i];
    samples_.resize((samples_.size() + 1) / 2);
    sample_step_ *= 2;
  }
}

bool PartAudit::Moves(const Stretch& stretch) const {
  return stretch.travel > 0.0 && stretch.travel >= kMovingShare * longest_travel_;
}

/// " in 48 % of the moving rows, from 12.3 s on", if so many are copies within stretches; else
/// empty.
std::string PartAudit::MixedRows(std::size_t episodes, double least_share) const {
  constexpr double kMostly = 0.8;
  constexpr double kAtEnd_s = 1.0;
  double moving = 0.0, copied = 0.0, between = 0.0, first_s = HUGE_VAL, last_s = 0.0, end_s = 0.0;
  bool any = false;
  std::set<double> where;
  for (const Judged& one : judged_) {
    const CopiedRows& rows = one.copied;
    end_s = one.first_s + static_cast<double>(one.rows) * one.row_s;
    moving += static_cast<double>(rows.moving);
    if (rows.copied == 0) continue;
    any |= one.kind == CommandKind::kMixed;
    copied += static_cast<double>(rows.copied);
    between += static_cast<double>(rows.between);
    where.insert(one.episode);
    first_s = std::min(first_s, one.first_s + static_cast<double>(rows.first) * one.row_s);
    last_s = std::max(last_s, one.first_s + static_cast<double>(rows.last) * one.row_s);
  }
  if (!any || !(copied >= least_share * moving)) return "";
  std::string place = EpisodesText(where, episodes);
  if (episodes == 1) {
    const bool is_all = copied >= kMostly * between;
    place = is_all && last_s > end_s - kAtEnd_s
                ? fmt::format(", from {:.1f} s on", first_s)
                : fmt::format(", {} {:.1f} {} {:.1f} s", is_all ? "from" : "between", first_s,
                              is_all ? "to" : "and", last_s);
  }
  return fmt::format(" in {:.2g} % of the moving rows{}", 100.0 * copied / moving, place);
}

/// The kind of the commands. True for a target.
bool PartAudit::NameKind(const std::vector<double>& episodes, AuditedPart& part) const {
  constexpr double kMostly = 0.8;
  constexpr double kHalf = 0.5;
  constexpr double kSome = 0.05;
  const auto is = [&](const char* kind, std::string text) {
    part.kind = kind;
    part.kind_text = std::move(text);
    return false;
  };
  double known = 0.0, opposite = 0.0, moving = 0.0, moving_s = 0.0, angle_travel = 0.0;
  std::vector<double> delays_rows;
  double rate_hz = 0.0;
  for (const Stretch& stretch : stretches_) {
    angle_travel = std::max(angle_travel, stretch.angle_travel);
    if (!Moves(stretch)) continue;
    rate_hz = stretch.rate_hz;
    moving += 1.0;
    moving_s += stretch.length_s;
    if (IsOpposite(stretch.fit)) {
      opposite += 1.0;
    } else if (stretch.fit.is_known) {
      known += 1.0;
      delays_rows.push_back(stretch.fit.delay_rows);
    }
  }
  constexpr double kNothing = 1e-3;  // of the command's travel
  if (stretches_.empty()) return is("missing", "it has no rows with values");
  if (!(longest_travel_ > 0.0)) {
    return angle_travel > 0.0 ? is("command_still", "its command does not move, but its angle does")
                              : is("still", "neither command nor angle moves");
  }
  if (!(angle_travel > kNothing * longest_travel_)) {
    return is("angle_still", "its angle does not move, but its command does");
  }
  double judged = 0.0;
  std::map<CommandKind, std::set<double>> by_kind;
  std::map<CommandKind, double> counts;
  for (const Judged& one : judged_) {
    if (one.travel < kMovingShare * longest_travel_) continue;
    judged += 1.0;
    counts[one.kind] += 1.0;
    by_kind[one.kind].insert(one.episode);
  }
  // Copies, and sums: the largest kind of a group stands for all of it.
  const auto group = [&](bool is_copy) {
    std::pair<CommandKind, double> all{CommandKind::kTarget, 0.0};
    double most = 0.0;
    for (const auto& [kind, count] : counts) {
      if (kind == CommandKind::kTarget || kind == CommandKind::kMixed) continue;
      if ((kind < CommandKind::kSteps) != is_copy) continue;
      all.second += count / judged;
      if (count <= most) continue;
      most = count;
      all.first = kind;
    }
    return all;
  };
  const auto [copy, copies] = group(true);
  const auto [sum, sums] = group(false);
  if (copies >= kMostly) return is(NameOf(copy), ProblemOf(copy, rate_hz));
  if (sums >= kHalf) return is(NameOf(sum), ProblemOf(sum, rate_hz));
  if (const std::string rows = MixedRows(episodes.size(), kSome); !rows.empty()) {
    return is("mixed", "its commands are copies of its angles" + rows);
  }
  if (copies > kSome && counts[copy] > 1.0) {
    return is("mixed", fmt::format("its commands are copies of its angles{}",
                                   EpisodesText(by_kind[copy], episodes.size())));
  }
  // Motions of few seconds are alike at some lag by chance, but not at the same.
  constexpr double kFew = 0.2;
  const double least = std::min(0.98, 0.5 + 0.3 / std::sqrt(std::max(0.1, moving_s / kStretch_s)));
  const double most = correlation_ ? correlation_->Largest(1.0) : 0.0;
  const bool is_short = moving_s < kStretch_s;
  if (opposite > kHalf * moving && known < kFew * moving &&
      (!is_short || correlation_->Largest(-1.0) > least)) {
    return is("opposite",
              "its angle falls where its command rises: turn the sign of one of the columns");
  }
  if (known < kFew * moving || delays_rows.empty() || most < least) {
    return is("unrelated",
              is_short ? fmt::format("its motion is too short to see how the angle follows "
                                     "(correlation {:.2f}, must be {:.2f})",
                                     most, least)
                       : fmt::format("its angle does not follow its command (correlation {:.2f} at "
                                     "the best delay)",
                                     most));
  }
  const double median_rows = controller::MedianOf(delays_rows);
  if (median_rows < -1.0) {
    return is("ahead", fmt::format("its angle is {:.1f} ms ahead of its command: are the columns "
                                   "exchanged?",
                                   -1e3 * median_rows / rate_hz));
  }
  part.kind = "target";
  part.kind_text = "targets";
  return true;
}

/// Stretches that are not as most: still, opposite, ahead, not followed, with copies.
void PartAudit::FindOddStretches(std::size_t episodes, AuditedPart& part) const {
  constexpr double kStillShare = 0.02;  // of the command's travel
  constexpr double kFollowed = 0.95;    // correlation of most stretches
  constexpr double kNotFollowed = 0.8;
  std::vector<double> correlations, delays_rows;
  for (const Stretch& stretch : stretches_) {
    if (!Moves(stretch) || !stretch.fit.is_known) continue;
    correlations.push_back(stretch.fit.correlation);
    delays_rows.push_back(stretch.fit.delay_rows);
  }
  const bool is_clear = controller::MedianOf(correlations) > kFollowed;
  const double usual_rows = controller::MedianOf(delays_rows);
  std::map<std::string, Places> odd;
  for (const Stretch& stretch : stretches_) {
    const FollowFit& fit = stretch.fit;
    std::string how;
    if (!Moves(stretch)) {
      const bool moves_alone = stretch.travel < kStillShare * longest_travel_ &&
                               stretch.later_travel > kMovingShare * longest_travel_;
      if (moves_alone) how = "moves without its command";
    } else if (stretch.angle_travel < kStillShare * stretch.travel) {
      how = "does not move with its command";
    } else if (IsOpposite(fit)) {
      how = "moves against its command";
    } else if (fit.is_known && fit.delay_rows < -1.0 && usual_rows > -0.5) {
      how = "is ahead of its command";
    } else if (is_clear && fit.correlation < kNotFollowed) {
      how = "does not follow its command";
    }
    if (!how.empty()) odd[how].Add(stretch.episodes, stretch.first_s, stretch.length_s);
  }
  for (const Judged& one : judged_) {
    const bool is_copy = one.kind != CommandKind::kTarget && one.kind < CommandKind::kSteps;
    if (!is_copy || episodes == 1 || one.travel < kMovingShare * longest_travel_) continue;
    odd["has copies of its angle as commands"].Add({one.episode}, 0.0, 0.0);
  }
  constexpr double kOdd = 2.8;
  if (const std::string rows = episodes == 1 ? MixedRows(1, 0.0) : ""; !rows.empty()) {
    part.faults.push_back({"odd", "has copies of its angle as commands" + rows, kOdd});
  }
  for (const auto& [how, places] : odd) {
    const bool may_touch = how.starts_with("does not") && MayTouch(places.episodes);
    part.faults.push_back({"odd", how + PlacesText(places, episodes), may_touch ? kLook : kOdd});
  }
  if (!empty_.empty()) {
    part.faults.push_back({"missing", "has no values" + EpisodesText(empty_, episodes), kOdd});
  }
}

/// A gripper or finger closes on objects: its angle stops before its command. So may any part that
/// stands still while its command moves, in most of these episodes, if there are several.
bool PartAudit::MayTouch(const std::set<double>& episodes) const {
  constexpr std::string_view kWords =
      "gripper grip jaw claw finger fingers hand thumb index middle ring little pinky mcp pip dip";
  if (HasWordOf(WordsOf(name_), kWords)) return true;
  if (judged_.empty() || judged_.front().episode == judged_.back().episode) return false;
  std::set<double> stopped;
  for (const Freeze& freeze : freezes_) {
    if (freeze.command_travel >= kMovesOn * longest_travel_ && episodes.contains(freeze.episode)) {
      stopped.insert(freeze.episode);
    }
  }
  return 2 * stopped.size() >= episodes.size() && !stopped.empty();
}

void PartAudit::FinishDelay(const std::vector<const Stretch*>& moving, AuditedPart& part) const {
  std::vector<double> delays_ms, errors_ms;
  for (const Stretch* const stretch : moving) {
    delays_ms.push_back(1e3 * stretch->fit.delay_rows / stretch->rate_hz);
    errors_ms.push_back(1e3 * stretch->fit.error_rows / stretch->rate_hz);
  }
  const CommonValue common = CommonOf(delays_ms, errors_ms);
  // The straight line between rows is no better: without this, intervals of many episodes held the
  // delay of long logs in 81 to 93 % of the cases.
  constexpr double kLeastError_rows = 0.02;
  const double half_width_ms =
      std::hypot(common.half_width, kLeastError_rows * 1e3 / moving.front()->rate_hz);
  part.delay_ms = {common.mean, common.mean - half_width_ms, common.mean + half_width_ms};
  part.delay_low_ms = Quantile(delays_ms, 0.05);
  part.delay_high_ms = Quantile(delays_ms, 0.95);
  constexpr double kLeastChange_ms = 10.0;
  constexpr double kLeastChange_rows = 0.3;
  const double period_ms = 1e3 / moving.front()->rate_hz;
  const double least_ms = std::max(kLeastChange_ms, kLeastChange_rows * period_ms);
  part.delay_limit_ms = least_ms;
  // Twice the spread on both sides of the mean: most stretches.
  if (!common.differs || 4.0 * common.spread < least_ms) return;
  part.delay_stays = false;
  std::vector<double> order, in_episode;
  for (const Stretch* const stretch : moving) {
    order.push_back(static_cast<double>(order.size()));
    in_episode.push_back(stretch->first_s);
  }
  const bool is_one = moving.front()->episodes == moving.back()->episodes;
  const std::string where = is_one ? "log" : "data set";
  const Course over_all = CourseOf(order, delays_ms),
               over_episode = CourseOf(in_episode, delays_ms);
  std::string how;
  if (over_all.jump > kExplained && over_all.jump > over_all.line - kAsGood) {
    const Stretch& at = *moving[static_cast<std::size_t>(over_all.at)];
    how = fmt::format("jumps from {:.0f} to {:.0f} ms at {}", over_all.before, over_all.behind,
                      is_one ? fmt::format("{:.0f} s", at.first_s)
                             : fmt::format("episode {:g}", at.episodes.front()));
  } else if (over_all.line > kExplained) {
    how = fmt::format("drifts from {:.0f} to {:.0f} ms over the {}", over_all.first, over_all.last,
                      where);
  } else if (!is_one && over_episode.line > kExplained) {
    how = fmt::format("drifts from {:.0f} to {:.0f} ms in each episode", over_episode.first,
                      over_episode.last);
  }
  // A drift is one of clocks or buffers; other changes may be those of the motion or its load.
  const bool drifts = !how.empty();
  if (!drifts) {
    const auto [least, most] = std::ranges::minmax(delays_ms);
    const bool is_rare = part.delay_high_ms - part.delay_low_ms < least_ms;
    how = is_rare ? fmt::format("is {:.0f} to {:.0f} ms, mostly {:.0f}", least, most,
                                Quantile(delays_ms, 0.5))
                  : fmt::format("varies from {:.0f} to {:.0f} ms", part.delay_low_ms,
                                part.delay_high_ms);
  }
  part.faults.push_back({"delay_varies", "has a delay that " + how, drifts ? 1.5 : kLook});
}

void PartAudit::FinishOffset(const std::vector<const Stretch*>& moving, const std::string& unit,
                             std::size_t episodes, AuditedPart& part) const {
  std::vector<double> offsets, gains, places, unexplained;
  double rest_squares = 0.0, rest_rows = 0.0, squares = 0.0;
  for (const Stretch* const stretch : moving) {
    offsets.push_back(stretch->offset);
    places.push_back(stretch->place);
    gains.push_back(stretch->fit.gain);
    squares += stretch->fit.residual_rms * stretch->fit.residual_rms;
    unexplained.push_back(std::sqrt(1.0 - std::min(1.0, std::pow(stretch->fit.correlation, 2))));
    rest_squares += stretch->rest_squares;
    rest_rows += stretch->rest_rows;
  }
  part.residual = std::sqrt(squares / static_cast<double>(moving.size()));
  part.offset = controller::MedianOf(offsets);
  constexpr double kLeast_deg = 1.0;
  part.offset_limit = std::max(kOffsetOfTravel * longest_travel_, unit == "deg" ? kLeast_deg : 0.0);
  part.gain = MeanOfEpisodes(gains);
  constexpr double kFewestRest = 20.0;
  if (rest_rows >= kFewestRest) part.rest_error = std::sqrt(rest_squares / rest_rows);
  constexpr double kMostUnexplained = 0.25;
  const double share = controller::MedianOf(unexplained);
  constexpr double kExact = 1e-4;
  if (share < kExact) {
    part.faults.push_back(
        {"exact",
         "equals its delayed command to the last digits: a simulation, or commands "
         "that were made of the angles",
         0.5});
  }
  if (share > kMostUnexplained) {
    part.faults.push_back({"unexplained",
                           fmt::format("moves by {:.0f} % other than its delayed command: contact, "
                                       "play or friction",
                                       100.0 * share),
                           kLook * share});
    // Little motion, or much else: the delay may vary by chance.
    for (AuditFault& fault : part.faults) fault.severity = std::min(fault.severity, kLook);
  }
  if (share > kMostUnexplained) return;
  constexpr double kLeastGain = 0.8;
  constexpr double kMostGain = 1.25;
  std::set<double> all;
  for (const Stretch* const stretch : moving) {
    all.insert(stretch->episodes.begin(), stretch->episodes.end());
  }
  if (part.gain.value < kLeastGain || part.gain.value > kMostGain) {
    part.faults.push_back({"gain",
                           fmt::format("moves {:.3g} times as far as its command", part.gain.value),
                           part.gain.value < 1.0 && MayTouch(all) ? kLook : 5.0});
    return;  // an offset depends on the place then
  }
  const double limit = part.offset_limit;
  Places off;
  std::vector<double> of_off;
  bool is_off_throughout = false;
  const double middle = controller::MedianOf(places);
  for (const Stretch* const stretch : moving) {
    // With another gain than 1, the error depends on the place.
    const double offset = stretch->offset - (part.gain.value - 1.0) * (stretch->place - middle);
    if (!(std::abs(offset) > limit)) continue;
    off.Add(stretch->episodes, stretch->first_s, stretch->length_s);
    of_off.push_back(offset);
    // A part that an object stops is not off where it moves freely.
    is_off_throughout |= stretch->least_error > 0.5 * std::abs(offset);
  }
  if (of_off.empty()) return;
  const double offset = controller::MedianOf(of_off);
  const bool everywhere = of_off.size() == moving.size() && episodes == 1;
  part.faults.push_back({"offset",
                         fmt::format("is {} off{}", ShortValue(offset, unit),
                                     everywhere ? "" : PlacesText(off, episodes)),
                         !is_off_throughout && MayTouch(off.episodes)
                             ? kLook
                             : 2.0 + std::abs(offset) / longest_travel_});
}

/// Commands or angles that end where the other goes on.
void PartAudit::FinishEnds(const std::string& unit, AuditedPart& part) const {
  constexpr std::size_t kFewest = 200;
  if (samples_.size() < kFewest) return;
  std::vector<std::pair<double, double>> sorted = samples_;
  std::ranges::sort(sorted);
  const std::size_t count = sorted.size();
  // The straight line of the middle half.
  double mean_c = 0.0, mean_a = 0.0, cc = 0.0, ca = 0.0;
  const std::size_t from = count / 4, to = count - count / 4;
  for (std::size_t i = from; i < to; ++i) {
    mean_c += sorted[i].first / static_cast<double>(to - from);
    mean_a += sorted[i].second / static_cast<double>(to - from);
  }
  for (std::size_t i = from; i < to; ++i) {
    cc += std::pow(sorted[i].first - mean_c, 2);
    ca += (sorted[i].first - mean_c) * (sorted[i].second - mean_a);
  }
  if (!(cc > 0.0) || !(ca > 0.0)) return;
  const double gain = ca / cc;
  const auto beyond = [&](const std::pair<double, double>& sample) {
    return sample.second - mean_a - gain * (sample.first - mean_c);
  };
  const double travel = sorted.back().first - sorted.front().first;
  const double limit = kOffsetOfTravel * travel;
  constexpr double kOften = 0.01;  // of the samples
  const auto least = std::max<std::size_t>(
      kFewestRows, static_cast<std::size_t>(kOften * static_cast<double>(count)));
  std::vector<std::string> clipped, stopped;
  for (const bool upper : {false, true}) {
    const double sign = upper ? 1.0 : -1.0;
    const double end = upper ? sorted.back().first : sorted.front().first;
    const auto farther = [&](double a, double b) {
      return upper ? std::max(a, b) : std::min(a, b);
    };
    std::vector<double> at_end;  // of commands that stay at their end
    double at_end_angle = -sign * HUGE_VAL, last_angle = at_end_angle;
    for (const auto& sample : sorted) {
      last_angle = farther(last_angle, sample.second);
      if (sample.first != end) continue;
      // Farther than the line of the others, and farther than the command itself.
      at_end.push_back(std::min(sign * beyond(sample), sign * (sample.second - end - part.offset)));
      at_end_angle = farther(at_end_angle, sample.second);
    }
    if (at_end.size() >= least && controller::MedianOf(at_end) > limit) {
      clipped.push_back(
          fmt::format("{:.4g} {} (the angle goes to {:.4g})", end, unit, at_end_angle));
      continue;
    }
    constexpr double kSame = 0.005;  // of the travel
    std::size_t missing = 0;         // angles that stay at their end
    for (const auto& sample : sorted) {
      const bool is_last = std::abs(sample.second - last_angle) <= kSame * travel;
      missing += is_last && -sign * beyond(sample) > limit ? 1 : 0;
    }
    if (missing >= least) {
      stopped.push_back(
          fmt::format("{:.4g} {} (the commands go to {:.4g})", last_angle, unit, end));
    }
  }
  const auto add = [&](const char* key, const char* what, const std::vector<std::string>& ends,
                       double severity) {
    if (ends.empty()) return;
    std::erase_if(part.faults, [](const AuditFault& fault) { return fault.key == "offset"; });
    part.faults.push_back({key, fmt::format("{} {}", what, fmt::join(ends, " and ")), severity});
  };
  add("clipped", "has commands that are clipped at", clipped, 3.0);
  add("stops", "stops at", stopped, 0.9 * kLook);
}

AuditedPart PartAudit::Finish(const std::vector<double>& episodes, const std::string& unit) {
  if (pending_s_ >= kLeastRest_s || stretches_.empty()) FinishPending();
  AuditedPart part;
  part.name = name_;
  part.unit = unit;
  part.travel = longest_travel_;
  part.worst = std::move(worst_);
  part.worst_episode = worst_episode_;
  part.worst_rate_hz = worst_rate_hz_;
  part.episodes.resize(episodes.size());
  if (!NameKind(episodes, part)) return part;
  std::vector<const Stretch*> moving, clear;
  constexpr double kClear = 0.9;  // correlation of a delay that counts
  for (const Stretch& stretch : stretches_) {
    if (!Moves(stretch) || !stretch.fit.is_known) continue;
    moving.push_back(&stretch);
    if (stretch.fit.correlation >= kClear) clear.push_back(&stretch);
  }
  if (2 * clear.size() >= moving.size()) FinishDelay(clear, part);
  FindOddStretches(episodes.size(), part);
  FinishOffset(moving, unit, episodes.size(), part);
  FinishEnds(unit, part);
  for (const Stretch* const stretch : moving) {
    for (const double episode : stretch->episodes) {
      const auto place = std::ranges::find(episodes, episode) - episodes.begin();
      AuditedEpisode& one = part.episodes[static_cast<std::size_t>(place)];
      // The stretch with the largest residual stands for its episode.
      if (one.residual >= stretch->residual) continue;
      const bool is_own = stretch->episodes.size() == 1;
      one = {.delay_ms = 1e3 * stretch->fit.delay_rows / stretch->rate_hz,
             .offset = stretch->offset,
             .residual = stretch->residual,
             .from_s = is_own ? stretch->first_s : kNaN,
             .to_s = is_own ? stretch->first_s + stretch->length_s : kNaN};
    }
  }
  if (!freezes_.empty()) {
    std::set<double> where;
    double longest_s = 0.0;
    for (const Freeze& freeze : freezes_) {
      if (freeze.command_travel < kMovesOn * longest_travel_) continue;
      where.insert(freeze.episode);
      longest_s = std::max(longest_s, freeze.length_s);
    }
    if (!where.empty())
      part.faults.push_back(
          {"stands_still",
           fmt::format("stands still for up to {:.1f} s while its command moves{}", longest_s,
                       EpisodesText(where, episodes.size())),
           kLook});
  }
  std::ranges::stable_sort(part.faults, std::ranges::greater(), &AuditFault::severity);
  return part;
}

}  // namespace gauntlet::sim
