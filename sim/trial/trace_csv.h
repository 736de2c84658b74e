#pragma once

#include <filesystem>

#include "sim/glove/glove.h"
#include "sim/hand/hand_model.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// The signals of a trace file as CSV, one file per controller: `t_s`, then `signal.column` per
/// column. Counts are empty between the samples of the glove.
void WriteTraceCsv(const std::filesystem::path& target, const GloveSignal& glove,
                   const HandModel& hand, const Trace& trace);

}  // namespace gauntlet::sim
