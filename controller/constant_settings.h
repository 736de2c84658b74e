#pragma once

#include <span>
#include <string_view>

#include "controller/controller_config.h"
#include "controller/export.h"

namespace gauntlet::controller {

/// One setting as a constant of a program: its key and its value. A list or a map has its length as
/// value, and its items behind it.
struct GAUNTLET_API ConstantSetting {
  std::string_view key;
  double number = 0.0;
  std::string_view text = {};
  bool is_text = false;

  constexpr ConstantSetting(std::string_view k, double value) : key(k), number(value) {}
  constexpr ConstantSetting(std::string_view k, std::string_view value)
      : key(k), text(value), is_text(true) {}
};

/// The robot whose settings a header of `gauntlet export --header` holds, in the order in which
/// RobotConfig::Visit() shows them. No file, no parser: for robots that only have a compiler.
///
/// A setting that is missing has its default, as in settings of an older version, unless it has
/// none or is the last. Errors: SettingError, also for settings that are unknown, given twice or
/// out of order. Controller's constructor checks what values mean together.
GAUNTLET_API RobotConfig RobotFromConstants(std::span<const ConstantSetting> settings);

/// The same from the text of `gauntlet export --text`, for programs that read it from anywhere and
/// have no more than this library. One setting a line; `#` begins a comment:
///
///     key = value value ..    numbers, or texts in quotes: a length and so many items
///     key =                   a group, whose settings follow
///     = "name"                an item of a map
///
/// In quotes, a backslash stands before a character that is meant itself, or before three octal
/// digits of a byte. Values may be changed by hand, and lines left out; their order may not change.
///
/// Errors: SettingError with the number of the line for one that is none of these, for those of
/// RobotFromConstants(), and for settings that make no Controller.
GAUNTLET_API RobotConfig RobotFromText(std::string_view text);

}  // namespace gauntlet::controller
