#include "sim/show/video/worker_process.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <functional>
#include <new>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

using Tasks = WorkerProcess::Tasks;

/// How a worker ends that gets no numbers.
std::string EndOf(const std::function<void(Tasks&)>& work) {
  WorkerProcess worker("is tested", work);
  worker.Close();
  try {
    return worker.Receive() ? "an answer" : "done";
  } catch (const UserError& error) {
    return std::string("UserError: ") + error.what();
  } catch (const RunError& error) {
    return std::string("RunError: ") + error.what();
  }
}

TEST(WorkerProcess, AnswersInAProcessOfItsOwn) {
  int seen = 0;
  WorkerProcess worker("is tested", [&](Tasks& tasks) {
    while (const auto number = tasks.Next()) tasks.Answer(seen += *number);
  });
  for (const int number : {1, -3, 40}) worker.Send(number);
  EXPECT_EQ(worker.Receive(), 1);
  EXPECT_EQ(worker.Receive(), -2);
  EXPECT_EQ(worker.Receive(), 38);
  worker.Close();
  EXPECT_EQ(worker.Receive(), std::nullopt);
  EXPECT_EQ(seen, 0);  // here nothing was changed
}

TEST(WorkerProcess, HandsOnErrorsAndHowItsProcessEnded) {
  EXPECT_EQ(EndOf([](Tasks&) {}), "done");
  EXPECT_EQ(EndOf([](Tasks&) { throw UserError("a, b"); }), "UserError: a, b");
  EXPECT_EQ(EndOf([](Tasks&) { throw RunError("c"); }), "RunError: c");
  EXPECT_EQ(EndOf([](Tasks&) { throw std::bad_alloc(); }),
            "RunError: video: not enough memory for the process that is tested");
  EXPECT_EQ(EndOf([](Tasks&) { raise(SIGSYS); }),
            "RunError: video: the process that is tested was ended by signal 31 (Bad system call)");
  EXPECT_EQ(EndOf([](Tasks&) { _exit(3); }),
            "RunError: video: the process that is tested ended with exit code 3");
}

TEST(WorkerProcess, TellsAnErrorAlsoWhenNumbersWereLeftUnread) {
  WorkerProcess worker("is tested", [](Tasks& tasks) {
    tasks.Answer(*tasks.Next());
    throw RunError("enough");
  });
  for (int number = 0; number < 5; ++number) worker.Send(number);
  EXPECT_EQ(worker.Receive(), 0);
  EXPECT_THROW(worker.Receive(), RunError);
  worker.Send(7);  // to nobody: no signal, no error
}

TEST(WorkerProcess, NamesALimitOfMemory) {
  EXPECT_EQ(EndOf([](Tasks&) {
              // In the child only, and too large for what it already has to matter.
              const rlimit limit = {1'000'000'000'000'000, 1'000'000'000'000'000};
              setrlimit(RLIMIT_AS, &limit);
              throw std::bad_alloc();
            }),
            "RunError: video: not enough memory for the process that is tested: the memory of a "
            "process is limited to 1000000000 MB (ulimit -v)");
}

TEST(WorkerProcess, LeavesSignalsToItsParentAndOpenFilesToo) {
  const int file = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 10);
  ASSERT_GE(file, 10);
  WorkerProcess worker("is tested", [&](Tasks& tasks) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) raise(signal);
    tasks.Answer(fcntl(file, F_GETFD));
  });
  EXPECT_EQ(worker.Receive(), -1);
  close(file);
}

TEST(WorkerProcess, PrintsNothingTwice) {
  std::FILE* const file = std::tmpfile();
  std::fputs("once", file);  // in the buffer only
  EXPECT_EQ(EndOf([](Tasks&) {}), "done");
  std::fflush(file);
  EXPECT_EQ(std::ftell(file), 4);
  std::fseek(file, 0, SEEK_END);
  EXPECT_EQ(std::ftell(file), 4);
  std::fclose(file);
}

TEST(WorkerProcess, IsEndedAtOnceAndLeavesNothing) {
  {
    WorkerProcess worker("is tested", [](Tasks&) { pause(); });
  }
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

TEST(WorkerProcess, EndsWithItsParent) {
  int pipe_ends[2];  // nobody has the writing end any more when all processes have ended
  ASSERT_EQ(pipe(pipe_ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    WorkerProcess worker("is tested", [](Tasks&) {});
    worker.Receive();
    // The worker closes files: this one outlives it on purpose, by standing where standard error
    // was.
    dup2(pipe_ends[1], STDERR_FILENO);
    WorkerProcess waiting("is tested", [](Tasks& tasks) {
      tasks.Answer(0);
      pause();
    });
    waiting.Receive();
    raise(SIGKILL);
  }
  close(pipe_ends[1]);
  int status = 0;
  waitpid(parent, &status, 0);
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
  pollfd end = {.fd = pipe_ends[0], .events = POLLIN, .revents = 0};
  EXPECT_EQ(poll(&end, 1, 30'000), 1);
  EXPECT_TRUE(end.revents & POLLHUP);
  close(pipe_ends[0]);
}

}  // namespace
}  // namespace gauntlet::sim
