#pragma once

#include <functional>

#include "sim/video/image.h"

namespace gauntlet::sim {

/// Draws one frame of a video into an image that holds an earlier frame or nothing.
using FrameDrawer = std::function<void(int frame, Image& image)>;

/// Draws frames 0 .. `frame_count` - 1 on `jobs` threads and hands them over in order.
///
/// `make_drawer` runs once on each thread, so a drawer can own what belongs to one thread. `take`
/// runs on the calling thread; false stops, and so does an exception of any of the three, which is
/// thrown on here. However far ahead the threads are, at most `FramesInFlight(jobs)` images exist:
/// memory does not grow with the length of the video.
/// Returns false if `take` stopped it.
bool DrawFramesInOrder(int frame_count, int jobs, const std::function<FrameDrawer()>& make_drawer,
                       const std::function<bool(int frame, const Image& image)>& take);

/// One image per thread, and some that wait for the taker so that threads need not.
constexpr int FramesInFlight(int jobs) { return 2 * jobs + 2; }

}  // namespace gauntlet::sim
