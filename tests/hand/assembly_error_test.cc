#include "sim/hand/assembly_error.h"

#include <gmock/gmock.h>

#include <cmath>

#include "sim/base/error.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"
#include "tests/support/gram_schmidt.h"

namespace gauntlet::sim::testing {
namespace {

using ::testing::HasSubstr;

/// Weightless and without friction, so that a joint stands where its cables say.
SmallHand Weightless(const AssemblyErrorConfig& error = {}) {
  SmallHand small{.gravity_m_s2 = 0.0, .config = FrictionFree()};
  small.config.assembly_error = error;
  return small;
}

/// Where the joint stands when it is told to be at this angle.
double AngleAt(const SmallHand& small, double told_deg) {
  const auto model = small.Make();
  Hand hand(model);
  Hold(hand, JointCommand(*model, told_deg * kRadPerDeg), 3000);  // until it swings no more
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  return Read(hand).joint_rad * kDegPerRad;
}

TEST(AssemblyError, ALargerDrumMovesTheJointAsMuchFurther) {
  for (const int seed : {1, 2, 3}) {
    const SmallHand small = Weightless({.seed = seed, .drum_radius_percent = 5.0});
    const double ratio = small.Make()->drives()[0].drum_radius_m / small.drum_radius_m;
    EXPECT_GT(std::abs(ratio - 1.0), 0.003) << seed;
    for (const double told_deg : {-30.0, 10.0, 30.0}) {
      EXPECT_NEAR(AngleAt(small, told_deg), ratio * told_deg, 0.05) << seed;
    }
  }
}

TEST(AssemblyError, ALargerMomentArmMovesTheJointAsMuchLess) {
  for (const int seed : {1, 2, 3}) {
    const SmallHand small = Weightless({.seed = seed, .moment_arm_percent = 5.0});
    const auto model = small.Make();
    const double arm_m = std::abs(model->drives()[0].cables[0].crossings[0].moment_arm_m);
    EXPECT_GT(std::abs(arm_m / SmallHand::kPulleyM - 1.0), 0.003) << seed;
    for (const double told_deg : {-30.0, 10.0, 30.0}) {
      EXPECT_NEAR(AngleAt(small, told_deg), told_deg * SmallHand::kPulleyM / arm_m, 0.05) << seed;
    }
  }
}

TEST(AssemblyError, AJointThatIsOffItsMiddleIsOffEverywhereByTheSame) {
  const SmallHand small = Weightless({.seed = 2, .centre_deg = 2.0});
  const double off_deg = small.Make()->center_error_rad()[0] * kDegPerRad;
  EXPECT_GT(std::abs(off_deg), 0.2);
  for (const double told_deg : {-30.0, 0.0, 30.0}) {
    EXPECT_NEAR(AngleAt(small, told_deg), told_deg + off_deg, 0.05);
  }
}

HandConfig WithErrors(const AssemblyErrorConfig& error) {
  HandConfig config = FrictionFree();
  config.assembly_error = error;
  return config;
}

/// All joints after half a second of a command.
Eigen::VectorXd AnglesAt(const std::shared_ptr<const HandModel>& model,
                         const std::vector<std::int32_t>& counts) {
  Hand hand(model);
  hand.SetCommand(counts);
  StepTimes(hand, 1500);
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  const std::vector<double> angle = JointAngles(hand);
  return Eigen::Map<const Eigen::VectorXd>(angle.data(), std::ssize(angle));
}

// C q = s with the coupling as built: cables that pass other joints carry their errors along.
TEST(AssemblyError, OfTheWholeHandIsThatOfItsCoupling) {
  const auto drawn = MakeModel(FrictionFree());
  const auto built = MakeModel(WithErrors(
      {.seed = 5, .drum_radius_percent = 2.0, .moment_arm_percent = 2.0, .centre_deg = 1.0}));
  const controller::TendonTransmission& map = drawn->transmission();
  EXPECT_EQ(built->transmission().coupling, map.coupling);
  EXPECT_EQ(built->transmission().reference_angle_rad, map.reference_angle_rad);
  const std::vector<double> told = HomePosture(map);
  const std::vector<std::int32_t> counts = CountsFor(map, told);

  const int count = static_cast<int>(told.size());
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const Square> drawn_coupling(map.coupling.data(), count, count);
  const Eigen::Map<const Square> built_coupling(built->as_built().coupling.data(), count, count);
  Eigen::VectorXd from_middle(count);
  for (int i = 0; i < count; ++i) from_middle[i] = told[i] - map.reference_angle_rad[i];
  const Eigen::VectorXd expected =
      test::SolveByGramSchmidt<Eigen::MatrixXd>(built_coupling, drawn_coupling * from_middle)
          .value() -
      from_middle + Eigen::Map<const Eigen::VectorXd>(built->center_error_rad().data(), count);
  const Eigen::VectorXd difference = AnglesAt(built, counts) - AnglesAt(drawn, counts);
  for (int i = 0; i < count; ++i) {
    EXPECT_NEAR(difference[i] * kDegPerRad, expected[i] * kDegPerRad, 0.2) << map.joint_names[i];
  }
  EXPECT_GT(expected.norm() * kDegPerRad, 3.0);
}

TEST(AssemblyError, HasTheDeviationThatItIsSaidToHave) {
  const auto drawn = MakeModel();
  double drums = 0.0;
  double centers = 0.0;
  constexpr int kHands = 8;
  for (int seed = 1; seed <= kHands; ++seed) {
    const auto built =
        MakeModel(WithErrors({.seed = seed, .drum_radius_percent = 5.0, .centre_deg = 2.0}));
    for (std::size_t i = 0; i < drawn->drives().size(); ++i) {
      drums +=
          std::pow(built->drives()[i].drum_radius_m / drawn->drives()[i].drum_radius_m - 1.0, 2);
      centers += std::pow(built->center_error_rad()[i] * kDegPerRad, 2);
    }
  }
  const double count = kHands * static_cast<double>(drawn->drives().size());
  EXPECT_NEAR(std::sqrt(drums / count), 0.05, 0.01);
  EXPECT_NEAR(std::sqrt(centers / count), 2.0, 0.4);
}

TEST(AssemblyError, LeavesAHandAtRestInThePostureInWhichItBegins) {
  const auto built = MakeModel(
      WithErrors({.drum_radius_percent = 5.0, .moment_arm_percent = 5.0, .centre_deg = 2.0}));
  const std::vector<double> posture = HomePosture(built->transmission());
  Hand hand(built);
  hand.Reset(posture);
  StepTimes(hand, 500);
  const std::vector<double> angle = JointAngles(hand);
  for (std::size_t i = 0; i < angle.size(); ++i) {
    EXPECT_NEAR(angle[i] * kDegPerRad, posture[i] * kDegPerRad, 0.6) << built->joint_names()[i];
  }
}

TEST(AssemblyError, ThatNoWorkshopMakesIsRefused) {
  EXPECT_THROW(MakeModel(WithErrors({.drum_radius_percent = 10.1})), controller::SettingError);
  EXPECT_THROW(MakeModel(WithErrors({.moment_arm_percent = -1.0})), controller::SettingError);
  EXPECT_THROW(MakeModel(WithErrors({.centre_deg = 11.0})), controller::SettingError);
}

}  // namespace
}  // namespace gauntlet::sim::testing
