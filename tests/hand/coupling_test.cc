#include <gmock/gmock.h>

#include <algorithm>

#include "tests/hand/hand_fixture.h"
#include "tests/hand/small_hand.h"

namespace gauntlet::sim::testing {
namespace {

/// Length of a cable beyond its drum in a posture [m].
double CableLength(const HandModel& hand, mjData& data, const std::vector<double>& angle_rad,
                   int tendon) {
  const std::vector<double> spools(hand.drives().size(), 0.0);
  SetPosture(hand, angle_rad, spools, data);
  return data.ten_length[tendon];
}

/// Two levers one behind the other. The cables of the far one run over an idler of 6 mm at the near
/// joint, then around a pulley of 8 mm; the near one has a pulley of 9 mm; drums have 10 mm.
constexpr const char* kTwoLevers = R"(
<mujoco>
  <compiler angle="degree"/>
  <worldbody>
    <geom name="near_pulley" type="cylinder" fromto="0 -.012 0 0 -.008 0" size=".009"/>
    <geom name="idler" type="cylinder" fromto="0 .008 0 0 .012 0" size=".006"/>
    <site name="below" pos="0 0 -.03"/> <site name="above" pos="0 0 .03"/>
    <site name="near_flexor_drum" pos="-.1 -.01 -.01"/> <site name="near_flexor_in" pos="-.02 -.01 .005"/>
    <site name="near_extensor_drum" pos="-.1 -.01 .01"/> <site name="near_extensor_in" pos="-.02 -.01 -.005"/>
    <site name="far_flexor_drum" pos="-.1 .01 -.01"/> <site name="far_flexor_in" pos="-.02 .01 .003"/>
    <site name="far_extensor_drum" pos="-.1 .01 .01"/> <site name="far_extensor_in" pos="-.02 .01 -.003"/>
    <body name="near_spool" pos="-.1 -.01 0">
      <joint name="near_spool" axis="0 1 0" armature="3e-4"/>
      <geom name="near_drum" type="cylinder" size=".01 .002" euler="90 0 0" mass=".001"/>
    </body>
    <body name="far_spool" pos="-.1 .01 0">
      <joint name="far_spool" axis="0 1 0" armature="3e-4"/>
      <geom name="far_drum" type="cylinder" size=".01 .002" euler="90 0 0" mass=".001"/>
    </body>
    <body name="near_lever">
      <joint name="near" axis="0 1 0" limited="true" range="-40 50" armature="1e-4" damping=".005"/>
      <geom type="capsule" fromto="0 0 0 .06 0 0" size=".004" mass=".02"/>
      <site name="near_flexor_out" pos=".02 -.01 .005"/> <site name="near_extensor_out" pos=".02 -.01 -.005"/>
      <site name="far_flexor_between" pos=".02 .01 .003"/> <site name="far_extensor_between" pos=".02 .01 -.003"/>
      <geom name="far_pulley" type="cylinder" fromto=".06 .008 0 .06 .012 0" size=".008"/>
      <site name="far_below" pos=".06 0 -.03"/> <site name="far_above" pos=".06 0 .03"/>
      <body name="far_lever" pos=".06 0 0">
        <joint name="far" axis="0 1 0" limited="true" range="-30 60" armature="1e-4" damping=".005"/>
        <geom type="capsule" fromto="0 0 0 .05 0 0" size=".004" mass=".02"/>
        <site name="far_flexor_out" pos=".02 .01 .004"/> <site name="far_extensor_out" pos=".02 .01 -.004"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <spatial name="near_flexor" stiffness="1e4" damping="5">
      <site site="near_flexor_drum"/><site site="near_flexor_in"/>
      <geom geom="near_pulley" sidesite="below"/><site site="near_flexor_out"/>
    </spatial>
    <spatial name="near_extensor" stiffness="1e4" damping="5">
      <site site="near_extensor_drum"/><site site="near_extensor_in"/>
      <geom geom="near_pulley" sidesite="above"/><site site="near_extensor_out"/>
    </spatial>
    <spatial name="far_flexor" stiffness="1e4" damping="5">
      <site site="far_flexor_drum"/><site site="far_flexor_in"/>
      <geom geom="idler" sidesite="below"/><site site="far_flexor_between"/>
      <geom geom="far_pulley" sidesite="far_below"/><site site="far_flexor_out"/>
    </spatial>
    <spatial name="far_extensor" stiffness="1e4" damping="5">
      <site site="far_extensor_drum"/><site site="far_extensor_in"/>
      <geom geom="idler" sidesite="above"/><site site="far_extensor_between"/>
      <geom geom="far_pulley" sidesite="far_above"/><site site="far_extensor_out"/>
    </spatial>
  </tendon>
  <actuator>
    <motor name="near" joint="near_spool" ctrllimited="true" ctrlrange="-.45 .45"/>
    <motor name="far" joint="far_spool" ctrllimited="true" ctrlrange="-.45 .45"/>
  </actuator>
</mujoco>)";

TEST(Coupling, OfTwoLeversIsTheRatiosOfPulleysAndDrums) {
  const auto hand = MakeFromText(kTwoLevers, {});
  const controller::TendonTransmission& map = hand->transmission();
  EXPECT_NEAR(map.coupling[0], 0.9, 1e-6);  // near spool by near joint
  EXPECT_NEAR(map.coupling[1], 0.0, 1e-6);
  EXPECT_NEAR(map.coupling[2], 0.6, 1e-6);
  EXPECT_NEAR(map.coupling[3], 0.8, 1e-6);

  std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&hand->model()), &mj_deleteData);
  constexpr double kTurn = 0.01;
  for (std::size_t motor = 0; motor < 2; ++motor) {
    const Drive& drive = hand->drives()[motor];
    for (std::size_t channel = 0; channel < 2; ++channel) {
      std::vector<double> up(2, 0.0), down(2, 0.0);
      up[channel] = kTurn;
      down[channel] = -kTurn;
      const double shorter = CableLength(*hand, *data, down, drive.cables[0].tendon) -
                             CableLength(*hand, *data, up, drive.cables[0].tendon);
      EXPECT_NEAR(map.coupling[2 * motor + channel], shorter / (2 * kTurn * drive.drum_radius_m),
                  1e-6)
          << drive.name << " by " << map.joint_names[channel];
    }
  }
}

