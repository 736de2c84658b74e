#include "sim/fit/identified_hand.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/fit/identified_servo.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {
namespace {

bool HasServo(const ChainResult& result) {
  const auto limited = std::ranges::count_if(
      result.fits, [](const ChainFit& fit) { return std::isfinite(fit.speed_limit_deg_s.value); });
  const bool is_limited = 2 * limited > std::ssize(result.fits);
  return !result.log().from_wearer && result.log().unit_known && !is_limited;
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
