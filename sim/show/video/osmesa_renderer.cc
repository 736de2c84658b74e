#include "sim/show/video/osmesa_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "sim/base/error.h"
#include "sim/show/video/drawing_library.h"

namespace gauntlet::sim {
namespace {

constexpr int kMaxGeoms = 10000;     // of one scene, decorations included
constexpr int kMaxDrawn_px = 16384;  // the rasteriser's largest picture

mjvCamera FixedCamera(int id) {
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.type = mjCAMERA_FIXED;
  camera.fixedcamid = id;
  return camera;
}

bool IsTall(const RendererConfig& config) { return config.width_px < config.height_px; }

mjvCamera CameraOf(const mjModel& model, const RendererConfig& config) {
  if (config.camera_id) return FixedCamera(*config.camera_id);
  if (const auto id = FindCamera(model, config.camera, IsTall(config))) return FixedCamera(*id);
  mjvCamera camera;
  mjv_defaultFreeCamera(&model, &camera);
  return camera;
}

/// True if the camera's field of view is meant for the height of the picture.
bool IsMadeForTall(const mjModel& model, const RendererConfig& config) {
  return FindCamera(model, config.camera, true) != FindCamera(model, config.camera, false);
}

void CheckConfig(const RendererConfig& config) {
  if (config.supersampling < 1 || config.supersampling > 8) {
    throw UserError(
        fmt::format("picture: supersampling {} is not in 1 .. 8", config.supersampling));
  }
  if (config.sides < 4 || config.sides > 256) {
    throw UserError(fmt::format("picture: sides {} is not in 4 .. 256", config.sides));
  }
  const int largest = kMaxDrawn_px / config.supersampling;
  for (int side : {config.width_px, config.height_px}) {
    if (side < 1 || side > largest) {
      throw UserError(fmt::format("picture: a side of {} px is not in 1 .. {} px", side, largest));
    }
  }
}

/// Mean of n x n pixels, channel by channel, rounded; two channels at a time in one word.
std::uint32_t MeanPixel(const std::uint32_t* corner, int stride, int n) {
  std::uint32_t red_blue = 0, alpha_green_low = 0, alpha_high = 0;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const std::uint32_t pixel = corner[y * stride + x];
      red_blue += pixel & 0x00ff00ffu;
      alpha_green_low += (pixel >> 8) & 0xffu;
      alpha_high += pixel >> 24;
    }
  }
  const std::uint32_t count = static_cast<std::uint32_t>(n * n), half = count / 2;
  const auto mean = [&](std::uint32_t sum) { return (sum + half) / count; };
  return mean(alpha_high) << 24 | mean(red_blue >> 16) << 16 | mean(alpha_green_low) << 8 |
         mean(red_blue & 0xffffu);
}

/// The usual case of MeanPixel, n = 2, for a whole row; without a division it is vectorised.
void HalveRow(const std::uint32_t* upper, const std::uint32_t* lower, int width,
              std::uint32_t* out) {
  constexpr std::uint32_t kMask = 0x00ff00ffu, kHalf = 0x00020002u;
  for (int x = 0; x < width; ++x) {
    const std::uint32_t a = upper[2 * x], b = upper[2 * x + 1];
    const std::uint32_t c = lower[2 * x], d = lower[2 * x + 1];
    const std::uint32_t even = (a & kMask) + (b & kMask) + (c & kMask) + (d & kMask) + kHalf;
    const std::uint32_t odd =
        ((a >> 8) & kMask) + ((b >> 8) & kMask) + ((c >> 8) & kMask) + ((d >> 8) & kMask) + kHalf;
    out[x] = ((even >> 2) & kMask) | (((odd >> 2) & kMask) << 8);
  }
}

}  // namespace

struct OsmesaRenderer::Context {
  const mjModel& model;
  RendererConfig config;
  mjvCamera camera;
  mjvOption option;
  mjvScene scene;
  mjrContext drawing;
  std::unique_ptr<OffScreenContext> off_screen;
  std::vector<std::uint32_t> drawn;  // supersampled, rows from the bottom
  std::vector<float> depth;

  Context(const mjModel& given_model, const RendererConfig& given_config)
      : model(given_model), config(given_config), camera(CameraOf(given_model, given_config)) {
    mjv_defaultOption(&option);
    mjv_defaultScene(&scene);
    mjr_defaultContext(&drawing);
  }

  ~Context() {
    if (TryMakeCurrent()) mjr_freeContext(&drawing);
    mjv_freeScene(&scene);
  }

  /// False where it cannot be made so.
  bool TryMakeCurrent() const {
    if (!off_screen) return false;
    try {
      off_screen->MakeCurrent();
      return true;
    } catch (const RunError&) {
      return false;
    }
  }

  int drawn_width() const { return config.width_px * config.supersampling; }
  int drawn_height() const { return config.height_px * config.supersampling; }

