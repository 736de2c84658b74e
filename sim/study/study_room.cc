#include "sim/study/study_room.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

#include "sim/base/error.h"
#include "sim/base/signal_storage.h"

namespace gauntlet::sim {
namespace {

Eigen::Index LongestTicks(const Study& study) {
  return std::ranges::max(study.repetitions, {}, &GloveFacts::ticks).ticks;
}

/// Space that a study needs while it runs, its trace file and page included.
struct Needs {
  double signal_bytes = 0.0;  // of the signals that exist at once, wherever they are
  double disk_bytes = 0.0;    // the files beside them, too
  double memory_bytes = 0.0;
};

Needs NeedsOf(const Study& study, const StudyOptions& options) {
  const auto channels = static_cast<double>(study.channel_names().size());
  const auto joints = static_cast<double>(study.joint_count);
  const auto motors = static_cast<double>(study.hand->motor_names().size());
  const auto cables = static_cast<double>(study.hand->cable_names().size());
  // Traces that are kept, and trials beside them.
  const double controllers =
      options.keep_first_traces ? static_cast<double>(study.scenario.controllers.size()) : 0.0;
  const double others = options.seeds > 1 || !options.keep_first_traces ? options.jobs : 0;
  constexpr double kObjectDigitsAndPalm = 21.0;
  const bool twins = study.scenario.score.noise_free_twin;
  // Columns of numbers with a row per tick.
  const double glove = (twins ? 6.0 : 3.0) * channels + joints;
  const double twin = twins ? joints + motors : 0.0;
  const CausePlan plan = PlanCauses(study, options.seeds, options.causes);
  const double share_of_trial =
      plan.ticks ? static_cast<double>(*plan.ticks) / static_cast<double>(LongestTicks(study))
                 : 1.0;
  const double causes = joints * ((plan.switched ? kSwitchedCauseCount * share_of_trial : 0.0) +
                                  (plan.chain ? static_cast<double>(kCauseTrialCount) : 0.0));
  const double trace =
      2.0 * channels + 2.0 * joints + 2.625 * motors + cables + kObjectDigitsAndPalm + twin;
  const double in_passing =
      9.0 * joints + 0.5 * motors;  // what the scores or the page make and forget
  const double kept = glove + controllers * trace + (plan.controller ? 1.0 : controllers) * causes;
  const double signals = kept + others * (glove + trace + causes) + in_passing;
  // Numbers of 32 bits. Signals that go as they are written take the most space when those of the
  // first controller are there twice.
  const double in_file = 0.5 * (options.traces_go ? glove + trace + causes : kept);
  const auto ticks = static_cast<double>(LongestTicks(study));
  // Columns that the scores of one joint make and forget.
  constexpr double kColumns = 4.0;
  constexpr double kRest = 300e6;
  return {.signal_bytes = ticks * sizeof(double) * signals,
          .disk_bytes = ticks * sizeof(double) *
                        (options.traces_go ? std::max(signals, kept + in_file) : signals + in_file),
          .memory_bytes = ticks * kColumns * sizeof(double) + kRest};
}

/// Bytes of memory that are to be had; as many as one likes if the system does not say.
double AvailableMemory() {
  std::ifstream info("/proc/meminfo");
  for (std::string line; std::getline(info, line);) {
    double kilobytes = 0.0;
    if (std::sscanf(line.c_str(), "MemAvailable: %lf kB", &kilobytes) == 1) {
      return 1024.0 * kilobytes;
    }
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

std::shared_ptr<const FewSignalsOnHeap> CheckRoom(const Study& study, const StudyOptions& options) {
  const Needs needs = NeedsOf(study, options);
  const auto on_heap = static_cast<double>(GetSignalStorageLimits().all_on_heap_bytes);
  if (needs.signal_bytes < on_heap) return nullptr;
  const auto fail = [&](double needed, std::string_view where, double free) {
    throw RunError(fmt::format(
        "{:.6g} s of {} need about {:.1f} GB {}, {:.1f} GB are free: a shorter "
        "glove.motion.duration_s, a lower glove.rate_hz or fewer --controllers need less",
        static_cast<double>(LongestTicks(study)) / study.hand->timing().tick_rate_hz(),
        study.scenario.controllers.size() == 1
            ? "one controller"
            : fmt::format("{} controllers", study.scenario.controllers.size()),
        1e-9 * needed, where, 1e-9 * free));
  };
  const SignalSpace space = FreeSignalSpace();
  const auto free_disk = static_cast<double>(space.free_bytes);
  if (needs.disk_bytes > free_disk) {
    fail(needs.disk_bytes, fmt::format("on the disk of {}", space.folder.string()), free_disk);
  }
  const double free_memory = AvailableMemory();
  if (needs.memory_bytes > free_memory) fail(needs.memory_bytes, "of memory", free_memory);
  // Writing to the disk takes a larger share of the time of a shorter study, and without a hand as
  // long as the trials themselves.
  const double long_from = on_heap * (options.physics ? 1.4 : 5.6);
  std::shared_ptr<const FewSignalsOnHeap> few;
  if (needs.signal_bytes >= long_from) few = std::make_shared<const FewSignalsOnHeap>();
  rlimit addresses{};
  if (getrlimit(RLIMIT_AS, &addresses) != 0 || addresses.rlim_cur == RLIM_INFINITY) {
    return few;
  }
  const auto allowed = static_cast<double>(addresses.rlim_cur);
  const double needed = needs.disk_bytes + needs.memory_bytes;
  if (needed > allowed) fail(needed, "of addresses (ulimit -v)", allowed);
  return few;
}

}  // namespace gauntlet::sim
