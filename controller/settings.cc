#include "controller/settings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "controller/number.h"

namespace gauntlet::controller {
namespace {

std::string RangeText(const Setting& setting) {
  const bool has_min = std::isfinite(setting.min);
  const bool has_max = std::isfinite(setting.max);
  const char* at_least = setting.open_range ? "above " : "at least ";
  const char* at_most = setting.open_range ? "below " : "at most ";
  if (has_min && has_max) {
    return (setting.open_range ? "between " : "from ") + NumberText(setting.min) +
           (setting.open_range ? " and " : " to ") + NumberText(setting.max);
  }
  if (has_min) return at_least + NumberText(setting.min);
  if (has_max) return at_most + NumberText(setting.max);
  return "any finite number";
}

/// Hands every value that is not allowed to `fail`; changes nothing.
class RangeChecker final : public SettingsVisitor {
 public:
  using Failing = std::function<void(const SettingError&)>;
  explicit RangeChecker(Failing fail) : fail_(std::move(fail)) {}

  void Number(const Setting& setting, double& value) override { Check(setting, value); }
  void Integer(const Setting& setting, int& value) override { Check(setting, value); }
  void Flag(const Setting&, bool&) override {}
  void Text(const Setting& setting, std::string& value) override { CheckGiven(setting, value); }
  void Path(const Setting& setting, std::string& value) override { CheckGiven(setting, value); }
  void Texts(const Setting&, std::vector<std::string>&) override {}
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    if (setting.required && value.empty()) Fail(setting, "is missing");
    if (const std::string problem = CountProblem(setting, value.size()); !problem.empty()) {
      Fail(setting, problem);
    }
    for (const double number : value) Check(setting, number);
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    if (index >= names.size()) Fail(setting, "is none of the choices");
  }
  void Group(const Setting& setting, const std::function<void(SettingsVisitor&)>& visit) override {
    Inside(std::string(setting.key), [&] { visit(*this); });
  }
  void List(const Setting& setting, const SettingList& list) override {
    for (std::size_t i = 0; i < list.size(); ++i) {
      Inside(std::string(setting.key) + "[" + std::to_string(i) + "]",
             [&] { list.visit(i, *this); });
    }
  }
  void Map(const Setting& setting, const SettingMap& map) override {
    for (std::size_t i = 0; i < map.size(); ++i) {
      Inside(std::string(setting.key) + "." + map.name(i), [&] { map.visit(i, *this); });
    }
  }

 private:
  void Check(const Setting& setting, double value) const {
    if (const std::string problem = RangeProblem(setting, value); !problem.empty()) {
      Fail(setting, problem);
    }
  }
  void CheckGiven(const Setting& setting, const std::string& value) const {
    if (setting.required && value.empty()) Fail(setting, "is missing");
  }
  void Fail(const Setting& setting, const std::string& problem) const {
    fail_(SettingError(place_ + std::string(setting.key), problem));
  }
  void Inside(const std::string& key, const std::function<void()>& visit) {
    const std::string outer = place_;
    place_ += key + ".";
    visit();
    place_ = outer;
  }

  Failing fail_;
  std::string place_;
};

}  // namespace

void SettingsVisitor::NamedNumbers(const Setting& setting, std::vector<NamedNumber>& values) {
  Group(setting, [&values](SettingsVisitor& inner) {
    for (NamedNumber& number : values) {
      inner.Number({.key = number.name, .help = "as named"}, number.value);
    }
  });
}

void VisitOneForEach(SettingsVisitor& visitor, const Setting& setting,
                     std::vector<double>& values) {
  if (visitor.ShowsList(setting, values.size() != 1)) return visitor.Numbers(setting, values);
  double one = values.size() == 1 ? values[0] : kNaN;
  visitor.Number(setting, one);
  if (!std::isnan(one)) values = {one};  // else a reader whose file has none: the list stays
}

std::string NumberText(double value) {
  constexpr double kExact = 1e15;  // whole numbers up to here have all their digits
  const bool whole = std::abs(value) < kExact && value == std::floor(value);
  char text[32];
  std::snprintf(text, sizeof text, whole ? "%.0f" : "%.6g", value);
  return text;
}

std::string RangeProblem(const Setting& setting, double value) {
  const bool inside = setting.open_range ? value > setting.min && value < setting.max
                                         : value >= setting.min && value <= setting.max;
  if (std::isfinite(value) && inside) return "";
  // As it was given: rounded, a number just outside would look like one inside.
  char text[32];
  const auto end = std::to_chars(std::begin(text), std::end(text), value).ptr;
  return "is " + std::string(std::begin(text), end) + ", must be " + RangeText(setting);
}

std::string CountProblem(const Setting& setting, std::size_t count) {
  if (setting.count == 0 || setting.count == count) return "";
  return "has " + std::to_string(count) + " values, must have " + std::to_string(setting.count);
}

void CheckNames(const std::string& key, const std::vector<std::string>& names) {
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) == name) continue;
    throw SettingError(key, *name + " appears twice");
  }
}

void CheckSettings(const std::function<void(SettingsVisitor&)>& visit) {
  RangeChecker checker([](const SettingError& error) { throw error; });
  visit(checker);
}

std::vector<SettingError> SettingProblems(const std::function<void(SettingsVisitor&)>& visit) {
  std::vector<SettingError> problems;
  RangeChecker checker([&](const SettingError& error) { problems.push_back(error); });
  visit(checker);
  return problems;
}

}  // namespace gauntlet::controller
