#include "sim/live/live_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>
#include <utility>

#include "controller/number.h"
#include "sim/base/json.h"
#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {
namespace {

constexpr double kQuantiles[] = {0.5, 0.95, 0.99, 0.999};
constexpr const char* kQuantileKeys[] = {"p50_us", "p95_us", "p99_us", "p999_us"};
constexpr std::string_view kEndNames[] = {"seconds", "glove ended", "stopped", "motors gone",
                                          "simulated hand stopped"};
constexpr std::string_view kTierNames[] = {"follow", "hold", "relax", "off"};
constexpr double kLeastTrend_ms_min = 1.0;
constexpr double kLeastQueueBefore_ms_min = 10.0;  // clocks drift by up to 100 ppm: 6 ms a minute

std::string Ms(double us) { return std::isnan(us) ? "-" : fmt::format("{:.3f}", 1e-3 * us); }

ResultCell MsCell(double us) { return {{1e-3 * us}, Ms(us)}; }

/// Period in which frames come in batches [ms]; NaN if they do not: two fifths of the gaps are
/// shorter than a third of the mean.
double BatchPeriod_ms(const ArrivalFacts& arrivals) {
  const DurationHistogram& gaps = arrivals.gaps;
  constexpr std::int64_t kLeastGaps = 50;
  if (gaps.count() < kLeastGaps) return controller::kNaN;
  const double mean_us = gaps.mean_us();
  double sum_us = 0.0;
  std::int64_t longer = 0;
  std::int64_t shorter = 0;
  for (const auto& [step_us, count] : gaps.Steps()) {
    if (3.0 * step_us < mean_us) shorter += count;
    if (step_us < mean_us) continue;
    sum_us += step_us * static_cast<double>(count);
    longer += count;
  }
  const bool are_batches = 5 * shorter > 2 * gaps.count();
  return are_batches && longer > 0 ? 1e-3 * sum_us / static_cast<double>(longer) : controller::kNaN;
}

bool Grows(const Trend& trend, double least) {
  constexpr double kSigmas = 3.0;
  return trend.slope() > least && trend.slope() > kSigmas * trend.slope_error();
}

double ShareOf(std::int64_t part, std::int64_t all) {
  return all == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(all);
}

ResultTable StageTable(const LiveFacts& facts) {
  ResultTable table{
      .columns = {ResultColumn("stage", "stage").Words(), ResultColumn("mean_ms", "mean", "ms"),
                  ResultColumn("share_percent", "share", "%"), ResultColumn("p50_ms", "p50", "ms"),
                  ResultColumn("p95_ms", "p95", "ms"), ResultColumn("p99_ms", "p99", "ms"),
                  ResultColumn("max_ms", "max", "ms")}};
  const auto add = [&](std::string_view name, const DurationHistogram& times) {
    const double share = 100.0 * times.mean_us() / facts.total.mean_us();
    table.rows.push_back({ResultCell(ResultValue(std::string(name))),
                          MsCell(times.mean_us()),
                          {{share}, fmt::format("{:.1f}", share)},
                          MsCell(times.Quantile_us(0.5)),
                          MsCell(times.Quantile_us(0.95)),
                          MsCell(times.Quantile_us(0.99)),
                          MsCell(times.max_us())});
  };
  std::vector<std::size_t> order(kStages);
  for (std::size_t i = 0; i < kStages; ++i) order[i] = i;
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t stage) { return facts.stages[stage].mean_us(); });
  for (const std::size_t stage : order) add(kStageNames[stage].text, facts.stages[stage]);
  add("total", facts.total);
  return table;
}

std::string LargestText(const LiveFacts& facts) {
  const auto largest = static_cast<std::size_t>(LargestStage(facts));
  return fmt::format(
      "A command leaves {} ms after its glove sample arrived (median; p99 {} ms). "
      "The largest stage is: {}, {} ms on average.",
      Ms(facts.total.Quantile_us(0.5)), Ms(facts.total.Quantile_us(0.99)),
      kStageNames[largest].text, Ms(facts.stages[largest].mean_us()));
}

