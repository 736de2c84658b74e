#include "sim/fit/identified_hand.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/prediction/horizon.h"
#include "sim/fit/answering_servo.h"
#include "sim/fit/chain_log.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {
namespace {

/// Value and ends of the interval with three decimals, more than the accuracy of any log. Empty if
/// one of them is unknown.
std::vector<double> ListOf(const ChainEstimate& estimate) {
  if (!std::isfinite(estimate.value + estimate.low + estimate.high)) return {};
  std::vector<double> list = {estimate.value, estimate.low, estimate.high};
  for (double& value : list) value = std::round(value * 1e3) / 1e3;
  return list;
}

/// Mean of `member` over the parts that have a value; 0 if none has.
double MeanOf(const std::vector<IdentifiedPart>& parts,
              std::vector<double> IdentifiedPart::*member) {
  double sum = 0.0;
  int count = 0;
  for (const IdentifiedPart& part : parts) {
    if ((part.*member).empty()) continue;
    sum += (part.*member).front();
    ++count;
  }
  return count > 0 ? std::round(sum / count * 1e3) / 1e3 : 0.0;
}

/// `member` of every part; the mean of the others for a part without a value. Empty if no part has
/// one.
std::vector<double> ValuesOf(const std::vector<IdentifiedPart>& parts,
                             std::vector<double> IdentifiedPart::*member) {
  std::vector<double> values;
  if (std::ranges::all_of(parts, [&](const auto& part) { return (part.*member).empty(); })) {
    return values;
  }
  const double mean = MeanOf(parts, member);
  for (const IdentifiedPart& part : parts) {
    values.push_back((part.*member).empty() ? mean : (part.*member).front());
  }
  return values;
}

IdentifiedPart PartOf(const ChainLog& log, const ChainFit& fit, const std::string& name) {
  const auto rounded = [](double value) {
    return std::isfinite(value) ? std::round(value * 1e3) / 1e3 : 0.0;
  };
  const auto in_deg = [&](const ChainEstimate& estimate) {
    return log.unit_known ? ListOf(estimate) : std::vector<double>();
  };
  return {.part = name,
          .delay_ms = ListOf(fit.delay_ms),
          .dead_time_ms = ListOf(fit.dead_time_ms),
          .lag_ms = ListOf(fit.lag_ms),
          .natural_frequency_hz = ListOf(fit.natural_frequency_hz),
          .damping_ratio = ListOf(fit.damping_ratio),
          .gain = ListOf(fit.gain),
          .offset_deg = in_deg(fit.offset_deg),
          .speed_limit_deg_s = in_deg(fit.speed_limit_deg_s),
          .hysteresis_deg = in_deg(fit.hysteresis_deg),
          .motor_hysteresis_deg = in_deg(fit.motor_hysteresis_deg),
          .lost_motion_deg = in_deg(fit.lost_motion_deg),
          .residual_rms_deg = log.unit_known ? rounded(fit.residual_rms_deg) : 0.0,
          .held_out_rms_deg = log.unit_known ? rounded(fit.held_out_rms_deg) : 0.0,
          .model = fit.model_text,
          .remarks = RemarksOf(log, fit)};
}

bool HasServo(const ChainResult& result) {
  return !result.log().from_wearer && result.log().unit_known;
}

std::string ChainYaml(const ChainResult& result, IdentifiedChain chain) {
  return "# Made by gauntlet identify. horizon_ms is for the prediction of a controller, "
         "expected_delay_ms\n# and friction_deg are for its joint_loop, dead_time_ms, lag_ms and "
         "natural_frequency_hz (of a log\n# that begins with commands) for its model_predictive; "
         "in "
         "the order of parts.\n# " +
         WhatHysteresisIs(result.fits) + "\n" +
         SettingsToYaml([&chain](controller::SettingsVisitor& visitor) { chain.Visit(visitor); });
}

}  // namespace

IdentifiedChain MakeIdentifiedChain(const ChainLog& log, const std::vector<ChainFit>& fits) {
  IdentifiedChain chain;
  chain.log = FileNameOf(log);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    chain.parts.push_back(PartOf(log, fits[i], log.parts[i]));
  }
  chain.expected_delay_ms = MeanOf(chain.parts, &IdentifiedPart::delay_ms);
  chain.horizon_ms = ValuesOf(chain.parts, &IdentifiedPart::delay_ms);
  for (double& value : chain.horizon_ms) {
    value = std::round(std::clamp(kHorizonShare * value, 0.0, controller::kMostHorizon_ms) * 10.0) /
            10.0;
  }
  chain.friction_deg = ValuesOf(chain.parts, &IdentifiedPart::hysteresis_deg);
  for (double& value : chain.friction_deg) value = std::round(value * 500.0) / 1e3;
  chain.dead_time_ms = ValuesOf(chain.parts, &IdentifiedPart::dead_time_ms);
  chain.lag_ms = ValuesOf(chain.parts, &IdentifiedPart::lag_ms);
  chain.natural_frequency_hz = ValuesOf(chain.parts, &IdentifiedPart::natural_frequency_hz);
  return chain;
}

IdentifiedHand IdentifyHand(ChainEpisodes episodes, const ChainProgress& progress) {
  IdentifiedHand found;
  found.result = IdentifyChain(std::move(episodes), progress);
  found.chain = MakeIdentifiedChain(found.result.log(), found.result.fits);
  found.chain_yaml = ChainYaml(found.result, found.chain);
  if (HasServo(found.result)) {
    found.servo_yaml = ServoSettingsText(found.result.log(), HandModel(HandConfig()), progress);
  }
  return found;
}

}  // namespace gauntlet::sim
