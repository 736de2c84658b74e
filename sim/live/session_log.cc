#include "sim/live/session_log.h"

#include <chrono>
#include <cmath>
#include <stop_token>
#include <string_view>

#include "sim/base/signal_storage.h"
#include "sim/live/session_threads.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kLogRows = 8192;
constexpr std::size_t kSampleRows = 32768;  // a disk may need many seconds
constexpr std::size_t kNoteRows = 64;
constexpr int kTraceBlocks = 128;

Eigen::Index TraceTicks(const LiveSetup& setup) {
  const double rate_hz = setup.trial.hand->timing().controller.tick_rate_hz;
  return static_cast<Eigen::Index>(std::ceil(setup.trace_s * rate_hz));
}

}  // namespace

SessionLog::SessionLog(const LiveSetup& setup, LiveResult& result)
    : samples_(setup.recording == nullptr ? 1 : kSampleRows,
               setup.trial.calibration.channel_names.size()),
      notes_(kNoteRows, 0),
      targets_(kLogRows, setup.shadows.size() * setup.trial.hand->joint_names().size()),
      recording_(setup.recording),
      setup_(setup),
      result_(result),
      recorder_(result.trace, TraceTicks(setup),
                TraceColumnNames(setup.trial.calibration.channel_names, *setup.trial.hand,
                                 setup.trial.links.config.exist()),
                std::span<const std::string_view>(), kTraceBlocks) {
  for (ShadowResult& shadow : result.shadows) {
    shadow.target_angle_rad =
        Signal(TraceTicks(setup), std::ssize(setup.trial.hand->joint_names()));
  }
  thread_ = StartThread([this](const std::stop_token& stop) {
    constexpr int kLooksPerRelease = 200;
    for (int look = 1; !stop.stop_requested(); ++look) {
      Move();
      if (look % kLooksPerRelease == 0) ReleaseSignals();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  if (recording_ == nullptr) return;
  recording_thread_ = StartThread([this](const std::stop_token& stop) {
    constexpr int kLooksPerFlush = 10;
    std::string said;
    for (int look = 1; !stop.stop_requested(); ++look) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      Record();
      if (look % kLooksPerFlush != 0) continue;
      recording_->Flush();
      const std::string& problem = recording_->facts().problem;
      if (setup_.say && said.empty() && !problem.empty()) {
        setup_.say(problem + "; the session goes on, and writes again if it can");
      }
      said = problem;
    }
  });
}

void SessionLog::Record() {
  for (; lost_samples_ > 0; --lost_samples_) recording_->AddLost();
  while (samples_.Pop(
      [&](double time_s, std::span<const double> counts) { recording_->Add(time_s, counts); })) {
  }
  while (notes_.Pop([&](const Note& note, std::span<const double>) {
    const auto controller = static_cast<std::size_t>(note.controller);
    recording_->Note(note.time_s, note.kind == Note::Kind::kStill   ? "the hand is marked still"
                                  : note.kind == Note::Kind::kMoves ? "the hand moves again"
                                  : controller == 0
                                      ? setup_.trial.controller_name + " drives"
                                      : setup_.shadows[controller - 1].name + " drives");
  })) {
  }
}

void SessionLog::Move() {
  recorder_.MoveBlocks();
  const Eigen::Index joints = std::ssize(setup_.trial.hand->joint_names());
  while (targets_.Pop([&](int, std::span<const double> targets_rad) {
    const Eigen::Map<const Eigen::MatrixXd> of_shadows(targets_rad.data(), joints,
                                                       std::ssize(result_.shadows));
    for (std::size_t i = 0; i < result_.shadows.size(); ++i) {
      Signal& moved = result_.shadows[i].target_angle_rad;
      if (moved_targets_ == moved.rows()) return;
      moved.row(moved_targets_) = of_shadows.col(static_cast<Eigen::Index>(i)).transpose();
    }
    ++moved_targets_;
  })) {
  }
}

void SessionLog::End() {
  thread_.request_stop();
  recording_thread_.request_stop();
  thread_.join();
  Move();
  recorder_.Finish();
  result_.trace_rows_left_out = recorder_.left_out();
  for (ShadowResult& shadow : result_.shadows) shadow.target_angle_rad.KeepRows(moved_targets_);
  if (recording_ == nullptr) return;
  recording_thread_.join();
  Record();
  recording_->End();
}

}  // namespace gauntlet::sim
