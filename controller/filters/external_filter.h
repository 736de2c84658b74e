#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/filters/filter.h"
#include "controller/settings.h"

namespace gauntlet::controller {

struct ExternalConfig;

/// Makes the filter of a caller. `channel_names`: those that it filters, as many as the filter has
/// channels. Errors: SettingError.
using FilterMaker = std::function<std::unique_ptr<Filter>(
    const ExternalConfig& config, std::span<const std::string> channel_names, double rate_hz)>;

/// A filter that the caller makes, from outside this library: in the simulator a program that gets
/// a sample a line. This library starts no program: without `make`, there is no such filter.
///
/// Errors: SettingError without `make`, and those of `make`.
struct GAUNTLET_API ExternalConfig {
  static constexpr std::string_view kKind = "external";
  static constexpr std::string_view kSummary =
      "a program of yours: a sample a line in, a sample a line out";

  std::string command;
  std::string folder;  // empty: the current one
  double timeout_ms = 2000.0;
  bool deterministic = false;
  std::vector<NamedNumber> parameters = {};
  FilterMaker make = {};  // no setting: the caller's

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
