// A walk through the keys of a scenario that concern time, channels, segments or the video: at both
// ends of its range, and at odd values, a key changes the scores as its help says or is refused by
// name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/settings/setting_rows.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

enum class Outcome {
  kChanges,  // other scores than without it
  kKeeps,    // the same scores: it draws, or has nothing to act on
  kRefused,  // one line that names what is wrong
};
using enum Outcome;

struct Step {
  std::string set;  // key=value
  Outcome outcome;
  std::string says = {};               // what a refusal says; empty: the key
  std::vector<std::string> with = {};  // settings under which the key has something to act on

  std::string key() const { return set.substr(0, set.find('=')); }
};

const std::string kOf = "controllers.walked.";  // the only controller
const std::vector<std::string> kTremor = {"glove.tremor.rms_deg=3"};
const std::vector<std::string> kHum = {"glove.noise.mains_amplitude_counts=20"};
const std::vector<std::string> kDrift = {"glove.sensor.drift_deviation_percent=20"};
// Nothing was recorded from 4.47 to 4.87 s.
const std::vector<std::string> kGap = {"glove.motion={kind: recording, file: " + SourceDir() +
                                       "/scenarios/recordings/door_opening/targets.csv, use: "
                                       "measured, problems: repair, start_s: 3.2, "
                                       "duration_s: 3}"};
const std::vector<std::string> kJumps = {kOf + "untrusted.jump_share=0.01"};
// Every channel is refused for ever at its first jump.
const std::vector<std::string> kRefuses = {kOf + "untrusted.jump_share=0.01",
                                           kOf + "untrusted.jump_confirm_ms=1000000",
                                           kOf + "untrusted.when_lost=rest"};
const std::vector<std::string> kLost = {kRefuses[0], kRefuses[1], kRefuses[2],
                                        kOf + "untrusted.lost_after_ms=100"};
const std::vector<std::string> kStill = {"glove.motion={kind: hold, duration_s: 1.5}",
                                         "glove.noise.kind=none"};
const std::vector<std::string> kSlow = {"glove.rate_hz=33.3"};
const std::vector<std::string> kOddEvents = {"event.period_ms=7.3"};
const std::vector<std::string> kGloveLink = {"link.glove.preset=none"};
const std::vector<std::string> kHandLink = {"link.hand.preset=none"};
const std::vector<std::string> kShort = {"glove.motion.duration_s=0.03"};
const std::vector<std::string> kFive = {
    "glove.channels=[thumb_ip, index_pip, middle_pip, ring_pip, little_pip]"};
const std::vector<std::string> kFiveSlow = {kFive[0], "glove.rate_hz=33.3"};
const std::vector<std::string> kJointLoop = {"hand.joint_sensors.kind=encoder",
                                             kOf + "joint_loop.kind=pi"};
const std::vector<std::string> kSlowJointLoop = {kJointLoop[0], kJointLoop[1], kSlow[0]};
const std::vector<std::string> kPlanned = {kOf + "model_predictive.kind=second_order",
                                           kOf + "prediction={kind: kalman, horizon_ms: 0}"};
const std::vector<std::string> kRareReadings = {kJointLoop[0], kJointLoop[1],
                                                "hand.joint_sensors.rate_hz=5"};

