#include "sim/cli/export_lines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <utility>
#include <variant>
#include <vector>

#include "controller/filters/kalman_noise.h"
#include "controller/filters/per_channel_settings.h"
#include "sim/answers/tune/tune_all.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/base/threads.h"
#include "sim/cli/progress.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/table_text.h"
#include "sim/score/score.h"
#include "sim/settings/input_unit.h"
#include "sim/settings/libraries/library.h"
#include "sim/study/recorded_units.h"
#include "sim/study/scenario/filter_input.h"
#include "sim/study/scenario/scenario_reader.h"

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
  if (!scenario.glove.calibration.empty()) return "counts";
  const std::string recorded = SharedRecordedUnit(scenario.glove);
  return recorded.empty() ? "deg" : recorded;
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

std::string KindsText(const Library& library, const PlainFilter& filter) {
  const std::string_view kind = controller::KindName(filter.settings);
  if (std::ranges::find(library.kinds, kind) == library.kinds.end()) {
    return fmt::format("has no {} (it has {})", kind, fmt::join(library.kinds, ", "));
  }
  if (const auto* euro = std::get_if<controller::OneEuroConfig>(&filter.settings)) {
    const bool is_raw = euro->speed_from == controller::OneEuroConfig::SpeedFrom::kRaw;
    return fmt::format("has one_euro with speed_from: {} alone", is_raw ? "filtered" : "raw");
  }
  return fmt::format("has no {} with this start or acceleration_window", kind);
}

/// "exponential is in dex-retargeting, scipy"; empty if it is in none.
std::string WhereItIs(const PlainFilter& filter) {
  std::vector<std::string_view> others;
  for (const Library& other : Libraries()) {
    if (HasFilter(other, filter)) others.push_back(other.name);
  }
  if (others.empty()) return "";
  return fmt::format("; {} is in {}", controller::KindName(filter.settings),
                     fmt::join(others, ", "));
}

/// A small search on the scenario of the folder.
TunePlan PlanOf(const LinesRequest& request) {
  constexpr int kSeeds = 3;  // of the search, and as many of the price
  constexpr int kEvaluations = 20;
  const std::filesystem::path file =
      std::filesystem::path(request.folder) / "scenario.resolved.yaml";
  TunePlan plan;
  plan.scenario = {.file = file, .text = ReadYamlText(file)};
  plan.controller = request.controller;
  plan.minimise = MetricIndex("tracking_rmse_deg");
  plan.seeds = plan.held_out = kSeeds;
  plan.evaluations = kEvaluations;
  return plan;
}

/// The scenario with a form in place of the controller's filter; none for one that needs settings
/// which the scenario does not tell, as a Kalman filter of a glove without noise.
std::optional<Scenario> ScenarioWith(const TunePlan& plan, const FilterForm& form) {
  try {
    return ParseScenario(PlanOfForm(plan, form).scenario);
  } catch (const UserError&) {
    return {};
  }
}

/// The filters that a library has for the signal of the controller.
std::vector<FilterForm> FormsOf(const Library& library, const TunePlan& plan,
                                const LinesRequest& request) {
  std::vector<FilterForm> forms;
  for (const std::string_view kind : library.kinds) {
    if (kind == controller::NoFilterConfig::kKind) continue;
    const FilterForm form{.kind = kind, .fixed = library.fixed};
    const std::optional<Scenario> scenario = ScenarioWith(plan, form);
    if (!scenario) continue;
    const auto filter =
        PlainFilterOf(*scenario, FindController(*scenario, plan.controller), request);
    const auto* plain = std::get_if<PlainFilter>(&filter);
    if (plain != nullptr && HasFilter(library, *plain)) forms.push_back(form);
  }
  return forms;
}

/// "tracking error 1.3 in place of 1.2 deg RMS, delay .., jitter ..".
std::string PriceOf(const NearestFilter& nearest) {
  const TuneResult& result = nearest.forms.front().result;
  std::vector<std::string> prices;
  for (const auto& [key, name, unit] :
       {std::tuple{"tracking_rmse_deg", "tracking error", "deg RMS"},
        std::tuple{"delay_ms", "delay", "ms"}, std::tuple{"jitter_rms_deg", "jitter", "deg RMS"}}) {
    const std::size_t place = PlaceOfMetric(result.metrics, MetricIndex(key));
    prices.push_back(fmt::format("{} {:.3g} in place of {:.3g} {}", name,
                                 result.verdict.scores[place].mean, nearest.own.scores[place].mean,
                                 unit));
  }
  return fmt::format("{}", fmt::join(prices, ", "));
}

