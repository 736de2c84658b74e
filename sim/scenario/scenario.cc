#include "sim/scenario/scenario.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/calibrate/identified_chain.h"
#include "sim/glove/glove.h"
#include "sim/scenario/included_controllers.h"
#include "sim/settings/yaml_reader.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {

using controller::SettingMap;
using controller::SettingsVisitor;
using controller::VisitGroup;

void VideoConfig::Visit(SettingsVisitor& visitor) {
  visitor.Text(
      {.key = "channel",
       .help = "joint whose curves are drawn below the hands; empty: index_mcp, or the first"},
      channel);
  visitor.Text({.key = "camera",
                .help = "camera of the model, as hand or arm; fingers, close_up: what hand sees of "
                        "the fingers, or of that of the channel; empty: the whole model, as also "
                        "where hand is not in it"},
               camera);
  visitor.Integer(
      {.key = "width_px", .help = "picture width, even", .min = kMinWidth_px, .max = 3840},
      width_px);
  visitor.Integer(
      {.key = "height_px", .help = "picture height, even", .min = kMinHeight_px, .max = 2160},
      height_px);
  visitor.Integer({.key = "frames_per_s",
                   .help = "pictures per second of simulated time",
                   .min = 1,
                   .max = 120},
                  frames_per_s);
}

void NamedFile::Visit(SettingsVisitor& visitor) {
  visitor.Path({.key = "file", .help = "recording or other file of the glove"}, file);
  visitor.Text({.key = "hash", .help = "of its bytes"}, hash);
}

void MadeWith::Visit(SettingsVisitor& visitor) {
  visitor.Text({.key = "gauntlet_version", .help = "version of the program"}, gauntlet_version);
  visitor.Text({.key = "mujoco_version", .help = "version of the physics engine"}, mujoco_version);
  visitor.Text({.key = "model_hash", .help = "of the compiled hand and arm"}, model_hash);
  visitor.Text(
      {.key = "mathematics",
       .help = "of sin, exp, ... to the last bit: they differ between kinds of processors"},
      mathematics);
  controller::VisitList(visitor, {.key = "files", .help = "that the glove is made from"}, files);
}

void NamedController::Visit(SettingsVisitor& visitor) {
  visitor.Path(
      {.key = "calibration",
       .help = "file that gauntlet calibrate wrote: gives the linearisation, and r to every "
               "filter that has it and is not given one"},
      calibration);
  visitor.Path({.key = "chain",
                .help = "file that gauntlet identify wrote: gives horizon_ms to a prediction that "
                        "is given none, or auto"},
               chain);
  config.Visit(visitor);
}

void Scenario::Visit(SettingsVisitor& visitor) {
  visitor.Text({.key = "name", .help = "name in tables and files; the file's name if left out"},
               name);
  visitor.Text(
      {.key = "question", .help = "what the scenario answers, one sentence", .required = true},
      question);
  visitor.Integer({.key = "seed",
                   .help = "fixes every random number; a comparison counts up from it",
                   .min = 0,
                   .max = 2147480000},
                  seed);
  VisitGroup(visitor, {.key = "glove", .help = "the wearer's motion and the data glove"}, glove);
  // Read and written by hand, see repetitions.h: no other setting has this form.
  visitor.Map({.key = "repetitions",
               .help = "what differs between the repetitions of a comparison: settings, as "
                       "glove.motion.file, each with a list of values"},
              SettingMap{.size = [] { return 0; }, .name = {}, .add = {}, .visit = {}});
  VisitGroup(visitor, {.key = "event", .help = "when command frames leave and arrive"}, event);
  VisitGroup(visitor, {.key = "hand", .help = "motors, cables and joints"}, hand);
  joint_map.Visit(visitor,
                  {.key = "joint_map",
                   .help = "joints of the hand that do not follow the channel of their own name"});
  VisitGroup(visitor, {.key = "score", .help = "what counts in the scores"}, score);
  VisitGroup(visitor, {.key = "video", .help = "what the comparison video shows"}, video);
  visitor.Map({.key = "controllers",
               .help = "what is compared: a name, then its settings",
               .required = true},
              SettingMap{.size = [this] { return controllers.size(); },
                         .name = [this](std::size_t i) { return controllers[i].name; },
                         .add =
                             [this](const std::string& added) {
                               controllers.push_back({.name = added, .config = {}});
                             },
                         .visit = [this](std::size_t i,
                                         SettingsVisitor& inner) { controllers[i].Visit(inner); }});
  visitor.Text({.key = "baseline",
                .help = "controller that the others are held against; empty: the first that "
                        "neither filters nor predicts"},
               baseline);
  VisitGroup(visitor, {.key = "made_with", .help = "written into resolved scenarios"}, made_with);
}