const std::vector<Step>& Walk() {
  static const std::vector<Step> kSteps = {
      // Rates.
      {"glove.rate_hz=10", kChanges},
      {"glove.rate_hz=33.3", kChanges},
      {"glove.rate_hz=60", kChanges},
      {"glove.rate_hz=1000.5", kChanges},
      {"glove.rate_hz=10000", kChanges, {}, {"glove.motion.duration_s=0.3"}},
      {"glove.rate_hz=9.9", kRefused},
      {"glove.rate_hz=33.3", kChanges, {}, kFive},
      {"glove.rate_hz=33.3", kChanges, {}, {kOf + "filter_at=event"}},
      {"glove.rate_hz=33.3", kChanges, {}, {kOf + "prediction={kind: kalman, horizon_ms: 60}"}},
      {"glove.rate_hz=33.3", kChanges, {}, kTremor},
      {"glove.rate_hz=33.3", kChanges, {}, {"glove.noise.pink_variance_counts2=50"}},
      {"glove.rate_hz=10", kChanges, {}, {"glove.noise.pink_variance_counts2=50"}},
      {"glove.rate_hz=10", kChanges, {}, {"glove.faults=[{kind: dropouts, rate_per_s: 4}]"}},
      {"glove.rate_hz=33.3", kChanges, {}, {"glove.faults=[{kind: spikes, rate_per_s: 4}]"}},
      {"glove.rate_hz=33.3", kChanges, {}, {"glove.faults=[{kind: late_frames, rate_per_s: 4}]"}},
      {"glove.rate_hz=33.3", kChanges, {}, {"glove.faults=[{kind: time_jitter, deviation_ms: 9}]"}},
      // Events.
      {"event.period_ms=1", kChanges},
      {"event.period_ms=7.3", kChanges},
      {"event.period_ms=1000", kChanges},
      {"event.period_ms=1001", kRefused},
      {"event.period_ms=1", kChanges, {}, kSlow},
      {"event.delay_ms=0", kChanges},
      {"event.delay_ms=12.7", kChanges},
      {"event.delay_ms=1000", kChanges},
      {"event.delay_ms=1001", kRefused},
      {"event.delay_ms=12.7", kChanges, {}, kFiveSlow},
      // Links.
      {"link.glove.delay.delay_ms=0", kKeeps, {}, kGloveLink},
      {"link.glove.delay.delay_ms=10000", kChanges, {}, kGloveLink},
      {"link.glove.delay.delay_ms=10001", kRefused},
      {"link.glove.frame_ms=0", kKeeps, {}, kGloveLink},
      {"link.glove.frame_ms=1000", kChanges, {}, kGloveLink},
      {"link.glove.batch_ms=0", kKeeps, {}, kGloveLink},
      {"link.glove.batch_ms=1000", kChanges, {}, kGloveLink},
      {"link.hand.delay.delay_ms=0", kKeeps, {}, kHandLink},
      {"link.hand.delay.delay_ms=10000", kChanges, {}, kHandLink},
      {"link.hand.delay.delay_ms=10001", kRefused},
      {"link.hand.frame_ms=0", kKeeps, {}, kHandLink},
      {"link.hand.frame_ms=1000", kChanges, {}, kHandLink},
      {"link.hand.batch_ms=0", kKeeps, {}, kHandLink},
      {"link.hand.batch_ms=1000", kChanges, {}, kHandLink},
      // Physics and servos.
      {"hand.step_ms=0.01", kChanges, {}, kShort},
      {"hand.step_ms=0.3", kChanges},
      {"hand.step_ms=1", kKeeps},  // the default
      {"hand.step_ms=1.1", kRefused},
      {"hand.step_ms=0.3", kChanges, {}, kSlow},
      {"hand.servo.frame_ms=0", kChanges},
      {"hand.servo.frame_ms=5", kKeeps},  // the default
      {"hand.servo.frame_ms=7.7", kChanges},
      {"hand.servo.frame_ms=1000", kChanges},
      {"hand.servo.frame_ms=1001", kRefused},
      {"hand.servo.frame_ms=7.7", kChanges, {}, {"hand.servo.free_running=false"}},
      {"hand.servo.dead_time_ms=0", kChanges},
      {"hand.servo.dead_time_ms=2", kKeeps},  // the default
      {"hand.servo.dead_time_ms=12.7", kChanges},
      {"hand.servo.dead_time_ms=12.7", kChanges, {}, kSlow},
      {"hand.servo.dead_time_ms=500", kChanges},
      {"hand.servo.dead_time_ms=501", kRefused},
      {"hand.servo={kind: bus}", kChanges},
      {"hand.servo={kind: rc_digital}", kChanges, {}, kFiveSlow},
      {"hand.servo.damping_ms=0", kChanges},
      {"hand.servo.damping_ms=100", kChanges},
      {"hand.servo.damping_ms=101", kRefused},
      {"hand.servo.no_load_speed_deg_s=1", kRefused, "hand.servo: the servo of thumb_rotation"},
      {"hand.servo.no_load_speed_deg_s=100", kChanges},
      {"hand.servo.no_load_speed_deg_s=10000", kKeeps},  // none turns as fast as its own
      {"hand.arm_servo.frame_ms=0", kChanges},
      {"hand.arm_servo.frame_ms=5", kKeeps},  // the default
      {"hand.arm_servo.frame_ms=1000", kChanges},
      {"hand.arm_servo.frame_ms=1001", kRefused},
      {"hand.arm_servo.dead_time_ms=0", kChanges},
      {"hand.arm_servo.dead_time_ms=2", kKeeps},  // the default
      {"hand.arm_servo.dead_time_ms=500", kChanges},
      {"hand.arm_servo.dead_time_ms=501", kRefused},
      {"hand.arm_servo={kind: bus}", kChanges},
      {"hand.arm_servo.damping_ms=0", kChanges},
      {"hand.arm_servo.damping_ms=100", kChanges},
      {"hand.arm_servo={kind: standard, damping_ms: 100}", kRefused,
       "hand.arm_servo: the servo of "},
      {"hand.arm_servo.damping_ms=101", kRefused},
      {"hand.arm_servo.no_load_speed_deg_s=1", kRefused, "hand.arm_servo: the servo of "},
      {"hand.arm_servo.no_load_speed_deg_s=10000", kChanges},
      {"hand.motor_friction_scale=0", kChanges},
      {"hand.motor_friction_scale=100", kChanges},
      {"hand.motor_friction_scale=101", kRefused},
      {"hand.motor_friction_scale=[1, 1]", kRefused},
      // Joint sensors, and what uses them.
      {"hand.joint_sensors.kind=encoder", kKeeps},  // nobody does
      {kOf + "joint_loop.kind=pi", kRefused, "joint_loop.kind: pi needs a hand that measures"},
      {kOf + "joint_loop.kind=pi", kChanges, {}, {"hand.joint_sensors.kind=encoder"}},
      {"hand.joint_sensors.rate_hz=1", kChanges, {}, kJointLoop},
      {"hand.joint_sensors.rate_hz=33.3", kChanges, {}, kSlowJointLoop},
      {"hand.joint_sensors.rate_hz=10000", kChanges, {}, kJointLoop},
      {"hand.joint_sensors.rate_hz=0.9", kRefused},
      {"hand.joint_sensors.delay_ms=0", kChanges, {}, kJointLoop},
      {"hand.joint_sensors.delay_ms=12.7", kChanges, {}, kSlowJointLoop},
      {"hand.joint_sensors.delay_ms=1000", kChanges, {}, kJointLoop},
      {"hand.joint_sensors.delay_ms=1001", kRefused},
      {kOf + "joint_loop.integral_per_s=0", kChanges, {}, kJointLoop},
      {kOf + "joint_loop.integral_per_s=50", kChanges, {}, kJointLoop},
      {kOf + "joint_loop.integral_per_s=51", kRefused, {}, kJointLoop},
      {kOf + "joint_loop.expected_delay_ms=0", kChanges, {}, kJointLoop},
      {kOf + "joint_loop.expected_delay_ms=33.3", kChanges, {}, kSlowJointLoop},
      {kOf + "joint_loop.expected_delay_ms=1000", kChanges, {}, kJointLoop},
      {kOf + "joint_loop.expected_delay_ms=1001", kRefused, {}, kJointLoop},
      {kOf + "joint_loop.stale_after_ms=0", kKeeps, {}, kJointLoop},  // a reading every 10 ms
      {kOf + "joint_loop.stale_after_ms=0", kChanges, {}, kRareReadings},
      {kOf + "joint_loop.stale_after_ms=10000", kChanges, {}, kRareReadings},
      {kOf + "joint_loop.stale_after_ms=10001", kRefused, {}, kJointLoop},
      // Scores.
      {"score.noise_free_twin=false", kChanges},
      {"score.noise_free_twin=true", kKeeps},
      {"score.noise_free_twin=2", kRefused},
      {"score.recovery_s=0", kKeeps},  // without a gap
      {"score.recovery_s=0", kChanges, {}, kGap},
      {"score.recovery_s=60", kChanges, {}, kGap},
      {"score.recovery_s=61", kRefused},
      // Channels and joints.
      {"glove.channels=[]", kKeeps},
      {"glove.channels=[index_mcp]", kChanges},
      {kFive[0], kChanges},
      {"glove.channels=[index_dip, little_dip]", kRefused, "joint_map: moves no joint of the hand"},
      {"glove.channels=[nose]", kRefused},
      {"glove.channels=[index_mcp, index_mcp]", kRefused},
      {"glove.noise.variance_counts2=[1, 2, 3]", kRefused, "glove.noise.variance_counts2", kFive},
      {"glove.noise.covariance_counts2=[1, 0, 0, 1]", kRefused, "glove.noise.covariance_counts2",
       kFive},
      {"glove.motion.channels=[index_mcp]", kChanges},
      {"glove.motion.channels=[nose]", kRefused},
      {"glove.tremor.channels=[index_mcp]", kChanges, {}, kTremor},
      {"glove.tremor.channels=[nose]", kRefused, {}, kTremor},
      {"joint_map.index_mcp={channels: [index_pip]}", kChanges},
      {"joint_map.index_mcp={channels: [index_pip, ring_pip], weights: [0.5, 0.25]}", kChanges},
      {"joint_map.index_mcp={channels: [], offset_deg: 30}", kChanges},
      {"joint_map.index_mcp={channels: [index_pip], offset_deg: 500}", kRefused,
       "joint_map.index_mcp.offset_deg"},
      {"joint_map.index_mcp={channels: [index_pip], weights: [1, 2]}", kRefused,
       "joint_map.index_mcp.weights"},
      {"joint_map.index_mcp={channels: [index_pip], weights: [0]}", kRefused,
       "joint_map.index_mcp.weights"},
      {"joint_map.index_mcp={channels: [index_mcp]}", kRefused, "joint_map.index_mcp.channels",
       kFive},
      {"joint_map.nose={channels: [index_pip]}", kRefused},
      {"score.jitter_above_hz=100", kChanges},
      {"score.jitter_above_hz=2", kRefused, "score.jitter_above_hz: is 2, must be at least 9.7"},
      {"score.jitter_above_hz=101", kRefused},
      {"video.channel=ring_pip", kKeeps},
      {"video.channel=nose", kRefused},
      {"video.channel=index_mcp", kKeeps, {}, kFive},
      {"video.camera=arm", kKeeps},
      {"video.camera=fingers", kKeeps},
      {"video.camera=close_up", kKeeps},
      {"video.camera=nose", kRefused},
      {"video.width_px=480", kKeeps},
      {"video.width_px=3840", kKeeps},
      {"video.width_px=478", kRefused},
      {"video.width_px=481", kRefused, "video.width_px: is 481, must be even"},
      {"video.height_px=270", kKeeps},
      {"video.height_px=2160", kKeeps},
      {"video.height_px=268", kRefused},
      {"video.height_px=271", kRefused, "video.height_px: is 271, must be even"},
      {"video.frames_per_s=1", kKeeps},
      {"video.frames_per_s=120", kKeeps},
      {"video.frames_per_s=0", kRefused},
      // Segments.
      {"glove.motion.label=rest", kChanges},
      {"glove.motion.label=slow", kChanges},
      {"glove.motion.label=fast", kChanges},
      {"glove.motion.label=onset", kChanges},
      {"glove.motion.label=reversal", kChanges},
      {"glove.motion.label=dance", kKeeps},  // only stored
      {"glove.motion.label=fast", kChanges, {}, kFiveSlow},
      // Motion, tremor, sensors.
      {"glove.motion.duration_s=0.01", kChanges},
      {"glove.motion.duration_s=3601", kRefused},
      {"glove.motion.bandwidth_hz=0.01", kChanges},
      {"glove.motion.bandwidth_hz=50", kChanges},
      {"glove.motion.bandwidth_hz=50", kChanges, {}, kSlow},
      {"glove.tremor.from_hz=0.5", kChanges, {}, kTremor},
      {"glove.tremor.from_hz=25", kRefused, "glove.tremor.to_hz: is below from_hz", kTremor},
      {"glove.tremor.to_hz=0.5", kRefused, {}, kTremor},
      {"glove.tremor.to_hz=25", kChanges, {}, kTremor},
      {"glove.tremor.to_hz=25", kChanges, {}, {kTremor[0], "glove.rate_hz=33.3"}},
      {"glove.sensor.lag_ms=0", kKeeps},  // the default
      {"glove.sensor.lag_ms=1000", kChanges},
      {"glove.sensor.lag_ms=40", kChanges, {}, kSlow},
      {"glove.sensor.drift_time_s=1", kChanges, {}, kDrift},
      {"glove.sensor.drift_time_s=100000", kChanges, {}, kDrift},
      // Noise.
      {"glove.noise.mains_hz=10", kChanges, {}, kHum},
      {"glove.noise.mains_hz=400", kChanges, {}, kHum},
      {"glove.noise.mains_hz=400", kChanges, {}, {kHum[0], "glove.rate_hz=33.3"}},
      // Controllers.
      {kOf + "filter_at=event", kChanges},
      {kOf + "filter_at=event", kChanges, {}, kFiveSlow},
      {kOf + "filter={kind: butterworth, cutoff_hz: 16}", kChanges, {}, kSlow},
      {kOf + "filter={kind: butterworth, cutoff_hz: 17}", kRefused,
       "cutoff_hz: is 17, must be below half the rate, 16.65", kSlow},
      {kOf + "filter={kind: butterworth, cutoff_hz: 500}", kRefused, "cutoff_hz: is 500"},
      {kOf + "filter={kind: butterworth, cutoff_hz: 25}",
       kRefused,
       "below half the rate, 25",
       {kOf + "filter_at=event"}},
      {kOf + "prediction={kind: linear, horizon_ms: 0}", kKeeps},
      {kOf + "prediction={kind: linear, horizon_ms: 1000}", kChanges},
      {kOf + "prediction={kind: kalman, horizon_ms: 1000}", kChanges},
      {kOf + "prediction={kind: kalman, horizon_ms: 1001}", kRefused, "horizon_ms: is 1001"},
      {kOf + "prediction={kind: kalman, horizon_ms: [10, 20]}", kRefused,
       "horizon_ms: has 2 values, must have 1 for all channels or 18"},
      {kOf + "prediction={kind: adaptive, horizon_ms: 0}", kChanges},
      {kOf + "prediction={kind: adaptive, horizon_ms: 1000}", kChanges},
      {kOf + "prediction={kind: adaptive, memory_ms: 1}", kChanges},
      {kOf + "prediction={kind: adaptive, memory_ms: 100000}", kChanges},
      {kOf + "prediction={kind: fitted, tap_ms: 0.1, weights: [-1]}", kRefused,
       "tap_ms: is 0.1, must be a multiple of the step of the filter, 1 ms"},
      {kOf + "prediction={kind: fitted, tap_ms: 1000, weights: [-1]}", kChanges},
      {kOf + "prediction={kind: fitted, weights: [-1], position_weights: [1]}", kRefused,
       "position_weights: has 1 values, must have none, 18, one for each channel, or 324, one of "
       "every channel for each"},
      {kOf + "prediction={kind: fitted, weights: [-1], slope_weights: [1]}", kRefused,
       "slope_weights: has 1 values, must have none or 324, one of every channel for each"},
      {kOf + "prediction={kind: fitted, weights: [-1], offset_deg: [1]}", kRefused,
       "offset_deg: has 1 values, must have none or 18"},
      {kOf + "prediction={kind: fitted_to_others}", kRefused,
       "kind: is fitted_to_others, which needs replicates with other motions; this scenario has "
       "one motion, or draws them"},
      {kOf + "model_predictive.kind=second_order", kChanges},
      {kOf + "model_predictive.kind=second_order",
       kRefused,
       "prediction.kind: is fitted, must be none or one whose horizon_ms may be changed",
       {kOf + "prediction={kind: fitted, tap_ms: 5, weights: [-1]}"}},
      {kOf + "model_predictive.kind=second_order", kRefused,
       "joint_loop.kind: pi with proportional", kJointLoop},
      {kOf + "model_predictive.dead_time_ms=0", kChanges, {}, kPlanned},
      {kOf + "model_predictive.dead_time_ms=500", kChanges, {}, kPlanned},
      {kOf + "model_predictive.dead_time_ms=501", kRefused, {}, kPlanned},
      {kOf + "model_predictive.dead_time_ms=500",
       kRefused,
       "prediction.horizon_ms: and what model_predictive plans beyond it are 1",
       {kPlanned[0], kPlanned[1], "event.period_ms=100"}},
      {kOf + "model_predictive.lag_ms=0.1", kChanges, {}, kPlanned},
      {kOf + "model_predictive.lag_ms=1000", kChanges, {}, kPlanned},
      {kOf + "model_predictive.lag_ms=0", kRefused, {}, kPlanned},
      {kOf + "model_predictive.natural_frequency_hz=0.1", kChanges, {}, kPlanned},
      {kOf + "model_predictive.natural_frequency_hz=100", kChanges, {}, kPlanned},
      {kOf + "model_predictive.natural_frequency_hz=0", kRefused, {}, kPlanned},
      {kOf + "model_predictive.speed_limit_deg_s=0", kKeeps, {}, kPlanned},  // the default
      {kOf + "model_predictive.speed_limit_deg_s=20", kChanges, {}, kPlanned},
      {kOf + "model_predictive.speed_limit_deg_s=100000", kKeeps, {}, kPlanned},  // never reached
      {kOf + "model_predictive.speed_limit_deg_s=-1", kRefused, {}, kPlanned},
      {kOf + "motor.speed_limit_rad_s=0", kKeeps},  // no limit: the default is never reached
      {kOf + "motor.speed_limit_rad_s=1", kChanges},
      {kOf + "motor.speed_limit_rad_s=10000", kKeeps},
      {kOf + "motor.speed_limit_rad_s=1", kChanges, {}, kOddEvents},
      {kOf + "untrusted.stuck_after_ms=0", kChanges, {}, kStill},
      {kOf + "untrusted.stuck_after_ms=333.3", kChanges, {}, kStill},
      {kOf + "untrusted.stuck_after_ms=1000000", kChanges, {}, kStill},
      {kOf + "untrusted.jump_confirm_ms=0", kChanges, {}, kJumps},
      {kOf + "untrusted.jump_confirm_ms=33.3", kChanges, {}, kJumps},
      {kOf + "untrusted.jump_confirm_ms=1000000", kChanges, {}, kJumps},
      {kOf + "untrusted.jump_confirm_ms=1000001", kRefused, {}, kJumps},
      {kOf + "untrusted.lost_after_ms=0", kKeeps, {}, kRefuses},  // the default
      {kOf + "untrusted.lost_after_ms=33.3", kChanges, {}, kRefuses},
      {kOf + "untrusted.lost_after_ms=1000000", kKeeps, {}, kRefuses},  // longer than the trial
      {kOf + "untrusted.lost_after_ms=1000001", kRefused, {}, kRefuses},
      {kOf + "untrusted.lost_speed_deg_s=0.1", kChanges, {}, kLost},
      {kOf + "untrusted.lost_speed_deg_s=10000", kChanges, {}, kLost},
  };
  return kSteps;
}

