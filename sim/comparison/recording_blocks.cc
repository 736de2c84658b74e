#include "sim/comparison/recording_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "sim/base/threads.h"
#include "sim/score/jitter.h"
#include "sim/score/tracking.h"
#include "sim/study/counted_parts.h"
#include "sim/study/trial_score.h"

namespace gauntlet::sim {
namespace {

using Series = std::vector<double>;

/// The ticks in which all channels count.
CountedTicks CountedOf(const Study& study, const GloveSignal& glove) {
  const int ticks = static_cast<int>(glove.true_angle_rad.rows());
  const std::optional<CountedParts> counted = CountedPartsOf(study, glove.masked, ticks);
  return counted ? counted->hand : CountedTicks{{0, ticks}};
}

/// Calls for each tick that counts, with its number among these.
void ForEachTick(const CountedTicks& counted,
                 const std::function<void(int tick, int number)>& do_) {
  int number = 0;
  for (const TickRange& range : counted) {
    for (int tick = range.begin; tick < range.end; ++tick) do_(tick, number++);
  }
}

/// The part of each bin of time in a mean over joints of the RMS of a signal. Row 0 of the signal
/// belongs to tick `first`; ticks without a row have no part.
Series PartsOfRms(const Signal& signal, int first, const CountedTicks& counted, int bin_ticks) {
  Series parts(static_cast<std::size_t>(CountOf(counted) / bin_ticks), 0.0);
  for (Eigen::Index joint = 0; joint < signal.cols(); ++joint) {
    const std::span<const double> values(signal.col(joint).data(),
                                         static_cast<std::size_t>(signal.rows()));
    const double rms = RmsWithin(values, first, counted);
    if (!(rms > 0.0)) continue;
    const double scale = 1.0 / (2.0 * rms * bin_ticks);
    ForEachTick(counted, [&](int tick, int number) {
      const int row = tick - first;
      const auto bin = static_cast<std::size_t>(number / bin_ticks);
      if (row < 0 || row >= std::ssize(values) || bin >= parts.size()) return;
      parts[bin] += scale * values[row] * values[row];
    });
  }
  return parts;
}

/// Adds the differences of all pairs, over the smallest relevant difference; of one controller its
/// own parts.
void AddDifferences(const std::vector<Series>& parts_rad, std::string_view metric,
                    std::vector<Series>& differences) {
  const double scale = kDegPerRad / Metrics()[MetricIndex(metric)].relevant_difference.absolute;
  const auto add = [&](const Series& first, const Series& second) {
    Series& difference = differences.emplace_back(first.size());
    std::ranges::transform(first, second, difference.begin(),
                           [scale](double a, double b) { return scale * (a - b); });
  };
  if (parts_rad.size() == 1) add(parts_rad[0], Series(parts_rad[0].size(), 0.0));
  for (std::size_t a = 0; a < parts_rad.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) add(parts_rad[a], parts_rad[b]);
  }
}

/// Autocorrelation time of the differences [s].
double CorrelationOf(const Study& study, const StudyResult& result, const CountedTicks& counted,
                     double rate_hz) {
  const int bin_ticks = static_cast<int>(std::lround(kCorrelationBin_s * rate_hz));
  const Columns reference(result.first_reference_rad, study.measured_joints);
  std::vector<Series> of_error, of_jitter, differences;
  Fourier fourier;
  for (const Trace& trace : result.first_traces) {
    if (!trace.health.ok) continue;
    const Columns hand(trace.hand_angle_rad, study.measured_joints);
    const Signal error = *hand - *reference;
    of_error.push_back(PartsOfRms(error, 0, counted, bin_ticks));
    const FilteredSignal high =
        Trembling(*hand, rate_hz, study.scenario.score.jitter_above_hz, fourier);
    of_jitter.push_back(PartsOfRms(high.values, high.first_sample, counted, bin_ticks));
  }
  AddDifferences(of_error, "tracking_rmse_deg", differences);
  AddDifferences(of_jitter, "jitter_rms_deg", differences);
  return kCorrelationBin_s * AutocorrelationTime(differences);
}

/// Equal amounts of ticks that count.
std::vector<TickRange> BlocksOf(const CountedTicks& counted, int count) {
  const int all = CountOf(counted);
  std::vector<TickRange> blocks(static_cast<std::size_t>(count));
  ForEachTick(counted, [&](int tick, int number) {
    const auto block = static_cast<std::size_t>(static_cast<std::int64_t>(number) * count / all);
    TickRange& range = blocks[block];
    if (range.end == 0) range.begin = tick;
    range.end = tick + 1;
  });
  return blocks;
}

/// Scores that the jackknife serves: means over time, their roots, and delays. No extreme values.
std::vector<std::size_t> ScoresOfBlocks() {
  std::vector<std::size_t> metrics;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    if (Metrics()[m].main && !NeedsNoiseFreeTwin(m) && !NeedsCauseTrials(m)) metrics.push_back(m);
  }
  return metrics;
}

}  // namespace

