// Tuning finds what is known to be best, and says what held-out seeds say.
#include "sim/answers/tune/tune.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "controller/filters/filter_registry.h"
#include "sim/answers/tune/tune_tables.h"
#include "sim/base/error.h"
#include "sim/base/normal_pair.h"
#include "sim/base/optimise.h"
#include "sim/base/random.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

/// A path whose acceleration is white noise of density q, and its samples with noise.
struct WhiteAcceleration {
  std::vector<double> truth;
  std::vector<double> samples;
};

WhiteAcceleration MakePath(double q, double r, double rate_hz, int count) {
  RandomStream stream(7, "white acceleration");
  const auto normal = [&stream] {
    return std::sqrt(-2.0 * std::log(stream.UniformAboveZero())) *
           std::cos(2.0 * M_PI * stream.Uniform());
  };
  const double h = 1.0 / rate_hz;
  double position = 0.0, velocity = 0.0;
  WhiteAcceleration path;
  for (int n = 0; n < count; ++n) {
    // Exact: the two parts of one step's noise have the covariance q [h^3/3 h^2/2; h^2/2 h].
    const double a = std::sqrt(q * h) * normal();
    const double b = std::sqrt(q * h * h * h / 12.0) * normal();
    position += h * velocity + 0.5 * h * a + b;
    velocity += a;
    path.truth.push_back(position);
    path.samples.push_back(position + std::sqrt(r) * normal());
  }
  return path;
}

double RmsOfKalman(double q, double r, double rate_hz, const WhiteAcceleration& path) {
  controller::KalmanConfig config;
  config.noise.q = {q};
  config.noise.r = {r};
  config.noise.process_noise = controller::ProcessNoise::kWhite;
  const auto filter = controller::MakeFilter(config, 1, rate_hz);
  double squares = 0.0;
  for (std::size_t n = 0; n < path.truth.size(); ++n) {
    double value = path.samples[n];
    filter->Step({&value, 1}, {&value, 1});
    squares += (value - path.truth[n]) * (value - path.truth[n]);
  }
  return std::sqrt(squares / static_cast<double>(path.truth.size()));
}

TEST(Minimise, FindsTheKnownProcessNoiseOfWhiteAcceleration) {
  constexpr double kRate_hz = 100.0, kR = 4.0, kQ = 2000.0;
  const WhiteAcceleration path = MakePath(kQ, kR, kRate_hz, 20000);
  const double optimum = RmsOfKalman(kQ, kR, kRate_hz, path);  // no linear filter does better
  int measured = 0;
  const auto q_at = [](double place) { return 1e-2 * std::pow(1e9, place); };
  const auto points = Minimise(1, 100, [&](const std::vector<double>& place) {
    ++measured;
    return Measured{.objective = RmsOfKalman(q_at(place[0]), kR, kRate_hz, path)};
  });
  EXPECT_LE(measured, 100);
  EXPECT_LT(BestOf(points).measured.objective, 1.05 * optimum);
  EXPECT_NEAR(std::log10(q_at(BestOf(points).place[0])), std::log10(kQ), 0.3);
}

TEST(Minimise, StopsAtABoundInTwoDimensions) {
  // The nearest point to (0.9, 0.8) with x + y <= 1 is (0.55, 0.45).
  const auto points = Minimise(2, 200, [](const std::vector<double>& p) {
    return Measured{.objective = std::hypot(p[0] - 0.9, p[1] - 0.8),
                    .violation = std::max(0.0, p[0] + p[1] - 1.0)};
  });
  const MeasuredPoint& best = BestOf(points);
  EXPECT_EQ(best.measured.violation, 0.0);
  EXPECT_LT(best.measured.objective, 1.05 * std::hypot(0.35, 0.35));
}

TEST(Minimise, LetsAnErrorThrough) {
  EXPECT_THROW(Minimise(1, 10, [](const std::vector<double>&) -> Measured { throw Cancelled{}; }),
               Cancelled);
}

class TuneTest : public testing::Test {
 protected:
  TuneTest() {
    std::ofstream(folder_.path() / "base.yaml")
        << "question: How much smoothing?\n"
           "seed: 3\n"
           "glove:\n"
           "  rate_hz: 100\n"
           "  motion: {kind: random, duration_s: 4, bandwidth_hz: 1}\n"
           "score: {noise_free_twin: false}\n"
           "controllers:\n"
           "  smooth: {filter: {kind: exponential, alpha: 1}}\n";
    const std::filesystem::path file = folder_.path() / "base.yaml";
    plan_.scenario = {.file = file, .text = ReadYamlText(file)};
    plan_.controller = "smooth";
    plan_.free = {ParseFree("filter.alpha=0.01:1:log", "smooth")};
    plan_.minimise = MetricIndex("tracking_rmse_deg");
    plan_.seeds = 3;
    plan_.held_out = 4;
    plan_.evaluations = 30;
    plan_.physics = false;
  }
  TuneResult Run(int jobs = 1) const {
    return Tune(plan_, jobs, [](double, double) { return true; });
  }

