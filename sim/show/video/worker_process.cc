#include "sim/show/video/worker_process.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>
#include <string_view>
#include <system_error>
#include <utility>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

// A message is one of these letters and what belongs to it: a number, or the text of an error.
constexpr char kNumber = 'n', kDone = 'd', kUserError = 'u', kRunError = 'r';
constexpr std::size_t kLongest = 4096;
constexpr int kSocketOfChild = 3;  // the first after the standard streams

/// The other end may be gone: who listens at this one is told so by the end of messages.
void SendMessage(int socket, char kind, std::string_view content) {
  std::string message(1, kind);
  message += content.substr(0, kLongest - 1);
  while (send(socket, message.data(), message.size(), MSG_NOSIGNAL) < 0 && errno == EINTR) {
  }
}

void SendNumber(int socket, int number) {
  SendMessage(socket, kNumber, {reinterpret_cast<const char*>(&number), sizeof number});
}

/// Empty at the end of messages.
std::string ReceiveMessage(int socket) {
  std::array<char, kLongest> message;
  for (;;) {
    const ssize_t size = recv(socket, message.data(), message.size(), 0);
    if (size >= 0) return {message.data(), static_cast<std::size_t>(size)};
    // A reset is told once, before the last messages of an end that left some unread.
    if (errno != EINTR && errno != ECONNRESET) return {};
  }
}

int NumberOf(const std::string& message) {
  int number = 0;
  std::memcpy(&number, message.data() + 1, sizeof number);
  return number;
}

/// Known limit of memory, as the rest of a sentence; empty if none is known.
std::string LimitOfMemory() {
  rlimit limit = {};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
  return fmt::format("the memory of a process is limited to {} MB (ulimit -v)",
                     limit.rlim_cur / 1'000'000);
}

std::string NotEnoughMemory(const std::string& does) {
  const std::string limit = LimitOfMemory();
  return fmt::format("video: not enough memory for the process that {}{}{}", does,
                     limit.empty() ? "" : ": ", limit);
}

/// How the child ended, and why it may have.
std::string EndOf(ChildProcess& process, const std::string& does) {
  const std::optional<ChildEnd> end = process.Wait();
  if (!end) return fmt::format("video: the process that {} is gone", does);
  std::string reason = end->signal != 0 ? LimitOfMemory() : "";
  if (reason.empty() && end->signal == SIGKILL) reason = "the system does so when memory runs out";
  return fmt::format("video: the process that {} {}{}{}", does,
                     (end->signal != 0 ? "was " : "") + TextOf(*end), reason.empty() ? "" : "; ",
                     reason);
}

/// Work of the child in place of the parent's own way on.
void WorkInChild(int socket, const std::string& does,
                 const std::function<void(WorkerProcess::Tasks&)>& work) {
  dup2(socket, kSocketOfChild);
  closefrom(kSocketOfChild + 1);
  socket = kSocketOfChild;
  try {
    WorkerProcess::Tasks tasks(socket);
    work(tasks);
    SendMessage(socket, kDone, "");
  } catch (const UserError& error) {
    SendMessage(socket, kUserError, error.what());
  } catch (const std::bad_alloc&) {
    SendMessage(socket, kRunError, NotEnoughMemory(does));
  } catch (const std::exception& error) {
    SendMessage(socket, kRunError, error.what());
  }
}

}  // namespace

std::optional<int> WorkerProcess::Tasks::Next() {
  const std::string message = ReceiveMessage(socket_);
  if (message.empty()) return std::nullopt;
  return NumberOf(message);
}

void WorkerProcess::Tasks::Answer(int number) { SendNumber(socket_, number); }

WorkerProcess::WorkerProcess(std::string does, const std::function<void(Tasks&)>& work)
    : does_(std::move(does)) {
  int ends[2] = {-1, -1};
  try {
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
      throw std::system_error(errno, std::generic_category());
    }
    process_.emplace([&] { WorkInChild(ends[1], does_, work); });
  } catch (const std::system_error& error) {
    for (const int end : ends) close(end);
    throw RunError(
        fmt::format("video: cannot start the process that {}: {}", does_, error.code().message()));
  }
  socket_ = ends[0];
  close(ends[1]);
}

WorkerProcess::~WorkerProcess() { close(socket_); }

void WorkerProcess::Send(int number) { SendNumber(socket_, number); }

void WorkerProcess::Close() { shutdown(socket_, SHUT_WR); }

std::optional<int> WorkerProcess::Receive() {
  const std::string message = ReceiveMessage(socket_);
  if (message.empty()) throw RunError(EndOf(*process_, does_));
  switch (message[0]) {
    case kNumber:
      return NumberOf(message);
    case kUserError:
      throw UserError(message.substr(1));
    case kRunError:
      throw RunError(message.substr(1));
    default:
      return std::nullopt;
  }
}

}  // namespace gauntlet::sim
