#include "sim/study/recorded_units.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <variant>

#include "controller/number.h"
#include "sim/base/channels.h"
#include "sim/base/signal.h"
#include "sim/glove/motions/recorded_motion.h"
#include "sim/recordings/column_scale.h"

namespace gauntlet::sim {
namespace {

/// A channel's new unit, in which angle_rad = factor * value + offset_rad.
struct RecordedUnitOf {
  ColumnScale scale;
  std::string name;
};

std::optional<RecordedUnitOf> UnitOfChannel(const ColumnMap& map, int channel) {
  const auto is_of_channel = [channel](const ColumnMapping& mapping) {
    return mapping.channel == channel;
  };
  const auto found = std::ranges::find_if(map.channels, is_of_channel);
  if (found == map.channels.end()) return std::nullopt;
  const ColumnMapping& mapping = *found;
  const ColumnScale scale = ScaleOf(mapping, NominalCounts{});
  const bool is_line = std::ranges::count_if(map.channels, is_of_channel) == 1 &&
                       mapping.wraps_at == 0.0 && mapping.envelope_ms == 0.0 && scale.factor != 0.0;
  if (!is_line) {
    return RecordedUnitOf{{.factor = kRadPerDeg},
                          "degrees of the joint, as gauntlet filter --map writes them"};
  }
  if (mapping.unit == RecordedUnit::kCounts) return std::nullopt;
  const bool is_plain = mapping.scale == 1.0 && mapping.offset == 0.0 && mapping.weight == 1.0;
  if (is_plain && mapping.unit == RecordedUnit::kDegrees) return RecordedUnitOf{scale, "degrees"};
  if (is_plain && mapping.unit == RecordedUnit::kRadians) return RecordedUnitOf{scale, "radians"};
  return RecordedUnitOf{scale, "the numbers of its column in the recording"};
}

/// One value for each of the filter's channels.
void ScaleAll(std::vector<double>& values, const std::vector<double>& factors) {
  if (values.size() == 1) values.assign(factors.size(), values[0]);
  const std::size_t count = factors.size();
  if (values.size() == count * count && count > 1) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] *= std::sqrt(factors[i / count] * factors[i % count]);
    }
    return;
  }
  for (std::size_t i = 0; i < std::min(count, values.size()); ++i) values[i] *= factors[i];
}

void ScaleNumber(std::string_view key, double one, const std::vector<double>& factors,
                 controller::FilterConfig& filter) {
  auto found = std::ranges::find(filter.per_channel, key, &controller::ChannelValues::key);
  if (found == filter.per_channel.end()) {
    if (one == 0.0) return;
    filter.per_channel.push_back({.key = std::string(key), .values = {one}});
    found = std::prev(filter.per_channel.end());
  }
  ScaleAll(found->values, factors);
}

/// `per_count`: how much of the new unit a count is, per channel of the filter.
void ScaleFilter(const std::vector<double>& per_count, controller::FilterConfig& filter) {
  std::vector<double> squares, inverse;
  for (const double factor : per_count) {
    squares.push_back(factor * factor);
    inverse.push_back(1.0 / factor);
  }
  std::visit(
      [&](auto& settings) {
        if constexpr (requires { settings.noise.r; }) {
          ScaleAll(settings.noise.r, squares);
          ScaleAll(settings.noise.q, squares);
        } else if constexpr (requires {
                               settings.r;
                               settings.q;
                             }) {
          ScaleAll(settings.r, squares);
          ScaleAll(settings.q, squares);
        } else if constexpr (requires {
                               settings.beta;
                               settings.min_cutoff_hz;
                             }) {
          ScaleNumber("beta", settings.beta, inverse, filter);
        } else if constexpr (requires { settings.max_jerk_per_s3; }) {
          ScaleNumber("max_velocity_per_s", settings.max_velocity_per_s, per_count, filter);
          ScaleNumber("max_acceleration_per_s2", settings.max_acceleration_per_s2, per_count,
                      filter);
          ScaleNumber("max_jerk_per_s3", settings.max_jerk_per_s3, per_count, filter);
        }
      },
      static_cast<controller::FilterSettings::variant&>(filter.settings));
}