class KeysWalk : public testing::Test {
 protected:
  KeysWalk() {
    std::ofstream(file()) << "question: q\n"
                             "glove: {motion: {kind: random, duration_s: 1.4}}\n"
                             "controllers: {walked: {filter: {kind: kalman, q: 0.1}}}\n";
  }

  std::string file() const { return (folder_.path() / "walk.yaml").string(); }

  /// The summary of the scores and how many samples were not trusted, as bits. Errors: as a person
  /// sees them.
  std::string ScoresWith(const std::vector<std::string>& settings) const {
    const StudyResult result = RunStudy(PrepareStudy(LoadScenario(file(), settings)), {});
    const TrialOutcome& outcome = result.seeds[0].controllers[0];
    EXPECT_TRUE(outcome.health.ok) << outcome.health.problem;
    EXPECT_TRUE(std::isfinite(outcome.scores.summary[MetricIndex("tracking_rmse_deg")]));
    std::string bits;
    const auto add = [&bits](const auto& values) {
      for (const auto& value : values) {
        std::array<char, sizeof value> bytes;
        std::memcpy(bytes.data(), &value, sizeof value);
        bits.append(bytes.begin(), bytes.end());
      }
    };
    add(outcome.scores.summary);
    add(outcome.untrusted_samples);
    return bits;
  }

