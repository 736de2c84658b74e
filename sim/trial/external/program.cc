#include "sim/trial/external/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <set>
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

/// Names of the processes that left the group of a program.
struct LeftNames {
  std::set<std::string> ended;
  std::set<std::string> running;
};

std::mutex left_mutex;
std::map<std::string, LeftNames> left_of;  // by the words of the program

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
  Descriptor read;
  Descriptor write;
};

Program::Program(const ProgramCommand& command)
    : name_(fmt::format("{}", fmt::join(command.words, " "))) {
  Pipe to_child;
  Pipe from_child;
  Pipe errors;
  try {
    process_ = std::make_unique<SupervisedProcess>(
        command, std::array{to_child.read.get(), from_child.write.get(), errors.write.get()});
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
  const LeftGroup left = process_->Kill();
  if (left.ended.empty() && left.running.empty()) return;
  const std::lock_guard lock(left_mutex);
  auto& [ended, running] = left_of[name_];
  ended.insert(left.ended.begin(), left.ended.end());
  running.insert(left.running.begin(), left.running.end());
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
  std::optional<ChildEnd> end;
  while (!end && Clock::now() < deadline) {
    end = process_->End();
    pollfd errors = {.fd = errors_.get(), .events = POLLIN, .revents = 0};
    if (poll(&errors, 1, end ? 0 : kMoment_ms) > 0) ReadErrors();
  }
  KillAll();
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

std::vector<std::string> TakeLeftProcesses() {
  const std::lock_guard lock(left_mutex);
  std::vector<std::string> sentences;
  for (const auto& [program, left] : left_of) {
    std::string sentence = fmt::format("{} started processes that left its process group", program);
    if (!left.ended.empty()) {
      sentence += fmt::format(" ({}); they were ended with it", fmt::join(left.ended, ", "));
    }
    if (!left.running.empty()) {
      sentence += fmt::format("{} {}, which still run, could not be ended",
                              left.ended.empty() ? ";" : ", but", fmt::join(left.running, ", "));
    }
    sentences.push_back(std::move(sentence));
  }
  left_of.clear();
  return sentences;
}

}  // namespace gauntlet::sim
