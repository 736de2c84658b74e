#pragma once

#include <string>

#include "sim/answers/compare/summary.h"

namespace gauntlet::sim {

/// The part of the report page that tells of the recording, as HTML: file, hash, rows, rate and its
/// jitter, what was repaired, what of each joint does not count and why, and of the first joint the
/// rows as they stand in the file, with marks where they were left out. Of the first seed. Empty
/// where nothing was recorded.
std::string RecordingSection(const FinishedStudy& finished);

}  // namespace gauntlet::sim
