// Predictions that are fitted to the other repetitions of a scenario.
#include "sim/study/prediction_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

class PredictionFitTest : public testing::Test {
 protected:
  Study Prepare(const std::string& repetitions, const std::string& more = "") const {
    const auto file = folder_.path() / "scenario.yaml";
    std::ofstream(file)
        << "question: q\nseed: 3\n"
           "glove:\n  channels: [index_mcp, index_pip]\n"
           "  motion: " +
               motion_ + "\n" + repetitions + "controllers:\n  fitted:\n    " + more +
               "\n    prediction: {kind: fitted_to_others, order: 10, offset: true}\n";
    return PrepareStudy(LoadScenario(file, {}));
  }
  static const controller::FittedPredictionConfig& WeightsOf(
      const controller::ControllerConfig& config) {
    return std::get<controller::FittedPredictionConfig>(config.prediction.settings);
  }
  static controller::ControllerConfig OfSeed(const Study& study, int seed) {
    return ControllerOfSeed(study, study.scenario.controllers[0].config, seed);
  }
  std::string Complaint(const std::string& repetitions, const std::string& more = "") const {
    try {
      Prepare(repetitions, more);
    } catch (const controller::SettingError& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryDirectory folder_;
  std::string motion_ = "{kind: random, duration_s: 8}";
};

const std::string kThree = "repetitions: {glove.motion.bandwidth_hz: [0.8, 1.0, 1.3]}\n";

TEST_F(PredictionFitTest, TakesWeightsFromAllOthers) {
  const Study study = Prepare(kThree);
  const controller::ControllerConfig& asked = study.scenario.controllers[0].config;
  const auto& wanted =
      std::get<controller::FittedToOthersPredictionConfig>(asked.prediction.settings);
  for (int left_out = 0; left_out < 3; ++left_out) {
    std::vector<Eigen::MatrixXd> others;
    for (int i = 0; i < 3; ++i) {
      if (i == left_out) continue;
      const auto glove = GloveOfSeed(study, 3 + i);
      for (auto& seen : SeenByPredictor(study, asked, *glove)) others.push_back(seen);
    }
    const auto expected = FitPredictor(others, 1000.0, wanted).predictor;
    for (const int round : {0, 1}) {  // repetitions take turns
      const auto found = WeightsOf(OfSeed(study, 3 + left_out + 3 * round));
      for (std::size_t w = 0; w < expected.weights.size(); ++w) {
        ASSERT_NEAR(found.weights[w], expected.weights[w], 1e-6) << left_out << " " << w;
      }
    }
  }
}

/// What the wearer does in a repetition has no part in its weights, whatever the noise.
TEST_F(PredictionFitTest, LearnsNothingFromAnotherNoiseOfTheSameMotion) {
  motion_ = "{kind: bursts, bursts: 4, cycles: 5, frequency_hz: 1}";
  const auto of_first = [this](const std::string& second) {
    const Study study = Prepare(
        "repetitions:\n  glove.motion.frequency_hz: [1, 1, 1.7]\n  glove.noise.variance_scale: " +
        second + "\n");
    EXPECT_EQ(MotionCount(study), 2);
    return WeightsOf(OfSeed(study, 3)).weights;
  };
  EXPECT_EQ(of_first("[1, 1, 1]"), of_first("[1, 2, 1]"));
  EXPECT_NE(of_first("[1, 1, 1]"), of_first("[1, 1, 2]"));
}

TEST_F(PredictionFitTest, IsWholeForTheRobot) {
  const Study study = Prepare(kThree);
  const auto whole =
      WeightsOf(ControllerForRobot(study, study.scenario.controllers[0].config)).weights;
  for (const int seed : {3, 4, 5}) EXPECT_NE(whole, WeightsOf(OfSeed(study, seed)).weights);
}

TEST_F(PredictionFitTest, RefusesWhatHasNoOtherMotion) {
  const std::string none =
      "controllers.fitted.prediction.kind: is fitted_to_others, which needs replicates with other "
      "motions; this scenario has one motion, or draws them";
  EXPECT_EQ(Complaint(""), none);
  EXPECT_EQ(Complaint(kThree), "");
  EXPECT_EQ(
      Complaint(kThree, "filter_at: event"),
      "controllers.fitted.prediction.kind: is fitted_to_others, which needs filter_at: sample");
}

}  // namespace
}  // namespace gauntlet::sim
