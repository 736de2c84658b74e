#include "sim/study/scenario/scenario.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/settings/yaml_tree.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {

using controller::SettingMap;
using controller::SettingsVisitor;
using controller::VisitGroup;

void EventConfig::Visit(SettingsVisitor& visitor) {
  visitor.Number({"period_ms", "time between two command frames", 1, 1000}, period_ms);
  visitor.Number(
      {"delay_ms", "time until a command frame reaches the servos, in whole steps of 1 ms or less",
       0, 1000},
      delay_ms);
}

void VideoConfig::Visit(SettingsVisitor& visitor) {
  visitor.Text(
      {"channel", "joint whose curves are drawn below the hands; empty: index_mcp, or the first"},
      channel);
  visitor.Text(
      {"camera",
       "camera of the model, as hand or arm; fingers, close_up: what hand sees of the fingers, or "
       "of that of the channel; empty: the whole model, as also where hand is not in it"},
      camera);
  visitor.Integer({"width_px", "picture width, even", kMinWidth_px, 3840}, width_px);
  visitor.Integer({"height_px", "picture height, even", kMinHeight_px, 2160}, height_px);
  visitor.Integer({"frames_per_s", "pictures per second of simulated time", 1, 120}, frames_per_s);
}

void NamedFile::Visit(SettingsVisitor& visitor) {
  visitor.Path({"file", "recording or other file of the glove"}, file);
  visitor.Text({"hash", "of its bytes"}, hash);
}

void MadeWith::Visit(SettingsVisitor& visitor) {
  visitor.Text({"gauntlet_version", "version of the program"}, gauntlet_version);
  visitor.Text({"mujoco_version", "version of the physics engine"}, mujoco_version);
  visitor.Text({"model_hash", "of the compiled hand and arm"}, model_hash);
  visitor.Text(
      {"mathematics", "of sin, exp, ... to the last bit: they differ between kinds of processors"},
      mathematics);
  controller::VisitList(visitor, {"files", "that the glove is made from"}, files);
}

void NamedController::Visit(SettingsVisitor& visitor) {
  visitor.Path({"calibration",
                "file that gauntlet calibrate wrote: gives the linearisation, and r to every "
                "filter that has it and is not given one"},
               calibration);
  visitor.Path({"chain",
                "file that gauntlet identify wrote: gives horizon_ms to a prediction that is given "
                "none, or auto"},
               chain);
  controller::VisitOptionalGroup(
      visitor,
      {"receiver",
       "what the computer does with the glove's samples, in place of link.glove.receiver"},
      receiver);
  config.Visit(visitor);
}

void Scenario::Visit(SettingsVisitor& visitor) {
  visitor.Text({"name", "name in tables and files; the file's name if left out"}, name);
  visitor.Text(
      {.key = "question", .help = "what the scenario answers, one sentence", .required = true},
      question);
  visitor.Integer(
      {"seed", "fixes every random number; a comparison counts up from it", 0, 2147480000}, seed);
  VisitGroup(visitor, {"glove", "the wearer's motion and the data glove"}, glove);
  // Read and written by hand, see repetitions.h: no other setting has this form.
  visitor.Map({"repetitions",
               "what differs between the replicates of a comparison: settings, as "
               "glove.motion.file, each with a list of values"},
              SettingMap{.size = [] { return 0; }, .name = {}, .add = {}, .visit = {}});
  VisitGroup(visitor, {"event", "when command frames leave and arrive"}, event);
  controller::VisitOptionalGroup(
      visitor, {"link", "what happens on the way from the glove and to the hand"}, link);
  VisitGroup(visitor, {"hand", "motors, cables and joints"}, hand);
  joint_map.Visit(visitor, {"joint_map",
                            "joints of the hand that do not follow the channel of their own name"});
  VisitGroup(visitor, {"score", "what counts in the scores"}, score);
  VisitGroup(visitor, {"video", "what the comparison video shows"}, video);
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
  visitor.Text({"baseline",
                "controller that the others are compared with; empty: the first that neither "
                "filters nor predicts"},
               baseline);
  visitor.Text({"priority",
                "score that decides which controller is recommended: tracking, delay or jitter; "
                "also bounds behind commas, as jitter_rms_deg<=0.1"},
               priority);
  VisitGroup(visitor, {"made_with", "written into resolved scenarios"}, made_with);
}

namespace {

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

LinksConfig LinksOf(const Scenario& scenario, const NamedController& named) {
  LinksConfig links = scenario.link.value_or(LinksConfig{});
  if (!named.receiver) return links;
  if (!links.glove) {
    throw controller::SettingError("controllers." + named.name + ".receiver",
                                   "needs a link from the glove, link.glove");
  }
  links.glove->receiver = *named.receiver;
  return links;
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

const NamedController& FindController(const Scenario& scenario, const std::string& name) {
  const auto found = std::ranges::find(scenario.controllers, name, &NamedController::name);
  if (found != scenario.controllers.end()) return *found;
  std::vector<std::string> names;
  for (const NamedController& controller : scenario.controllers) names.push_back(controller.name);
  throw UserError(
      {.place = "--controller " + name, .problem = "unknown controller" + Suggestion(name, names)});
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

namespace {

void CollectValues(const std::string& key, const YamlNode& node,
                   std::vector<SettingValue>& values) {
  const std::string prefix = key.empty() ? "" : key + ".";
  if (node.IsMap()) {
    for (const auto& [name, value] : node.entries()) {
      CollectValues(prefix + name.text(), value, values);
    }
  } else if (node.IsSequence() && !node.items().empty() && !node.items()[0].IsScalar()) {
    for (std::size_t i = 0; i < node.items().size(); ++i) {
      CollectValues(prefix + std::to_string(i), node.items()[i], values);
    }
  } else if (node.IsSequence()) {
    std::vector<std::string> texts;
    for (const YamlNode& item : node.items()) texts.push_back(item.text());
    values.push_back({key, fmt::format("[{}]", fmt::join(texts, ", "))});
  } else {
    values.push_back({key, node.text()});
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
  CollectValues("", ParseOwnYaml(ScenarioToYaml(scenario, std::filesystem::current_path())),
                values);
  return values;
}

}  // namespace gauntlet::sim
