#include "sim/settings/setting_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace gauntlet::sim {
namespace {

using controller::Setting;

std::string RangeOf(const Setting& setting) {
  const bool has_min = std::isfinite(setting.min);
  const bool has_max = std::isfinite(setting.max);
  const bool open = setting.open_range;
  if (has_min && has_max) {
    return open ? fmt::format("between {} and {}", setting.min, setting.max)
                : fmt::format("{} to {}", setting.min, setting.max);
  }
  if (has_min) return fmt::format("{} {}", open ? "above" : "at least", setting.min);
  if (has_max) return fmt::format("{} {}", open ? "below" : "at most", setting.max);
  return "";
}

class RowCollector final : public controller::SettingsVisitor {
 public:
  void Number(const Setting& setting, double& value) override {
    Add(setting, fmt::format("{}", value), RangeOf(setting));
  }
  void Integer(const Setting& setting, int& value) override {
    Add(setting, fmt::format("{}", value), RangeOf(setting));
  }
  void Flag(const Setting& setting, bool& value) override {
    Add(setting, value ? "true" : "false", "true, false");
  }
  void Text(const Setting& setting, std::string& value) override { Add(setting, value, ""); }
  void Path(const Setting& setting, std::string& value) override { Add(setting, value, "a path"); }
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    const std::string numbers = value.size() == 1 ? fmt::format("{}", value[0])
                                                  : fmt::format("[{}]", fmt::join(value, ", "));
    const std::string range = RangeOf(setting);
    Add(setting, numbers,
        range.empty() ? "one, or one for each" : range + "; one, or one for each");
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    Add(setting, fmt::format("[{}]", fmt::join(value, ", ")), "a list");
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    Add(setting, std::string(names[index]), fmt::format("{}", fmt::join(names, ", ")));
  }
  void Group(const Setting& setting,
             const std::function<void(controller::SettingsVisitor&)>& visit) override {
    Inside(std::string(setting.key), [&] { visit(*this); });
  }
  void List(const Setting& setting, const controller::SettingList& list) override {
    Add(setting, list.size() == 0 ? "none" : fmt::format("{} given", list.size()), "a list");
  }
  void Map(const Setting& setting, const controller::SettingMap& map) override {
    Add(setting, map.size() == 0 ? "none" : fmt::format("{} given", map.size()),
        map.visit ? "named groups" : "named lists");
  }
  void NamedNumbers(const Setting& setting, std::vector<controller::NamedNumber>& values) override {
    Add(setting, values.empty() ? "none" : fmt::format("{} given", values.size()), "named numbers");
  }
  bool ShowsOptional(const Setting& /*setting*/, bool /*given*/) override { return true; }

  std::vector<SettingRow> rows;

 private:
  void Add(const Setting& setting, std::string value, std::string range) {
    rows.push_back({.key = prefix_ + std::string(setting.key),
                    .default_value = setting.required ? "" : std::move(value),
                    .required = setting.required,
                    .range = std::move(range),
                    .help = std::string(setting.help)});
  }
  void Inside(const std::string& key, const std::function<void()>& visit) {
    const std::string outer = prefix_;
    prefix_ += key + ".";
    visit();
    prefix_ = outer;
  }

  std::string prefix_;
};

}  // namespace

std::vector<SettingRow> ListSettings(
    const std::function<void(controller::SettingsVisitor&)>& visit) {
  RowCollector collector;
  visit(collector);
  return collector.rows;
}

}  // namespace gauntlet::sim
