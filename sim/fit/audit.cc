#include "sim/fit/audit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <thread>
#include <utility>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/base/threads.h"
#include "sim/fit/audit_part.h"
#include "sim/fit/fit_tables.h"
#include "sim/recordings/inspect/senders.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/name_words.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kBatchValues = 1e6;  // of the episodes that are held at once

/// Full turns after which a position begins anew, in the unit of the column.
std::vector<double> TurnsOf(const PartColumn& column, bool is_whole) {
  if (column.scale) return {360.0 / *column.scale};
  if (is_whole) return {360.0, 1024.0, 4096.0, 16384.0, 65536.0};
  return {360.0, 2.0 * 3.14159265358979323846};
}

/// Removes the jumps of a position that is counted within one turn. Result: their number;
/// `turn_found` receives the turn if there are any.
double Unwrap(const PartColumn& column, std::vector<double>& values, double& turn_found) {
  constexpr double kJump = 0.9;  // of a turn, between two rows
  const auto [least, most] = std::ranges::minmax(values);
  const double span = most - least;
  const bool is_whole =
      std::ranges::all_of(values, [](double value) { return value == std::floor(value); });
  for (const double turn : TurnsOf(column, is_whole)) {
    if (!(kJump * turn < span && span <= 1.001 * turn)) continue;
    double jumps = 0.0, shift = 0.0, before = values.front();
    std::vector<double> turned = values;
    for (double& value : turned) {
      const double step = value - before;
      before = value;
      if (std::abs(step) > kJump * turn) {
        jumps += 1.0;
        shift -= std::copysign(turn, step);
      }
      value += shift;
    }
    if (jumps > 0.0) {
      values = std::move(turned);
      turn_found = turn;
    }
    return jumps;
  }
  return 0.0;
}

/// Mean of the steps that are about as long as the median: times may be rounded to ms.
double PeriodOf(const std::vector<double>& steps_s) {
  const double median_s = controller::MedianOf(steps_s);
  double sum_s = 0.0, count = 0.0;
  for (const double step_s : steps_s) {
    if (std::abs(step_s - median_s) > 0.5 * median_s) continue;
    sum_s += step_s;
    count += 1.0;
  }
  return count > 0.0 ? sum_s / count : 0.0;
}

/// Watches the rows of all parts together.
class RowWatch {
 public:
  RowWatch(std::size_t parts, double every_s) : senders_(parts), period_s_(every_s) {}