  const std::string& ScoresWithout(const std::vector<std::string>& settings) {
    std::string& known = without_[settings];
    if (known.empty()) known = ScoresWith(settings);
    return known;
  }

  void ExpectRefused(const Step& step, const std::vector<std::string>& settings) const {
    try {
      ScoresWith(settings);
      ADD_FAILURE() << step.set << " is accepted";
    } catch (const std::exception& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(step.says.empty() ? step.key() : step.says));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n"))) << step.set;
    }
  }

 private:
  test::TemporaryDirectory folder_;
  std::map<std::vector<std::string>, std::string> without_;
};

TEST_F(KeysWalk, EveryValueChangesTheScoresOrIsRefused) {
  for (const Step& step : Walk()) {
    SCOPED_TRACE(testing::Message() << step.set << " with " << testing::PrintToString(step.with));
    std::vector<std::string> settings = step.with;
    settings.push_back(step.set);
    if (step.outcome == kRefused) {
      ExpectRefused(step, settings);
      continue;
    }
    EXPECT_EQ(ScoresWith(settings) == ScoresWithout(step.with), step.outcome == kKeeps);
  }
}

/// Does a key concern time, channels, segments or the video?
bool IsWalked(const std::string& key) {
  const auto ends_with = [&key](const char* end) { return key.ends_with(end); };
  const auto has = [&key](const char* part) { return key.find(part) != std::string::npos; };
  return ends_with("_ms") || ends_with("_s") || ends_with("_hz") || has("channel") ||
         has("label") || has("joint_map") || has("filter_at") || has("video.");
}

