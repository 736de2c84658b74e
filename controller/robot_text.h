#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controller/controller_config.h"
#include "controller/export.h"

namespace gauntlet::controller {

/// The robot of a text of `gauntlet export --text`, for programs that read it from anywhere and
/// have no more than this library. One setting a line, in the order in which RobotConfig::Visit()
/// shows them; `#` begins a comment:
///
///     key = value value ..    numbers, or texts in quotes: a length and so many items
///     key =                   a group, whose settings follow
///     = "name"                an item of a map
///
/// In quotes, a backslash stands before a character that is meant itself, or before three octal
/// digits of a byte. Values may be changed by hand, and lines left out; their order may not change.
/// A setting that is missing has its default, as in settings of an older version, unless it has
/// none or is the last.
///
/// Errors: SettingError with the number of the line for one that is none of these, for settings
/// that are unknown, given twice or out of order, and for those that make no Controller.
GAUNTLET_API RobotConfig RobotFromText(std::string_view text);

/// All problems of such a text, a line each as of TextOf(Validate()); of one that cannot be read,
/// its first error.
GAUNTLET_API std::vector<std::string> ProblemsOfText(std::string_view text);

}  // namespace gauntlet::controller
