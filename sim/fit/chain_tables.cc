#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <utility>

#include "controller/prediction/horizon.h"
#include "sim/base/json.h"
#include "sim/fit/audit.h"
#include "sim/fit/chain_episodes.h"
#include "sim/fit/fit_tables.h"
#include "sim/fit/follow_fit.h"

namespace gauntlet::sim {
namespace {

/// A quantity of a chain, with so many digits behind the point.
struct Quantity {
  const char* key;
  const char* heading;
  const char* unit;
  ChainEstimate ChainFit::*estimate;
  int digits;
  bool rare = false;  // few logs determine it: no column for a person if none does
};

constexpr Quantity kQuantities[] = {
    {"delay_ms", "delay", "ms", &ChainFit::delay_ms, 1},
    {"dead_time_ms", "dead time", "ms", &ChainFit::dead_time_ms, 1},
    {"lag_ms", "lag", "ms", &ChainFit::lag_ms, 1},
    {"natural_frequency_hz", "frequency", "Hz", &ChainFit::natural_frequency_hz, 1},
    {"damping_ratio", "damping", "", &ChainFit::damping_ratio, 2},
    {"gain", "gain", "", &ChainFit::gain, 3},
    {"offset_deg", "offset", "deg", &ChainFit::offset_deg, 2},
    {"speed_limit_deg_s", "speed limit", "deg/s", &ChainFit::speed_limit_deg_s, 0, true},
    {"hysteresis_deg", "hysteresis", "deg", &ChainFit::hysteresis_deg, 2},
    {"motor_hysteresis_deg", "of motor", "deg", &ChainFit::motor_hysteresis_deg, 2, true},
    {"lost_motion_deg", "lost motion", "deg", &ChainFit::lost_motion_deg, 2, true}};

/// A key or unit of degrees; `units` if the log's unit is unknown.
std::string InUnitOf(const ChainLog& log, std::string text) {
  const auto at = text.find("deg");
  if (!log.unit_known && at != std::string::npos) text.replace(at, 3, "units");
  return text;
}

bool HasSpeedLimit(const std::vector<ChainFit>& fits) {
  return std::ranges::any_of(
      fits, [](const ChainFit& fit) { return std::isfinite(fit.speed_limit_deg_s.value); });
}

/// The table that answers: no model, no remarks.
ResultTable DelayTable(const ChainLog& log, const std::vector<ChainFit>& fits,
                       const IdentifiedChain& chain) {
  const std::string unit = InUnitOf(log, "deg");
  const bool is_limited = HasSpeedLimit(fits);
  ResultTable table{.columns = {ForPeople("part"), ForPeople("delay (95 % CI)", "ms"),
                                ForPeople(is_limited ? "dead time (95 % CI)" : "", "ms"),
                                ForPeople(is_limited ? "speed limit" : "", unit + "/s"),
                                ForPeople("horizon", "ms"), ForPeople("offset", unit),
                                ForPeople("hysteresis", unit),
                                ForPeople("residual", unit + " RMS")}};
  const auto fixed = [](double value, int digits) {
    return ResultCell::Text(FixedText(value, digits));
  };
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const ChainFit& fit = fits[i];
    const bool is_known = fit.problem.empty() && fit.split_problem.empty();
    table.rows.push_back({ResultCell::Text(log.parts[i]), IntervalCell(fit.delay_ms, 1),
                          IntervalCell(fit.dead_time_ms, 1), fixed(fit.speed_limit_deg_s.value, 0),
                          fixed(chain.horizon_ms.empty() ? kNaN : chain.horizon_ms[i], 1),
                          fixed(fit.offset_deg.value, 2), fixed(fit.hysteresis_deg.value, 2),
                          fixed(is_known ? fit.held_out_rms_deg : kNaN, 2)});
  }
  return table;
}

std::string CountOf(std::size_t count, std::size_t all) {
  return all == 1 ? "" : fmt::format(" of {} of {} parts", count, all);
}

/// One sentence with the values that most logs determine and this one does not.
std::string WithheldText(const std::vector<ChainFit>& fits) {
  const auto without = [&](auto estimate) {
    return static_cast<std::size_t>(std::ranges::count_if(fits, [&](const ChainFit& fit) {
      return fit.problem.empty() && std::isnan((fit.*estimate).value);
    }));
  };
  std::vector<std::string> withheld;
  for (const auto& [name, estimate] :
       {std::pair("dead time and lag", &ChainFit::dead_time_ms),
        std::pair("natural frequency", &ChainFit::natural_frequency_hz),
        std::pair("hysteresis", &ChainFit::hysteresis_deg)}) {
    const std::size_t count = without(estimate);
    if (count > 0) withheld.push_back(name + CountOf(count, fits.size()));
  }
  if (withheld.empty()) return "";
  return fmt::format(
      "Not determined by this log: {}. Faster motion or more rows per second "
      "determine more (--verbose: reasons).",
      Listed(std::move(withheld)));
}

/// The first thing that keeps a part from being known, if there is any.
const std::string& ProblemOf(const ChainFit& fit) {
  if (!fit.problem.empty()) return fit.problem;
  return fit.split_problem.empty() ? fit.motor_problem : fit.split_problem;
}

}  // namespace

