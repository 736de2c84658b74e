#include "sim/study/scenario/controller_defaults.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/glove/glove.h"
#include "sim/settings/glove_calibration.h"
#include "sim/settings/identified_chain.h"
#include "sim/settings/yaml_reader.h"

namespace gauntlet::sim {
namespace {

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

}  // namespace

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

void FillControllers(const YamlNode& root, const YamlSource& source,
                     const std::vector<AutoHorizon>& auto_horizons, Scenario& scenario) {
  const std::vector<std::string> channels = ChannelNamesOf(scenario.glove, root, source);
  IncludeCalibrations(root, source, channels, scenario);
  IncludeChains(root, source, auto_horizons, channels, scenario);
  FillMeasurementVariances(root, source, channels, scenario);
}

}  // namespace gauntlet::sim
