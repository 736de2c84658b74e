#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "sim/base/timing.h"
#include "sim/glove/glove_config.h"
#include "sim/hand/hand_config.h"
#include "sim/score/score_config.h"
#include "sim/study/scenario/repetitions.h"
#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {

struct NamedController {
  std::string name;
  /// File of `gauntlet calibrate`. LoadScenario() puts what it says into `config` and empties this.
  std::string calibration = {};
  /// File of `gauntlet identify`, likewise.
  std::string chain = {};
  /// Computer's handling of the glove's samples, in place of `link.glove.receiver`.
  std::optional<ReceiverConfig> receiver = {};
  controller::ControllerConfig config;

  void Visit(controller::SettingsVisitor& visitor);
};

/// When commands leave and arrive: one frame per period, and it takes effect after the delay.
/// Source: Bai, Jiang, Yokoi, section 3: an event every 0.02 s, event time below 45 ms. The delay's
/// default lies in the middle of what that allows: an assumption.
struct EventConfig {
  double period_ms = 20.0;
  double delay_ms = 25.0;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Content of the video besides the hands.
struct VideoConfig {
  // Below, texts cannot be read. Sides are even: in the video two neighbours share their colour.
  static constexpr int kMinWidth_px = 480;
  static constexpr int kMinHeight_px = 270;

  std::string channel;  // whose curves are drawn; empty: index_mcp, or the first of the glove
  std::string camera = "hand";  // empty: the whole model
  int width_px = 1280;
  int height_px = 720;
  int frames_per_s = 30;

  void Visit(controller::SettingsVisitor& visitor);
};

/// A file that a resolved scenario names, as it was then.
struct NamedFile {
  std::string file;
  std::string hash;  // see HashOfFile()

  void Visit(controller::SettingsVisitor& visitor);
};

/// Origin of a resolved scenario; empty in one that a person wrote.
struct MadeWith {
  std::string gauntlet_version;
  std::string mujoco_version;
  std::string model_hash;
  std::string mathematics;  // see HashOfMathematics()
  std::vector<NamedFile> files;

  void Visit(controller::SettingsVisitor& visitor);
};

/// A question to the testbed, as plain data: one glove signal, one hand, many controllers.
struct Scenario {
  std::string name;      // the file's stem unless the file says otherwise
  std::string question;  // what this scenario answers, one sentence
  int seed = 1;
  GloveConfig glove;  // of the first repetition
  Repetitions repetitions;
  EventConfig event;
  std::optional<LinksConfig> link;
  HandConfig hand;
  ScoreConfig score;
  VideoConfig video;
  controller::JointMapConfig joint_map;
  std::vector<NamedController> controllers;
  std::string baseline;  // name of a controller; empty: the first that neither filters nor predicts
  std::string priority = "tracking";  // see ParsePriority()
  MadeWith made_with;

  void Visit(controller::SettingsVisitor& visitor);
};

/// The clocks of the scenario's trials.
LoopTiming TimingOf(const Scenario& scenario);

/// The links of a controller's trials. Errors: SettingError, also for a receiver without a link.
LinksConfig LinksOf(const Scenario& scenario, const NamedController& named);

/// The glove of a seed: the scenario's own, or that of the repetition which the seed takes.
/// Repetitions take turns from the scenario's seed on: number (seed - scenario.seed) mod their
/// count.
const GloveConfig& GloveOf(const Scenario& scenario, int seed);

/// Index of the controller that all others are compared with; none if there is no such controller.
std::optional<std::size_t> BaselineOf(const Scenario& scenario);

/// Errors: UserError for a name that the scenario does not have, or that is given twice.
void CheckControllerNames(const std::vector<std::string>& names, const Scenario& scenario);

/// The controller of `--controller`. Errors: UserError for a name that the scenario does not have.
const NamedController& FindController(const Scenario& scenario, const std::string& name);

/// Leaves only these controllers, in this order; for no names, all. Returns the baseline that the
/// scenario names if it is not among them: then the rule for scenarios that name none decides.
/// Errors: as CheckControllerNames().
std::string KeepControllers(const std::vector<std::string>& names, Scenario& scenario);

/// The scenario with every value used, as YAML that LoadScenario() reads back to the same values.
/// `folder`: where the file will lie, see SettingsToYaml().
std::string ScenarioToYaml(const Scenario& scenario, const std::filesystem::path& folder = {});

/// One value of a scenario. The key is a path as --set takes it (`controllers.raw.filter.0.kind`).
struct SettingValue {
  std::string key;
  std::string value;
};

/// Every value used, in the order of the file. Paths as seen from the working folder: pages show
/// them.
std::vector<SettingValue> SettingValues(const Scenario& scenario);

}  // namespace gauntlet::sim