  void Add(const EpisodeRows& rows, std::size_t parts) {
    AddClock(rows);
    const std::size_t count = rows.series.front().value.size();
    for (std::size_t i = 0; i < 2 * parts; ++i) {
      if (rows.series[i].value.size() != count) return;  // values are missing
    }
    const auto changes = [&](std::size_t row, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        if (rows.series[i].value[row] != rows.series[i].value[row - 1]) return true;
      }
      return false;
    };
    std::vector<bool> command(count, false), angle(count, false);
    std::vector<double> values(parts);
    for (std::size_t n = 0; n < count; ++n) {
      for (std::size_t i = 0; i < parts; ++i) values[i] = rows.series[i].value[n];
      senders_.Add(kNaN, values);
      if (n == 0) continue;
      command[n] = changes(n, 0, parts);
      angle[n] = changes(n, parts, 2 * parts);
    }
    // All angles stand still for a second, while commands change in most of the rows.
    for (std::size_t n = 1; n < count;) {
      std::size_t end = n;
      double moving = 0.0;
      while (end < count && !angle[end]) moving += command[end++] ? 1.0 : 0.0;
      const auto rows_of_run = static_cast<double>(end - n);
      if (rows_of_run * period_s_ >= kFrozen_s && rows_of_run >= kFrozenRows &&
          moving > 0.5 * rows_of_run && rows_of_run * period_s_ > frozen_s_) {
        frozen_s_ = rows_of_run * period_s_;
        frozen_from_s_ = rows.series.front().time_s[n] - rows.first_s;
        frozen_episode_ = rows.episode;
      }
      n = end + 1;
    }
    std::size_t last = 0;
    for (std::size_t n = 1; n < count; ++n) {
      if (!angle[n]) continue;
      if (last > 0 && n - last < gaps_.size()) gaps_[n - last] += 1.0;
      last = n;
    }
    for (std::size_t n = 2; n + 1 < count; ++n) {
      rows_ += 1.0;
      const bool repeats = !command[n] && !angle[n];
      const auto both = [&](std::size_t row) { return command[row] && angle[row]; };
      if (repeats && both(n - 1) && both(n + 1)) repeated_ += 1.0;
    }
    command_changes_ += static_cast<double>(std::ranges::count(command, true));
    angle_changes_ += static_cast<double>(std::ranges::count(angle, true));
  }

  void Finish(const std::vector<std::pair<std::size_t, double>>& commands,
              std::vector<AuditFault>& faults) const {
    // Changes of the angles that come at every n-th row, in turns of n and n + 1 at most.
    double all = 0.0, sum = 0.0;
    for (std::size_t gap = 0; gap < gaps_.size(); ++gap) {
      all += gaps_[gap];
      sum += static_cast<double>(gap) * gaps_[gap];
    }
    constexpr double kFewest = 20.0;
    constexpr double kNearlyAll = 0.8;
    constexpr double kLeastEvery = 1.25;
    if (all >= kFewest) {
      // The median does not count the gaps of an arm at rest.
      std::size_t middle = 0;
      double below = gaps_[0];
      while (below < 0.5 * all) below += gaps_[++middle];
      const std::size_t low =
          middle > 1 && gaps_[middle - 1] > gaps_[middle + 1] ? middle - 1 : middle;
      const double near = gaps_[low] + gaps_[low + 1];
      const double every =
          (static_cast<double>(low) * gaps_[low] + static_cast<double>(low + 1) * gaps_[low + 1]) /
          near;
      if (near >= kNearlyAll * all && every >= kLeastEvery &&
          command_changes_ > kLeastEvery * angle_changes_) {
        faults.push_back(
            {"state_is_held",
             fmt::format("The angles are read at every {:.3g} rows only ({:.3g} Hz): they are 0 to "
                         "{:.0f} ms older than their row, and the delays contain it",
                         every, 1.0 / (every * period_s_), 1e3 * (every - 1.0) * period_s_),
             1.0});
      }
    }
    constexpr double kMostRepeated = 0.005;
    if (repeated_ > kMostRepeated * rows_) {
      faults.push_back(
          {"repeated_rows",
           fmt::format("{:.2g} % of the rows repeat the row before", 100.0 * repeated_ / rows_),
           1.0});
    }
    if (frozen_s_ > 0.0) {
      faults.push_back({"frozen",
                        fmt::format("all angles stand still for {:.1f} s from {:.1f} s of episode "
                                    "{:g} on while commands move",
                                    frozen_s_, frozen_from_s_, frozen_episode_),
                        2.6});
    }
    if (gaps_in_time_ > 0.0) {
      faults.push_back({"gaps",
                        fmt::format("{:g} gap{} in time, up to {:.3g} s", gaps_in_time_,
                                    gaps_in_time_ == 1.0 ? "" : "s", longest_gap_s_),
                        1.0});
    }
    if (const auto senders = senders_.Find(SIZE_MAX, commands)) {
      faults.push_back({"two_senders", "the commands have " + TextOf(*senders), 4.0});
    }
  }

 private:
  void AddClock(const EpisodeRows& rows) {
    const double longest_s = std::max(0.1, 10.0 * period_s_);  // as in LoadChainEpisodes()
    for (const double step_s : rows.steps_s) {
      if (step_s <= longest_s) continue;
      gaps_in_time_ += 1.0;
      longest_gap_s_ = std::max(longest_gap_s_, step_s);
    }
  }

  static constexpr double kFrozen_s = 1.0;
  static constexpr double kFrozenRows = 10.0;
  SenderWatch senders_;
  double period_s_;
  double frozen_s_ = 0.0, frozen_from_s_ = 0.0, frozen_episode_ = 0.0;
  std::array<double, 64> gaps_ = {};  // rows between changes of the angles
  double rows_ = 0.0;
  double repeated_ = 0.0;
  double command_changes_ = 0.0;
  double angle_changes_ = 0.0;
  double gaps_in_time_ = 0.0;
  double longest_gap_s_ = 0.0;
};

/// How alike each command and each angle are, at some lags.
class OtherParts {
 public:
  explicit OtherParts(std::size_t parts) : parts_(static_cast<Index>(parts)) {}

