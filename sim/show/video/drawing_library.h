#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "sim/show/video/image.h"
#include "sim/show/video/painter.h"
#include "sim/show/video/video_encoder.h"

namespace gauntlet::sim {

/// A context of OpenGL that draws into memory. Pictures are rows from the bottom, from the place
/// where MuJoCo's renderer draws.
class OffScreenContext {
 public:
  virtual ~OffScreenContext() = default;
  /// For what is drawn next. Errors: RunError.
  virtual void MakeCurrent() = 0;
  virtual void ReadColours(int width_px, int height_px, std::uint32_t* pixels) const = 0;
  virtual void ReadDepths(int width_px, int height_px, float* depths) const = 0;
};

/// Functions of Gauntlet that use OSMesa, libav and cairo, in a library of their own: these bring
/// 150 others along, which take three quarters of the time in which the program starts, and few
/// commands draw. Measured in docs/evidence/benchmarks.md. A wheel for pip finds them on the
/// system.
struct DrawingLibrary {
  std::unique_ptr<OffScreenContext> (*open_context)();
  std::unique_ptr<VideoEncoder> (*open_encoder)(const OutputFile& file, const VideoFormat& format);
  std::unique_ptr<Painter> (*open_painter)(ImageView image);
  std::string (*encode_png)(const Image& image);
};

}  // namespace gauntlet::sim

/// The library's only name.
extern "C" const gauntlet::sim::DrawingLibrary* GauntletDrawingLibrary();

namespace gauntlet::sim {

// Its own names are what it is made of.
std::unique_ptr<OffScreenContext> OpenOsmesaContext();
std::unique_ptr<VideoEncoder> OpenLibavEncoder(const OutputFile& file, const VideoFormat& format);
std::unique_ptr<Painter> OpenCairoPainter(ImageView image);
/// The content of a PNG file, transparency included. Errors: RunError.
std::string EncodeCairoPng(const Image& image);

/// Loaded when it is asked for first, for as long as the process lasts.
/// Errors: RunError if it is not there, or its libraries are not.
const DrawingLibrary& LoadDrawingLibrary();

/// The picture as a PNG file, transparency included. It appears under its name when it is whole.
/// Errors: RunError with the path and the reason.
void WritePng(const Image& image, const std::filesystem::path& target);

}  // namespace gauntlet::sim
