#include "sim/study/scenario/like_filters.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/settings/yaml_reader.h"
#include "sim/study/scenario/filter_input.h"

namespace gauntlet::sim {
namespace {

/// The keys of such a filter.
struct LikeKeys {
  LikeSettings& settings;
  std::string kind = {};
  std::string library = {};
  std::vector<std::string> channels = {};

  void Visit(controller::SettingsVisitor& visitor) {
    visitor.Text({.key = "kind", .help = "", .required = true}, kind);
    visitor.Text({.key = "like", .help = "", .required = true}, library);
    visitor.Texts({"channels", ""}, channels);
    settings.Visit(visitor);
  }
};

/// The error at the key of the filter, or at the filter for a key that is not there.
UserError AtKey(const YamlNode& node, const std::string& path, const YamlSource& source,
                const controller::SettingError& error) {
  const YamlNode& key = ChildOf(node, error.key());
  return source.At(key.IsDefined() ? key : node,
                   controller::SettingError(path.empty() ? error.key() : path + "." + error.key(),
                                            error.problem()));
}

const Library& LibraryOf(const std::string& name) {
  const Library& library = FindLibrary(name);
  if (library.like != nullptr) return library;
  throw controller::SettingError("like", name +
                                             " has no settings that can be read; its filters are "
                                             "those of Gauntlet (gauntlet export --for)");
}

YamlNode WithoutLike(const YamlNode& node) {
  std::vector<YamlNode::Entry> kept;
  for (const auto& entry : node.entries()) {
    const std::string& key = entry.first.text();
    if (key == "kind" || key == "channels") kept.push_back(entry);
  }
  return YamlNode::Map(std::move(kept), node.place());
}

/// Settings for the unit of the input: for each channel where their scales differ.
void UseScales(const Scenario& scenario, const controller::ControllerConfig& config,
               const LikeFilter& like, const YamlSource& source, controller::FilterConfig& filter) {
  const auto scaled = [&](std::optional<int> channel) {
    const FilterInput input = InputOf(scenario, config, channel);
    return WithInputUnit(like.At(input.rate_hz, "", source),
                         1.0 / input.FactorTo(like.settings->unit()));
  };
  filter.settings = scaled({});
  if (!filter.channels.empty() ||
      !std::holds_alternative<controller::OneEuroConfig>(filter.settings))
    return;
  controller::ChannelValues betas{.key = "beta", .values = {}};
  const std::size_t count = ChannelsOfFilters(scenario).size();
  for (std::size_t i = 0; i < count; ++i) {
    betas.values.push_back(std::get<controller::OneEuroConfig>(scaled(static_cast<int>(i))).beta);
  }
  if (std::ranges::adjacent_find(betas.values, std::ranges::not_equal_to()) != betas.values.end()) {
    filter.per_channel = {std::move(betas)};
  }
}

}  // namespace

controller::FilterSettings LikeFilter::At(double rate_hz, std::string_view unit,
                                          const YamlSource& source) const {
  try {
    const controller::FilterSettings own = settings->At(rate_hz);
    const std::string given = settings->unit();
    if (settings->DependsOnUnit().empty() || unit.empty() || given == unit) return own;
    if (given == "counts" || unit == "counts") {
      throw controller::SettingError("unit",
                                     fmt::format("is {}, must be {}, that of the signal", given,
                                                 unit == "counts" ? "counts" : "deg or rad"));
    }
    return WithInputUnit(own, given == "rad" ? kDegPerRad : kRadPerDeg);
  } catch (const controller::SettingError& error) {
    throw AtKey(node, path, source, error);
  }
}

std::optional<LikeFilter> TakeLikeFilter(YamlNode& filter, std::string path,
                                         const YamlSource& source) {
  if (!ChildOf(filter, "like").IsDefined()) return {};
  LikeFilter like{.path = std::move(path), .node = filter, .settings = {}};
  try {
    const Library& library = LibraryOf(ChildOf(filter, "like").text());
    like.settings = library.like();
    LikeKeys keys{.settings = *like.settings};
    YamlReader reader(filter, like.path, source);
    keys.Visit(reader);
    reader.RejectUnknownKeys();
    if (keys.kind != library.like_kind) {
      throw controller::SettingError(
          "kind", fmt::format("is {}, must be {}", keys.kind, library.like_kind));
    }
    if (!like.settings->DependsOnUnit().empty() && like.settings->unit().empty()) {
      throw controller::SettingError("unit",
                                     fmt::format("must be given: {} of the signal (deg, rad or "
                                                 "counts)",
                                                 like.settings->DependsOnUnit()));
    }
  } catch (const controller::SettingError& error) {
    throw AtKey(filter, like.path, source, error);
  }
  filter = WithoutLike(filter);
  return like;
}

std::vector<LikeFilterOf> TakeLikeFilters(YamlNode& root, const YamlSource& source) {
  std::vector<LikeFilterOf> taken;
  const YamlNode controllers = ChildOf(root, "controllers");
  std::vector<YamlNode::Entry> entries = controllers.entries();
  for (auto& [name, controller] : entries) {
    const std::string& of = name.text();
    const auto take = [&](YamlNode& filter, std::size_t index, std::string path) {
      auto like = TakeLikeFilter(filter, std::move(path), source);
      if (like) {
        taken.push_back({.controller = of, .index = index, .filter = *std::move(like)});
      }
      return like.has_value();
    };
    YamlNode filter = ChildOf(controller, "filter");
    const std::string path = fmt::format("controllers.{}.filter", of);
    bool is_taken = false;
    if (filter.IsSequence()) {
      std::vector<YamlNode> items = filter.items();
      for (std::size_t i = 0; i < items.size(); ++i) {
        is_taken = take(items[i], i, fmt::format("{}[{}]", path, i)) || is_taken;
      }
      filter = YamlNode::Sequence(std::move(items), filter.place());
    } else {
      is_taken = take(filter, 0, path);
    }
    if (is_taken) controller = WithChild(controller, "filter", filter);
  }
  if (taken.empty()) return taken;
  root = WithChild(root, "controllers", YamlNode::Map(std::move(entries), controllers.place()));
  return taken;
}

void UseLikeFilters(const std::vector<LikeFilterOf>& filters, const YamlSource& source,
                    Scenario& scenario) {
  for (const LikeFilterOf& like : filters) {
    const auto named =
        std::ranges::find(scenario.controllers, like.controller, &NamedController::name);
    if (named == scenario.controllers.end()) continue;
    UseScales(scenario, named->config, like.filter, source, named->config.filters[like.index]);
  }
}

}  // namespace gauntlet::sim
