#include "sim/show/video/ordered_frames.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

#include "sim/base/error.h"

namespace gauntlet::sim {

/// Images that this process and its children share: frame k lives in image k mod size, from when it
/// is given to a process that draws until it has been taken.
class SharedImages {
 public:
  SharedImages(int count, const FramePlan& plan) : count_(count), plan_(plan) {
    void* memory =
        mmap(nullptr, Bytes(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
      throw RunError(fmt::format("video: no memory for {} pictures of {} x {} px: {}", count_,
                                 plan_.width_px, plan_.height_px, std::strerror(errno)));
    }
    pixels_ = static_cast<std::uint32_t*>(memory);
  }
  ~SharedImages() { munmap(pixels_, Bytes()); }
  SharedImages(const SharedImages&) = delete;
  SharedImages& operator=(const SharedImages&) = delete;

  int count() const { return count_; }
  ImageView ImageOf(int frame) const {
    return {plan_.width_px, plan_.height_px, pixels_ + frame % count_ * PixelsOfOne()};
  }

 private:
  std::size_t PixelsOfOne() const { return std::size_t{1} * plan_.width_px * plan_.height_px; }
  std::size_t Bytes() const { return count_ * PixelsOfOne() * sizeof(std::uint32_t); }

  int count_;
  FramePlan plan_;
  std::uint32_t* pixels_ = nullptr;
};

namespace {

constexpr int kMostTasks = 2;  // of one process: what it is at, and the next

struct Drawer {
  explicit Drawer(const std::function<void(WorkerProcess::Tasks&)>& work)
      : process("draws", work) {}

  WorkerProcess process;
  int tasks = 0;
};

/// Gives frames to the processes that draw, and from them to the one that takes.
class Schedule {
 public:
  Schedule(const FramePlan& plan, int jobs, const std::function<void(Frames&)>& draw,
           const std::function<void(Frames&)>& take)
      : frame_count_(plan.frame_count),
        images_(FramesInFlight(jobs), plan),
        drawn_(images_.count(), false),
        taker_("encodes", WorkOn(take)) {
    const auto draw_frames = WorkOn(draw);
    while (std::ssize(drawers_) < jobs) {
      try {
        drawers_.push_back(std::make_unique<Drawer>(draw_frames));
      } catch (const RunError&) {
        if (drawers_.empty()) throw;
        break;  // the pixels do not depend on how many there are
      }
    }
  }

  bool Run(const std::function<bool(int)>& keep_going) {
    while (!finished_) {
      HandOut();
      const int taken_before = taken_;
      const bool answered = WaitForAnswers();
      if ((!answered || taken_ > taken_before) && !keep_going(taken_)) return false;
    }
    return true;
  }

 private:
  std::function<void(WorkerProcess::Tasks&)> WorkOn(const std::function<void(Frames&)>& work) {
    return [this, &work](WorkerProcess::Tasks& tasks) {
      Frames frames(tasks, images_);
      work(frames);
    };
  }

  /// Every process gets what it may have.
  void HandOut() {
    while (given_ < frame_count_ && given_ - taken_ < images_.count()) {
      Drawer& idlest = **std::ranges::min_element(
          drawers_, {}, [](const std::unique_ptr<Drawer>& drawer) { return drawer->tasks; });
      if (idlest.tasks == kMostTasks) break;
      idlest.process.Send(given_++);
      ++idlest.tasks;
    }
    while (offered_ < given_ && drawn_[offered_ % images_.count()] &&
           offered_ - taken_ < kMostTasks) {
      taker_.Send(offered_++);
    }
    if (offered_ == frame_count_) taker_.Close();
  }

  /// At most one answer of each process. False: a signal came first.
  bool WaitForAnswers() {
    std::vector<pollfd> ends = {{.fd = taker_.descriptor(), .events = POLLIN, .revents = 0}};
    for (const auto& drawer : drawers_) {
      ends.push_back({.fd = drawer->process.descriptor(), .events = POLLIN, .revents = 0});
    }
    if (poll(ends.data(), ends.size(), -1) < 0) return false;
    for (std::size_t i = 0; i < drawers_.size(); ++i) {
      if (ends[i + 1].revents == 0) continue;
      drawn_[drawers_[i]->process.Receive().value() % images_.count()] = true;
      --drawers_[i]->tasks;
    }
    if (ends[0].revents != 0) {
      if (const std::optional<int> frame = taker_.Receive()) {
        drawn_[*frame % images_.count()] = false;
        ++taken_;
      } else {
        finished_ = true;
      }
    }
    return true;
  }

  const int frame_count_;
  SharedImages images_;
  std::vector<bool> drawn_;  // per image
  WorkerProcess taker_;
  std::vector<std::unique_ptr<Drawer>> drawers_;
  int given_ = 0;    // frames given to processes that draw
  int offered_ = 0;  // of these, to the taker
  int taken_ = 0;    // of these, those that it is done with
  bool finished_ = false;
};

}  // namespace

std::optional<VideoFrame> Frames::Next() {
  if (current_) tasks_.Answer(*current_);
  current_ = tasks_.Next();
  if (!current_) return std::nullopt;
  return VideoFrame{.number = *current_, .image = images_.ImageOf(*current_)};
}

bool DrawFramesInOrder(const FramePlan& plan, const std::function<void(Frames&)>& draw,
                       const std::function<void(Frames&)>& take,
                       const std::function<bool(int)>& keep_going) {
  const int jobs = std::clamp(plan.jobs, 1, std::max(1, plan.frame_count));
  return Schedule(plan, jobs, draw, take).Run(keep_going);
}

}  // namespace gauntlet::sim
