#pragma once

#include <fmt/core.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {

/// A hand of the model in this text; the file is gone afterwards.
inline std::shared_ptr<const HandModel> MakeFromText(const std::string& xml, HandConfig config) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("small_hand_{}.xml", getpid());
  std::ofstream(file) << xml;
  config.model_path = file.string();
  try {
    auto model = std::make_shared<const HandModel>(config);
    std::filesystem::remove(file);
    return model;
  } catch (...) {
    std::filesystem::remove(file);
    throw;
  }
}

/// A hand of one hinge, whose laws can be worked out on paper: a lever of mass m at distance l, a
/// pulley of 10 mm around the hinge, a drum at 100 mm, and two cables.
///
/// At joint angle 0 the lever is level; gravity pulls it towards flexion (down). Every cable bends
/// once at its guide and once around the pulley.
struct SmallHand {
  double stiffness_n_m = 1e4;
  double drum_radius_m = 0.01;
  double mass_kg = 0.2;
  double gravity_m_s2 = 9.81;
  HandConfig config = StiffServos();

  static constexpr double kPulleyM = 0.010;
  static constexpr double kLeverM = 0.05;
  static constexpr double kGuideM = 0.020;  // from the hinge, along the cable
  static constexpr double kGuideHeightM = 0.006;

  std::string Xml() const {
    return fmt::format(R"(
<mujoco>
  <compiler angle="degree"/>
  <option timestep="0.001" gravity="0 0 -{gravity}"><flag contact="disable"/></option>
  <worldbody>
    <geom name="pulley" type="cylinder" fromto="0 -.005 0 0 .005 0" size="{pulley}"/>
    <site name="below" pos="0 0 -.03"/> <site name="above" pos="0 0 .03"/>
    <site name="flexor_drum" pos="-.1 0 -.01"/> <site name="extensor_drum" pos="-.1 0 .01"/>
    <site name="flexor_in" pos="-{guide} 0 {height}"/>
    <site name="extensor_in" pos="-{guide} 0 -{height}"/>
    <body name="spool" pos="-.1 0 0">
      <joint name="joint_spool" axis="0 1 0" armature="3e-4" damping="1e-3"/>
      <geom name="joint_drum" type="cylinder" size="{drum} .002" euler="90 0 0" mass=".001"/>
    </body>
    <body name="lever">
      <joint name="joint" axis="0 1 0" limited="true" range="-60 60" armature="1e-4" damping=".005"/>
      <geom type="sphere" size=".004" pos="{lever} 0 0" mass="{mass}"/>
      <site name="flexor_out" pos="{guide} 0 {height}"/>
      <site name="extensor_out" pos="{guide} 0 -{height}"/>
    </body>
  </worldbody>
  <tendon>
    <spatial name="joint_flexor" stiffness="{stiffness}" damping="5">
      <site site="flexor_drum"/><site site="flexor_in"/>
      <geom geom="pulley" sidesite="below"/><site site="flexor_out"/>
    </spatial>
    <spatial name="joint_extensor" stiffness="{stiffness}" damping="5">
      <site site="extensor_drum"/><site site="extensor_in"/>
      <geom geom="pulley" sidesite="above"/><site site="extensor_out"/>
    </spatial>
  </tendon>
  <actuator>
    <motor name="joint" joint="joint_spool" ctrllimited="true" ctrlrange="-.45 .45"/>
  </actuator>
</mujoco>)",
                       fmt::arg("gravity", gravity_m_s2), fmt::arg("pulley", kPulleyM),
                       fmt::arg("guide", kGuideM), fmt::arg("height", kGuideHeightM),
                       fmt::arg("drum", drum_radius_m), fmt::arg("lever", kLeverM),
                       fmt::arg("mass", mass_kg), fmt::arg("stiffness", stiffness_n_m));
  }

  std::shared_ptr<const HandModel> Make() const { return MakeFromText(Xml(), config); }

  /// Torque of the weight about the hinge at a joint angle [N m], towards flexion.
  double WeightTorque(double angle_rad) const {
    return mass_kg * gravity_m_s2 * kLeverM * std::cos(angle_rad);
  }

  /// How far a cable has bent behind the pulley at joint angle 0 [rad]: at its guide from level to
  /// the tangent, and around the pulley from tangent to tangent.
  static double BendAtZero() {
    const double distance = std::hypot(kGuideM, kGuideHeightM);
    const double above = std::atan2(kGuideHeightM, kGuideM);
    const double wrap = M_PI + 2.0 * (above - std::acos(kPulleyM / distance));
    // The tangent leaves the guide at half the wrap from level; before it the cable rises from the
    // drum's rim, 16 mm lower and 80 mm behind.
    const double rise = std::atan2(kGuideHeightM + 0.01, 0.1 - kGuideM);
    return 0.5 * wrap + rise + wrap;
  }
};

/// The small hand beside a mass on a spring too stiff for the time step, whose swing doubles every
/// millisecond (k h^2 / m = 4.5): after 17 steps its acceleration passes 1e10 m/s^2, where the
/// physics engine gives up. The hinge has the name of a channel.
inline std::string DivergingHandXml(const std::string& channel) {
  std::string xml = SmallHand{}.Xml();
  const std::string name = "\"joint";  // where a value begins with it
  for (std::size_t at = xml.find(name); at != std::string::npos; at = xml.find(name, at + 1)) {
    xml.replace(at, name.size(), "\"" + channel);
  }
  xml.insert(
      xml.find("</worldbody>"),
      R"(<body pos="0 0 1"><joint type="slide" axis="1 0 0" stiffness="4500" springref=".01"/>
                <geom size=".01" mass=".001"/></body>)");
  return xml;
}
inline std::shared_ptr<const HandModel> MakeDivergingHand(const std::string& channel) {
  return MakeFromText(DivergingHandXml(channel), {});
}

/// A command with which the joint stands at this angle when nothing stretches.
inline std::int32_t JointCommand(const HandModel& model, double angle_rad) {
  const controller::TendonTransmission& map = model.transmission();
  return static_cast<std::int32_t>(
      std::lround(map.center_counts[0] + map.counts_per_rad[0] * map.coupling[0] *
                                             (angle_rad - map.reference_angle_rad[0])));
}

struct SmallHandReading {
  double joint_rad;
  double spool_rad;
  double flexor_n;
  double extensor_n;
};

inline SmallHandReading Read(const Hand& hand) {
  SmallHandReading reading{};
  double tension[2];
  hand.ReadJointAngles({&reading.joint_rad, 1});
  hand.ReadSpoolAngles({&reading.spool_rad, 1});
  hand.ReadCableTensions(tension);
  reading.flexor_n = tension[0];
  reading.extensor_n = tension[1];
  return reading;
}

/// Gives one command and lets the hand follow it.
inline void Hold(Hand& hand, std::int32_t counts, int samples) {
  hand.SetCommand({&counts, 1});
  for (int i = 0; i < samples; ++i) hand.Step();
}

}  // namespace gauntlet::sim::testing
