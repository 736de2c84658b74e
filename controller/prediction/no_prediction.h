#pragma once

#include <memory>
#include <string_view>

#include "controller/filters/filter.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The hand is sent to where the wearer is now.
struct NoPredictionConfig {
  static constexpr std::string_view kKind = "none";
  static constexpr std::string_view kSummary = "does not look ahead";

  void Visit(SettingsVisitor&) {}
};

/// Null: there is nothing to do.
inline std::unique_ptr<Filter> MakePredictor(const NoPredictionConfig&, int, double) {
  return nullptr;
}

}  // namespace gauntlet::controller
