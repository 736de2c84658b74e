#pragma once

#include <mujoco/mujoco.h>

#include <span>
#include <vector>

#include "sim/show/video/camera_window.h"
#include "sim/show/video/palette.h"

namespace gauntlet::sim {

// What is changed in a scene between MuJoCo's mjv_updateScene() and its drawing.

/// Planes: without them the rest stands before the caller's background.
void RemovePlanes(mjvScene& scene);

/// Cables as bars of four sides, not as round ones.
void FlattenCables(mjvScene& scene);

/// Colours of one drawing. Where nothing is given: as the model has them.
struct SceneColours {
  /// Per cable of the model, how it pulls, 0 .. 1: white where it is slack (0), else from brown to
  /// red with the root of the share, so that small pulls differ, too.
  std::span<const float> cable_share{};
  /// Per body of the model, how far from the model's colour (0) to `link` (1).
  std::span<const float> link_share{};
  Color link = palette::kHand.OnLight();
};

void ColourScene(mjvScene& scene, const mjModel& model, const SceneColours& colours);

/// Leaves only shapes of the bodies chosen by their numbers.
void KeepBodies(mjvScene& scene, const mjModel& model, const std::vector<bool>& chosen);

/// Both eyes show this part of what their camera sees.
void ShowWindow(mjvScene& scene, const CameraWindow& window);

/// `factor` times as much to be seen in height.
void WidenView(mjvScene& scene, double factor);

/// Removes shapes that cannot be in the picture: bounding spheres beyond the cone around the view.
/// Not to be used with shadows, since a shape out of sight may cast one into it.
void RemoveOutOfSight(mjvScene& scene, int width_px, int height_px);

}  // namespace gauntlet::sim
