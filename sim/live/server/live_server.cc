#include "sim/live/server/live_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/tcp.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <optional>
#include <span>
#include <stop_token>
#include <thread>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/live/server/page_process.h"
#include "sim/live/server/page_server.h"
#include "sim/live/session_threads.h"

namespace gauntlet::sim {
namespace {

constexpr auto kLook = std::chrono::milliseconds(10);  // of the watcher

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

sockaddr_in AddressOf(const LiveServerConfig& config) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(config.port));
  inet_pton(AF_INET, config.address.c_str(), &address.sin_addr);
  return address;
}

/// Listens at the address of `config`; gives it the port, if any was asked for.
bool Listen(const Descriptor& listener, LiveServerConfig& config) {
  constexpr int kBacklog = 1024;        // one without a place there tries again after a second
  constexpr int kSendBuffer = 1 << 16;  // a browser that does not read is noticed when it is full
  const int yes = 1;
  const int socket = listener.get();
  // Those that are accepted have the same options. Not SO_REUSEPORT: another program could share
  // the port.
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer);
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  sockaddr_in address = AddressOf(config);
  socklen_t size = sizeof address;
  auto* const place = reinterpret_cast<sockaddr*>(&address);
  if (bind(socket, place, size) != 0 || listen(socket, kBacklog) != 0) return false;
  if (getsockname(socket, place, &size) != 0) return false;
  config.port = ntohs(address.sin_port);
  return true;
}

