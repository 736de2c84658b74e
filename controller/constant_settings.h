#pragma once

#include <span>
#include <string_view>

#include "controller/controller_config.h"

namespace gauntlet::controller {

/// One setting as a constant of a program: its key and its value. A list or a map has its length as
/// value, and its items behind it.
struct ConstantSetting {
  std::string_view key;
  double number = 0.0;
  std::string_view text = {};

  constexpr ConstantSetting(std::string_view k, double value) : key(k), number(value) {}
  constexpr ConstantSetting(std::string_view k, std::string_view value) : key(k), text(value) {}
};

/// The robot whose settings a header of `gauntlet export --header` holds, in the order in which
/// RobotConfig::Visit() shows them. No file, no parser: for robots that only have a compiler.
///
/// Errors: SettingError if the settings are those of another version of this library, whose keys
/// differ; then export them again.
RobotConfig RobotFromConstants(std::span<const ConstantSetting> settings);

}  // namespace gauntlet::controller
