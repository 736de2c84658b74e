#include "sim/settings/input_unit.h"

#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

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