std::string FramesText(const LiveFacts& facts, const LiveContext& context) {
  const ArrivalFacts& arrivals = facts.arrivals;
  std::string text =
      fmt::format("Samples: {:.1f}/s, of them {:.1f}/s different; longest gap {} ms.",
                  arrivals.PerSecond(arrivals.frames), arrivals.PerSecond(arrivals.different),
                  Ms(arrivals.gaps.max_us()));
  if (arrivals.has_numbers) {
    text += fmt::format(
        " Lost {} ({:.2f} %), in bursts of up to {} (p99 {}); repeated {}; out of order {}.",
        arrivals.lost, ShareOf(arrivals.lost, arrivals.frames + arrivals.lost),
        arrivals.longest_loss, arrivals.p99_loss, arrivals.repeated, arrivals.out_of_order);
  } else {
    text += " Frames have no number, so lost, repeated and reordered ones are unknown.";
  }
  if (const double batch_ms = BatchPeriod_ms(arrivals); !std::isnan(batch_ms)) {
    text += fmt::format(" They come in batches, about every {:.1f} ms.", batch_ms);
  }
  if (arrivals.restarts > 0)
    text += fmt::format(" The sender restarted {} times.", arrivals.restarts);
  const SourceCounts& source = facts.source;
  if (source.garbage + source.half_frames + source.foreign + source.overflowed + source.reopened >
      0) {
    text += fmt::format(
        " Left out: {} without a frame, {} half frames, {} of other senders; dropped by the system "
        "{}; device reopened {} times.",
        source.garbage, source.half_frames, source.foreign, source.overflowed, source.reopened);
  }
  constexpr double kNoticeable = 0.05;
  const double rate_hz = arrivals.Rate_hz();
  if (std::abs(rate_hz / context.timing.sample_rate_hz() - 1.0) > kNoticeable) {
    text += fmt::format(
        " Warning: glove.rate_hz is {:.4g}; the filters assume it. For this glove: --set "
        "glove.rate_hz={:.4g}.",
        context.timing.sample_rate_hz(), rate_hz);
  }
  return text;
}

std::string TrendText(const LiveFacts& facts) {
  const double slope = facts.age_ms.slope();
  if (std::isnan(slope)) return "Trend of the age: needs at least 4 s.";
  std::string text = fmt::format("Trend of the age: {:+.2f} ms per minute.", slope);
  if (Grows(facts.age_ms, kLeastTrend_ms_min)) {
    text += " It grows: there is a queue before the controller (link.glove.receiver).";
  }
  const Trend& before = facts.arrivals.relative_delay_ms;
  if (facts.arrivals.has_sender_times && !std::isnan(before.slope())) {
    text += fmt::format(" Of the delay on the way to this computer: {:+.2f} ms per minute.",
                        before.slope());
    if (Grows(before, kLeastQueueBefore_ms_min)) {
      text += " It grows: there is a queue before this computer.";
    }
  }
  return text;
}

std::string QueueText(const LiveFacts& facts, const LiveContext& context) {
  if (!context.has_real_glove) {
    return fmt::format("Queues: at most {} frames in the receiver.", facts.most_queued);
  }
  const std::string late = context.receiver.find("buffer") == std::string::npos
                               ? ""
                               : fmt::format("; {} frames late for the buffer", facts.late_frames);
  return fmt::format(
      "Queues: at most {} frames before the control thread ({} left out), {} in the receiver{}. "
      "Commands replaced by newer ones before they were sent: {}.",
      facts.most_waiting, facts.input_overruns, facts.most_queued, late, facts.replaced_commands);
}

std::string WatchdogText(const LiveFacts& facts) {
  std::string text;
  for (std::size_t tier = 1; tier < facts.tiers.size(); ++tier) {
    const TierFacts& entered = facts.tiers[tier];
    if (entered.entered == 0) continue;
    text += fmt::format("{}{} {} times, longest {:.3f} s", text.empty() ? "" : "; ",
                        kTierNames[tier], entered.entered, entered.longest_s);
  }
  text = text.empty() ? "Watchdog: the motors followed all the time."
                      : "Watchdog tiers: " + text + ".";
  if (facts.rests > 0) {
    text += fmt::format(" Times that the motors were brought to rest: {}.", facts.rests);
  }
  return text;
}

