#pragma once

namespace gauntlet::controller {

/// How often this program has asked for memory by new, malloc or their relatives so far, and given
/// some back.
long AllocationCount();

}  // namespace gauntlet::controller
