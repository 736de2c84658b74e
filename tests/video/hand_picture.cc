#include "tests/video/hand_picture.h"

#include <memory>

#include "sim/hand/posture.h"
#include "sim/show/video/drawing_library.h"
#include "sim/show/video/osmesa_renderer.h"
#include "sim/show/video/painter.h"

namespace gauntlet::sim {

void WriteHandPng(const HandModel& hand, std::span<const double> joint_angle_rad,
                  std::span<const double> spool_angle_rad, const HandPictureConfig& config,
                  const std::filesystem::path& target) {
  // A still is looked at for longer than a frame: finer in every respect.
  OsmesaRenderer renderer(hand.model(), {.width_px = config.width_px,
                                         .height_px = config.height_px,
                                         .camera = config.camera,
                                         .supersampling = 3,
                                         .shadows = true,
                                         .shadow_map_px = 4096,
                                         .ground = false,
                                         .sides = 64});
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(&hand.model()),
                                                               &mj_deleteData);
  SetPosture(hand, joint_angle_rad, spool_angle_rad, *data);
  Image view;
  renderer.Draw(*data, view);
  if (config.transparent) {
    WritePng(view, target);
    return;
  }
  Image picture(view.width_px, view.height_px);
  {
    const std::unique_ptr<Painter> opened = OpenPainter(picture);
    Painter& painter = *opened;
    painter.FillGradient(
        {0.0, 0.0, static_cast<double>(view.width_px), static_cast<double>(view.height_px)},
        palette::kViewTop, palette::kViewBottom);
    painter.Picture(view, 0, 0);
  }
  WritePng(picture, target);
}

}  // namespace gauntlet::sim
