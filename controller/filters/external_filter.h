#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

class FilterMaker;  // of filter_registry.h, which needs more of the standard library

/// A filter that the caller makes, from outside this library: in the simulator a program that gets
/// a sample a line, functions of a shared library, or the answers that any of them gave earlier.
/// This library starts, loads and reads none of them: without `make`, there is no such filter.
///
/// Errors: SettingError without `make`, and those of `make`.
struct GAUNTLET_API ExternalConfig {
  static constexpr std::string_view kKind = "external";
  static constexpr std::string_view kSummary =
      "a program of yours, a sample a line in and out, a shared library, or a file of its answers";

  std::string command;
  std::string library;
  std::string answers;      // a recording that was filtered elsewhere
  std::string answers_map;  // of that file; empty: as the recording's
  std::string folder;       // empty: the current one
  double timeout_ms = 2000.0;
  bool deterministic = false;
  std::vector<NamedNumber> parameters = {};
  const FilterMaker* make = nullptr;  // no setting: the caller's, who keeps it

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
