#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// Trials of a study or cells of a sweep by their numbers, from `first` to before `end`.
struct WorkRange {
  std::int64_t first = 0;
  std::int64_t end = 0;
};

/// Divides into equal parts, but for one. Fewer than `most`, where there is less.
inline std::vector<WorkRange> Divide(const WorkRange& work, int most) {
  std::vector<WorkRange> parts;
  const std::int64_t all = std::max<std::int64_t>(0, work.end - work.first);
  const std::int64_t count = std::min<std::int64_t>(all, most);
  for (std::int64_t i = 0; i < count; ++i) {
    parts.push_back({work.first + all * i / count, work.first + all * (i + 1) / count});
  }
  return parts;
}

/// Other processes that compute parts of a study or sweep. The parts need not come in
/// order. Any thread may call Next().
class Elsewhere {
 public:
  struct Part {
    std::size_t number = 0;
    std::filesystem::path database;  // a study.db with its trials; empty: it will not come
  };

  virtual ~Elsewhere() = default;
  /// The largest number of parts that makes sense.
  virtual int most_parts() const = 0;
  /// Parts of one question: `about` is empty, or says what is asked where that is not known before.
  /// Again only when all parts of the question before have come.
  virtual void Begin(const std::vector<WorkRange>& parts,
                     const std::vector<std::string>& about) = 0;
  /// The next part that has come, each once; nothing if none came in this time.
  virtual std::optional<Part> Next(std::chrono::milliseconds patience) = 0;
};

/// The RunError for a part that is not what was asked for.
inline constexpr const char* kOtherBuild =
    "executor: a worker gave other results than were asked for; all need the same build of "
    "Gauntlet, the same files and processors of one kind";

}  // namespace gauntlet::sim
