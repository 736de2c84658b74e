#include "sim/answers/sweep/sweep_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "controller/number.h"
#include "sim/answers/sweep/sobol.h"
#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/base/text.h"
#include "sim/score/score.h"
#include "sim/settings/yaml_reader.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {

using controller::SettingError;
using controller::SettingsVisitor;

void SweepAxis::Visit(SettingsVisitor& visitor) {
  visitor.Text({.key = "key", .help = "setting, as --set takes it", .required = true}, key);
  visitor.Texts({.key = "values", .help = "values, as behind the = of --set"}, values);
  visitor.Number({.key = "low", .help = "first value of a range"}, low);
  visitor.Number({.key = "high", .help = "last value of a range"}, high);
  visitor.Integer({.key = "count", .help = "values of the range in a grid", .min = 1, .max = 1e6},
                  count);
  static constexpr std::array<std::string_view, 2> kSpacings = {"linear", "log"};
  controller::VisitEnum(visitor, {.key = "spacing", .help = "of the values of a range"}, kSpacings,
                        spacing);
  visitor.Flag({.key = "whole", .help = "round the values of a range to whole numbers"}, whole);
}

void SweepFile::Visit(SettingsVisitor& visitor) {
  visitor.Text({.key = "name", .help = "name of the results; the file's name if left out"}, name);
  visitor.Text(
      {.key = "question", .help = "what the sweep answers, one sentence", .required = true},
      question);
  visitor.Path({.key = "scenario", .help = "base scenario of all settings", .required = true},
               scenario);
  visitor.Texts({.key = "set", .help = "key=value of --set, for all settings"}, set);
  visitor.Texts({.key = "controllers", .help = "only these of the scenario; empty: all"},
                controllers);
  visitor.Integer({.key = "seeds",
                   .help = "how many, from the scenario's on: the same for all settings",
                   .min = 1,
                   .max = 100000},
                  seeds);
  visitor.Flag(
      {.key = "physics", .help = "false: no hand; what the filters give is scored as it is"},
      physics);
  static constexpr std::array<std::string_view, 3> kDesigns = {"grid", "random", "sobol"};
  controller::VisitEnum(visitor, {.key = "design", .help = "how settings are chosen"}, kDesigns,
                        design);
  visitor.Integer(
      {.key = "cells", .help = "how many, random or of the Sobol sequence", .min = 1, .max = 1e9},
      cells);
  visitor.Integer({.key = "design_seed", .help = "of random settings", .min = 0, .max = 2147480000},
                  design_seed);
  controller::VisitList(visitor, {.key = "axes", .help = "what varies"}, axes);
  visitor.Texts({.key = "scores", .help = "that are kept; left out: those of the main question"},
                scores);
  visitor.Text({.key = "best_by", .help = "score that decides which setting is best"}, best_by);
  visitor.Texts({.key = "subject_to", .help = "bounds of scores, as jitter_rms_deg<=0.2"},
                subject_to);
}

std::string SweepAxis::ValueAt(double place) const {
  if (!is_range()) {
    const auto count_of_values = static_cast<double>(values.size());
    const double item = std::floor(place * count_of_values);
    return values[static_cast<std::size_t>(std::clamp(item, 0.0, count_of_values - 1.0))];
  }
  double value = place <= 0.0 ? low : high;
  if (place > 0.0 && place < 1.0) {
    value =
        spacing == Spacing::kLog ? low * std::pow(high / low, place) : low + (high - low) * place;
    if (!whole) {
      const std::string text = fmt::format("{:.{}g}", value, digits);
      const double rounded = controller::ParseNumber(text).value_or(value);
      return low <= rounded && rounded <= high ? text
                                               : fmt::format("{}", rounded < low ? low : high);
    }
  }
  if (whole) value = std::clamp(std::round(value), std::ceil(low), std::floor(high)) + 0.0;
  return fmt::format("{}", value);
}

int SweepAxis::FewDigits() const {
  constexpr double kValues = 100.0;
  const double share = spacing == Spacing::kLog
                           ? std::log(high / low)
                           : (high - low) / std::max(std::abs(low), std::abs(high));
  return std::max(3, static_cast<int>(std::ceil(1.0 + std::log10(kValues / share))));
}

std::string SweepAxis::WholeProblem() const {
  if (!whole || std::ceil(low) <= std::floor(high)) return "";
  return fmt::format("from {} to {} lies no whole number, the range must have one", low, high);
}

