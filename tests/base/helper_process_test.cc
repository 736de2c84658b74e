// Whatever the helper does, the program goes on and knows what happened.
#include "sim/base/helper_process.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

using Send = HelperProcess::Send;
using testing::HasSubstr;

/// What `work` sends, ten bytes, or why there is nothing.
std::string Result(const std::function<void(const Send&)>& work, const HelperLimits& limits = {}) {
  try {
    HelperProcess helper(work, limits);
    std::string bytes(10, '\0');
    helper.Receive(bytes);
    helper.Finish();
    return bytes;
  } catch (const HelperEnded& ended) {
    return std::string("ended: ") + ended.what();
  } catch (const HelperError& error) {
    return std::string("error: ") + error.what();
  }
}

TEST(HelperProcess, GivesWhatTheWorkSends) {
  EXPECT_EQ(Result([](const Send& send) {
              send(std::string("01234"));
              send(std::string());
              send(std::string("56789"));
            }),
            "0123456789");
}

// SIGSYS is one that the address sanitizer leaves alone.
TEST(HelperProcess, TellsHowTheWorkEnded) {
  EXPECT_THAT(Result([](const Send&) { std::raise(SIGSYS); }), HasSubstr("signal 31"));
  EXPECT_THAT(Result([](const Send&) { std::abort(); }), HasSubstr("ended: ended"));
  EXPECT_EQ(Result([](const Send&) { _exit(0); }), "ended: ended too early");
  EXPECT_EQ(Result([](const Send& send) { send(std::string("short")); }), "ended: ended too early");
  EXPECT_EQ(Result([](const Send& send) { send(std::string("much too long")); }),
            "ended: gave more than it should");
  EXPECT_EQ(Result([](const Send&) { throw UserError("is no good"); }), "error: is no good");
}

TEST(HelperProcess, EndsWorkThatTakesTooLong) {
  EXPECT_EQ(Result(
                [](const Send&) {
                  while (getppid() != 0) continue;
                },
                {.processor_s = 0.1}),
            "ended: took more than 0.1 s of processor time");
  EXPECT_THROW(Result([](const Send&) { pause(); }, {.silence_s = 1}), HelperSilent);
}

// As one that waits for each block of a file on a slow disk.
TEST(HelperProcess, HasTimeWhileItMakesProgress) {
  const auto waits = [](double work_s) {
    return [work_s](const Send& send) {
      for (int block = 0; block < 16; ++block) {
        usleep(100'000);
        const std::clock_t begin = std::clock();
        while (static_cast<double>(std::clock() - begin) < work_s * CLOCKS_PER_SEC) continue;
      }
      send(std::string("0123456789"));
    };
  };
  EXPECT_EQ(Result(waits(5e-3), {.silence_s = 1}), "0123456789");
  EXPECT_THROW(Result(waits(0.0), {.silence_s = 1}), HelperSilent);
}

TEST(HelperProcess, CanDoLittle) {
  static const int other = fcntl(STDIN_FILENO, F_DUPFD, 50);
  EXPECT_EQ(Result([](const Send& send) {
              std::string found(10, '-');
              if (fcntl(other, F_GETFD) >= 0) found[0] = 'd';  // descriptor of the program
              char name[] = "/tmp/gauntlet-helper-XXXXXX";
              if (const int file = mkstemp(name); file >= 0) {
                std::signal(SIGXFSZ, SIG_IGN);
                if (write(file, "x", 1) == 1) found[1] = 'w';
                unlink(name);
              }
              OpenNoMoreFiles();
              if (open("/dev/null", O_RDONLY) >= 0) found[2] = 'o';
              send(found);
            }),
            "----------");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(HelperProcess, CannotTakeAllMemory) {
  EXPECT_EQ(Result(
                [](const Send& send) {
                  std::vector<std::string> hoard;
                  for (int i = 0; i < 1000; ++i) hoard.emplace_back(1'000'000, 'x');
                  send(hoard.front());
                },
                {.memory_bytes = 100 << 20}),
            "error: takes more than 100 MB of memory");
}
#endif

/// Says which process works, then sleeps.
void SendOwnId(const Send& send) {
  const pid_t self = getpid();
  send({reinterpret_cast<const char*>(&self), sizeof self});
  pause();
}

TEST(HelperProcess, GoesWithTheProgram) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // the helper of a program that is gone is ours
  std::array<int, 2> ends = {};
  ASSERT_EQ(pipe(ends.data()), 0);
  const pid_t program = fork();
  if (program == 0) {
    HelperProcess helper(SendOwnId, {});
    std::array<char, sizeof(pid_t)> id = {};
    helper.Receive(id);
    if (write(ends[1], id.data(), id.size()) > 0) std::raise(SIGKILL);
    _exit(1);
  }
  pid_t helper = 0;
  ASSERT_EQ(read(ends[0], &helper, sizeof helper), ssize_t{sizeof helper});
  waitpid(program, nullptr, 0);
  int status = 0;
  EXPECT_EQ(waitpid(helper, &status, 0), helper);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  for (const int end : ends) close(end);
}

TEST(HelperProcess, EndsWhenTheUserWantsIt) {
  pid_t helper_id = 0;
  EXPECT_THROW(
      {
        HelperProcess helper(SendOwnId, {}, [&] { return helper_id == 0; });
        helper.Receive({reinterpret_cast<char*>(&helper_id), sizeof helper_id});
        helper.Finish();
      },
      Cancelled);
  EXPECT_EQ(kill(helper_id, 0), -1);
  EXPECT_EQ(errno, ESRCH);
}

}  // namespace
}  // namespace gauntlet::sim
