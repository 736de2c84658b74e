#pragma once

#include "controller/controller_config.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {

/// The command frames as the posture that a hand without slack or stretch would take, so that they
/// can be drawn beside the joints. Units: rad. Shapes: samples x motors in, samples x channels out.
Signal CommandAngles(const controller::TendonTransmission& transmission,
                     const IntegerSignal& command_counts);

}  // namespace gauntlet::sim
