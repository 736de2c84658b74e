#include "sim/video/render_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/scenario/scenario.h"
#include "sim/settings/yaml_reader.h"
#include "sim/study/manifest.h"
#include "sim/study/study.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/trace_reader.h"
#include "sim/video/comparison_video.h"
#include "sim/video/video_layout.h"

namespace gauntlet::sim {
namespace {

/// A folder can hold the trace of one scenario and the text of another.
void CheckTraceIsOfHand(const std::filesystem::path& place, const TraceFile& file,
                        const Scenario& scenario, const HandModel& hand) {
  const auto fail = [&](const std::string& problem) {
    throw UserError({.place = place.string(),
                     .problem = problem + "; is it of the scenario.resolved.yaml beside it?"});
  };
  if (file.joint_names != hand.joint_names()) fail("has other joints than the hand");
  for (const Trace& trace : file.traces) {
    if (trace.command_counts.cols() != std::ssize(hand.motor_names())) {
      fail(fmt::format("{} has {} motors, the hand {}", trace.controller_name,
                       trace.command_counts.cols(), hand.motor_names().size()));
    }
  }
  const double rate_hz = TimingOf(scenario).tick_rate_hz();
  if (std::abs(file.tick_rate_hz - rate_hz) > 1e-6 * rate_hz) {
    fail(fmt::format("has {} ticks per second, the scenario {}", file.tick_rate_hz, rate_hz));
  }
}

}  // namespace

std::filesystem::path VideoOf(const std::filesystem::path& folder) {
  return folder / "comparison.mp4";
}

std::filesystem::path PictureOf(const std::filesystem::path& folder) {
  return folder / "comparison.png";
}

double MotionStarts_s(const Scenario& scenario) {
  return scenario.question.empty() ? 0.0 : kTitle_s;
}

void CheckVideo(int controllers, const std::filesystem::path& target) {
  CheckPaneCount(controllers);
  std::error_code ignored;
  if (!std::filesystem::is_directory(target, ignored)) return;
  throw UserError({.place = target.string(), .problem = "is a folder, must be a file"});
}

std::filesystem::path RenderFolder(const RenderOptions& options,
                                   const std::function<bool(int, int)>& keep_going) {
  std::filesystem::path target = options.target;
  if (target.empty())
    target = options.frame_s ? PictureOf(options.folder) : VideoOf(options.folder);
  const Manifest manifest(options.folder);
  const std::filesystem::path resolved = manifest.Checked("scenario.resolved.yaml");
  Scenario scenario = LoadScenario(resolved, options.overrides);
  CheckControllerNames(options.controllers, scenario);
  CheckVideo(options.controllers.empty() ? scenario.controllers.size() : options.controllers.size(),
             target);
  const HandModel hand(scenario.hand, TimingOf(scenario));
  try {
    ChooseVideoCamera(hand, scenario.video.camera);
  } catch (const controller::SettingError& error) {
    throw AtPlace(resolved.string(), error);
  }
  const TraceFile file = ReadTraceFile(
      manifest.Checked("trace.h5"),
      {.only = options.controllers, .keep_going = [&] { return !keep_going || keep_going(0, 1); }});
  if (file.traces.empty()) {
    throw UserError(
        {.place = (options.folder / "trace.h5").string(), .problem = "holds no controller"});
  }
  CheckTraceIsOfHand(options.folder / "trace.h5", file, scenario, hand);
  const controller::JointMap joint_map(scenario.joint_map, file.channel_names, hand.transmission());
  std::vector<WayOfAngles> ways;
  for (const Trace& trace : file.traces) {
    ways.push_back(WayOf(trace, joint_map, hand.transmission()));
  }
  VideoInput input;
  input.title = scenario.name;
  if (options.excerpt.is_all()) {
    input.question = scenario.question;
    std::vector<std::string> names;
    for (const Trace& trace : file.traces) names.push_back(trace.controller_name);
    const std::filesystem::path scores = manifest.Checked("scores.json");
    if (std::filesystem::exists(scores)) input.verdict = ReadVerdict(scores, names);
  }
  input.rate_hz = file.tick_rate_hz;
  input.true_angle_rad = &file.reference_angle_rad;
  input.raw_angle_rad = &ways.front().raw;
  for (std::size_t i = 0; i < file.traces.size(); ++i) {
    const Trace& trace = file.traces[i];
    input.panes.push_back({.title = trace.controller_name,
                           .hand_angle_rad = &trace.hand_angle_rad,
                           .spool_angle_rad = &trace.spool_angle_rad,
                           .command_angle_rad = &ways[i].command,
                           .object_pose = &trace.object_pose,
                           .tension_n = &trace.tension_n});
  }
  for (int joint = 0; joint < joint_map.joint_count(); ++joint) {
    if (joint_map.measured(joint)) input.measured_joints.push_back(joint);
  }
  const auto joint = std::ranges::find(file.joint_names, scenario.video.channel);
  if (joint == file.joint_names.end()) {
    throw UserError({.place = resolved.string(),
                     .key = "video.channel",
                     .problem = scenario.video.channel + " is not in the trace" +
                                Suggestion(scenario.video.channel, file.joint_names)});
  }
  input.jitter_above_hz = scenario.score.jitter_above_hz;
  input.joint = static_cast<int>(joint - file.joint_names.begin());
  input.joint_name = scenario.video.channel;
  input.camera = scenario.video.camera;
  input.width_px = scenario.video.width_px;
  input.height_px = scenario.video.height_px;
  input.frames_per_s = scenario.video.frames_per_s;
  input.excerpt = options.excerpt;
  input.rate_factor = options.rate_factor;
  input.jobs = options.jobs;

  if (options.frame_s) {
    WriteComparisonPng(input, hand, *options.frame_s, target);
  } else {
    WriteComparisonVideo(input, hand, target, keep_going);
  }
  return target;
}

}  // namespace gauntlet::sim
