// How fast are videos drawn, and how much of it is the rasteriser?
//
// Draws the beginning of an output folder as a video of two panes, 1280 x 720, once with each look,
// curves, text and encoding included. Then the hands of the same frames alone, beside a bare loop
// of mjr_render and mjr_readPixels over the same scenes: it checks that both make the same picture.
//
//   video_benchmark FOLDER A,B [seconds of the motion]
#include <GL/osmesa.h>
#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/show/video/comparison_picture.h"
#include "sim/show/video/folder_video.h"
#include "sim/show/video/hand_view.h"
#include "sim/show/video/osmesa_renderer.h"
#include "sim/show/video/scene_geoms.h"

namespace gauntlet::sim {
namespace {

constexpr int kCores = 2;

double Wall_s() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// Of this process and of those that it waited for.
double Processor_s() {
  double sum_s = 0.0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage = {};
    getrusage(who, &usage);
    for (const timeval& time : {usage.ru_utime, usage.ru_stime}) {
      sum_s += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
  }
  return sum_s;
}

/// What MuJoCo's own functions take for the scenes of a renderer: its camera, shapes and sizes.
class BareLoop {
 public:
  BareLoop(const mjModel& model, const RendererConfig& config)
      : model_(model), config_(config), pixels_(3 * PixelCount()) {
    mjv_defaultCamera(&camera_);
    camera_.type = mjCAMERA_FIXED;
    camera_.fixedcamid =
        FindCamera(model, config.camera, config.width_px < config.height_px).value();
    mjv_defaultOption(&option_);
    mjv_defaultScene(&scene_);
    mjr_defaultContext(&drawing_);
    mesa_ = OSMesaCreateContextExt(OSMESA_RGBA, 24, 8, 0, nullptr);
    MakeCurrent();
    mjModel* copy = mj_copyModel(nullptr, &model);
    copy->vis.global.offwidth = width_px();
    copy->vis.global.offheight = height_px();
    copy->vis.quality.offsamples = 0;
    copy->vis.quality.shadowsize = 0;
    copy->vis.quality.numslices = config.sides;
    copy->vis.quality.numstacks = config.sides / 2;
    copy->vis.quality.numquads = 1;
    mjr_makeContext(copy, &drawing_, mjFONTSCALE_100);
    mj_deleteModel(copy);
    mjr_setBuffer(mjFB_OFFSCREEN, &drawing_);
    mjv_makeScene(&model, &scene_, 10'000);
  }
  ~BareLoop() {
    MakeCurrent();
    mjr_freeContext(&drawing_);
    mjv_freeScene(&scene_);
    OSMesaDestroyContext(mesa_);
  }
  BareLoop(const BareLoop&) = delete;
  BareLoop& operator=(const BareLoop&) = delete;

  /// Not part of what is timed.
  void SetScene(mjData& data) {
    MakeCurrent();
    mjv_updateScene(&model_, &data, &option_, nullptr, &camera_, mjCAT_ALL, &scene_);
    for (const int flag : {mjRND_SHADOW, mjRND_REFLECTION, mjRND_SKYBOX, mjRND_HAZE}) {
      scene_.flags[flag] = 0;
    }
    RemovePlanes(scene_);
    FlattenCables(scene_);
    ShowWindow(scene_, config_.window.value());
    RemoveOutOfSight(scene_, config_.width_px, config_.height_px);
  }

  void Draw() {
    const mjrRect all = {0, 0, width_px(), height_px()};
    mjr_render(all, &scene_, &drawing_);
    mjr_readPixels(pixels_.data(), nullptr, all, &drawing_);
  }

  /// Whether `picture` has what was drawn, each pixel the rounded mean of n x n.
  bool IsIn(const Image& picture) const {
    const int n = config_.supersampling;
    for (int y = 0; y < config_.height_px; ++y) {
      for (int x = 0; x < config_.width_px; ++x) {
        for (int channel = 0; channel < 3; ++channel) {  // red, green, blue
          int sum = 0;
          for (int part = 0; part < n * n; ++part) {
            const int row = (config_.height_px - 1 - y) * n + part / n;
            sum += pixels_[3 * (std::size_t{1} * row * width_px() + x * n + part % n) + channel];
          }
          const int mean = (sum + n * n / 2) / (n * n);
          const int shown = static_cast<int>(picture.Row(y)[x] >> (8 * (2 - channel)) & 255u);
          if (mean != shown) return false;
        }
      }
    }
    return true;
  }

 private:
  int width_px() const { return config_.width_px * config_.supersampling; }
  int height_px() const { return config_.height_px * config_.supersampling; }
  std::size_t PixelCount() const { return std::size_t{1} * width_px() * height_px(); }
  void MakeCurrent() { OSMesaMakeCurrent(mesa_, placeholder_, GL_UNSIGNED_BYTE, 16, 16); }

  const mjModel& model_;
  RendererConfig config_;
  std::vector<unsigned char> pixels_;
  unsigned char placeholder_[16 * 16 * 4] = {};
  mjvCamera camera_;
  mjvOption option_;
  mjvScene scene_;
  mjrContext drawing_;
  OSMesaContext mesa_ = nullptr;
};

/// Our drawing of hands against the bare loop, frame by frame in turns.
void CompareWithBareLoop(const FolderVideo& video) {
  const VideoInput& input = video.input();
  const ComparisonPicture picture(input);
  const HandView view(input, video.hand(), picture.view_width_px(), picture.view_height_px());
  const DataOfModel data = MakeData(video.hand());
  SetWearer(input, video.hand(), 0, *data);
  RendererConfig config = view.RendererOf(input);
  config.window = view.WindowAt(*data);
  OsmesaRenderer renderer(video.hand().model(), config);
  BareLoop bare(video.hand().model(), config);
  Image drawn;
  double ours_s = 0.0, bare_s = 0.0;
  int count = 0;
  for (int frame = 0; frame < picture.frame_count(); ++frame) {
    for (std::size_t pane = 0; pane < input.panes.size(); ++pane) {
      SetPane(input.panes[pane], video.hand(), picture.SampleOf(pane, frame), *data);
      const double start_s = Processor_s();
      renderer.Draw(*data, drawn);
      const double drawn_s = Processor_s();
      bare.SetScene(*data);
      const double scene_s = Processor_s();
      bare.Draw();
      const double end_s = Processor_s();
      if (!bare.IsIn(drawn)) throw std::runtime_error("the bare loop draws something else");
      if (frame == 0) continue;  // compiles shaders
      ours_s += drawn_s - start_s;
      bare_s += end_s - scene_s;
      ++count;
    }
  }
  fmt::print("{:5}  {:3} drawings: {:.2f} ms each, bare loop {:.2f} ms: {:.3f} of its speed\n",
             input.look.name, count, 1e3 * ours_s / count, 1e3 * bare_s / count, bare_s / ours_s);
}

/// Frames per second of a video, from the first to the last of its file.
void TimeVideo(const FolderVideo& video, const std::filesystem::path& target) {
  int frames = 0;
  const double start_s = Wall_s(), processor_s = Processor_s();
  WriteComparisonVideo(video.input(), video.hand(), target, [&frames](int, int all) {
    frames = all;
    return true;
  });
  const double took_s = Wall_s() - start_s, used_s = Processor_s() - processor_s;
  fmt::print("{:5}  {} frames: {:.1f} per second, {:.1f} per second of processor time\n",
             video.input().look.name, frames, frames / took_s, frames / used_s);
}

int Main(int count, char** arguments) {
  if (count < 3) {
    fmt::print("video_benchmark FOLDER A,B [seconds of the motion]\n");
    return 2;
  }
  const std::string names = arguments[2];
  const std::size_t comma = names.find(',');
  const auto target = std::filesystem::temp_directory_path() /
                      fmt::format("gauntlet_video_benchmark_{}.mp4", getpid());
  for (const Look& look : kLooks) {
    const FolderVideo video(
        {.folder = arguments[1],
         .controllers = {names.substr(0, comma), names.substr(comma + 1)},
         .overrides = {"video.width_px=1280", "video.height_px=720"},
         .excerpt = {.from_s = 0.0, .to_s = count > 3 ? std::atof(arguments[3]) : 4.0},
         .look = look,
         .jobs = kCores});
    TimeVideo(video, target);
    if (!look.shadows) CompareWithBareLoop(video);
  }
  std::filesystem::remove(target);
  return 0;
}

}  // namespace
}  // namespace gauntlet::sim

int main(int count, char** arguments) { return gauntlet::sim::Main(count, arguments); }