  void Add(const std::vector<const FollowRows*>& rows, double rate_hz) {
    if (parts_ > kMost || parts_ < 2) return;
    const Index count = rows.front()->command.size();
    Eigen::MatrixXd c(count, parts_), a(count, parts_);
    for (Index i = 0; i < parts_; ++i) {
      const FollowRows& part = *rows[static_cast<std::size_t>(i)];
      if (part.command.size() != count) return;
      c.col(i) = part.command.array() - part.command.mean();
      a.col(i) = part.angle.array() - part.angle.mean();
    }
    for (std::size_t l = 0; l < kLags_s.size(); ++l) {
      const Index lag = std::lround(kLags_s[l] * rate_hz);
      if (2 * lag > count) break;
      if (sums_[l].size() == 0) sums_[l] = Eigen::MatrixXd::Zero(parts_, parts_);
      sums_[l] += c.topRows(count - lag).transpose() * a.bottomRows(count - lag);
    }
    if (of_commands_.size() == 0) {
      of_commands_ = VectorXd::Zero(parts_);
      of_angles_ = VectorXd::Zero(parts_);
    }
    of_commands_ += c.colwise().squaredNorm().transpose();
    of_angles_ += a.colwise().squaredNorm().transpose();
  }

  /// The other part whose commands an angle follows; none if there is no clear one.
  std::optional<std::size_t> LeaderOf(std::size_t part) const {
    constexpr double kClearly = 0.9;
    if (of_commands_.size() == 0) return std::nullopt;
    const auto angle = static_cast<Index>(part);
    std::optional<std::size_t> best;
    double most = kClearly;
    for (const Eigen::MatrixXd& sums : sums_) {
      if (sums.size() == 0) continue;
      for (Index other = 0; other < parts_; ++other) {
        const double norm = std::sqrt(of_commands_[other] * of_angles_[angle]);
        if (other == angle || !(norm > 0.0) || sums(other, angle) / norm <= most) continue;
        most = sums(other, angle) / norm;
        best = static_cast<std::size_t>(other);
      }
    }
    return best;
  }

 private:
  static constexpr Index kMost = 64;
  static constexpr std::array<double, 11> kLags_s = {0.0, 0.05, 0.1, 0.15, 0.2, 0.3,
                                                     0.4, 0.5,  0.7, 0.9,  1.2};
  Index parts_;
  std::array<Eigen::MatrixXd, kLags_s.size()> sums_;  // command x angle
  VectorXd of_commands_, of_angles_;
};

/// The audit of one log while it is read.
class Auditor {
 public:
  Auditor(const EpisodeReader& reader, const ChainLogOptions& options)
      : columns_(reader.columns()), parts_(reader.parts()), options_(options) {
    for (const PartColumn& command : columns_.commands) audits_.emplace_back(command.part);
    others_.emplace(audits_.size());
  }

  void Add(EpisodeRows rows) {
    rows_ += rows.count;
    found_.insert(rows.episode);
    rows_missing_ += static_cast<double>(rows.rows_missing);
    for (std::size_t i = 0; i < 2 * audits_.size(); ++i) {
      if (static_cast<double>(rows.series[i].value.size()) < rows.count) {
        parts_missing_.insert(i % audits_.size());
      }
    }
    const double period_s = rows.steps_s.size() + 1 < kFewestRows ? 0.0 : PeriodOf(rows.steps_s);
    if (!(period_s > 0.0)) {
      short_.insert(rows.episode);
      return;
    }
    if (period_s_ == 0.0) {
      period_s_ = period_s;
      watch_.emplace(audits_.size(), period_s);
    }
    episodes_.push_back(rows.episode);
    duration_s_ += rows.last_s - rows.first_s + period_s;
    values_ += static_cast<double>(rows.steps_s.size() * parts_.size());
    batch_.push_back({std::move(rows), period_s});
    if (values_ > kBatchValues) FinishBatch();
  }

  /// `info`: what the data set should have.
  Audit Finish(const EpisodeReader& reader, const std::string& name, const DatasetInfo& info);

 private:
  static constexpr std::size_t kFewestRows = 10;
  struct Batched {
    EpisodeRows rows;
    double period_s;
  };

  void FindUnits();
  PartInRows RowsOf(const Batched& one, std::size_t part);
  void FinishBatch();
  void NameOthers(std::vector<AuditedPart>& parts) const;
  void NameMissing(const DatasetInfo& info, std::vector<AuditFault>& faults) const;