/// Keys that need no walk, and why.
const std::map<std::string, std::string>& NotWalked() {
  static const std::map<std::string, std::string> kReasons = {
      {"controllers.walked.linearisation.channels", "measured curves: calibration_test.cc"},
  };
  return kReasons;
}

/// Values that no test can wait for.
bool IsTooLong(const std::string& setting) { return setting == "glove.motion.duration_s=3600"; }

TEST_F(KeysWalk, PassesEveryKeyAtBothEndsOfItsRange) {
  Scenario scenario;
  std::vector<SettingRow> rows =
      ListSettings([&](controller::SettingsVisitor& visitor) { scenario.Visit(visitor); });
  NamedController named;
  for (SettingRow row :
       ListSettings([&](controller::SettingsVisitor& visitor) { named.Visit(visitor); })) {
    row.key = kOf + row.key;
    rows.push_back(row);
  }
  for (const SettingRow& row : rows) {
    if (!IsWalked(row.key) || NotWalked().contains(row.key)) continue;
    const auto passes = [](const auto& fits) { return std::ranges::any_of(Walk(), fits); };
    EXPECT_TRUE(passes([&](const Step& step) { return step.set.starts_with(row.key); })) << row.key;
    const std::size_t to = row.range.find(" to ");
    if (to == std::string::npos) continue;
    const std::string high = row.range.substr(to + 4, row.range.find(';') - to - 4);  // of a list
    for (const std::string& end : {row.range.substr(0, to), high}) {
      const std::string setting = row.key + "=" + end;
      if (IsTooLong(setting)) continue;
      EXPECT_TRUE(passes([&](const Step& step) { return step.set == setting; })) << setting;
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
