#include "sim/study/scenario/like_filters.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "sim/settings/input_unit.h"
#include "sim/study/scenario/filter_input.h"

namespace gauntlet::sim {
namespace {

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

std::vector<LikeFilterOf> ExtractLikeFilters(YamlNode& root, const YamlSource& source) {
  std::vector<LikeFilterOf> taken;
  const YamlNode controllers = ChildOf(root, "controllers");
  std::vector<YamlNode::Entry> entries = controllers.entries();
  for (auto& [name, controller] : entries) {
    const std::string& of = name.text();
    const auto take = [&](YamlNode& filter, std::size_t index, std::string path) {
      auto like = ExtractLikeFilter(filter, std::move(path), source);
      if (!like) return false;
      taken.push_back({.controller = of, .index = index, .filter = *std::move(like)});
      return true;
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
