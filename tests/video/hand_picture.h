#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "sim/hand/hand.h"

namespace gauntlet::sim {

struct HandPictureConfig {
  std::string camera{};  // by name; empty: the whole model from afar
  int width_px = 1280;
  int height_px = 960;
  bool transparent = false;  // else the video's light background
};

/// One still picture of the hand in a posture, as PNG: for a page, a model card, a look in between.
///
/// Shapes: a joint angle [rad] per channel, a spool angle [rad] per motor.
/// Errors: UserError for a camera that the model lacks or a size that cannot be drawn; RunError for
/// a file that cannot be written.
void WriteHandPng(const HandModel& hand, std::span<const double> joint_angle_rad,
                  std::span<const double> spool_angle_rad, const HandPictureConfig& config,
                  const std::filesystem::path& target);

}  // namespace gauntlet::sim
