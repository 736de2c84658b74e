#include "sim/fit/chain_episodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "controller/assert.h"
#include "controller/calibration/robust_statistics.h"
#include "sim/base/error.h"
#include "sim/base/student.h"
#include "sim/fit/fit_tables.h"

namespace gauntlet::sim {
namespace {

constexpr double kLeastTravel = 0.2;   // of the largest of a part: the episode counts
constexpr double kSameCommand = 0.02;  // of a part's travel
constexpr std::size_t kFewest = 4;     // episodes of which some are held out
constexpr double kUncompared_s = 0.5;  // not compared, as in FitChain()

double TravelOf(const ChainLog& log, std::size_t part) {
  const auto [least, most] = std::ranges::minmax(ColumnOf(log.command_deg, part));
  return most - least;
}

/// Sum of squares, and how many there are.
struct Squares {
  double sum = 0.0;
  double count = 0.0;

  double Rms() const { return count > 0.0 ? std::sqrt(sum / count) : kNaN; }
};

void AddResidual(const ChainLog& log, std::size_t part, const ChainFit& of_episode,
                 const ChainModel& model, Squares& squares) {
  const std::span<const double> angle_deg = ColumnOf(log.angle_deg, part);
  std::vector<double> simulated_deg(angle_deg.size());
  SimulateChain(model,
                RefineCommand(ColumnOf(log.command_deg, part), log.rate_hz, of_episode.frames),
                simulated_deg);
  for (auto k = static_cast<std::size_t>(kUncompared_s * log.rate_hz); k < angle_deg.size(); ++k) {
    squares.sum += std::pow(angle_deg[k] - simulated_deg[k], 2);
    ++squares.count;
  }
}

/// RMS difference of two signals over their common time.
double DifferenceOf(std::span<const double> a, std::span<const double> b) {
  Squares squares;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    squares.sum += (a[k] - b[k]) * (a[k] - b[k]);
    ++squares.count;
  }
  return squares.Rms();
}

double RepeatSpread(const std::vector<ChainLog>& logs, std::size_t part, double travel_deg) {
  Squares squares;
  for (std::size_t a = 0; a < logs.size(); ++a) {
    for (std::size_t b = a + 1; b < logs.size(); ++b) {
      const double apart_deg =
          DifferenceOf(ColumnOf(logs[a].command_deg, part), ColumnOf(logs[b].command_deg, part));
      if (!(apart_deg < kSameCommand * travel_deg)) continue;
      squares.sum += std::pow(DifferenceOf(ColumnOf(logs[a].angle_deg, part),
                                           ColumnOf(logs[b].angle_deg, part)),
                              2) /
                     2.0;
      ++squares.count;
    }
  }
  return squares.Rms();
}

/// Fits of one part in some episodes.
struct PartInEpisode {
  const ChainLog* log;
  ChainFit fit;
};

std::vector<double> ValuesOf(const std::vector<PartInEpisode>& episodes, const auto& value_of) {
  std::vector<double> values;
  for (const PartInEpisode& episode : episodes) {
    const double value = value_of(episode.fit);
    if (std::isfinite(value)) values.push_back(value);
  }
  return values;
}

/// Adds the speed limit to the mean chain, if more than chance and a single episode have one. The
/// others may move too little to reach it.
void AddLimit(const std::vector<PartInEpisode>& episodes, ChainFit& combined) {
  constexpr double kLeastShare = 0.25;
  const std::vector<double> limits =
      ValuesOf(episodes, [](const ChainFit& fit) { return fit.speed_limit_deg_s.value; });
  if (!(static_cast<double>(limits.size()) > kLeastShare * static_cast<double>(episodes.size()))) {
    return;
  }
  combined.speed_limit_deg_s = MeanOfEpisodes(limits);
  combined.model.speed_limit_deg_s = combined.speed_limit_deg_s.value;
  combined.model.limit_in_lag =
      2 * std::ranges::count_if(episodes,
                                [](const PartInEpisode& episode) {
                                  return std::isfinite(episode.fit.speed_limit_deg_s.value) &&
                                         episode.fit.model.limit_in_lag;
                                }) >
      std::ssize(limits);
  combined.model_text =
      fmt::format("play, 2nd order, speed limit: mean of {} episodes", episodes.size());
  const std::vector<double> unlimited_ms =
      ValuesOf(episodes, [](const ChainFit& fit) { return fit.unlimited_delay_ms; });
  if (!unlimited_ms.empty()) combined.unlimited_delay_ms = controller::MedianOf(unlimited_ms);
  WithholdLimited(
      RangeText(ValuesOf(episodes, [](const ChainFit& fit) { return fit.delay_ms.value; }), 0) +
          " ms",
      combined);
}

/// The mean chain of the episodes.
ChainFit Combined(const std::vector<PartInEpisode>& episodes, double travel_deg, double rate_hz) {
  ChainFit combined;
  const auto mean = [&](ChainEstimate ChainFit::*value) {
    if (episodes.size() == 1) {
      combined.*value = episodes.front().fit.*value;
      return;
    }
    combined.*value =
        MeanOfEpisodes(ValuesOf(episodes, [&](const ChainFit& fit) { return (fit.*value).value; }));
  };
  mean(&ChainFit::delay_ms);
  for (const auto value : {&ChainFit::dead_time_ms, &ChainFit::lag_ms, &ChainFit::gain,
                           &ChainFit::offset_deg, &ChainFit::hysteresis_deg}) {
    mean(value);
  }
  if (episodes.size() > 1) {
    combined.open_ms =
        controller::MedianOf(ValuesOf(episodes, [](const ChainFit& fit) { return fit.open_ms; }));
    WidenDeadTime(combined);
  }
  if (!std::isfinite(combined.dead_time_ms.value)) {
    combined.split_problem = "no episode tells dead time, lag and hysteresis apart";
    return combined;
  }
  combined.model = {.dead_time_s = 1e-3 * combined.dead_time_ms.value,
                    .lag_s = 1e-3 * combined.lag_ms.value,
                    .inertia_s2 = controller::MedianOf(ValuesOf(
                        episodes, [](const ChainFit& fit) { return fit.model.inertia_s2; })),
                    .gain = combined.gain.value,
                    .play_deg = 0.5 * combined.hysteresis_deg.value,
                    .offset_deg = combined.offset_deg.value};
  combined.model_text = fmt::format("play, 2nd order: mean of {} episodes", episodes.size());
  AddLimit(episodes, combined);
  WithholdUnknown(
      {.travel_deg = travel_deg * combined.gain.value,
       .rate_hz = rate_hz,
       .delay_ms = MeanOfEpisodes(
           ValuesOf(episodes,
                    [](const ChainFit& fit) { return fit.dead_time_ms.value + fit.lag_ms.value; })),
       .has_play = combined.hysteresis_deg.value > 0.0,
       .has_frames = episodes.front().fit.frames.has_value()},
      combined);
  return combined;
}

/// The fits of an episode; none if no part can be fitted.
std::optional<std::vector<ChainFit>> TryFit(const ChainLog& log, ChainDetail detail,
                                            std::vector<std::string>& left_out) {
  try {
    return FitChains(log, {}, detail);
  } catch (const UserError& error) {
    left_out.push_back(
        fmt::format("episode {}: {}: {}", log.episode.value_or(0), error.key(), error.problem()));
    return std::nullopt;
  }
}

bool HasRepeats(const ChainResult& result) {
  return std::ranges::any_of(
      result.held_out, [](const HeldOutPart& part) { return std::isfinite(part.repeat_rms_deg); });
}

/// "At most 4.1 ms (gripper) lie between the delay of the held-out episodes and the fitted one."
std::string DelayText(const ChainResult& result) {
  double most_ms = -1.0;
  std::string where;
  for (std::size_t part = 0; part < result.fits.size(); ++part) {
    const double apart_ms =
        std::abs(result.held_out[part].held_out_delay_ms.value - result.fits[part].delay_ms.value);
    if (!(apart_ms > most_ms)) continue;
    most_ms = apart_ms;
    where = result.log().parts[part];
  }
  if (most_ms < 0.0) return "";
  return fmt::format("The delay of the held-out episodes differs by at most {:.1f} ms ({}).",
                     most_ms, where);
}

std::string ErrorText(const ChainResult& result) {
  std::vector<double> ratios, to_repeats;
  for (const HeldOutPart& part : result.held_out) {
    const double ratio = part.held_out_rms_deg / part.fitted_rms_deg;
    if (std::isfinite(ratio)) ratios.push_back(ratio);
    const double to_repeat = part.held_out_rms_deg / part.repeat_rms_deg;
    if (std::isfinite(to_repeat)) to_repeats.push_back(to_repeat);
  }
  if (ratios.empty()) return "";
  return fmt::format(
      "The error of the model there is {} times that in the fitted episodes{}.",
      RangeText(ratios, 1),
      to_repeats.empty()
          ? ""
          : fmt::format(" and {} times the spread of repeated motions", RangeText(to_repeats, 1)));
}

}  // namespace

