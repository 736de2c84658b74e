#include "controller/filters/filter_registry.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "controller/filters/check_filter.h"
#include "controller/filters/filter_parts.h"
#include "controller/filters/per_channel_settings.h"
#include "controller/number.h"

namespace gauntlet::controller {
namespace {

std::vector<std::string> NumbersAsNames(int channel_count) {
  std::vector<std::string> names;
  for (int i = 1; i <= channel_count; ++i) names.push_back(std::to_string(i));
  return names;
}

/// Index of a channel that is given by its name, or by its number from 1.
int ChannelOf(const std::string& given, std::span<const std::string> names) {
  const auto named = std::ranges::find(names, given);
  if (named != names.end()) return static_cast<int>(named - names.begin());
  const auto number = ParseWholeNumber(given, 1, std::ssize(names));
  if (number) return static_cast<int>(*number - 1);
  constexpr std::size_t kShown = 3;
  std::string some;
  for (const std::string& name : names.first(std::min(kShown, names.size()))) {
    some += (some.empty() ? "" : ", ") + name;
  }
  throw SettingError("channels", "has " + given + ", must have numbers from 1 to " +
                                     std::to_string(names.size()) + " or names of channels (" +
                                     some + (names.size() > kShown ? ", ..)" : ")"));
}

std::vector<int> ChannelsOf(const FilterConfig& config, std::span<const std::string> names) {
  std::vector<int> channels;
  for (const std::string& given : config.channels) {
    const int channel = ChannelOf(given, names);
    if (std::ranges::find(channels, channel) != channels.end()) {
      throw SettingError("channels", "has " + given + " twice");
    }
    channels.push_back(channel);
  }
  return channels;
}

/// Filter of channels that all have it.
std::unique_ptr<Filter> MakeOfAll(const FilterConfig& config, std::span<const std::string> names,
                                  double rate_hz) {
  const auto count = static_cast<int>(names.size());
  const auto* external = std::get_if<ExternalConfig>(&config.settings);
  if (!config.per_channel.empty() &&
      (external != nullptr || std::holds_alternative<KalmanDenseConfig>(config.settings))) {
    throw SettingError(config.per_channel[0].key,
                       "is a list, must be one value: " + std::string(config.kind()) +
                           " takes all channels together");
  }
  if (external != nullptr) {
    CheckFilter(*external, count, rate_hz);
    if (external->make != nullptr) return external->make->Make(*external, names, rate_hz);
  }
  if (config.per_channel.empty() || count < 1) {
    return std::visit([&](const auto& settings) { return MakeFilter(settings, count, rate_hz); },
                      config.settings);
  }
  std::vector<FilterPart> parts;
  for (int channel = 0; channel < count; ++channel) {
    const FilterSettings one = SettingsOfChannel(config, channel, count);
    parts.push_back(
        {.filter = std::visit(
             [&](const auto& settings) { return MakeFilter(settings, 1, rate_hz); }, one),
         .channels = {channel}});
  }
  return JoinParts(std::move(parts), count);
}

}  // namespace

FilterSettings::FilterSettings() = default;
FilterSettings::FilterSettings(const FilterSettings& other) = default;
FilterSettings::FilterSettings(FilterSettings&& other) noexcept = default;
FilterSettings& FilterSettings::operator=(const FilterSettings& other) = default;
FilterSettings& FilterSettings::operator=(FilterSettings&& other) noexcept = default;
FilterSettings::~FilterSettings() = default;

void FilterConfig::Visit(SettingsVisitor& visitor) {
  const std::size_t kind_before = settings.index();
  ChooseKind(visitor, {.key = "kind", .help = "which filter", .required = true}, settings);
  if (settings.index() != kind_before) per_channel.clear();
  const Setting of_channels = {"channels",
                               "names of the channels that it filters, or their numbers from 1; "
                               "others pass unchanged [all]"};
  if (visitor.ShowsOptional(of_channels, !channels.empty())) visitor.Texts(of_channels, channels);
  VisitWithLists(visitor, per_channel,
                 [this](SettingsVisitor& inner) { VisitChosen(inner, settings); });
}

std::span<const FilterKind> AllFilterKinds() { return AllKinds<FilterConfig>(); }

std::span<const FilterKind> FilterKinds() {
  return AllFilterKinds().first(AllFilterKinds().size() - 1);
}

std::unique_ptr<Filter> MakeFilter(const FilterConfig& config,
                                   std::span<const std::string> channel_names, double rate_hz) {
  const std::vector<int> channels = ChannelsOf(config, channel_names);
  if (channels.empty()) return MakeOfAll(config, channel_names, rate_hz);
  std::vector<std::string> names;
  for (const int channel : channels) {
    names.push_back(channel_names[static_cast<std::size_t>(channel)]);
  }
  std::vector<FilterPart> parts;
  parts.push_back({.filter = MakeOfAll(config, names, rate_hz), .channels = channels});
  return JoinParts(std::move(parts), static_cast<int>(channel_names.size()));
}

std::unique_ptr<Filter> MakeFilter(const FilterConfig& config, int channel_count, double rate_hz) {
  return MakeFilter(config, NumbersAsNames(channel_count), rate_hz);
}

std::unique_ptr<Filter> MakeFilter(const ExternalConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  if (config.make == nullptr) {
    throw SettingError("kind", "is external, a program, which runs only in the simulator's trials");
  }
  return config.make->Make(config, NumbersAsNames(channel_count), rate_hz);
}

}  // namespace gauntlet::controller
