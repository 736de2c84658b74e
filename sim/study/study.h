#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/scenario/scenario.h"
#include "sim/score/score.h"
#include "sim/trial/trial.h"

namespace gauntlet::sim {

/// What stays known of a glove signal when it is gone.
struct GloveFacts {
  std::string signal_hash;  // of all that it holds, a recording's content included
  std::string motion_hash;  // of the wearer's true angles alone
  Eigen::Index ticks = 0;
  bool is_recorded = false;  // see GloveSignal
};

/// A scenario whose parts have all been built once, so that nothing in it is wrong any more.
struct Study {
  Scenario scenario;
  std::shared_ptr<const HandModel> hand;
  controller::GloveCalibration calibration;
  /// Indices of the parts of the hand that count: joints that some channel of the glove moves, and
  /// the motors and cables that turn with them. What only holds a posture says nothing of a filter.
  std::vector<int> measured_joints;
  std::vector<int> measured_motors;
  std::vector<int> measured_cables;
  std::vector<std::string> measured_joint_names;
  int joint_count = 0;                             // of the hand, measured or not
  ScoreRows rows;                                  // of these joints, motors and cables
  std::vector<std::string> remarks;                // what was repaired or replaced, a line each
  std::shared_ptr<const GloveSignal> first_glove;  // the signal of the first seed
  std::vector<GloveFacts> repetitions;             // of the first seed of each; one if none differ

  const std::vector<std::string>& channel_names() const { return calibration.channel_names; }
  /// From the glove's channels to the hand's joints.
  controller::JointMap joint_map() const {
    return {scenario.joint_map, channel_names(), hand->transmission()};
  }
};

/// All that the controller is made from: with the glove and the hand of the scenario.
controller::RobotConfig RobotOf(const Scenario& scenario, const HandModel& hand,
                                const controller::ControllerConfig& config);

/// The trial of one controller of the study.
TrialSetup SetupOf(const Study& study, const NamedController& named);

/// Empties the name of the default camera where the model does not have it: the whole is shown.
/// Errors: SettingError `video.camera` for another that the model does not have.
void ChooseVideoCamera(const HandModel& hand, std::string& camera);

/// Builds hand, glove (of the first seed of every repetition) and every controller.
/// Errors: UserError, SettingError.
Study PrepareStudy(Scenario scenario);

class StudyDatabase;

/// What one controller did with one seed.
struct TrialOutcome {
  Scores scores;  // none, all NaN, of a hand that was stopped
  HandHealth health;
  std::vector<std::int64_t> untrusted_samples;  // per channel
};

/// All trials of one seed: the same glove signal and the same hand for every controller.
struct SeedOutcome {
  int seed = 0;
  int motion = 0;  // number of what the wearer did, from 0: the same where the true angles are
  std::vector<TrialOutcome> controllers;  // in the order of the scenario
};

struct StudyOptions {
  int seeds = 1;  // seed, seed + 1, ...
  int jobs = 1;
  /// Gets trials done (with fractions of the running ones) and trials in all, twins counted. Called
  /// from any thread, one at a time. False stops: RunStudy throws Cancelled.
  std::function<bool(double, int)> progress;
  /// Gets a line for the user about what went otherwise than asked and changes no result. May be
  /// empty.
  std::function<void(const std::string&)> remark = {};
  /// Keep the glove signal and the traces of the first seed.
  bool keep_first_traces = true;
  /// Where finished trials are kept and looked for; null: nowhere.
  StudyDatabase* database = nullptr;
};

struct StudyResult {
  std::vector<std::string> controller_names;
  std::vector<std::string> row_names;  // of the scores: see ScoreRows
  std::string reference_name;
  std::vector<SeedOutcome> seeds;  // in the order of seeds, whatever the schedule
  /// Nothing is drawn at random: one seed of each repetition was run, the others would be the same.
  bool seeds_alike = false;
  double shortest_s = 0.0;  // of the trials, as far as the wearer's motion goes
  double longest_s = 0.0;
  std::shared_ptr<const GloveSignal> first_glove;
  Signal first_reference_rad;  // ticks x joints of the hand
  std::vector<Trace> first_traces;
  std::vector<std::optional<NoiseFreeTwin>> first_twins;  // of these trials, where they have one
};

/// Where the noise-free twin of a seed's trials comes from.
enum class TwinSource {
  kNone,    // not wanted, or not to be had: a recorded glove cannot be without its noise
  kItself,  // the trial has no noise, nor faults
  kTrial,   // a trial of its own, before the other
};
TwinSource TwinOf(const Study& study, int seed);

/// How many trials are run for so many seeds, twins included.
int TrialCount(const Study& study, int seeds);

/// Runs every controller on every seed, `jobs` trials at a time; repetitions take turns. Where
/// nothing is drawn at random, as with the recording of a real glove, one seed of each repetition
/// stands for all. Before a trial its noise-free twin runs, which the scores need: see ScoreInput.
/// The result does not depend on jobs. Errors: RunError, before the first trial, where the signals
/// find no room: see SignalStorage.
StudyResult RunStudy(const Study& study, const StudyOptions& options);

}  // namespace gauntlet::sim