ChainEstimate MeanOfEpisodes(const std::vector<double>& values) {
  if (values.empty()) return {};
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) mean += value / count;
  if (values.size() < 2) return {mean, kNaN, kNaN};
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double half_width =
      StudentHalfWidth(0.95, count - 1.0) * std::sqrt(squares / (count - 1.0) / count);
  return {mean, mean - half_width, mean + half_width};
}

double ChainResult::duration_s() const {
  double sum_s = 0.0;
  for (const ChainLog& log : episodes) {
    sum_s += static_cast<double>(log.command_deg.rows()) / log.rate_hz;
  }
  return sum_s;
}

ChainResult IdentifyChain(ChainEpisodes episodes, const ChainProgress& progress) {
  GAUNTLET_ASSERT(!episodes.logs.empty());
  ChainResult result;
  result.episodes = std::move(episodes.logs);
  result.left_out = std::move(episodes.left_out);
  const std::vector<ChainLog>& logs = result.episodes;
  if (logs.size() == 1) {
    result.fits = FitChains(logs.front(), progress);
    result.fitted = 1;
    return result;
  }
  const std::size_t parts = logs.front().parts.size();
  std::vector<double> travel_deg(parts, 0.0);
  for (const ChainLog& log : logs) {
    for (std::size_t p = 0; p < parts; ++p) {
      travel_deg[p] = std::max(travel_deg[p], TravelOf(log, p));
    }
  }
  std::vector<std::vector<PartInEpisode>> fitted(parts), held_out(parts);
  std::vector<std::string> problem(parts);
  double most_motion = -1.0;
  for (std::size_t e = 0; e < logs.size(); ++e) {
    const ChainLog& log = logs[e];
    const bool is_held_out = logs.size() >= kFewest && e % 2 == 1;
    const auto fits =
        TryFit(log, is_held_out ? ChainDetail::kDelay : ChainDetail::kBasic, result.left_out);
    if (progress) progress(static_cast<int>(e) + 1, static_cast<int>(logs.size()));
    if (!fits) continue;
    ++(is_held_out ? result.judged : result.fitted);
    double motion = 0.0;
    for (std::size_t p = 0; p < parts; ++p) {
      const double travel = TravelOf(log, p);
      if (travel_deg[p] > 0.0) motion += travel / travel_deg[p];
      if (!(*fits)[p].problem.empty()) problem[p] = (*fits)[p].problem;
      if (!(*fits)[p].problem.empty() || travel < kLeastTravel * travel_deg[p]) continue;
      (is_held_out ? held_out : fitted)[p].push_back({&log, (*fits)[p]});
    }
    if ((is_held_out || logs.size() < kFewest) && motion > most_motion) {
      most_motion = motion;
      result.shown = e;
    }
  }
  if (result.fitted == 0) {
    throw UserError({.place = logs.front().name, .problem = result.left_out.front()});
  }
  for (std::size_t p = 0; p < parts; ++p) {
    ChainFit& fit = result.fits.emplace_back();
    HeldOutPart& judged = result.held_out.emplace_back();
    judged.fitted = fitted[p].size();
    judged.held_out = held_out[p].size();
    if (fitted[p].empty()) {
      fit.problem = problem[p].empty() ? "it hardly moves in the fitted episodes" : problem[p];
      continue;
    }
    fit = Combined(fitted[p], travel_deg[p], logs.front().rate_hz);
    fit.frames = FramesOf(logs[result.shown])[p];
    judged.held_out_delay_ms =
        MeanOfEpisodes(ValuesOf(held_out[p], [](const ChainFit& f) { return f.delay_ms.value; }));
    judged.repeat_rms_deg = RepeatSpread(logs, p, travel_deg[p]);
    if (!fit.split_problem.empty()) continue;
    Squares in_fitted, in_held_out;
    for (const auto& [log, own] : fitted[p]) AddResidual(*log, p, own, fit.model, in_fitted);
    for (const auto& [log, own] : held_out[p]) AddResidual(*log, p, own, fit.model, in_held_out);
    judged.fitted_rms_deg = fit.residual_rms_deg = in_fitted.Rms();
    judged.held_out_rms_deg = fit.held_out_rms_deg = in_held_out.Rms();
  }
  return result;
}

