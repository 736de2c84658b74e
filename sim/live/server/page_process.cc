#include "sim/live/server/page_process.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <new>
#include <system_error>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/process_limits.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMemoryBytes = std::size_t{32} << 20;  // in addition to the program's
constexpr rlim_t kFurtherFiles = 16;                         // beside connections
constexpr int kNice = 10;
constexpr int kNoMemory = 2;  // exit codes of the server
constexpr int kFailed = 1;

/// Work of the server's process.
void Serve(const LiveServerConfig& config, int listener, int session) noexcept {
  try {
    ServePage(config, listener, session);
  } catch (const std::bad_alloc&) {
    _exit(kNoMemory);
  } catch (...) {
    _exit(kFailed);
  }
}

/// As PageMessage::kEnded has it.
int NumberOf(const ChildEnd& end) {
  return end.signal != 0 ? end.signal : (end.exit_code == kNoMemory ? -1 : 0);
}

/// Work of the process between session and server: starts the server, again if it must.
void KeepServer(const LiveServerConfig& config, int listener, int session) noexcept {
  constexpr auto kBetweenStarts = std::chrono::milliseconds(200);
  KeepOnly({listener, session});
  DropRights();
  LimitMemory(kMemoryBytes);
  LimitResource(RLIMIT_NOFILE, kMostConnections + kFurtherFiles);
  setpriority(PRIO_PROCESS, 0, kNice);
  for (int start = 0; start < PageProcess::kMostStarts; ++start) {
    if (start > 0) std::this_thread::sleep_for(kBetweenStarts);
    PageMessage ended{.kind = PageMessage::Kind::kEnded, .number = -1};
    try {
      ChildProcess server([&] { Serve(config, listener, session); });
      const std::optional<ChildEnd> end = server.Wait();
      if (!end || (end->signal == 0 && end->exit_code == 0)) return;
      ended.number = NumberOf(*end);
    } catch (const std::system_error&) {  // no process
    }
    SendPageMessage(session, ended);
  }
}

}  // namespace

PageProcess::PageProcess(const LiveServerConfig& config, const Descriptor& listener) {
  int ends[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) != 0) {
    throw RunError(fmt::format("cannot start the process of the page: {}",
                               std::generic_category().message(errno)));
  }
  session_.Set(ends[0]);
  const Descriptor page(ends[1]);
  try {
    keeper_.emplace([&] { KeepServer(config, listener.get(), page.get()); });
  } catch (const std::system_error& error) {
    throw RunError(fmt::format("cannot start the process of the page: {}", error.code().message()));
  }
}

PageProcess::~PageProcess() {
  shutdown(session_.get(), SHUT_WR);
  constexpr int kMostLooks = 400;
  constexpr auto kLook = std::chrono::milliseconds(5);
  for (int i = 0; i < kMostLooks && !keeper_->HasEnded(); ++i) std::this_thread::sleep_for(kLook);
}

void PageProcess::Send(std::string_view event) noexcept {
  if (event.empty() || event.size() > kMostEventBytes) return;
  while (send(session_.get(), event.data(), event.size(), MSG_DONTWAIT | MSG_NOSIGNAL) < 0 &&
         errno == EINTR) {
  }
}

std::optional<PageMessage> PageProcess::Receive() noexcept {
  PageMessage message;
  const ssize_t size = recv(session_.get(), &message, sizeof message, MSG_DONTWAIT | MSG_TRUNC);
  if (size == sizeof message) return message;
  // A reset is told once, before the last messages of an end that left some unread.
  is_gone_ = size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR && errno != ECONNRESET);
  return std::nullopt;
}

}  // namespace gauntlet::sim
