#include "sim/cli/jobs_option.h"

#include <algorithm>
#include <thread>

#include "sim/cli/usage_error.h"

namespace gauntlet::sim {

void AddJobsOption(CLI::App& command, int& jobs) {
  command.add_option("--jobs", jobs, "trials at a time [number of cores]")
      ->transform(WholeNumber(1, 1024));
}

int JobsOrCores(int jobs) {
  return jobs > 0 ? jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace gauntlet::sim
