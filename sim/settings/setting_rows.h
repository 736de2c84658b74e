#pragma once

#include <functional>
#include <string>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::sim {

/// One setting as a row of a list for people.
struct SettingRow {
  std::string key;            // path of keys, joined by dots
  std::string default_value;  // as text
  bool required = false;      // there is no default
  std::string range;          // "0 to 1", "true, false", "above 0"; empty if anything goes
  std::string help;
};

/// All settings that `visit` shows, in their order.
std::vector<SettingRow> ListSettings(
    const std::function<void(controller::SettingsVisitor&)>& visit);

}  // namespace gauntlet::sim
