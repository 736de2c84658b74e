#include "sim/video/comparison_video.h"

#include <memory>
#include <vector>

#include "sim/base/atomic_file.h"
#include "sim/base/error.h"
#include "sim/hand/posture.h"
#include "sim/video/comparison_picture.h"
#include "sim/video/ordered_frames.h"
#include "sim/video/osmesa_renderer.h"
#include "sim/video/video_encoder.h"

namespace gauntlet::sim {
namespace {

struct FreeData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};

std::vector<double> Row(const Signal& signal, int sample) {
  std::vector<double> values(signal.cols());
  for (Eigen::Index i = 0; i < signal.cols(); ++i) values[i] = signal(sample, i);
  return values;
}

/// What one process needs to draw frames: its own context, posture and pictures of hands.
class FrameArtist {
 public:
  FrameArtist(const VideoInput& input, const HandModel& hand, const ComparisonPicture& picture)
      : input_(input),
        hand_(hand),
        picture_(picture),
        renderer_(hand.model(), {.width_px = picture.view_width_px(),
                                 .height_px = picture.view_height_px(),
                                 .camera = input.camera,
                                 .ground = false,
                                 .plain_cables = true}),
        data_(mj_makeData(&hand.model())),
        views_(input.panes.size()) {
    if (data_ == nullptr) throw RunError("video: not enough memory for a posture");
    if (!hand.grasp().exists()) return;
    // The support stands where the object stood when the trial began.
    SetPosture(hand, Row(*input.true_angle_rad, 0),
               std::vector<double>(hand.transmission().motor_names.size()), *data_);
    PlaceObject(hand.grasp(), *data_);
  }

  void Draw(int frame, ImageView image) {
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const VideoPane& pane = input_.panes[i];
      const int sample = picture_.SampleOf(i, frame);
      if (pane.object_pose != nullptr && pane.object_pose->cols() == 7) {
        SetObjectPose(hand_, Row(*pane.object_pose, sample), *data_);
      }
      SetPosture(hand_, Row(*pane.hand_angle_rad, sample), Row(*pane.spool_angle_rad, sample),
                 *data_);
      renderer_.Draw(*data_, views_[i]);
    }
    picture_.Draw(frame, views_, image);
  }

 private:
  const VideoInput& input_;
  const HandModel& hand_;
  const ComparisonPicture& picture_;
  OsmesaRenderer renderer_;
  std::unique_ptr<mjData, FreeData> data_;
  std::vector<Image> views_;
};

}  // namespace

void WriteComparisonVideo(const VideoInput& input, const HandModel& hand,
                          const std::filesystem::path& target,
                          const std::function<bool(int, int)>& progress) {
  const ComparisonPicture picture(input);
  AtomicFile file(target);
  const int frames = picture.frame_count();
  const bool complete = DrawFramesInOrder(
      {.frame_count = frames,
       .width_px = input.width_px,
       .height_px = input.height_px,
       .jobs = input.jobs},
      [&](Frames& todo) {
        FrameArtist artist(input, hand, picture);
        while (const auto frame = todo.Next()) artist.Draw(frame->number, frame->image);
      },
      [&](Frames& drawn) {
        VideoEncoder encoder(file, {.width_px = input.width_px,
                                    .height_px = input.height_px,
                                    .frames_per_s = input.frames_per_s});
        while (const auto frame = drawn.Next()) encoder.Add(frame->image);
        encoder.Finish();
      },
      [&](int done) { return !progress || progress(done, frames); });
  if (!complete) throw Cancelled{};
  file.Commit();
}

}  // namespace gauntlet::sim
