#include "sim/show/video/comparison_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/show/video/comparison_picture.h"
#include "sim/show/video/drawing_library.h"
#include "sim/show/video/ghost.h"
#include "sim/show/video/hand_colours.h"
#include "sim/show/video/hand_view.h"
#include "sim/show/video/ordered_frames.h"
#include "sim/show/video/osmesa_renderer.h"
#include "sim/show/video/video_encoder.h"

namespace gauntlet::sim {
namespace {

/// Which frames of a video show what: the question, the motion, a part of it again, the verdict.
struct FrameRanges {
  int motion;   // the first of these
  int again;    // the first of these
  int verdict;  // the first of these
  int end;
};

/// Frames of a card, which stands still.
int CardFrames(bool exists, double time_s, int frames_per_s) {
  return exists ? static_cast<int>(std::lround(time_s * frames_per_s)) : 0;
}

/// One picture of hands and curves, and its camera.
struct Scene {
  Scene(const VideoInput& given, const HandModel& hand)
      : input(given),
        picture(input),
        view(input, hand, picture.view_width_px(), picture.view_height_px(), picture.inset_px()) {}
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  const VideoInput input;
  const ComparisonPicture picture;
  const HandView view;
};

/// The part that is shown again, if there is one.
std::unique_ptr<Scene> SceneAgain(const VideoInput& input, const HandModel& hand) {
  if (!input.again) return nullptr;
  VideoInput again = input;
  again.excerpt = *input.again;
  return std::make_unique<Scene>(again, hand);
}

FrameRanges FrameRangesOf(const VideoInput& input, const Scene& scene, const Scene* again) {
  const int motion = CardFrames(!input.question.empty(), kTitle_s, input.frames_per_s);
  const int slow = motion + scene.picture.frame_count();
  const int verdict = slow + (again == nullptr ? 0 : again->picture.frame_count());
  return {.motion = motion,
          .again = slow,
          .verdict = verdict,
          .end = verdict + CardFrames(!input.verdict.rows.empty(), kVerdict_s, input.frames_per_s)};
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
  add_until("unlabelled", frames.again);
  add_until("slow motion", frames.verdict);
  add_until("verdict", frames.end);
  return chapters;
}

/// Moments all over a video, whose colours it has.
std::vector<int> SampleFrames(int frame_count) {
  constexpr int kSamples = 12;
  std::vector<int> frames;
  for (int i = 0; i < std::min(kSamples, frame_count); ++i) {
    frames.push_back(static_cast<int>((i + 0.5) * frame_count / std::min(kSamples, frame_count)));
  }
  return frames;
}

/// Tools of one process to draw frames of a scene: its own context, posture and pictures of hands.
class FrameArtist {
 public:
  FrameArtist(const Scene& scene, const HandModel& hand)
      : input_(scene.input),
        hand_(hand),
        picture_(scene.picture),
        view_(scene.view),
        renderer_(hand.model(), view_.RendererOf(input_)),
        data_(MakeData(hand)),
        ghost_(palette::kWearer.OnLight(), picture_.outline_px()),
        second_(ColourOfPane(input_, input_.overlay ? 1 : 0), picture_.outline_px()),
        colours_(input_, hand, picture_.colour_scale()),
        hands_(input_.panes.size()),
        insets_(input_.panes.size()) {
    if (view_.inset_px() > 0) inset_renderer_.emplace(hand.model(), view_.InsetRendererOf(input_));
    if (!hand.grasp().exists()) return;
    // The support stands where the object stood when the trial began.
    SetWearer(input_, hand, 0, *data_);
    PlaceObject(hand.grasp(), *data_);
  }

  void Draw(int frame, ImageView image) {
    SetWearer(input_, hand_, picture_.clock().Sample(frame), *data_);
    if (const auto window = view_.WindowAt(*data_)) renderer_.SetWindow(window);
    if (!view_.bodies().empty()) {
      renderer_.DrawBodies(*data_, view_.bodies(), drawn_);
      ghost_.SetHand(drawn_);
    }
    for (std::size_t i = 0; i < input_.panes.size(); ++i) {
      const int pane = static_cast<int>(i), sample = picture_.SampleOf(pane, frame);
      SetPane(input_.panes[i], hand_, sample, *data_);
      renderer_.Draw(*data_, hands_[i], colours_.Of(pane, sample));
      DrawInset(pane, sample);
    }
    if (input_.overlay) second_.SetHand(hands_[1]);
    picture_.Draw(
        frame,
        {.panes = hands_, .insets = insets_, .wearer = ghost_, .second = second_, .view = view_},
        image);
  }

 private:
  void DrawInset(int pane, int sample) {
    const FingertipPath& path = view_.fingertip(pane);
    if (!inset_renderer_ || path.places.empty()) return;
    const FingertipPath::Place& place = path.places[path.IndexAt(sample / input_.rate_hz)];
    inset_renderer_->SetWindow(view_.InsetAround(place.smooth));
    inset_renderer_->Draw(*data_, insets_[pane]);
  }