std::string SwitchText(const LiveFacts& facts, const LiveContext& context) {
  std::string text;
  for (const Switched& switched : facts.switches) {
    text +=
        fmt::format("{}{} from {:.2f} s", text.empty() ? "" : ", ",
                    context.controllers[static_cast<std::size_t>(switched.to)], switched.time_s);
  }
  if (facts.switch_count > std::ssize(facts.switches)) text += ", ..";
  return fmt::format("Switches of the controller: {} ({}).", facts.switch_count, text);
}

/// Options that tell `gauntlet calibrate` of the converter, which a file of counts does not.
std::string ConverterOptions(const std::vector<controller::ConverterRange>& converters) {
  const auto option = [&](std::string_view name, double by_default, const auto& member) {
    std::vector<double> values;
    for (const controller::ConverterRange& range : converters) values.push_back(range.*member);
    const bool alike = std::ranges::all_of(values, [&](double v) { return v == values[0]; });
    if (alike && (values.empty() || values[0] == by_default)) return std::string();
    if (alike) values.erase(values.begin() + 1, values.end());
    return fmt::format(" {} {}", name, fmt::join(values, ","));
  };
  const controller::ConverterRange usual;
  return option("--full-scale", usual.full_scale_counts,
                &controller::ConverterRange::full_scale_counts) +
         option("--min-counts", usual.min_counts, &controller::ConverterRange::min_counts);
}

std::string StillText(const LiveFacts& facts, const LiveContext& context) {
  std::string text;
  std::string options;
  for (const StillTime& still : facts.still) {
    // Inwards: calibrate refuses what is outside of the recording.
    const double begin_s = std::ceil(100.0 * still.begin_s) / 100.0;
    const double end_s = std::floor(100.0 * still.end_s) / 100.0;
    text += fmt::format("{}{:.2f} to {:.2f} s", text.empty() ? "" : ", ", begin_s, end_s);
    options += fmt::format(" --still {:.2f}:{:.2f}", begin_s, end_s);
  }
  return fmt::format("Marked still: {}. The noise R of the glove: gauntlet calibrate {}{}{}", text,
                     context.counts_file, ConverterOptions(context.converters), options);
}

std::string LoopText(const LiveFacts& facts, const LiveContext& context) {
  const std::string end =
      facts.end != LiveEnd::kGloveEnded
          ? ""
          : fmt::format(", ended after {:.3g} s with the {}", facts.duration_s,
                        context.has_real_glove ? "glove's last frame" : "scenario's motion");
  return fmt::format(
      "Loop: {} ticks{}. The machine: wake-ups late by {} ms (p50), {} (p99), {} (max); {} ticks "
      "skipped, at most {} in a row. The program, from wake-up to command: {} ms of processor time "
      "(p50), {} (p99.9), {} (max); in real time {} (p99.9).",
      facts.ticks, end, Ms(facts.lateness.Quantile_us(0.5)), Ms(facts.lateness.Quantile_us(0.99)),
      Ms(facts.lateness.max_us()), facts.skipped_ticks, facts.longest_skip_ticks,
      Ms(facts.step_cpu.Quantile_us(0.5)), Ms(facts.step_cpu.Quantile_us(0.999)),
      Ms(facts.step_cpu.max_us()), Ms(facts.step.Quantile_us(0.999)));
}

