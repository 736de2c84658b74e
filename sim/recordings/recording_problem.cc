#include "sim/recordings/recording_problem.h"

#include <fmt/format.h>

#include <cmath>

namespace gauntlet::sim {
namespace {

constexpr std::string_view kShuffled = "are the rows shuffled? Sort them by time";
constexpr std::string_view kDecimalCommas = "are there decimal commas between commas?";

struct Facts {
  std::string_view name;
  bool needs_repair;
  std::string_view cause = "";
};

Facts FactsOf(RecordingProblem problem) {
  switch (problem) {
    using enum RecordingProblem;
    case kBeyondRange:
      return {"beyond the joint's range", false};
    case kClockRestart:
      return {"clock started anew", true, kShuffled};
    case kGap:
      return {"gap in time", true};  // the cause is told by the usual step
    case kFarBeyondRange:
      return {"glitch far outside the joint's range", true,
              "is the unit another: degrees taken for radians, counts for degrees?"};
    case kGlitch:
      return {"glitch, value left out", true, "are the columns angles of joints at all?"};
    case kShortHeader:
      return {"header too short", false};
    case kMissingValue:
      return {"missing value", false};
    case kNoTime:
      return {"no time", true, "is the column of time another?"};
    case kNotANumber:
      return {"not a number", true,
              "are there decimal commas between commas, or texts in a mapped column?"};
    case kNotFinite:
      return {"not finite", true};
    case kRepeatedTime:
      return {"repeated time, row left out", true,
              "is the time too coarse? Map its column to ignore, and give file_rate_hz"};
    case kOutOfOrder:
      return {"row out of order, left out", true, kShuffled};
    case kRowTooLong:
      return {"row too long", true, kDecimalCommas};
    case kTimeOutOfRange:
      return {"time out of range", true, "is the unit of time another?"};
    case kTruncatedRow:
      return {"truncated row", true, kDecimalCommas};
    case kWildTime:
      return {"wild time, row left out", true, kShuffled};
  }
  return {};
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
