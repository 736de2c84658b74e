#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::controller {

/// Declares the std::variant that a type is or derives from; it is not defined.
template <class... Configs>
std::variant<Configs...> VariantOf(const std::variant<Configs...>& settings);

/// "Kind and its settings": the one idiom for filters, predictions, motions and faults.
///
/// Each kind is a config struct of its own with kKind (its name), kSummary, defaults and Visit().
/// All kinds of one thing are a std::variant, which a config holds as `settings`:
///
///     using ShapeSettings = std::variant<CircleConfig, SquareConfig>;
///     struct ShapeConfig {
///       ShapeSettings settings;
///       void Visit(SettingsVisitor& visitor) {
///         VisitKind(visitor, {"kind", "which shape"}, settings);
///       }
///     };
///
/// To add a kind: a file with its struct and the function that all kinds have (MakeFilter,
/// MakeMotion, ..), and one entry in the variant. A kind without that function does not compile.
///
/// A variant of many kinds is a class derived from std::variant. Its copy, move and destructor are
/// defined in one source, so that sources that copy a config do not compile those of every kind.
template <class Settings, class Variant = decltype(VariantOf(std::declval<Settings>()))>
struct KindsOf;
/// The kinds of a variant.
template <class Settings, class... Configs>
struct KindsOf<Settings, std::variant<Configs...>> {
  static constexpr std::size_t kCount = sizeof...(Configs);
  static constexpr std::array<std::string_view, kCount> kNames = {Configs::kKind...};
  static constexpr std::array<std::string_view, kCount> kSummaries = {Configs::kSummary...};

  /// The kind of this index with its own defaults.
  static Settings Defaults(std::size_t index) {
    static constexpr std::array<Settings (*)(), kCount> kMakers = {Make<Configs>...};
    return kMakers.at(index)();
  }

 private:
  template <class Config>
  static Settings Make() {
    return Config{};
  }
};

/// The name of the kind that is chosen.
template <class Settings>
std::string_view KindName(const Settings& settings) {
  return KindsOf<Settings>::kNames[settings.index()];
}

/// Shows the choice of the kind alone. Another kind brings its own defaults.
template <class Settings>
void ChooseKind(SettingsVisitor& visitor, const Setting& setting, Settings& settings) {
  using Kinds = KindsOf<Settings>;
  std::size_t index = settings.index();
  visitor.Choice(setting, Kinds::kNames, index);
  if (index != settings.index() && index < Kinds::kCount) settings = Kinds::Defaults(index);
}

/// Shows the settings of the kind that is chosen.
template <class Settings>
void VisitChosen(SettingsVisitor& visitor, Settings& settings) {
  std::visit([&visitor](auto& config) { config.Visit(visitor); }, settings);
}

/// Shows the choice of the kind, then the settings of that kind.
template <class Settings>
void VisitKind(SettingsVisitor& visitor, const Setting& setting, Settings& settings) {
  ChooseKind(visitor, setting, settings);
  VisitChosen(visitor, settings);
}

/// One kind as lists show it, with the settings it has by default.
template <class Config>
struct Kind {
  std::string_view name;
  std::string_view summary;
  Config defaults;
};

/// All kinds of a config that holds `settings`, in the order of the variant.
template <class Config>
std::span<const Kind<Config>> AllKinds() {
  static const std::vector<Kind<Config>> kKinds = [] {
    using Kinds = KindsOf<decltype(Config::settings)>;
    std::vector<Kind<Config>> kinds;
    for (std::size_t i = 0; i < Kinds::kCount; ++i) {
      Config config;
      config.settings = Kinds::Defaults(i);
      kinds.push_back({Kinds::kNames[i], Kinds::kSummaries[i], std::move(config)});
    }
    return kinds;
  }();
  return kKinds;
}

}  // namespace gauntlet::controller
