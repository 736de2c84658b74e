#include "sim/live/server/live_server.h"

#include <httplib.h>
#undef _res  // of <resolv.h>; Eigen has parameters of this name

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <iterator>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string_view>
#include <thread>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/live/session_threads.h"

namespace gauntlet::sim {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kMostStreams = 4;
constexpr std::size_t kThreads = kMostStreams + 8;
constexpr std::size_t kMostBody = 256;
constexpr int kSendBuffer = 1 << 16;  // a browser that does not read is noticed when it is full
constexpr auto kBetweenSwitches = std::chrono::milliseconds(500);
constexpr auto kQuiet = std::chrono::milliseconds(250);  // then a comment shows who has left
constexpr auto kLook = std::chrono::milliseconds(10);    // of the watcher

/// Takes as long for every wrong token of the same length.
bool IsSame(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

void AddNumber(double value, int digits, std::string& json) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(json), "{:.{}f}", value, digits);
  } else {
    json += "null";
  }
}

void AddList(std::span<const double> values, double factor, int digits, std::string& json) {
  json += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) json += ',';
    AddNumber(factor * values[i], digits, json);
  }
  json += ']';
}

/// The last events, for all streams. A stream that is too slow goes on with the newest.
class Events {
 public:
  void Add(std::string event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
    ++next_;
    if (events_.size() > kKept) events_.pop_front();
    changed_.notify_all();
  }

  void End() {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
    changed_.notify_all();
  }

  std::int64_t next() const {
    const std::lock_guard lock(mutex_);
    return next_;
  }

  struct Waited {
    std::string text;  // may be empty
    bool is_last = false;
  };

  /// All events from number `from` on, which becomes that of the next; waits for a moment if there
  /// is none.
  Waited WaitFor(std::int64_t& from) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kQuiet, [&] { return has_ended_ || next_ > from; });
    Waited waited{.text = {}, .is_last = has_ended_};
    const auto begin = next_ - std::ssize(events_);
    if (from < begin) from = next_ - 1;
    for (; from < next_; ++from) waited.text += events_[static_cast<std::size_t>(from - begin)];
    return waited;
  }

 private:
  static constexpr std::size_t kKept = 50;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> events_;
  std::int64_t next_ = 0;
  bool has_ended_ = false;
};

/// At most one switch per period.
class SwitchLimit {
 public:
  bool Allow() {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (last_ && now - *last_ < kBetweenSwitches) return false;
    last_ = now;
    return true;
  }

 private:
  std::mutex mutex_;
  std::optional<Clock::time_point> last_;
};

}  // namespace

bool IsIpv4(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

std::string RandomToken() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != std::ssize(bytes)) {
    throw RunError("the system gives no random numbers for the address of the page");
  }
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

class LiveServer::Server {
 public:
  Server(LiveServerConfig config, LiveView& view)
      : config_(std::move(config)), view_(view), token_(RandomToken()) {
    SetUp();
    const bool is_bound = config_.port == 0
                              ? (config_.port = http_.bind_to_any_port(config_.address)) > 0
                              : http_.bind_to_port(config_.address, config_.port);
    if (!is_bound) {
      throw UserError({.place = fmt::format("--page {}", config_.port),
                       .problem = fmt::format("cannot be had at {}: another program has the port, "
                                              "or the address is not of this computer; --page 0 "
                                              "takes any free port",
                                              config_.address)});
    }
    watcher_ = StartThread([this](const std::stop_token& stop) { Watch(stop); });
    listener_ = StartThread([this] { Listen(); });
  }

