#include "python/long_call.h"

#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <initializer_list>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "python/elsewhere.h"
#include "python/own_filters.h"
#include "python/sources.h"
#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/trial/external/program.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;
using namespace std::chrono_literals;

constexpr auto kPatience = 50ms;         // between two looks for signals
constexpr auto kPatienceForParts = 5ms;  // a search waits for the parts of each setting

/// The right to run long work; one thread has it.
class Turn {
 public:
  /// Errors: RunError for the thread that has it already; what a signal handler of Python raises.
  Turn() {
    if (owner == std::this_thread::get_id()) {
      throw sim::RunError("a progress callback cannot begin another long call");
    }
    if (IsInOwnFilter()) throw sim::RunError("a filter cannot begin another long call");
    Wait();
    if (has_ended()) {
      mutex.unlock();
      throw sim::RunError("Python is ending");
    }
    owner = std::this_thread::get_id();
    sim::stop_signal = 0;
  }
  ~Turn() {
    sim::stop_signal = 0;
    owner = std::thread::id();
    mutex.unlock();
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  /// Stops the work that runs now, waits for its end, and lets none begin any more.
  static void End() {
    end_thread = std::this_thread::get_id();
    for (bool taken = false; !taken;) {
      sim::stop_signal = SIGTERM;
      InterruptOwnFilters();
      const py::gil_scoped_release unlocked;
      taken = mutex.try_lock_for(kPatience);
    }
    mutex.unlock();
    const py::gil_scoped_release unlocked;
    while (waiting > 0) std::this_thread::sleep_for(1ms);
  }
  static bool has_ended() { return end_thread.load() != std::thread::id(); }
  /// True for the thread that called End().
  static bool is_in_end() { return end_thread.load() == std::this_thread::get_id(); }

 private:
  struct Waiting {
    Waiting() { ++waiting; }
    ~Waiting() { --waiting; }
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;
  };

  /// Errors: what a signal handler of Python raises.
  static void Wait() {
    const Waiting here;
    for (bool taken = false; !taken;) {
      {
        const py::gil_scoped_release unlocked;
        taken = mutex.try_lock_for(kPatience);
      }
      if (!taken && PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
  }

  static inline std::atomic<int> waiting{0};
  static inline std::atomic<std::thread::id> end_thread;
  static inline std::timed_mutex mutex;
  static inline std::atomic<std::thread::id> owner;
};

/// A long call with parts that run in other threads of this process, while this object lives.
class CallWithParts {
 public:
  explicit CallWithParts(const std::string& call) {
    const std::lock_guard lock(mutex);
    process = getpid();
    known.insert(call);
    current = call;
  }
  /// Stops the parts that run still.
  ~CallWithParts() {
    const py::gil_scoped_release unlocked;
    std::unique_lock lock(mutex);
    current.clear();
    sim::stop_signal = SIGTERM;
    ended.wait(lock, [] { return running == 0; });
  }
  CallWithParts(const CallWithParts&) = delete;
  CallWithParts& operator=(const CallWithParts&) = delete;

  /// Runs `work` if this is the process of the call; false if it is not. Without the GIL.
  /// Errors: Cancelled where the call has ended.
  static bool RunWithin(const std::string& call, const std::function<void()>& work) {
    {
      const std::lock_guard lock(mutex);
      if (!known.contains(call) || process != getpid()) return false;  // a child knows it, too
      if (current != call) throw sim::Cancelled{};
      ++running;
    }
    struct End {
      ~End() {
        const std::lock_guard lock(mutex);
        --running;
        ended.notify_all();
      }
    } end;
    work();
    return true;
  }

 private:
  static inline std::mutex mutex;
  static inline std::condition_variable ended;
  static inline pid_t process = 0;
  static inline std::set<std::string> known;
  static inline std::string current;
  static inline int running = 0;
};

/// In this scope new threads get no signals: Python's handlers interrupt system calls.
class NoSignals {
 public:
  NoSignals() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM, SIGUSR1, SIGUSR2}) {
      sigaddset(&signals, signal);
    }
    pthread_sigmask(SIG_BLOCK, &signals, &before_);
  }
  ~NoSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  NoSignals(const NoSignals&) = delete;
  NoSignals& operator=(const NoSignals&) = delete;

