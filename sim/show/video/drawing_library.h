#pragma once

#include <memory>

#include "sim/show/video/off_screen_context.h"
#include "sim/show/video/video_encoder.h"

namespace gauntlet::sim {

/// Functions of Gauntlet that use OSMesa and libav, in a library of their own: OSMesa and libav
/// bring 140 others along, which take three quarters of the time in which the program starts, and
/// few commands draw. Measured in docs/evidence/benchmarks.md.
struct DrawingLibrary {
  std::unique_ptr<OffScreenContext> (*open_context)();
  std::unique_ptr<VideoEncoder> (*open_encoder)(const OutputFile& file, const VideoFormat& format);
};

}  // namespace gauntlet::sim

/// The library's only name.
extern "C" const gauntlet::sim::DrawingLibrary* GauntletDrawingLibrary();

namespace gauntlet::sim {

/// Loaded when it is asked for first, for as long as the process lasts.
/// Errors: RunError if it is not there, or its libraries are not.
const DrawingLibrary& LoadDrawingLibrary();

}  // namespace gauntlet::sim
