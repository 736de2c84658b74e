#pragma once

#include <memory>
#include <string>

#include "sim/show/video/painter.h"

namespace gauntlet::sim {

/// OpenPainter() in the drawing library.
std::unique_ptr<Painter> OpenCairoPainter(ImageView image);

/// The content of a PNG file, transparency included. Errors: RunError.
std::string EncodeCairoPng(const Image& image);

}  // namespace gauntlet::sim
