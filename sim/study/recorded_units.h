#pragma once

#include <string>

#include "controller/controller_config.h"
#include "sim/glove/glove_config.h"

namespace gauntlet::sim {

/// The units of a sample, in a sentence, and what the column map assumes of them; empty: counts, or
/// nothing.
struct RecordedUnits {
  std::string units = {};
  std::string assumptions = {};
};

/// Lets a robot take what the columns of its scenario's recording hold (`use: measured`), where
/// these are no counts: degrees, radians or whatever the column map says, in place of the counts of
/// the simulated converter. Known poses and converter ranges are those of the column, and the
/// settings of filters on counts are scaled, so that the commands are those of the trials but for
/// the rounding to counts, and the first samples of a Kalman filter, whose first covariance is 1. A
/// channel that is no line of one column (a sum, jumps, an envelope) takes its joint's angle in
/// degrees. Robots with a calibration of their own stay as they are.
///
/// Errors: UserError for a recording or a map that cannot be read.
RecordedUnits UseRecordedUnits(const GloveConfig& config, controller::RobotConfig& robot);

/// The unit that all columns of a scenario's recording share as they are: deg or rad; empty:
/// counts, several units, others, or no recording. Errors: as UseRecordedUnits().
std::string SharedRecordedUnit(const GloveConfig& config);

}  // namespace gauntlet::sim
