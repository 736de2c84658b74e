#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace gauntlet::python {

class ExecutorParts;
struct OwnFilters;

/// Reports of long work to its caller, from any thread.
class LongWork {
 public:
  /// False: the caller wants it to stop.
  bool Progress(double done, double all);
  void Remark(const std::string& line);

  double done() const { return done_; }
  double all() const { return all_; }
  std::vector<std::string> RemoveRemarks();

 private:
  std::atomic<double> done_{0.0};
  std::atomic<double> all_{0.0};
  std::mutex mutex_;
  std::vector<std::string> remarks_;
};

/// Runs `work` in a thread of its own, without the GIL. Meanwhile the caller's thread looks for
/// signals and calls `on_progress(done, all)`, unless it is None: an exception of either stops the
/// work and is thrown. Long calls take turns, because stopping is a matter of the whole process.
/// Returns the remarks of the work. Errors: those of `work`; RunError for a call from
/// `on_progress` or from a filter of the caller. `elsewhere`: parts of the work that an executor
/// computes; null: none.
std::vector<std::string> RunLong(const pybind11::object& on_progress,
                                 const std::function<void(LongWork&)>& work,
                                 ExecutorParts* elsewhere = nullptr);

/// Runs a part of the long call `call`: in this thread within that call, where it runs in this
/// process, as with a pool of threads; in another process as a long call of its own, with these
/// filters.
void RunPartOf(const std::string& call, const OwnFilters& own_filters,
               const std::function<void()>& work);

/// Stops the long call of another thread, and lets none begin any more: before Python ends, which
/// would end that thread in the middle of C++.
void EndLongCalls();

}  // namespace gauntlet::python
