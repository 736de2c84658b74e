#include "sim/show/pages/live_page.h"

#include <fmt/format.h>

#include "sim/base/json.h"
#include "sim/hand/camera_view.h"
#include "sim/results/html_text.h"
#include "sim/show/figure/palette.h"
#include "sim/show/pages/assets.h"
#include "sim/show/pages/replay_data.h"

namespace gauntlet::sim {
namespace {

std::string DataOf(const Study& study, const LiveSetup& setup) {
  Json data = {{"hand", HandData(*study.hand, CameraViewOf(study.scenario.video.camera).camera)},
               {"channels", study.calibration.channel_names},
               {"joints", study.hand->joint_names()},
               {"stages", Json::array()},
               {"controllers", {setup.trial.controller_name}},
               {"has_motors", setup.sink != nullptr}};
  for (const StageName& stage : kStageNames) data["stages"].push_back(stage.text);
  for (const ShadowSetup& shadow : setup.shadows) data["controllers"].push_back(shadow.name);
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
       {"recording", recording.empty()
                         ? "The glove is not recorded; --record FILE.csv records it."
                         : fmt::format("All samples go to {} at the end.", EscapeHtml(recording))},
       {"sources", fmt::format("script-src 'nonce-{}'; connect-src 'self'; ", nonce)},
       {"nonce", nonce},
       {"style", PaletteCss() + std::string(assets::kStyle) + std::string(assets::kLiveStyle)},
       {"data", DataOf(study, setup)},
       {"replay_library", std::string(assets::kReplayLibrary)},
       {"script", std::string(assets::kLiveScript)}});
}

}  // namespace gauntlet::sim
