#include "sim/cli/export_lines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>
#include <variant>
#include <vector>

#include "controller/filters/kalman_noise.h"
#include "controller/filters/per_channel_settings.h"
#include "sim/answers/compare/study_folder.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/results/table_text.h"
#include "sim/score/score.h"
#include "sim/settings/libraries/library.h"
#include "sim/study/scenario/filter_input.h"

namespace gauntlet::sim {
namespace {

constexpr double kNoDifference = 1e-9;  // of scales

UserError Mistake(const LinesRequest& request, std::string problem) {
  return UserError({.place = "--for " + request.library, .problem = std::move(problem)});
}

std::optional<int> ChannelOf(const Scenario& scenario, const LinesRequest& request) {
  if (request.channel.empty()) return {};
  const std::vector<std::string> names = ChannelsOfFilters(scenario);
  const auto found = std::ranges::find(names, request.channel);
  if (found == names.end()) {
    throw UserError(
        {.place = "--channel " + Shown(request.channel),
         .problem = "is not a channel of the scenario" + Suggestion(request.channel, names)});
  }
  return static_cast<int>(found - names.begin());
}

/// The one value of a list, that of the channel, or none if they differ.
bool KeepOne(std::vector<double>& values, std::optional<int> channel) {
  if (channel && std::cmp_less(*channel, values.size()) && values.size() > 1) {
    values = {values[static_cast<std::size_t>(*channel)]};
  }
  if (std::ranges::adjacent_find(values, std::ranges::not_equal_to()) != values.end()) return false;
  values.resize(std::min<std::size_t>(values.size(), 1));
  return true;
}

/// The settings of one channel, or of all if they are the same. Errors: the key that differs.
std::variant<controller::FilterSettings, std::string> OneFilter(
    const controller::FilterConfig& config, std::optional<int> channel, int channel_count) {
  if (!channel && !config.per_channel.empty()) return config.per_channel.front().key;
  controller::FilterSettings settings =
      channel ? controller::SettingsOfChannel(config, *channel, channel_count) : config.settings;
  std::string differs;
  std::visit(
      [&](auto& of_kind) {
        std::vector<double>* r = controller::MeasurementVarianceOf(of_kind);
        if (r != nullptr && !KeepOne(*r, channel)) differs = "r";
        if constexpr (requires { of_kind.noise.q; }) {
          if (!KeepOne(of_kind.noise.q, channel)) differs = "q";
        }
      },
      settings);
  if (!differs.empty()) return differs;
  return settings;
}

/// `channel` is one of those that the filter names, by name or by number from 1, or it names none.
bool Filters(const controller::FilterConfig& filter, int channel, const std::string& name) {
  return filter.channels.empty() || std::ranges::count(filter.channels, name) > 0 ||
         std::ranges::count(filter.channels, std::to_string(channel + 1)) > 0;
}

std::string UnitOf(const Scenario& scenario, const LinesRequest& request) {
  if (!request.unit.empty()) return request.unit;
  return scenario.glove.calibration.empty() ? "deg" : "counts";
}

/// The part of a controller beside its filter that changes where the hand goes; empty if there is
/// none.
std::string_view BesideTheFilter(const controller::ControllerConfig& config) {
  if (config.prediction.kind() != "none") return "a prediction";
  if (config.model_predictive.kind != controller::ModelPredictiveKind::kNone) {
    return "model-predictive commands";
  }
  return config.joint_loop.kind == controller::JointLoopKind::kNone ? "" : "a joint loop";
}

/// The filter of a controller for the user's signal; a sentence where it is none.
std::variant<PlainFilter, std::string> PlainFilterOf(const Scenario& scenario,
                                                     const NamedController& named,
                                                     const LinesRequest& request) {
  const std::optional<int> channel = ChannelOf(scenario, request);
  const controller::ControllerConfig& config = named.config;
  if (const std::string_view beside = BesideTheFilter(config); !beside.empty()) {
    return fmt::format(
        "{} also has {}, which no library here has: give a controller with a filter alone",
        named.name, beside);
  }
  if (config.filters.size() > 1) {
    return fmt::format("{} has {} filters, must have one", named.name, config.filters.size());
  }
  controller::FilterConfig filter;
  if (!config.filters.empty()) filter = config.filters.front();
  if (!filter.channels.empty() && !channel) {
    return fmt::format("{} filters some channels only: give --channel", named.name);
  }
  if (channel && !Filters(filter, *channel, request.channel)) {
    return fmt::format("{} does not filter {}", named.name, request.channel);
  }
  const auto one = OneFilter(filter, channel, static_cast<int>(ChannelsOfFilters(scenario).size()));
  if (const auto* differs = std::get_if<std::string>(&one)) {
    return fmt::format("{} of {} differs from channel to channel: give --channel", *differs,
                       named.name);
  }
  const FilterInput input = InputOf(scenario, config, channel);
  const double factor = input.FactorTo(UnitOf(scenario, request));
  return PlainFilter{.settings = WithInputUnit(std::get<controller::FilterSettings>(one), factor),
                     .rate_hz = input.rate_hz,
                     .unit = UnitOf(scenario, request),
                     .start_variance = factor * factor};
}

/// Scores of a controller, means over the seeds; NaN where there is none.
double ScoreOf(const ScoreFile& scores, const std::string& controller, const char* key) {
  const auto found = std::ranges::find(scores.controllers, controller);
  if (found == scores.controllers.end()) return std::nan("");
  const auto& values =
      scores
          .summary[static_cast<std::size_t>(found - scores.controllers.begin())][MetricIndex(key)];
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// "smooth (butterworth): tracking error 1.3 in place of 1.2 deg RMS, delay .., jitter ..": the
/// controller of the folder with the least tracking error among those whose filter the library has;
/// empty if there is none.
std::string NearestInFolder(const Scenario& scenario, const Library& library,
                            const LinesRequest& request) {
  const ScoreFile scores = ReadStudyFolder(request.folder).scores;
  const NamedController* nearest = nullptr;
  double least = 0.0;
  for (const NamedController& named : scenario.controllers) {
    if (named.config.filters.empty()) continue;
    const auto filter = PlainFilterOf(scenario, named, request);
    const auto* plain = std::get_if<PlainFilter>(&filter);
    const double error = ScoreOf(scores, named.name, "tracking_rmse_deg");
    if (plain == nullptr || !HasFilter(library, *plain) || !std::isfinite(error)) continue;
    if (std::holds_alternative<controller::NoFilterConfig>(plain->settings)) continue;
    if (nearest != nullptr && error >= least) continue;
    nearest = &named;
    least = error;
  }
  if (nearest == nullptr) return "";
  std::vector<std::string> prices;
  for (const auto& [key, name, unit] :
       {std::tuple{"tracking_rmse_deg", "tracking error", "deg RMS"},
        std::tuple{"delay_ms", "delay", "ms"}, std::tuple{"jitter_rms_deg", "jitter", "deg RMS"}}) {
    prices.push_back(fmt::format("{} {:.3g} in place of {:.3g} {}", name,
                                 ScoreOf(scores, nearest->name, key),
                                 ScoreOf(scores, request.controller, key), unit));
  }
  return fmt::format("{} ({}): {}", nearest->name, nearest->config.filters.front().kind(),
                     fmt::join(prices, ", "));
}

UserError NoSuchFilter(const Scenario& scenario, const Library& library, const PlainFilter& filter,
                       const LinesRequest& request) {
  const std::string_view kind = controller::KindName(filter.settings);
  std::string problem = std::ranges::find(library.kinds, kind) == library.kinds.end()
                            ? fmt::format("has no {}", kind)
                            : fmt::format("has no {} with this {}", kind,
                                          kind == controller::OneEuroConfig::kKind
                                              ? "speed_from: tune it with the other"
                                              : "start or acceleration_window");
  if (library.kinds.size() > 1) {
    problem += fmt::format(" (it has {})", fmt::join(library.kinds, ", "));
  }
  const std::string nearest = NearestInFolder(scenario, library, request);
  if (nearest.empty()) {
    problem += fmt::format("; gauntlet tune SCENARIO --controller {} --all tunes those, too",
                           request.controller);
  } else {
    problem += "; of this folder it has " + nearest;
  }
  std::vector<std::string_view> others;
  for (const Library& other : Libraries()) {
    if (HasFilter(other, filter)) others.push_back(other.name);
  }
  if (!others.empty()) problem += fmt::format("; {} is in {}", kind, fmt::join(others, ", "));
  return Mistake(request, std::move(problem));
}

/// Signal, version and differences, a sentence each.
std::vector<std::string> NotesOf(const Scenario& scenario, const NamedController& named,
                                 const Library& library, const PlainFilter& filter,
                                 const LinesRequest& request) {
  std::vector<std::string> notes = {
      fmt::format("Filter {} of {} in {}, by gauntlet {} export.",
                  controller::KindName(filter.settings), named.name, scenario.name,
                  GAUNTLET_VERSION),
      fmt::format("For a signal in {}, {} samples per second; {}.", filter.unit,
                  LineNumber(filter.rate_hz), library.package)};
  const FilterInput input = InputOf(scenario, named.config, ChannelOf(scenario, request));
  const bool on_counts = named.config.filter_on == controller::FilterOn::kCounts;
  const bool changes_unit = on_counts != (filter.unit == "counts");
  const bool depends =
      library.lines(filter) != library.lines({.settings = WithInputUnit(filter.settings, 2.0),
                                              .rate_hz = filter.rate_hz,
                                              .unit = filter.unit,
                                              .start_variance = 4.0 * filter.start_variance});
  if (changes_unit && depends &&
      input.most_counts_per_rad > (1.0 + kNoDifference) * input.least_counts_per_rad) {
    notes.push_back(fmt::format(
        "The channels have {:.4g} to {:.4g} counts per deg: the settings are for their mean. "
        "--channel NAME gives those of one.",
        input.least_counts_per_rad / kDegPerRad, input.most_counts_per_rad / kDegPerRad));
  }
  notes.insert(notes.end(), library.differences.begin(), library.differences.end());
  return notes;
}

}  // namespace

std::string LinesOf(const Scenario& scenario, const LinesRequest& request) {
  constexpr std::size_t kWidth = 97;
  const NamedController& named = FindController(scenario, request.controller);
  const Library& library = FindLibrary(request.library);
  const auto filter = PlainFilterOf(scenario, named, request);
  if (const auto* problem = std::get_if<std::string>(&filter)) throw Mistake(request, *problem);
  const PlainFilter& plain = std::get<PlainFilter>(filter);
  if (!HasFilter(library, plain)) throw NoSuchFilter(scenario, library, plain, request);
  std::string text;
  for (const std::string& note : NotesOf(scenario, named, library, plain, request)) {
    std::istringstream lines(Wrapped(note, kWidth));
    for (std::string line; std::getline(lines, line);) {
      text += fmt::format("{} {}\n", library.comment, line);
    }
  }
  return text + "\n" + library.lines(plain);
}

}  // namespace gauntlet::sim
