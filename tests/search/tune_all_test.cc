// Every kind of filter gets the same search, and is judged on the same seeds.
#include "sim/answers/tune/tune_all.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "controller/filters/filter_registry.h"
#include "sim/answers/tune/filter_search.h"
#include "sim/answers/tune/tune_tables.h"
#include "sim/base/random.h"
#include "sim/settings/yaml_tree.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

/// A scenario whose controller `it` filters with a kind that has these settings, and 1 for r.
controller::FilterConfig FilterOf(const std::string& settings, double rate_hz,
                                  const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "s.yaml";
  std::ofstream(file) << "question: q\nglove: {rate_hz: " << rate_hz
                      << ", channels: [index_mcp]}\ncontrollers:\n  it: {filter: {" << settings
                      << "}}\n";
  return LoadScenario(file, {}).controllers.front().config.filters.front();
}

/// How much of white noise a filter lets through.
double NoiseGain(const controller::FilterConfig& config, double rate_hz) {
  const auto filter = controller::MakeFilter(config, 1, rate_hz);
  RandomStream stream(3, "noise");
  double squares_in = 0.0, squares_out = 0.0;
  for (int n = 0; n < 3000; ++n) {
    double value = stream.Uniform() - 0.5;
    squares_in += value * value;
    filter->Step({&value, 1}, {&value, 1});
    if (n >= 500) squares_out += value * value;
  }
  return std::sqrt(squares_out / 2500.0 / (squares_in / 3000.0));
}

TEST(FilterSearch, GoesFromNoSmoothingToMuchOfItForEveryKindAtEveryRate) {
  const test::TemporaryDirectory folder;
  for (const double rate_hz : {60.0, 1000.0}) {
    for (const controller::FilterKind& kind : controller::FilterKinds()) {
      const std::string head = "kind: " + std::string(kind.name);
      const FilterSearch search = SearchOf(FilterOf(head, rate_hz, folder.path()),
                                           {.rate_hz = rate_hz, .unit_per_rad = 1.0});
      if (!search.left_out.empty() || search.free.empty()) continue;
      double least = 10.0, most = 0.0;
      int built = 0;
      const int corners = 1 << search.free.size();
      for (int corner = 0; corner < corners; ++corner) {
        std::string settings = head;
        for (std::size_t a = 0; a < search.free.size(); ++a) {
          settings += ", " + search.free[a].key + ": " +
                      search.free[a].ValueAt((corner >> a) % 2 == 0 ? 0.0 : 1.0);
        }
        try {
          const double gain = NoiseGain(FilterOf(settings, rate_hz, folder.path()), rate_hz);
          least = std::min(least, gain);
          most = std::max(most, gain);
          ++built;
        } catch (const controller::SettingError&) {  // alpha, beta and gamma that are not stable
        }
      }
      EXPECT_GE(built, corners / 4) << kind.name;
      EXPECT_GT(most, 0.7) << kind.name << " at " << rate_hz;
      EXPECT_LT(least, 0.4) << kind.name << " at " << rate_hz;
    }
  }
}

class TuneAllTest : public testing::Test {
 protected:
  TuneAllTest() {
    const std::filesystem::path file = folder_.path() / "base.yaml";
    std::ofstream(file) << "question: Which filter?\n"
                           "seed: 3\n"
                           "glove:\n"
                           "  rate_hz: 60\n"
                           "  channels: [index_mcp, index_pip]\n"
                           "  motion: {kind: random, duration_s: 4, bandwidth_hz: 1}\n"
                           "controllers:\n"
                           "  raw: {filter: none}\n";
    plan_.scenario = {.file = file, .text = ReadYamlText(file)};
    plan_.controller = "raw";
    plan_.minimise = MetricIndex("delay_ms");
    plan_.constraints = {ParseConstraint("jitter_rms_deg<=0.35", "")};
    plan_.seeds = 2;
    plan_.held_out = 2;
    plan_.evaluations = 12;
    plan_.physics = false;
  }
  std::vector<TunedKind> Run(int jobs = 1) const {
    return TuneAll(plan_, jobs, [](double, double) { return true; });
  }

  test::TemporaryDirectory folder_;
  TunePlan plan_;
};