/// End of a process as the begin of a sentence.
std::string TextOfEnd(int signal) {
  const char* const name = signal > 0 ? sigdescr_np(signal) : nullptr;
  if (name != nullptr) {
    return fmt::format("the process of the page was ended by signal {} ({})", signal, name);
  }
  return signal < 0 ? "the process of the page had no memory left"
                    : "the process of the page ended";
}

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
  Server(LiveServerConfig config, LiveView& view) : config_(std::move(config)), view_(view) {
    config_.token = RandomToken();
    {
      const Descriptor listener(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
      if (!Listen(listener, config_)) {
        throw UserError(
            {.place = fmt::format("--page {}", config_.port),
             .problem = fmt::format("cannot be had at {}: another program has the port, "
                                    "or the address is not of this computer; --page 0 "
                                    "takes any free port",
                                    config_.address)});
      }
      page_.emplace(config_, listener);
    }
    watcher_ = StartThread([this](const std::stop_token& stop) { Watch(stop); });
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::string Address() const {
    const std::string host = config_.address == "0.0.0.0" ? "127.0.0.1" : config_.address;
    return fmt::format("http://{}:{}/?token={}", host, config_.port, config_.token);
  }

 private:
  /// Takes what the session shows, so that its rings do not fill.
  void Watch(const std::stop_token& stop) {
    constexpr int kNice = 10;
    setpriority(PRIO_PROCESS, 0, kNice);  // on Linux of this thread
    std::string stages, scores;
    while (!stop.stop_requested()) {
      while (view_.NextStages([&](std::span<const double> stages_us) {
        if (!stages.empty()) stages += ',';
        AddList(stages_us, 1e-3, 3, stages);
      })) {
      }
      while (view_.NextScores([&](double time_s, std::span<const double> numbers) {
        scores = ScoresOf(time_s, numbers);
      })) {
      }
      while (view_.Next([&](const LiveMoment& moment, std::span<const double> values) {
        page_->Send(EventOf(moment, values, stages, scores));
        stages.clear();
        scores.clear();
      })) {
      }
      if (!is_gone_) TakeMessages();
      std::this_thread::sleep_for(kLook);
    }
  }

  /// Takes messages of the page, and keeps the limit of switches, whatever it asks for.
  void TakeMessages() {
    constexpr int kMostAtOnce = 16;
    for (int i = 0; i < kMostAtOnce; ++i) {
      const std::optional<PageMessage> message = page_->Receive();
      if (!message) break;
      if (!IsOfPage(*message, config_.controllers.size())) continue;
      switch (message->kind) {
        case PageMessage::Kind::kSwitch:
          asked_ = message->number;
          break;
        case PageMessage::Kind::kMark:
          view_.Mark(message->number == 1);
          break;
        case PageMessage::Kind::kEnded:
          NoteEnd(TextOfEnd(message->number));
          break;
      }
    }
    if (asked_ && limit_.Allow()) view_.Ask(*std::exchange(asked_, std::nullopt));
    if (page_->IsGone()) NoteLoss("the process of the page is gone");
  }

  void NoteEnd(const std::string& how) {
    if (++ends_ >= PageProcess::kMostStarts) return NoteLoss(how);
    Say(how + "; it starts again at the same address, and the session goes on");
  }

  void NoteLoss(const std::string& how) {
    if (std::exchange(is_gone_, true)) return;
    Say(how + ": there is no page any more, and the session goes on");
  }

  void Say(const std::string& line) const {
    if (config_.say) config_.say(line);
  }

  static std::string ScoresOf(double time_s, std::span<const double> numbers) {
    constexpr int kDigits = 4;
    std::string json = fmt::format(",\"scores\":{{\"time_s\":{:.3f},\"controllers\":[", time_s);
    for (std::size_t i = 0; i < numbers.size(); i += LiveView::kNumbersOfScore) {
      if (i > 0) json += ',';
      AddList(numbers.subspan(i, LiveView::kNumbersOfScore), 1.0, kDigits, json);
    }
    return json + "]}";
  }

  std::string EventOf(const LiveMoment& moment, std::span<const double> values,
                      const std::string& stages, const std::string& scores) const {
    std::string json = fmt::format(
        "data: {{\"time_s\":{:.3f},\"late_ms\":{:.3f},\"skipped\":{},\"waiting\":{},\"queued\":{},"
        "\"commands\":{},\"repeated\":{},\"driving\":{},\"is_still\":{},\"is_ending\":{},\"tier\":{"
        "},"
        "\"silent_s\":{:.3f},\"has_sink\":{},\"stages_ms\":[{}]{},\"glove_deg\":",
        moment.time_s, 1e3 * moment.largest_lateness_s, moment.skipped_ticks, moment.waiting_frames,
        moment.queued_frames, moment.commands, moment.repeated_samples, moment.driving,
        moment.is_still, moment.is_ending, static_cast<int>(moment.tier), moment.silent_s,
        moment.has_sink, stages, scores);
    constexpr int kDigits = 2;
    AddList(values.first(view_.channels()), kDegPerRad, kDigits, json);
    json += ",\"command_deg\":";
    AddList(values.subspan(view_.channels(), view_.joints()), kDegPerRad, kDigits, json);
    json += ",\"hand_deg\":";
    values = values.subspan(view_.channels() + view_.joints());
    AddList(values.first(view_.joints()), kDegPerRad, kDigits, json);
    json += ",\"asked_deg\":[";
    for (std::size_t controller = 0; controller < view_.controllers(); ++controller) {
      values = values.subspan(view_.joints());
      if (controller > 0) json += ',';
      AddList(values.first(view_.joints()), kDegPerRad, kDigits, json);
    }
    return json + "]}\n\n";
  }

  LiveServerConfig config_;
  LiveView& view_;
  std::optional<PageProcess> page_;
  // The watcher has these.
  std::optional<int> asked_;  // of the controllers, until the next switch is allowed
  SwitchLimit limit_;
  int ends_ = 0;
  bool is_gone_ = false;
  std::jthread watcher_;  // last: it ends before what it uses
};

LiveServer::LiveServer(LiveServerConfig config, LiveView& view)
    : server_(std::make_unique<Server>(std::move(config), view)) {}

LiveServer::~LiveServer() = default;

std::string LiveServer::Address() const { return server_->Address(); }

}  // namespace gauntlet::sim
