#include "sim/hand/grasp.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/base/error.h"
#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {
namespace {

/// Thumb and fingers up, the thumb opposed, fingers open: the posture in which an object is put
/// before the hand.
std::vector<double> OpenHand() {
  std::vector<double> angle(GloveChannels().size(), 0.0);
  angle[ChannelIndex("thumb_rotation")] = 72.0 * kRadPerDeg;
  angle[ChannelIndex("thumb_abduction")] = 60.0 * kRadPerDeg;
  angle[ChannelIndex("wrist_deviation")] = -20.0 * kRadPerDeg;
  angle[ChannelIndex("elbow_flexion")] = 28.0 * kRadPerDeg;
  angle[ChannelIndex("shoulder_flexion")] = 75.0 * kRadPerDeg;
  return angle;
}

std::vector<double> ClosedHand() {
  std::vector<double> angle = OpenHand();
  for (const char* finger : {"index", "middle", "ring", "little"}) {
    angle[ChannelIndex(std::string(finger) + "_mcp")] = 75.0 * kRadPerDeg;
    angle[ChannelIndex(std::string(finger) + "_pip")] = 80.0 * kRadPerDeg;
  }
  angle[ChannelIndex("thumb_abduction")] = 35.0 * kRadPerDeg;
  angle[ChannelIndex("thumb_mcp")] = 40.0 * kRadPerDeg;
  angle[ChannelIndex("thumb_ip")] = 40.0 * kRadPerDeg;
  return angle;
}

double Height_mm(const Hand& hand) {
  std::array<double, 7> pose;
  hand.ReadObjectPose(pose);
  return 1e3 * pose[2];
}

struct Grasp {
  double force_n = 0.0;    // at the end
  double height_mm = 0.0;  // above where the object stood
  double moved_mm = 0.0;   // up or down in the last 20 ms
  double ripple_n = 0.0;   // RMS of the grip force's change per command frame while holding
  double sunk_mm = 0.0;    // in the last second
};

/// Closes within 0.8 s, lifts by 20 deg at the elbow within 1 s, holds for some; commands tremble
/// by `noise_counts`.
Grasp CloseLiftHold(const HandConfig& config, int noise_counts, std::uint64_t seed,
                    int hold_frames = 50) {
  Hand hand(MakeModel(config));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  RandomStream random(seed, "tremble");
  hand.Reset(OpenHand());
  Grasp grasp;
  const double stood_mm = Height_mm(hand);
  double sum = 0.0;
  for (int frame = 0; frame < 110 + hold_frames; ++frame) {
    const double closed = std::clamp(frame / 40.0, 0.0, 1.0);
    const double lifted = std::clamp((frame - 60) / 50.0, 0.0, 1.0);
    std::vector<double> angle = OpenHand();
    for (std::size_t i = 0; i < angle.size(); ++i)
      angle[i] += closed * (ClosedHand()[i] - angle[i]);
    angle[ChannelIndex("elbow_flexion")] += lifted * 20.0 * kRadPerDeg;
    std::vector<std::int32_t> counts = CountsFor(map, angle);
    for (std::int32_t& count : counts) {
      count += static_cast<int>(random.Index(2 * noise_counts + 1)) - noise_counts;
    }
    hand.SetCommand(counts);
    StepTimes(hand, 20);
    const double force_before_n = std::exchange(grasp.force_n, hand.GripForce());
    const double before_mm = std::exchange(grasp.height_mm, Height_mm(hand) - stood_mm);
    grasp.moved_mm = grasp.height_mm - before_mm;
    if (frame == 59 + hold_frames) grasp.sunk_mm = grasp.height_mm;
    if (frame >= 120) sum += std::pow(grasp.force_n - force_before_n, 2);
  }
  EXPECT_TRUE(hand.health().ok) << hand.health().problem;
  grasp.ripple_n = std::sqrt(sum / 40.0);
  grasp.sunk_mm -= grasp.height_mm;
  return grasp;
}

HandConfig WithObject() {
  HandConfig config;
  config.contact = Contact::kObject;
  return config;
}

TEST(Grasp, LiftsABottleAndHoldsIt) {
  const Grasp grasp = CloseLiftHold(WithObject(), 0, 1);
  EXPECT_GT(grasp.height_mm, 60.0);
  EXPECT_GT(grasp.force_n, 10.0);
  EXPECT_NEAR(grasp.moved_mm, 0.0, 0.06);
}

// Contacts that creep let it sink by 0.3 mm/s; this is for four seconds.
TEST(Grasp, AHeldBottleDoesNotSink) {
  for (const double mass_kg : {0.3, 1.0}) {
    HandConfig config = WithObject();
    config.object.mass_kg = mass_kg;
    const Grasp grasp = CloseLiftHold(config, 0, 1, 200);
    EXPECT_GT(grasp.height_mm, 60.0) << mass_kg;
    EXPECT_NEAR(grasp.sunk_mm, 0.0, 0.25) << mass_kg;
  }
}

TEST(Grasp, ASlipperyHeavyObjectStaysBehind) {
  HandConfig config = WithObject();
  config.object.friction = 0.05;
  config.object.mass_kg = 3.0;
  EXPECT_LT(CloseLiftHold(config, 0, 1).height_mm, 40.0);
}

// What the paper's filter is for: trembling commands show as ripple of the grip force.
TEST(Grasp, TremblingCommandsRippleTheGripForce) {
  const double calm = CloseLiftHold(WithObject(), 0, 1).ripple_n;
  const double trembling = CloseLiftHold(WithObject(), 8, 1).ripple_n;
  EXPECT_GT(trembling, 1.4 * calm);  // 1.7 measured; 3 with a stiff arm
}

// An object that nobody holds stands still: the support carries its weight.
TEST(Grasp, TheObjectStandsOnItsSupport) {
  Hand hand(MakeModel(WithObject()));
  hand.Reset(OpenHand());
  const double stood_mm = Height_mm(hand);
  StepTimes(hand, 500);
  EXPECT_NEAR(Height_mm(hand), stood_mm, 0.5);
  EXPECT_EQ(hand.GripForce(), 0.0);
}

TEST(Grasp, WhatStandsIsCarriedByTheSupportWhatIsHeldByTheHand) {
  Hand hand(MakeModel(WithObject()));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const double weight_n = 0.3 * 9.81;
  hand.Reset(OpenHand());
  StepTimes(hand, 500);
  EXPECT_NEAR(hand.Forces().support_n, weight_n, 0.01 * weight_n);
  EXPECT_EQ(hand.Forces().carried_n, 0.0);
  std::vector<double> angle = ClosedHand();
  hand.SetCommand(CountsFor(map, angle));
  StepTimes(hand, 800);
  angle[ChannelIndex("elbow_flexion")] += 20.0 * kRadPerDeg;
  hand.SetCommand(CountsFor(map, angle));
  StepTimes(hand, 1500);
  EXPECT_EQ(hand.Forces().support_n, 0.0);
  EXPECT_NEAR(hand.Forces().carried_n, weight_n, 0.02 * weight_n);
  EXPECT_GT(hand.Forces().grip_n, weight_n);
}

TEST(Grasp, ThePoseInThePalmIsThatInTheWorld) {
  Hand hand(MakeModel(WithObject()));
  const GraspParts& grasp = hand.hand_model().grasp_in_physics();
  const auto in_palm = [&] {
    std::array<double, 7> pose;
    hand.ReadObjectInPalm(pose);
    return pose;
  };
  const auto in_world = [&](const std::array<double, 7>& pose) {
    const double* palm = hand.data().xquat + 4 * grasp.palm_body;
    std::array<double, 7> world;
    mju_rotVecQuat(world.data(), pose.data(), palm);
    mju_addTo3(world.data(), hand.data().xpos + 3 * grasp.palm_body);
    mju_mulQuat(world.data() + 3, palm, pose.data() + 3);
    return world;
  };
  std::vector<double> angle = OpenHand();
  for (const double elbow_deg : {28.0, 10.0}) {
    angle[ChannelIndex("elbow_flexion")] = elbow_deg * kRadPerDeg;
    hand.Reset(angle);
    const std::array<double, 7> pose = in_world(in_palm());
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(pose[i], hand.data().xpos[3 * grasp.object_body + i], 1e-12);
    }
    EXPECT_NEAR(std::abs(pose[3]), 1.0, 1e-12) << "upright";
  }
}