std::string RecordingBlocks::Text() const {
  return empty() ? "" : fmt::format("{} blocks of {:.1f} s", plan.count, plan.length_s);
}

RecordingBlocks DivideRecording(const Study& study, const StudyResult& result, int jobs) {
  RecordingBlocks divided;
  divided.is_wanted = result.seeds.size() == 1 && result.seeds_alike &&
                      result.first_glove != nullptr && result.first_glove->recording != nullptr &&
                      !result.first_traces.empty();
  if (!divided.is_wanted) return divided;
  const GloveSignal& glove = *result.first_glove;
  const double rate_hz = glove.tick_rate_hz;
  const CountedTicks counted = CountedOf(study, glove);
  divided.duration_s = CountOf(counted) / rate_hz;
  divided.plan = PlanBlocks(divided.duration_s, CorrelationOf(study, result, counted, rate_hz));
  if (divided.plan.count == 0) return divided;
  const std::vector<TickRange> blocks = BlocksOf(counted, divided.plan.count);
  for (const TickRange& block : blocks) {
    divided.blocks.push_back({block.begin / rate_hz, block.end / rate_hz});
  }

  const std::vector<std::size_t> metrics = ScoresOfBlocks();
  std::vector<std::size_t> controllers;
  for (std::size_t c = 0; c < result.first_traces.size(); ++c) {
    if (result.first_traces[c].health.ok) controllers.push_back(c);
  }
  std::vector<Scores> without(controllers.size() * blocks.size());  // a block after the other
  ForEachOnThreads(static_cast<std::size_t>(std::max(1, jobs)), without.size(), [&](std::size_t i) {
    const std::size_t c = controllers[i % controllers.size()];
    without[i] =
        ScoreTrial(study, study.scenario.controllers[c].config, glove, result.first_reference_rad,
                   result.first_traces[c], {}, metrics, {}, blocks[i / controllers.size()]);
  });
  std::vector<Scores*> all;
  for (Scores& scores : without) all.push_back(&scores);
  UseCommonParts(all);

  divided.values.assign(result.first_traces.size(),
                        std::vector<std::vector<double>>(Metrics().size()));
  for (const std::size_t m : metrics) {
    const bool has_all = std::ranges::all_of(
        without, [m](const Scores& scores) { return std::isfinite(scores.summary[m]); });
    if (!has_all) continue;
    for (std::size_t i = 0; i < controllers.size(); ++i) {
      Series of_blocks;
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        of_blocks.push_back(without[b * controllers.size() + i].summary[m]);
      }
      const std::size_t c = controllers[i];
      divided.values[c][m] = BlockValues(result.seeds.front().controllers[c].scores.summary[m],
                                         of_blocks, divided.plan.Widening());
    }
  }
  return divided;
}

}  // namespace gauntlet::sim
