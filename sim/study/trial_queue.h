#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>

#include "sim/study/study.h"

namespace gauntlet::sim {

/// The glove signals of one seed, made by the first trial that needs them. They live as long as
/// the tasks that hold them.
struct SeedGloves {
  struct Shared {
    std::once_flag once;
    std::shared_ptr<const GloveSignal> signal;
    Signal reference_rad;  // ticks x joints of the hand
  };
  std::shared_ptr<Shared> shared = std::make_shared<Shared>();
  /// Only where the noise-free twin is a trial of its own.
  std::shared_ptr<std::optional<GloveSignal>> noise_free =
      std::make_shared<std::optional<GloveSignal>>();
};

/// One controller of one seed.
struct TrialTask {
  std::size_t seed_index = 0;
  std::size_t controller = 0;
  SeedGloves gloves;
  std::optional<SeedGloves> next;  // of the next seed, if this task makes them
};

/// The trials of a study as tasks, in the order of the seeds. Any thread may call it.
class TrialQueue {
 public:
  TrialQueue(std::size_t seeds, std::size_t controllers, std::size_t jobs);

  /// None after the last task, or after Stop().
  std::optional<TrialTask> Next();
  void Stop() { stopped_ = true; }
  bool is_stopped() const { return stopped_; }
  std::size_t threads() const { return threads_; }

 private:
  std::size_t controllers_;
  std::size_t tasks_;
  std::size_t threads_;
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  std::size_t next_task_ = 0;
  SeedGloves gloves_;  // of the seed whose tasks are given out
  SeedGloves next_gloves_;
};

}  // namespace gauntlet::sim
