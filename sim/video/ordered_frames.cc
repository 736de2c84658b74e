#include "sim/video/ordered_frames.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace gauntlet::sim {
namespace {

/// A ring of images: frame k lives in image k mod size, from when a thread takes it up until it has
/// been taken.
class Ring {
 public:
  Ring(int frame_count, int size) : frame_count_(frame_count), images_(size), drawn_(size, false) {}

  Image& ImageOf(int frame) { return images_[frame % images_.size()]; }

  /// The next frame to be drawn; -1 if there is nothing more to do.
  int Begin() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] {
      return stopped_ || next_ == frame_count_ || next_ < taken_ + static_cast<int>(images_.size());
    });
    return stopped_ || next_ == frame_count_ ? -1 : next_++;
  }

  void MarkDrawn(int frame) {
    const std::lock_guard lock(mutex_);
    drawn_[frame % drawn_.size()] = true;
    changed_.notify_all();
  }

  /// Until `frame` is drawn; throws what went wrong on a thread instead.
  void WaitFor(int frame) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return problem_ != nullptr || drawn_[frame % drawn_.size()]; });
    if (problem_ != nullptr) std::rethrow_exception(problem_);
  }

  void MarkTaken(int frame) {
    const std::lock_guard lock(mutex_);
    drawn_[frame % drawn_.size()] = false;
    taken_ = frame + 1;
    changed_.notify_all();
  }

  void Stop(std::exception_ptr problem) {
    const std::lock_guard lock(mutex_);
    if (problem_ == nullptr) problem_ = std::move(problem);
    stopped_ = true;
    changed_.notify_all();
  }

 private:
  const int frame_count_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Image> images_;
  std::vector<bool> drawn_;
  int next_ = 0;
  int taken_ = 0;
  bool stopped_ = false;
  std::exception_ptr problem_;
};

void DrawUntilDone(Ring& ring, const std::function<FrameDrawer()>& make_drawer) {
  try {
    const FrameDrawer draw = make_drawer();
    for (int frame = ring.Begin(); frame >= 0; frame = ring.Begin()) {
      draw(frame, ring.ImageOf(frame));
      ring.MarkDrawn(frame);
    }
  } catch (...) {
    ring.Stop(std::current_exception());
  }
}

struct StopAtEnd {
  Ring& ring;
  ~StopAtEnd() { ring.Stop(nullptr); }
};

}  // namespace

bool DrawFramesInOrder(int frame_count, int jobs, const std::function<FrameDrawer()>& make_drawer,
                       const std::function<bool(int, const Image&)>& take) {
  jobs = std::clamp(jobs, 1, std::max(1, frame_count));
  Ring ring(frame_count, FramesInFlight(jobs));
  std::vector<std::jthread> threads;
  const StopAtEnd stop_at_end{ring};  // goes before the threads, which are joined then
  for (int job = 0; job < jobs; ++job) {
    threads.emplace_back([&] { DrawUntilDone(ring, make_drawer); });
  }
  for (int frame = 0; frame < frame_count; ++frame) {
    ring.WaitFor(frame);
    if (!take(frame, ring.ImageOf(frame))) return false;
    ring.MarkTaken(frame);
  }
  return true;
}

}  // namespace gauntlet::sim