/// One sentence: what to change, and what that gains at most.
std::string AdviceText(const LiveFacts& facts, const LiveContext& context) {
  const double frame_ms = 0.5 * context.timing.event_period_ms;
  const double total_ms = 1e-3 * facts.total.mean_us();
  const ArrivalFacts& arrivals = facts.arrivals;
  constexpr double kMuchSkipped_percent = 1.0;
  constexpr double kMuchLost_percent = 5.0;
  if (ShareOf(facts.skipped_ticks, facts.ticks + facts.skipped_ticks) > kMuchSkipped_percent) {
    return fmt::format(
        "Advice: the machine skipped {:.1f} % of the ticks; allow real-time priority "
        "or free a processor first.",
        ShareOf(facts.skipped_ticks, facts.ticks + facts.skipped_ticks));
  }
  if (ShareOf(arrivals.lost, arrivals.frames + arrivals.lost) > kMuchLost_percent) {
    return "Advice: mend the link before the filter: more than 5 % of the samples are lost.";
  }
  if (facts.total.count() == 0) return "";
  if (frame_ms > total_ms) {
    return fmt::format(
        "Advice: command frames every {:g} ms hold a command for {:g} ms on average, longer than "
        "all stages here ({:.2f} ms); a shorter period of the frames gains up to that.",
        context.timing.event_period_ms, frame_ms, total_ms);
  }
  const Stage largest = LargestStage(facts);
  const std::string gain = Ms(facts.stages[static_cast<std::size_t>(largest)].mean_us());
  switch (largest) {
    case Stage::kReceiver:
      if (context.receiver.empty() || context.receiver == NewestReceiver::kKind) {
        return fmt::format(
            "Advice: samples wait {} ms for their time by glove.rate_hz, {:.4g} a second; a glove "
            "that sends more often, or at equal intervals, gains up to that.",
            gain, context.timing.sample_rate_hz());
      }
      return fmt::format(
          "Advice: the receiver costs {} ms ({}); link.glove.receiver.kind=newest "
          "has no buffer and no queue.",
          gain, context.receiver);
    case Stage::kHeld:
      return fmt::format(
          "Advice: samples came too seldom for the command frames, or the glove fell silent: {} "
          "ms. "
          "Look at the glove and its link.",
          gain);
    case Stage::kEvent:
      return fmt::format("Advice: a shorter period of the command frames gains up to {} ms.", gain);
    case Stage::kTick:
    case Stage::kInput:
    case Stage::kSend:
      return fmt::format(
          "Advice: the machine takes {} ms; real-time priority or a free processor "
          "gains up to that.",
          gain);
    case Stage::kFilter:
      break;
  }
  return fmt::format("Advice: a shorter filter gains up to {} ms of computing time.", gain);
}

std::string KnownText(const LiveFacts& facts, const LiveContext& context) {
  std::string text =
      context.has_real_glove
          ? "Measured by this computer's clock (CLOCK_MONOTONIC): all stages from the arrival of a "
            "sample on."
          : "Measured by this computer's clock (CLOCK_MONOTONIC): all stages from the time of a "
            "simulated sample on; its link, if set, is simulated.";
  if (context.has_real_glove) {
    text += facts.arrivals.has_sender_times
                ? fmt::format(
                      " The way before is known relative to its fastest frame only: {} ms "
                      "(p50), {} (p99) above it; absolute, it would need a common clock.",
                      Ms(facts.arrivals.relative_delay.Quantile_us(0.5)),
                      Ms(facts.arrivals.relative_delay.Quantile_us(0.99)))
                : " The way before is unknown: the frames have no time of their sender.";
  }
  text +=
      context.has_motors
          ? " Not measured: the way to the motors, and the motors. The hand in the trace is the "
            "simulated one beside them, with the same commands."
          : " The hand is simulated.";
  return text + fmt::format(
                    " Assumed: {:g} ms from a command frame to the servos "
                    "(event.delay_ms).",
                    context.event_delay_ms);
}

Json JsonOf(const DurationHistogram& times) {
  Json json;
  json["count"] = times.count();
  if (times.count() == 0) return json;
  json["mean_us"] = times.mean_us();
  for (std::size_t i = 0; i < std::size(kQuantiles); ++i) {
    json[kQuantileKeys[i]] = times.Quantile_us(kQuantiles[i]);
  }
  json["max_us"] = times.max_us();
  auto& steps = json["histogram_us"] = Json::array();
  for (const auto& [step_us, count] : times.Steps()) steps.push_back({step_us, count});
  return json;
}

Json JsonOf(const Trend& trend) {
  if (std::isnan(trend.slope())) return nullptr;
  return {{"ms_per_minute", trend.slope()}, {"standard_error", trend.slope_error()}};
}

