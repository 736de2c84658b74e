#include "tests/support/program.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <utility>

namespace gauntlet::test {
namespace {

struct Pipe {
  int read_end = -1;
  int write_end = -1;
};

[[noreturn]] void Fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

/// The near end of a new pseudo-terminal.
int MakeTerminal() {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0) Fail(errno, "terminal");
  return terminal;
}

/// The name of its far end.
std::string NameOfTerminal(int terminal) {
  char name[64] = {};
  if (ptsname_r(terminal, name, sizeof name) != 0) Fail(errno, "terminal");
  return name;
}

Pipe MakePipe() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) Fail(errno, "pipe");
  return {ends[0], ends[1]};
}

void Close(int& descriptor) {
  if (descriptor >= 0) close(descriptor);
  descriptor = -1;
}

void SetNonBlocking(int descriptor) {
  fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) | O_NONBLOCK);
}

/// KEY=VALUE strings: the inherited ones that are not replaced, then the given ones.
std::vector<std::string> EnvironmentOf(const ProgramOptions& options) {
  std::vector<std::string> result;
  for (char** entry = environ; options.inherit_environment && *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::string key(text.substr(0, text.find('=')));
    if (!options.environment.contains(key)) result.emplace_back(text);
  }
  for (const auto& [key, value] : options.environment) result.push_back(key + "=" + value);
  return result;
}

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

/// posix_spawn and not fork: a test may have threads (MuJoCo, sanitizers) when it starts a program.
/// `terminal`: name of the one that is input and error; empty: none.
pid_t Spawn(std::vector<std::string> command, const ProgramOptions& options, int input, int output,
            int error, const std::string& terminal) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (terminal.empty()) {
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  } else {
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, terminal.c_str(), O_RDWR, 0);
  }
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, terminal.empty() ? error : STDIN_FILENO,
                                   STDERR_FILENO);
  if (!options.working_directory.empty()) {
    posix_spawn_file_actions_addchdir_np(&actions, options.working_directory.c_str());
  }

  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // A session of its own, which has a process group, gets the terminal that it opens first: then
  // Ctrl-C is a signal.
  const int group = terminal.empty() ? POSIX_SPAWN_SETPGROUP : POSIX_SPAWN_SETSID;
  posix_spawnattr_setflags(&attributes, static_cast<short>(group | POSIX_SPAWN_SETSIGDEF));
  posix_spawnattr_setpgroup(&attributes, 0);
  sigset_t defaults;
  sigemptyset(&defaults);
  // A shell ignores some of them for what it starts in the background: this test, say.
  for (const int signal : {SIGPIPE, SIGINT, SIGQUIT, SIGHUP}) sigaddset(&defaults, signal);
  posix_spawnattr_setsigdefault(&attributes, &defaults);

  std::vector<std::string> environment = EnvironmentOf(options);
  pid_t process = -1;
  const int problem = posix_spawnp(&process, command.front().c_str(), &actions, &attributes,
                                   Pointers(command).data(), Pointers(environment).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (problem != 0) Fail(problem, command.front());
  return process;
}

/// Appends what is there now; closes the descriptor at its end.
void Drain(int& descriptor, std::string& text) {
  char buffer[65536];
  while (descriptor >= 0) {
    const ssize_t count = read(descriptor, buffer, sizeof buffer);
    if (count > 0) {
      text.append(buffer, static_cast<std::size_t>(count));
    } else if (count == 0 || errno != EINTR) {
      if (count == 0 || errno != EAGAIN) Close(descriptor);
      return;
    }
  }
}

}  // namespace

