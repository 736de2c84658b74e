#pragma once

#include <chrono>
#include <string>

namespace gauntlet::sim {

/// "40 s", "12 min" or "1.5 h": an estimate, with no more digits than it has.
std::string TimeText(double seconds);

/// A progress bar with the time left on standard error; silent when that is not a terminal.
class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();

  /// Returns false when the user pressed Ctrl-C, for callbacks that may stop the work.
  bool Update(double done, double total);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool on_terminal_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_;
};

}  // namespace gauntlet::sim
