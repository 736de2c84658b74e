#include "sim/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "sim/base/stop.h"
#include "sim/cli/standard_streams.h"

namespace gauntlet::sim {
namespace {

std::string Duration(double seconds) {
  const int whole = static_cast<int>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  return fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

}  // namespace

std::string TimeText(double seconds) {
  constexpr double kWhole_s = 20.0, kMost_s = 90.0, kStep_s = 5.0;
  if (seconds < kWhole_s) return fmt::format("{:.0f} s", std::max(1.0, seconds));
  if (seconds < kMost_s) return fmt::format("{:.0f} s", kStep_s * std::round(seconds / kStep_s));
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

Progress::Progress(std::string label)
    : label_(std::move(label)), on_terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (drawn_) SayText("\r\033[K");
}

bool Progress::Update(double done, double total) {
  if (StopAsked()) return false;
  const auto now = Clock::now();
  if (!on_terminal_ || now - last_drawn_ < std::chrono::milliseconds(100)) return true;
  last_drawn_ = now;
  drawn_ = true;
  const double share = total > 0.0 ? std::clamp(done / total, 0.0, 1.0) : 0.0;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  constexpr int kWidth = 30;
  const int filled = static_cast<int>(share * kWidth);
  const std::string left =
      share > 0.01 ? Duration(elapsed_s * (1.0 - share) / share) + " left" : "";
  SayText(fmt::format("\r\033[K{} [{}{}] {:3.0f} %  {}", label_, std::string(filled, '#'),
                      std::string(kWidth - filled, '.'), 100.0 * share, left));
  return true;
}

}  // namespace gauntlet::sim
