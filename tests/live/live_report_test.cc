#include "sim/live/live_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "sim/base/json.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A thousand durations, 1 to 1000 times `unit_us`: each quantile is another one.
DurationHistogram Ramp(std::int64_t unit_us) {
  DurationHistogram times;
  for (std::int64_t i = 1; i <= 1000; ++i) times.Add(1000 * unit_us * i);
  return times;
}

DurationHistogram TimesOf_ms(const std::vector<std::pair<int, double>>& counts_and_ms) {
  DurationHistogram times;
  for (const auto& [count, ms] : counts_and_ms) {
    for (int i = 0; i < count; ++i) times.Add(static_cast<std::int64_t>(1e6 * ms));
  }
  return times;
}

/// A line through -1, 0 and 1 min, with an error of its slope.
Trend TrendOf(double slope, double error = 0.0) {
  Trend trend;
  for (const double time : {-1.0, 0.0, 1.0}) {
    // Off the line by (1, -2, 1) e: sqrt(6 e^2 / (1 * 2)) is the error.
    trend.Add(time, slope * time + error / std::sqrt(3.0) * (time == 0.0 ? -2.0 : 1.0));
  }
  return trend;
}

DurationHistogram& At(LiveFacts& facts, Stage stage) {
  return facts.stages[static_cast<std::size_t>(stage)];
}

/// A session of 10 s with 100 samples a second of a real glove, all in order.
struct ReportedSession {
  ReportedSession() {
    facts.duration_s = 10.0;
    facts.ticks = 9950;
    facts.skipped_ticks = 50;
    facts.longest_skip_ticks = 12;
    facts.lateness = Ramp(1);
    facts.step_cpu = Ramp(2);
    facts.step = Ramp(3);
    facts.tick_work = Ramp(4);
    At(facts, Stage::kInput) = Ramp(1);
    At(facts, Stage::kTick) = Ramp(2);
    At(facts, Stage::kReceiver) = Ramp(20);
    At(facts, Stage::kFilter) = Ramp(3);
    At(facts, Stage::kHeld) = Ramp(5);
    At(facts, Stage::kEvent) = Ramp(10);
    At(facts, Stage::kSend) = Ramp(4);
    facts.total = Ramp(45);
    facts.age_ms = TrendOf(0.25);
    facts.commands = 500;
    facts.replaced_commands = 6;
    facts.most_waiting = 3;
    facts.input_overruns = 4;
    facts.most_queued = 5;
    facts.late_frames = 7;
    facts.arrivals.frames = 1001;
    facts.arrivals.different = 951;
    facts.arrivals.lost = 50;
    facts.arrivals.longest_loss = 21;
    facts.arrivals.p99_loss = 20;
    facts.arrivals.repeated = 8;
    facts.arrivals.out_of_order = 9;
    facts.arrivals.has_numbers = true;
    facts.arrivals.first_ns = 5'000'000'000;
    facts.arrivals.last_ns = 15'000'000'000;
    facts.arrivals.gaps = TimesOf_ms({{999, 10.0}, {1, 40.0}});
  }