  const VideoInput& input_;
  const HandModel& hand_;
  const ComparisonPicture& picture_;
  const HandView& view_;
  OsmesaRenderer renderer_;
  std::optional<OsmesaRenderer> inset_renderer_;
  DataOfModel data_;
  Image drawn_;
  Ghost ghost_;
  Ghost second_;
  HandColours colours_;
  std::vector<Image> hands_;
  std::vector<Image> insets_;
};

/// Draws all frames of a video in one process, with an artist for each scene that it meets.
class VideoArtist {
 public:
  VideoArtist(const Scene& scene, const Scene* again, const FrameRanges& frames,
              const HandModel& hand)
      : scene_(scene), again_(again), frames_(frames), hand_(hand) {}

  void Draw(int number, ImageView image) {
    if (number < frames_.motion) {
      scene_.picture.DrawTitle(image);
    } else if (number < frames_.again) {
      if (!artist_) artist_.emplace(scene_, hand_);
      artist_->Draw(number - frames_.motion, image);
    } else if (number < frames_.verdict) {
      if (!artist_again_) artist_again_.emplace(*again_, hand_);
      artist_again_->Draw(number - frames_.again, image);
    } else {
      scene_.picture.DrawVerdict(image);
    }
  }

 private:
  const Scene& scene_;
  const Scene* again_;
  const FrameRanges& frames_;
  const HandModel& hand_;
  std::optional<FrameArtist> artist_, artist_again_;
};

}  // namespace

std::vector<int> MeasuredJointsOf(const VideoInput& input) {
  if (!input.measured_joints.empty()) return input.measured_joints;
  std::vector<int> all(static_cast<std::size_t>(input.true_angle_rad->cols()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<VideoStretch> StretchesOf(bool has_title, double rate_hz, std::int64_t samples,
                                      int frames_per_s, const std::optional<Excerpt>& again) {
  const FrameClock clock(rate_hz, frames_per_s, samples);
  const double duration_s = static_cast<double>(samples) / rate_hz;
  const int title = CardFrames(has_title, kTitle_s, frames_per_s);
  const double begin_s = static_cast<double>(title) / frames_per_s;
  std::vector<VideoStretch> stretches = {{begin_s, 0.0, duration_s, 1.0}};
  if (again) {
    const double end_s = static_cast<double>(title + clock.FrameCount()) / frames_per_s;
    stretches.push_back({end_s, again->from_s, std::min(duration_s, again->to_s), again->speed});
  }
  return stretches;
}

void WriteComparisonVideo(const VideoInput& input, const HandModel& hand,
                          const std::filesystem::path& target,
                          const std::function<bool(int, int)>& progress) {
  const Scene scene(input, hand);
  const std::unique_ptr<Scene> again = SceneAgain(input, hand);
  OutputFile file(target);
  const FrameRanges frames = FrameRangesOf(input, scene, again.get());
  LoadDrawingLibrary();  // once for all processes
  const bool complete = DrawFramesInOrder(
      {.frame_count = frames.end,
       .width_px = input.width_px,
       .height_px = input.height_px,
       .jobs = input.jobs},
      [&](Frames& todo) {
        VideoArtist artist(scene, again.get(), frames, hand);
        while (const auto frame = todo.Next()) artist.Draw(frame->number, frame->image);
      },
      [&](Frames& drawn) {
        std::vector<Image> samples;
        if (ContainerOf(target) == Container::kGif) {
          VideoArtist artist(scene, again.get(), frames, hand);
          for (const int number : SampleFrames(frames.end)) {
            artist.Draw(number, samples.emplace_back(input.width_px, input.height_px));
          }
        }
        const auto encoder =
            OpenVideo(file, {.width_px = input.width_px,
                             .height_px = input.height_px,
                             .frames_per_s = input.frames_per_s,
                             .container = ContainerOf(target),
                             .rate_factor = input.rate_factor,
                             .chapters = ChaptersOf(input, scene.picture.clock(), frames),
                             .samples = {samples.begin(), samples.end()}});
        while (const auto frame = drawn.Next()) encoder->Add(frame->image);
        encoder->Finish();
      },
      [&](int done) { return !progress || progress(done, frames.end); });
  if (!complete) throw Cancelled{};
  file.Commit();
}

void WriteComparisonPng(const VideoInput& input, const HandModel& hand, double time_s,
                        const std::filesystem::path& target) {
  const Scene scene(input, hand);
  const FrameClock& clock = scene.picture.clock();
  const double frame = std::round((time_s - clock.first_s()) * clock.frames_per_s / clock.speed());
  if (!(frame >= 0.0 && frame < clock.FrameCount())) {
    throw UserError(fmt::format("--frame {:g}: must be from {:g} to {:g} s", time_s,
                                clock.first_s(), clock.Time_s(clock.FrameCount() - 1)));
  }
  Image image(input.width_px, input.height_px);
  FrameArtist(scene, hand).Draw(static_cast<int>(frame), image);
  WritePng(image, target);
}

}  // namespace gauntlet::sim
