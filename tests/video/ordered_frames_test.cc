#include "sim/show/video/ordered_frames.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <new>
#include <thread>

#include "sim/base/error.h"
#include "tests/video/test_files.h"

namespace gauntlet::sim {
namespace {

/// A number that this process and its children share.
class SharedNumber {
 public:
  SharedNumber()
      : number_(new (mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE,
                          MAP_SHARED | MAP_ANONYMOUS, -1, 0)) std::atomic<int>(0)) {}
  ~SharedNumber() { munmap(number_, sizeof(std::atomic<int>)); }
  SharedNumber(const SharedNumber&) = delete;
  SharedNumber& operator=(const SharedNumber&) = delete;
  std::atomic<int>& operator*() const { return *number_; }

 private:
  std::atomic<int>* number_;
};

FramePlan SmallFrames(int frame_count, int jobs) {
  return {.frame_count = frame_count, .width_px = 3, .height_px = 2, .jobs = jobs};
}

/// Writes its number into the image, after a while that differs from frame to frame.
void DrawNumbers(Frames& frames) {
  while (const auto frame = frames.Next()) {
    std::this_thread::sleep_for(std::chrono::microseconds(200 * (frame->number * 7 % 5)));
    for (int i = 0; i < 6; ++i) frame->image.pixels[i] = 10 * frame->number + i;
  }
}

void TakeAll(Frames& frames) {
  while (frames.Next()) {
  }
}

bool GoOn(int) { return true; }

bool HasChildren() { return waitpid(-1, nullptr, WNOHANG) >= 0 || errno != ECHILD; }

TEST(OrderedFrames, HandsOverEveryFrameOnceInOrder) {
  for (const int jobs : {1, 2, 5, 20}) {
    int calls = 0;
    const auto take = [](Frames& frames) {
      int expected = 0;
      for (; const auto frame = frames.Next(); ++expected) {
        if (frame->number != expected) throw RunError("another frame");
        for (int i = 0; i < 6; ++i) {
          if (static_cast<int>(frame->image.pixels[i]) != 10 * expected + i) {
            throw RunError("another image");
          }
        }
      }
      if (expected != 100) throw RunError("another number of frames");
    };
    EXPECT_TRUE(DrawFramesInOrder(SmallFrames(100, jobs), DrawNumbers, take, [&](int taken) {
      EXPECT_EQ(taken, ++calls);
      return true;
    }));
    EXPECT_EQ(calls, 100);
    EXPECT_FALSE(HasChildren());
  }
}

TEST(OrderedFrames, AVideoOfNothingEndsAtOnce) {
  EXPECT_TRUE(DrawFramesInOrder(SmallFrames(0, 2), DrawNumbers, TakeAll, GoOn));
}

TEST(OrderedFrames, NeverHoldsMoreFramesThanPromised) {
  constexpr int kJobs = 3, kFrames = 200;
  const SharedNumber begun, taken, most;
  DrawFramesInOrder(
      SmallFrames(kFrames, kJobs),
      [&](Frames& frames) {
        while (frames.Next()) ++*begun;
      },
      [&](Frames& frames) {
        while (frames.Next()) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));  // slower than the drawers
          *most = std::max<int>(*most, *begun - *taken);
          ++*taken;
        }
      },
      GoOn);
  EXPECT_EQ(*taken, kFrames);
  EXPECT_LE(*most, FramesInFlight(kJobs));
  EXPECT_GT(*most, kJobs);  // and the drawers do run ahead
}

TEST(OrderedFrames, EveryDrawerHasAProcessWithOneThread) {
  const SharedNumber processes, with_one_thread;
  DrawFramesInOrder(
      SmallFrames(50, 3),
      [&](Frames& frames) {
        ++*processes;
        int threads = 0;
        for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
          (void)thread;
          ++threads;
        }
        if (threads == kOneThread) ++*with_one_thread;
        DrawNumbers(frames);
      },
      TakeAll, GoOn);
  EXPECT_EQ(*processes, 3);
  EXPECT_EQ(*with_one_thread, 3);
}

TEST(OrderedFrames, StopsWhenItIsTold) {
  const SharedNumber begun;
  int calls = 0;
  const bool complete = DrawFramesInOrder(
      SmallFrames(100000, 2),
      [&](Frames& frames) {
        while (frames.Next()) ++*begun;
      },
      TakeAll, [&](int) { return ++calls < 10; });
  EXPECT_FALSE(complete);
  EXPECT_EQ(calls, 10);
  EXPECT_LE(*begun, 10 + FramesInFlight(2));
  EXPECT_FALSE(HasChildren());
}

TEST(OrderedFrames, PassesOnWhatGoesWrongWhereverItDoes) {
  const auto message_of = [](const std::function<void(Frames&)>& draw,
                             const std::function<void(Frames&)>& take) -> std::string {
    try {
      DrawFramesInOrder(SmallFrames(50, 2), draw, take, GoOn);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message_of([](Frames&) { throw RunError("no context"); }, TakeAll), "no context");
  EXPECT_EQ(message_of(
                [](Frames& frames) {
                  while (const auto frame = frames.Next()) {
                    if (frame->number == 7) throw UserError("no frame");
                  }
                },
                TakeAll),
            "no frame");
  EXPECT_EQ(message_of(DrawNumbers,
                       [](Frames& frames) {
                         frames.Next();
                         throw RunError("full");
                       }),
            "full");
  EXPECT_EQ(message_of([](Frames&) { raise(SIGSYS); }, TakeAll),
            "video: the process that draws was ended by signal 31 (Bad system call)");
  EXPECT_EQ(message_of(DrawNumbers,
                       [](Frames& frames) {
                         while (frames.Next()) raise(SIGKILL);
                       }),
            "video: the process that encodes was ended by signal 9 (Killed); the system does so "
            "when memory runs out");
  EXPECT_FALSE(HasChildren());
}

TEST(OrderedFrames, SaysThatThereIsNoMemoryForItsImages) {
  FramePlan plan = SmallFrames(1, 1);
  plan.width_px = plan.height_px = 2'000'000;
  EXPECT_THROW(DrawFramesInOrder(plan, DrawNumbers, TakeAll, GoOn), RunError);
}

}  // namespace
}  // namespace gauntlet::sim
