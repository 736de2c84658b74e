#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/show/video/camera_window.h"
#include "sim/show/video/image.h"
#include "sim/show/video/scene_geoms.h"

namespace gauntlet::sim {

struct RendererConfig {
  int width_px = 640;
  int height_px = 480;
  std::string camera{};  // by name; empty: a free camera that sees the whole model
  std::optional<int>
      camera_id{};  // instead of the one that the name and the size of the picture choose
  /// The part of what the camera sees that fills the picture; none: what the model says.
  std::optional<CameraWindow> window{};
  /// A pixel is the mean of n x n drawn ones. On a software rasteriser twice the resolution in both
  /// directions costs half of what four samples a pixel cost, and smooths highlights, too.
  int supersampling = 2;
  bool shadows = false;  // cost two to three times the time without
  int shadow_map_px = 1024;
  bool ground = true;  // planes; without them the hand stands before the caller's background
  /// Round shapes are drawn with this many sides: 14 are enough for a finger some 20 px wide. The
  /// number of triangles is what costs time.
  int sides = 14;
  /// Cables as bars of four sides, not as round ones: look the same up to 3 px of width, and
  /// saves half of the time for a hand with 36 cables.
  bool plain_cables = false;
};

/// Draws a model off-screen, without a display, on the CPU.
///
/// Pixels that the model does not cover stay transparent. For a picture taller than wide
/// FindCamera() takes the upright camera where the model has one; where not, the camera's field of
/// view becomes that in width, so that the hand is not cut off.
/// One thread of a process may have renderers, and draw with one at a time: Mesa's rasteriser keeps
/// the scenes of all contexts in one list, and walks through it without a lock (llvmpipe of 22.3).
/// Errors: UserError for a camera that the model lacks, RunError for a context that cannot be made.
class OsmesaRenderer {
 public:
  /// `model` must outlive the renderer.
  OsmesaRenderer(const mjModel& model, const RendererConfig& config);
  ~OsmesaRenderer();
  OsmesaRenderer(const OsmesaRenderer&) = delete;
  OsmesaRenderer& operator=(const OsmesaRenderer&) = delete;

  /// Sets the window of the next pictures, as RendererConfig::window.
  void SetWindow(const std::optional<CameraWindow>& window);
  /// The posture in `data`, whose kinematics are computed, as a picture of the configured size.
  void Draw(mjData& data, Image& picture, const SceneColours& colours = {});
  /// As Draw(), for some bodies only, chosen by their numbers, and without cables.
  void DrawBodies(mjData& data, const std::vector<bool>& chosen, Image& picture);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace gauntlet::sim