  const ChainColumns& columns_;
  const std::vector<PartColumn>& parts_;
  const ChainLogOptions& options_;
  std::vector<PartAudit> audits_;
  std::optional<OtherParts> others_;
  std::optional<RowWatch> watch_;
  std::vector<Batched> batch_;
  std::vector<double> episodes_;
  double values_ = 0.0;
  double period_s_ = 0.0;
  double duration_s_ = 0.0;
  double rows_ = 0.0;
  double rows_missing_ = 0.0;  // with a missing value
  std::set<std::size_t> parts_missing_;
  std::set<double> found_, short_;  // episodes
  std::vector<double> wraps_;       // by part
  UnitOfLog unit_;                  // of columns without one of their own
  std::vector<std::string> units_;  // by part
  std::vector<double> travel_;      // of the commands, in the file's unit, by part
};

/// The word for a length at the end of a name: m of gripper_m; else empty.
std::string LengthOf(const std::string& name) {
  const std::vector<std::string> words = WordsOf(name);
  const bool is_length = words.size() > 1 && HasWordOf({words.back()}, "m mm cm");
  return is_length ? words.back() : "";
}

/// Units of the parts, by the first rows. What is said or assumed of all angles holds for no
/// gripper in metres among them.
void Auditor::FindUnits() {
  constexpr std::string_view kGrippers = "gripper grippers grip jaw jaws claw";
  constexpr double kMostGrip = 0.3;  // m
  constexpr double kFarther = 3.0;   // the median of all parts moves
  const std::size_t parts = audits_.size();
  std::vector<double> most(parts, 0.0), travel(parts, 0.0);
  double most_unnamed = 0.0;
  ChainColumns unnamed = columns_;
  unnamed.commands.clear();
  unnamed.angles.clear();
  const auto has_own = [&](std::size_t part) {
    return parts_[part].scale && parts_[parts + part].scale;
  };
  for (std::size_t part = 0; part < parts; ++part) {
    for (const Batched& one : batch_) {
      for (const std::size_t at : {part, parts + part}) {
        const std::vector<double>& values = one.rows.series[at].value;
        if (values.empty()) continue;
        const auto [low, high] = std::ranges::minmax(values);
        most[part] = std::max({most[part], -low, high});
        travel[part] = std::max(travel[part], high - low);
      }
    }
    if (has_own(part) || !LengthOf(parts_[part].part).empty()) continue;
    most_unnamed = std::max(most_unnamed, most[part]);
    unnamed.commands.push_back(parts_[part]);
    unnamed.angles.push_back(parts_[parts + part]);
  }
  unit_ = UnitOf(unnamed, most_unnamed, options_.unit);
  if (!unit_.is_known) {
    unit_.note =
        fmt::format("The unit is unknown (values up to {:.4g}): see --unit.", most_unnamed);
  }
  const double usual = controller::MedianOf(travel);
  for (std::size_t part = 0; part < parts; ++part) {
    const std::string length = LengthOf(parts_[part].part);
    const bool is_grip = HasWordOf(WordsOf(parts_[part].part), kGrippers) &&
                         most[part] < kMostGrip && usual > kFarther * travel[part];
    units_.push_back(has_own(part)                ? "deg"
                     : !length.empty()            ? length
                     : unit_.is_known && !is_grip ? "deg"
                                                  : "units");
  }
}

/// The rows that have both values; empty if most do not.
FollowRows SameRows(const ColumnSeries& command, const ColumnSeries& angle) {
  std::vector<double> commands, angles;
  for (std::size_t c = 0, a = 0; c < command.value.size() && a < angle.value.size();) {
    if (command.time_s[c] == angle.time_s[a]) {
      commands.push_back(command.value[c++]);
      angles.push_back(angle.value[a++]);
    } else {
      ++(command.time_s[c] < angle.time_s[a] ? c : a);
    }
  }
  if (2 * commands.size() <= std::max(command.value.size(), angle.value.size())) return {};
  return {Eigen::Map<const VectorXd>(commands.data(), std::ssize(commands)),
          Eigen::Map<const VectorXd>(angles.data(), std::ssize(angles))};
}

