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

  /// Shown until the work itself tells how long it takes.
  void Expect(double seconds) { expected_s_ = seconds; }
  bool on_terminal() const { return on_terminal_; }

  /// Returns false when the user pressed Ctrl-C, for callbacks that may stop the work.
  bool Update(double done, double total);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool on_terminal_;
  bool drawn_ = false;
  double expected_s_ = 0.0;  // 0: not known
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_drawn_;
};

}  // namespace gauntlet::sim
