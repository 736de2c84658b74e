#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/filters/filter_config.h"
#include "controller/settings.h"

namespace gauntlet::sim {

/// The filter of one channel, as a program outside Gauntlet gets it.
struct PlainFilter {
  controller::FilterSettings settings;  // for a signal in `unit`
  double rate_hz = 1000.0;
  std::string unit = "deg";
  double start_variance = 1.0;  // of a Kalman filter's first state [unit^2]
};

/// A filter as the settings of another library, as that library means them.
class LikeSettings {
 public:
  LikeSettings() = default;
  LikeSettings(const LikeSettings&) = delete;
  LikeSettings& operator=(const LikeSettings&) = delete;
  virtual ~LikeSettings() = default;

  virtual void Visit(controller::SettingsVisitor& visitor) = 0;
  /// The filter of Gauntlet at `rate_hz`; its settings are for a signal in unit().
  /// Errors: SettingError.
  virtual controller::FilterSettings At(double rate_hz) const = 0;
  /// deg, rad or counts; empty: not given.
  virtual std::string unit() const { return ""; }
  /// The setting that depends on the unit, and its own unit, as a sentence says it; empty: none.
  virtual std::string_view DependsOnUnit() const { return ""; }
  /// At() differs from rate to rate, even where its filter counts samples.
  virtual bool DependsOnRate() const { return false; }
};

/// For Library::like.
template <class Like>
std::unique_ptr<LikeSettings> MakeLike() {
  return std::make_unique<Like>();
}

/// A library of filters, or a language for one that is written out.
struct Library {
  std::string_view name;     // of `export --for` and of `like`
  std::string_view package;  // with the version that the lines were run with
  std::string_view comment;  // mark of a comment
  std::vector<std::string_view> kinds;
  /// A setting of Gauntlet's filter that is so there, as `speed_from: raw`; empty: none.
  std::string_view fixed = {};
  /// Differences from Gauntlet's filter, a sentence each.
  std::vector<std::string_view> differences;
  /// The filter as lines; empty where the library has none with these settings.
  std::string (*lines)(const PlainFilter& filter);
  /// The settings that `like` reads; null: none.
  std::unique_ptr<LikeSettings> (*like)();
  std::string_view like_kind = {};  // of the filter that these are
};

/// All of them, in the order of every list.
std::span<const Library> Libraries();
/// The library of this name. Errors: SettingError for a name that there is not.
const Library& FindLibrary(const std::string& name);
/// True if the library has lines for the filter.
bool HasFilter(const Library& library, const PlainFilter& filter);

/// One row of Libraries() each.
Library OneEuroOfPypi();
Library OneEuroOfNpm();
Library MediaPipe();
Library DexRetargeting();
Library OpenTeleVision();
Library WujiRetargeting();
Library ScipySignal();
Library FilterPy();
Library LeRobot();
Library PlainC();
Library PlainJavaScript();

/// A number of a line: 12 digits, which no filter tells from all of them.
std::string LineNumber(double value);

}  // namespace gauntlet::sim
