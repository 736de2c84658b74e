#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/recordings/inspect/inspection.h"

namespace gauntlet::sim {

/// A defect of a sensor, and what to do about it.
struct HealthFinding {
  std::size_t column = 0;
  std::string key;       // two_senders (of the clock, or of the first sensor that shows it), dead,
                         // no_movement, lost, missing_code, copy, spikes, clipped, repeats or
                         // drift
  double value = 0.0;    // share of the rows; of no_movement, copy, drift: see the sentence
  std::string sentence;  // "does not move: .."
};

/// Findings about the sensors of an inspection, the worst kind first. A healthy sensor has none.
std::vector<HealthFinding> HealthOf(const Inspection& inspection);

/// Range of the usual values in multiples of the noise; infinity without noise.
double RangeOverNoise(const ColumnStatistics& statistics);

/// True if a column, of no muscle, only has noise: it changes from row to row as white noise does,
/// its range is below ten times its noise, and the means of four rows stand still as well. White
/// noise alone has a range of about six, and means with half of its deviation.
bool IsOnlyNoise(const InspectedColumn& column);

/// True for counts, volts and unknown units. The lowest and highest values of the recording then
/// stand for the ends of the joint's range, or of the part that a hand uses.
bool NeedsTwoPoints(RawUnit unit);
/// True for counts whose range a profile does not know: then it is that of the file.
bool TakesRangeOfFile(const ColumnMapping& mapping);
/// True if either holds for a column.
bool TakesRangeOfFile(const Inspection& inspection, const InspectedColumn& column);

/// Degrees of its joint per unit of a sensor; 0 if it drives none.
double DegPerUnitOf(const Inspection& inspection, const InspectedColumn& column);

}  // namespace gauntlet::sim