Json JsonOfArrivals(const LiveFacts& facts) {
  const ArrivalFacts& arrivals = facts.arrivals;
  Json json = {
      {"frames", arrivals.frames},
      {"different", arrivals.different},
      {"frames_per_s", arrivals.PerSecond(arrivals.frames)},
      {"different_per_s", arrivals.PerSecond(arrivals.different)},
      {"has_numbers", arrivals.has_numbers},
      {"lost", arrivals.lost},
      {"longest_loss", arrivals.longest_loss},
      {"p99_loss", arrivals.p99_loss},
      {"repeated", arrivals.repeated},
      {"out_of_order", arrivals.out_of_order},
      {"restarts", arrivals.restarts},
      {"late", facts.late_frames},
      {"garbage", facts.source.garbage},
      {"half_frames", facts.source.half_frames},
      {"of_other_senders", facts.source.foreign},
      {"dropped_by_system", facts.source.overflowed},
      {"reopened", facts.source.reopened},
      {"ring_overruns", facts.input_overruns},
      {"most_in_ring", facts.most_waiting},
      {"most_in_receiver", facts.most_queued},
      {"grid_shifts", facts.grid_shifts},
      {"gaps", JsonOf(arrivals.gaps)},
  };
  if (const double batch_ms = BatchPeriod_ms(arrivals); !std::isnan(batch_ms)) {
    json["batch_ms"] = batch_ms;
  }
  if (arrivals.has_sender_times) {
    json["relative_delay"] = JsonOf(arrivals.relative_delay);
    json["relative_delay_trend"] = JsonOf(arrivals.relative_delay_ms);
  }
  return json;
}

}  // namespace

Stage LargestStage(const LiveFacts& facts) {
  std::size_t largest = 0;
  for (std::size_t stage = 1; stage < kStages; ++stage) {
    if (facts.stages[stage].mean_us() > facts.stages[largest].mean_us()) largest = stage;
  }
  return static_cast<Stage>(largest);
}

ResultText LiveText(const LiveFacts& facts, const LiveContext& context) {
  ResultText text;
  if (facts.total.count() > 0) {
    text.emplace_back(LargestText(facts));
    text.emplace_back(StageTable(facts));
  } else {
    text.emplace_back("No command frame was sent.");
  }
  std::string rest = context.has_real_glove ? FramesText(facts, context) + "\n" : "";
  if (facts.switch_count > 0) rest += SwitchText(facts, context) + "\n";
  if (!facts.still.empty()) rest += StillText(facts, context) + "\n";
  rest += TrendText(facts) + "\n" + QueueText(facts, context) + "\n" + WatchdogText(facts) + "\n" +
          LoopText(facts, context);
  text.emplace_back(std::move(rest));
  if (const std::string advice = AdviceText(facts, context); !advice.empty()) {
    text.emplace_back(advice);
  }
  text.emplace_back(KnownText(facts, context));
  return text;
}

namespace {

ResultTable ShadowTable(const std::vector<ShadowScore>& scores) {
  ResultTable table{.columns = {ResultColumn("controller", "controller").Words(),
                                OnlyInJson("drives"),
                                ResultColumn("jitter_rms_deg", "jitter", "deg RMS"),
                                ResultColumn("delay_ms", "delay", "ms"),
                                ResultColumn("tracking_rmse_deg", "tracking error", "deg RMS"),
                                ResultColumn("step_p99_us", "step p99", "us")}};
  for (const ShadowScore& score : scores) {
    table.rows.push_back({{{score.name}, score.name + (score.drives ? " (drives)" : "")},
                          ResultCell(ResultValue(score.drives)),
                          ResultCell(ResultValue(score.jitter_rms_deg)),
                          ResultCell(ResultValue(score.delay_ms)),
                          ResultCell(ResultValue(score.tracking_rmse_deg)),
                          ResultCell(ResultValue(score.step_p99_us))});
  }
  return table;
}

/// A score in a sentence. A short session has no value of some.
std::string With(std::string_view noun, double value, std::string_view unit) {
  return std::isnan(value) ? fmt::format("without a value of the {}", noun)
                           : fmt::format("with {} {:.3g} {}", noun, value, unit);
}

}  // namespace