ResultTable HeldOutTable(const ChainResult& result) {
  const std::string unit = result.log().unit_known ? "deg" : "units";
  ResultTable table{
      .columns = {
          {"part", "part"},
          {"fitted_episodes"},
          {"held_out_episodes"},
          {"delay_ms", "delay", "ms"},
          IntervalColumn("held_out_delay_ms", "delay held out (95 % CI)", "ms"),
          {"fitted_rms_" + unit, "error", unit + " RMS"},
          {"held_out_rms_" + unit, "error held out", unit + " RMS"},
          {"repeat_rms_" + unit, HasRepeats(result) ? "spread of repeats" : "", unit + " RMS"}}};
  for (std::size_t p = 0; p < result.held_out.size(); ++p) {
    const HeldOutPart& part = result.held_out[p];
    table.rows.push_back(
        {ResultCell(result.log().parts[p]), ResultCell(static_cast<std::int64_t>(part.fitted)),
         ResultCell(static_cast<std::int64_t>(part.held_out)),
         FixedCell(result.fits[p].delay_ms.value, 1), IntervalCell(part.held_out_delay_ms, 1),
         FixedCell(part.fitted_rms_deg, 2), FixedCell(part.held_out_rms_deg, 2),
         FixedCell(part.repeat_rms_deg, 2)});
  }
  return table;
}

ResultText HeldOutText(const ChainResult& result) {
  ResultText text;
  if (result.judged > 0) {
    AddLine(fmt::format("{} {}{}", DelayText(result), ErrorText(result),
                        HasRepeats(result) ? "" : " No episodes repeat the commands of others."),
            text);
    text.emplace_back(HeldOutTable(result));
  } else if (result.episodes.size() > 1) {
    AddLine("Fewer than four episodes: all are fitted and none is held out.", text);
  }
  for (const std::string& left_out : result.left_out) AddLine("Left out: " + left_out + ".", text);
  return text;
}

}  // namespace gauntlet::sim
