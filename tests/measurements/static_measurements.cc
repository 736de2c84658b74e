#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>

#include "sim/base/data_folder.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/opposition.h"
#include "tests/hand/slow_motion.h"
#include "tests/measurements/hand_measurements.h"
#include "tests/video/hand_picture.h"

namespace gauntlet::sim::testing {
namespace {

/// Crossing of the first cable of a motor with the joint of the motor's name.
const Crossing& OwnCrossing(const mjModel& model, const Drive& drive) {
  const int dof = model.jnt_dofadr[mj_name2id(&model, mjOBJ_JOINT, drive.name.c_str())];
  return *std::ranges::find(drive.cables[0].crossings, dof, &Crossing::dof);
}

/// Error of the moved channel after 1.2 s at a goal, all others in the home posture [deg].
double SettledError(Hand& hand, std::size_t channel, double start_rad, double goal_rad) {
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  std::vector<double> angle = HomePosture(map);
  angle[channel] = start_rad;
  hand.Reset(angle);
  angle[channel] = goal_rad;
  hand.SetCommand(CountsFor(map, angle));
  StepTimes(hand, 1200);
  return (JointAngles(hand)[channel] - goal_rad) * kDegPerRad;
}

/// Index finger told to creep to and fro; writes commanded and reached angle [deg] to a file and
/// gives the widest gap between the ways up and down, between 30 and 70 deg [deg].
double Hysteresis(const HandConfig& config, const std::string& joint,
                  const std::filesystem::path& file) {
  Hand hand(MakeModel(config));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const int channel = ChannelIndex(joint);
  std::vector<double> angle = map.reference_angle_rad;
  hand.Reset(angle);
  std::ofstream out(file);
  out << "command_deg,joint_deg\n";
  std::vector<double> up(121), down(121);
  for (int frame = 0; frame < 3 * 240; ++frame) {  // 20 to 80 deg and back in 4.8 s, three times
    const int place = frame % 240;
    const double deg = 20.0 + (place < 120 ? place : 240 - place) * 0.5;
    angle[channel] = deg * kRadPerDeg;
    hand.SetCommand(CountsFor(map, angle));
    StepTimes(hand, 20);
    const double reached = JointAngles(hand)[channel] * kDegPerRad;
    if (frame < 240) continue;
    out << fmt::format("{:.3f},{:.3f}\n", deg, reached);
    (place < 120 ? up : down)[static_cast<std::size_t>(2.0 * (deg - 20.0))] = reached;
  }
  double widest = 0.0;
  for (std::size_t i = 20; i <= 100; ++i) widest = std::max(widest, down[i] - up[i]);
  return widest;
}

}  // namespace

void PrintJoints() {
  const auto hand = MakeModel();
  const controller::TendonTransmission& map = hand->transmission();
  fmt::print(
      "| channel, joint and motor | range [deg] | moment arm [mm] | drum [mm] "
      "| stall torque [N m] | pull at stall [N] | cable stiffness [N/mm] | bends [deg] |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (std::size_t motor = 0; motor < map.motor_names.size(); ++motor) {
    const Drive& drive = hand->drives()[motor];
    fmt::print(
        "| `{}` | {:.0f} .. {:.0f} | {:.1f} | {:.0f} | {:.2f} | {:.0f} | {:.0f} | {:.0f} |\n",
        drive.name, map.joint_min_rad[motor] * kDegPerRad, map.joint_max_rad[motor] * kDegPerRad,
        1e3 * std::abs(OwnCrossing(hand->model(), drive).moment_arm_m), 1e3 * drive.drum_radius_m,
        drive.servo.stall_torque_nm, drive.servo.stall_torque_nm / drive.drum_radius_m,
        1e-3 * drive.cables[0].cord.stiffness_n_m,
        drive.cables[0].branches[0].bend_rad * kDegPerRad);
  }
  const mjModel& model = hand->model();
  for (const char* body : {"palm", "forearm", "upper_arm"}) {
    fmt::print("{} and all that hangs on it: {:.2f} kg\n", body,
               model.body_subtreemass[mj_name2id(&model, mjOBJ_BODY, body)]);
  }
}

void PrintCoupling() {
  const auto hand = MakeModel();
  const controller::TendonTransmission& map = hand->transmission();
  const std::size_t count = map.joint_names.size();
  fmt::print("{:>19}", "");
  for (std::size_t channel = 1; channel <= count; ++channel) fmt::print(" {:>4}", channel);
  for (std::size_t motor = 0; motor < count; ++motor) {
    fmt::print("\n{:>2} {:<16}", motor + 1, map.motor_names[motor]);
    for (std::size_t channel = 0; channel < count; ++channel) {
      const double value = map.coupling[motor * count + channel];
      fmt::print(" {:>4}", std::abs(value) < 1e-6 ? "." : fmt::format("{:.2f}", value));
    }
  }
  fmt::print("\n");
}

void PrintOpposition() {
  Hand hand(MakeModel());
  fmt::print(
      "| Kapandji | meets | gap [mm] | facing [deg] | rotation, abduction, MCP, IP | spread, MCP, "
      "PIP of the finger |\n|---|---|---|---|---|---|\n");
  for (const Opposition& posture : kOppositions) {
    const Meeting meeting = Meet(hand, posture);
    fmt::print("| {} | {} | {:.1f} | {:.0f} | {} | {} |\n", posture.kapandji,
               *posture.body == '\0' ? std::string("pad of the ") + posture.finger + " finger"
                                     : std::string("side of ") + posture.body,
               meeting.gap_mm, meeting.facing_deg, fmt::join(posture.thumb_deg, ", "),
               fmt::join(posture.finger_deg, ", "));
  }
}

void PrintFriction() {
  fmt::print(
      "| servo | coefficient | neighbours | arrives of 5 deg to and fro | of 12.5 | loop [deg] |\n"
      "|---|---|---|---|---|---|\n");
  for (const char* kind : {"dynamixel", "dynamixel_stiff", "leap", "orca", "standard"}) {
    for (const double coefficient : {0.02, 0.04, 0.08}) {
      if (coefficient != 0.04 && std::string_view(kind) != "dynamixel_stiff") continue;
      for (const bool moving : {false, true}) {
        HandConfig config;
        config.servo.settings =
            std::ranges::find(ServoKinds(), kind, &ServoKind::name)->defaults.settings;
        config.cable.capstan_friction = coefficient;
        const SlowMotion small = MoveSlowly(config, 5.0, moving);
        const SlowMotion middle = MoveSlowly(config, 12.5, moving);
        const SlowMotion large = MoveSlowly(config, 30.0, moving);
        fmt::print("| `{}` | {} | {} | {:.0f} % | {:.0f} % | {:.1f} |\n", kind, coefficient,
                   moving ? "moving" : "at rest", 100.0 * small.share, 100.0 * middle.share,
                   large.loop_deg);
      }
    }
  }
}

void PrintReach() {
  Hand free(MakeModel(FrictionFree()));
  Hand real(MakeModel());
  const controller::TendonTransmission& map = free.hand_model().transmission();
  fmt::print(
      "Largest error at 11 angles over the whole range, reached from both ends.\n"
      "| channel | without friction [deg] | with friction [deg] |\n|---|---|---|\n");
  for (std::size_t channel = 0; channel < map.joint_names.size(); ++channel) {
    const double least = map.joint_min_rad[channel];
    const double most = map.joint_max_rad[channel];
    double worst[2] = {};
    for (int place = 0; place <= 10; ++place) {
      const double goal = least + 0.1 * place * (most - least);
      for (double start : {least, most}) {
        worst[0] = std::max(worst[0], std::abs(SettledError(free, channel, start, goal)));
        worst[1] = std::max(worst[1], std::abs(SettledError(real, channel, start, goal)));
      }
    }
    fmt::print("| {} | {:.2f} | {:.2f} |\n", map.joint_names[channel], worst[0], worst[1]);
  }
}

void WriteHysteresis(const std::filesystem::path& folder) {
  HandConfig slack;
  slack.cable.pretension_mm = 0.0;
  slack.cable.slack_mm = {0.2};
  HandConfig backlash;
  backlash.cable.backlash_deg = 3.0;
  const std::pair<const char*, HandConfig> hands[] = {
      {"default", {}}, {"friction_free", FrictionFree()}, {"slack", slack}, {"backlash", backlash}};
  for (const char* joint : {"index_mcp", "index_pip"}) {
    for (const auto& [name, config] : hands) {
      const std::filesystem::path file = folder / fmt::format("hysteresis_{}_{}.csv", joint, name);
      fmt::print("{} {}: {:.2f} deg wide\n", joint, name, Hysteresis(config, joint, file));
    }
  }
}

void WritePictures(const std::filesystem::path& folder) {
  const auto hand = MakeModel();
  std::vector<double> angle(GloveChannels().size());
  const std::pair<const char*, double> posture[] = {
      {"thumb_rotation", 35}, {"thumb_abduction", 55}, {"thumb_mcp", 12},  {"thumb_ip", 15},
      {"index_mcp", 15},      {"index_pip", 20},       {"middle_mcp", 25}, {"middle_pip", 30},
      {"ring_mcp", 35},       {"ring_pip", 40},        {"little_mcp", 45}, {"little_pip", 50},
      {"finger_spread", 8},   {"elbow_flexion", 90}};
  for (const auto& [name, deg] : posture) angle[ChannelIndex(name)] = deg * kRadPerDeg;
  const std::vector<double> spools(angle.size());
  WriteHandPng(*hand, angle, spools, {.camera = "portrait", .width_px = 840, .height_px = 960},
               folder / "hand.png");
  WriteHandPng(*hand, angle, spools, {.camera = "arm_portrait", .width_px = 1080, .height_px = 840},
               folder / "arm.png");
  HandConfig five_motors;
  five_motors.model_path = DataFolder("models") / "five_motor_hand.xml";
  const auto second = MakeModel(five_motors);
  WriteHandPng(*second, std::vector(second->joint_names().size(), 20.0 * kRadPerDeg),
               std::vector<double>(second->motor_names().size()),
               {.camera = "hand", .width_px = 1080, .height_px = 840},
               folder / "five_motor_hand.png");
}

}  // namespace gauntlet::sim::testing
