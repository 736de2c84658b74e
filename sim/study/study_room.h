#pragma once

#include <memory>

#include "sim/base/few_signals_on_heap.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// Keeps the memory of signals small as long as the returned object exists, for a study that needs
/// the disk anyway; null for others. Errors: RunError if a long study will not find the disk and
/// the memory that it needs, its trace file and page included.
std::shared_ptr<const FewSignalsOnHeap> CheckRoom(const Study& study, const StudyOptions& options);

}  // namespace gauntlet::sim
