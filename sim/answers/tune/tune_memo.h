#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "sim/answers/tune/tune.h"

namespace gauntlet::sim {

/// Settings that were measured before, by the same build for the same scenario. A search that finds
/// all it asks for here has the same result at once. So a search can be divided among processes
/// although each of its settings depends on those before.
class TuneMemo {
 public:
  /// Errors: UserError, SettingError for a scenario that cannot be built.
  explicit TuneMemo(const TunePlan& plan);

  std::optional<TunedSetting> Find(const std::string& question) const;
  void Keep(const std::string& question, const TunedSetting& setting);

  /// Errors: RunError.
  void Write(const std::filesystem::path& file) const;
  /// Adds what Write() of another process wrote. Errors: RunError for a file of another scenario or
  /// build.
  void Add(const std::filesystem::path& file);

 private:
  std::string identity_;  // of all that decides a setting, but the question
  std::map<std::string, TunedSetting> known_;
};

}  // namespace gauntlet::sim
