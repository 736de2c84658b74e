#pragma once

#include "controller/settings.h"

namespace gauntlet::controller {

/// The setting that every prediction has.
inline void VisitHorizon(SettingsVisitor& visitor, double& horizon_ms) {
  visitor.Number({.key = "horizon_ms", .help = "how far to look ahead", .min = 0, .max = 1000},
                 horizon_ms);
}

}  // namespace gauntlet::controller
