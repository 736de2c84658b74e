#include "sim/show/video/folder_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/show/video/video_layout.h"
#include "sim/study/counted_parts.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study.h"

namespace gauntlet::sim {
namespace {

Scenario CheckedScenario(const std::filesystem::path& resolved, const RenderOptions& options) {
  Scenario scenario = LoadScenario(resolved, options.overrides);
  CheckControllerNames(options.controllers, scenario);
  if (!options.controllers.empty()) CheckPaneCount(static_cast<int>(options.controllers.size()));
  return scenario;
}

/// An empty plan where there is no file.
VideoPlan PlanOf(const std::filesystem::path& scores) {
  return std::filesystem::exists(scores) ? ReadVideoPlan(scores) : VideoPlan();
}

/// Those that are asked for, else those that the verdict is about, else the first three.
std::vector<std::string> NamesOf(const RenderOptions& options, const VideoPlan& plan,
                                 const Scenario& scenario) {
  if (!options.controllers.empty()) return options.controllers;
  if (!plan.shown.empty()) return plan.shown;
  constexpr std::size_t kMost = 3;
  std::vector<std::string> names;
  for (const NamedController& controller : scenario.controllers) {
    if (names.size() < kMost) names.push_back(controller.name);
  }
  return names;
}

}  // namespace

FolderVideo::FolderVideo(const RenderOptions& options, const std::function<bool()>& keep_going)
    : manifest_(options.folder),
      plan_(PlanOf(manifest_.Checked("scores.json"))),
      resolved_(manifest_.Checked("scenario.resolved.yaml")),
      scenario_(CheckedScenario(resolved_, options)),
      hand_(scenario_.hand, TimingOf(scenario_)) {
  try {
    ChooseVideoCamera(hand_, scenario_.video.camera);
  } catch (const controller::SettingError& error) {
    throw AtPlace(resolved_.string(), error);
  }
  names_ = NamesOf(options, plan_, scenario_);
  trace_ = manifest_.Checked("trace.h5");
  file_ = ReadTraceFile(trace_, {.only = names_, .keep_going = keep_going});
  if (file_.traces.empty()) {
    throw UserError({.place = trace_.string(), .problem = "holds no controller"});
  }
  CheckTraceIsOfHand();
  OrderTraces();
  input_.overlay = options.overlay;
  if (options.overlay) {
    if (file_.traces.size() != 2) {
      throw UserError({.place = trace_.string(), .problem = "holds only one of the two hands"});
    }
  }
  input_.rate_hz = file_.tick_rate_hz;
  input_.camera = scenario_.video.camera;
  input_.width_px = scenario_.video.width_px;
  input_.height_px = scenario_.video.height_px;
  input_.frames_per_s = scenario_.video.frames_per_s;
  input_.excerpt = options.excerpt;
  input_.look = options.look;
  input_.rate_factor = options.rate_factor;
  input_.parts = file_.segments;
  input_.jobs = options.jobs;
  AddWords();
  AddPanes();
  AddCurves();
}

void FolderVideo::CheckTraceIsOfHand() const {
  const auto fail = [&](const std::string& problem) {
    throw UserError({.place = trace_.string(),
                     .problem = problem + "; is it of the scenario.resolved.yaml beside it?"});
  };
  if (file_.joint_names != hand_.joint_names()) fail("has other joints than the hand");
  for (const Trace& trace : file_.traces) {
    if (trace.command_counts.cols() != std::ssize(hand_.motor_names())) {
      fail(fmt::format("{} has {} motors, the hand {}", trace.controller_name,
                       trace.command_counts.cols(), hand_.motor_names().size()));
    }
  }
  const double rate_hz = TimingOf(scenario_).tick_rate_hz();
  if (std::abs(file_.tick_rate_hz - rate_hz) > 1e-6 * rate_hz) {
    fail(fmt::format("has {} ticks per second, the scenario {}", file_.tick_rate_hz, rate_hz));
  }
}

VideoPlan::Named FolderVideo::PlanOfController(const std::string& name) const {
  const auto found = std::ranges::find(plan_.controllers, name, &VideoPlan::Named::name);
  if (found != plan_.controllers.end()) return *found;
  const auto place = std::ranges::find(names_, name) - names_.begin();
  return {.name = name, .role = "", .series = static_cast<std::size_t>(place) + 1};
}

void FolderVideo::OrderTraces() {
  std::ranges::sort(file_.traces, {}, [this](const Trace& trace) {
    return std::ranges::find(names_, trace.controller_name) - names_.begin();
  });
}

void FolderVideo::AddWords() {
  input_.title = scenario_.name;
  if (!input_.excerpt.is_all()) return;
  input_.question = scenario_.question;
  std::vector<std::string> names;
  for (const Trace& trace : file_.traces) names.push_back(trace.controller_name);
  const std::filesystem::path scores = manifest_.Checked("scores.json");
  if (!std::filesystem::exists(scores)) return;
  input_.verdict = ReadScoreBoard(scores, names);
  for (std::size_t i = 0; i < names.size(); ++i) {
    input_.verdict.rows[i].series = PlanOfController(names[i]).series;
  }
  input_.again = plan_.again;
}

void FolderVideo::AddPanes() {
  const controller::JointMap joint_map(scenario_.joint_map, file_.channel_names,
                                       hand_.transmission());
  input_.true_angle_rad = &file_.reference_angle_rad;
  for (const Trace& trace : file_.traces) {
    const VideoPlan::Named named = PlanOfController(trace.controller_name);
    input_.panes.push_back({.title = named.name,
                            .role = named.role,
                            .hand_angle_rad = &trace.hand_angle_rad,
                            .spool_angle_rad = &trace.spool_angle_rad,
                            .object_pose = &trace.object_pose,
                            .tension_n = &trace.tension_n,
                            .series = named.series});
  }
  for (int joint = 0; joint < joint_map.joint_count(); ++joint) {
    if (joint_map.measured(joint)) input_.measured_joints.push_back(joint);
  }
  if (file_.masked.empty()) return;
  input_.counted = CountedTicksOfJoints(input_.measured_joints, joint_map, file_.masked,
                                        RecoveryTicks(scenario_, file_.tick_rate_hz),
                                        static_cast<int>(file_.true_angle_rad.rows()));
}

void FolderVideo::AddCurves() {
  const std::string& name = scenario_.video.channel;
  const auto joint = std::ranges::find(file_.joint_names, name);
  if (joint == file_.joint_names.end()) {
    throw UserError(
        {.place = resolved_.string(),
         .key = "video.channel",
         .problem = name + " is not in the trace" + Suggestion(name, file_.joint_names)});
  }
  input_.jitter_above_hz = scenario_.score.jitter_above_hz;
  input_.joint = static_cast<int>(joint - file_.joint_names.begin());
  input_.joint_name = name;
}

}  // namespace gauntlet::sim
