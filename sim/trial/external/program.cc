#include "sim/trial/external/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongestAnswer = 1 << 20;
constexpr std::size_t kLongestTail = 4096;              // of standard error
constexpr auto kLook = std::chrono::milliseconds(100);  // between two looks at the stop signal
constexpr auto kFarewell = std::chrono::milliseconds(200);
constexpr const char* kWithoutSample = "answered more than it was asked";
constexpr int kCannotStart = 127;  // an exit code of shells

std::string SystemReason() { return std::strerror(errno); }

/// Behind the three standard streams, which may be closed in this program.
int BehindStreams(int descriptor) {
  if (descriptor > STDERR_FILENO) return descriptor;
  const int moved = fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  const int reason = errno;
  close(descriptor);
  errno = reason;
  return moved;
}

void DoNotBlock(int descriptor) {
  fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) | O_NONBLOCK);
}

}  // namespace

void Program::End::Set(int descriptor) {
  Close();
  descriptor_ = descriptor;
}

int Program::End::Release() { return std::exchange(descriptor_, -1); }

void Program::End::Close() {
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
}

struct Program::Pipe {
  Pipe() {
    std::array<int, 2> ends = {-1, -1};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw RunError(fmt::format("cannot be started: {}", SystemReason()));
    }
    read.Set(BehindStreams(ends[0]));
    write.Set(BehindStreams(ends[1]));
    if (read.get() < 0 || write.get() < 0) {
      throw RunError(fmt::format("cannot be started: {}", SystemReason()));
    }
  }
  End read;
  End write;
};

Program::Program(const ProgramCommand& command) {
  // All that the child needs is made before it: behind a fork of one thread of several, it may
  // neither allocate nor take a lock.
  Pipe to_child;
  Pipe from_child;
  Pipe errors;
  std::vector<char*> words;
  for (const std::string& word : command.words) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const auto become_program = [&] {
    setpgid(0, 0);
    std::signal(SIGPIPE, SIG_DFL);
    std::signal(SIGXFSZ, SIG_DFL);
    const bool has_streams = dup2(to_child.read.get(), STDIN_FILENO) >= 0 &&
                             dup2(from_child.write.get(), STDOUT_FILENO) >= 0 &&
                             dup2(errors.write.get(), STDERR_FILENO) >= 0;
    const bool is_there = has_streams && chdir(command.folder.c_str()) == 0;
    close_range(STDERR_FILENO + 1, ~0U, 0);
    if (is_there) execv(command.program.c_str(), words.data());
    const char* const reason = strerrordesc_np(errno);
    if (write(STDERR_FILENO, reason, std::strlen(reason)) < 0) _exit(kCannotStart);
    _exit(kCannotStart);
  };
  try {
    child_ = std::make_unique<ChildProcess>(become_program);
  } catch (const std::system_error& error) {
    throw RunError(fmt::format("cannot be started: {}", error.code().message()));
  }
  input_.Set(to_child.write.Release());
  output_.Set(from_child.read.Release());
  errors_.Set(errors.read.Release());
  for (const int end : {input_.get(), output_.get(), errors_.get()}) DoNotBlock(end);
}

Program::~Program() {
  input_.Close();
  // It may have something to write to a file of its own.
  const auto deadline = Clock::now() + kFarewell;
  try {
    while (Clock::now() < deadline && ReadAnswers()) {
      received_.clear();
      Exchange(deadline);
    }
  } catch (...) {  // a stop
  }
  KillAll();
}

void Program::KillAll() {
  if (child_->id() > 0) kill(-child_->id(), SIGKILL);  // the group that it leads
  child_->Kill();
}

void Program::Tell(std::string_view text, Duration limit) {
  unsent_ += text;
  Send();
  const auto deadline = Clock::now() + limit;
  while (!unsent_.empty()) {
    if (Clock::now() > deadline) throw RunError("does not read its input" + LastWords());
    Exchange(deadline);
  }
}

