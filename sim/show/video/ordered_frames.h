#pragma once

#include <functional>
#include <optional>

#include "sim/show/video/image.h"
#include "sim/show/video/worker_process.h"

namespace gauntlet::sim {

/// A frame of a video: its number, and the image that it is drawn into or was drawn into. A drawer
/// finds an earlier frame there, or nothing.
struct VideoFrame {
  int number = 0;
  ImageView image;
};

class SharedImages;

/// Tasks of one process, frame after frame.
class Frames {
 public:
  Frames(WorkerProcess::Tasks& tasks, const SharedImages& images)
      : tasks_(tasks), images_(images) {}

  /// The next one; the one before is done then. None: there are no more.
  std::optional<VideoFrame> Next();

 private:
  WorkerProcess::Tasks& tasks_;
  const SharedImages& images_;
  std::optional<int> current_;
};

struct FramePlan {
  int frame_count = 0;
  int width_px = 0;
  int height_px = 0;
  int jobs = 1;  // processes that draw
};

/// Draws frames 0 .. `frame_count` - 1 in `jobs` processes, and hands them over in order to one
/// more.
///
/// `draw` runs in each process that draws and gets some of the frames; `take` runs in one process
/// and gets them all. Both return when there are no more. They see what this process knew before,
/// and nothing here sees what they change: each library has its state to itself. Images lie in
/// memory that all processes share; however far ahead the drawing is, there are at most
/// `FramesInFlight(jobs)`, so memory does not grow with the length of the video.
///
/// `keep_going` gets the number of frames taken, after each one and at each signal; false stops,
/// and the function returns false. Errors: those of `draw` and `take`, as WorkerProcess hands them
/// on.
bool DrawFramesInOrder(const FramePlan& plan, const std::function<void(Frames&)>& draw,
                       const std::function<void(Frames&)>& take,
                       const std::function<bool(int taken)>& keep_going);

/// Two per process that draws, the one that it draws and the next, and two for the taker.
constexpr int FramesInFlight(int jobs) { return 2 * jobs + 2; }

}  // namespace gauntlet::sim
