#include "sim/trial/external/supervised_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <string_view>
#include <system_error>
#include <utility>

#include "sim/base/process_limits.h"

// Gauntlet -> starter: the streams of a program, and a line to its future supervisor.
// Gauntlet -> supervisor: folder, program and words, then nothing until the line is closed.
// Supervisor -> Gauntlet: Messages.

namespace gauntlet::sim {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kGraceOfLeft = std::chrono::milliseconds(200);  // for those who left the group
constexpr auto kPatience = std::chrono::seconds(2);            // for the end of all
constexpr timeval kMostOfSupervisor = {.tv_sec = 4, .tv_usec = 0};
constexpr std::size_t kLongestWord = 1 << 17;  // more the system does not take
constexpr int kCannotStart = 127;              // an exit code of shells

enum class Said : int {
  kStarted,  // number: 0, or the errno of what failed
  kEnded,    // number: its exit code, or the signal that ended it as a negative one
  kWasLeft,  // text: of a process outside the group that was ended
  kIsLeft,   // that could not be ended
};

struct Message {
  Said said = Said::kStarted;
  int number = 0;
  char text[16] = {};
};

void Send(int line, Said said, int number, std::string_view text = {}) {
  Message message = {.said = said, .number = number};
  text.copy(message.text, sizeof message.text - 1);
  send(line, &message, sizeof message, MSG_NOSIGNAL);
}

std::system_error SystemError(int reason = errno) {
  return {std::error_code(reason, std::generic_category())};
}

using Handed = std::array<int, 4>;  // the streams and the line

/// Room for the descriptors of one request, as the system wants it.
struct HandedRoom {
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(Handed))> bytes = {};
};

msghdr RequestOf(iovec& part, HandedRoom& room) {
  msghdr request = {};
  request.msg_iov = &part;
  request.msg_iovlen = 1;
  request.msg_control = room.bytes.data();
  request.msg_controllen = room.bytes.size();
  return request;
}

bool Hand(int starter, const Handed& handed) {
  char nothing = 0;  // descriptors travel with at least one byte
  iovec part = {.iov_base = &nothing, .iov_len = 1};
  HandedRoom room;
  msghdr request = RequestOf(part, room);
  cmsghdr* const head = CMSG_FIRSTHDR(&request);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof handed);
  std::memcpy(CMSG_DATA(head), &handed, sizeof handed);
  return sendmsg(starter, &request, MSG_NOSIGNAL) == 1;
}

/// False when nothing is asked any more.
bool TakeHanded(int starter, Handed& handed) {
  char nothing = 0;
  iovec part = {.iov_base = &nothing, .iov_len = 1};
  HandedRoom room;
  msghdr request = RequestOf(part, room);
  ssize_t got = 0;
  do {
    got = recvmsg(starter, &request, MSG_CMSG_CLOEXEC);
  } while (got < 0 && errno == EINTR);
  const cmsghdr* const head = got == 1 ? CMSG_FIRSTHDR(&request) : nullptr;
  if (head == nullptr || head->cmsg_len != CMSG_LEN(sizeof handed)) return false;
  std::memcpy(&handed, CMSG_DATA(head), sizeof handed);
  return true;
}

/// The kind of a word, before its text; the last one comes alone.
constexpr char kFolder = 'f';
constexpr char kProgram = 'p';
constexpr char kWord = 'w';
constexpr char kGo = '.';

bool SendWord(int line, char what, const std::string& text) {
  const std::string packet = what + text;
  return send(line, packet.data(), packet.size(), MSG_NOSIGNAL) ==
         static_cast<ssize_t>(packet.size());
}

/// False if Gauntlet has ended before the last word.
bool ReceiveCommand(int line, ProgramCommand& command) {
  std::string packet(kLongestWord + 2, '\0');
  while (true) {
    const ssize_t got = recv(line, packet.data(), packet.size(), 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    const std::string text = packet.substr(1, static_cast<std::size_t>(got) - 1);
    if (packet[0] == kGo) return true;
    if (packet[0] == kFolder) command.folder = text;
    if (packet[0] == kProgram) command.program = text;
    if (packet[0] == kWord) command.words.push_back(text);
  }
}

/// In the new process: makes the program of it.
[[noreturn]] void Become(const ProgramCommand& command, const Handed& handed, pid_t supervisor) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // should the supervisor be killed
  if (getppid() != supervisor) _exit(kCannotStart);
  setpgid(0, 0);
  for (int signal = 1; signal <= SIGRTMAX; ++signal) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  bool is_there = chdir(command.folder.c_str()) == 0;
  for (int stream = 0; stream < 3; ++stream) {
    is_there = dup2(handed[static_cast<std::size_t>(stream)], stream) >= 0 && is_there;
  }
  close_range(STDERR_FILENO + 1, ~0U, 0);
  std::vector<char*> words;
  for (const std::string& word : command.words) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  if (is_there) execv(command.program.c_str(), words.data());
  const char* const reason = strerrordesc_np(errno);
  if (write(STDERR_FILENO, reason, std::strlen(reason)) < 0) _exit(kCannotStart);
  _exit(kCannotStart);
}

