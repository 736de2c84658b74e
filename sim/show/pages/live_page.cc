#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <numeric>

#include "sim/base/json.h"
#include "sim/hand/camera_view.h"
#include "sim/live/live_session.h"
#include "sim/live/session_scores.h"
#include "sim/results/html_text.h"
#include "sim/show/figure/palette.h"
#include "sim/show/pages/assets.h"
#include "sim/show/pages/pages.h"
#include "sim/show/pages/replay_data.h"
#include "sim/study/study.h"

namespace gauntlet::sim {
namespace {

/// The glove is silent from then on: five samples are missing, and a person would see it.
double SilentFrom_s(double rate_hz) {
  constexpr double kLeast_s = 0.25;
  return std::max(kLeast_s, 5.0 / rate_hz);
}

/// Per joint: angle = offset_deg + sum of weight * angle of a channel.
Json JointMapJson(const controller::JointMap& map) {
  Json joints = Json::array();
  for (int joint = 0; joint < map.joint_count(); ++joint) {
    Json terms = Json::array();
    for (const auto& term : map.terms(joint)) terms.push_back({term.channel, term.weight});
    joints.push_back({{"offset_deg", map.offset_rad(joint) * kDegPerRad}, {"terms", terms}});
  }
  return joints;
}

std::string DataOf(const Study& study, const LiveSetup& setup) {
  Json data = {{"hand", HandData(*study.hand, CameraViewOf(study.scenario.video.camera).camera)},
               {"channels", study.calibration.channel_names},
               {"joints", study.hand->joint_names()},
               {"stages", Json::array()},
               {"has_motors", setup.sink != nullptr},
               {"silent_from_s", SilentFrom_s(study.scenario.glove.rate_hz)},
               {"scored_joints", study.measured_joints.size()},
               {"jitter_above_hz", study.scenario.score.jitter_above_hz},
               {"least_delay_s", ScoreWindow::kLeastDelay_s},
               {"reference", setup.simulated_glove == nullptr
                                 ? "the samples of the glove, smoothed without delay"
                                 : setup.simulated_glove->reference_name}};
  for (const StageName& stage : kStageNames) data["stages"].push_back(stage.text);
  std::vector<std::string> names = {setup.trial.controller_name};
  for (const ShadowSetup& shadow : setup.shadows) names.push_back(shadow.name);
  std::vector<std::size_t> order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::vector<std::size_t> series = SeriesOf(order, BaselineOf(study.scenario));
  for (std::size_t i = 0; i < names.size(); ++i) {
    data["controllers"].push_back({{"name", names[i]}, {"colour", CssOfSeries(series[i])}});
  }
  data["joint_map"] = JointMapJson(study.joint_map());
  auto& rest = data["rest_deg"] = Json::array();
  for (const double angle_rad : study.hand->transmission().reference_angle_rad) {
    rest.push_back(angle_rad * kDegPerRad);
  }
  return JsonForScript(data);
}

}  // namespace

std::string LivePage(const Study& study, const LiveSetup& setup, const std::string& recording,
                     const std::string& nonce) {
  return FillTemplate(
      assets::kLiveHtml,
      {{"kind", "Gauntlet live"},
       {"title", EscapeHtml(study.scenario.name)},
       {"glove", EscapeHtml(setup.source == nullptr ? "simulated" : setup.source->Description())},
       {"motors", EscapeHtml(setup.sink == nullptr ? "simulated" : setup.sink->Description())},
       {"recording",
        recording.empty()
            ? "The glove is not recorded: --record FILE.csv records it."
            : fmt::format("All samples are recorded in {}.",
                          EscapeHtml(std::filesystem::path(recording).filename().string()))},
       {"sources", fmt::format("script-src 'nonce-{}'; connect-src 'self'; ", nonce)},
       {"nonce", nonce},
       {"style", PaletteCss() + std::string(assets::kStyle) + std::string(assets::kLiveStyle)},
       {"data", DataOf(study, setup)},
       {"replay_library", std::string(assets::kReplayLibrary)},
       {"script", std::string(assets::kLiveScript)}});
}

}  // namespace gauntlet::sim
