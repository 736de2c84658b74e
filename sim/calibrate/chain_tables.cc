#include "sim/calibrate/chain_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/calibrate/identified_chain.h"

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

ResultCell CellOf(const ChainEstimate& estimate, int digits) {
  ResultCell cell({estimate.value, estimate.low, estimate.high}, "-");
  if (std::isfinite(estimate.value)) {
    cell.text = fmt::format("{:.{}f} {}({:.{}f}..{:.{}f})", estimate.value, digits, kSoftBreak,
                            estimate.low, digits, estimate.high, digits);
  }
  return cell;
}

/// A key or unit of degrees; `units` if the log's unit is unknown.
std::string InUnitOf(const ChainLog& log, std::string text) {
  const auto at = text.find("deg");
  if (!log.unit_known && at != std::string::npos) text.replace(at, 3, "units");
  return text;
}

/// The first thing that keeps a part from being known, if there is any.
const std::string& ProblemOf(const ChainFit& fit) {
  if (!fit.problem.empty()) return fit.problem;
  return fit.split_problem.empty() ? fit.motor_problem : fit.split_problem;
}

}  // namespace

ResultTable ChainTable(const ChainLog& log, const std::vector<ChainFit>& fits) {
  ResultTable table{.columns = {{"part", "part"}, {"problem"}}};
  const auto in_unit = [&](const std::string& text) { return InUnitOf(log, text); };
  for (const Quantity& quantity : kQuantities) {
    const bool any = std::ranges::any_of(
        fits, [&](const ChainFit& fit) { return std::isfinite((fit.*quantity.estimate).value); });
    const std::string key = in_unit(quantity.key);
    table.columns.push_back(
        {key,
         quantity.rare && !any ? "" : quantity.heading,
         in_unit(quantity.unit),
         {{"value", key}, {"ci95_low", key + "_low"}, {"ci95_high", key + "_high"}}});
  }
  table.columns.push_back({in_unit("residual_rms_deg"), "left", in_unit("deg")});
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
      row.push_back(CellOf(fit.*quantity.estimate, quantity.digits));
    }
    const bool is_known = fit.problem.empty() && fit.split_problem.empty();
    for (const double rms_deg : {fit.residual_rms_deg, fit.held_out_rms_deg}) {
      row.push_back({{rms_deg}, is_known ? fmt::format("{:.2f}", rms_deg) : "-"});
    }
    row.emplace_back(fit.shifted_rms_deg);
    row.push_back(ResultCell::IfAny(fit.model_text));
    row.push_back(ResultCell::IfAny(RemarksOf(log, fit)));
  }
  return table;
}

ResultText ChainText(const ChainLog& log, const std::vector<ChainFit>& fits) {
  ResultText text = {
      fmt::format("{:.1f} s at {:.6g} Hz; in brackets the 95 % interval",
                  static_cast<double>(log.command_deg.rows()) / log.rate_hz, log.rate_hz),
      ChainTable(log, fits)};
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

std::string ChainJson(const ChainLog& log, const std::vector<ChainFit>& fits) {
  const nlohmann::ordered_json json = {{"log", log.name},
                                       {"samples", log.command_deg.rows()},
                                       {"rate_hz", log.rate_hz},
                                       {"angle_unit", log.unit_known ? "deg" : "unknown"},
                                       {"parts", JsonOf(ChainTable(log, fits))}};
  return json.dump(2) + "\n";
}

}  // namespace gauntlet::sim