Program::Program(const std::vector<std::string>& command, ProgramOptions options)
    : options_(std::move(options)), deadline_(std::chrono::steady_clock::now() + options_.timeout) {
  // A program that ends before it has read its input must not end the test.
  std::signal(SIGPIPE, SIG_IGN);
  Pipe input = MakePipe();
  Pipe output = MakePipe();
  Pipe error = MakePipe();
  input_ = input.write_end;
  output_ = output.read_end;
  error_ = error.read_end;
  std::string terminal;
  if (options_.on_terminal) {
    for (int* near_end : {&input_, &error_}) Close(*near_end);
    error_ = MakeTerminal();
    input_ = fcntl(error_, F_DUPFD_CLOEXEC, 0);
    terminal = NameOfTerminal(error_);
  }
  const auto close_far_ends = [&] {
    Close(input.read_end);
    Close(output.write_end);
    Close(error.write_end);
  };
  try {
    process_ =
        Spawn(command, options_, input.read_end, output.write_end, error.write_end, terminal);
  } catch (...) {
    close_far_ends();
    for (int* near_end : {&input_, &output_, &error_}) Close(*near_end);
    throw;
  }
  close_far_ends();
  for (const int near_end : {input_, output_, error_}) SetNonBlocking(near_end);
}

Program::~Program() {
  if (!ended_) {
    kill(-process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  for (int* near_end : {&input_, &output_, &error_}) Close(*near_end);
}

bool Program::WaitForText(std::string_view text) {
  const auto seen = [&] {
    return result_.standard_output.find(text) != std::string::npos ||
           result_.standard_error.find(text) != std::string::npos;
  };
  while (!seen()) {
    if (!Advance()) return seen();
  }
  return true;
}

bool Program::WaitForPath(const std::filesystem::path& path) {
  while (!std::filesystem::exists(path)) {
    if (!Advance()) return std::filesystem::exists(path);
  }
  return true;
}

bool Program::WaitForHandlerOf(int signal) {
  const auto handled = [&] {
    std::ifstream status("/proc/" + std::to_string(process_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (!line.starts_with("SigCgt:")) continue;
      return (std::stoull(line.substr(line.find_last_of(" \t")), nullptr, 16) >> (signal - 1) &
              1) != 0;
    }
    return false;
  };
  while (!handled()) {
    if (!Advance()) return false;
  }
  return true;
}

void Program::SendSignal(int signal) {
  if (!ended_) kill(process_, signal);
}

void Program::Type(std::string_view text) { options_.standard_input += text; }

const ProgramResult& Program::Wait() {
  while (Advance()) {
  }
  return result_;
}

bool Program::Advance() {
  if (ended_) return false;
  // Short, because the end of a program that has closed its pipes wakes nobody.
  constexpr int kPollMs = 5;
  const bool has_input = input_written_ < options_.standard_input.size() || !options_.on_terminal;
  pollfd waiting[] = {
      {has_input ? input_ : -1, POLLOUT, 0}, {output_, POLLIN, 0}, {error_, POLLIN, 0}};
  poll(waiting, std::size(waiting), kPollMs);
  WriteInput();
  ReadOutput();

  int status = 0;
  rusage used{};
  if (wait4(process_, &status, WNOHANG, &used) == process_) {
    ended_ = true;
    result_.peak_memory_kib = used.ru_maxrss;
    ReadOutput();
    if (WIFEXITED(status)) result_.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result_.signal = WTERMSIG(status);
    kill(-process_, SIGKILL);  // what it left behind
    return false;
  }
  if (!result_.timed_out && std::chrono::steady_clock::now() > deadline_) {
    result_.timed_out = true;
    kill(-process_, SIGKILL);
  }
  return true;
}

void Program::WriteInput() {
  if (input_ < 0) return;
  const std::string_view rest = std::string_view(options_.standard_input).substr(input_written_);
  const ssize_t count = rest.empty() ? 0 : write(input_, rest.data(), rest.size());
  if (count > 0) input_written_ += static_cast<std::size_t>(count);
  const bool broken = count < 0 && errno != EAGAIN && errno != EINTR;
  const bool is_all = input_written_ == options_.standard_input.size() && !options_.on_terminal;
  if (broken || is_all) Close(input_);
}

void Program::ReadOutput() {
  Drain(output_, result_.standard_output);
  Drain(error_, result_.standard_error);
}

ProgramResult RunProgram(const std::vector<std::string>& command, const ProgramOptions& options) {
  return Program(command, options).Wait();
}

TemporaryDirectory::TemporaryDirectory() {
  std::string name = std::filesystem::temp_directory_path() / "gauntlet-test-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) Fail(errno, name);
  path_ = name;
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace gauntlet::test
