#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/live/live_view.h"

namespace gauntlet::sim {

/// True for four numbers with dots.
bool IsIpv4(const std::string& text);

/// 128 random bits of the system as hexadecimal digits. Errors: RunError.
std::string RandomToken();

struct LiveServerConfig {
  std::string address = "127.0.0.1";  // IPv4; 0.0.0.0: every address of this computer
  int port = 0;                       // 0: any that is free
  std::string page = {};              // HTML, see LivePage()
  std::string nonce = {};             // of its scripts
  std::vector<std::string> controllers = {};
  std::function<void(const std::string&)> say = {};  // a line for the user
  std::string token = {};                            // set by the server
};

/// Serves the page of a session by HTTP from a process of its own, of low priority, until it is
/// destroyed; that may take 2 s. See README.md for its requests, and SECURITY.md for what it
/// promises.
class LiveServer {
 public:
  /// Keeps `view`. To be made while no other thread runs. Errors: UserError for a place that cannot
  /// be had, with key `--page`; RunError if no process or thread starts.
  LiveServer(LiveServerConfig config, LiveView& view);
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  /// The address of the page, with its token.
  std::string Address() const;

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace gauntlet::sim
