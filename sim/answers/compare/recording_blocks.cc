#include "sim/answers/compare/recording_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "sim/base/few_signals_on_heap.h"
#include "sim/base/threads.h"
#include "sim/score/jitter.h"
#include "sim/score/tracking.h"
#include "sim/study/counted_parts.h"
#include "sim/study/trial_score.h"

namespace gauntlet::sim {
namespace {

using Series = std::vector<double>;

/// The ticks that count, per measured joint.
std::vector<CountedTicks> CountedOfJoints(const Study& study, const GloveSignal& glove) {
  const int ticks = static_cast<int>(glove.true_angle_rad.rows());
  const std::optional<CountedParts> counted = CountedPartsOf(study, glove.masked, ticks);
  return counted ? counted->joints
                 : std::vector<CountedTicks>(study.measured_joints.size(), {{0, ticks}});
}

/// The part of each bin of time in a mean over joints of the RMS of a signal. Row 0 of the signal
/// belongs to tick `first`; ticks without a row have no part.
Series PartsOfRms(const Signal& signal, int first, const std::vector<CountedTicks>& counted,
                  int ticks, int bin_ticks) {
  Series parts(static_cast<std::size_t>(ticks / bin_ticks), 0.0);
  for (Eigen::Index joint = 0; joint < signal.cols(); ++joint) {
    const std::span<const double> values(signal.col(joint).data(),
                                         static_cast<std::size_t>(signal.rows()));
    const CountedTicks& of_joint = counted[static_cast<std::size_t>(joint)];
    const double rms = RmsWithin(values, first, of_joint);
    if (!(rms > 0.0)) continue;
    const double scale = 1.0 / (2.0 * rms * bin_ticks * static_cast<double>(signal.cols()));
    for (const TickRange& range : of_joint) {
      const int end = std::min(range.end, first + static_cast<int>(values.size()));
      for (int tick = std::max(range.begin, first); tick < end; ++tick) {
        const auto bin = static_cast<std::size_t>(tick / bin_ticks);
        if (bin < parts.size()) parts[bin] += scale * values[tick - first] * values[tick - first];
      }
    }
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
double CorrelationOf(const Study& study, const StudyResult& result,
                     const std::vector<CountedTicks>& counted, double rate_hz) {
  const int bin_ticks = static_cast<int>(std::lround(kCorrelationBin_s * rate_hz));
  const Columns reference(result.first_reference_rad, study.measured_joints);
  const int ticks = static_cast<int>(reference->rows());
  std::vector<Series> of_error, of_jitter, differences;
  Fourier fourier;
  for (const Trace& trace : result.first_traces) {
    if (!trace.health.ok) continue;
    const Columns hand(trace.hand_angle_rad, study.measured_joints);
    const Signal error = *hand - *reference;
    of_error.push_back(PartsOfRms(error, 0, counted, ticks, bin_ticks));
    const FilteredSignal high =
        Trembling(*hand, rate_hz, study.scenario.score.jitter_above_hz, fourier);
    of_jitter.push_back(PartsOfRms(high.values, high.first_sample, counted, ticks, bin_ticks));
    ReturnFreedMemory();
  }
  AddDifferences(of_error, "tracking_rmse_deg", differences);
  AddDifferences(of_jitter, "jitter_rms_deg", differences);
  return kCorrelationBin_s * AutocorrelationTime(differences);
}

std::vector<std::size_t> ScoresOfBlocks() {
  std::vector<std::size_t> metrics;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    if (HasBlockValues(Metrics()[m])) metrics.push_back(m);
  }
  return metrics;
}

}  // namespace

CountedTime CountedTimeOf(const Study& study, const StudyResult& result) {
  const GloveSignal& glove = *result.first_glove;
  CountedTime time{.joints = CountedOfJoints(study, glove),
                   .ticks = static_cast<int>(glove.true_angle_rad.rows())};
  for (const CountedTicks& of_joint : time.joints) {
    time.duration_s +=
        CountOf(of_joint) / (glove.tick_rate_hz * static_cast<double>(time.joints.size()));
  }
  time.correlation_s = CorrelationOf(study, result, time.joints, glove.tick_rate_hz);
  return time;
}

std::vector<TickRange> DivideTicks(const CountedTime& time, int count) {
  std::vector<std::int64_t> joints(static_cast<std::size_t>(time.ticks),
                                   0);  // that count, per tick
  std::int64_t all = 0;
  for (const CountedTicks& of_joint : time.joints) {
    for (const TickRange& range : of_joint) {
      for (int tick = range.begin; tick < range.end; ++tick) ++joints[tick];
    }
    all += CountOf(of_joint);
  }
  std::vector<TickRange> blocks;
  std::int64_t before = 0;
  int begin = 0;
  for (int tick = 0; tick < time.ticks; ++tick) {
    before += joints[tick];
    const bool is_full = before * count >= all * (std::ssize(blocks) + 1);
    if (!is_full || std::ssize(blocks) + 1 == count) continue;
    blocks.push_back({begin, tick + 1});
    begin = tick + 1;
  }
  blocks.push_back({begin, time.ticks});
  return blocks;
}

bool HasBlockValues(const Metric& metric) {
  return metric.main && !metric.extreme && !metric.needs_twin && !metric.needs_chain &&
         !metric.needs_switched;
}

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
  const CountedTime time = CountedTimeOf(study, result);
  divided.duration_s = time.duration_s;
  divided.plan = PlanBlocks(time.duration_s, time.correlation_s);
  if (divided.plan.count == 0) return divided;
  const std::vector<TickRange> blocks = DivideTicks(time, divided.plan.count);
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
                   result.first_traces[c], {}, metrics, {}, {&blocks[i / controllers.size()], 1});
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
