#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/hand/fingertips.h"
#include "sim/score/score.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/trial/trial.h"

namespace gauntlet::sim {

struct PredictionFits;

/// Facts about a glove signal that are kept when the signal itself is not.
struct GloveFacts {
  std::string signal_hash;  // of all that it holds, a recording's content included
  std::string motion_hash;  // of the wearer's true angles alone
  Eigen::Index ticks = 0;
  bool is_recorded = false;      // see GloveSignal
  bool is_of_recording = false;  // the motion is that of a recording; its noise may be simulated
  std::vector<MaskedStretch> masked = {};
};

GloveFacts FactsOf(const GloveSignal& glove);

/// A scenario whose parts have all been built once, so that nothing in it is wrong any more.
struct Study {
  Scenario scenario;
  std::shared_ptr<const HandModel> hand;
  std::shared_ptr<const Fingertips> fingertips;  // null for a hand without a thumb and two fingers
  controller::GloveCalibration calibration;
  /// Indices of the parts of the hand that count: joints that some channel of the glove moves, and
  /// the motors and cables that turn with them. What only holds a posture says nothing of a filter.
  std::vector<int> measured_joints;
  std::vector<int> measured_motors;
  std::vector<int> measured_cables;
  std::vector<std::string> measured_joint_names;
  int joint_count = 0;               // of the hand, measured or not
  ScoreRows rows;                    // of these joints, motors and cables
  std::vector<std::string> remarks;  // what was repaired or replaced, a line each
  std::vector<std::shared_ptr<const GloveSignal>>
      gloves;                            // signals of the first seeds, one at least
  std::vector<GloveFacts> repetitions;   // of the first seed of each; one if none differ
  std::shared_ptr<PredictionFits> fits;  // of these gloves, see ControllerOfSeed()
  /// Make the filters of controllers with answers from a file; the controllers point to them.
  std::vector<std::shared_ptr<const controller::FilterMaker>> answers;

  const std::vector<std::string>& channel_names() const { return calibration.channel_names; }
  /// From the glove's channels to the hand's joints.
  controller::JointMap joint_map() const {
    return {scenario.joint_map, channel_names(), hand->transmission()};
  }
};

/// All that the controller is made from: with the glove and the hand of the scenario.
controller::RobotConfig RobotOf(const Scenario& scenario, const HandModel& hand,
                                const controller::ControllerConfig& config);

/// Name of a controller with curves that were measured on one glove, where each seed draws another
/// glove; empty if there is none.
std::string FittedToOneGlove(const Study& study);
/// Errors: SettingError if there is one: its curves do not fit the gloves of `seeds` seeds.
void RefuseOtherGloves(const Study& study, int seeds);

/// The glove's signal of a seed.
std::shared_ptr<const GloveSignal> GloveOfSeed(const Study& study, int seed);

/// Source of the noise-free twin of the trials of a seed.
enum class TwinSource {
  kNone,    // not wanted, or not to be had: a recorded glove cannot be without its noise
  kItself,  // the trial has no noise, nor faults
  kTrial,   // a trial of its own, before the other
};
TwinSource TwinOf(const Study& study, int seed);

/// For a study that runs many times: makes the signals of its first `seeds` seeds now, as many as
/// take 64 MB. Errors: UserError, SettingError.
void KeepGloves(int seeds, Study& study);

/// The trial of one controller with the glove of a seed.
TrialSetup SetupOf(const Study& study, const NamedController& named, int seed);

/// Builds a controller, and starts no program, to find what is wrong with it. Errors: SettingError.
void CheckController(const Study& study, const NamedController& named);

/// Empties the name of the default camera where the model does not have it: the whole is shown.
/// Errors: SettingError `video.camera` for another that the model does not have.
void ChooseVideoCamera(const HandModel& hand, std::string& camera);

/// Builds hand, glove (of the first seed of every repetition) and every controller.
/// Errors: UserError, SettingError.
Study PrepareStudy(Scenario scenario);
/// As above, for a scenario that was read from `source`. Errors: UserError with the place in the
/// source, unless it has a place of its own: a model, a recording.
Study PrepareStudy(const ScenarioSource& source, Scenario scenario);

/// Checks the programs of these controllers of a scenario, of all if none is named, before many
/// settings of it are tried. Errors: UserError, as without the consent to run them.
void CheckProgramsOf(const ScenarioSource& source, const std::vector<std::string>& controllers);

}  // namespace gauntlet::sim