  ~Server() {
    watcher_.request_stop();
    events_.End();
    constexpr int kMostWaits = 30;
    for (int i = 0; i < kMostWaits && streams_.load() > 0; ++i) std::this_thread::sleep_for(kLook);
    // A server that does not listen yet cannot be stopped.
    while (!http_.is_running() && !has_listened_.load()) std::this_thread::sleep_for(kLook);
    http_.stop();
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::string Address() const {
    const std::string host = config_.address == "0.0.0.0" ? "127.0.0.1" : config_.address;
    return fmt::format("http://{}:{}/?token={}", host, config_.port, token_);
  }

 private:
  void Listen() {
    constexpr int kNice = 10;
    setpriority(PRIO_PROCESS, 0, kNice);  // on Linux of this thread, and of those that it starts
    http_.listen_after_bind();
    has_listened_.store(true, std::memory_order_release);
  }

  void SetUp() {
    http_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    http_.set_socket_options([](socket_t socket) {
      // Not SO_REUSEPORT, the default: another program could share the port.
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
      setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer);
    });
    http_.set_tcp_nodelay(true);
    http_.set_keep_alive_max_count(1);
    http_.set_keep_alive_timeout(1);
    http_.set_read_timeout(1);
    http_.set_write_timeout(1);
    http_.set_payload_max_length(kMostBody);
    http_.set_default_headers(
        {{"Content-Security-Policy",
          fmt::format("default-src 'none'; script-src 'nonce-{}'; style-src 'unsafe-inline'; "
                      "img-src data:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
                      "frame-ancestors 'none'",
                      config_.nonce)},
         {"X-Content-Type-Options", "nosniff"},
         {"Referrer-Policy", "no-referrer"},
         {"Cross-Origin-Resource-Policy", "same-origin"},
         {"Cache-Control", "no-store"}});
    http_.set_pre_routing_handler(
        [this](const httplib::Request& request, httplib::Response& response) {
          if (MaySee(request)) return httplib::Server::HandlerResponse::Unhandled;
          Answer(403, "the address needs the token that gauntlet live printed", response);
          return httplib::Server::HandlerResponse::Handled;
        });
    http_.Get("/", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(config_.page, "text/html; charset=utf-8");
    });
    http_.Get("/events", [this](const httplib::Request& request, httplib::Response& response) {
      Stream(request, response);
    });
    http_.Post("/switch", [this](const httplib::Request& request, httplib::Response& response) {
      Switch(request, response);
    });
    http_.Post("/mark", [this](const httplib::Request& request, httplib::Response& response) {
      Mark(request, response);
    });
  }

  static void Answer(int status, const std::string& text, httplib::Response& response) {
    response.status = status;
    response.set_content(text + "\n", "text/plain; charset=utf-8");
  }

  /// A name that resolves to this computer is not enough: pages elsewhere can make one.
  bool IsOwnHost(const std::string& host) const {
    const std::string port = fmt::format(":{}", config_.port);
    if (!host.ends_with(port)) return false;
    const std::string name = host.substr(0, host.size() - port.size());
    if (name == "localhost" || name == config_.address) return true;
    return config_.address == "0.0.0.0" && IsIpv4(name);
  }

  bool MaySee(const httplib::Request& request) const {
    const std::string host = request.get_header_value("Host");
    if (request.get_header_value_count("Host") != 1 || !IsOwnHost(host)) return false;
    if (request.has_header("Origin") && request.get_header_value("Origin") != "http://" + host) {
      return false;
    }
    return IsSame(request.get_param_value("token"), token_);
  }

  void Stream(const httplib::Request& request, httplib::Response& response) {
    if (request.method != "GET") return Answer(405, "only GET", response);
    if (streams_.fetch_add(1) >= kMostStreams) {
      --streams_;
      response.set_header("Retry-After", "5");
      return Answer(503, fmt::format("{} browsers watch already", kMostStreams), response);
    }
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, from = events_.next()](std::size_t, httplib::DataSink& sink) mutable {
          auto [text, is_last] = events_.WaitFor(from);
          if (text.empty()) text = ": \n\n";
          if (is_last) text += "data: {\"has_ended\":true}\n\n";
          if (!sink.is_writable() || !sink.write(text.data(), text.size())) return false;
          if (is_last) sink.done();
          return true;
        },
        [this](bool) { --streams_; });
  }

  void Switch(const httplib::Request& request, httplib::Response& response) {
    const auto found = std::ranges::find(config_.controllers, request.body);
    if (found == config_.controllers.end()) {
      return Answer(400, "no controller of this session has this name", response);
    }
    if (!limit_.Allow()) {
      response.set_header("Retry-After", "1");
      return Answer(429, "at most two switches per second", response);
    }
    view_.Ask(static_cast<int>(found - config_.controllers.begin()));
    Answer(202, "asked for " + request.body, response);
  }

  void Mark(const httplib::Request& request, httplib::Response& response) {
    const bool is_still = request.body == "still";
    if (!is_still && request.body != "moving") return Answer(400, "still or moving", response);
    view_.Mark(is_still);
    Answer(202, "marked " + request.body, response);
  }

  /// Takes what the session shows, so that its rings do not fill.
  void Watch(const std::stop_token& stop) {
    std::string stages;
    while (!stop.stop_requested()) {
      while (view_.NextStages([&](std::span<const double> stages_us) {
        if (!stages.empty()) stages += ',';
        AddList(stages_us, 1e-3, 3, stages);
      })) {
      }
      while (view_.Next([&](const LiveMoment& moment, std::span<const double> values) {
        events_.Add(EventOf(moment, values, stages));
        stages.clear();
      })) {
      }
      std::this_thread::sleep_for(kLook);
    }
  }

  std::string EventOf(const LiveMoment& moment, std::span<const double> values,
                      const std::string& stages) const {
    std::string json = fmt::format(
        "data: {{\"time_s\":{:.3f},\"late_ms\":{:.3f},\"skipped\":{},\"waiting\":{},\"queued\":{},"
        "\"commands\":{},\"repeated\":{},\"driving\":{},\"is_still\":{},\"tier\":{},\"has_sink\":{}"
        ","
        "\"stages_ms\":[{}],\"glove_deg\":",
        moment.time_s, 1e3 * moment.largest_lateness_s, moment.skipped_ticks, moment.waiting_frames,
        moment.queued_frames, moment.commands, moment.repeated_samples, moment.driving,
        moment.is_still, static_cast<int>(moment.tier), moment.has_sink, stages);
    constexpr int kDigits = 2;
    AddList(values.first(view_.channels()), kDegPerRad, kDigits, json);
    json += ",\"command_deg\":";
    AddList(values.subspan(view_.channels(), view_.joints()), kDegPerRad, kDigits, json);
    json += ",\"hand_deg\":";
    AddList(values.last(view_.joints()), kDegPerRad, kDigits, json);
    return json + "}\n\n";
  }

  LiveServerConfig config_;
  LiveView& view_;
  std::string token_;
  Events events_;
  SwitchLimit limit_;
  std::atomic<int> streams_ = 0;
  std::atomic<bool> has_listened_ = false;
  httplib::Server http_;
  std::jthread watcher_;  // last, with the next: they end before what they use
  std::jthread listener_;
};

LiveServer::LiveServer(LiveServerConfig config, LiveView& view)
    : server_(std::make_unique<Server>(std::move(config), view)) {}

LiveServer::~LiveServer() = default;

std::string LiveServer::Address() const { return server_->Address(); }

}  // namespace gauntlet::sim
