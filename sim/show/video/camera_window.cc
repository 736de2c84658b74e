#include "sim/show/video/camera_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"

namespace gauntlet::sim {
namespace {

constexpr double kMargin = 0.06;  // on each side, of what is shown

}  // namespace

std::optional<int> FindCamera(const mjModel& model, const std::string& name, bool tall) {
  if (name.empty()) return std::nullopt;
  if (tall) {
    const int upright = mj_name2id(&model, mjOBJ_CAMERA, (name + "_upright").c_str());
    if (upright >= 0) return upright;
  }
  const int id = mj_name2id(&model, mjOBJ_CAMERA, name.c_str());
  if (id >= 0) return id;
  std::vector<std::string> names;
  for (int i = 0; i < model.ncam; ++i) {
    if (const char* known = mj_id2name(&model, mjOBJ_CAMERA, i)) names.emplace_back(known);
  }
  throw UserError(
      fmt::format("camera {}: the model has no such camera{}", name, Suggestion(name, names)));
}

void CameraWindow::Include(Point tangents) {
  left = std::min(left, tangents.x);
  right = std::max(right, tangents.x);
  bottom = std::min(bottom, tangents.y);
  top = std::max(top, tangents.y);
}

std::optional<SeenPoint> SeenFrom(const mjData& data, int camera,
                                  std::span<const mjtNum, 3> point_m) {
  const mjtNum* position = data.cam_xpos + 3 * camera;
  const mjtNum* axes = data.cam_xmat + 9 * camera;  // columns: right, up, backwards
  double seen[3] = {};
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 3; ++i) seen[axis] += axes[3 * i + axis] * (point_m[i] - position[i]);
  }
  if (seen[2] >= 0.0) return std::nullopt;
  return SeenPoint{.tangents = {-seen[0] / seen[2], -seen[1] / seen[2]}, .depth_m = -seen[2]};
}

Point PixelOf(const CameraWindow& window, Point tangents, int width_px, int height_px) {
  return {(tangents.x - window.left) / window.width() * width_px,
          (window.top - tangents.y) / window.height() * height_px};
}

CameraWindow WindowAround(const CameraWindow& shown, int width_px, int height_px) {
  const double scale =
      (1.0 + 2.0 * kMargin) * std::max(shown.width() / width_px, shown.height() / height_px);
  const double x = 0.5 * (shown.left + shown.right), half_width = 0.5 * scale * width_px;
  const double y = 0.5 * (shown.bottom + shown.top), half_height = 0.5 * scale * height_px;
  return {x - half_width, x + half_width, y - half_height, y + half_height};
}

}  // namespace gauntlet::sim
