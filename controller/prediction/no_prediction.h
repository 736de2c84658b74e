#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The hand is sent to where the wearer is now.
struct GAUNTLET_API NoPredictionConfig {
  static constexpr std::string_view kKind = "none";
  static constexpr std::string_view kSummary = "does not look ahead";

  void Visit(SettingsVisitor&) {}
};

}  // namespace gauntlet::controller
