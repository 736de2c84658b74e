#pragma once

#include <optional>
#include <string_view>

#include "sim/base/child_process.h"
#include "sim/base/descriptor.h"
#include "sim/live/server/page_server.h"

namespace gauntlet::sim {

/// The process that serves the page of a session. It has limits of memory and of open files, and
/// only two descriptors of this process: the listening socket and the way to the session. It ends
/// with this process, however that ends.
///
/// A server that ends otherwise is started again at the same address, kMostStarts times in all. A
/// process between the two does that, which was copied before the session had threads.
class PageProcess {
 public:
  static constexpr int kMostStarts = 4;

  /// To be made while no other thread runs. `listener` listens; the page has it from now on.
  /// Errors: RunError if the system gives no process.
  PageProcess(const LiveServerConfig& config, const Descriptor& listener);
  /// Waits for its end, at most 2 s.
  ~PageProcess();
  PageProcess(const PageProcess&) = delete;
  PageProcess& operator=(const PageProcess&) = delete;

  /// Never waits: a message that finds no room is lost, as one of more than kMostEventBytes.
  void Send(std::string_view event) noexcept;
  /// The next message; nothing if there is none yet, or IsGone(). The sender may be hostile: of a
  /// message only the size has been checked.
  std::optional<PageMessage> Receive() noexcept;
  bool IsGone() const { return is_gone_; }

 private:
  Descriptor session_;
  std::optional<ChildProcess> keeper_;
  bool is_gone_ = false;
};

}  // namespace gauntlet::sim
