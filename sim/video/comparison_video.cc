#include "sim/video/comparison_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/video/comparison_picture.h"
#include "sim/video/drawing_library.h"
#include "sim/video/ghost.h"
#include "sim/video/hand_colours.h"
#include "sim/video/hand_view.h"
#include "sim/video/ordered_frames.h"
#include "sim/video/osmesa_renderer.h"
#include "sim/video/png_file.h"
#include "sim/video/video_encoder.h"

namespace gauntlet::sim {
namespace {

/// Which frames of a video show what: first the question, then the motion, then the verdict.
struct FrameRanges {
  int motion;   // the first of these
  int verdict;  // the first of these
  int end;
};

FrameRanges FrameRangesOf(const VideoInput& input, const FrameClock& clock) {
  // Cards stand still: before and after the motion, where there is something to say.
  const auto card = [&](bool exists, double time_s) {
    return exists ? static_cast<int>(std::lround(time_s * input.frames_per_s)) : 0;
  };
  const int motion = card(!input.question.empty(), kTitle_s);
  const int verdict = motion + clock.FrameCount();
  return {.motion = motion,
          .verdict = verdict,
          .end = verdict + card(!input.verdict.rows.empty(), kVerdict_s)};
}

/// Chapters without a gap, where the video shows any named part of the motion: players of MP4 know
/// no end of a chapter but the beginning of the next.
std::vector<Chapter> ChaptersOf(const VideoInput& input, const FrameClock& clock,
                                const FrameRanges& frames) {
  std::vector<Chapter> chapters;
  int end = 0;  // of those that there are
  const auto add_until = [&](const std::string& title, int until) {
    if (until <= end) return;
    chapters.push_back({.title = title, .begin = end, .end = until});
    end = until;
  };
  add_until("question", frames.motion);
  bool any_named = false;
  for (const Segment& part : input.parts) {
    add_until("unlabelled", frames.motion + clock.FirstFrameFrom(part.begin));
    const std::size_t before = chapters.size();
    add_until(part.label, frames.motion + clock.FirstFrameFrom(part.end));
    any_named = any_named || chapters.size() > before;
  }
  if (!any_named) return {};
  add_until("unlabelled", frames.verdict);
  add_until("verdict", frames.end);
  return chapters;
}

/// What one process needs to draw frames: its own context, posture and pictures of hands.
class FrameArtist {
 public:
  FrameArtist(const VideoInput& input, const HandModel& hand, const ComparisonPicture& picture,
              const HandView& view)
      : input_(input),
        hand_(hand),
        picture_(picture),
        view_(view),
        renderer_(hand.model(), view.RendererOf(input)),
        data_(MakeData(hand)),
        ghost_(palette::kTrue, picture.outline_px()),
        second_(palette::kSecondHand, picture.outline_px()),
        colours_(input, hand, picture.colour_scale()),
        hands_(input.panes.size()) {
    if (!hand.grasp().exists()) return;
    // The support stands where the object stood when the trial began.
    SetWearer(input, hand, 0, *data_);
    PlaceObject(hand.grasp(), *data_);
  }

  void Draw(int frame, ImageView image) {
    SetWearer(input_, hand_, picture_.clock().Sample(frame), *data_);
    if (!view_.bodies().empty()) {
      renderer_.DrawBodies(*data_, view_.bodies(), drawn_);
      ghost_.Take(drawn_);
    }
    for (std::size_t i = 0; i < input_.panes.size(); ++i) {
      const int pane = static_cast<int>(i), sample = picture_.SampleOf(pane, frame);
      SetPane(input_.panes[i], hand_, sample, *data_);
      renderer_.Draw(*data_, hands_[i], colours_.Of(pane, sample));
    }
    if (input_.overlay) second_.Take(hands_[1]);
    picture_.Draw(frame, {.panes = hands_, .wearer = ghost_, .second = second_, .view = view_},
                  image);
  }

 private:
  const VideoInput& input_;
  const HandModel& hand_;
  const ComparisonPicture& picture_;
  const HandView& view_;
  OsmesaRenderer renderer_;
  DataOfModel data_;
  Image drawn_;
  Ghost ghost_;
  Ghost second_;
  HandColours colours_;
  std::vector<Image> hands_;
};

}  // namespace

std::vector<int> MeasuredJointsOf(const VideoInput& input) {
  if (!input.measured_joints.empty()) return input.measured_joints;
  std::vector<int> all(static_cast<std::size_t>(input.true_angle_rad->cols()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

void WriteComparisonVideo(const VideoInput& input, const HandModel& hand,
                          const std::filesystem::path& target,
                          const std::function<bool(int, int)>& progress) {
  const ComparisonPicture picture(input);
  const HandView view(input, hand, picture.view_width_px(), picture.view_height_px());
  OutputFile file(target);
  const FrameRanges frames = FrameRangesOf(input, picture.clock());
  LoadDrawingLibrary();  // once for all processes
  const bool complete = DrawFramesInOrder(
      {.frame_count = frames.end,
       .width_px = input.width_px,
       .height_px = input.height_px,
       .jobs = input.jobs},
      [&](Frames& todo) {
        FrameArtist artist(input, hand, picture, view);
        while (const auto frame = todo.Next()) {
          if (frame->number < frames.motion) {
            picture.DrawTitle(frame->image);
          } else if (frame->number >= frames.verdict) {
            picture.DrawVerdict(frame->image);
          } else {
            artist.Draw(frame->number - frames.motion, frame->image);
          }
        }
      },
      [&](Frames& drawn) {
        const auto encoder =
            OpenVideo(file, {.width_px = input.width_px,
                             .height_px = input.height_px,
                             .frames_per_s = input.frames_per_s,
                             .container = ContainerOf(target),
                             .rate_factor = input.rate_factor,
                             .chapters = ChaptersOf(input, picture.clock(), frames)});
        while (const auto frame = drawn.Next()) encoder->Add(frame->image);
        encoder->Finish();
      },
      [&](int done) { return !progress || progress(done, frames.end); });
  if (!complete) throw Cancelled{};
  file.Commit();
}

void WriteComparisonPng(const VideoInput& input, const HandModel& hand, double time_s,
                        const std::filesystem::path& target) {
  const ComparisonPicture picture(input);
  const FrameClock& clock = picture.clock();
  const double frame = std::round((time_s - clock.first_s()) * clock.frames_per_s / clock.speed());
  if (!(frame >= 0.0 && frame < clock.FrameCount())) {
    throw UserError(fmt::format("--frame {:g}: must be from {:g} to {:g} s", time_s,
                                clock.first_s(), clock.Time_s(clock.FrameCount() - 1)));
  }
  const HandView view(input, hand, picture.view_width_px(), picture.view_height_px());
  Image image(input.width_px, input.height_px);
  FrameArtist(input, hand, picture, view).Draw(static_cast<int>(frame), image);
  WritePng(image, target);
}

}  // namespace gauntlet::sim