 private:
  sigset_t before_ = {};
};

/// The thread of the work.
class Worker {
 public:
  Worker(const std::function<void(LongWork&)>& work, LongWork& state) {
    const NoSignals scope;
    thread_ = std::thread([this, &work, &state] {
      try {
        work(state);
      } catch (...) {
        error_ = std::current_exception();
      }
      {
        const std::lock_guard lock(mutex_);
        has_ended_ = true;
      }
      ended_.notify_all();
    });
  }
  ~Worker() {
    const py::gil_scoped_release unlocked;  // which the thread's Python state needs to end
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// True if the work has ended within the time.
  bool WaitFor(std::chrono::milliseconds time) {
    const py::gil_scoped_release unlocked;
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, time, [this] { return has_ended_; });
  }
  const std::exception_ptr& error() const { return error_; }

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool has_ended_ = false;
  std::exception_ptr error_;
  std::thread thread_;
};

/// Adds to the exception that stopped the work what of it is kept.
void AddNote(const py::error_already_set& raised, const std::exception_ptr& error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const sim::Cancelled& cancelled) {
    if (!cancelled.kept.empty()) raised.value().attr("add_note")(cancelled.kept);
  } catch (...) {  // what failed while it was stopped is not the reason
  }
}

std::vector<std::string> RunInTurn(const py::object& on_progress,
                                   const std::function<void(LongWork&)>& work,
                                   ExecutorParts* elsewhere) {
  const Turn turn;
  std::optional<CallWithParts> parts;
  if (elsewhere != nullptr) parts.emplace(elsewhere->call());
  LongWork state;
  std::optional<py::error_already_set> raised;
  double told = 0.0;
  const auto look = [&](double done) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (elsewhere != nullptr) elsewhere->Look();
    if (on_progress.is_none() || done == told) return;
    told = done;
    on_progress(done, state.all());
  };
  Worker worker(work, state);
  while (!worker.WaitFor(elsewhere == nullptr ? kPatience : kPatienceForParts)) {
    if (raised) continue;
    try {
      look(state.done());
    } catch (py::error_already_set& error) {
      raised.emplace(error);
      sim::stop_signal = SIGINT;
      InterruptOwnFilters();
    }
  }
  if (!raised && !worker.error()) look(state.all());
  if (raised) {
    AddNote(*raised, worker.error());
    throw *std::move(raised);
  }
  if (worker.error()) std::rethrow_exception(worker.error());
  for (const std::string& line : sim::TakeLeftProcesses()) state.Remark("warning: " + line);
  return state.RemoveRemarks();
}

}  // namespace

bool LongWork::Progress(double done, double all) {
  all_ = all;
  done_ = done;
  return !sim::StopAsked();
}

void LongWork::Remark(const std::string& line) {
  const std::lock_guard lock(mutex_);
  remarks_.push_back(line);
}

std::vector<std::string> LongWork::RemoveRemarks() {
  const std::lock_guard lock(mutex_);
  return std::exchange(remarks_, {});
}

void EndLongCalls() { Turn::End(); }

std::vector<std::string> RunLong(const py::object& on_progress,
                                 const std::function<void(LongWork&)>& work,
                                 ExecutorParts* elsewhere) {
  std::vector<std::string> remarks;
  std::exception_ptr error;
  try {
    remarks = RunInTurn(on_progress, work, elsewhere);
  } catch (...) {
    error = std::current_exception();
  }
  if (Turn::has_ended() && !Turn::is_in_end()) {
    // A daemon thread, for which Python does not wait. If it prints its exception while standard
    // error is closed, Python 3.13 ends by SIGABRT.
    const py::gil_scoped_release unlocked;
    while (true) std::this_thread::sleep_for(1h);
  }
  if (error) std::rethrow_exception(error);
  return remarks;
}

void RunPartOf(const std::string& call, const OwnFilters& own_filters,
               const std::function<void()>& work) {
  {
    const py::gil_scoped_release unlocked;
    if (CallWithParts::RunWithin(call, work)) return;
  }
  RunLong(py::none(), [&](LongWork&) {
    const OwnFiltersOfCall scope(own_filters, call);
    work();
  });
}

}  // namespace gauntlet::python
