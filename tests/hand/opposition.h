#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {

/// A posture in which the pad of the thumb meets another digit, with the Kapandji position that it
/// is (Kapandji 1986: 1 and 2 the side of the index finger's first two phalanges, 3 to 6 the tips).
struct Opposition {
  int kapandji;
  const char* finger;
  const char* body;                  // whose side is met; empty: the pad of the finger
  std::array<double, 4> thumb_deg;   // rotation, abduction, MCP, IP
  std::array<double, 3> finger_deg;  // spread, MCP, PIP
};

/// Found by a random search over the ranges of all joints.
inline constexpr std::array<Opposition, 6> kOppositions = {{
    {1, "index", "index_proximal", {0.0, 34.8, 60.0, 0.3}, {0.0, 15.8, 64.4}},
    {2, "index", "index_middle", {22.1, 9.6, 0.7, -10.7}, {14.7, 0.6, 100.0}},
    {3, "index", "", {89.8, 53.8, 4.1, -4.6}, {2.6, 77.6, 0.0}},
    {4, "middle", "", {104.9, 60.0, 0.1, -12.0}, {0.0, 84.9, 4.9}},
    {5, "ring", "", {121.0, 57.8, 1.6, -15.0}, {0.6, 74.5, 11.9}},
    {6, "little", "", {137.5, 60.0, 0.0, -15.0}, {0.0, 65.8, 19.6}},
}};

/// How near the thumb's pad and its target are, and how flat on each other.
struct Meeting {
  double gap_mm = 0.0;
  double facing_deg = 0.0;  // between one normal and the other reversed; 0: flat on flat
  double overlap_mm = 0.0;  // the deepest that any digit is in another
};

namespace opposition {

struct Surface {
  mjtNum point_m[3];
  mjtNum normal[3];
};

/// The pad of a digit: the palmar pole of the ellipsoid on its tip.
inline Surface PadOf(const mjModel& model, const mjData& data, const std::string& digit) {
  const int geom = mj_name2id(&model, mjOBJ_GEOM, (digit + "_fingertip").c_str());
  Surface surface{};
  for (int k = 0; k < 3; ++k) {
    const double outward = data.geom_xmat[9 * geom + 3 * k + 2];
    surface.normal[k] = -outward;
    surface.point_m[k] = data.geom_xpos[3 * geom + k] - model.geom_size[3 * geom + 2] * outward;
  }
  return surface;
}

/// The side of a phalanx towards the thumb, in its middle.
inline Surface SideOf(const mjModel& model, const mjData& data, const std::string& name) {
  const int body = mj_name2id(&model, mjOBJ_BODY, name.c_str());
  int capsule = model.body_geomadr[body];
  while (model.geom_type[capsule] != mjGEOM_CAPSULE || model.geom_contype[capsule] == 0) ++capsule;
  Surface surface{};
  for (int k = 0; k < 3; ++k) {
    surface.normal[k] = data.xmat[9 * body + 3 * k + 1];
    surface.point_m[k] =
        data.geom_xpos[3 * capsule + k] + model.geom_size[3 * capsule] * surface.normal[k];
  }
  return surface;
}

}  // namespace opposition

inline Meeting Meet(Hand& hand, const Opposition& posture) {
  const HandModel& whole = hand.hand_model();
  std::vector<double> angle_rad(whole.joint_names().size(), 0.0);
  const auto put = [&](const std::string& channel, double deg) {
    angle_rad[static_cast<std::size_t>(ChannelIndex(channel))] = deg * kRadPerDeg;
  };
  const std::string finger = posture.finger;
  const char* const thumb[] = {"thumb_rotation", "thumb_abduction", "thumb_mcp", "thumb_ip"};
  for (std::size_t i = 0; i < 4; ++i) put(thumb[i], posture.thumb_deg[i]);
  put("finger_spread", posture.finger_deg[0]);
  put(finger + "_mcp", posture.finger_deg[1]);
  put(finger + "_pip", posture.finger_deg[2]);
  hand.Reset(angle_rad);
  const mjModel& model = whole.model();
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&model), &mj_deleteData);
  SetPosture(whole, angle_rad, std::vector<double>(whole.drives().size(), 0.0), *data);

  const auto pad = opposition::PadOf(model, *data, "thumb");
  const auto other = *posture.body == '\0' ? opposition::PadOf(model, *data, finger)
                                           : opposition::SideOf(model, *data, posture.body);
  const double cosine = -mju_dot3(pad.normal, other.normal);
  return {.gap_mm = 1e3 * mju_dist3(pad.point_m, other.point_m),
          .facing_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegPerRad,
          .overlap_mm = 1e3 * hand.DigitOverlap()};
}

}  // namespace gauntlet::sim::testing
