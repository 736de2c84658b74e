#include "sim/tables/time_columns.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kTimes =
    "t ts time timestamp timestamps stamp elapsed elapsedtime xvalue";

/// Names of a unit in the names of columns.
struct TimeUnit {
  std::string_view names;
  double scale_s;
};
constexpr std::array<TimeUnit, 4> kColumnUnits = {{{"s sec secs second seconds", 1.0},
                                                   {"ms msec millis millisec milliseconds", 1e-3},
                                                   {"us usec micros microsec microseconds", 1e-6},
                                                   {"ns nsec nanos nanosec nanoseconds", 1e-9}}};
constexpr std::array<TimeUnit, 8> kMapUnits = {{{"s", 1.0},
                                                {"ms", 1e-3},
                                                {"us", 1e-6},
                                                {"ns", 1e-9},
                                                {"ticks", 1e-7},
                                                {"min", 60.0},
                                                {"h", 3600.0},
                                                {"day", 86400.0}}};

constexpr std::string_view kNumbered = "k frame sample row seq";
constexpr std::string_view kNumbers = "number num no nr index";
constexpr std::string_view kDoubtful = "s i n id idx nr index sequence counter";

/// One of `names`, with one of `ends` behind it.
bool IsJoined(std::string_view bare, std::string_view names, std::string_view ends) {
  for (std::size_t cut = 1; cut < bare.size(); ++cut) {
    if (IsWordOf(names, bare.substr(0, cut)) && IsWordOf(ends, bare.substr(cut))) return true;
  }
  return false;
}

}  // namespace

bool IsWordOf(std::string_view list, std::string_view word) {
  if (word.empty()) return list.empty();
  for (std::size_t at = list.find(word); at != list.npos; at = list.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    const bool begins = at == 0 || list[at - 1] == ' ';
    if (begins && (end == list.size() || list[end] == ' ')) return true;
  }
  return false;
}

std::string BareName(std::string_view name) {
  std::string bare;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) bare.push_back(static_cast<char>(std::tolower(byte)));
  }
  return bare;
}

std::optional<double> TimeScaleS(std::string_view name) {
  const std::string bare = BareName(name);
  if (IsWordOf(kTimes, bare)) return 1.0;
  for (const auto& [names, scale_s] : kColumnUnits) {
    const bool is_unit = bare != "s" && IsWordOf(names, bare);  // s may be a sensor
    if (is_unit || IsJoined(bare, kTimes, names)) return scale_s;
  }
  return std::nullopt;
}

std::optional<double> SecondsPerUnit(std::string_view unit) {
  const auto found = std::ranges::find(kMapUnits, unit, &TimeUnit::names);
  return found == kMapUnits.end() ? std::nullopt : std::optional(found->scale_s);
}

std::string UnitOfSeconds(double seconds) {
  const auto found = std::ranges::find(kMapUnits, seconds, &TimeUnit::scale_s);
  GAUNTLET_ASSERT(found != kMapUnits.end());
  return std::string(found->names);
}

bool IsSampleNumber(std::string_view name) {
  const std::string bare = BareName(name);
  return IsWordOf(kNumbered, bare) || IsJoined(bare, kNumbered, kNumbers);
}

bool MayBeTime(std::string_view name) {
  const std::string bare = BareName(name);
  const auto has = [&bare](const char* part) { return bare.find(part) != std::string::npos; };
  if (name.find("[s]") != name.npos || name.find("(s)") != name.npos) return true;
  return IsSampleNumber(name) || IsWordOf(kDoubtful, bare) || has("time") || has("date") ||
         has("clock") || has("tick");
}

}  // namespace gauntlet::sim