  std::string Text() const {
    return TextOf(LiveText(facts, context),
                  {.width = 10'000, .table_width = TerminalStyle::kNoLimit});
  }

  LiveFacts facts;
  LiveContext context{.scenario = "door",
                      .controller = "raw",
                      .controllers = {"raw", "kalman"},
                      .glove = "udp:9000, csv",
                      .motors = "udp:9001, csv",
                      .has_real_glove = true,
                      .has_motors = true,
                      .timing = {.ticks_per_sample = 10},
                      .event_delay_ms = 12.0,
                      .receiver = "queue"};
};

TEST(LiveText, SaysAllOfASession) {
  EXPECT_EQ(
      ReportedSession().Text(),
      R"(A command leaves 22.501 ms after its glove sample arrived (median; p99 44.551 ms). The largest stage is: receiver: grid, buffer, queue, 10.010 ms on average.

                                 mean  share     p50     p95     p99     max
stage                              ms      %      ms      ms      ms      ms
receiver: grid, buffer, queue  10.010   44.4  10.001  19.001  19.801  20.000
wait for the command frame      5.005   22.2   5.001   9.501   9.901  10.000
no newer sample                 2.502   11.1   2.501   4.751   4.951   5.000
send                            2.002    8.9   2.001   3.801   3.961   4.000
filter and maps                 1.502    6.7   1.501   2.851   2.971   3.000
wait for the tick               1.001    4.4   1.001   1.901   1.981   2.000
input thread                    0.501    2.2   0.501   0.951   0.991   1.000
total                          22.523  100.0  22.501  42.751  44.551  45.000

Samples: 100.0/s, of them 95.0/s different; longest gap 40.000 ms. Lost 50 (4.76 %), in bursts of up to 21 (p99 20); repeated 8; out of order 9.
Trend of the age: +0.25 ms per minute.
Queues: at most 3 frames before the control thread (4 left out), 5 in the receiver. Commands replaced by newer ones before they were sent: 6.
Watchdog: the motors followed all the time.
Loop: 9950 ticks. The machine: wake-ups late by 0.501 ms (p50), 0.991 (p99), 1.000 (max); 50 ticks skipped, at most 12 in a row. The program, from wake-up to command: 1.001 ms of processor time (p50), 1.999 (p99.9), 2.000 (max); in real time 2.998 (p99.9).

Advice: the receiver costs 10.010 ms (queue); link.glove.receiver.kind=newest has no buffer and no queue.

Measured by this computer's clock (CLOCK_MONOTONIC): all stages from the arrival of a sample on. The way before is unknown: the frames have no time of their sender. Not measured: the way to the motors, and the motors. The hand in the trace is the simulated one beside them, with the same commands. Assumed: 12 ms from a command frame to the servos (event.delay_ms).
)");
}

/// A change of that session, and a sentence that its report has then, or has not.
struct Sentence {
  std::string text;
  std::function<void(ReportedSession&)> change;
};

using R = ReportedSession;

void EnlargeStage(Stage stage, R& session) { At(session.facts, stage) = Ramp(21); }

std::vector<Sentence> SaidSentences() {
  return {
      {"No command frame was sent.", [](R& r) { r.facts.total = {}; }},
      // Frames.
      {"longest gap 40.000 ms. Frames have no number, so lost, repeated and reordered ones are "
       "unknown.\n",
       [](R& r) { r.facts.arrivals.has_numbers = false; }},
      {" The sender restarted 1 times.", [](R& r) { r.facts.arrivals.restarts = 1; }},
      {" Left out: 1 without a frame, 0 half frames, 0 of other senders; dropped by the system 0; "
       "device reopened 0 times.",
       [](R& r) { r.facts.source.garbage = 1; }},
      {": 0 without a frame, 2 half frames, 0 of", [](R& r) { r.facts.source.half_frames = 2; }},
      {"0 half frames, 3 of other senders;", [](R& r) { r.facts.source.foreign = 3; }},
      {"dropped by the system 4; device", [](R& r) { r.facts.source.overflowed = 4; }},
      {"device reopened 5 times.", [](R& r) { r.facts.source.reopened = 5; }},
      // Two gaps in five are short, against a third of the mean; the period is the mean of the
      // long ones, one of the mean's own length included.
      {" They come in batches, about every 18.3 ms.",
       [](R& r) {
         r.facts.arrivals.gaps = TimesOf_ms({{24, 1.0}, {2, 10.0}, {24, 19.0}});
       }},
      {" They come in batches, about every 10.0 ms.",
       [](R& r) {
         r.facts.arrivals.gaps = TimesOf_ms({{21, 0.0}, {29, 10.0}});
       }},
      // A rate that is wrong by more than a twentieth.
      {" Warning: glove.rate_hz is 94; the filters assume it. For this glove: --set "
       "glove.rate_hz=100.",
       [](R& r) { r.context.timing.glove_rate_hz = 94.0; }},
      {" Warning: glove.rate_hz is 106;", [](R& r) { r.context.timing.glove_rate_hz = 106.0; }},
      // Trends.
      {"Trend of the age: needs at least 4 s.", [](R& r) { r.facts.age_ms = {}; }},
      {"Trend of the age: -7.00 ms per minute.\n", [](R& r) { r.facts.age_ms = TrendOf(-7.0); }},
      {"Trend of the age: +0.99 ms per minute.\n", [](R& r) { r.facts.age_ms = TrendOf(0.99); }},
      {"Trend of the age: +1.01 ms per minute. It grows: there is a queue before the controller "
       "(link.glove.receiver).\n",
       [](R& r) { r.facts.age_ms = TrendOf(1.01); }},
      {"Trend of the age: +7.00 ms per minute. It grows",
       [](R& r) { r.facts.age_ms = TrendOf(7.0, 2.3); }},
      {"Trend of the age: +7.00 ms per minute.\n",
       [](R& r) { r.facts.age_ms = TrendOf(7.0, 2.4); }},
      {" Of the delay on the way to this computer: +10.10 ms per minute. It grows: there is a "
       "queue before this computer.\n",
       [](R& r) {
         r.facts.arrivals.has_sender_times = true;
         r.facts.arrivals.relative_delay_ms = TrendOf(10.1);
       }},
      {"this computer: +9.90 ms per minute.\n",
       [](R& r) {
         r.facts.arrivals.has_sender_times = true;
         r.facts.arrivals.relative_delay_ms = TrendOf(9.9);
       }},
      {"Trend of the age: +0.25 ms per minute.\n",
       [](R& r) { r.facts.arrivals.has_sender_times = true; }},
      {"Trend of the age: +0.25 ms per minute.\n",
       [](R& r) { r.facts.arrivals.relative_delay_ms = TrendOf(9.9); }},
      // Queues.
      {"Queues: at most 5 frames in the receiver.\n",
       [](R& r) { r.context.has_real_glove = false; }},
      {"5 in the receiver; 7 frames late for the buffer. Commands",
       [](R& r) { r.context.receiver = "adaptive_buffer"; }},
      // Watchdogs.
      {"Watchdog tiers: hold 1 times, longest 0.125 s; relax 2 times, longest 0.250 s; off 3 "
       "times, longest 4.000 s.\n",
       [](R& r) {
         r.facts.tiers = {{{9, 9.0}, {1, 0.125}, {2, 0.25}, {3, 4.0}}};
       }},
      {"Watchdog tiers: relax 2 times, longest 0.250 s.\n",
       [](R& r) {
         r.facts.tiers[2] = {2, 0.25};
       }},
      {"followed all the time. Times that the motors were brought to rest: 1.\n",
       [](R& r) { r.facts.rests = 1; }},
      // Switches.
      {"Switches of the controller: 2 (kalman from 1.25 s, raw from 2.50 s).\n",
       [](R& r) {
         r.facts.switch_count = 2;
         r.facts.switches = {{1.25, 1}, {2.5, 0}};
       }},
      {"Switches of the controller: 2 (kalman from 1.25 s, ..).\n",
       [](R& r) {
         r.facts.switch_count = 2;
         r.facts.switches = {{1.25, 1}};
       }},
      // Stretches, by whole hundredths of a second within them.
      {"Marked still: 1.24 to 2.98 s, 4.00 to 5.00 s. The noise R of the glove: gauntlet "
       "calibrate out/counts.csv --still 1.24:2.98 --still 4.00:5.00\n",
       [](R& r) {
         r.facts.still = {{1.231, 2.989}, {4.0, 5.0}};
         r.context.counts_file = "out/counts.csv";
         r.context.converters = {{}, {}};
       }},
      {"calibrate c.csv --full-scale 4095 --still 4.00:5.00\n",
       [](R& r) {
         r.facts.still = {{4.0, 5.0}};
         r.context.counts_file = "c.csv";
         r.context.converters = {{.full_scale_counts = 4095.0}, {.full_scale_counts = 4095.0}};
       }},
      {"calibrate c.csv --full-scale 1023,4095 --min-counts 5,0 --still 4.00:5.00\n",
       [](R& r) {
         r.facts.still = {{4.0, 5.0}};
         r.context.counts_file = "c.csv";
         r.context.converters = {{.min_counts = 5.0}, {.full_scale_counts = 4095.0}};
       }},
      // Ends.
      {"Loop: 9950 ticks, ended after 10 s with the glove's last frame. The machine",
       [](R& r) { r.facts.end = LiveEnd::kGloveEnded; }},
      {"Loop: 9950 ticks, ended after 10 s with the scenario's motion. The machine",
       [](R& r) {
         r.facts.end = LiveEnd::kGloveEnded;
         r.context.has_real_glove = false;
       }},
      // Advice: first the machine, then the link, then the command frames, then the largest stage.
      {"Advice: the machine skipped 1.1 % of the ticks; allow real-time priority or free a "
       "processor first.\n",
       [](R& r) {
         r.facts.ticks = 9890;
         r.facts.skipped_ticks = 110;
         r.facts.arrivals.lost = 5000;
       }},
      {"Advice: the receiver",  // exactly one percent
       [](R& r) {
         r.facts.ticks = 9900;
         r.facts.skipped_ticks = 100;
       }},
      {"Advice: mend the link before the filter: more than 5 % of the samples are lost.\n",
       [](R& r) {
         r.facts.arrivals.frames = 949;
         r.facts.arrivals.lost = 51;
         r.context.timing.event_period_ms = 500.0;
       }},
      {"Advice: the receiver",  // exactly five percent
       [](R& r) {
         r.facts.arrivals.frames = 950;
         r.facts.arrivals.lost = 50;
       }},
      {"Advice: command frames every 45.1 ms hold a command for 22.55 ms on average, longer than "
       "all stages here (22.52 ms); a shorter period of the frames gains up to that.\n",
       [](R& r) { r.context.timing.event_period_ms = 45.1; }},
      {"Advice: the receiver", [](R& r) { r.context.timing.event_period_ms = 45.045; }},
      {"Advice: the machine takes 10.511 ms; real-time priority or a free processor gains up to "
       "that.\n",
       [](R& r) { EnlargeStage(Stage::kInput, r); }},
      {"Advice: the machine takes 10.511 ms", [](R& r) { EnlargeStage(Stage::kTick, r); }},
      {"Advice: the machine takes 10.511 ms", [](R& r) { EnlargeStage(Stage::kSend, r); }},
      {"Advice: a shorter filter gains up to 10.511 ms of computing time.\n",
       [](R& r) { EnlargeStage(Stage::kFilter, r); }},
      {"Advice: samples came too seldom for the command frames, or the glove fell silent: 10.511 "
       "ms. Look at the glove and its link.\n",
       [](R& r) { EnlargeStage(Stage::kHeld, r); }},
      {"Advice: a shorter period of the command frames gains up to 10.511 ms.\n",
       [](R& r) { EnlargeStage(Stage::kEvent, r); }},
      // A receiver without buffer and queue is not to be set once more.
      {"Advice: samples wait 10.010 ms for their time by glove.rate_hz, 100 a second; a glove that "
       "sends more often, or at equal intervals, gains up to that.\n",
       [](R& r) { r.context.receiver = "newest"; }},
      // Known numbers.
      {" The way before is known relative to its fastest frame only: 3.001 ms (p50), 5.941 (p99) "
       "above it; absolute, it would need a common clock. Not measured",
       [](R& r) {
         r.facts.arrivals.has_sender_times = true;
         r.facts.arrivals.relative_delay = Ramp(6);
       }},
      {"all stages from the time of a simulated sample on; its link, if set, is simulated. Not",
       [](R& r) { r.context.has_real_glove = false; }},
      {"no time of their sender. The hand is simulated. Assumed: 12 ms",
       [](R& r) { r.context.has_motors = false; }},
  };
}

std::vector<Sentence> UnsaidSentences() {
  return {
      {"Advice", [](R& r) { r.facts.total = {}; }},
      {"stage is",
       [](R& r) {
         r.facts.total = {};
         r.context.has_real_glove = false;
         r.context.has_motors = false;
       }},
      {"batches",  // two gaps in five, and no more
       [](R& r) {
         r.facts.arrivals.gaps = TimesOf_ms({{20, 0.0}, {30, 10.0}});
       }},
      {"batches",  // too few
       [](R& r) {
         r.facts.arrivals.gaps = TimesOf_ms({{25, 0.0}, {24, 10.0}});
       }},
      {"batches",  // a third of the mean
       [](R& r) {
         r.facts.arrivals.gaps = TimesOf_ms({{30, 1.0}, {20, 6.0}});
       }},
      {"Warning", [](R& r) { r.context.timing.glove_rate_hz = 96.0; }},
      {"Warning", [](R& r) { r.context.timing.glove_rate_hz = 105.0; }},
      {"Warning", [](R& r) { r.facts.arrivals.last_ns = r.facts.arrivals.first_ns; }},
      {"Samples", [](R& r) { r.context.has_real_glove = false; }},
      {"restarted", [](R&) {}},
      {"Left out", [](R&) {}},
      {"Switches", [](R&) {}},
      {"still", [](R&) {}},
      {"rest:", [](R&) {}},
      {"buffer.", [](R& r) { r.context.receiver = "newest"; }},
  };
}

TEST(LiveText, SaysWhatHappenedAndWhatToDo) {
  for (const Sentence& sentence : SaidSentences()) {
    ReportedSession session;
    sentence.change(session);
    EXPECT_THAT(session.Text(), HasSubstr(sentence.text));
  }
  for (const Sentence& sentence : UnsaidSentences()) {
    ReportedSession session;
    sentence.change(session);
    EXPECT_THAT(session.Text(), Not(HasSubstr(sentence.text)));
  }
}

TEST(LargestStage, IsTheFirstOfEqualOnes) {
  LiveFacts facts;
  for (std::size_t stage = 0; stage < kStages; ++stage) facts.stages[stage] = Ramp(1);
  EXPECT_EQ(LargestStage(facts), Stage::kInput);
  for (std::size_t stage = 1; stage < kStages; ++stage) {
    facts.stages[stage] = Ramp(1 + static_cast<std::int64_t>(stage));
    EXPECT_EQ(LargestStage(facts), static_cast<Stage>(stage));
  }
}

TEST(ShadowText, NamesTheLowestTrackingError) {
  const std::vector<ShadowScore> scores = {{.name = "raw",
                                            .drives = true,
                                            .jitter_rms_deg = 2.5,
                                            .delay_ms = 51.0,
                                            .tracking_rmse_deg = controller::kNaN,
                                            .step_p99_us = 11.0},
                                           {.name = "one_euro",
                                            .jitter_rms_deg = 0.75,
                                            .delay_ms = 62.0,
                                            .tracking_rmse_deg = 5.25,
                                            .step_p99_us = 12.0},
                                           {.name = "kalman",
                                            .jitter_rms_deg = 0.5,
                                            .delay_ms = 73.0,
                                            .tracking_rmse_deg = 5.5,
                                            .step_p99_us = 13.0}};
  const TerminalStyle style{.width = 10'000, .table_width = TerminalStyle::kNoLimit};
  EXPECT_EQ(
      TextOf(ShadowText(scores, "ground truth"), style),
      R"(Controllers on the same samples, by the angles that they ask of the joints; reference: ground truth. one_euro has the lowest tracking error, 5.25 deg RMS, with jitter 0.75 deg RMS and with delay 62 ms. One session gives no confidence interval: gauntlet compare on the recording does.

               jitter  delay  tracking error  step p99
controller    deg RMS     ms         deg RMS        us
raw (drives)     2.50   51.0               -      11.0
one_euro        0.750   62.0            5.25      12.0
kalman          0.500   73.0            5.50      13.0
)");
  const double none = controller::kNaN;
  ShadowScore alone{
      .name = "raw", .jitter_rms_deg = none, .delay_ms = none, .tracking_rmse_deg = 4};
  EXPECT_THAT(TextOf(ShadowText({alone}, "recording"), style),
              HasSubstr(" raw has the lowest tracking error, 4 deg RMS, without a value of the "
                        "jitter and without a value of the delay. One session"));
  alone.tracking_rmse_deg = none;
  EXPECT_THAT(TextOf(ShadowText({alone}, "recording"), style),
              HasSubstr(": recording. No controller has a tracking error: too little of the "
                        "session counts. One session"));
}

DurationHistogram Once(double us) {
  DurationHistogram times;
  times.Add(std::lround(1e3 * us));
  return times;
}

/// As JsonOf() of one duration.
std::string JsonOfOnce(double us) {
  return Json{{"count", 1},
              {"mean_us", us},
              {"p50_us", us},
              {"p95_us", us},
              {"p99_us", us},
              {"p999_us", us},
              {"max_us", us},
              {"histogram_us", Json::parse("[[" + std::to_string(std::lround(us)) + ".0,1]]")}}
      .dump();
}

/// Each number is another one.
TEST(LiveJson, HasEachMeasurementUnderItsName) {
  ReportedSession session;
  LiveFacts& facts = session.facts;
  facts.end = LiveEnd::kSinkGone;
  facts.lateness = Once(1.0);
  facts.step = Once(2.0);
  facts.step_cpu = Once(3.0);
  facts.tick_work = Once(4.0);
  for (std::size_t i = 0; i < kStages; ++i) facts.stages[i] = Once(10.0 + static_cast<double>(i));
  facts.total = Once(91.0);
  facts.arrivals.gaps = Once(5.0);
  facts.arrivals.restarts = 12;
  facts.source = {.frames = 9,
                  .garbage = 13,
                  .half_frames = 14,
                  .foreign = 15,
                  .overflowed = 16,
                  .reopened = 17};
  facts.grid_shifts = 18;
  facts.repeated_samples = 19;
  facts.largest_step_counts = 20;
  facts.sink = {.frames = 21, .dropped = 22, .failed = 23};
  facts.rests = 24;
  facts.tiers = {{{99, 9.0}, {1, 0.125}, {2, 0.25}, {3, 4.0}}};
  facts.rights.has_priority = true;
  facts.switch_count = 3;
  facts.switches = {{1.25, 1}, {2.5, 0}};
  facts.still = {{3.5, 4.5}};
  facts.untrusted_samples = {31, 32};
  session.context.glove = "file:/home/a/glove.csv";
  const Json json = LiveJson(facts, session.context, {{.name = "kalman", .drives = true}});
  const std::vector<std::pair<const char*, std::string>> expected = {
      {"version", "1"},
      {"scenario", R"("door")"},
      {"controller", R"("raw")"},
      {"glove", R"("file:glove.csv")"},
      {"motors", R"("udp:9001, csv")"},
      {"ended_by", R"("motors gone")"},
      {"duration_s", "10.0"},
      {"total", JsonOfOnce(91.0)},
      {"largest_stage", R"("send")"},
      {"commands", R"({"frames":500,"of_the_same_sample":19,"replaced":6,)"
                   R"("largest_step_counts":20,"sent":21,"dropped":22,"failed":23,"rests":24})"},
      {"watchdog",
       R"({"hold":{"entered":1,"longest_s":0.125},)"
       R"("relax":{"entered":2,"longest_s":0.25},"off":{"entered":3,"longest_s":4.0}})"},
      {"loop", R"({"tick_rate_hz":1000.0,"ticks":9950,"skipped_ticks":50,)"
               R"("longest_skip_ticks":12,"has_real_time_priority":true,"has_locked_memory":false,)"
               R"("lateness":)" +
                   JsonOfOnce(1.0) + R"(,"step":)" + JsonOfOnce(2.0) +
                   R"(,"step_processor_time":)" + JsonOfOnce(3.0) + R"(,"tick_work":)" +
                   JsonOfOnce(4.0) + "}"},
      {"switches", R"({"first":[{"time_s":1.25,"controller":"kalman"},)"
                   R"({"time_s":2.5,"controller":"raw"}],"count":3})"},
      {"still", R"([{"begin_s":3.5,"end_s":4.5}])"},
      {"untrusted_samples", "[31,32]"},
      {"assumed", R"({"event_delay_ms":12.0,"hand":"simulated beside the motors"})"},
      {"frames", R"({"frames":1001,"different":951,"frames_per_s":100.0,"different_per_s":95.0,)"
                 R"("has_numbers":true,"lost":50,"longest_loss":21,"p99_loss":20,"repeated":8,)"
                 R"("out_of_order":9,"restarts":12,"late":7,"garbage":13,"half_frames":14,)"
                 R"("of_other_senders":15,"dropped_by_system":16,"reopened":17,"ring_overruns":4,)"
                 R"("most_in_ring":3,"most_in_receiver":5,"grid_shifts":18,"gaps":)" +
                     JsonOfOnce(5.0) + "}"},
      {"controllers", R"([{"controller":"kalman","drives":true,"jitter_rms_deg":0.0,)"
                      R"("delay_ms":0.0,"tracking_rmse_deg":0.0,"step_p99_us":0.0}])"}};
  for (const auto& [key, value] : expected) EXPECT_EQ(json[key].dump(), value) << key;
  const std::vector<std::string> stages = {"input", "tick",  "receiver", "filter",
                                           "held",  "event", "send"};
  for (std::size_t i = 0; i < kStages; ++i) {
    EXPECT_EQ(json["stages"][stages[i]].dump(), JsonOfOnce(10.0 + static_cast<double>(i)));
  }
  EXPECT_EQ(json["stages"].size(), kStages);
  EXPECT_EQ(json["age_trend"]["ms_per_minute"].get<double>(), 0.25);
  EXPECT_EQ(json["age_trend"]["standard_error"].get<double>(), 0.0);
  EXPECT_EQ(json.size(), expected.size() + 2);
}

TEST(LiveJson, LeavesOutWhatThereIsNot) {
  LiveContext context;
  const Json json = LiveJson({}, context, {});
  for (const char* key : {"largest_stage", "frames", "switches", "still", "controllers"}) {
    EXPECT_FALSE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["total"].dump(), R"({"count":0})");
  EXPECT_TRUE(json["age_trend"].is_null());
  EXPECT_EQ(json["ended_by"].dump(), R"("seconds")");
  EXPECT_EQ(json["assumed"]["hand"].dump(), R"("simulated")");
  const std::vector<std::pair<LiveEnd, std::string>> ends = {
      {LiveEnd::kGloveEnded, "glove ended"},
      {LiveEnd::kStopped, "stopped"},
      {LiveEnd::kHandStopped, "simulated hand stopped"}};
  for (const auto& [end, name] : ends) {
    LiveFacts facts;
    facts.end = end;
    EXPECT_EQ(LiveJson(facts, context, {})["ended_by"].get<std::string>(), name);
  }
}

TEST(LiveJson, HasTheWayBeforeWhereTheSenderGivesItsTime) {
  ReportedSession session;
  session.facts.arrivals.has_sender_times = true;
  session.facts.arrivals.relative_delay = Once(6.0);
  session.facts.arrivals.relative_delay_ms = TrendOf(1.5);
  session.facts.arrivals.gaps = TimesOf_ms({{25, 0.0}, {25, 10.0}});
  session.facts.total = TimesOf_ms({{500, 1.0}, {450, 2.0}, {40, 3.0}, {9, 4.0}, {1, 5.0}});
  const Json json = LiveJson(session.facts, session.context, {});
  EXPECT_EQ(json["frames"]["relative_delay"].dump(), JsonOfOnce(6.0));
  EXPECT_EQ(json["frames"]["relative_delay_trend"]["ms_per_minute"].get<double>(), 1.5);
  EXPECT_EQ(json["frames"]["batch_ms"].get<double>(), 10.0);
  EXPECT_EQ(json["total"].dump(),
            R"({"count":1000,"mean_us":1561.0,"p50_us":1001.0,"p95_us":2001.0,"p99_us":3001.0,)"
            R"("p999_us":4001.0,"max_us":5000.0,"histogram_us":[[1000.0,500],[2000.0,450],)"
            R"([3000.0,40],[4000.0,9],[5000.0,1]]})");
}

}  // namespace
}  // namespace gauntlet::sim