namespace {

YAML::Node Find(const YAML::Node& group, const std::string& key) {
  if (group.IsMap()) {
    for (const auto& entry : group) {
      if (entry.first.Scalar() == key) return entry.second;
    }
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

/// For each filter whether its own `r` is left out.
std::vector<bool> WithoutR(const YAML::Node& filters, std::size_t count) {
  std::vector<bool> without(count, true);
  for (std::size_t i = 0; i < count; ++i) {
    const YAML::Node filter = filters.IsSequence() ? filters[i] : filters;
    without[i] = !Find(filter, "r").IsDefined();
  }
  return without;
}

/// Checks what the defaults of the controllers are made from, too.
std::vector<std::string> ChannelNamesOf(const GloveConfig& glove, const YAML::Node& root,
                                        const YamlSource& source) {
  std::vector<std::string> names;
  try {
    for (const int channel : ChannelsOf(glove)) {
      names.emplace_back(KnownChannels()[static_cast<std::size_t>(channel)].name);
    }
    glove.noise.Check();
  } catch (const controller::SettingError& error) {
    const std::string& key = error.key();
    const std::size_t dot = key.find('.');
    YAML::Node node = Find(Find(root, "glove"), key.substr(0, dot));
    if (dot != std::string::npos) node = Find(node, key.substr(dot + 1));
    throw source.At(node, controller::SettingError("glove." + key, error.problem()));
  }
  return names;
}

/// All that a file says, which holds nothing else.
template <class Settings>
Settings ReadWhole(const std::filesystem::path& file) {
  const YAML::Node root = ParseYamlFile(file);
  const YamlSource source{.file = file, .overrides = {}};
  Settings settings;
  YamlReader reader(root, "", source);
  settings.Visit(reader);
  reader.RejectUnknownKeys();
  return settings;
}

/// What the file of a controller's calibration says becomes its settings; its own keys win.
void IncludeCalibrations(const YAML::Node& root, const YamlSource& source, Scenario& scenario) {
  const std::vector<std::string> channels = ChannelNamesOf(scenario.glove, root, source);
  for (NamedController& controller : scenario.controllers) {
    if (controller.calibration.empty()) continue;
    const YAML::Node node = Find(Find(root, "controllers"), controller.name);
    const Calibration calibration = LoadCalibration(controller.calibration);
    try {
      UseCalibration(calibration, channels, !Find(node, "linearisation").IsDefined(),
                     WithoutR(Find(node, "filter"), controller.config.filters.size()),
                     controller.config);
    } catch (const controller::SettingError& error) {
      const std::string path = fmt::format("controllers.{}.{}", controller.name, error.key());
      const std::string problem = controller.calibration + ": " + error.problem();
      throw source.At(Find(node, "calibration"), controller::SettingError(path, problem));
    }
    controller.calibration.clear();
  }
}

/// A setting with the value `auto`, and where it stood.
struct AutoHorizon {
  std::string controller;
  YAML::Node node;
};

/// Takes `prediction.horizon_ms: auto` out of the tree: it means what leaving it out does, and that
/// there must be a chain.
std::vector<AutoHorizon> TakeAutoHorizons(YAML::Node& root) {
  std::vector<AutoHorizon> taken;
  const YAML::Node controllers = Find(root, "controllers");
  if (!controllers.IsMap()) return taken;
  for (const auto& entry : controllers) {
    YAML::Node prediction = Find(entry.second, "prediction");
    const YAML::Node horizon = Find(prediction, "horizon_ms");
    if (!horizon.IsDefined() || !horizon.IsScalar() || horizon.Scalar() != "auto") continue;
    taken.push_back({.controller = entry.first.Scalar(), .node = horizon});
    prediction.remove("horizon_ms");
  }
  return taken;
}

/// What the file of a controller's chain says becomes the horizon of its prediction, unless that
/// has one of its own.
void IncludeChains(const YAML::Node& root, const YamlSource& source,
                   const std::vector<AutoHorizon>& auto_horizons, Scenario& scenario) {
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
  const std::vector<std::string> channels = ChannelNamesOf(scenario.glove, root, source);
  for (NamedController& controller : scenario.controllers) {
    if (controller.chain.empty()) continue;
    const YAML::Node node = Find(Find(root, "controllers"), controller.name);
    const auto chain = ReadWhole<IdentifiedChain>(controller.chain);
    try {
      const bool given = Find(Find(node, "prediction"), "horizon_ms").IsDefined();
      if (!given) UseChain(chain, channels, scenario.joint_map, controller.config);
    } catch (const controller::SettingError& error) {
      const std::string path = fmt::format("controllers.{}.{}", controller.name, error.key());
      throw source.At(Find(node, "chain"),
                      controller::SettingError(path, controller.chain + ": " + error.problem()));
    }
    controller.chain.clear();
  }
}

/// Where a filter's measurement variance r is left out: the paper's is for 18 channels in counts;
/// any other glove gets that of the scenario's own noise.
void FillMeasurementVariances(const YAML::Node& root, const YamlSource& source,
                              Scenario& scenario) {
  const std::vector<std::string> channels = ChannelNamesOf(scenario.glove, root, source);
  for (NamedController& named : scenario.controllers) {
    controller::ControllerConfig& config = named.config;
    const bool on_counts = config.filter_on == controller::FilterOn::kCounts;
    const YAML::Node node = Find(Find(root, "controllers"), named.name);
    const std::vector<bool> without_r = WithoutR(Find(node, "filter"), config.filters.size());
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
          {.place = source.PlaceOf(Find(node, "filter"), path),
           .key = path,
           .problem = "must be given: the default is the paper's, for 18 channels in counts, and "
                      "the scenario's own noise is 0 (gauntlet calibrate finds r in a recording)"});
    }
  }
}

/// Names become those of folders and files, also where case makes no difference.
void CheckNames(const YAML::Node& root, const YamlSource& source, const Scenario& scenario) {
  if (const std::string problem = NameProblem(scenario.name); !problem.empty()) {
    const YAML::Node given = Find(root, "name");
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

void CheckBaseline(const YAML::Node& root, const YamlSource& source, const Scenario& scenario) {
  if (scenario.baseline.empty()) return;
  std::vector<std::string> names;
  for (const NamedController& named : scenario.controllers) names.push_back(named.name);
  if (std::ranges::find(names, scenario.baseline) != names.end()) return;
  throw UserError({.place = source.PlaceOf(Find(root, "baseline"), "baseline"),
                   .key = "baseline",
                   .problem = Shown(scenario.baseline) + " is not a controller of the scenario" +
                              Suggestion(scenario.baseline, names)});
}

void CheckVideoSize(const YAML::Node& root, const YamlSource& source, const VideoConfig& video) {
  for (const auto& [key, side_px] :
       {std::pair{"width_px", video.width_px}, std::pair{"height_px", video.height_px}}) {
    if (side_px % 2 == 0) continue;
    throw source.At(Find(Find(root, "video"), key),
                    controller::SettingError(std::string("video.") + key,
                                             fmt::format("is {}, must be even", side_px)));
  }
}

/// A controller that does nothing against noise nor delay: what every other has to beat.
bool NeitherFiltersNorPredicts(const controller::ControllerConfig& config) {
  return std::holds_alternative<controller::NoPredictionConfig>(config.prediction.settings) &&
         std::ranges::all_of(config.filters, [](const controller::FilterConfig& filter) {
           return std::holds_alternative<controller::NoFilterConfig>(filter.settings);
         });
}

}  // namespace

const GloveConfig& GloveOf(const Scenario& scenario, int seed) {
  const std::vector<GloveConfig>& gloves = scenario.repetitions.gloves;
  if (gloves.empty()) return scenario.glove;
  const int count = static_cast<int>(gloves.size());
  const int place = (seed - scenario.seed) % count;
  return gloves[place < 0 ? place + count : place];
}

LoopTiming TimingOf(const Scenario& scenario) {
  return MakeLoopTiming({.sample_rate_hz = scenario.glove.rate_hz,
                         .event_period_ms = scenario.event.period_ms,
                         .event_delay_ms = scenario.event.delay_ms,
                         .longest_step_ms = scenario.hand.step_ms});
}

std::optional<std::size_t> BaselineOf(const Scenario& scenario) {
  const auto found = std::ranges::find_if(scenario.controllers, [&](const NamedController& named) {
    return scenario.baseline.empty() ? NeitherFiltersNorPredicts(named.config)
                                     : named.name == scenario.baseline;
  });
  if (found == scenario.controllers.end()) return std::nullopt;
  return static_cast<std::size_t>(found - scenario.controllers.begin());
}

void CheckControllerNames(const std::vector<std::string>& names, const Scenario& scenario) {
  std::vector<std::string> known;
  for (const NamedController& controller : scenario.controllers) known.push_back(controller.name);
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) == known.end()) {
      throw UserError({.place = "--controllers",
                       .key = Shown(name),
                       .problem = "unknown controller" + Suggestion(name, known)});
    }
    if (std::ranges::count(names, name) > 1) {
      throw UserError({.place = "--controllers", .key = name, .problem = "named twice"});
    }
  }
}