/// A part's rows at an even rate. Also counts its wraps.
PartInRows Auditor::RowsOf(const Batched& one, std::size_t part) {
  const std::size_t angle_at = audits_.size() + part;
  PartInRows result{.episode = one.rows.episode,
                    .rate_hz = 1.0 / one.period_s,
                    .first_s = one.rows.first_s,
                    .stretches = {},
                    .raw = {}};
  std::array<ColumnSeries, 2> series;
  double turn = 0.0;  // of a position that is counted within it
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
    const std::size_t at = k == 0 ? part : angle_at;
    series[k] = one.rows.series[at];
    if (series[k].value.empty()) return result;
    wraps_[part] += Unwrap(parts_[at], series[k].value, turn);
  }
  if (turn > 0.0) {
    const double apart =
        controller::MedianOf(series[1].value) - controller::MedianOf(series[0].value);
    for (double& value : series[1].value) value -= turn * std::round(apart / turn);
  }
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
    const std::size_t at = k == 0 ? part : angle_at;
    if (k == 0) {
      const auto [least, most] = std::ranges::minmax(series[k].value);
      travel_[part] = std::max(travel_[part], most - least);
    }
    const double scale = units_[part] == "deg" ? parts_[at].scale.value_or(unit_.scale) : 1.0;
    for (double& value : series[k].value) value = scale * value + parts_[at].offset_deg;
  }
  const std::vector<double>& times = series[1].time_s;
  const double rows_of_time = (times.back() - times.front()) / one.period_s;
  result.raw = SameRows(series[0], series[1]);
  bool is_even = series[0].time_s == times;
  constexpr double kUneven = 0.1;  // of the period
  for (std::size_t n = 1; is_even && n < times.size(); ++n) {
    const double due_s = times.front() + static_cast<double>(n) * one.period_s;
    is_even = std::abs(times[n] - due_s) < kUneven * one.period_s;
  }
  if (is_even) {
    result.stretches.push_back(result.raw);
    return result;
  }
  const double longest_gap_s = std::max(0.1, 10.0 * one.period_s);
  constexpr double kMostRows = 20.0;  // per row of the file
  if (!(rows_of_time <= kMostRows * static_cast<double>(times.size()))) return result;
  std::size_t first = 0;
  for (std::size_t n = 1; n <= times.size(); ++n) {
    if (n < times.size() && times[n] - times[n - 1] <= longest_gap_s) continue;
    const auto count =
        static_cast<Index>(std::lround((times[n - 1] - times[first]) / one.period_s)) + 1;
    if (count >= static_cast<Index>(kFewestRows)) {
      FollowRows rows{VectorXd(count), VectorXd(count)};
      ToEvenRows(series[0], true, times[first], result.rate_hz, rows.command);
      ToEvenRows(series[1], false, times[first], result.rate_hz, rows.angle);
      result.stretches.push_back(std::move(rows));
    }
    first = n;
  }
  return result;
}

void Auditor::FinishBatch() {
  const std::size_t parts = audits_.size();
  wraps_.resize(parts);
  travel_.resize(parts);
  if (units_.empty()) FindUnits();
  std::vector<std::vector<PartInRows>> rows(parts);
  ForEachOnThreads(std::max(1U, std::thread::hardware_concurrency()), parts + 1,
                   [&](std::size_t part) {
                     if (part == parts) {
                       for (const Batched& one : batch_) watch_->Add(one.rows, parts);
                       return;
                     }
                     for (const Batched& one : batch_) {
                       rows[part].push_back(RowsOf(one, part));
                       audits_[part].Add(rows[part].back());
                     }
                   });
  for (std::size_t e = 0; e < batch_.size(); ++e) {
    const std::size_t pieces = rows.front()[e].stretches.size();
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      std::vector<const FollowRows*> of_parts;
      for (std::size_t part = 0; part < parts; ++part) {
        if (rows[part][e].stretches.size() == pieces) {
          of_parts.push_back(&rows[part][e].stretches[piece]);
        }
      }
      if (of_parts.size() == parts) others_->Add(of_parts, rows.front()[e].rate_hz);
    }
  }
  batch_.clear();
  values_ = 0.0;
}

/// Angles without a command of their own that follow another part's.
void Auditor::NameOthers(std::vector<AuditedPart>& parts) const {
  for (std::size_t part = 0; part < parts.size(); ++part) {
    // A gain far from 1 is that of a motion that is alike by chance.
    constexpr double kLeastGain = 0.4;
    constexpr double kMostGain = 2.5;
    AuditedPart& one = parts[part];
    const bool is_odd =
        one.is_target() && (one.gain.value < kLeastGain || one.gain.value > kMostGain);
    if (one.kind != "unrelated" && !is_odd) continue;
    const auto leader = others_->LeaderOf(part);
    if (!leader) continue;
    one.kind = "other_part";
    one.kind_text = "its angle follows the command of " + parts[*leader].name;
    one.delay_ms = one.gain = {};
    one.delay_low_ms = one.delay_high_ms = one.offset = one.rest_error = one.residual = kNaN;
    one.faults.clear();
    std::ranges::fill(one.episodes, AuditedEpisode());
  }
}