/// Those of the channels that a filter names, by name or by number from 1.
std::vector<double> OfFilter(const controller::FilterConfig& filter,
                             const std::vector<std::string>& names,
                             const std::vector<double>& of_all) {
  if (filter.channels.empty()) return of_all;
  std::vector<double> values;
  for (const std::string& channel : filter.channels) {
    const auto found = std::ranges::find(names, channel);
    const auto number = controller::ParseWholeNumber(channel, 1, std::ssize(names));
    if (found == names.end() && !number) continue;
    values.push_back(of_all[found != names.end() ? static_cast<std::size_t>(found - names.begin())
                                                 : static_cast<std::size_t>(*number - 1)]);
  }
  return values;
}

}  // namespace

std::string SharedRecordedUnit(const GloveConfig& config) {
  const auto* motion = std::get_if<RecordedMotionConfig>(&config.motion.settings);
  if (motion == nullptr) return "";
  const ColumnMap map = ReadMapOf(*motion);
  std::string shared;
  for (const ColumnMapping& mapping : map.channels) {
    const auto unit = UnitOfChannel(map, mapping.channel);
    const std::string name = !unit                     ? ""
                             : unit->name == "degrees" ? "deg"
                             : unit->name == "radians" ? "rad"
                                                       : "";
    if (name.empty() || (!shared.empty() && shared != name)) return "";
    shared = name;
  }
  return shared;
}

RecordedUnits UseRecordedUnits(const GloveConfig& config, controller::RobotConfig& robot) {
  const auto* motion = std::get_if<RecordedMotionConfig>(&config.motion.settings);
  controller::GloveCalibration& glove = robot.glove;
  if (motion == nullptr || motion->use != RecordingUse::kMeasured ||
      robot.controller.linearisation.kind != controller::LinearisationKind::kGlove) {
    return {};
  }
  const ColumnMap map = ReadMapOf(*motion);
  std::vector<controller::ConverterRange> converters = controller::ConvertersOf(glove);
  const std::size_t count = glove.channel_names.size();
  std::vector<double> per_count(count, 1.0);
  std::map<std::string, std::vector<std::string>> channels_by_unit;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string& name = glove.channel_names[i];
    const bool is_own = std::ranges::find(config.calibration, name, &OwnCalibration::channel) !=
                        config.calibration.end();
    const auto unit = is_own ? std::nullopt : UnitOfChannel(map, ChannelIndex(name));
    if (!unit) continue;
    const double rad_per_count = (glove.high_angle_rad[i] - glove.low_angle_rad[i]) /
                                 (glove.high_counts[i] - glove.low_counts[i]);
    const auto value_at = [&](double counts) {
      const double angle_rad =
          glove.low_angle_rad[i] + rad_per_count * (counts - glove.low_counts[i]);
      return std::round((angle_rad - unit->scale.offset_rad) / unit->scale.factor * 1e9) * 1e-9;
    };
    per_count[i] = std::abs(rad_per_count / unit->scale.factor);
    const auto [least, most] = std::minmax(
        {value_at(converters[i].min_counts), value_at(converters[i].full_scale_counts)});
    converters[i] = {.min_counts = least, .full_scale_counts = most};
    const auto [low, high] =
        std::pair{value_at(glove.low_counts[i]), value_at(glove.high_counts[i])};
    glove.low_counts[i] = low;
    glove.high_counts[i] = high;
    channels_by_unit[unit->name].push_back(name);
  }
  if (channels_by_unit.empty()) return {};
  glove.min_counts.clear();
  glove.full_scale_counts.clear();
  for (const controller::ConverterRange& range : converters) {
    glove.min_counts.push_back(range.min_counts);
    glove.full_scale_counts.push_back(range.full_scale_counts);
  }
  if (robot.controller.filter_on == controller::FilterOn::kCounts) {
    for (controller::FilterConfig& filter : robot.controller.filters) {
      ScaleFilter(OfFilter(filter, glove.channel_names, per_count), filter);
    }
  }
  std::vector<std::string> units;
  for (const auto& [unit, channels] : channels_by_unit) {
    units.push_back(fmt::format("{} ({})", unit, fmt::join(channels, ", ")));
  }
  return {.units = fmt::format("a sample of the glove is: {}", fmt::join(units, "; ")),
          .assumptions = AssumptionsOf(map)};
}

}  // namespace gauntlet::sim