/// A child of this process, as /proc has it: "1234 (name) S parent group ..".
struct Child {
  pid_t id = -1;
  pid_t group = -1;
  std::string name;
};

std::vector<Child> Children() {
  std::vector<Child> children;
  std::error_code unreadable;
  for (std::filesystem::directory_iterator entry("/proc", unreadable), end; entry != end;
       entry.increment(unreadable)) {
    const pid_t id = std::atoi(entry->path().filename().c_str());
    if (id <= 0) continue;
    std::ifstream file(entry->path() / "stat");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::size_t begin = text.find('(');
    const std::size_t end_of_name = text.rfind(") ");  // the name may have both, too
    if (end_of_name == std::string::npos) continue;
    char state = 0;
    int parent = 0;
    int group = 0;
    if (std::sscanf(text.c_str() + end_of_name + 2, "%c %d %d", &state, &parent, &group) == 3 &&
        parent == getpid() && state != 'Z') {
      children.push_back(
          {.id = id, .group = group, .name = text.substr(begin + 1, end_of_name - begin - 1)});
    }
  }
  return children;
}

/// Until `program` has ended: takes the ends of processes whose parents ended before them. The
/// program's own end is left to the system, so that its number is that of its group alone.
bool HasEnded(pid_t program, int& end) {
  siginfo_t info = {};
  while (waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid > 0) {
    if (info.si_pid == program) {
      end = info.si_code == CLD_EXITED ? info.si_status : -info.si_status;
      return true;
    }
    waitpid(info.si_pid, nullptr, 0);
    info = {};
  }
  return false;
}

void Drain(int signals) {
  signalfd_siginfo info;
  while (read(signals, &info, sizeof info) > 0) {
  }
}

/// Kills what the program has started until there is nothing, and tells who had left the group.
void EndAll(int line, int signals, pid_t program) {
  kill(-program, SIGKILL);
  const auto begin = Clock::now();
  std::map<pid_t, std::string> left;
  pid_t taken = 0;
  while (true) {
    Drain(signals);
    do {
      taken = waitpid(-1, nullptr, WNOHANG);
    } while (taken > 0);
    if (taken < 0 && errno == ECHILD) break;
    const auto waited = Clock::now() - begin;
    if (waited > kPatience) break;
    if (waited > kGraceOfLeft) {
      for (const Child& child : Children()) {
        if (child.group != program) left.emplace(child.id, child.name);
        kill(child.id, SIGKILL);
      }
    }
    constexpr int kMomentMs = 10;
    pollfd ends = {.fd = signals, .events = POLLIN, .revents = 0};
    poll(&ends, 1, kMomentMs);
  }
  if (taken == 0) {
    for (const Child& child : Children()) {
      if (left.erase(child.id) > 0) Send(line, Said::kIsLeft, child.id, child.name);
    }
  }
  for (const auto& [id, name] : left) Send(line, Said::kWasLeft, id, name);
}

[[noreturn]] void Supervise(const Handed& handed) {
  const int line = handed.back();
  // Processes whose parents end become children of this one.
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGCHLD);
  sigprocmask(SIG_SETMASK, &ends, nullptr);
  const int signals = signalfd(-1, &ends, SFD_NONBLOCK | SFD_CLOEXEC);
  ProgramCommand command;
  if (!ReceiveCommand(line, command)) _exit(0);
  const pid_t supervisor = getpid();
  const pid_t program = signals < 0 ? -1 : fork();
  if (program == 0) Become(command, handed, supervisor);
  Send(line, Said::kStarted, program < 0 ? errno : 0);
  if (program < 0) _exit(0);
  setpgid(program, program);  // whichever of both is first
  for (std::size_t i = 0; i + 1 < handed.size(); ++i) close(handed[i]);
  pollfd seen[] = {{.fd = line, .events = POLLIN, .revents = 0},
                   {.fd = signals, .events = POLLIN, .revents = 0}};
  while (seen[0].revents == 0) {  // Gauntlet says nothing but the end
    poll(seen, std::size(seen), -1);
    if (seen[1].revents == 0) continue;
    Drain(signals);
    if (int end = 0; HasEnded(program, end)) {
      Send(line, Said::kEnded, end);
      seen[1].fd = -1;
    }
  }
  EndAll(line, signals, program);
  _exit(0);
}

