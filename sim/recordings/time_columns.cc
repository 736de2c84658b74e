#include "sim/recordings/time_columns.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <utility>

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 5> kTimes = {"t", "time", "timestamp", "elapsed",
                                                    "elapsedtime"};

/// `alone`: a column that is called so can be nothing else.
struct TimeUnit {
  std::string_view name;
  double scale_s;
  bool alone;
};
constexpr std::array<TimeUnit, 20> kKnownTimeUnits = {{{"s", 1.0, false},
                                                       {"sec", 1.0, true},
                                                       {"secs", 1.0, true},
                                                       {"second", 1.0, true},
                                                       {"seconds", 1.0, true},
                                                       {"ms", 1e-3, true},
                                                       {"msec", 1e-3, true},
                                                       {"millis", 1e-3, true},
                                                       {"millisec", 1e-3, true},
                                                       {"milliseconds", 1e-3, true},
                                                       {"us", 1e-6, true},
                                                       {"usec", 1e-6, true},
                                                       {"micros", 1e-6, true},
                                                       {"microsec", 1e-6, true},
                                                       {"microseconds", 1e-6, true},
                                                       {"ns", 1e-9, true},
                                                       {"nsec", 1e-9, true},
                                                       {"nanos", 1e-9, true},
                                                       {"nanosec", 1e-9, true},
                                                       {"nanoseconds", 1e-9, true}}};

constexpr std::array<std::string_view, 5> kNumbered = {"k", "frame", "sample", "row", "seq"};
constexpr std::array<std::string_view, 6> kNumbers = {"", "number", "num", "no", "nr", "index"};
constexpr std::array<std::string_view, 9> kDoubtful = {"s",  "i",     "n",        "id",     "idx",
                                                       "nr", "index", "sequence", "counter"};

/// Letters and digits only, small ones.
std::string Bare(std::string_view name) {
  std::string bare;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) bare.push_back(static_cast<char>(std::tolower(byte)));
  }
  return bare;
}

/// One of `names`, with one of `ends` behind it.
template <class Names, class Ends>
bool IsOneOf(std::string_view bare, const Names& names, const Ends& ends) {
  return std::ranges::any_of(names, [&](std::string_view name) {
    return bare.starts_with(name) &&
           std::ranges::find(ends, bare.substr(name.size())) != std::end(ends);
  });
}

}  // namespace

std::optional<double> TimeScaleS(std::string_view name) {
  const std::string bare = Bare(name);
  if (std::ranges::find(kTimes, bare) != kTimes.end()) return 1.0;
  for (const TimeUnit& unit : kKnownTimeUnits) {
    if ((unit.alone && bare == unit.name) || IsOneOf(bare, kTimes, std::array{unit.name})) {
      return unit.scale_s;
    }
  }
  return std::nullopt;
}

bool IsSampleNumber(std::string_view name) { return IsOneOf(Bare(name), kNumbered, kNumbers); }

bool MayBeTime(std::string_view name) {
  const std::string bare = Bare(name);
  return IsSampleNumber(name) || std::ranges::find(kDoubtful, bare) != kDoubtful.end() ||
         bare.find("time") != std::string::npos || bare.find("date") != std::string::npos ||
         bare.find("clock") != std::string::npos || bare.find("tick") != std::string::npos;
}

}  // namespace gauntlet::sim
