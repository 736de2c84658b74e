#pragma once

#include <string_view>
#include <vector>

#include "sim/tables/array_table.h"

namespace gauntlet::sim {

/// True for the beginning of a text that Octave saved: comments with name and type of a variable.
bool IsOctaveText(std::string_view head);

/// The numbers, matrices and ranges in such a text; those in structures have the names of their
/// fields, those in a cell array `name_2`. Other variables are left out, but for texts.
/// Source: Octave, libinterp/octave-value, save_ascii of each type.
/// Errors: UserError without a place.
std::vector<NamedArray> ReadOctaveText(std::string_view text);

}  // namespace gauntlet::sim
