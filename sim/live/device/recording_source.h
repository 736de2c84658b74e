#pragma once

#include <memory>

#include "sim/live/device/frame_source.h"

namespace gauntlet::sim {

/// The rows of a recording as frames, at the times of its time column or at a rate. The formats are
/// those of TableSource().
/// Errors: UserError of the file; one if it has neither a time nor a rate.
std::unique_ptr<FrameSource> OpenRecordingSource(const DeviceAddress& address,
                                                 const SourceOptions& options);

}  // namespace gauntlet::sim