  void Open() {
    off_screen = LoadDrawingLibrary().open_context();
    off_screen->MakeCurrent();
    // The sizes of buffers are part of the model: set them in a copy, which is not kept.
    const std::unique_ptr<mjModel, void (*)(mjModel*)> copy(mj_copyModel(nullptr, &model),
                                                            &mj_deleteModel);
    copy->vis.global.offwidth = drawn_width();
    copy->vis.global.offheight = drawn_height();
    copy->vis.quality.offsamples = 0;
    copy->vis.quality.shadowsize = config.shadows ? config.shadow_map_px : 0;
    copy->vis.quality.numslices = config.sides;
    copy->vis.quality.numstacks = config.sides / 2;
    copy->vis.quality.numquads = 1;  // more are for spot lights on large faces
    mjr_makeContext(copy.get(), &drawing, mjFONTSCALE_100);
    mjr_setBuffer(mjFB_OFFSCREEN, &drawing);
    if (drawing.currentBuffer != mjFB_OFFSCREEN || mjr_getError() != 0) {
      throw RunError(fmt::format("video: OSMesa cannot make an off-screen buffer of {} x {} px",
                                 drawn_width(), drawn_height()));
    }
    mjv_makeScene(&model, &scene, kMaxGeoms);
  }

  void UpdateScene(mjData& data, const std::vector<bool>* only, const SceneColours& colours) {
    mjv_updateScene(&model, &data, &option, nullptr, &camera, mjCAT_ALL, &scene);
    scene.flags[mjRND_SHADOW] = config.shadows;
    scene.flags[mjRND_REFLECTION] = 0;  // draws everything twice
    scene.flags[mjRND_SKYBOX] = 0;      // the background is the caller's
    scene.flags[mjRND_HAZE] = 0;
    if (!config.ground) RemovePlanes(scene);
    if (only != nullptr) KeepBodies(scene, model, *only);
    if (config.plain_cables) FlattenCables(scene);
    ColourScene(scene, model, colours);
    if (config.window) {
      ShowWindow(scene, *config.window);
    } else if (IsTall(config) && !IsMadeForTall(model, config)) {
      WidenView(scene, static_cast<double>(config.height_px) / config.width_px);
    }
    if (!config.shadows) RemoveOutOfSight(scene, config.width_px, config.height_px);
  }

  /// Repairs the alpha where a translucent shape lies over an opaque one, since blending leaves it
  /// below 1. There the depth says that the pixel is covered. Over the background the colour bounds
  /// the alpha from below.
  void RepairAlpha() {
    const bool translucent = std::any_of(scene.geoms, scene.geoms + scene.ngeom,
                                         [](const mjvGeom& geom) { return geom.rgba[3] < 1.0f; });
    if (!translucent) return;
    depth.resize(drawn.size());
    off_screen->ReadDepths(drawn_width(), drawn_height(), depth.data());
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const std::uint32_t pixel = drawn[i];
      const std::uint32_t bound =
          std::max({pixel & 0xffu, (pixel >> 8) & 0xffu, (pixel >> 16) & 0xffu, pixel >> 24});
      drawn[i] = (pixel & 0x00ffffffu) | (depth[i] < 1.0f ? 0xffu : bound) << 24;
    }
  }

  /// From rows counted from the bottom to rows counted from the top, at the size asked for.
  void Shrink(Image& picture) const {
    const int n = config.supersampling, stride = drawn_width();
    for (int y = 0; y < config.height_px; ++y) {
      const std::uint32_t* source =
          drawn.data() + std::ptrdiff_t{config.height_px - 1 - y} * n * stride;
      std::uint32_t* out = picture.Row(y);
      if (n == 1) {
        std::copy_n(source, config.width_px, out);
      } else if (n == 2) {
        HalveRow(source, source + stride, config.width_px, out);
      } else {
        for (int x = 0; x < config.width_px; ++x) out[x] = MeanPixel(source + x * n, stride, n);
      }
    }
  }

  void Draw(mjData& data, const std::vector<bool>* only, const SceneColours& colours,
            Image& picture) {
    off_screen->MakeCurrent();
    UpdateScene(data, only, colours);
    mjr_render({0, 0, drawn_width(), drawn_height()}, &scene, &drawing);
    drawn.resize(std::ptrdiff_t{drawn_width()} * drawn_height());
    off_screen->ReadColours(drawn_width(), drawn_height(), drawn.data());
    RepairAlpha();
    if (picture.width_px != config.width_px || picture.height_px != config.height_px) {
      picture = Image(config.width_px, config.height_px);
    }
    Shrink(picture);
  }
};

OsmesaRenderer::OsmesaRenderer(const mjModel& model, const RendererConfig& config) {
  CheckConfig(config);
  context_ = std::make_unique<Context>(model, config);
  context_->Open();
}

OsmesaRenderer::~OsmesaRenderer() = default;

void OsmesaRenderer::Draw(mjData& data, Image& picture, const SceneColours& colours) {
  context_->Draw(data, nullptr, colours, picture);
}

void OsmesaRenderer::SetWindow(const std::optional<CameraWindow>& window) {
  context_->config.window = window;
}

void OsmesaRenderer::DrawBodies(mjData& data, const std::vector<bool>& chosen, Image& picture) {
  context_->Draw(data, &chosen, {}, picture);
}

}  // namespace gauntlet::sim
