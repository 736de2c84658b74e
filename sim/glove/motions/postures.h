#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// A posture of hand and arm that has a name: the end points of grasps and moves.
struct Posture {
  std::string_view name;
  std::string_view help;
  std::array<double, 18> angle_deg;  // in the order of GloveChannels()
};

/// The library of postures. Angles are assumptions: typical values inside the joints' ranges, named
/// after the grasps of daily life (power, precision, tripod, lateral, hook).
std::span<const Posture> Postures();
/// For a setting that is a choice of one posture; the same order.
std::span<const std::string_view> PostureNames();
/// Index of a posture; throws SettingError of `postures` with the nearest name if there is none.
std::size_t PostureIndex(std::string_view name);
/// The angles of a posture [rad, per channel of KnownChannels()].
std::vector<double> PostureAngles(std::size_t index);
/// Lets the end joints follow the middle joints: the places behind those of GloveChannels().
void BendEndJoints(std::vector<double>& angle_rad);

}  // namespace gauntlet::sim