std::string KeepControllers(const std::vector<std::string>& names, Scenario& scenario) {
  CheckControllerNames(names, scenario);
  if (names.empty()) return {};
  std::vector<NamedController> kept;
  for (const std::string& name : names) {
    kept.push_back(*std::ranges::find(scenario.controllers, name, &NamedController::name));
  }
  scenario.controllers = std::move(kept);
  if (std::ranges::count(names, scenario.baseline) > 0) return {};
  return std::exchange(scenario.baseline, {});
}

Calibration LoadCalibration(const std::filesystem::path& file) {
  return ReadWhole<Calibration>(file);
}

std::string CalibrationToYaml(const Calibration& calibration) {
  Calibration copy = calibration;  // a visitor may change what it sees
  return SettingsToYaml([&copy](SettingsVisitor& visitor) { copy.Visit(visitor); });
}

namespace {

using RepeatedSettings = std::vector<RepeatedSetting>;

/// The file, the values of one repetition, then what --set puts over both: single values, then
/// those of lists.
YamlSource TreeOf(const ScenarioSource& text, const RepeatedSettings& lists, std::size_t repetition,
                  YAML::Node& root) {
  root.reset(ParseYaml(text.file, text.text, YamlIncludes::kAllowed));
  YamlSource source{.file = text.file};
  IncludeControllers(root, source);
  PutRepetition(lists, repetition, ListsFrom::kFile, root, source);
  for (const std::string& override : text.overrides) ApplyOverride(root, override, source);
  PutRepetition(lists, repetition, ListsFrom::kSet, root, source);
  return source;
}

RepeatedSettings ListsOf(const ScenarioSource& text) {
  YAML::Node root;
  const YamlSource source = TreeOf(text, {}, 0, root);
  return ReadRepetitions(root, source);
}

/// What the tree of one repetition says.
Scenario ReadScenario(const ScenarioSource& text, const RepeatedSettings& lists,
                      std::size_t repetition, YAML::Node& root, const YamlSource& source) {
  RemoveRepetitions(root);
  Scenario scenario;
  scenario.name = text.file.stem().string();
  try {
    YamlReader reader(root, "", source);
    scenario.Visit(reader);
    reader.RejectUnknownKeys();
  } catch (const UserError& error) {
    const auto list = std::ranges::find(lists, error.key(), &RepeatedSetting::key);
    if (list == lists.end()) throw;
    throw source.At(list->values[repetition],
                    controller::SettingError(error.key(), error.problem()));
  }
  return scenario;
}

/// The gloves of all repetitions; `scenario` is of the first. They begin with the one that the
/// scenario's seed has in the file.
Repetitions AllRepetitions(const ScenarioSource& text, const RepeatedSettings& lists,
                           const YamlSource& source, const Scenario& scenario) {
  Repetitions repetitions;
  if (lists.empty()) return repetitions;
  for (const RepeatedSetting& list : lists) repetitions.keys.push_back(list.key);
  repetitions.gloves.push_back(scenario.glove);
  for (std::size_t i = 1; i < lists.front().values.size(); ++i) {
    YAML::Node root;
    const YamlSource of_this = TreeOf(text, lists, i, root);
    TakeAutoHorizons(root);
    repetitions.gloves.push_back(ReadScenario(text, lists, i, root, of_this).glove);
  }
  CheckRepetitions(lists, repetitions, source);
  const YAML::Node seed_in_file =
      Find(ParseYaml(text.file, text.text, YamlIncludes::kAllowed), "seed");
  repetitions.Rotate(scenario.seed - (seed_in_file.IsDefined() && seed_in_file.IsScalar()
                                          ? seed_in_file.as<int>(Scenario{}.seed)
                                          : Scenario{}.seed));
  return repetitions;
}

}  // namespace

