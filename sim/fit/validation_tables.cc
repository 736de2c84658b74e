#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "sim/base/json.h"
#include "sim/fit/chain_episodes.h"
#include "sim/fit/chain_log.h"
#include "sim/fit/fit_tables.h"
#include "sim/fit/validation.h"

namespace gauntlet::sim {
namespace {

// A servo that leaves more than this is not a model of the real one.
constexpr double kMostShareOfMotion = 0.15;
constexpr double kMostDelay_ms = 10.0;
constexpr double kMostOverRepeats = 1.5;

bool HasOtherDelay(const ValidatedPart& part) {
  return std::abs(part.delay_difference_ms.value) > kMostDelay_ms;
}

/// The interval of the difference does not contain 0.
bool IsDecided(const ChainEstimate& difference) {
  return difference.low > 0.0 || difference.high < 0.0;
}

/// Why the servo is no model of a part; empty if it is one, or if that is undecided.
std::string Doubt(const ValidatedPart& part) {
  std::vector<std::string> reasons;
  if (part.share_of_motion() > kMostShareOfMotion) {
    reasons.push_back(
        fmt::format("its error is {:.0f} % of the motion", 100.0 * part.share_of_motion()));
  }
  if (part.rms_deg > part.shifted_rms_deg) {
    reasons.push_back(fmt::format("its error is {:.2f} deg RMS, and {:.2f} by the delay alone",
                                  part.rms_deg, part.shifted_rms_deg));
  }
  if (HasOtherDelay(part) && IsDecided(part.delay_difference_ms)) {
    reasons.push_back(fmt::format("its delay is {:.0f} ms, measured {:.0f}",
                                  part.simulated_delay_ms, part.measured_delay_ms));
  }
  if (part.rms_deg > kMostOverRepeats * part.repeat_rms_deg) {
    reasons.push_back(fmt::format("its error is {:.1f} times the spread of repeated motions",
                                  part.rms_deg / part.repeat_rms_deg));
  }
  if (reasons.empty()) return "";
  constexpr std::array<const char*, 3> kWhen = {"while the command rests", "in slow motion",
                                                "in fast motion"};
  const auto most = std::ranges::max_element(part.speed_share) - part.speed_share.begin();
  return fmt::format("{}: {}; {:.0f} % of the squared error arises {}.", part.part,
                     Listed(std::move(reasons)), 100.0 * part.speed_share[most], kWhen[most]);
}

}  // namespace

Verdict VerdictOf(const Validation& validation) {
  Verdict verdict;
  std::vector<std::string> holds, failed, undecided;
  std::map<std::string, std::vector<std::string>> not_simulated;  // by problem
  double least = 1e9, most = 0.0, most_ms = 0.0;
  for (const ValidatedPart& part : validation.parts) {
    if (!part.problem.empty()) {
      not_simulated[part.problem].push_back(part.part);
      continue;
    }
    if (const std::string doubt = Doubt(part); !doubt.empty()) {
      failed.push_back(doubt);
      continue;
    }
    if (HasOtherDelay(part)) {
      undecided.push_back(part.part);
      continue;
    }
    holds.push_back(part.part);
    least = std::min(least, part.share_of_motion());
    most = std::max(most, part.share_of_motion());
    most_ms = std::max(most_ms, std::abs(part.simulated_delay_ms - part.measured_delay_ms));
  }
  const std::size_t all = validation.parts.size();
  if (holds.empty()) {
    verdict.AddReason("holds", "The simulated servo is a model of no part.");
  } else {
    verdict.AddHeadline(
        "holds",
        fmt::format("The simulated servo is a model of {} of {} part{}", holds.size(), all,
                    all == 1 ? "" : "s"),
        fmt::format(": error {} % of the motion in held-out episodes, delay within {:.1f} ms.",
                    RangeText({100.0 * least, 100.0 * most}, 0), most_ms));
    verdict.recommended = holds.size() == all ? "holds" : "holds in part";
  }
  for (const std::string& doubt : failed) verdict.AddWarning("does_not_hold", doubt);
  if (!undecided.empty()) {
    verdict.AddWarning("undecided",
                       fmt::format("Undecided for {}: the delay differs by more than {:g} ms, but "
                                   "no more than between episodes.",
                                   Listed(std::move(undecided)), kMostDelay_ms));
  }
  for (auto& [problem, parts] : not_simulated) {
    verdict.AddWarning("not_simulated",
                       fmt::format("Not simulated: {} ({}).", Listed(std::move(parts)), problem));
  }
  verdict.AddWarning("offset", OffsetsText(validation.identified));
  verdict.AddWarning("unit", validation.identified.log().unit_note);
  return verdict;
}

ResultTable ValidationTable(const Validation& validation) {
  const bool repeats = std::ranges::any_of(validation.parts, [](const ValidatedPart& part) {
    return std::isfinite(part.repeat_rms_deg);
  });
  ResultTable table{.columns = {{"part", "part"},
                                {"problem"},
                                {"episodes"},
                                {"measured_delay_ms", "delay measured", "ms"},
                                {"simulated_delay_ms", "delay simulated", "ms"},
                                IntervalColumn("delay_difference_ms", "", "ms"),
                                {"error_rms_deg", "error", "deg RMS"},
                                {"share_of_motion", "error of motion"},
                                {"shifted_rms_deg", "by delay alone", "deg RMS"},
                                {"repeat_rms_deg", repeats ? "spread of repeats" : "", "deg RMS"},
                                {"rest_share"},
                                {"slow_share"},
                                {"fast_share"}}};
  for (const ValidatedPart& part : validation.parts) {
    const double share = part.share_of_motion();
    table.rows.push_back(
        {ResultCell(part.part),
         ResultCell::IfAny(part.problem),
         ResultCell(static_cast<std::int64_t>(part.episodes)),
         FixedCell(part.measured_delay_ms, 1),
         FixedCell(part.simulated_delay_ms, 1),
         IntervalCell(part.delay_difference_ms, 1),
         FixedCell(part.rms_deg, 2),
         {{share}, std::isfinite(share) ? fmt::format("{:.0f} %", 100.0 * share) : "-"},
         FixedCell(part.shifted_rms_deg, 2),
         FixedCell(part.repeat_rms_deg, 2),
         FixedCell(part.speed_share[0], 2),
         FixedCell(part.speed_share[1], 2),
         FixedCell(part.speed_share[2], 2)});
  }
  return table;
}

ResultText ValidationText(const Validation& validation) {
  const ChainResult& identified = validation.identified;
  ResultText text = {fmt::format("{}: {} episodes, {:.1f} s at {:.6g} Hz",
                                 FileNameOf(identified.log()), identified.episodes.size(),
                                 identified.duration_s(), identified.log().rate_hz)};
  AddVerdict(VerdictOf(validation), text);
  text.emplace_back(ValidationTable(validation));
  AddLine(
      "Error: measured less simulated, in episodes that no fit contains. By delay alone: the "
      "command, shifted by the measured delay.",
      text);
  for (const std::string& left_out : identified.left_out) {
    AddLine("Left out: " + left_out + ".", text);
  }
  return text;
}

std::string ValidationJson(const Validation& validation) {
  const ChainResult& identified = validation.identified;
  const Json json = {
      {"log", identified.log().name},
      {"hand", validation.hand.empty() ? "one joint for each part" : validation.hand},
      {"episodes",
       {{"fitted", identified.fitted},
        {"held_out", identified.judged},
        {"left_out", identified.left_out}}},
      {"verdict", JsonOf(VerdictOf(validation))},
      {"parts", JsonOf(ValidationTable(validation))}};
  return json.dump(2) + "\n";
}

}  // namespace gauntlet::sim
