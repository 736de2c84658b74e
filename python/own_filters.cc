#include "python/own_filters.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controller/settings.h"
#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/base/text.h"
#include "sim/results/table_text.h"
#include "sim/trial/external/stepper.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;

/// Python's state of a thread of ours. It lives as long as the thread: making one for each sample
/// would cost more than the sample, and thread-local values of Python would be lost.
class ThreadState {
 public:
  ThreadState() : before_(PyGILState_Ensure()), state_(PyEval_SaveThread()) {}
  ~ThreadState() {
    PyEval_RestoreThread(state_);
    PyGILState_Release(before_);
  }
  ThreadState(const ThreadState&) = delete;
  ThreadState& operator=(const ThreadState&) = delete;

 private:
  PyGILState_STATE before_;
  PyThreadState* state_;
};

class Gil {
 public:
  Gil() {
    static thread_local std::optional<ThreadState> state;
    if (PyGILState_GetThisThreadState() == nullptr) state.emplace();
    before_ = PyGILState_Ensure();
  }
  ~Gil() { PyGILState_Release(before_); }
  Gil(const Gil&) = delete;
  Gil& operator=(const Gil&) = delete;

 private:
  PyGILState_STATE before_;
};

/// A call of an object, with the GIL. Threads in such calls are known, so that a stop reaches them.
class Call {
 public:
  /// Errors: Cancelled.
  Call() : thread_(PyThread_get_thread_ident()) {
    if (sim::StopAsked()) throw sim::Cancelled{};
    Calling().insert(thread_);
    is_calling = true;
  }
  ~Call() {
    Calling().erase(thread_);
    is_calling = false;
    if (sim::StopAsked()) PyThreadState_SetAsyncExc(thread_, nullptr);  // one that came too late
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  static bool IsInThisThread() { return is_calling; }
  /// Guarded by the GIL.
  static std::set<unsigned long>& Calling() {
    static std::set<unsigned long> calling;
    return calling;
  }

 private:
  static inline thread_local bool is_calling = false;
  Gil gil_;
  unsigned long thread_;
};

/// Throws what was raised in an object. Errors: Cancelled, SettingError for a function over arrays
/// that looks ahead, else RunError.
[[noreturn]] void Rethrow(const py::error_already_set& raised) {
  if (sim::StopAsked()) throw sim::Cancelled{};
  std::string reason;
  bool looks_ahead = false;
  try {
    const py::module_ filters = py::module_::import("gauntlet._filters");
    looks_ahead = raised.matches(filters.attr("LooksAhead"));
    const py::object trace = raised.trace() ? raised.trace() : py::none();
    reason = py::str(filters.attr("reason")(raised.value(), trace));
  } catch (const py::error_already_set&) {
    reason = "raised an exception that cannot be shown";
  }
  reason = sim::OneLine(reason);
  if (looks_ahead) throw controller::SettingError("", reason);
  throw sim::RunError(reason);
}

std::string TypeName(const py::handle& object) {
  return py::str(py::type::handle_of(object).attr("__name__"));
}

/// An object with step(sample), and start_channel(channel) if it is told of a new start.
class ObjectStepper final : public sim::Stepper {
 public:
  ObjectStepper(const py::object& make, const sim::FilterFacts& facts) : channels_(facts.channels) {
    const Call call;
    try {
      py::dict parameters;
      for (const auto& [name, value] : facts.parameters) parameters[py::str(name)] = value;
      const py::object filter = make(facts.rate_hz, facts.channels, parameters);
      step_ = filter.attr("step");
      start_channel_ = py::getattr(filter, "start_channel", py::none());
    } catch (const py::error_already_set& raised) {
      Rethrow(raised);
    }
  }
  ~ObjectStepper() override {
    const Gil gil;
    step_ = {};
    start_channel_ = {};
  }

  void Step(std::span<const double> input, std::span<double> output) override {
    const Call call;
    try {
      CopyAnswer(step_(py::array_t<double>(static_cast<py::ssize_t>(input.size()), input.data())),
                 output);
    } catch (const py::error_already_set& raised) {
      Rethrow(raised);
    }
  }

  void StartChannel(int channel) override {
    if (start_channel_.is_none()) return;
    const Call call;
    try {
      start_channel_(channel);
    } catch (const py::error_already_set& raised) {
      Rethrow(raised);
    }
  }

 private:
  /// Errors: RunError.
  void CopyAnswer(const py::object& answer, std::span<double> output) const {
    const auto fail = [&output](const std::string& returned) {
      throw sim::RunError(fmt::format("returned {}, must be an array of {}", returned,
                                      sim::Counted(std::ssize(output), "number")));
    };
    const py::array any = py::array::ensure(answer);
    PyErr_Clear();
    const char kind = any ? any.dtype().kind() : 'O';
    const bool is_real = kind == 'f' || kind == 'i' || kind == 'u';
    if (!is_real || any.ndim() == 0) fail(TypeName(answer));
    if (any.ndim() != 1) fail(fmt::format("an array of {} dimensions", any.ndim()));
    if (any.size() != std::ssize(output)) {
      fail(sim::Counted(any.size(), "value"));
    }
    const auto values = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(any);
    if (!values) throw py::error_already_set();
    const std::span<const double> from(values.data(), output.size());
    const auto bad = std::ranges::find_if(from, [](double value) { return !std::isfinite(value); });
    if (bad != from.end()) {
      throw sim::RunError(fmt::format("returned {} for {}, must be finite", *bad,
                                      channels_[static_cast<std::size_t>(bad - from.begin())]));
    }
    std::ranges::copy(from, output.begin());
  }

  std::vector<std::string> channels_;
  py::object step_;
  py::object start_channel_;  // None: goes on from the last value
};

}  // namespace

sim::OwnObjects OwnObjectsOf(const py::dict& filters) {
  sim::OwnObjects objects;
  for (const auto& [name, given] : filters) {
    const auto [make, identity] = given.cast<std::pair<py::object, std::string>>();
    const std::shared_ptr<const py::object> held(new py::object(make), [](const py::object* last) {
      const Gil gil;
      delete last;
    });
    objects[name.cast<std::string>()] = {.identity = identity,
                                         .make = [held](const sim::FilterFacts& facts) {
                                           return std::make_unique<ObjectStepper>(*held, facts);
                                         }};
  }
  return objects;
}

bool IsInOwnFilter() { return Call::IsInThisThread(); }

void InterruptOwnFilters() {
  for (const unsigned long thread : Call::Calling()) {
    PyThreadState_SetAsyncExc(thread, PyExc_KeyboardInterrupt);
  }
}

}  // namespace gauntlet::python
