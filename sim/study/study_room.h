#pragma once

#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// Errors: RunError if a long study will not find the disk and the memory that it needs, its trace
/// file and page included.
void CheckRoom(const Study& study, const StudyOptions& options);

}  // namespace gauntlet::sim