void Auditor::NameMissing(const DatasetInfo& info, std::vector<AuditFault>& faults) const {
  if (rows_missing_ > 0.0) {
    std::vector<std::string> names;
    for (const std::size_t part : parts_missing_) names.push_back(columns_.commands[part].part);
    faults.push_back({"missing_values",
                      fmt::format("{:g} of {:g} rows have no value of {}", rows_missing_, rows_,
                                  FirstNames(std::move(names))),
                      1.0});
  }
  if (!short_.empty()) {
    const bool is_one = short_.size() == 1;
    faults.push_back({"short_episodes",
                      fmt::format("{} episode{} fewer than {} rows and {} left out ({})",
                                  short_.size(), is_one ? " has" : "s have", kFewestRows,
                                  is_one ? "is" : "are", NumbersText(short_)),
                      1.0});
  }
  if (options_.episode) return;
  std::set<double> missing;
  constexpr double kMostNamed = 1e6;  // of a damaged file
  const auto named = static_cast<int>(std::clamp(info.episodes, 0.0, kMostNamed));
  for (int number = 0; number < named; ++number) {
    if (!found_.contains(number)) missing.insert(number);
  }
  if (!missing.empty()) {
    faults.push_back({"missing_episodes",
                      fmt::format("meta/info.json names {:g} episodes, {} are missing ({})",
                                  info.episodes, missing.size(), NumbersText(missing)),
                      1.0});
  } else if (info.rows > rows_) {
    faults.push_back({"missing_rows",
                      fmt::format("meta/info.json names {:g} rows, {:g} are missing", info.rows,
                                  info.rows - rows_),
                      1.0});
  }
}

Audit Auditor::Finish(const EpisodeReader& reader, const std::string& name,
                      const DatasetInfo& info) {
  if (!batch_.empty()) FinishBatch();
  if (episodes_.empty()) reader.csv().Fail(1, "no episode has ten rows");
  Audit audit;
  audit.name = name;
  audit.episodes = episodes_;
  audit.duration_s = duration_s_;
  audit.rate_hz = 1.0 / period_s_;
  audit.ignored = columns_.ignored;
  audit.unit = unit_.is_known ? "deg" : "units";
  audit.unit_note = unit_.note;
  for (const std::string& remark : reader.remarks()) {
    audit.unit_note += (audit.unit_note.empty() ? "" : " ") + remark;
  }
  for (std::size_t part = 0; part < audits_.size(); ++part) {
    audit.parts.push_back(audits_[part].Finish(episodes_, units_[part]));
    if (wraps_[part] > 0.0) {
      audit.parts.back().faults.push_back(
          {"wraps",
           fmt::format("jumps by a full turn {:g} time{}, which is compensated here", wraps_[part],
                       wraps_[part] == 1.0 ? "" : "s"),
           2.0});
    }
  }
  NameOthers(audit.parts);
  std::vector<std::pair<std::size_t, double>> commands;
  for (std::size_t part = 0; part < travel_.size(); ++part) {
    if (travel_[part] > 0.0) commands.emplace_back(part, travel_[part]);
  }
  watch_->Finish(commands, audit.faults);
  NameMissing(info, audit.faults);
  return audit;
}

}  // namespace

Audit AuditLog(const std::filesystem::path& file, const ChainLogOptions& options,
               const AuditProgress& progress) {
  EpisodeReader reader(file, options);
  Auditor auditor(reader, options);
  for (EpisodeRows rows; reader.Next(rows);) {
    auditor.Add(std::move(rows));
    const double share = reader.csv().share_read();
    if (progress && std::isfinite(share)) progress(share);
  }
  const bool is_folder_with_slash = !file.has_filename();
  const std::filesystem::path name =
      is_folder_with_slash ? file.parent_path().filename() : file.filename();
  std::error_code ignored;
  const bool is_data_set = std::filesystem::is_directory(file / "meta", ignored);
  return auditor.Finish(reader, OneLine(name.string()),
                        is_data_set ? DatasetInfoOf(file) : DatasetInfo());
}

}  // namespace gauntlet::sim
