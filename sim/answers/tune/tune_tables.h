#pragma once

#include <string>
#include <vector>

#include "sim/answers/tune/tune.h"
#include "sim/answers/tune/tune_all.h"
#include "sim/results/result_table.h"
#include "sim/results/table_text.h"
#include "sim/results/verdict.h"

namespace gauntlet::sim {

/// A row per setting: the values of what is free, scores with intervals.
ResultTable SettingsTable(const TunePlan& plan, const TuneResult& result,
                          const std::vector<TunedSetting>& settings);

/// The setting that was found.
Verdict VerdictOf(const TunePlan& plan, const TuneResult& result);
/// The kind of filter that was chosen on the fitted part; nothing is recommended where another is
/// better on the held-out part, or undecided against it.
Verdict VerdictOf(const TunePlan& plan, const std::vector<TunedKind>& kinds);

/// A row per setting that was tried.
std::string TuneCsv(const TunePlan& plan, const TuneResult& result);
std::string TuneJson(const TunePlan& plan, const TuneResult& result);
/// Row per kind of filter: `tune --all`.
std::string TuneCsv(const TunePlan& plan, const std::vector<TunedKind>& kinds);
std::string TuneJson(const TunePlan& plan, const std::vector<TunedKind>& kinds);

/// A key without the controllers.<name>. before it.
std::string KeyInController(const TunePlan& plan, std::size_t axis);

/// Every value of a controller, as it stands in a scenario below its name: what `!include` takes.
std::string ControllerYaml(const NamedController& controller);

/// The result of tuning for people: values, scores on the held-out part, the front.
ResultText TuneText(const TunePlan& plan, const TuneResult& result, bool verbose);

/// `tuned_kalman of door_opening: least jitter_rms_deg, delay_ms<=50`; `search`: behind the name.
std::string QuestionText(const TunePlan& plan, const std::string& search);
/// `seeds 1 to 8, validated on held-out seeds 9 to 16`.
std::string SplitText(const TuneSplit& split);
/// The split that all kinds share. At least one was searched.
const TuneSplit& SplitOfKinds(const std::vector<TunedKind>& kinds);

/// The result of `tune --all` for people: a row per kind of filter, the chosen one first.
ResultText TuneText(const TunePlan& plan, const std::vector<TunedKind>& kinds, bool verbose);

}  // namespace gauntlet::sim
