#include <GL/gl.h>
#include <GL/osmesa.h>

#include <array>
#include <cstdlib>

#include "sim/base/error.h"
#include "sim/show/video/drawing_library.h"

namespace gauntlet::sim {
namespace {

class OsmesaContext final : public OffScreenContext {
 public:
  OsmesaContext() {
    constexpr int kAttributes[] = {OSMESA_FORMAT,
                                   OSMESA_RGBA,
                                   OSMESA_DEPTH_BITS,
                                   24,
                                   OSMESA_STENCIL_BITS,
                                   8,
                                   OSMESA_PROFILE,
                                   OSMESA_COMPAT_PROFILE,
                                   0};
    context_ = OSMesaCreateContextAttribs(kAttributes, nullptr);
    if (context_ == nullptr) throw RunError("video: OSMesa cannot make an off-screen context");
  }
  ~OsmesaContext() override { OSMesaDestroyContext(context_); }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  void MakeCurrent() override {
    if (OSMesaGetCurrentContext() == context_) return;
    if (!OSMesaMakeCurrent(context_, placeholder_.data(), GL_UNSIGNED_BYTE, kSide, kSide)) {
      throw RunError("video: OSMesa cannot use its off-screen context");
    }
  }

  void ReadColours(int width_px, int height_px, std::uint32_t* pixels) const override {
    glReadPixels(0, 0, width_px, height_px, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, pixels);
  }

  void ReadDepths(int width_px, int height_px, float* depths) const override {
    glReadPixels(0, 0, width_px, height_px, GL_DEPTH_COMPONENT, GL_FLOAT, depths);
  }

 private:
  static constexpr int kSide = 16;  // of the context's own buffer, never drawn into

  OSMesaContext context_ = nullptr;
  std::array<std::uint8_t, kSide * kSide * 4> placeholder_{};
};

}  // namespace

std::unique_ptr<OffScreenContext> OpenOsmesaContext() {
  // The rasteriser draws on the thread that asks for it: several drawings at once use the cores
  // better than several threads in one. Its cache of shaders would have a thread of its own, too.
  setenv("LP_NUM_THREADS", "0", /*overwrite=*/1);
  setenv("MESA_SHADER_CACHE_DISABLE", "true", /*overwrite=*/1);
  return std::make_unique<OsmesaContext>();
}

}  // namespace gauntlet::sim
