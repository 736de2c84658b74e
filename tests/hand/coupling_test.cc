#include <gmock/gmock.h>

#include <algorithm>

#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {
namespace {

/// Length of a cable beyond its drum in a posture [m].
double CableLength(const HandModel& hand, mjData& data, const std::vector<double>& angle_rad,
                   int tendon) {
  const std::vector<double> spools(hand.drives().size(), 0.0);
  SetPosture(hand, angle_rad, spools, data);
  return data.ten_length[tendon];
}

// What a spool must wind is what the flexor becomes shorter, over the whole range and not only at
// the reference: pulleys make moment arms constant.
TEST(Coupling, AgreesWithFiniteDifferencesOfCableLengths) {
  const auto hand = MakeModel();
  const controller::TendonTransmission& map = hand->transmission();
  const std::size_t count = map.channel_names.size();
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
        const double flexor = CableLength(*hand, *data, to, drive.flexor.tendon) -
                              CableLength(*hand, *data, from, drive.flexor.tendon);
        const double extensor = CableLength(*hand, *data, to, drive.extensor.tendon) -
                                CableLength(*hand, *data, from, drive.extensor.tendon);
        EXPECT_NEAR(flexor, -wound, 1e-6) << drive.name << " by " << map.channel_names[channel];
        EXPECT_NEAR(extensor, wound, 1e-6) << drive.name << " by " << map.channel_names[channel];
      }
    }
  }
}

TEST(Coupling, EveryPostureIsWithinTheCountsOfEveryMotor) {
  const controller::TendonTransmission map = MakeModel()->transmission();
  const std::size_t count = map.channel_names.size();
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
double Drag(const HandConfig& config, bool compensate) {
  Hand hand(MakeModel(config));
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
  EXPECT_GT(Drag({}, false), 45.0);
  EXPECT_LT(Drag({}, true), 2.0);
}

TEST(Coupling, WithoutInterferenceNothingIsDragged) {
  HandConfig config;
  config.cable.interference = false;
  EXPECT_LT(Drag(config, false), 2.0);
  const controller::TendonTransmission map = MakeModel(config)->transmission();
  const std::size_t count = map.channel_names.size();
  for (std::size_t i = 0; i < count * count; ++i) {
    if (i / count != i % count) {
      EXPECT_EQ(map.coupling[i], 0.0);
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
