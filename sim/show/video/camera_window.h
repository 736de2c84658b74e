#pragma once

#include <mujoco/mujoco.h>

#include <optional>
#include <span>
#include <string>

#include "sim/show/video/painter.h"

namespace gauntlet::sim {

/// The number of the camera that draws a picture of a size: for one taller than wide
/// `<name>_upright` where the model has it. None for an empty name, the free camera that sees the
/// whole model. Errors: UserError for a camera that the model lacks.
std::optional<int> FindCamera(const mjModel& model, const std::string& name, bool tall);

/// Extent of a camera's picture, as tangents of the angles from its axis.
struct CameraWindow {
  double left = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  double top = 0.0;

  double width() const { return right - left; }
  double height() const { return top - bottom; }
  void Include(Point tangents);
};

/// A point as a camera sees it: tangents of the angles to the right of its axis and above it, and
/// how far away it is along the axis.
struct SeenPoint {
  Point tangents;
  double depth_m = 0.0;
};

/// A point of the world [m] from a camera of `data`, whose kinematics are computed. None behind it.
std::optional<SeenPoint> SeenFrom(const mjData& data, int camera,
                                  std::span<const mjtNum, 3> point_m);

/// The pixel of a picture that shows a direction, from the top left corner.
Point PixelOf(const CameraWindow& window, Point tangents, int width_px, int height_px);

/// The smallest window with the sides' ratio of a picture that has `shown` in its middle, and a
/// margin around it.
CameraWindow WindowAround(const CameraWindow& shown, int width_px, int height_px);

}  // namespace gauntlet::sim
