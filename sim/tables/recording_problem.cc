#include "sim/tables/recording_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gauntlet::sim {
namespace {

constexpr std::string_view kShuffled = "are the rows shuffled? Sort them by time";
constexpr std::string_view kDecimalCommas = "are there decimal commas between commas?";

struct Facts {
  RecordingProblem problem;
  std::string_view name;
  bool needs_repair;
  std::string_view cause = "";
};

const Facts& FactsOf(RecordingProblem problem) {
  using enum RecordingProblem;
  static constexpr std::array<Facts, 16> kFacts = {{
      {kBeyondRange, "beyond the joint's range", false},
      {kClockRestart, "clock started anew", true, kShuffled},
      {kGap, "gap in time", true},  // the cause is told by the usual step
      {kFarBeyondRange, "glitch far outside the joint's range", true,
       "is the unit another: degrees taken for radians, counts for degrees?"},
      {kGlitch, "glitch", true, "are the columns angles of joints at all?"},
      {kShortHeader, "header too short", false},
      {kMissingValue, "missing value", false},
      {kNoTime, "no time", true, "is the column of time another?"},
      {kNotANumber, "not a number", true,
       "are there decimal commas between commas, or texts in a mapped column?"},
      {kNotFinite, "not finite", true},
      {kRepeatedTime, "repeated time, row left out", true,
       "is the time too coarse? Map its column to ignore, and give file_rate_hz"},
      {kOutOfOrder, "row out of order, left out", true, kShuffled},
      {kRowTooLong, "row too long", true, kDecimalCommas},
      {kTimeOutOfRange, "time out of range", true, "is the unit of time another?"},
      {kTruncatedRow, "truncated row", true, kDecimalCommas},
      {kWildTime, "wild time, row left out", true, kShuffled},
  }};
  return *std::ranges::find(kFacts, problem, &Facts::problem);
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

std::string_view NameOf(RecordingProblem problem) { return FactsOf(problem).name; }

bool NeedsRepair(RecordingProblem problem) { return FactsOf(problem).needs_repair; }

std::string LikelyCause(RecordingProblem problem, double usual_step_s) {
  if (problem == RecordingProblem::kGap) return CauseOfGaps(usual_step_s);
  return std::string(FactsOf(problem).cause);
}

}  // namespace gauntlet::sim
