#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/results/verdict.h"

namespace gauntlet::sim {

/// The answer of a comparison: AnswerOf() makes it once, and every output shows it. Numbers are
/// places in Summary::controllers. Marks: Summary::MarkOf().
struct ComparisonAnswer {
  Verdict verdict;
  /// Recommended, alternatives, the others by tracking error.
  std::vector<std::size_t> order;
  /// For a page and a video, at most three: the baseline, the recommended controller and the first
  /// alternative. Where nothing is recommended, or nothing to compare it with is among them, the
  /// next in the order.
  std::vector<std::size_t> shown;
  /// Role of each controller: "recommended", "equivalent", "less jitter", "baseline"; may be empty.
  std::vector<std::string> roles;
};

}  // namespace gauntlet::sim