  test::TemporaryDirectory folder_;
  TunePlan plan_;
};

TEST_F(TuneTest, KeepsABoundAndMeetsItClosely) {
  plan_.minimise = MetricIndex("delay_ms");
  plan_.constraints = {ParseConstraint("jitter_rms_deg<=0.15", "")};
  const TuneResult result = Run();
  const TunedSetting& chosen = result.tried[result.chosen];
  EXPECT_TRUE(chosen.KeepsBounds());
  EXPECT_LE(chosen.scores[1].mean, 0.15);
  // Delay falls as jitter rises: the least delay is at the bound.
  const auto least = std::ranges::min_element(result.tried, {}, [](const TunedSetting& setting) {
    return setting.KeepsBounds() ? setting.scores[0].mean : 1e9;
  });
  EXPECT_GT(least->scores[1].mean, 0.13);
  EXPECT_LT(result.verdict.met, Met::kNo);
  EXPECT_EQ(result.verdict.motions.size(), 4u);
}

TEST_F(TuneTest, TakesTheLeastJitterAmongEquivalentDelays) {
  plan_.minimise = MetricIndex("delay_ms");
  const TuneResult result = Run();
  const TunedSetting& chosen = result.tried[result.chosen];
  const auto least = std::ranges::min_element(
      result.tried, {}, [](const TunedSetting& setting) { return setting.scores[0].mean; });
  const std::size_t jitter = PlaceOfMetric(result, MetricIndex("jitter_rms_deg"));
  const auto relevant = [&](double delay_ms) {
    return RelevantDifferenceBetween(Metrics()[plan_.minimise], delay_ms, least->scores[0].mean);
  };
  EXPECT_LE(chosen.scores[0].mean, least->scores[0].mean + relevant(chosen.scores[0].mean));
  EXPECT_LT(chosen.scores[jitter].mean, least->scores[jitter].mean - 0.02);
}

TEST_F(TuneTest, TakesTheLeastDelayAmongSettingsOfTheLeastJitter) {
  plan_.minimise = MetricIndex("jitter_rms_deg");
  const TuneResult result = Run();
  const TunedSetting& chosen = result.tried[result.chosen];
  const auto least = std::ranges::min_element(
      result.tried, {}, [](const TunedSetting& setting) { return setting.scores[0].mean; });
  const std::size_t delay = PlaceOfMetric(result, MetricIndex("delay_ms"));
  EXPECT_LT(chosen.scores[delay].mean, least->scores[delay].mean - 20.0);
  EXPECT_LT(chosen.scores[0].mean - least->scores[0].mean,
            RelevantDifferenceBetween(Metrics()[plan_.minimise], chosen.scores[0].mean,
                                      least->scores[0].mean));
}

TEST_F(TuneTest, GivesTheSameOnAnyNumberOfThreadsAndReadsBack) {
  const TuneResult one = Run(1);
  EXPECT_EQ(TuneCsv(plan_, one), TuneCsv(plan_, Run(2)));
  EXPECT_LE(one.tried.size(), 30u);
  // What it writes is a controller with that value.
  std::string text = plan_.scenario.text;
  text.replace(text.find("{filter"), std::string::npos, "!include it.yaml\n");
  std::ofstream(folder_.path() / "it.yaml") << ControllerYaml(one.controller);
  std::ofstream(folder_.path() / "tuned.yaml") << text;
  const Scenario tuned = LoadScenario(folder_.path() / "tuned.yaml", {});
  const auto& filter = std::get<controller::ExponentialConfig>(
      tuned.controllers.front().config.filters.front().settings);
  EXPECT_EQ(filter.alpha, std::stod(one.tried[one.chosen].values[0]));
}

TEST_F(TuneTest, SaysThatNoSettingKeepsABound) {
  plan_.constraints = {ParseConstraint("jitter_rms_deg<=1e-6", "")};
  EXPECT_THROW(Run(), RunError);
}

TEST(ParseFree, RefusesWhatIsNoRange) {
  for (const char* text : {"filter.q", "filter.q=1", "=1:2", "filter.q=2:1", "filter.q=0:1:log",
                           "filter.q=1:2:lgo", "filter.q=a:2", "filter.q=1:2x"}) {
    EXPECT_THROW(ParseFree(text, "a"), UserError) << text;
  }
  const SweepAxis axis = ParseFree("filter.window=3:100:log:whole", "a");
  EXPECT_EQ(axis.key, "controllers.a.filter.window");
  EXPECT_EQ(axis.ValueAt(0.5), "17");
}

}  // namespace
}  // namespace gauntlet::sim
