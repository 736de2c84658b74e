// What the ready scenarios ask of the motors.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study.h"
#include "sim/trial/joint_angles.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

/// The largest speed of a motor that follows the wearer, from one command frame to the next, over
/// its no-load speed: coupling x (joint angles now - joint angles a frame ago).
double LargestSpeedShare(const Study& study) {
  const controller::TendonTransmission& hand = study.hand->transmission();
  const Signal joints = JointAngles(study.joint_map(), study.gloves.front()->true_angle_rad);
  const double frame_s = 1e-3 * study.scenario.event.period_ms;
  const auto frame = static_cast<Eigen::Index>(study.gloves.front()->tick_rate_hz * frame_s);
  const Eigen::Index rows = joints.rows() - frame;
  const Signal moved = joints.bottomRows(rows) - joints.topRows(rows);
  double largest_share = 0.0;
  for (const int motor : study.measured_motors) {
    const Eigen::Map<const Eigen::VectorXd> coupling(&hand.coupling[motor * joints.cols()],
                                                     joints.cols());
    const double fastest_rad = (moved.matrix() * coupling).cwiseAbs().maxCoeff();
    const Servo& servo = study.hand->drives()[static_cast<std::size_t>(motor)].servo;
    largest_share = std::max(largest_share, fastest_rad / frame_s / servo.no_load_speed_rad_s);
  }
  return largest_share;
}

// Where a motor gives all it has no filter makes a difference. The scenarios that ask for more say
// so in their question or comment.
TEST(ReadyScenarios, AskNoMotorForMoreThanItsNoLoadSpeedUnlessTheySaySo) {
  const std::map<std::string, std::string> beyond = {{"door_opening", "recorded"},
                                                     {"door_targets", "recorded"},
                                                     {"grasp_hook", "for a moment"},
                                                     {"steps", "jumps"}};
  int within = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(SourceDir()) + "/scenarios")) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string name = entry.path().stem();
    const double share = LargestSpeedShare(PrepareStudy(LoadScenario(entry.path(), {})));
    if (beyond.contains(name)) {
      EXPECT_GT(share, 1.0) << name << " need not be an exception";
    } else {
      EXPECT_LT(share, 1.0) << name;
      ++within;
    }
  }
  EXPECT_GT(within, 20);
}

}  // namespace
}  // namespace gauntlet::sim
