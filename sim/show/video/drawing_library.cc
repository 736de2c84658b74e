#include "sim/show/video/drawing_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/output_file.h"

namespace gauntlet::sim {

const DrawingLibrary& LoadDrawingLibrary() {
  static const DrawingLibrary& library = []() -> const DrawingLibrary& {
    // MuJoCo's renderer looks for OSMesa among the names that the whole process has.
    const std::string file = OwnLibrary("gauntlet_drawing.so");
    void* const loaded = dlopen(file.c_str(), RTLD_LAZY | RTLD_GLOBAL);
    if (loaded == nullptr) {
      throw RunError(fmt::format(
          "cannot draw: {}: pictures and videos need OSMesa, cairo and FFmpeg as the system "
          "has them on which Gauntlet was built",
          dlerror()));
    }
    void* const entry = dlsym(loaded, "GauntletDrawingLibrary");
    if (entry == nullptr) throw RunError(fmt::format("cannot draw: {}", dlerror()));
    return *reinterpret_cast<decltype(&GauntletDrawingLibrary)>(entry)();
  }();
  return library;
}

std::unique_ptr<Painter> OpenPainter(ImageView image) {
  return LoadDrawingLibrary().open_painter(image);
}

std::unique_ptr<VideoEncoder> OpenVideo(const OutputFile& file, const VideoFormat& format) {
  return LoadDrawingLibrary().open_encoder(file, format);
}

void WritePng(const Image& image, const std::filesystem::path& target) {
  WriteOutputFile(target, LoadDrawingLibrary().encode_png(image));
}

}  // namespace gauntlet::sim
