// What the rate of the glove does to a trial, and what it must not do.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/study/study_run.h"

namespace gauntlet::sim {
namespace {

constexpr double kRatesHz[] = {33.3, 60, 100, 250, 500, 1000, 2000};
constexpr double kPlainRateHz = 1000.0;
constexpr double kDurationS = 5.0;

/// All joints move at random, the same way at every rate.
Scenario RandomMotionAt(double rate_hz, double duration_s, double range_percent) {
  Scenario scenario;
  scenario.name = "rates";
  scenario.question = "What does a slow glove cost?";
  scenario.glove.rate_hz = rate_hz;
  scenario.glove.motion.settings = RandomMotionConfig{
      .duration_s = duration_s, .bandwidth_hz = 0.7, .range_percent = range_percent};
  return scenario;
}

NamedController Filtered(const std::string& name, std::vector<controller::FilterConfig> filters) {
  NamedController named{.name = name, .calibration = {}, .config = {}};
  named.config.filters = std::move(filters);
  return named;
}

std::vector<double> Summaries(Scenario scenario, std::string_view metric) {
  StudyOptions options;
  options.jobs = 2;
  options.keep_first_traces = false;
  const StudyResult result = RunStudy(PrepareStudy(std::move(scenario)), options);
  std::vector<double> values;
  for (const TrialOutcome& outcome : result.seeds[0].controllers) {
    EXPECT_TRUE(outcome.health.ok) << outcome.health.problem;
    values.push_back(outcome.scores.summary[MetricIndex(metric)]);
  }
  return values;
}

/// From the clocks alone: how old the newest sample is when a frame leaves, on average, and by how
/// much the delay of the link is not what was asked for, as it is whole ticks.
double MeanAgeOfSamplesMs(double rate_hz) {
  const double ticks_per_sample = std::max(1.0, std::ceil(1000.0 / rate_hz - 1e-9));
  const double tick_ms = 1000.0 / (rate_hz * ticks_per_sample);
  const EventConfig event;
  const auto events = static_cast<int>(1000.0 * kDurationS / event.period_ms);
  double sum_ms = 0.0;
  for (int j = 0; j < events; ++j) {
    const double event_tick = std::ceil(j * event.period_ms / tick_ms - 1e-6);
    sum_ms += tick_ms * std::fmod(event_tick, ticks_per_sample);
  }
  const double link_ms = tick_ms * std::round(event.delay_ms / tick_ms);
  return sum_ms / events + link_ms - event.delay_ms;
}

double DelayMs(double rate_hz) {
  // Wide: a thumb that moves less than its joint's friction holds has no delay to speak of.
  Scenario scenario = RandomMotionAt(rate_hz, kDurationS, 80.0);
  scenario.glove.noise.kind = WhiteNoiseKind::kNone;
  scenario.controllers = {Filtered("raw", {})};
  return Summaries(scenario, "delay_ms")[0];
}

TEST(SamplingRate, AddsTheAgeOfTheHeldSampleToTheDelayAndNothingElse) {
  const double plain_ms = DelayMs(kPlainRateHz);
  const double plain_age_ms = MeanAgeOfSamplesMs(kPlainRateHz);
  ASSERT_EQ(plain_age_ms, 0.0);  // there is a sample at every event
  for (const double rate_hz : kRatesHz) {
    const double added_ms = DelayMs(rate_hz) - plain_ms;
    const double expected_ms = MeanAgeOfSamplesMs(rate_hz) - plain_age_ms;
    EXPECT_NEAR(added_ms, expected_ms, 3.5) << rate_hz << " Hz";
    RecordProperty(fmt::format("added_ms_at_{}_hz", rate_hz),
                   fmt::format("{:.2f}, expected {:.2f}", added_ms, expected_ms));
  }
}

TEST(SamplingRate, LeavesTheOrderOfControllersByJitterAsItIs) {
  for (const double rate_hz : kRatesHz) {
    Scenario scenario = RandomMotionAt(rate_hz, 3.0, 40.0);
    scenario.controllers = {
        Filtered("raw", {}), Filtered("paper_kalman", {{controller::KalmanConfig{}}}),
        Filtered("tuned_kalman", {{controller::KalmanConfig{.noise = {.q = {0.01}}}}})};
    const std::vector<double> jitter_deg = Summaries(scenario, "jitter_rms_deg");
    EXPECT_GT(jitter_deg[0], jitter_deg[1]) << rate_hz << " Hz";
    EXPECT_GT(jitter_deg[1], jitter_deg[2]) << rate_hz << " Hz";
    RecordProperty(
        fmt::format("jitter_deg_at_{}_hz", rate_hz),
        fmt::format("{:.3f} {:.3f} {:.3f}", jitter_deg[0], jitter_deg[1], jitter_deg[2]));
  }
}

}  // namespace
}  // namespace gauntlet::sim
