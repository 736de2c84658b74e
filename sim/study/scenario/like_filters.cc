#include "sim/study/scenario/like_filters.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "sim/base/error.h"
#include "sim/settings/yaml_reader.h"
#include "sim/study/scenario/filter_input.h"

namespace gauntlet::sim {
namespace {

/// The keys of such a filter.
struct LikeKeys {
  LikeFilter& filter;
  std::vector<std::string> channels = {};

  void Visit(controller::SettingsVisitor& visitor) {
    visitor.Text({.key = "kind", .help = "", .required = true}, filter.kind);
    visitor.Text({.key = "like", .help = "", .required = true}, filter.library);
    visitor.Texts({"channels", ""}, channels);
    filter.settings->Visit(visitor);
  }
};

LikeFilter Read(const std::string& controller, std::size_t index, std::string path,
                const YamlNode& node, const YamlSource& source) {
  LikeFilter filter{.controller = controller,
                    .index = index,
                    .path = std::move(path),
                    .node = node,
                    .kind = {},
                    .library = ChildOf(node, "like").text(),
                    .settings = {}};
  try {
    const Library& library = FindLibrary(filter.library);
    if (library.like == nullptr) {
      throw controller::SettingError(
          "like", filter.library +
                      " has no settings that can be read; its filters are those of "
                      "Gauntlet (gauntlet export --for)");
    }
    filter.settings = library.like();
    LikeKeys keys{.filter = filter};
    YamlReader reader(node, filter.path, source);
    keys.Visit(reader);
    reader.RejectUnknownKeys();
  } catch (const controller::SettingError& error) {
    throw source.At(ChildOf(node, error.key()),
                    controller::SettingError(filter.path + "." + error.key(), error.problem()));
  }
  return filter;
}

YamlNode WithoutLike(const YamlNode& node) {
  std::vector<YamlNode::Entry> kept;
  for (const auto& entry : node.entries()) {
    const std::string& key = entry.first.text();
    if (key == "kind" || key == "channels") kept.push_back(entry);
  }
  return YamlNode::Map(std::move(kept), node.place());
}

bool IsLike(const YamlNode& node) { return ChildOf(node, "like").IsDefined(); }

/// Settings for the unit of the input: for each channel where their scales differ.
void UseScales(const Scenario& scenario, const controller::ControllerConfig& config,
               const LikeSettings& like, const std::string& given_kind,
               controller::FilterConfig& filter) {
  const auto scaled = [&](std::optional<int> channel) {
    const FilterInput input = InputOf(scenario, config, channel);
    return WithInputUnit(like.At(input.rate_hz), 1.0 / input.FactorTo(like.unit()));
  };
  filter.settings = scaled({});
  const std::string_view kind = controller::KindName(filter.settings);
  if (kind != given_kind) {
    throw controller::SettingError("kind", fmt::format("is {}, must be {}", given_kind, kind));
  }
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

std::vector<LikeFilter> TakeLikeFilters(YamlNode& root, const YamlSource& source) {
  std::vector<LikeFilter> taken;
  const YamlNode controllers = ChildOf(root, "controllers");
  std::vector<YamlNode::Entry> entries = controllers.entries();
  for (auto& [name, controller] : entries) {
    const YamlNode filter = ChildOf(controller, "filter");
    const std::string path = fmt::format("controllers.{}.filter", name.text());
    if (filter.IsSequence() && std::ranges::any_of(filter.items(), IsLike)) {
      std::vector<YamlNode> items = filter.items();
      for (std::size_t i = 0; i < items.size(); ++i) {
        if (!IsLike(items[i])) continue;
        taken.push_back(Read(name.text(), i, fmt::format("{}[{}]", path, i), items[i], source));
        items[i] = WithoutLike(items[i]);
      }
      controller =
          WithChild(controller, "filter", YamlNode::Sequence(std::move(items), filter.place()));
    } else if (IsLike(filter)) {
      taken.push_back(Read(name.text(), 0, path, filter, source));
      controller = WithChild(controller, "filter", WithoutLike(filter));
    }
  }
  if (taken.empty()) return taken;
  root = WithChild(root, "controllers", YamlNode::Map(std::move(entries), controllers.place()));
  return taken;
}

void UseLikeFilters(const std::vector<LikeFilter>& filters, const YamlSource& source,
                    Scenario& scenario) {
  for (const LikeFilter& like : filters) {
    const auto named =
        std::ranges::find(scenario.controllers, like.controller, &NamedController::name);
    if (named == scenario.controllers.end()) continue;
    try {
      UseScales(scenario, named->config, *like.settings, like.kind,
                named->config.filters[like.index]);
    } catch (const controller::SettingError& error) {
      const YamlNode& key = ChildOf(like.node, error.key());
      throw source.At(key.IsDefined() ? key : like.node,
                      controller::SettingError(like.path + "." + error.key(), error.problem()));
    }
  }
}

}  // namespace gauntlet::sim
