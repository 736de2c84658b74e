#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The raw signal, with which every filter is compared.
struct GAUNTLET_API NoFilterConfig {
  static constexpr std::string_view kKind = "none";
  static constexpr std::string_view kSummary = "passes every sample unchanged";

  void Visit(SettingsVisitor&) {}
};

}  // namespace gauntlet::controller
