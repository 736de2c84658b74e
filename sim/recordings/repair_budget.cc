#include "sim/recordings/repair_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gauntlet::sim {
namespace {

/// By how a problem begins. Kinds that are not here need no repair.
struct Cause {
  std::string_view problem;
  std::string_view cause;
};
constexpr std::array<Cause, 12> kCauses{{
    {"gap in time", ""},  // by the usual step
    {"clock started anew", "are the rows shuffled? Sort them by time"},
    {"row out of order", "are the rows shuffled? Sort them by time"},
    {"wild time", "are the rows shuffled? Sort them by time"},
    {"repeated time", "is the time too coarse? Map its column to ignore, and give file_rate_hz"},
    {"not a number", "are there decimal commas between commas, or texts in a mapped column?"},
    {"row too long", "are there decimal commas between commas?"},
    {"truncated row", "are there decimal commas between commas?"},
    {"glitch far outside", "is the unit another: degrees taken for radians, counts for degrees?"},
    {"glitch, value left out", "are the columns angles of joints at all?"},
    {"not finite", ""},
    {"time out of range", "is the unit of time another?"},
}};

const Cause* Find(std::string_view problem) {
  const auto found = std::ranges::find_if(
      kCauses, [&](const Cause& cause) { return problem.starts_with(cause.problem); });
  return found == kCauses.end() ? nullptr : &*found;
}

/// No glove gives less than a row in two seconds: then the unit is another.
std::string CauseOfGaps(double usual_step_s) {
  const auto taken = [&](std::string_view unit, std::string_view name) {
    return fmt::format(
        "are the times {}, taken for seconds? Rows come every {:.4g} s; a column map "
        "says unit {}",
        name, usual_step_s, unit);
  };
  if (std::isnan(usual_step_s)) return "";
  if (usual_step_s >= 1e6) return taken("ns", "nanoseconds");
  if (usual_step_s >= 1e3) return taken("us", "microseconds");
  if (usual_step_s >= 2.0) return taken("ms", "milliseconds");
  return fmt::format("rows usually come every {:.4g} ms: longest_gap_ms must be above that",
                     1e3 * usual_step_s);
}

}  // namespace

bool NeedsRepair(std::string_view problem) { return Find(problem) != nullptr; }

std::string LikelyCause(std::string_view most_frequent_problem, double usual_step_s) {
  const Cause* cause = Find(most_frequent_problem);
  if (cause == nullptr) return "";
  if (cause->problem == "gap in time") return CauseOfGaps(usual_step_s);
  return std::string(cause->cause);
}

}  // namespace gauntlet::sim
