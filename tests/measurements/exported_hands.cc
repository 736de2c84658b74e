// Ready hands as MJCF, each with lengths and moment arms of its cables in random postures, which
// mjcf_export.py compares with those of other versions of MuJoCo:
//
//     exported_hands FOLDER
//
// NAME.xml is the hand, NAME.txt has the names of its cables and then, a posture a line, the
// positions of all joints and for each cable its length [m] and a moment arm [m/rad] for each
// degree of freedom.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/base/data_folder.h"
#include "sim/base/output_file.h"
#include "sim/base/random.h"
#include "sim/hand/cable_geometry.h"
#include "sim/hand/mjcf_export.h"
#include "sim/hand/physics_model.h"

namespace gauntlet::sim {
namespace {

std::string Postures(const HandModel& hand) {
  constexpr int kPostures = 1000;
  const mjModel& physics = hand.physics().model();
  const std::vector<double> still(static_cast<std::size_t>(physics.nv));
  std::string text = fmt::format("{}\n", fmt::join(hand.cable_names(), " "));
  RandomStream random(11, "postures");
  for (int posture = 0; posture < kPostures; ++posture) {
    std::vector<double> angle_rad;
    for (const HandJoint& joint : hand.joints()) {
      angle_rad.push_back(random.Uniform(joint.min_rad, joint.max_rad));
    }
    const std::vector<double> whole =
        PostureOf(hand.model(), hand.joints(), angle_rad, hand.followers());
    std::vector<double> numbers(static_cast<std::size_t>(physics.nq));
    hand.physics().CopyPositions(whole.data(), numbers.data());
    const std::vector<double> qpos = numbers;
    for (const Drive& drive : hand.drives()) {
      for (const Cable& cable : drive.cables) {
        std::vector<double> arm_m(cable.crossings.size());
        double rate_m_s = 0.0;
        numbers.push_back(MeasureCable(cable, qpos.data(), still.data(), arm_m, rate_m_s));
        std::vector<double> by_dof(still.size());
        for (std::size_t i = 0; i < arm_m.size(); ++i) {
          by_dof[static_cast<std::size_t>(cable.crossings[i].dof)] += arm_m[i];
        }
        numbers.insert(numbers.end(), by_dof.begin(), by_dof.end());
      }
    }
    text += fmt::format("{}\n", fmt::join(numbers, " "));
  }
  return text;
}

void Write(const std::filesystem::path& folder) {
  MakeDirectory(folder);
  for (const std::string name :
       {"hand_arm", "hand_arm_object", "five_motor_hand", "three_finger_hand", "one_joint"}) {
    HandConfig config;
    config.model_path = (DataFolder("models") / (name + ".xml")).string();
    if (name == "hand_arm_object") config.contact = Contact::kObject;
    const HandModel hand(config);
    WriteOutputFile(folder / (name + ".xml"), ExportMjcf(hand, name, name + "_files").text);
    WriteOutputFile(folder / (name + ".txt"), Postures(hand));
  }
}

}  // namespace
}  // namespace gauntlet::sim

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: exported_hands FOLDER\n", stderr);
    return 2;
  }
  try {
    gauntlet::sim::Write(argv[1]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "exported_hands: {}\n", error.what());
    return 1;
  }
}