Scenario ParseScenario(const ScenarioSource& text) {
  const RepeatedSettings lists = ListsOf(text);
  YAML::Node root;
  const YamlSource source = TreeOf(text, lists, 0, root);
  const std::vector<AutoHorizon> auto_horizons = TakeAutoHorizons(root);
  Scenario scenario = ReadScenario(text, lists, 0, root, source);
  CheckNames(root, source, scenario);
  IncludeCalibrations(root, source, scenario);
  IncludeChains(root, source, auto_horizons, scenario);
  FillMeasurementVariances(root, source, scenario);
  CheckBaseline(root, source, scenario);
  CheckVideoSize(root, source, scenario.video);
  scenario.repetitions = AllRepetitions(text, lists, source, scenario);
  scenario.glove = GloveOf(scenario, scenario.seed);
  return scenario;
}

std::string PlaceOfSetting(const ScenarioSource& text, const std::string& key) {
  const RepeatedSettings lists = ListsOf(text);
  YAML::Node root;
  const YamlSource source = TreeOf(text, lists, 0, root);
  const YAML::Node node = NodeAt(root, key);
  if (source.OverrideOf(key) == nullptr && node.is(root)) return text.file.string();
  return source.PlaceOf(node, key);
}

Scenario LoadScenario(const std::filesystem::path& file,
                      const std::vector<std::string>& overrides) {
  return ParseScenario({.file = file, .text = ReadYamlText(file), .overrides = overrides});
}

