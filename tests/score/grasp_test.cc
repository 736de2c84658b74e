#include "sim/score/grasp.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/score/signals.h"

namespace gauntlet::sim {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kTicks = 4000;
constexpr int kLift = 1000;
constexpr double kWeightN = 3.0;

/// An object that stands for a second, upright, and is held from then on.
struct Example {
  std::vector<double> grip_n = std::vector<double>(kTicks, 12.0);
  std::vector<double> carried_n = std::vector<double>(kTicks, 0.0);
  std::vector<double> support_n = std::vector<double>(kTicks, kWeightN);
  Signal pose = Signal::Zero(kTicks, 7);
  Signal in_palm = Signal::Zero(kTicks, 7);

  Example() {
    for (int n = 0; n < kTicks; ++n) {
      if (n < kLift / 2) grip_n[n] = 0.0;
      if (n >= kLift) support_n[n] = 0.0;
      if (n >= kLift) carried_n[n] = kWeightN;
      Put(n, pose, Vector3d(0.4, 0.0, 1.0), Quaterniond::Identity());
      Put(n, in_palm, Vector3d(0.07, 0.0, -0.03), Turned(90.0, Vector3d::UnitX()));
    }
  }
  static Quaterniond Turned(double angle_deg, const Vector3d& axis) {
    return Quaterniond(AngleAxisd(angle_deg * kRadPerDeg, axis.normalized()));
  }
  static void Put(int tick, Signal& signal, const Vector3d& place_m, const Quaterniond& attitude) {
    signal.row(tick) << place_m.transpose(), attitude.w(), attitude.vec().transpose();
  }
  GraspSignals Signals() const {
    return {.rate_hz = 1000.0,
            .grip_force_n = grip_n,
            .carried_force_n = carried_n,
            .support_force_n = support_n,
            .pose = &pose,
            .pose_in_palm = &in_palm,
            .friction = 0.8};
  }
  double Slip_mm() const { return 1e3 * ObjectSlip(Signals(), All(grip_n)); }
  double Tilt_deg() const { return kDegPerRad * ObjectTilt(Signals(), All(grip_n)); }
  double Ratio() const { return GripForceRatio(Signals(), All(grip_n)); }
  double Lost() const { return LostContactShare(Signals(), All(grip_n)); }
};

TEST(Grasp, IsHeldFromLiftingUntilTheSupportCarriesTheObjectAgain) {
  Example example;
  std::fill(example.support_n.begin() + 3000, example.support_n.end(), kWeightN);
  const std::vector<TickRange> held = HeldRanges(example.Signals());
  ASSERT_EQ(held.size(), 1u);
  EXPECT_EQ(held[0].begin, kLift);
  EXPECT_EQ(held[0].end, 3000);
}

TEST(Grasp, IsNotHeldForLessThanATenthOfASecondOrWithoutATouch) {
  Example example;
  std::fill(example.support_n.begin() + kLift + 99, example.support_n.end(), kWeightN);
  EXPECT_TRUE(HeldRanges(example.Signals()).empty());
  std::fill(example.support_n.begin() + kLift + 99, example.support_n.begin() + kLift + 100, 0.0);
  EXPECT_EQ(HeldRanges(example.Signals()).size(), 1u);
  std::fill(example.grip_n.begin(), example.grip_n.end(), 0.09);  // it fell off
  EXPECT_TRUE(HeldRanges(example.Signals()).empty());
  EXPECT_TRUE(std::isnan(example.Slip_mm()));
  EXPECT_TRUE(std::isnan(example.Ratio()));
  EXPECT_TRUE(std::isnan(example.Lost()));
}

TEST(ObjectSlip, IsTheLargestShiftInThePalmSinceTheLift) {
  Example example;
  EXPECT_EQ(example.Slip_mm(), 0.0);
  example.in_palm(kLift - 1, 0) += 0.05;  // before it is held
  example.pose.col(2).array() += 0.1;     // carried along
  EXPECT_EQ(example.Slip_mm(), 0.0);
  example.in_palm.block(2000, 0, 500, 3).rowwise() += Eigen::RowVector3d(0.003, 0.0, 0.004);
  EXPECT_NEAR(example.Slip_mm(), 5.0, 1e-9);
}

TEST(ObjectSlip, EndsWhereTheHandTouchesItNoMore) {
  Example example;
  for (int n = kLift; n < kTicks; ++n) example.in_palm(n, 1) -= 1e-5 * (n - kLift);  // 10 mm/s
  std::fill(example.grip_n.begin() + 2001, example.grip_n.end(), 0.0);
  EXPECT_NEAR(example.Slip_mm(), 10.0, 1e-9);
  EXPECT_NEAR(example.Lost(), 1999.0 / 3000.0, 1e-12);
}

TEST(Grasp, OfAFallingObjectIsLostToTheEnd) {
  Example example;
  EXPECT_EQ(FallTick(example.Signals()), kTicks);
  EXPECT_EQ(ObjectDropped(example.Signals()), 0.0);
  // It leaves the hand, touches the edge of the support on its way, and falls.
  std::fill(example.grip_n.begin() + 2000, example.grip_n.end(), 0.0);
  std::fill_n(example.support_n.begin() + 2050, 10, 5.0);
  for (int n = 2060; n < kTicks; ++n) {
    Example::Put(n, example.pose, Vector3d(0.4, 0.0, -5.0),
                 Example::Turned(170.0, {1.0, 0.0, 0.0}));
  }
  EXPECT_EQ(FallTick(example.Signals()), 2060);
  EXPECT_EQ(ObjectDropped(example.Signals()), 1.0);
  EXPECT_NEAR(example.Lost(), (50.0 + kTicks - 2060) / (1050.0 + kTicks - 2060), 1e-12);
  EXPECT_NEAR(example.Tilt_deg(), 0.0, 1e-9) << "of the hold, not of the fall";
  // Held again before 0.1 s are over: not dropped.
  std::fill(example.grip_n.begin() + 2159, example.grip_n.end(), 12.0);
  EXPECT_EQ(ObjectDropped(example.Signals()), 0.0);
  // It stands where the hand lets it go.
  Example put_down;
  std::fill(put_down.support_n.begin() + 2000, put_down.support_n.end(), kWeightN);
  std::fill(put_down.grip_n.begin() + 2000, put_down.grip_n.end(), 0.0);
  EXPECT_EQ(ObjectDropped(put_down.Signals()), 0.0);
  EXPECT_EQ(put_down.Lost(), 0.0);
}

TEST(ObjectTilt, IsTheAngleToTheVerticalUntilTheLift) {
  Example example;
  EXPECT_NEAR(example.Tilt_deg(), 0.0, 1e-9);
  const Vector3d place(0.4, 0.0, 1.0);
  Example::Put(700, example.pose, place, Example::Turned(130.0, Vector3d::UnitZ()));
  EXPECT_NEAR(example.Tilt_deg(), 0.0, 1e-9) << "turned about its own axis";
  Example::Put(800, example.pose, place,
               Example::Turned(35.0, {1.0, 2.0, 0.0}) * Example::Turned(50.0, Vector3d::UnitZ()));
  EXPECT_NEAR(example.Tilt_deg(), 35.0, 1e-9);
  Example::Put(2000, example.pose, place, Example::Turned(60.0, Vector3d::UnitX()));
  EXPECT_NEAR(example.Tilt_deg(), 35.0, 1e-9) << "lifted with the palm";
}

TEST(ObjectTilt, IsTheAngleInThePalmWhileItIsHeld) {
  Example example;
  const Vector3d place(0.07, 0.0, -0.03);
  const Quaterniond lifted = Example::Turned(90.0, Vector3d::UnitX());
  Example::Put(2000, example.in_palm, place, lifted * Example::Turned(20.0, Vector3d::UnitY()));
  EXPECT_NEAR(example.Tilt_deg(), 20.0, 1e-9);
  Example::Put(2000, example.in_palm, place, lifted * Example::Turned(20.0, Vector3d::UnitZ()));
  EXPECT_NEAR(example.Tilt_deg(), 0.0, 1e-9) << "turned about its own axis";
}

// Two fingers press with N each on both sides of a thing of weight W: it slips at 2 mu N = W.
TEST(GripForceRatio, OfAPinchIsThatOfItsFrictionCones) {
  Example example;
  const double normal_n = 6.0;
  std::fill(example.grip_n.begin(), example.grip_n.end(), 2.0 * normal_n);
  EXPECT_NEAR(example.Ratio(), 2.0 * 0.8 * normal_n / kWeightN, 1e-12);
  std::fill(example.grip_n.begin() + 3000, example.grip_n.end(), kWeightN / 0.8);
  EXPECT_NEAR(example.Ratio(), 1.0, 1e-12) << "the verge of slipping";
}

TEST(GripForceRatio, IsThatOfTheLeastMeanOver20Milliseconds) {
  Example example;
  std::fill_n(example.grip_n.begin() + 2000, 20, 6.0);
  EXPECT_NEAR(example.Ratio(), 0.8 * 6.0 / kWeightN, 1e-12);
  std::fill_n(example.grip_n.begin() + 2000, 20, 12.0);
  example.grip_n[2000] = 0.0;  // one tick of chatter
  EXPECT_NEAR(example.Ratio(), 0.8 * 12.0 * 19.0 / 20.0 / kWeightN, 1e-12);
  example.carried_n[100] = 1e6;  // not held then
  EXPECT_NEAR(example.Ratio(), 0.8 * 12.0 * 19.0 / 20.0 / kWeightN, 1e-12);
}

TEST(GraspScores, DoNotLookAtTicksThatDoNotCount) {
  Example example;
  example.in_palm(2000, 0) += 0.01;
  example.grip_n[2500] = 0.0;
  Example::Put(800, example.pose, Vector3d(0.4, 0.0, 1.0), Example::Turned(9.0, {1, 0, 0}));
  const CountedTicks counted = {{0, 800}, {801, 2000}, {2001, 2500}, {2501, kTicks}};
  EXPECT_EQ(ObjectSlip(example.Signals(), counted), 0.0);
  EXPECT_NEAR(ObjectTilt(example.Signals(), counted), 0.0, 1e-9);
  EXPECT_EQ(LostContactShare(example.Signals(), counted), 0.0);
  EXPECT_NEAR(example.Slip_mm(), 10.0, 1e-9);
}

}  // namespace
}  // namespace gauntlet::sim
