#include "controller/filters/per_channel_settings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "controller/filters/per_channel.h"

namespace gauntlet::controller {
namespace {

/// Passes everything on, and single numbers as lists where there is one.
class ListVisitor final : public SettingsVisitor {
 public:
  ListVisitor(SettingsVisitor& to, std::vector<ChannelValues>& lists) : to_(to), lists_(lists) {}

  void Number(const Setting& setting, double& value) override {
    ShowAsList(setting, value, [&] { to_.Number(setting, value); });
  }
  void Integer(const Setting& setting, int& value) override {
    double number = value;
    ShowAsList(setting, number, [&] {
      to_.Integer(setting, value);
      number = value;
    });
    value = static_cast<int>(number);
  }
  void Flag(const Setting& setting, bool& value) override { to_.Flag(setting, value); }
  void Text(const Setting& setting, std::string& value) override { to_.Text(setting, value); }
  void Path(const Setting& setting, std::string& value) override { to_.Path(setting, value); }
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    to_.Numbers(setting, value);
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    to_.Texts(setting, value);
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    to_.Choice(setting, names, index);
  }
  void Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) override {
    to_.Group(setting, visit);
  }
  void List(const Setting& setting, const SettingList& list) override { to_.List(setting, list); }
  void Map(const Setting& setting, const SettingMap& map) override { to_.Map(setting, map); }
  void NamedNumbers(const Setting& setting, std::vector<NamedNumber>& values) override {
    to_.NamedNumbers(setting, values);
  }
  bool ShowsOptional(const Setting& setting, bool given) override {
    return to_.ShowsOptional(setting, given);
  }

 private:
  template <class ShowOne>
  void ShowAsList(const Setting& setting, double& value, const ShowOne& show_one) {
    const auto known = std::ranges::find(lists_, setting.key, &ChannelValues::key);
    const bool given = known != lists_.end();
    if (!to_.ShowsList(setting, given)) return show_one();
    std::vector<double> values = given ? known->values : std::vector{value};
    to_.Numbers(setting, values);
    // What checks the setting itself sees a value of the list; the length is checked where the
    // number of channels is known.
    if (!values.empty() && std::isfinite(values[0])) {
      value = std::clamp(values[0], setting.min, setting.max);
    }
    if (given) {
      known->values = std::move(values);
    } else {
      lists_.push_back({std::string(setting.key), std::move(values)});
    }
  }

  SettingsVisitor& to_;
  std::vector<ChannelValues>& lists_;
};

/// Puts the values of one channel in place of all lists.
class ChannelSetter final : public SettingsVisitor {
 public:
  ChannelSetter(const std::vector<ChannelValues>& lists, int channel, int channel_count)
      : lists_(lists), channel_(channel), channel_count_(channel_count) {}

  void Number(const Setting& setting, double& value) override {
    const auto found = std::ranges::find(lists_, setting.key, &ChannelValues::key);
    if (found != lists_.end()) value = Of(setting, found->values);
  }
  void Integer(const Setting& setting, int& value) override {
    double number = value;
    Number(setting, number);
    if (number == std::floor(number) && std::abs(number) <= 2147483647.0) {
      value = static_cast<int>(number);
      return;
    }
    throw SettingError(std::string(setting.key),
                       "has " + NumberText(number) + ", must have whole numbers");
  }
  void Numbers(const Setting& /*setting*/, std::vector<double>& value) override {
    if (std::ssize(value) == channel_count_) value = {value[static_cast<std::size_t>(channel_)]};
  }
  void Flag(const Setting& /*setting*/, bool& /*value*/) override {}
  void Text(const Setting& /*setting*/, std::string& /*value*/) override {}
  void Path(const Setting& /*setting*/, std::string& /*value*/) override {}
  void Texts(const Setting& /*setting*/, std::vector<std::string>& /*value*/) override {}
  void Choice(const Setting& /*setting*/, std::span<const std::string_view> /*names*/,
              std::size_t& /*index*/) override {}
  void Group(const Setting& /*setting*/,
             const std::function<void(SettingsVisitor&)>& /*visit*/) override {}
  void List(const Setting& /*setting*/, const SettingList& /*list*/) override {}
  void Map(const Setting& /*setting*/, const SettingMap& /*map*/) override {}

 private:
  double Of(const Setting& setting, const std::vector<double>& values) const {
    return PerChannel(setting.key, values, channel_count_)(channel_);
  }

  const std::vector<ChannelValues>& lists_;
  int channel_;
  int channel_count_;
};

}  // namespace

void VisitWithLists(SettingsVisitor& visitor, std::vector<ChannelValues>& lists,
                    const std::function<void(SettingsVisitor&)>& visit) {
  ListVisitor with_lists(visitor, lists);
  visit(with_lists);
}

FilterSettings SettingsOfChannel(const FilterConfig& config, int channel, int channel_count) {
  FilterSettings settings = config.settings;
  ChannelSetter setter(config.per_channel, channel, channel_count);
  VisitChosen(setter, settings);
  return settings;
}

}  // namespace gauntlet::controller