TEST(Grasp, WithoutAnObjectThereIsNoGrip) {
  Hand hand(MakeModel());
  StepTimes(hand, 10);
  EXPECT_EQ(hand.GripForce(), 0.0);
  double pose[7] = {-1, -1, -1, -1, -1, -1, -1};
  hand.ReadObjectPose(pose);
  hand.ReadObjectInPalm(pose);
  EXPECT_THAT(pose, ::testing::Each(-1.0));
  EXPECT_EQ(hand.Forces().support_n, 0.0);
}

TEST(Grasp, ADrawnObjectIsWhereItWas) {
  const auto model = MakeModel(WithObject());
  Hand hand(model);
  hand.Reset(OpenHand());
  double pose[7];
  hand.ReadObjectPose(pose);
  std::unique_ptr<mjData, void (*)(mjData*)> drawn(mj_makeData(&model->model()), &mj_deleteData);
  SetObjectPose(*model, pose, *drawn);
  SetPosture(*model, JointAngles(hand), std::vector<double>(model->drives().size()), *drawn);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(drawn->xpos[3 * model->grasp().object_body + axis], pose[axis]);
  }
}

// Thumb and index finger meet only if the hand can touch itself.
TEST(Grasp, FingersStopEachOtherOnlyWithContacts) {
  const auto closest = [](Contact contact) {
    HandConfig config;
    config.contact = contact;
    Hand hand(MakeModel(config));
    const controller::TendonTransmission& map = hand.hand_model().transmission();
    std::vector<double> angle = OpenHand();
    angle[ChannelIndex("thumb_rotation")] = 90.0 * kRadPerDeg;
    hand.Reset(angle);
    angle[ChannelIndex("thumb_abduction")] = 45.0 * kRadPerDeg;
    angle[ChannelIndex("index_mcp")] = 60.0 * kRadPerDeg;
    angle[ChannelIndex("index_pip")] = 40.0 * kRadPerDeg;
    hand.SetCommand(CountsFor(map, angle));
    int touching = 0;
    for (int i = 0; i < 800; ++i) {
      hand.Step();
      touching += hand.data().ncon;
    }
    EXPECT_TRUE(hand.health().ok) << hand.health().problem;
    return touching;
  };
  EXPECT_EQ(closest(Contact::kNone), 0);
  EXPECT_GT(closest(Contact::kHand), 0);
}

}  // namespace
}  // namespace gauntlet::sim::testing
