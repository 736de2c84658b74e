#pragma once

#include <optional>

#include "sim/loop/event_config.h"
#include "sim/score/latency.h"
#include "sim/trial/trial.h"

namespace gauntlet::sim {

/// Where the delay of one trial comes from, stage by stage. None where there is nothing to measure:
/// a wearer who did not move, or a hand that was stopped within two seconds.
std::optional<LatencyBudget> LatencyOfTrace(const HandModel& hand, const EventConfig& event,
                                            const GloveSignal& glove, const Trace& trace);

}  // namespace gauntlet::sim