std::string ExtentText(const ChainResult& result) {
  std::string extent =
      fmt::format("{:.1f} s at {:.6g} Hz", result.duration_s(), result.log().rate_hz);
  if (result.episodes.size() == 1) return extent;
  return fmt::format("{} episodes, {}: {} fitted, {} held out", result.episodes.size(), extent,
                     result.fitted, result.judged);
}

ResultTable ChainTable(const ChainResult& result) {
  const ChainLog& log = result.log();
  const std::vector<ChainFit>& fits = result.fits;
  ResultTable table{.columns = {{"part", "part"}, {"problem"}}};
  const auto in_unit = [&](const std::string& text) { return InUnitOf(log, text); };
  for (const Quantity& quantity : kQuantities) {
    const bool any = std::ranges::any_of(
        fits, [&](const ChainFit& fit) { return std::isfinite((fit.*quantity.estimate).value); });
    table.columns.push_back(IntervalColumn(in_unit(quantity.key),
                                           quantity.rare && !any ? "" : quantity.heading,
                                           in_unit(quantity.unit)));
  }
  table.columns.push_back({in_unit("residual_rms_deg"), "residual", in_unit("deg")});
  table.columns.push_back({in_unit("held_out_rms_deg"), "held out", in_unit("deg")});
  table.columns.push_back({in_unit("shifted_rms_deg")});
  table.columns.push_back({"model"});
  table.columns.push_back({"remarks"});
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const ChainFit& fit = fits[i];
    const std::string& problem = ProblemOf(fit);
    ResultRow& row = table.rows.emplace_back();
    row = {ResultCell(log.parts[i]), problem.empty() ? ResultCell() : ResultCell(problem)};
    for (const Quantity& quantity : kQuantities) {
      row.push_back(IntervalCell(fit.*quantity.estimate, quantity.digits));
    }
    const bool is_known = fit.problem.empty() && fit.split_problem.empty();
    for (const double rms_deg : {fit.residual_rms_deg, fit.held_out_rms_deg}) {
      row.push_back({{rms_deg}, is_known ? FixedText(rms_deg, 2) : "-"});
    }
    row.emplace_back(fit.shifted_rms_deg);
    row.push_back(ResultCell::IfAny(fit.model_text));
    row.push_back(ResultCell::IfAny(RemarksOf(log, fit)));
  }
  return table;
}

ResultText ChainText(const ChainResult& result) {
  const ChainLog& log = result.log();
  const std::vector<ChainFit>& fits = result.fits;
  ResultText text = {ExtentText(result) + "; in brackets: 95 % confidence interval",
                     ChainTable(result)};
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const std::string& problem = ProblemOf(fits[i]);
    if (!problem.empty()) AddLine(fmt::format("{}: {}", log.parts[i], problem), text);
    if (!fits[i].model_text.empty()) {
      const std::string remarks = RemarksOf(log, fits[i]);
      AddLine(fmt::format("{}: {}{}{}", log.parts[i], fits[i].model_text,
                          remarks.empty() ? "" : "; ", remarks),
              text);
    }
  }
  AddLine(log.unit_note, text);
  AddLine(WhatFramesAre(log, fits), text);
  AddLine(WhatHysteresisIs(fits), text);
  return text;
}

