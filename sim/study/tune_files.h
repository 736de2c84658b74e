#pragma once

#include <string>
#include <vector>

#include "sim/study/tune_all.h"

namespace gauntlet::sim {

/// A row per setting that was tried.
std::string TuneCsv(const TunePlan& plan, const TuneResult& result);
std::string TuneJson(const TunePlan& plan, const TuneResult& result);
/// The same of all kinds of filters: `tune --all`.
std::string TuneAllCsv(const std::vector<TunedKind>& kinds);
std::string TuneAllJson(const TunePlan& plan, const std::vector<TunedKind>& kinds);

/// Every value of a controller, as it stands in a scenario below its name: what `!include` takes.
std::string ControllerYaml(const NamedController& controller);

}  // namespace gauntlet::sim
