#pragma once

#include <pybind11/pybind11.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/study/elsewhere.h"

namespace gauntlet::python {

/// Parts of a long call that an executor of Python computes, by an object `sender` with
///
///     call            name of the call, which no other has
///     most_parts      the largest number of parts that makes sense
///     begin(parts, about)  [(first, end)], [text]: sends them; again when all before have come
///     finished()      [(number, file or None)]: parts that have come since, or will not come
class ExecutorParts final : public sim::Elsewhere {
 public:
  explicit ExecutorParts(const pybind11::object& sender)
      : sender_(sender),
        call_(sender.attr("call").cast<std::string>()),
        most_parts_(sender.attr("most_parts").cast<int>()) {}

  const std::string& call() const { return call_; }
  int most_parts() const override { return most_parts_; }

  void Begin(const std::vector<sim::WorkRange>& parts,
             const std::vector<std::string>& about) override {
    const std::lock_guard lock(mutex_);
    to_send_ = {parts, about};
  }

  std::optional<Part> Next(std::chrono::milliseconds patience) override {
    std::unique_lock lock(mutex_);
    came_.wait_for(lock, patience, [this] { return !parts_.empty(); });
    if (parts_.empty()) return std::nullopt;
    Part part = std::move(parts_.front());
    parts_.pop_front();
    return part;
  }

  /// In the thread of the caller, several times per second. Errors: what Python raises.
  void Look() {
    std::optional<Question> to_send;
    {
      const std::lock_guard lock(mutex_);
      to_send.swap(to_send_);
    }
    if (to_send) {
      pybind11::list ranges, about;
      for (const auto& [first, end] : to_send->first) {
        ranges.append(pybind11::make_tuple(first, end));
      }
      for (const std::string& text : to_send->second) about.append(pybind11::str(text));
      sender_.attr("begin")(ranges, about);
      is_sent_ = true;
    }
    if (!is_sent_) return;
    for (const pybind11::handle item : sender_.attr("finished")()) {
      const auto [number, file] = item.cast<std::pair<std::size_t, std::optional<std::string>>>();
      const std::lock_guard lock(mutex_);
      parts_.push_back({.number = number, .database = file.value_or("")});
      came_.notify_one();
    }
  }

 private:
  using Question = std::pair<std::vector<sim::WorkRange>, std::vector<std::string>>;

  const pybind11::object sender_;
  const std::string call_;
  const int most_parts_;
  bool is_sent_ = false;
  std::mutex mutex_;
  std::condition_variable came_;
  std::optional<Question> to_send_;
  std::deque<Part> parts_;
};

/// Null for None.
inline std::unique_ptr<ExecutorParts> PartsOf(const pybind11::object& executor) {
  return executor.is_none() ? nullptr : std::make_unique<ExecutorParts>(executor);
}

}  // namespace gauntlet::python
