#pragma once

#include <memory>
#include <string_view>

#include "controller/filters/filter.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// The raw signal, with which every filter is compared.
struct NoFilterConfig {
  static constexpr std::string_view kKind = "none";
  static constexpr std::string_view kSummary = "passes every sample unchanged";

  void Visit(SettingsVisitor&) {}
};

std::unique_ptr<Filter> MakeFilter(const NoFilterConfig& config, int channel_count, double rate_hz);

}  // namespace gauntlet::controller
