#include "sim/video/render_folder.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/scenario/scenario.h"
#include "sim/trial/command_angles.h"
#include "sim/trial/trace_file.h"
#include "sim/video/comparison_video.h"

namespace gauntlet::sim {

std::filesystem::path RenderFolder(const RenderOptions& options,
                                   const std::function<bool(int, int)>& keep_going) {
  const std::filesystem::path resolved = options.folder / "scenario.resolved.yaml";
  if (!std::filesystem::exists(resolved)) {
    throw UserError({.place = options.folder.string(),
                     .problem = "no scenario.resolved.yaml there, must be the output folder of "
                                "gauntlet run or compare"});
  }
  const Scenario scenario = LoadScenario(resolved, {});
  CheckControllerNames(options.controllers, scenario);
  const TraceFile file = ReadTraceFile(options.folder / "trace.h5", options.controllers);
  if (file.traces.empty()) {
    throw UserError(
        {.place = (options.folder / "trace.h5").string(), .problem = "holds no controller"});
  }
  const HandModel hand(scenario.hand, file.channel_names);

  std::vector<Signal> command_angles;
  for (const Trace& trace : file.traces) {
    command_angles.push_back(CommandAngles(hand.transmission(), trace.command_counts));
  }
  VideoInput input;
  input.title = scenario.name;
  input.rate_hz = file.rate_hz;
  input.true_angle_rad = &file.true_angle_rad;
  input.raw_angle_rad = &file.traces.front().linearised_angle_rad;
  for (std::size_t i = 0; i < file.traces.size(); ++i) {
    const Trace& trace = file.traces[i];
    input.panes.push_back({.title = trace.controller_name,
                           .hand_angle_rad = &trace.hand_angle_rad,
                           .spool_angle_rad = &trace.spool_angle_rad,
                           .filtered_angle_rad = &trace.filtered_angle_rad,
                           .command_angle_rad = &command_angles[i],
                           .object_pose = &trace.object_pose});
  }
  const auto channel =
      std::find(file.channel_names.begin(), file.channel_names.end(), scenario.video.channel);
  if (channel == file.channel_names.end()) {
    throw UserError(
        {.place = resolved.string(),
         .key = "video.channel",
         .problem = fmt::format("{} is not in the trace{}", scenario.video.channel,
                                Suggestion(scenario.video.channel, file.channel_names))});
  }
  input.channel = channel - file.channel_names.begin();
  input.channel_name = scenario.video.channel;
  input.camera = scenario.video.camera;
  input.width_px = scenario.video.width_px;
  input.height_px = scenario.video.height_px;
  input.frames_per_s = scenario.video.frames_per_s;
  input.jobs = options.jobs;

  std::filesystem::path target =
      options.target.empty() ? options.folder / "comparison.mp4" : options.target;
  WriteComparisonVideo(input, hand, target, keep_going);
  return target;
}

}  // namespace gauntlet::sim