ResultText ShadowText(const std::vector<ShadowScore>& scores, const std::string& reference) {
  const auto best = std::ranges::min_element(scores, {}, [](const ShadowScore& score) {
    const double error_deg = score.tracking_rmse_deg;
    return std::isnan(error_deg) ? std::numeric_limits<double>::infinity() : error_deg;
  });
  ResultText text;
  text.emplace_back(fmt::format(
      "Controllers on the same samples, by the angles that they ask of the joints; reference: {}. "
      "{} One session gives no confidence interval: gauntlet compare on the recording does.",
      reference,
      std::isnan(best->tracking_rmse_deg)
          ? "No controller has a tracking error: too little of the session counts."
          : fmt::format("{} has the lowest tracking error, {:.3g} deg RMS, {} and {}.", best->name,
                        best->tracking_rmse_deg, With("jitter", best->jitter_rms_deg, "deg RMS"),
                        With("delay", best->delay_ms, "ms"))));
  text.emplace_back(ShadowTable(scores));
  return text;
}

namespace {

/// The address of a device without the folders of a file, which are a person's own.
std::string WithoutFolders(const std::string& address) {
  constexpr std::string_view kFile = "file:";
  if (!address.starts_with(kFile)) return address;
  const std::filesystem::path file = address.substr(kFile.size());
  return std::string(kFile) + file.filename().string();
}

}  // namespace

Json LiveJson(const LiveFacts& facts, const LiveContext& context,
              const std::vector<ShadowScore>& shadows) {
  Json json = {
      {"version", 1},
      {"scenario", context.scenario},
      {"controller", context.controller},
      {"glove", WithoutFolders(context.glove)},
      {"motors", WithoutFolders(context.motors)},
      {"ended_by", kEndNames[static_cast<std::size_t>(facts.end)]},
      {"duration_s", facts.duration_s},
  };
  auto& stages = json["stages"];
  for (std::size_t stage = 0; stage < kStages; ++stage) {
    stages[std::string(kStageNames[stage].key)] = JsonOf(facts.stages[stage]);
  }
  json["total"] = JsonOf(facts.total);
  if (facts.total.count() > 0) {
    json["largest_stage"] = kStageNames[static_cast<std::size_t>(LargestStage(facts))].key;
  }
  json["age_trend"] = JsonOf(facts.age_ms);
  if (context.has_real_glove) json["frames"] = JsonOfArrivals(facts);
  json["commands"] = {{"frames", facts.commands},
                      {"of_the_same_sample", facts.repeated_samples},
                      {"replaced", facts.replaced_commands},
                      {"largest_step_counts", facts.largest_step_counts},
                      {"sent", facts.sink.frames},
                      {"dropped", facts.sink.dropped},
                      {"failed", facts.sink.failed},
                      {"rests", facts.rests}};
  for (std::size_t tier = 1; tier < facts.tiers.size(); ++tier) {
    json["watchdog"][std::string(kTierNames[tier])] = {{"entered", facts.tiers[tier].entered},
                                                       {"longest_s", facts.tiers[tier].longest_s}};
  }
  json["loop"] = {{"tick_rate_hz", context.timing.tick_rate_hz},
                  {"ticks", facts.ticks},
                  {"skipped_ticks", facts.skipped_ticks},
                  {"longest_skip_ticks", facts.longest_skip_ticks},
                  {"has_real_time_priority", facts.rights.has_priority},
                  {"has_locked_memory", facts.rights.has_locked_memory},
                  {"lateness", JsonOf(facts.lateness)},
                  {"step", JsonOf(facts.step)},
                  {"step_processor_time", JsonOf(facts.step_cpu)},
                  {"tick_work", JsonOf(facts.tick_work)}};
  if (facts.switch_count > 0) {
    auto& list = json["switches"]["first"] = Json::array();
    for (const Switched& switched : facts.switches) {
      list.push_back({{"time_s", switched.time_s},
                      {"controller", context.controllers[static_cast<std::size_t>(switched.to)]}});
    }
    json["switches"]["count"] = facts.switch_count;
  }
  for (const StillTime& still : facts.still) {
    json["still"].push_back({{"begin_s", still.begin_s}, {"end_s", still.end_s}});
  }
  json["untrusted_samples"] = facts.untrusted_samples;
  json["assumed"] = {{"event_delay_ms", context.event_delay_ms},
                     {"hand", context.has_motors ? "simulated beside the motors" : "simulated"}};
  if (!shadows.empty()) json["controllers"] = JsonOf(ShadowTable(shadows));
  return json;
}

}  // namespace gauntlet::sim
