#include "sim/study/scenario/scenario_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/glove/glove.h"
#include "sim/score/priority.h"
#include "sim/settings/glove_calibration.h"
#include "sim/settings/identified_chain.h"
#include "sim/settings/yaml_reader.h"
#include "sim/settings/yaml_tree.h"
#include "sim/study/scenario/like_filters.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_tree.h"
#include "sim/trial/external/own_objects.h"

namespace gauntlet::sim {
namespace {

/// Place of a `prediction.horizon_ms: auto` in a scenario.
struct AutoHorizon {
  std::string controller;
  YamlNode node;
};

/// For each filter whether its own `r` is left out.
std::vector<bool> WithoutR(const YamlNode& filters, std::size_t count) {
  std::vector<bool> without(count, true);
  for (std::size_t i = 0; i < count; ++i) {
    const YamlNode& filter = filters.IsSequence() ? filters.items()[i] : filters;
    without[i] = !ChildOf(filter, "r").IsDefined();
  }
  return without;
}

/// Checks what the defaults of the controllers are made from, too.
std::vector<std::string> ChannelNamesOf(const GloveConfig& glove, const YamlNode& root,
                                        const YamlSource& source) {
  std::vector<std::string> names;
  try {
    for (const int channel : ChannelsOf(glove)) {
      names.emplace_back(KnownChannels()[static_cast<std::size_t>(channel)].name);
    }
    glove.noise.Check();
    glove.converter.Check();
  } catch (const controller::SettingError& error) {
    const std::string& key = error.key();
    const std::size_t dot = key.find('.');
    const YamlNode& group = ChildOf(ChildOf(root, "glove"), key.substr(0, dot));
    throw source.At(dot == std::string::npos ? group : ChildOf(group, key.substr(dot + 1)),
                    controller::SettingError("glove." + key, error.problem()));
  }
  return names;
}

/// Takes a controller's settings from the file of its calibration; its own keys win.
void IncludeCalibrations(const YamlNode& root, const YamlSource& source,
                         const std::vector<std::string>& channels, Scenario& scenario) {
  for (NamedController& controller : scenario.controllers) {
    if (controller.calibration.empty()) continue;
    const YamlNode& node = ChildOf(ChildOf(root, "controllers"), controller.name);
    const auto calibration = ReadAll<Calibration>(controller.calibration);
    try {
      UseCalibration(calibration, channels, !ChildOf(node, "linearisation").IsDefined(),
                     WithoutR(ChildOf(node, "filter"), controller.config.filters.size()),
                     controller.config);
    } catch (const controller::SettingError& error) {
      const std::string path = fmt::format("controllers.{}.{}", controller.name, error.key());
      const std::string problem = controller.calibration + ": " + error.problem();
      throw source.At(ChildOf(node, "calibration"), controller::SettingError(path, problem));
    }
    controller.calibration.clear();
  }
}

/// Takes the horizon of a controller's prediction from the file of its chain, unless the prediction
/// has a horizon of its own.
void IncludeChains(const YamlNode& root, const YamlSource& source,
                   const std::vector<AutoHorizon>& auto_horizons,
                   const std::vector<std::string>& channels, Scenario& scenario) {
  for (const AutoHorizon& horizon : auto_horizons) {
    const auto named =
        std::ranges::find(scenario.controllers, horizon.controller, &NamedController::name);
    if (named == scenario.controllers.end() || !named->chain.empty()) continue;
    throw source.At(horizon.node,
                    controller::SettingError(
                        fmt::format("controllers.{}.prediction.horizon_ms", horizon.controller),
                        "is auto, which needs the controller's chain: a file that gauntlet "
                        "identify wrote"));
  }
  for (NamedController& controller : scenario.controllers) {
    if (controller.chain.empty()) continue;
    const YamlNode& node = ChildOf(ChildOf(root, "controllers"), controller.name);
    const auto chain = ReadAll<IdentifiedChain>(controller.chain);
    try {
      const bool given = ChildOf(ChildOf(node, "prediction"), "horizon_ms").IsDefined();
      if (!given) UseChain(chain, channels, scenario.joint_map, controller.config);
    } catch (const controller::SettingError& error) {
      const std::string path = fmt::format("controllers.{}.{}", controller.name, error.key());
      throw source.At(ChildOf(node, "chain"),
                      controller::SettingError(path, controller.chain + ": " + error.problem()));
    }
    controller.chain.clear();
  }
}

/// Fills in a filter's measurement variance r where it is left out: the paper's is for 18 channels
/// in counts; any other glove gets that of the scenario's own noise.
void FillMeasurementVariances(const YamlNode& root, const YamlSource& source,
                              const std::vector<std::string>& channels, Scenario& scenario) {
  for (NamedController& named : scenario.controllers) {
    controller::ControllerConfig& config = named.config;
    const bool on_counts = config.filter_on == controller::FilterOn::kCounts;
    const YamlNode& node = ChildOf(ChildOf(root, "controllers"), named.name);
    const std::vector<bool> without_r = WithoutR(ChildOf(node, "filter"), config.filters.size());
    for (std::size_t i = 0; i < config.filters.size(); ++i) {
      std::vector<double>* r =
          std::visit([](auto& settings) { return controller::MeasurementVarianceOf(settings); },
                     config.filters[i].settings);
      if (r == nullptr || !without_r[i] || !controller::IsDefaultMeasurementVariance(*r)) continue;
      if (on_counts && channels == GloveChannelNames()) continue;
      *r = on_counts ? NoiseVarianceCounts2(scenario.glove) : NoiseVarianceRad2(scenario.glove);
      if (std::ranges::all_of(*r, [](double variance) { return variance > 0.0; })) continue;
      const std::string path = fmt::format("controllers.{}.filter[{}].r", named.name, i);
      throw UserError(
          {.place = source.PlaceOf(ChildOf(node, "filter"), path),
           .key = path,
           .problem = "must be given: the default is the paper's, for 18 channels in counts, and "
                      "the scenario's own noise is 0 (gauntlet calibrate finds r in a recording)"});
    }
  }
}

/// Takes `prediction.horizon_ms: auto` out of the tree: it means what leaving it out does, and that
/// there must be a chain.
std::vector<AutoHorizon> TakeAutoHorizons(YamlNode& root) {
  std::vector<AutoHorizon> taken;
  const YamlNode controllers = ChildOf(root, "controllers");
  std::vector<YamlNode::Entry> entries = controllers.entries();
  for (auto& [name, controller] : entries) {
    const YamlNode prediction = ChildOf(controller, "prediction");
    const YamlNode& horizon = ChildOf(prediction, "horizon_ms");
    if (horizon.text() != "auto") continue;
    taken.push_back({.controller = name.text(), .node = horizon});
    controller = WithChild(controller, "prediction", WithoutChild(prediction, "horizon_ms"));
  }
  if (taken.empty()) return taken;
  root = WithChild(root, "controllers", YamlNode::Map(std::move(entries), controllers.place()));
  return taken;
}

/// Gives the controllers of a scenario what its tree leaves out and something else says: the file
/// of a calibration the linearisation and r, that of a chain the horizon of a prediction, the
/// scenario's own noise the r of a glove that is not the paper's. A controller's own keys win.
/// Errors: UserError for a file that cannot be read or is of other channels, `auto` without a
/// chain, and an r that nothing gives.
void FillControllers(const YamlNode& root, const YamlSource& source,
                     const std::vector<AutoHorizon>& auto_horizons, Scenario& scenario) {
  const std::vector<std::string> channels = ChannelNamesOf(scenario.glove, root, source);
  IncludeCalibrations(root, source, channels, scenario);
  IncludeChains(root, source, auto_horizons, channels, scenario);
  FillMeasurementVariances(root, source, channels, scenario);
}

/// Names become those of folders and files, also where case makes no difference.
void CheckNames(const YamlNode& root, const YamlSource& source, const Scenario& scenario) {
  if (const std::string problem = NameProblem(scenario.name); !problem.empty()) {
    const YamlNode& given = ChildOf(root, "name");
    if (given.IsDefined()) throw source.At(given, controller::SettingError("name", problem));
    throw UserError({.place = source.file.string(),
                     .key = "name",
                     .problem = fmt::format(
                         "must be given, as the file's name cannot be one: it {}", problem)});
  }
  std::map<std::string, std::string> seen;  // in small letters -> as given
  for (const NamedController& named : scenario.controllers) {
    std::string small = named.name;
    std::ranges::transform(small, small.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto [other, is_new] = seen.insert({small, named.name});
    if (is_new) continue;
    throw source.At(
        NodeAt(root, "controllers." + named.name),
        controller::SettingError(
            "controllers." + named.name,
            fmt::format("differs from {} by case only, which not all file systems tell apart",
                        other->second)));
  }
}

void CheckBaseline(const YamlNode& root, const YamlSource& source, const Scenario& scenario) {
  if (scenario.baseline.empty()) return;
  std::vector<std::string> names;
  for (const NamedController& named : scenario.controllers) names.push_back(named.name);
  if (std::ranges::find(names, scenario.baseline) != names.end()) return;
  throw UserError({.place = source.PlaceOf(ChildOf(root, "baseline"), "baseline"),
                   .key = "baseline",
                   .problem = Shown(scenario.baseline) + " is not a controller of the scenario" +
                              Suggestion(scenario.baseline, names)});
}

void CheckPriority(const YamlNode& root, const YamlSource& source, const Scenario& scenario) {
  try {
    ParsePriority(scenario.priority);
  } catch (const controller::SettingError& error) {
    throw source.At(ChildOf(root, "priority"), error);
  }
}

void CheckVideoSize(const YamlNode& root, const YamlSource& source, const VideoConfig& video) {
  for (const auto& [key, side_px] :
       {std::pair{"width_px", video.width_px}, std::pair{"height_px", video.height_px}}) {
    if (side_px % 2 == 0) continue;
    throw source.At(ChildOf(ChildOf(root, "video"), key),
                    controller::SettingError(std::string("video.") + key,
                                             fmt::format("is {}, must be even", side_px)));
  }
}

/// Keys of a file replace values of a preset, so a preset from --set would change nothing there.
void CheckPresets(const YamlNode& root, const YamlSource& source) {
  for (const char* const link : {"link.glove", "link.hand"}) {
    const std::string preset = std::string(link) + ".preset";
    const YamlNode& node = NodeAt(root, link);
    if (source.OverrideOf(preset) == nullptr || !node.IsMap()) continue;
    for (const auto& entry : node.entries()) {
      const std::string& key = entry.first.text();
      if (key == "preset" || key == "receiver" || key == "watchdog") continue;
      const bool is_of_file = entry.first.place().is_known();
      if (!is_of_file || source.OverrideOf(std::string(link) + "." + key) != nullptr) continue;
      throw UserError({.place = source.PlaceOf(ChildOf(node, "preset"), preset),
                       .key = preset,
                       .problem = "has no effect on " + key +
                                  ", which the file sets; set that, too, or leave it out there"});
    }
  }
}

/// A program runs in the folder of the file that names it; one of --set, in the current one.
void PlacePrograms(const YamlSource& source, Scenario& scenario) {
  for (NamedController& named : scenario.controllers) {
    for (std::size_t i = 0; i < named.config.filters.size(); ++i) {
      auto* external = std::get_if<controller::ExternalConfig>(&named.config.filters[i].settings);
      if (external == nullptr || NamesObject(*external) || !external->folder.empty() ||
          !external->answers.empty()) {
        continue;
      }
      const std::string filter = fmt::format("controllers.{}.filter", named.name);
      const bool is_set =
          std::ranges::any_of(std::array{".command", ".library"}, [&](const char* key) {
            return source.OverrideOf(filter + key) != nullptr ||
                   source.OverrideOf(fmt::format("{}[{}]{}", filter, i, key)) != nullptr;
          });
      const std::filesystem::path folder =
          is_set ? std::filesystem::path() : source.FileOf(filter).parent_path();
      external->folder = (std::filesystem::current_path() / folder).lexically_normal();
    }
  }
}

using RepeatedSettings = std::vector<RepeatedSetting>;
using Overrides = std::vector<std::string>;

/// The text, the values of one repetition, then what --set puts over both: single values, then
/// those of lists.
YamlSource TreeOf(const ScenarioText& text, const Overrides& overrides,
                  const RepeatedSettings& lists, std::size_t repetition, YamlNode& root) {
  root = text.root;
  YamlSource source = text.source;
  PutRepetition(lists, repetition, ListsFrom::kFile, root, source);
  for (const std::string& override : overrides) ApplySet(root, override, source);
  PutRepetition(lists, repetition, ListsFrom::kSet, root, source);
  return source;
}

/// The tree of the first repetition, and what the others have in place of it.
RepeatedSettings FirstTreeOf(const ScenarioText& text, const Overrides& overrides, YamlNode& root,
                             YamlSource& source) {
  source = TreeOf(text, overrides, {}, 0, root);
  RepeatedSettings lists = ReadRepetitions(root, source);
  if (!lists.empty()) source = TreeOf(text, overrides, lists, 0, root);
  return lists;
}

/// Scenario of one repetition, read from the tree.
Scenario ReadScenario(const RepeatedSettings& lists, std::size_t repetition, YamlNode& root,
                      const YamlSource& source) {
  RemoveRepetitions(root);
  Scenario scenario;
  scenario.name = source.file.stem().string();
  try {
    ReadAll(root, source, scenario);
  } catch (const UserError& error) {
    const auto list = std::ranges::find(lists, error.key(), &RepeatedSetting::key);
    if (list == lists.end()) throw;
    throw source.At(list->values[repetition],
                    controller::SettingError(error.key(), error.problem()));
  }
  ApplyCalibrationOfMap(scenario.glove);
  return scenario;
}

/// The seed before --set goes over it.
int SeedIn(const ScenarioText& text) {
  struct Seed {
    int value = Scenario{}.seed;
    void Visit(controller::SettingsVisitor& visitor) { visitor.Integer({"seed", ""}, value); }
  } seed;
  const YamlNode& node = ChildOf(text.root, "seed");
  if (node.IsDefined()) {
    ReadAll(YamlNode::Map({{YamlNode::Scalar("seed"), node}}), text.source, seed);
  }
  return seed.value;
}

/// The gloves of all repetitions; `scenario` is of the first. They begin with the one that the
/// scenario's seed has in the file.
Repetitions AllRepetitions(const ScenarioText& text, const Overrides& overrides,
                           const RepeatedSettings& lists, const YamlSource& source,
                           const Scenario& scenario) {
  Repetitions repetitions;
  if (lists.empty()) return repetitions;
  for (const RepeatedSetting& list : lists) repetitions.keys.push_back(list.key);
  repetitions.gloves.push_back(scenario.glove);
  for (std::size_t i = 1; i < lists.front().values.size(); ++i) {
    YamlNode root;
    const YamlSource of_this = TreeOf(text, overrides, lists, i, root);
    TakeAutoHorizons(root);
    ExtractLikeFilters(root, of_this);
    repetitions.gloves.push_back(ReadScenario(lists, i, root, of_this).glove);
  }
  CheckRepetitions(lists, repetitions, source);
  repetitions.Rotate(scenario.seed - SeedIn(text));
  return repetitions;
}

}  // namespace

ScenarioText ParseScenarioText(const std::filesystem::path& file, std::string_view text) {
  ScenarioText parsed{.root = ParseYaml(file, text, YamlIncludes::kAllowed),
                      .source = {.file = file}};
  LeaveOutRemovedSettings(parsed.source, parsed.root);
  IncludeControllers(parsed.root, parsed.source);
  return parsed;
}

Scenario ParseScenario(const ScenarioText& text, const std::vector<std::string>& overrides) {
  YamlNode root;
  YamlSource source;
  const RepeatedSettings lists = FirstTreeOf(text, overrides, root, source);
  const std::vector<AutoHorizon> auto_horizons = TakeAutoHorizons(root);
  const std::vector<LikeFilterOf> like_filters = ExtractLikeFilters(root, source);
  Scenario scenario = ReadScenario(lists, 0, root, source);
  CheckNames(root, source, scenario);
  FillControllers(root, source, auto_horizons, scenario);
  UseLikeFilters(like_filters, source, scenario);
  PlacePrograms(source, scenario);
  CheckBaseline(root, source, scenario);
  CheckPriority(root, source, scenario);
  CheckVideoSize(root, source, scenario.video);
  CheckPresets(root, source);
  scenario.repetitions = AllRepetitions(text, overrides, lists, source, scenario);
  scenario.glove = GloveOf(scenario, scenario.seed);
  return scenario;
}

Scenario ParseScenario(const ScenarioSource& source) {
  return ParseScenario(ParseScenarioText(source.file, source.text), source.overrides);
}

std::string PlaceOfSetting(const ScenarioSource& text, const std::string& key) {
  YamlNode root;
  YamlSource source;
  FirstTreeOf(ParseScenarioText(text.file, text.text), text.overrides, root, source);
  const YamlNode& node = NodeAt(root, key);
  if (source.OverrideOf(key) == nullptr && node.Is(root)) return text.file.string();
  return source.PlaceOf(node, key);
}

Scenario LoadScenario(const std::filesystem::path& file,
                      const std::vector<std::string>& overrides) {
  return ParseScenario({.file = file, .text = ReadYamlText(file), .overrides = overrides});
}

}  // namespace gauntlet::sim
