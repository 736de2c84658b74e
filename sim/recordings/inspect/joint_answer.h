#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/recordings/inspect/inspection.h"
#include "sim/recordings/profile.h"

namespace gauntlet::sim {

/// Columns whose joints answer the question of an inspection; none if joints alone do not answer
/// it.
std::vector<std::size_t> ColumnsToName(const Inspection& inspection);

/// Profiles of devices with as many sensors as these columns, by name.
std::vector<Profile> ProfilesForColumns(const Inspection& inspection);

/// An inspection whose question is answered: StarterMap() of it has these joints. `joints`: of
/// ColumnsToName() in order, by the name of the channel; `-`: none.
/// Errors: UserError for a name that is no channel or appears twice, and for another number.
Inspection WithJoints(Inspection inspection, const std::vector<std::string>& joints);

}  // namespace gauntlet::sim
