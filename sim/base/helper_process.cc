#include "sim/base/helper_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/landlock.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/process_limits.h"

namespace gauntlet::sim {
namespace {

constexpr int kPollsPerSecond = 20;
constexpr std::size_t kLongestError = 1000;

/// Two limits: the timer has a resolution of microseconds and a signal of its own (SIGPROF). The
/// work could switch it off, but not the limit in whole seconds.
void LimitProcessorTime(double limit_s) {
  const auto whole_s = static_cast<std::int64_t>(limit_s);
  itimerval timer = {};
  timer.it_value.tv_sec = whole_s;
  timer.it_value.tv_usec = static_cast<std::int64_t>((limit_s - whole_s) * 1e6);
  setitimer(ITIMER_PROF, &timer, nullptr);
  LimitResource(RLIMIT_CPU, static_cast<rlim_t>(whole_s + 2));
}

std::shared_mutex& StartOfHelpers() {
  static std::shared_mutex mutex;
  return mutex;
}

/// Processor time of a child that runs; 0 if the system does not report it.
double ProcessorTimeOf(pid_t process) {
  clockid_t clock = 0;
  timespec time = {};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0.0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

bool WriteAll(int pipe, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = write(pipe, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    data += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace

std::shared_lock<std::shared_mutex> HoldHelpers() { return std::shared_lock(StartOfHelpers()); }

void HelperProcess::WriteFrame(int pipe, Frame frame, std::span<const char> bytes) {
  FrameHead head = {};
  head.frame = frame;
  head.size = static_cast<std::uint32_t>(bytes.size());
  const bool written = WriteAll(pipe, reinterpret_cast<const char*>(&head), sizeof head) &&
                       WriteAll(pipe, bytes.data(), bytes.size());
  if (!written) _exit(1);  // the program no longer reads
}

void HelperProcess::Work(const std::function<void(const Send&)>& work, const HelperLimits& limits,
                         int pipe) {
  for (const int signal : {SIGPIPE, SIGPROF, SIGXFSZ}) std::signal(signal, SIG_DFL);
  if (pipe <= STDERR_FILENO) pipe = fcntl(pipe, F_DUPFD, STDERR_FILENO + 1);
  KeepOnly({pipe});
  DropRights();
  LimitProcessorTime(limits.processor_s);
  LimitMemory(limits.memory_bytes);
  std::string error;
  try {
    work([pipe](std::span<const char> bytes) { WriteFrame(pipe, Frame::kBytes, bytes); });
    WriteFrame(pipe, Frame::kEnd, {});
    _exit(0);
  } catch (const std::bad_alloc&) {
    error = fmt::format("takes more than {} MB of memory", limits.memory_bytes >> 20);
  } catch (const std::exception& exception) {
    error = exception.what();
  } catch (...) {
    error = "unknown exception";
  }
  error.resize(std::min(error.size(), kLongestError));
  WriteFrame(pipe, Frame::kError, error);
  _exit(1);
}

HelperProcess::HelperProcess(const std::function<void(const Send&)>& work,
                             const HelperLimits& limits, std::function<bool()> keep_going)
    : limits_(limits), keep_going_(std::move(keep_going)) {
  try {
    int ends[2] = {-1, -1};
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category());
    pipe_.Set(ends[0]);
    const Descriptor of_helper(ends[1]);
    const std::unique_lock nobody_holds(StartOfHelpers());
    process_.emplace([&] { Work(work, limits, of_helper.get()); });
  } catch (const std::system_error& error) {
    throw RunError("cannot start a helper process: " + error.code().message());
  }
  fcntl(pipe_.get(), F_SETPIPE_SZ, 1 << 20);  // fewer switches between the processes
}

void HelperProcess::ThrowEnded() {
  process_->Kill();  // in case it only closed the pipe
  const std::optional<ChildEnd> end = process_->Wait();
  if (!end || end->signal == 0) throw HelperEnded("ended too early");
  if (end->signal == SIGPROF) {
    throw HelperEnded(fmt::format("took more than {} s of processor time", limits_.processor_s));
  }
  throw HelperEnded(TextOf(*end));
}

void HelperProcess::WaitForBytes() {
  // Counts polls instead of reading a clock: a program that was stopped for an hour continues.
  for (int polls = 0; polls < limits_.silence_s * kPollsPerSecond; ++polls) {
    if (keep_going_ && !keep_going_()) throw Cancelled{};
    pollfd waiting = {.fd = pipe_.get(), .events = POLLIN, .revents = 0};
    if (poll(&waiting, 1, 1000 / kPollsPerSecond) > 0) return;
    // A large file on a slow disk is read for minutes before the first byte of an answer. What it
    // may use in all is limited by the size of the file (processor_s).
    constexpr double kProgress_s = 1e-3;
    if (const double now_s = ProcessorTimeOf(process_->id()); now_s - processor_s_ > kProgress_s) {
      processor_s_ = now_s;
      polls = 0;
    }
  }
  throw HelperSilent(
      fmt::format("gave nothing for {} s: this machine is too busy, or does not get at "
                  "its files",
                  limits_.silence_s));
}

std::size_t HelperProcess::ReadSome(std::span<char> bytes) {
  constexpr std::size_t kReadAhead = std::size_t{1} << 16;  // for many small answers
  while (given_ == read_ahead_.size()) {
    WaitForBytes();
    read_ahead_.resize(kReadAhead);
    given_ = 0;
    const ssize_t size = read(pipe_.get(), read_ahead_.data(), read_ahead_.size());
    const bool is_interrupted = size < 0 && errno == EINTR;
    read_ahead_.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    if (size <= 0 && !is_interrupted) ThrowEnded();
  }
  const std::size_t size = read_ahead_.copy(bytes.data(), bytes.size(), given_);
  given_ += size;
  return size;
}

void HelperProcess::ReadAll(std::span<char> bytes) {
  while (!bytes.empty()) bytes = bytes.subspan(ReadSome(bytes));
}

bool HelperProcess::NextFrame() {
  if (is_done_) return false;
  FrameHead head = {};
  ReadAll({reinterpret_cast<char*>(&head), sizeof head});
  if (head.frame == Frame::kError) {
    std::string error(std::min<std::size_t>(head.size, kLongestError), '\0');
    ReadAll(error);
    throw HelperError(error);
  }
  left_of_frame_ = head.size;
  is_done_ = head.frame == Frame::kEnd;
  return !is_done_;
}

std::size_t HelperProcess::ReceiveSome(std::span<char> bytes) {
  while (left_of_frame_ == 0) {
    if (!NextFrame()) return 0;
  }
  const std::size_t size = ReadSome(bytes.first(std::min(bytes.size(), left_of_frame_)));
  left_of_frame_ -= size;
  return size;
}

void HelperProcess::Receive(std::span<char> bytes) {
  while (!bytes.empty()) {
    const std::size_t size = ReceiveSome(bytes);
    if (size == 0) throw HelperEnded("ended too early");
    bytes = bytes.subspan(size);
  }
}

void HelperProcess::Finish() {
  if (left_of_frame_ > 0 || NextFrame()) throw HelperEnded("gave more than it should");
}

void OpenNoMoreFiles() { LimitResource(RLIMIT_NOFILE, 0); }

void ReadOnlyBelow(std::initializer_list<std::filesystem::path> folders) {
  constexpr std::uint64_t kReading = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
  const auto check = [](std::int64_t result) {
    if (result >= 0) return static_cast<int>(result);
    throw UserError("--inside cannot be kept for a hand here: the system has no Landlock");
  };
  landlock_ruleset_attr what = {};  // Linux 6.7 and later have more members
  what.handled_access_fs = kReading;
  const int rules = check(syscall(SYS_landlock_create_ruleset, &what, sizeof what, 0));
  for (const std::filesystem::path& folder : folders) {
    const landlock_path_beneath_attr below = {
        .allowed_access = kReading,
        .parent_fd = check(open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC))};
    check(syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &below, 0));
    close(below.parent_fd);
  }
  check(prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0));
  check(syscall(SYS_landlock_restrict_self, rules, 0));
  close(rules);
}

}  // namespace gauntlet::sim
