#include "sim/live/session_log.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stop_token>
#include <string_view>

#include "sim/live/session_threads.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kLogRows = 8192;
constexpr int kTraceBlocks = 128;

Eigen::Index TraceTicks(const LiveSetup& setup) {
  const double rate_hz = setup.trial.hand->timing().controller.tick_rate_hz;
  return static_cast<Eigen::Index>(std::ceil(setup.trace_s * rate_hz));
}

}  // namespace

SessionLog::SessionLog(const LiveSetup& setup, LiveResult& result)
    : samples_(kLogRows, setup.trial.calibration.channel_names.size()),
      targets_(kLogRows, setup.shadows.size() * setup.trial.hand->joint_names().size()),
      result_(result),
      most_targets_(static_cast<std::size_t>(TraceTicks(setup)) * targets_.width()),
      recorder_(result.trace, TraceTicks(setup),
                TraceColumnNames(setup.trial.calibration.channel_names, *setup.trial.hand,
                                 setup.trial.links.config.exist()),
                std::span<const std::string_view>(), kTraceBlocks) {
  thread_ = StartThread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      Move();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
}

void SessionLog::Move() {
  recorder_.MoveBlocks();
  while (samples_.Pop([&](double time_s, std::span<const double> counts) {
    if (!result_.recorded_time_s.empty() && time_s <= result_.recorded_time_s.back()) return;
    result_.recorded_time_s.push_back(std::max(0.0, time_s));
    result_.recorded_counts.insert(result_.recorded_counts.end(), counts.begin(), counts.end());
  })) {
  }
  while (targets_.Pop([&](int, std::span<const double> targets_rad) {
    if (moved_targets_.size() == most_targets_) return;
    moved_targets_.insert(moved_targets_.end(), targets_rad.begin(), targets_rad.end());
  })) {
  }
}

void SessionLog::SortTargets() {
  const std::size_t width = targets_.width();
  if (width == 0) return;
  const std::size_t joints = width / result_.shadows.size();
  for (std::size_t i = 0; i < result_.shadows.size(); ++i) {
    const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<1, Eigen::Dynamic>> rows(
        moved_targets_.data() + i * joints,
        static_cast<Eigen::Index>(moved_targets_.size() / width), static_cast<Eigen::Index>(joints),
        {1, static_cast<Eigen::Index>(width)});
    result_.shadows[i].target_angle_rad = rows;
  }
}

void SessionLog::End() {
  thread_.request_stop();
  thread_.join();
  Move();
  recorder_.Finish();
  result_.trace_rows_left_out = recorder_.left_out();
  SortTargets();
}

}  // namespace gauntlet::sim
