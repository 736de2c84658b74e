#include "sim/study/trial_queue.h"

#include <algorithm>
#include <utility>

namespace gauntlet::sim {

TrialQueue::TrialQueue(std::size_t seeds, std::size_t controllers, std::size_t jobs)
    : controllers_(controllers), tasks_(controllers * seeds), threads_(std::min(jobs, tasks_)) {}

std::optional<TrialTask> TrialQueue::Next() {
  const std::lock_guard lock(mutex_);
  if (stopped_ || next_task_ == tasks_) return std::nullopt;
  const std::size_t place = next_task_ % controllers_;
  if (place == 0) gloves_ = std::exchange(next_gloves_, SeedGloves{});
  TrialTask task = {
      .seed_index = next_task_ / controllers_, .controller = place, .gloves = gloves_, .next = {}};
  ++next_task_;
  // The last tasks of a seed run on all threads. The first of these tasks makes the next glove, so
  // that no thread waits for it later.
  const bool is_last_seed = (task.seed_index + 1) * controllers_ == tasks_;
  if (threads_ > 1 && place > 0 && place + threads_ == controllers_ && !is_last_seed) {
    task.next = next_gloves_;
  }
  if (place + 1 == controllers_) gloves_ = {};
  return task;
}

}  // namespace gauntlet::sim