namespace {

/// Number of values of this axis in a grid.
std::int64_t GridCount(const SweepAxis& axis) {
  return axis.is_range() ? axis.count : std::ssize(axis.values);
}

void CheckAxis(const SweepAxis& axis, SweepFile::Design design, const std::string& path) {
  const auto fail = [&path](const std::string& key, const std::string& problem) {
    throw SettingError(path + key, problem);
  };
  const bool has_range = !std::isnan(axis.low) || !std::isnan(axis.high) || axis.count > 0;
  if (axis.key.find('=') != std::string::npos) fail(".key", "must be a key, without a value");
  if (!axis.is_range() && (has_range || axis.whole || axis.spacing != SweepAxis::Spacing::kLinear))
    fail("", "has values, and can have no range");
  if (!axis.is_range()) return;
  if (!has_range) fail("", "is empty: it must have values, or low and high");
  if (std::isnan(axis.low) || std::isnan(axis.high)) fail("", "must have both low and high");
  if (axis.low >= axis.high) {
    fail(".high", fmt::format("is {}, must be above low, which is {}", axis.high, axis.low));
  }
  if (axis.spacing == SweepAxis::Spacing::kLog && axis.low <= 0.0) {
    fail(".low", fmt::format("is {}, must be above 0 where spacing is log", axis.low));
  }
  if (const std::string problem = axis.WholeProblem(); !problem.empty()) fail(".whole", problem);
  const bool grid = design == SweepFile::Design::kGrid;
  if (grid && axis.count == 0) fail("", "must have count: how many values the grid has");
  if (!grid && axis.count > 0) fail(".count", "is for a grid");
}

void CheckAxes(const SweepFile& file) {
  if (file.axes.empty()) throw SettingError("axes", "is empty: nothing would vary");
  std::set<std::string> keys;
  for (std::size_t i = 0; i < file.axes.size(); ++i) {
    const SweepAxis& axis = file.axes[i];
    const std::string path = fmt::format("axes[{}]", i);
    CheckAxis(axis, file.design, path);
    if (axis.key == "seed") {
      throw SettingError(
          path + ".key",
          "is the same for all settings, for paired differences; the key seeds gives their "
          "number");
    }
    if (!keys.insert(axis.key).second) throw SettingError(path + ".key", "is varied twice");
    if (!axis.of_controller() || file.controllers.empty()) continue;
    const bool listed = std::ranges::any_of(file.controllers, [&axis](const std::string& name) {
      return axis.key.starts_with("controllers." + name + ".");
    });
    if (!listed) {
      throw SettingError(path + ".key",
                         axis.key + " changes a controller that is not among controllers");
    }
  }
}

void CheckDesign(const SweepFile& file) {
  const bool grid = file.design == SweepFile::Design::kGrid;
  if (!grid && file.cells == 0) throw SettingError("cells", "must give the number of settings");
  if (grid && file.cells > 0) {
    throw SettingError("cells", "is for design: random and sobol; a grid has all its settings");
  }
  if (file.design == SweepFile::Design::kSobol && file.axes.size() > kSobolDimensions) {
    throw SettingError("axes", fmt::format("are {}, the Sobol sequence has at most {} here",
                                           file.axes.size(), kSobolDimensions));
  }
  double cells = 1.0;
  for (const SweepAxis& axis : file.axes) cells *= static_cast<double>(GridCount(axis));
  if (grid && cells > 1e9) {
    throw SettingError("axes", fmt::format("make {:.3g} settings; the limit is 1e9", cells));
  }
}

/// Every score that is asked for, in the order of Metrics().
std::vector<std::size_t> KeptMetrics(const SweepFile& file, const SweepPlan& plan) {
  std::set<std::size_t> kept = {plan.best_by};
  for (const Constraint& constraint : plan.constraints) kept.insert(constraint.metric);
  for (std::size_t i = 0; i < file.scores.size(); ++i) {
    kept.insert(FindScore(file.scores[i], fmt::format("scores[{}]", i)));
  }
  for (std::size_t m = 0; file.scores.empty() && m < Metrics().size(); ++m) {
    // Without a hand there are no motors.
    const bool known = file.physics || Metrics()[m].part == ScoredPart::kJoint;
    if (Metrics()[m].main && known) kept.insert(m);
  }
  for (const std::size_t metric : kept) {
    if (!file.physics && Metrics()[metric].part != ScoredPart::kJoint) {
      throw SettingError("physics",
                         fmt::format("is false, and {} is not a score of a joint: there is none "
                                     "without a hand",
                                     Metrics()[metric].key));
    }
  }
  return {kept.begin(), kept.end()};
}

void FindScores(SweepPlan& plan) {
  const SweepFile& file = plan.file;
  plan.best_by = FindScore(file.best_by, "best_by");
  for (std::size_t i = 0; i < file.subject_to.size(); ++i) {
    plan.constraints.push_back(
        ParseConstraint(file.subject_to[i], fmt::format("subject_to[{}]", i)));
  }
  plan.metrics = KeptMetrics(file, plan);
}

/// A value that names a file beside the study file is that file.
void FindFiles(const std::filesystem::path& folder, SweepAxis& axis) {
  for (std::string& value : axis.values) {
    std::error_code ignored;
    const std::filesystem::path path = folder / value;
    if (value.empty() || !std::filesystem::is_regular_file(path, ignored)) continue;
    value = std::filesystem::absolute(path).lexically_normal().string();
  }
}

/// Why a scenario cannot be read; empty if it can.
std::string WhyNotReadable(const ScenarioSource& source) {
  try {
    ParseScenario(source);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

/// A key that there is not is found before anything runs: some value of each axis must be readable
/// beside the first ones of the others.
void CheckAxesAreReadable(const SweepPlan& plan) {
  const std::vector<std::string> first = plan.OverridesOf(0);
  for (std::size_t a = 0; a < plan.file.axes.size(); ++a) {
    const SweepAxis& axis = plan.file.axes[a];
    std::string problem;
    for (const double place : {0.0, 0.5, 1.0}) {
      ScenarioSource source = plan.scenario;
      source.overrides.insert(source.overrides.end(), first.begin(), first.end());
      source.overrides[plan.scenario.overrides.size() + a] = axis.key + "=" + axis.ValueAt(place);
      const std::string why = WhyNotReadable(source);
      if (problem.empty() || why.empty()) problem = why;
      if (why.empty()) break;
    }
    if (problem.empty()) continue;
    throw UserError({.place = plan.axis_places[a], .key = axis.key, .problem = problem});
  }
}

}  // namespace

std::int64_t SweepPlan::cell_count() const {
  if (!listed.empty()) return std::ssize(listed);
  if (file.design != SweepFile::Design::kGrid) return file.cells;
  std::int64_t count = 1;
  for (const SweepAxis& axis : file.axes) count *= GridCount(axis);
  return count;
}

std::vector<std::string> SweepPlan::ValuesOf(std::int64_t cell) const {
  if (!listed.empty()) return listed[static_cast<std::size_t>(cell)];
  std::vector<std::string> values(file.axes.size());
  if (file.design == SweepFile::Design::kGrid) {
    std::int64_t rest = cell;
    for (const bool of_controller : {true, false}) {  // the last axis varies fastest
      for (std::size_t a = file.axes.size(); a-- > 0;) {
        const SweepAxis& axis = file.axes[a];
        if (axis.of_controller() != of_controller) continue;
        const std::int64_t count = GridCount(axis);
        const auto item = static_cast<double>(rest % count);
        rest /= count;
        const auto last = static_cast<double>(std::max<std::int64_t>(count - 1, 1));
        values[a] = axis.is_range() ? axis.ValueAt(item / last)
                                    : axis.values[static_cast<std::size_t>(item)];
      }
    }
    return values;
  }
  RandomStream stream(static_cast<std::uint64_t>(file.design_seed), "sweep cell",
                      static_cast<std::uint64_t>(cell));
  for (std::size_t a = 0; a < values.size(); ++a) {
    const double place = file.design == SweepFile::Design::kSobol
                             ? SobolPoint(static_cast<std::uint32_t>(cell), static_cast<int>(a))
                             : stream.Uniform();
    values[a] = file.axes[a].ValueAt(place);
  }
  return values;
}

std::vector<std::string> SweepPlan::OverridesOf(std::int64_t cell) const {
  std::vector<std::string> overrides = ValuesOf(cell);
  for (std::size_t a = 0; a < overrides.size(); ++a) {
    overrides[a].insert(0, file.axes[a].key + "=");
  }
  return overrides;
}

SweepPlan LoadSweepPlan(const std::filesystem::path& path, const SweepOverrides& overrides) {
  return ParseSweepPlan(path, ReadYamlText(path), overrides);
}

SweepPlan ParseSweepPlan(const std::filesystem::path& path, std::string_view text,
                         const SweepOverrides& overrides) {
  YamlNode root = ParseYaml(path, text);
  if (root.IsMap()) root = WithoutChild(root, "all_seeds");  // a key of version 0.3
  const YamlSource source{.file = path};
  SweepPlan plan;
  SweepFile& file = plan.file;
  file.name = path.stem().string();
  ReadAll(root, source, file);
  if (overrides.seeds) file.seeds = *overrides.seeds;
  if (overrides.filter_only) file.physics = false;
  try {
    if (const std::string problem = NameProblem(file.name); !problem.empty()) {
      throw SettingError("name", problem);
    }
    CheckAxes(file);
    CheckDesign(file);
    FindScores(plan);
  } catch (const SettingError& error) {
    throw source.At(NodeAt(root, error.key()), error);
  }
  for (std::size_t a = 0; a < file.axes.size(); ++a) {
    FindFiles(path.parent_path(), file.axes[a]);
    const std::string key = fmt::format("axes[{}].key", a);
    plan.axis_places.push_back(source.PlaceOf(NodeAt(root, key), key));
  }
  file.set.insert(file.set.end(), overrides.set.begin(), overrides.set.end());
  plan.scenario = {
      .file = file.scenario, .text = ReadYamlText(file.scenario), .overrides = file.set};
  Scenario scenario = ParseScenario(plan.scenario);
  try {
    KeepControllers(file.controllers, scenario);
  } catch (const UserError& error) {
    throw source.At(NodeAt(root, "controllers"),
                    SettingError("controllers", error.key() + ": " + error.problem()));
  }
  CheckAxesAreReadable(plan);
  return plan;
}

std::vector<std::int64_t> CellRange::Numbers() const {
  std::vector<std::int64_t> numbers(static_cast<std::size_t>(end - first));
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

CellRange ShardOf(const SweepPlan& plan, int number, int count) {
  const std::int64_t cells = plan.cell_count();
  return {.first = cells * (number - 1) / count, .end = cells * number / count};
}

}  // namespace gauntlet::sim