namespace {

void CollectValues(const std::string& key, const YAML::Node& node,
                   std::vector<SettingValue>& values) {
  const std::string prefix = key.empty() ? "" : key + ".";
  if (node.IsMap()) {
    for (const auto& entry : node) {
      CollectValues(prefix + entry.first.Scalar(), entry.second, values);
    }
  } else if (node.IsSequence() && node.size() > 0 && !node[0].IsScalar()) {
    for (std::size_t i = 0; i < node.size(); ++i) {
      CollectValues(prefix + std::to_string(i), node[i], values);
    }
  } else if (node.IsSequence()) {
    values.push_back(
        {key, fmt::format("[{}]", fmt::join(node.as<std::vector<std::string>>(), ", "))});
  } else {
    values.push_back({key, node.Scalar()});
  }
}

}  // namespace

std::string ScenarioToYaml(const Scenario& scenario, const std::filesystem::path& folder) {
  Scenario copy = scenario;  // a visitor may change what it sees
  std::string text =
      SettingsToYaml([&copy](SettingsVisitor& visitor) { copy.Visit(visitor); }, folder);
  if (!copy.repetitions.gloves.empty()) text += RepetitionsToYaml(copy.repetitions, folder);
  return text;
}

std::vector<SettingValue> SettingValues(const Scenario& scenario) {
  std::vector<SettingValue> values;
  CollectValues("", YAML::Load(ScenarioToYaml(scenario)), values);
  return values;
}

}  // namespace gauntlet::sim