TEST_F(TuneAllTest, FindsTheBestOfEachKindWithTheSameBudget) {
  const std::vector<TunedKind> kinds = Run();
  ASSERT_EQ(kinds.size(), controller::FilterKinds().size());
  std::set<std::string> names;
  double before = 0.0;
  bool is_first = true;
  bool answers = true;
  for (const TunedKind& tuned : kinds) {
    names.insert(tuned.kind);
    EXPECT_TRUE(answers || !tuned.has_answer()) << "answers come first";
    answers = tuned.has_answer();
    if (!tuned.left_out.empty()) {
      EXPECT_EQ(tuned.kind, "kalman_dense");
      continue;
    }
    EXPECT_LE(std::ssize(tuned.result.tried), plan_.evaluations) << tuned.kind;
    EXPECT_GE(std::ssize(tuned.result.tried), tuned.kind == "none" ? 1 : 5) << tuned.kind;
    EXPECT_FALSE(tuned.result.front.empty()) << tuned.kind;
    if (!tuned.has_answer()) continue;
    const TunedSetting& verdict = tuned.result.verdict;
    // The chosen kind comes first; held-out values order the others.
    EXPECT_GE(verdict.scores.front().mean, before);
    if (!is_first) before = verdict.scores.front().mean;
    is_first = false;
    EXPECT_LT(verdict.met, Met::kNo) << tuned.kind;
    EXPECT_EQ(tuned.result.controller.config.filters.front().kind(), tuned.kind);
  }
  EXPECT_EQ(names.size(), kinds.size());
  EXPECT_TRUE(kinds.front().has_answer());
  EXPECT_NE(kinds.front().kind, "none");  // the noise is above the bound without a filter
  EXPECT_EQ(TuneCsv(plan_, kinds), TuneCsv(plan_, Run(2)));
}

TEST_F(TuneAllTest, FindsOfOneKindWhatTuningOfItAloneFinds) {
  const std::vector<TunedKind> kinds = Run();
  const auto tuned = std::ranges::find(kinds, "exponential", &TunedKind::kind);
  ASSERT_TRUE(tuned->has_answer());
  TunePlan alone = tuned->plan;
  alone.evaluations = 40;
  const TuneResult result = Tune(alone, 1, [](double, double) { return true; });
  EXPECT_NEAR(tuned->result.tried[tuned->result.chosen].scores.front().mean,
              result.tried[result.chosen].scores.front().mean, 5.0);
}

TEST_F(TuneAllTest, SaysOfKindsThatNoneKeepsABound) {
  plan_.constraints = {ParseConstraint("jitter_rms_deg<=1e-6", "")};
  plan_.evaluations = 4;
  for (const TunedKind& tuned : Run()) EXPECT_FALSE(tuned.has_answer()) << tuned.kind;
}

TEST(TuneAll, RecommendsNoneThatIsNotToldApartFromOthers) {
  TunePlan plan;
  plan.minimise = MetricIndex("delay_ms");
  std::vector<TunedKind> kinds(3);
  for (TunedKind& kind : kinds) {
    kind.result.metrics = {MetricIndex("delay_ms")};
    kind.result.verdict.scores = {{.mean = 7.0}};
  }
  kinds[0].kind = "kalman";
  kinds[1].kind = "one_euro";
  kinds[1].to_best.judgement = Judgement::kEqual;
  kinds[2].kind = "median";
  kinds[2].to_best.judgement = Judgement::kWorse;
  EXPECT_EQ(VerdictOf(plan, kinds).recommended, "kalman");
  EXPECT_EQ(VerdictOf(plan, kinds).alternatives, (std::vector<std::string>{"one_euro"}));
  kinds[2].to_best.judgement = Judgement::kUndecided;
  EXPECT_EQ(VerdictOf(plan, kinds).recommended, "");
  EXPECT_EQ(VerdictOf(plan, kinds).alternatives,
            (std::vector<std::string>{"kalman", "one_euro", "median"}));
  EXPECT_EQ(VerdictOf(plan, kinds).Text(),
            "Chosen on the fitted seeds: kalman: delay 7.00 ms. Equivalent in delay: one_euro. No "
            "recommendation, as it is undecided against median. More seeds can decide it.");
  for (TunedKind& tuned : kinds) tuned.result.problem = "no setting keeps the bounds";
  EXPECT_EQ(VerdictOf(plan, kinds).recommended, "");
}

}  // namespace
}  // namespace gauntlet::sim
