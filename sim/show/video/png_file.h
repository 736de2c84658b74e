#pragma once

#include <filesystem>

#include "sim/show/video/image.h"

namespace gauntlet::sim {

/// The picture as a PNG file, transparency included. It appears under its name when it is whole.
/// Errors: RunError with the path and the reason.
void WritePng(const Image& image, const std::filesystem::path& target);

}  // namespace gauntlet::sim