std::string OffsetsText(const ChainResult& result) {
  constexpr double kLeast_deg = 1.0;
  constexpr double kLeastGain = 0.8;
  constexpr double kMostGain = 1.25;
  const ChainLog& log = result.log();
  if (log.from_wearer) return "";
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < result.fits.size(); ++i) {
    const ChainFit& fit = result.fits[i];
    const double gain = fit.gain.value;
    if (!fit.problem.empty() || !(kLeastGain < gain && gain < kMostGain)) continue;
    const auto command = log.command_deg.col(static_cast<Eigen::Index>(i));
    const double offset = log.angle_deg.col(static_cast<Eigen::Index>(i)).mean() - command.mean();
    const double travel = command.maxCoeff() - command.minCoeff();
    const double limit = std::max(kOffsetOfTravel * travel, log.unit_known ? kLeast_deg : 0.0);
    if (std::abs(offset) <= limit) continue;
    texts.push_back(log.unit_known ? fmt::format("{} {:.1f} deg", log.parts[i], offset)
                                   : fmt::format("{} {:.3g} units", log.parts[i], offset));
  }
  if (texts.empty()) return "";
  return fmt::format("Angles are beside their commands by more than {:g} % of the motion: {}.",
                     100.0 * kOffsetOfTravel, FirstNames(std::move(texts)));
}

namespace {

/// A sentence about parts whose delay drifts over the longest episode; empty if none does.
std::string DriftText(const ChainResult& result) {
  const auto longest = std::ranges::max_element(
      result.episodes, {}, [](const ChainLog& log) { return log.command_deg.rows(); });
  constexpr double kLeastChange_ms = 10.0;
  constexpr double kLeastChange_rows = 0.3;
  const double row_ms = 1e3 / longest->rate_hz;
  const double least_rows = std::max(kLeastChange_ms / row_ms, kLeastChange_rows);
  std::vector<std::string> drifting;
  double first_ms = 0.0, last_ms = 0.0;  // sums
  for (std::size_t i = 0; i < result.fits.size(); ++i) {
    if (!result.fits[i].problem.empty()) continue;
    const auto part = static_cast<Eigen::Index>(i);
    const FollowRows rows = {longest->command_deg.col(part), longest->angle_deg.col(part)};
    const auto drift = FindDelayDrift(rows, longest->rate_hz, least_rows);
    if (!drift) continue;
    drifting.push_back(longest->parts[i]);
    first_ms += row_ms * drift->first_rows;
    last_ms += row_ms * drift->last_rows;
  }
  if (drifting.empty()) return "";
  const auto count = static_cast<double>(drifting.size());
  return fmt::format(
      "The delay of {} goes from {:.0f} to {:.0f} ms over the log, as with two clocks: no value "
      "holds for all of it.",
      FirstNames(std::move(drifting)), first_ms / count, last_ms / count);
}

}  // namespace