/// A filter that the library has, tuned in place of the controller's, and what it costs.
struct Substitute {
  NamedController named;
  PlainFilter filter;
  std::string note;
};

Substitute SubstituteOf(const Library& library, const PlainFilter& filter,
                        const LinesRequest& request) {
  constexpr double kNoWait_s = 5.0;
  const std::string without = KindsText(library, filter);
  const TunePlan plan = PlanOf(request);
  const std::vector<FilterForm> forms =
      request.exact ? std::vector<FilterForm>() : FormsOf(library, plan, request);
  if (forms.empty()) throw Mistake(request, without + WhereItIs(filter));
  Progress progress("filters");
  const auto say_wait = [&](double seconds) {
    if (seconds <= kNoWait_s) return;
    Say("gauntlet: tuning {} of {} takes about {:.0f} s\n",
        forms.size() == 1 ? std::string(forms.front().kind)
                          : fmt::format("{} kinds of filters", forms.size()),
        library.name, seconds);
  };
  const NearestFilter nearest = [&] {
    try {
      return TuneNearest(plan, forms, JobsOrCores(0), say_wait,
                         [&](double done, double all) { return progress.Update(done, all); });
    } catch (const RunError& error) {  // a short recording
      throw RunError(fmt::format("--for {}: {}{}; the closest is not tuned: {}", library.name,
                                 without, WhereItIs(filter), error.what()));
    }
  }();
  const TunedKind& best = nearest.forms.front();
  if (!best.has_answer()) {
    throw RunError(fmt::format("--for {}: {}, and {}", library.name, without,
                               best.left_out.empty() ? best.result.problem : best.left_out));
  }
  const Scenario tuned = ParseScenario(best.plan.scenario);
  const auto plain = PlainFilterOf(tuned, best.result.controller, request);
  if (const auto* problem = std::get_if<std::string>(&plain)) throw Mistake(request, *problem);
  return {
      .named = best.result.controller,
      .filter = std::get<PlainFilter>(plain),
      .note = fmt::format("{} {}{}. This is the closest that it has, {} tuned for the least "
                          "tracking error at about the jitter of {}. "
                          "Price, over {} of both: {}.",
                          library.name, without, WhereItIs(filter), best.kind, request.controller,
                          best.result.split.Text(TunePart::kHeldOut), PriceOf(nearest))};
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

std::string CommentsOf(const std::vector<std::string>& notes, std::string_view mark) {
  constexpr std::size_t kWidth = 97;
  std::string comments;
  for (const std::string& note : notes) {
    std::istringstream lines(Wrapped(note, kWidth));
    for (std::string line; std::getline(lines, line);) {
      comments += fmt::format("{} {}\n", mark, line);
    }
  }
  return comments;
}

std::string LinesOf(const Scenario& scenario, const LinesRequest& request) {
  const NamedController& named = FindController(scenario, request.controller);
  const Library& library = FindLibrary(request.library);
  const auto filter = PlainFilterOf(scenario, named, request);
  if (const auto* problem = std::get_if<std::string>(&filter)) throw Mistake(request, *problem);
  PlainFilter plain = std::get<PlainFilter>(filter);
  NamedController of = named;
  std::vector<std::string> notes;
  if (!HasFilter(library, plain)) {
    Substitute substitute = SubstituteOf(library, plain, request);
    Say("gauntlet: {}\n", substitute.note);
    notes.push_back(std::move(substitute.note));
    of = std::move(substitute.named);
    plain = std::move(substitute.filter);
  }
  const std::vector<std::string> of_filter = NotesOf(scenario, of, library, plain, request);
  notes.insert(notes.end(), of_filter.begin(), of_filter.end());
  return CommentsOf(notes, library.comment) + "\n" + library.lines(plain);
}

}  // namespace gauntlet::sim