/// The process that starts programs: the supervisors are copies of it, so it stays small, and
/// Gauntlet's memory is copied only once.
[[noreturn]] void StartWhatIsAsked(int socket) {
  prctl(PR_SET_PDEATHSIG, 0);  // not with the thread, but with the process, by its socket
  setpgid(0, 0);               // nor with who ends Gauntlet's group
  if (socket <= STDERR_FILENO) socket = fcntl(socket, F_DUPFD, STDERR_FILENO + 1);
  KeepOnly({socket});
  // The processor time of a supervisor that was waited for is also that of this one, and so of
  // Gauntlet.
  const auto wait_for_ended = [] {
    pid_t ended = 0;
    do {
      ended = waitpid(-1, nullptr, WNOHANG);
    } while (ended > 0);
    return ended < 0;
  };
  Handed handed = {};
  while (TakeHanded(socket, handed)) {
    wait_for_ended();
    const pid_t supervisor = fork();
    if (supervisor == 0) {
      close(socket);
      Supervise(handed);
    }
    if (supervisor < 0) Send(handed.back(), Said::kStarted, errno);
    for (const int descriptor : handed) close(descriptor);
  }
  constexpr int kMoments = 50;  // for those that are just ending
  constexpr int kMomentMs = 2;
  for (int i = 0; i < kMoments && !wait_for_ended(); ++i) poll(nullptr, 0, kMomentMs);
  _exit(0);
}

/// Starts that process when it is needed.
class Starter {
 public:
  Starter() = default;
  ~Starter() { End(); }
  Starter(const Starter&) = delete;
  Starter& operator=(const Starter&) = delete;
  /// Errors: std::system_error.
  void Start(const Handed& handed) {
    const std::lock_guard lock(mutex_);
    if (process_ && Hand(socket_.get(), handed)) return;
    Begin();
    if (!Hand(socket_.get(), handed)) throw SystemError();
  }
  void End() {
    const std::lock_guard lock(mutex_);
    if (!process_) return;
    shutdown(socket_.get(), SHUT_RDWR);
    process_->Wait();
    process_.reset();
    socket_.Close();
  }

 private:
  void Begin() {
    process_.reset();
    int ends[2] = {-1, -1};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) throw SystemError();
    socket_.Set(ends[0]);
    const Descriptor other(ends[1]);
    process_.emplace([&other] { StartWhatIsAsked(other.get()); });
  }

  std::mutex mutex_;
  Descriptor socket_;
  std::optional<ChildProcess> process_;
};

Starter& TheStarter() {
  static Starter starter;
  return starter;
}

}  // namespace

void ForgetSurroundings() { TheStarter().End(); }

SupervisedProcess::SupervisedProcess(const ProgramCommand& command,
                                     const std::array<int, 3>& streams) {
  int ends[2] = {-1, -1};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) throw SystemError();
  supervisor_.Set(ends[0]);
  {
    const Descriptor other(ends[1]);
    TheStarter().Start({streams[0], streams[1], streams[2], other.get()});
  }
  bool is_sent =
      SendWord(ends[0], kFolder, command.folder) && SendWord(ends[0], kProgram, command.program);
  for (const std::string& word : command.words) {
    if (word.size() >= kLongestWord) throw SystemError(E2BIG);
    is_sent = is_sent && SendWord(ends[0], kWord, word);
  }
  if (!is_sent || !SendWord(ends[0], kGo, "")) throw SystemError();
  Message started;
  ssize_t got = 0;
  do {
    got = recv(ends[0], &started, sizeof started, 0);
  } while (got < 0 && errno == EINTR);
  if (got != sizeof started) throw SystemError(ECHILD);
  if (started.number != 0) throw SystemError(started.number);
  setsockopt(ends[0], SOL_SOCKET, SO_RCVTIMEO, &kMostOfSupervisor, sizeof kMostOfSupervisor);
}

bool SupervisedProcess::Receive(int flags) {
  Message message;
  ssize_t got = 0;
  do {
    got = recv(supervisor_.get(), &message, sizeof message, flags);
  } while (got < 0 && errno == EINTR);
  if (got != sizeof message) return false;
  if (message.said == Said::kEnded) {
    end_ =
        ChildEnd{.signal = std::max(-message.number, 0), .exit_code = std::max(message.number, 0)};
  }
  if (message.said == Said::kWasLeft) left_.ended.emplace_back(message.text);
  if (message.said == Said::kIsLeft) left_.running.emplace_back(message.text);
  return true;
}

std::optional<ChildEnd> SupervisedProcess::End() {
  while (!end_ && Receive(MSG_DONTWAIT)) {
  }
  return end_;
}

LeftGroup SupervisedProcess::Kill() {
  if (supervisor_.get() < 0) return {};
  shutdown(supervisor_.get(), SHUT_WR);
  while (Receive(0)) {
  }
  supervisor_.Close();
  return std::exchange(left_, {});
}

}  // namespace gauntlet::sim