Verdict VerdictOf(const ChainResult& result, const IdentifiedChain& chain,
                  const std::string& file) {
  const ChainLog& log = result.log();
  const std::vector<ChainFit>& fits = result.fits;
  Verdict verdict;
  std::vector<double> delays_ms;
  std::vector<std::string> without_delay;  // the model of the others is known
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (std::isfinite(fits[i].delay_ms.value)) {
      delays_ms.push_back(fits[i].delay_ms.value);
    } else if (fits[i].problem.empty()) {
      without_delay.push_back(log.parts[i]);
    }
  }
  if (chain.horizon_ms.empty()) {
    std::vector<double> unlimited_ms;
    for (const ChainFit& fit : fits) {
      if (std::isfinite(fit.unlimited_delay_ms)) unlimited_ms.push_back(fit.unlimited_delay_ms);
    }
    verdict.AddHeadline(
        "horizon", "No horizon_ms",
        unlimited_ms.empty()
            ? ": the log determines no delay."
            : fmt::format(": a speed limit makes the delay depend on the size of the motion. "
                          "Below the limit it is {} ms.",
                          RangeText(unlimited_ms, 0)));
  } else {
    const std::string horizon = RangeText(chain.horizon_ms, 1);
    verdict.recommended = "horizon_ms: " + horizon;
    verdict.AddHeadline(
        "horizon", fmt::format("Set prediction.horizon_ms to {}", horizon),
        fmt::format(" ({:g} of the delay{}, {} ms{}): written to {}, for a controller's key chain.",
                    kHorizonShare, fits.size() == 1 ? "" : " of each part", RangeText(delays_ms, 1),
                    std::ranges::max(chain.horizon_ms) < controller::kMostHorizon_ms
                        ? ""
                        : fmt::format("; {:g} ms is the longest", controller::kMostHorizon_ms),
                    file));
  }
  verdict.AddReason("withheld", WithheldText(fits));
  if (!without_delay.empty() && !delays_ms.empty()) {
    verdict.AddWarning("assumed_delay",
                       FirstNames(without_delay) +
                           " without a delay: the delay depends on the size of the motion. The "
                           "mean of the others is written.");
  }
  std::map<std::string, std::vector<std::string>> failed;  // by problem
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i].problem.empty()) failed[fits[i].problem].push_back(log.parts[i]);
  }
  for (const auto& [problem, parts] : failed) {
    verdict.AddWarning("failed",
                       fmt::format("No result for {}: {}.{}", FirstNames(parts), problem,
                                   delays_ms.empty() ? "" : " The mean of the others is written."));
  }
  std::vector<std::string> undelayed;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const auto& [value, low, high] = fits[i].delay_ms;
    if (HasNoDelay(low, high, log.rate_hz)) undelayed.push_back(log.parts[i]);
  }
  if (!undelayed.empty() && !log.from_wearer) {
    const bool is_one = undelayed.size() == 1;
    verdict.AddWarning("no_delay",
                       fmt::format("{} {} no delay: the commands may be made of the angles. A hand "
                                   "has one; audit checks the log.",
                                   FirstNames(std::move(undelayed)), is_one ? "has" : "have"));
  }
  verdict.AddWarning("delay_drifts", DriftText(result));
  constexpr double kMostLeft = 0.25;  // of the motion
  std::vector<std::string> strays;
  double left = 0.0;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!(fits[i].left_share > kMostLeft)) continue;
    strays.push_back(log.parts[i]);
    left = std::max(left, fits[i].left_share);
  }
  if (!strays.empty()) {
    verdict.AddWarning("strays",
                       fmt::format("With the best delay, up to {:.0f} % of the motion of {} is "
                                   "left: the model explains little of it.",
                                   100.0 * left, FirstNames(strays)));
  }
  verdict.AddWarning("offset", OffsetsText(result));
  verdict.AddWarning("unit", log.unit_note);
  return verdict;
}

ResultText ChainAnswer(const ChainResult& result, const IdentifiedChain& chain,
                       const std::string& file, bool verbose) {
  const std::size_t parts = result.fits.size();
  ResultText text = {fmt::format("{}: {}, {} part{}", result.log().name, ExtentText(result), parts,
                                 parts == 1 ? "" : "s")};
  AddVerdict(VerdictOf(result, chain, file), text);
  text.emplace_back(DelayTable(result.log(), result.fits, chain));
  std::ranges::move(HeldOutText(result), std::back_inserter(text));
  if (verbose) std::ranges::move(ChainText(result), std::back_inserter(text));
  return text;
}

std::string ChainJson(const ChainResult& result, const Verdict& verdict) {
  const ChainLog& log = result.log();
  std::int64_t samples = 0;
  for (const ChainLog& episode : result.episodes) samples += episode.command_deg.rows();
  Json json = {{"log", log.name},
               {"samples", samples},
               {"rate_hz", log.rate_hz},
               {"angle_unit", log.unit_known ? "deg" : "unknown"},
               {"verdict", JsonOf(verdict)},
               {"parts", JsonOf(ChainTable(result))}};
  if (result.episodes.size() > 1) {
    json["episodes"] = {{"fitted", result.fitted},
                        {"held_out", result.judged},
                        {"left_out", result.left_out},
                        {"parts", JsonOf(HeldOutTable(result))}};
  }
  return json.dump(2) + "\n";
}

}  // namespace gauntlet::sim
