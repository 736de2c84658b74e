#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "controller/export.h"

namespace gauntlet::controller {

/// Description of one setting for a person. The unit is the suffix of the key (`cutoff_hz`).
/// Written in the order of the fields: {"cutoff_hz", "frequency of -3 dB", 0.1, 20}; with names
/// where a field after `max` is given.
struct GAUNTLET_API Setting {
  std::string_view key;
  std::string_view help;
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  /// A setting without a meaningful default: a file that leaves it out is in error.
  bool required = false;
  /// The limits themselves are not allowed (a stiffness > 0).
  bool open_range = false;
  /// A list of numbers has so many values; 0: any.
  std::size_t count = 0;
};

/// A list of structs, for a visitor that may lengthen it. Items are visited by index.
struct GAUNTLET_API SettingList {
  std::function<std::size_t()> size;
  std::function<void(std::size_t)> resize;
  std::function<void(std::size_t, class SettingsVisitor&)> visit;
};

/// An ordered map from a name to a struct, for a visitor that may add items at the end.
struct GAUNTLET_API SettingMap {
  std::function<std::size_t()> size;
  std::function<std::string(std::size_t)> name;
  std::function<void(const std::string&)> add;
  std::function<void(std::size_t, class SettingsVisitor&)> visit;
};

/// A number that a person names (a parameter of a program).
struct GAUNTLET_API NamedNumber {
  std::string name;
  double value = 0.0;
};

/// Sees every setting of a config struct once: the key, the help, the range and the value.
///
/// Every config struct has a member `void Visit(SettingsVisitor&)`. That one description serves the
/// reader of scenario files, the writer, the lists that `gauntlet list` prints and the check of
/// ranges in constructors. A visitor may change the values.
class GAUNTLET_API SettingsVisitor {
 public:
  virtual ~SettingsVisitor() = default;

  virtual void Number(const Setting& setting, double& value) = 0;
  virtual void Integer(const Setting& setting, int& value) = 0;
  virtual void Flag(const Setting& setting, bool& value) = 0;
  virtual void Text(const Setting& setting, std::string& value) = 0;
  /// A path; a reader makes a relative one relative to the file it reads.
  virtual void Path(const Setting& setting, std::string& value) = 0;
  /// One number for all channels, or one for each.
  virtual void Numbers(const Setting& setting, std::vector<double>& value) = 0;
  virtual void Texts(const Setting& setting, std::vector<std::string>& value) = 0;
  /// One of `names`, by its index.
  virtual void Choice(const Setting& setting, std::span<const std::string_view> names,
                      std::size_t& index) = 0;
  virtual void Group(const Setting& setting,
                     const std::function<void(SettingsVisitor&)>& visit) = 0;
  virtual void List(const Setting& setting, const SettingList& list) = 0;
  virtual void Map(const Setting& setting, const SettingMap& map) = 0;

  /// Numbers whose names are the file's; a visitor may add some at the end.
  virtual void NamedNumbers(const Setting& setting, std::vector<NamedNumber>& values);

  /// True if a setting that may be absent is to be shown. A reader also shows what its file has.
  virtual bool ShowsOptional(const Setting& /*setting*/, bool given) { return given; }
  /// True if Numbers() is to show a single number, with one value for each channel. A reader does
  /// so where its file has a list.
  virtual bool ShowsList(const Setting& /*setting*/, bool given) { return given; }
};

/// A value that a config struct does not allow. `key` is the path of keys, joined by dots.
class GAUNTLET_API SettingError : public std::invalid_argument {
 public:
  SettingError(std::string key, const std::string& problem)
      : std::invalid_argument(key + ": " + problem), key_(std::move(key)), problem_(problem) {}
  const std::string& key() const { return key_; }
  const std::string& problem() const { return problem_; }

 private:
  std::string key_;
  std::string problem_;
};

/// The result of `work`; a SettingError from it gets the path of `key` before its own.
template <class Work>
auto WithinSetting(const std::string& key, const Work& work) {
  try {
    return work();
  } catch (const SettingError& error) {
    throw SettingError(error.key().empty() ? key : key + "." + error.key(), error.problem());
  }
}

/// A number as errors show it: whole numbers exactly, others with six digits.
GAUNTLET_API std::string NumberText(double value);

/// Throws SettingError for a name that appears twice.
GAUNTLET_API void CheckNames(const std::string& key, const std::vector<std::string>& names);

/// The sentence for a number outside its range or not finite; empty if the number is allowed.
GAUNTLET_API std::string RangeProblem(const Setting& setting, double value);
/// The sentence for a list that is too short or too long; empty if its length is allowed.
GAUNTLET_API std::string CountProblem(const Setting& setting, std::size_t count);

/// A choice whose values are an enum starting at 0 in the order of `names`.
template <class Enum>
void VisitEnum(SettingsVisitor& visitor, const Setting& setting,
               std::span<const std::string_view> names, Enum& value) {
  auto index = static_cast<std::size_t>(value);
  visitor.Choice(setting, names, index);
  value = static_cast<Enum>(index);
}

/// A config struct nested under a key.
template <class Config>
void VisitGroup(SettingsVisitor& visitor, const Setting& setting, Config& config) {
  visitor.Group(setting, [&config](SettingsVisitor& inner) { config.Visit(inner); });
}

/// One number for all, or a list with one for each: a single one is shown as a number.
GAUNTLET_API void VisitOneForEach(SettingsVisitor& visitor, const Setting& setting,
                                  std::vector<double>& values);

/// A setting that is absent unless a file has it; then writers leave it out, too. `show` shows the
/// value.
template <class Value, class Show>
void VisitOptional(SettingsVisitor& visitor, const Setting& setting, std::optional<Value>& value,
                   const Show& show) {
  if (!visitor.ShowsOptional(setting, value.has_value())) return;
  if (!value) value.emplace();
  show(*value);
}
/// Config struct, nested under a key, that is absent unless a file has it.
template <class Config>
void VisitOptionalGroup(SettingsVisitor& visitor, const Setting& setting,
                        std::optional<Config>& config) {
  VisitOptional(visitor, setting, config,
                [&](Config& given) { VisitGroup(visitor, setting, given); });
}

/// A std::vector of config structs under a key.
template <class Config>
void VisitList(SettingsVisitor& visitor, const Setting& setting, std::vector<Config>& configs) {
  visitor.List(setting,
               {.size = [&configs] { return configs.size(); },
                .resize = [&configs](std::size_t size) { configs.resize(size); },
                .visit = [&configs](std::size_t index,
                                    SettingsVisitor& inner) { configs[index].Visit(inner); }});
}

/// All settings outside their ranges.
GAUNTLET_API std::vector<SettingError> SettingProblems(
    const std::function<void(SettingsVisitor&)>& visit);
/// Throws SettingError for the first setting of `config` outside its range.
GAUNTLET_API void CheckSettings(const std::function<void(SettingsVisitor&)>& visit);
template <class Config>
void CheckSettings(Config config) {  // by value: a visitor may change what it sees
  CheckSettings(std::function<void(SettingsVisitor&)>(
      [&config](SettingsVisitor& visitor) { config.Visit(visitor); }));
}

}  // namespace gauntlet::controller
