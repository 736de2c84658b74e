#pragma once

#include <span>
#include <string>

#include "sim/recordings/inspect/inspection.h"
#include "sim/recordings/inspect/senders.h"

namespace gauntlet::sim {

/// A sentence that stops the work until it is answered, and its remedy.
struct StopQuestion {
  std::string sentence = {};  // empty: none
  Remedy remedy = Remedy::kInSentence;
};

/// True for the name of a column that names the sensor or joint of each row.
bool NamesValues(const std::string& name);
/// True if each row has the value of one sensor, which a column names.
bool IsLongTable(const Inspection& inspection, std::span<const RowGroups> groups);

/// The question if a recording cannot be played as it is understood. `groups`: of columns that may
/// tell hands, devices or sessions apart. `has_map`: a person named time and joints.
StopQuestion FindStopQuestion(const Inspection& inspection, std::span<const RowGroups> groups,
                              bool has_map);

}  // namespace gauntlet::sim
