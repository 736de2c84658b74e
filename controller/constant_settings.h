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
/// Errors: SettingError if the settings are those of another version of this library, whose keys
/// differ; then export them again. Controller's constructor checks the values.
GAUNTLET_API RobotConfig RobotFromConstants(std::span<const ConstantSetting> settings);

/// The same from the text of `gauntlet export --text`, for programs that read it from anywhere and
/// have no more than this library. One setting a line; `#` begins a comment:
///
///     key = value value ..    numbers, or texts in quotes: a length and so many items
///     key =                   a group, whose settings follow
///     = "name"                an item of a map
///
/// In quotes, a backslash stands before a character that is meant itself, or before three octal
/// digits of a byte. Values may be changed by hand; which settings there are, and their order, may
/// not.
///
/// Errors: SettingError for a line that is none of these, with its number, and those of
/// RobotFromConstants().
GAUNTLET_API RobotConfig RobotFromText(std::string_view text);

}  // namespace gauntlet::controller