// What a spool must wind is what the flexor becomes shorter, over the whole range and not only at
// the reference: pulleys make moment arms constant.
TEST(Coupling, AgreesWithFiniteDifferencesOfCableLengths) {
  const auto hand = MakeModel();
  const controller::TendonTransmission& map = hand->transmission();
  const std::size_t count = map.joint_names.size();
  std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&hand->model()), &mj_deleteData);
  RandomStream random(3, "postures");
  for (int trial = 0; trial < 5; ++trial) {
    const std::vector<double> from = RandomPosture(map, random);
    for (std::size_t channel = 0; channel < count; ++channel) {
      std::vector<double> to = from;
      to[channel] = random.Uniform(map.joint_min_rad[channel], map.joint_max_rad[channel]);
      for (std::size_t motor = 0; motor < count; ++motor) {
        const Drive& drive = hand->drives()[motor];
        const double wound = drive.drum_radius_m * map.coupling[motor * count + channel] *
                             (to[channel] - from[channel]);
        const double flexor = CableLength(*hand, *data, to, drive.cables[0].tendon) -
                              CableLength(*hand, *data, from, drive.cables[0].tendon);
        const double extensor = CableLength(*hand, *data, to, drive.cables[1].tendon) -
                                CableLength(*hand, *data, from, drive.cables[1].tendon);
        EXPECT_NEAR(flexor, -wound, 1e-6) << drive.name << " by " << map.joint_names[channel];
        EXPECT_NEAR(extensor, wound, 1e-6) << drive.name << " by " << map.joint_names[channel];
      }
    }
  }
}

TEST(Coupling, EveryPostureIsWithinTheCountsOfEveryMotor) {
  const controller::TendonTransmission map = MakeModel()->transmission();
  const std::size_t count = map.joint_names.size();
  for (std::size_t motor = 0; motor < count; ++motor) {
    for (double sign : {-1.0, 1.0}) {  // the posture that winds this spool farthest
      std::vector<double> angle(count);
      for (std::size_t channel = 0; channel < count; ++channel) {
        angle[channel] = sign * map.coupling[motor * count + channel] >= 0
                             ? map.joint_max_rad[channel]
                             : map.joint_min_rad[channel];
      }
      const std::int32_t counts = CountsFor(map, angle)[motor];
      EXPECT_GE(counts, map.min_counts[motor]) << map.motor_names[motor];
      EXPECT_LE(counts, map.max_counts[motor]) << map.motor_names[motor];
    }
  }
}

/// How far other joints of the index finger move when its knuckle is bent by 60 deg [deg].
double Drag(bool compensate) {
  Hand hand(MakeModel(HandConfig()));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const int knuckle = ChannelIndex("index_mcp");
  const int finger = ChannelIndex("index_pip");
  std::vector<double> angle = map.reference_angle_rad;
  hand.Reset(angle);
  angle[knuckle] += 60.0 * kRadPerDeg;
  hand.SetCommand(CountsFor(map, angle, compensate));
  StepTimes(hand, 800);
  return std::abs(JointAngles(hand)[finger] - angle[finger]) * kDegPerRad;
}

// Interference drive: 60 deg at the knuckle wind 60 * 7 / 7 = 60 deg at the middle joint, which is
// stopped by its range after 50 deg.
TEST(Coupling, FingersDragEachOtherUnlessItIsUndone) {
  EXPECT_GT(Drag(false), 45.0);
  EXPECT_LT(Drag(true), 2.0);
}

}  // namespace
}  // namespace gauntlet::sim::testing
