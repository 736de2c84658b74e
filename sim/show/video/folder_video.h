#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "sim/base/manifest.h"
#include "sim/hand/hand_model.h"
#include "sim/show/video/comparison_video.h"
#include "sim/show/video/render_folder.h"
#include "sim/show/video/score_board.h"
#include "sim/study/scenario/scenario.h"
#include "sim/trial/trace_reader.h"

namespace gauntlet::sim {

/// Video input from the folder of a finished run or comparison: its `trace.h5`,
/// `scenario.resolved.yaml` and `scores.json`, checked by the manifest.
class FolderVideo {
 public:
  /// `keep_going` is asked now and then; false throws Cancelled.
  /// Errors: UserError for a folder without them, and for controllers, joints or a camera that
  /// there are not.
  explicit FolderVideo(const RenderOptions& options, const std::function<bool()>& keep_going = {});
  FolderVideo(const FolderVideo&) = delete;  // the input points into it
  FolderVideo& operator=(const FolderVideo&) = delete;

  const HandModel& hand() const { return hand_; }
  const VideoInput& input() const { return input_; }

 private:
  /// A folder can hold the trace of one scenario and the text of another.
  void CheckTraceIsOfHand() const;
  void AddWords();
  VideoPlan::Named PlanOfController(const std::string& name) const;
  void OrderTraces();
  void AddPanes();
  void AddCurves();

  Manifest manifest_;
  VideoPlan plan_;
  std::vector<std::string> names_;  // of the panes, in their order
  std::filesystem::path resolved_;
  std::filesystem::path trace_;
  Scenario scenario_;
  HandModel hand_;
  TraceFile file_;
  VideoInput input_;
};

}  // namespace gauntlet::sim
