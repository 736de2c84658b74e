// Tuning finds what is known to be best, and says what held-out seeds say.
#include "sim/answers/tune/tune.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "controller/filters/filter_registry.h"
#include "controller/number.h"
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
  const std::size_t jitter = PlaceOfMetric(result.metrics, MetricIndex("jitter_rms_deg"));
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
  const std::size_t delay = PlaceOfMetric(result.metrics, MetricIndex("delay_ms"));
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

TEST(ParseFree, HasAsManyDigitsAsTheRangeNeeds) {
  EXPECT_EQ(ParseFree("filter.q=1e-6:10:log", "it").ValueAt(0.37), "0.000389");
  EXPECT_EQ(ParseFree("filter.beta=0:1", "it").ValueAt(0.12345), "0.123");
  const SweepAxis narrow = ParseFree("filter.q=1:1.001", "it");
  EXPECT_NE(narrow.ValueAt(0.50), narrow.ValueAt(0.51));
  const SweepAxis odd = ParseFree("filter.q=0.12346:0.98764", "it");
  for (double place = 0.0; place <= 1.0; place += 1e-4) {
    const double value = controller::ParseNumber(odd.ValueAt(place)).value();
    EXPECT_GE(value, odd.low);
    EXPECT_LE(value, odd.high);
  }
}

/// The verdict on one setting with this value.
std::string VerdictOn(const std::string& free, const controller::FilterConfig& filter,
                      controller::FilterOn on, double unit_per_rad, const std::string& value,
                      const EqualRange& equal) {
  TunePlan plan;
  plan.controller = "it";
  plan.free = {ParseFree(free, "it")};
  TuneResult result;
  result.metrics = {MetricIndex("delay_ms")};
  result.tried = {{.values = {value}, .scores = {{.mean = 7.0}}}};
  result.verdict = result.before = result.tried.front();
  result.equal = {equal};
  result.controller.config.filters = {filter};
  result.controller.config.filter_on = on;
  result.unit_per_rad = unit_per_rad;
  return VerdictOf(plan, result).Text();
}

TEST(TuneVerdict, HasOneValueOfOneFilterForASignalInDegrees) {
  using enum controller::FilterOn;
  using testing::HasSubstr;
  controller::FilterConfig one_euro;
  one_euro.settings = controller::OneEuroConfig{};
  const std::string on_counts =
      VerdictOn("filter.beta=0:1", one_euro, kCounts, 200.0, "0.01", {"0.01", "0.02"});
  EXPECT_THAT(on_counts,
              HasSubstr("beta is in Hz/(count/s): 0.0349 for a signal in deg, 2 in rad."));
  const std::string on_angle =
      VerdictOn("filter.beta=0:10", one_euro, kAngle, 1.0, "2", {"1.5", "2.5"});
  EXPECT_THAT(on_angle, HasSubstr("beta is in Hz/(rad/s): 0.0349 for a signal in deg."));
  controller::FilterConfig kalman;
  kalman.settings = controller::KalmanConfig{};
  EXPECT_THAT(VerdictOn("filter.q=1:10", kalman, kCounts, 200.0, "4", {"2", "5"}),
              HasSubstr("q is in count^2: 0.328 for a signal in deg, 0.0001 in rad."));
  EXPECT_THAT(VerdictOn("filter.min_cutoff_hz=1:10", one_euro, kCounts, 200.0, "4", {"2", "5"}),
              testing::Not(HasSubstr("for a signal")));
  controller::FilterConfig jerk;
  jerk.settings = controller::JerkLimitConfig{};
  EXPECT_THAT(VerdictOn("filter.max_jerk_per_s3=1:1e6", jerk, kCounts, 200.0, "2000", {"2", "5"}),
              HasSubstr("max_jerk_per_s3 is in count/s^3: 573 for a signal in deg, 10 in rad."));
}

TEST(TuneVerdict, SaysWhereTheRangeOfTheSearchEnds) {
  using testing::HasSubstr;
  const auto with = [](const EqualRange& equal) {
    return VerdictOn("filter.min_cutoff_hz=0.1:10:log", {}, controller::FilterOn::kAngle, 1.0, "4",
                     equal);
  };
  EXPECT_THAT(with({"10", "10"}),
              HasSubstr("Equivalent settings: filter.min_cutoff_hz 10 (the range ends at 10)."));
  EXPECT_THAT(with({"0.1", "3"}), HasSubstr("0.1 to 3 (the range ends at 0.1)."));
  EXPECT_THAT(with({"0.1", "10"}), HasSubstr("0.1 to 10 (the whole range)."));
  EXPECT_THAT(with({"2", "3"}), HasSubstr("filter.min_cutoff_hz 2 to 3."));
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
