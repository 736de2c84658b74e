#include "sim/live/server/page_server.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <deque>
#include <iterator>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/base/descriptor.h"
#include "sim/live/server/http_request.h"

namespace gauntlet::sim {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::ptrdiff_t kMostStreams = 4;
constexpr std::size_t kMostBody = 256;
constexpr std::size_t kKeptEvents = 50;
constexpr auto kForRequest = std::chrono::seconds(2);   // until it is whole
constexpr auto kForProgress = std::chrono::seconds(1);  // of one who reads
constexpr auto kForAnswer = std::chrono::seconds(30);   // until it has been read
constexpr auto kForLastWords = std::chrono::milliseconds(500);
constexpr auto kForEnd = std::chrono::milliseconds(300);  // of the streams
constexpr auto kQuiet = std::chrono::milliseconds(250);   // then a comment shows who has left
constexpr int kLook_ms = 50;

/// Takes as long for every wrong token of the same length.
bool IsSame(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

bool WouldBlock() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

/// One connection has one request.
struct Connection {
  enum class State { kReads, kAnswers, kStreams, kDrains, kClosed };

  explicit Connection(int descriptor) : socket(descriptor) {}

  bool has_output() const { return sent < head.size() + body.size(); }

  Descriptor socket;
  State state = State::kReads;
  Clock::time_point until = Clock::now() + kForRequest;  // then it is closed
  Clock::time_point progress = {};                       // of its output
  std::string request = {};
  std::string head = {};        // of the answer; of a stream all of it
  std::string_view body = {};   // behind it, of the page
  std::size_t sent = 0;         // of both
  std::int64_t next_event = 0;  // of a stream
};

/// The last events, for all streams.
class RecentEvents {
 public:
  void Add(std::string_view event) {
    events_.emplace_back(event);
    ++next_;
    if (events_.size() > kKeptEvents) events_.pop_front();
  }
  std::int64_t next() const { return next_; }
  /// All events from number `from` on, which becomes that of the next. One who is too slow goes on
  /// with the newest.
  std::string Since(std::int64_t& from) const {
    std::string text;
    const std::int64_t begin = next_ - std::ssize(events_);
    if (from < begin) from = next_ - 1;
    for (; from < next_; ++from) text += events_[static_cast<std::size_t>(from - begin)];
    return text;
  }

 private:
  std::deque<std::string> events_;
  std::int64_t next_ = 0;
};

class PageServer {
 public:
  PageServer(const LiveServerConfig& config, int listener, int session)
      : config_(config),
        listener_(listener),
        session_(session),
        fields_(fmt::format(
            "Content-Security-Policy: default-src 'none'; script-src 'nonce-{}'; "
            "style-src 'unsafe-inline'; img-src data:; connect-src 'self'; base-uri 'none'; "
            "form-action 'none'; frame-ancestors 'none'\r\n"
            "X-Content-Type-Options: nosniff\r\n"
            "Referrer-Policy: no-referrer\r\n"
            "Cross-Origin-Resource-Policy: same-origin\r\n"
            "Cache-Control: no-store\r\n"
            "Connection: close\r\n",
            config.nonce)) {}

  void Run() {
    while (!has_ended_ || (Streams() > 0 && Clock::now() < end_)) {
      Wait();
      if (!has_ended_) TakeEvents();
      now_ = Clock::now();
      for (Connection& connection : connections_) Go(connection);
      if (!has_ended_) Accept();
      std::erase_if(connections_, [](const Connection& connection) {
        return connection.state == Connection::State::kClosed;
      });
    }
  }

 private:
  using State = Connection::State;

  std::ptrdiff_t Streams() const {
    return std::ranges::count(connections_, State::kStreams, &Connection::state);
  }

  /// Until there is something to do, or a moment.
  void Wait() {
    std::vector<pollfd> places;
    if (!has_ended_) {
      places.push_back({.fd = session_, .events = POLLIN, .revents = 0});
      places.push_back({.fd = listener_, .events = POLLIN, .revents = 0});
    }
    for (const Connection& connection : connections_) {
      const bool reads = connection.state != State::kAnswers;
      const int events = (reads ? POLLIN : 0) | (connection.has_output() ? POLLOUT : 0);
      places.push_back(
          {.fd = connection.socket.get(), .events = static_cast<short>(events), .revents = 0});
    }
    poll(places.data(), places.size(), kLook_ms);
  }

  void TakeEvents() {
    for (std::size_t i = 0; i < kKeptEvents; ++i) {
      const ssize_t size = recv(session_, event_.data(), event_.size(), 0);
      if (size < 0 && WouldBlock()) return;
      if (size <= 0) {
        has_ended_ = true;
        end_ = Clock::now() + kForEnd;
        recent_.Add("data: {\"has_ended\":true}\n\n");
        return;
      }
      recent_.Add({event_.data(), static_cast<std::size_t>(size)});
    }
  }

  void Accept() {
    constexpr int kMostAtOnce = 32;  // then the others have their turn
    for (int i = 0; i < kMostAtOnce; ++i) {
      const int socket = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
      if (socket < 0) {
        // On a system without free descriptors poll() would not wait.
        if (!WouldBlock() && errno != ECONNABORTED) poll(nullptr, 0, kLook_ms);
        return;
      }
      Go(connections_.emplace_back(socket));
      if (connections_.size() > kMostConnections) MakeRoom();
    }
  }

  /// Ends a connection that has had its answer, or else the oldest without a whole request. So one
  /// that sends its request at once is answered, however many others send none.
  void MakeRoom() {
    const auto rank = [](const Connection& connection) {
      constexpr std::array<State, 3> kOrder = {State::kClosed, State::kDrains, State::kReads};
      return std::ranges::find(kOrder, connection.state) - kOrder.begin();
    };
    const auto victim =
        std::ranges::min_element(connections_, {}, [&](const Connection& connection) {
          return std::pair(rank(connection), connection.until);
        });
    connections_.erase(victim);
  }

  /// All that can be done without waiting.
  void Go(Connection& connection) {
    if (connection.state == State::kReads) Read(connection);
    if (connection.state == State::kStreams) Drain(connection);
    if (connection.state == State::kStreams) Continue(connection);
    if (connection.state != State::kClosed) Send(connection);
    if (connection.state == State::kAnswers && !connection.has_output()) {
      // Closed with unread bytes, the answer would not arrive.
      shutdown(connection.socket.get(), SHUT_WR);
      connection.state = State::kDrains;
      connection.until = now_ + kForLastWords;
    }
    if (connection.state == State::kDrains) Drain(connection);
    if (now_ > connection.until) connection.state = State::kClosed;
  }

  void Read(Connection& connection) {
    std::array<char, kMostRequestBytes> bytes;
    const std::size_t room = kMostRequestBytes - connection.request.size();
    const ssize_t size = recv(connection.socket.get(), bytes.data(), room, 0);
    if (size < 0 && WouldBlock()) return;
    if (size <= 0) {
      connection.state = State::kClosed;
      return;
    }
    connection.request.append(bytes.data(), static_cast<std::size_t>(size));
    const std::string_view request = connection.request;
    const std::size_t head_size = HttpHeadSize(request);
    if (head_size == 0) {
      if (request.size() < kMostRequestBytes) return;
      return Answer(431, "a request may have at most 8 KB", connection);
    }
    const std::optional<HttpHead> head = ReadHttpHead(request.substr(0, head_size));
    if (!head) return Answer(400, "not a request of the page", connection);
    if (!MaySee(*head)) {
      return Answer(403, "the address needs the token that gauntlet live printed", connection);
    }
    if (head->body_bytes > kMostBody || head_size + head->body_bytes > kMostRequestBytes) {
      return Answer(413, "the body is too long", connection);
    }
    if (request.size() < head_size + head->body_bytes) return;
    Take(*head, request.substr(head_size, head->body_bytes), connection);
  }

  /// A name that resolves to this computer is not enough: pages elsewhere can make one.
  bool IsOwnHost(std::string_view host) const {
    const std::string port = fmt::format(":{}", config_.port);
    if (!host.ends_with(port)) return false;
    const std::string name(host.substr(0, host.size() - port.size()));
    if (name == "localhost" || name == config_.address) return true;
    return config_.address == "0.0.0.0" && IsIpv4(name);
  }

  bool MaySee(const HttpHead& head) const {
    if (!IsOwnHost(head.host)) return false;
    if (head.origin && *head.origin != fmt::format("http://{}", head.host)) return false;
    return IsSame(QueryValue(head.query, "token"), config_.token);
  }

  void Take(const HttpHead& head, std::string_view body, Connection& connection) {
    const auto is = [&](std::string_view method, std::string_view path) {
      return head.method == method && head.path == path;
    };
    if (is("GET", "/")) {
      Begin(200, "text/html; charset=utf-8", config_.page.size(), "", connection);
      connection.body = config_.page;
    } else if (is("GET", "/events")) {
      Stream(connection);
    } else if (is("POST", "/switch")) {
      Switch(body, connection);
    } else if (is("POST", "/mark")) {
      Mark(body, connection);
    } else {
      Answer(404, "the page has no such part", connection);
    }
  }

  /// `more`: further fields.
  void Begin(int status, std::string_view type, std::optional<std::size_t> body_bytes,
             std::string_view more, Connection& connection) const {
    connection.head =
        fmt::format("HTTP/1.1 {} \r\nContent-Type: {}\r\n{}{}", status, type, fields_, more);
    if (body_bytes) connection.head += fmt::format("Content-Length: {}\r\n", *body_bytes);
    connection.head += "\r\n";
    connection.state = State::kAnswers;
    connection.progress = now_;
    connection.until = now_ + kForAnswer;
  }

  void Answer(int status, std::string_view text, Connection& connection,
              std::string_view more = "") const {
    Begin(status, "text/plain; charset=utf-8", text.size() + 1, more, connection);
    connection.head += text;
    connection.head += '\n';
  }

  void Stream(Connection& connection) {
    if (Streams() >= kMostStreams) {
      return Answer(503, fmt::format("{} browsers watch already", kMostStreams), connection,
                    "Retry-After: 5\r\n");
    }
    Begin(200, "text/event-stream", std::nullopt, "", connection);
    connection.head += "retry: 1000\n\n";  // [ms] of a browser whose stream broke
    connection.state = State::kStreams;
    connection.until = Clock::time_point::max();
    connection.next_event = recent_.next();
  }

  void Switch(std::string_view name, Connection& connection) {
    const auto found = std::ranges::find(config_.controllers, name);
    if (found == config_.controllers.end()) {
      return Answer(400, "no controller of this session has this name", connection);
    }
    if (!limit_.Allow()) {
      return Answer(429, "at most two switches per second", connection, "Retry-After: 1\r\n");
    }
    SendPageMessage(session_,
                    {.kind = PageMessage::Kind::kSwitch,
                     .number = static_cast<std::int32_t>(found - config_.controllers.begin())});
    Answer(202, fmt::format("asked for {}", name), connection);
  }

  void Mark(std::string_view word, Connection& connection) const {
    const bool is_still = word == "still";
    if (!is_still && word != "moving") return Answer(400, "still or moving", connection);
    SendPageMessage(session_, {.kind = PageMessage::Kind::kMark, .number = is_still ? 1 : 0});
    Answer(202, fmt::format("marked {}", word), connection);
  }

  /// The next events of a stream whose browser has taken the ones before.
  void Continue(Connection& connection) {
    if (connection.has_output()) return;
    std::string text = recent_.Since(connection.next_event);
    if (text.empty() && has_ended_) connection.state = State::kClosed;
    if (text.empty() && now_ - connection.progress > kQuiet) text = ": \n\n";
    if (text.empty()) return;
    connection.head = std::move(text);
    connection.sent = 0;
    connection.progress = now_;
  }

  void Send(Connection& connection) {
    while (connection.has_output()) {
      const std::string_view head = connection.head;
      const std::string_view rest = connection.sent < head.size()
                                        ? head.substr(connection.sent)
                                        : connection.body.substr(connection.sent - head.size());
      const ssize_t size = send(connection.socket.get(), rest.data(), rest.size(), MSG_NOSIGNAL);
      if (size < 0) {
        const bool may_go_on = WouldBlock() && now_ - connection.progress < kForProgress;
        if (!may_go_on) connection.state = State::kClosed;
        return;
      }
      connection.sent += static_cast<std::size_t>(size);
      connection.progress = now_;
    }
  }

  /// Throws away what arrives; notices the end.
  static void Drain(Connection& connection) {
    std::array<char, kMostRequestBytes> bytes;
    const ssize_t size = recv(connection.socket.get(), bytes.data(), bytes.size(), 0);
    if (size == 0 || (size < 0 && !WouldBlock())) connection.state = State::kClosed;
  }

  const LiveServerConfig& config_;
  int listener_;
  int session_;
  std::string fields_;  // of all answers
  std::list<Connection> connections_;
  RecentEvents recent_;
  SwitchLimit limit_;
  std::vector<char> event_ = std::vector<char>(kMostEventBytes);
  Clock::time_point now_ = Clock::now();
  Clock::time_point end_ = {};
  bool has_ended_ = false;
};

}  // namespace

void SendPageMessage(int session, const PageMessage& message) noexcept {
  while (send(session, &message, sizeof message, MSG_DONTWAIT | MSG_NOSIGNAL) < 0 &&
         errno == EINTR) {
  }
}

void ServePage(const LiveServerConfig& config, int listener, int session) {
  PageServer(config, listener, session).Run();
}

}  // namespace gauntlet::sim
