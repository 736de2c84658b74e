#include "sim/study/scenario/filter_input.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/glove.h"

namespace gauntlet::sim {
namespace {

/// Multiplies what depends on the unit.
class UnitChange final : public controller::SettingsVisitor {
 public:
  UnitChange(std::string_view kind, double factor) : kind_(kind), factor_(factor) {}

  void Number(const controller::Setting& setting, double& value) override {
    value *= FactorOf(setting);
  }
  void Numbers(const controller::Setting& setting, std::vector<double>& values) override {
    for (double& value : values) value *= FactorOf(setting);
  }
  void Integer(const controller::Setting&, int&) override {}
  void Flag(const controller::Setting&, bool&) override {}
  void Text(const controller::Setting&, std::string&) override {}
  void Path(const controller::Setting&, std::string&) override {}
  void Texts(const controller::Setting&, std::vector<std::string>&) override {}
  void Choice(const controller::Setting&, std::span<const std::string_view>,
              std::size_t&) override {}
  void Group(const controller::Setting&,
             const std::function<void(controller::SettingsVisitor&)>& visit) override {
    visit(*this);
  }
  void List(const controller::Setting&, const controller::SettingList&) override {}
  void Map(const controller::Setting&, const controller::SettingMap&) override {}

 private:
  double FactorOf(const controller::Setting& setting) const {
    return std::pow(factor_, PowerOfInput(kind_, setting.key));
  }

  std::string_view kind_;
  double factor_;
};

}  // namespace

double FilterInput::FactorTo(std::string_view unit) const {
  const double per_rad = unit == "deg" ? kDegPerRad : unit == "counts" ? counts_per_rad : 1.0;
  return per_rad / unit_per_rad;
}

std::vector<std::string> ChannelsOfFilters(const Scenario& scenario) {
  return NominalCalibration(scenario.glove).channel_names;
}

FilterInput InputOf(const Scenario& scenario, const controller::ControllerConfig& config,
                    std::optional<int> channel) {
  const controller::Timing timing = TimingOf(scenario).controller;
  FilterInput input;
  input.rate_hz = config.filter_at == controller::FilterAt::kEvent ? timing.event_rate_hz()
                                                                   : timing.sample_rate_hz();
  const controller::GloveCalibration glove = NominalCalibration(scenario.glove);
  std::vector<double> scales;
  for (std::size_t c = 0; c < glove.channel_names.size(); ++c) {
    if (channel && static_cast<std::size_t>(*channel) != c) continue;
    scales.push_back(std::abs((glove.high_counts[c] - glove.low_counts[c]) /
                              (glove.high_angle_rad[c] - glove.low_angle_rad[c])));
  }
  double sum = 0.0;
  for (const double scale : scales) sum += scale;
  input.counts_per_rad = sum / static_cast<double>(scales.size());
  const auto [least, most] = std::ranges::minmax(scales);
  input.least_counts_per_rad = least;
  input.most_counts_per_rad = most;
  if (config.filter_on == controller::FilterOn::kCounts) input.unit_per_rad = input.counts_per_rad;
  return input;
}

int PowerOfInput(std::string_view kind, std::string_view key) {
  if (kind == "one_euro" && key == "beta") return -1;
  if (kind == "jerk_limit") return 1;
  return key == "q" || key == "r" ? 2 : 0;
}

controller::FilterSettings WithInputUnit(const controller::FilterSettings& settings,
                                         double factor) {
  controller::FilterSettings changed = settings;
  UnitChange change(controller::KindName(settings), factor);
  controller::VisitChosen(change, changed);
  return changed;
}

}  // namespace gauntlet::sim
