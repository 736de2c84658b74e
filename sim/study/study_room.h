#pragma once

#include <memory>

#include "sim/base/few_signals_on_heap.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// Of a study whose signals need the disk anyway, what keeps their memory small, for as long as its
/// result exists; else null.
/// Errors: RunError if a long study will not find the disk and the memory that it needs, its trace
/// file and page included.
std::shared_ptr<const FewSignalsOnHeap> CheckRoom(const Study& study, const StudyOptions& options);

}  // namespace gauntlet::sim