std::string_view Program::Ask(std::string_view line, Duration limit) {
  ReadAnswers();
  if (!received_.empty()) {
    throw RunError(fmt::format("{}: \"{}\"", kWithoutSample, Shown(received_)));
  }
  unsent_ += line;
  Send();
  const auto deadline = Clock::now() + limit;
  std::size_t end = received_.find('\n');
  while (end == std::string::npos) {
    if (received_.size() > kLongestAnswer) throw RunError("answered a line of more than 1 MB");
    if (Clock::now() > deadline) {
      throw RunError(fmt::format(
          "did not answer within {} ms (does it flush its output?){}",
          std::chrono::duration_cast<std::chrono::milliseconds>(limit).count(), LastWords()));
    }
    Exchange(deadline);
    end = received_.find('\n');
  }
  answer_.assign(received_, 0, end);
  received_.erase(0, end + 1);
  int unread = 0;
  if (!unsent_.empty() || (ioctl(input_.get(), FIONREAD, &unread) == 0 && unread > 0)) {
    throw RunError(fmt::format("{}: \"{}\"", kWithoutSample, Shown(answer_)));
  }
  if (!answer_.empty() && answer_.back() == '\r') answer_.pop_back();
  return answer_;
}

void Program::Exchange(Clock::time_point deadline) {
  if (StopAsked()) throw Cancelled{};
  const auto left =
      std::clamp(std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()) +
                     std::chrono::milliseconds(1),
                 std::chrono::milliseconds(1), std::chrono::milliseconds(kLook));
  std::array<pollfd, 3> ends = {
      pollfd{.fd = output_.get(), .events = POLLIN, .revents = 0},
      pollfd{.fd = errors_.get(), .events = POLLIN, .revents = 0},  // none once it is closed
      pollfd{.fd = unsent_.empty() ? -1 : input_.get(), .events = POLLOUT, .revents = 0}};
  poll(ends.data(), ends.size(), static_cast<int>(left.count()));
  if (ends[1].revents != 0) ReadErrors();
  if (ends[2].revents != 0) Send();
  if (ends[0].revents != 0 && !ReadAnswers() && input_.get() >= 0) FailAtEnd();
}

void Program::ReadErrors() {
  std::array<char, 4096> block;
  ssize_t got = 0;
  while ((got = read(errors_.get(), block.data(), block.size())) > 0) {
    errors_tail_.append(block.data(), static_cast<std::size_t>(got));
    if (errors_tail_.size() > kLongestTail) {
      errors_tail_.erase(0, errors_tail_.size() - kLongestTail);
    }
    if (static_cast<std::size_t>(got) < block.size()) return;
  }
  if (got == 0) errors_.Close();
}

bool Program::ReadAnswers() {
  std::array<char, 4096> block;
  const ssize_t got = read(output_.get(), block.data(), block.size());
  if (got > 0) received_.append(block.data(), static_cast<std::size_t>(got));
  return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

void Program::Send() {
  if (unsent_.empty()) return;
  const ssize_t sent = write(input_.get(), unsent_.data(), unsent_.size());
  if (sent > 0) unsent_.erase(0, static_cast<std::size_t>(sent));
  if (sent < 0 && errno == EPIPE) FailAtEnd();
}

void Program::FailAtEnd() {
  // Its last words may still be on their way; it may also have closed its streams and go on.
  constexpr int kMoment_ms = 5;
  const auto deadline = Clock::now() + kFarewell;
  bool has_ended = false;
  while (!has_ended && Clock::now() < deadline) {
    has_ended = child_->HasEnded();
    pollfd errors = {.fd = errors_.get(), .events = POLLIN, .revents = 0};
    if (poll(&errors, 1, has_ended ? 0 : kMoment_ms) > 0) ReadErrors();
  }
  KillAll();
  const std::optional<ChildEnd> end = has_ended ? child_->Wait() : std::nullopt;
  if (!end) throw RunError("closed its input or output" + LastWords());
  throw RunError(TextOf(*end) + LastWords());
}

std::string Program::LastWords() {
  std::string_view text = errors_tail_;
  const auto is_line_end = [](char c) { return c == '\n' || c == '\r' || c == ' '; };
  while (!text.empty() && is_line_end(text.back())) text.remove_suffix(1);
  text.remove_prefix(std::min(text.find_last_of('\n') + 1, text.size()));
  return text.empty() ? "" : ": " + Shown(text);
}

}  // namespace gauntlet::sim
