#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// A bound on a score: `jitter_rms_deg<=0.2`.
struct Constraint {
  std::size_t metric = 0;  // of Metrics()
  bool at_most = true;     // else at least
  double bound = 0.0;

  bool IsMetBy(double score) const { return at_most ? score <= bound : score >= bound; }
  std::string Text() const;
};

std::vector<std::string> TextsOf(const std::vector<Constraint>& bounds);

/// Errors: SettingError of `key` for text that is no bound, or names an unknown score.
Constraint ParseConstraint(const std::string& text, const std::string& key);
/// The place in Metrics(). Errors: SettingError of `key` for an unknown score.
std::size_t FindScore(const std::string& name, const std::string& key);

/// A score that decides which controller is recommended.
struct PrimaryScore {
  std::string_view word;  // in `priority`
  std::size_t metric;     // of Metrics()
};
/// Tracking error, delay, jitter.
const std::vector<PrimaryScore>& PrimaryScores();
/// `metric`: of Metrics().
bool IsPrimary(std::size_t metric);

/// Need of a user: the score that matters most, and bounds.
struct Priority {
  std::size_t metric = 0;          // of a primary score
  std::vector<Constraint> bounds;  // all are kept
};

/// Priority from "tracking", "delay" or "jitter", and bounds, separated by commas: "delay,
/// jitter_rms_deg<=0.1". Without a word: tracking. Errors: SettingError of the key `priority`.
Priority ParsePriority(const std::string& text);

}  // namespace gauntlet::sim
