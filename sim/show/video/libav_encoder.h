#pragma once

#include "sim/show/video/video_encoder.h"

namespace gauntlet::sim {

/// OpenVideo() in the drawing library.
std::unique_ptr<VideoEncoder> OpenLibavEncoder(const OutputFile& file, const VideoFormat& format);

}  // namespace gauntlet::sim
