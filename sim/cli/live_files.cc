#include "sim/cli/live_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "sim/answers/compare/study_files.h"
#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/live/target_scores.h"
#include "sim/show/pages/report_page.h"
#include "sim/study/counted_parts.h"
#include "sim/study/trial_score.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/trace_signals.h"

namespace gauntlet::sim {
namespace {

using Index = Eigen::Index;

void CutTrace(Index ticks, Trace& trace) {
  ForEachSignal(trace, [&](const auto&, auto& matrix) {
    if (matrix.cols() > 0) matrix.KeepRows(ticks);
  });
}

/// The scenario of a session with a real glove: its recording, without the simulated glove's noise
/// and faults, and without the way of the frames, which is in the recording.
Scenario ScenarioOfSession(const Scenario& scenario, const std::filesystem::path& recording,
                           double duration_s) {
  Scenario session = scenario;
  session.repetitions = {};
  session.made_with = {};
  session.name += "_live";
  RecordedMotionConfig motion;
  motion.file = recording.string();
  motion.use = RecordingUse::kMeasured;
  motion.problems = ProblemHandling::kRepair;
  motion.repair_budget_percent = 100.0;
  motion.duration_s = duration_s;
  session.glove.motion = {.settings = motion};
  session.glove.tremor = {};
  session.glove = WithoutNoise(session.glove);
  if (session.link && session.link->glove) session.link->glove->transport = {};
  session.controllers.resize(1);
  session.baseline.clear();
  return session;
}

FinishedStudy FinishedOf(Study study, std::shared_ptr<const GloveSignal> glove, Trace trace) {
  FinishedStudy finished{.study = std::move(study), .result = {}, .summary = {}};
  finished.study.gloves = {glove};
  const Signal reference_rad = ReferenceAngles(finished.study.joint_map(), glove->true_angle_rad);
  TrialOutcome outcome{
      .scores = ScoreTrial(finished.study, finished.study.scenario.controllers.front().config,
                           *glove, reference_rad, trace, std::nullopt),
      .health = trace.health,
      .untrusted_samples = trace.untrusted_samples};
  StudyResult& result = finished.result;
  const double length_s = static_cast<double>(glove->true_angle_rad.rows()) / glove->tick_rate_hz;
  result.controller_names = {trace.controller_name};
  result.row_names = finished.study.rows.names;
  result.reference_name = glove->reference_name;
  result.seeds = {{.seed = finished.study.scenario.seed, .controllers = {std::move(outcome)}}};
  result.shortest_s = result.longest_s = length_s;
  result.first_glove = std::move(glove);
  result.first_reference_rad = reference_rad;
  result.first_traces.push_back(std::move(trace));
  result.first_twins.resize(1);
  result.first_others.resize(1);
  finished.summary = Summarise(finished.study, finished.result);
  return finished;
}

TargetScoring ScoringOf(const Study& study) {
  return {.rate_hz = study.hand->timing().tick_rate_hz(),
          .jitter_above_hz = study.scenario.score.jitter_above_hz,
          .joints = study.measured_joints};
}

/// Smallest delay of each controller: the one that began, then the shadows.
std::vector<double> EarliestDelays_s(const LiveSetup& setup) {
  const HandModel& hand = *setup.trial.hand;
  std::vector<double> earliest_s = {EarliestAskedDelay_s(hand, setup.trial.controller)};
  for (const ShadowSetup& shadow : setup.shadows) {
    earliest_s.push_back(EarliestAskedDelay_s(hand, shadow.controller));
  }
  return earliest_s;
}

std::vector<ShadowScore> ScoreShadows(const LiveRecord& record, const FinishedStudy& finished,
                                      LiveResult& result) {
  const Signal& driven_rad = finished.result.first_traces.front().target_angle_rad;
  const Index ticks = driven_rad.rows();
  const std::optional<CountedParts> counted =
      CountedPartsOf(finished.study, finished.result.first_glove->masked, static_cast<int>(ticks));
  const std::vector<double> earliest_s = EarliestDelays_s(*record.setup);
  std::vector<ShadowScore> shadows;
  std::vector<AskingController> asked;
  const auto add = [&](std::size_t controller, const std::string& name, const Signal& asked_rad,
                       double step_p99_us) {
    shadows.push_back({.name = name, .drives = controller == 0, .step_p99_us = step_p99_us});
    const auto joint_of = [&, signal = &asked_rad](std::size_t joint) {
      const int column = finished.study.measured_joints[joint];
      return AskedAngle{
          .reference_rad = finished.result.first_reference_rad.col(column),
          .asked_rad = signal->col(column),
          .counted = counted ? counted->joints[joint] : CountedTicks{{0, static_cast<int>(ticks)}}};
    };
    asked.push_back({.joint = joint_of, .earliest_delay_s = earliest_s[controller]});
  };
  add(0, record.setup->trial.controller_name, driven_rad,
      result.facts.switch_count > 0 ? controller::kNaN : result.facts.step_cpu.Quantile_us(0.99));
  for (std::size_t i = 0; i < result.shadows.size(); ++i) {
    Signal& target_rad = result.shadows[i].target_angle_rad;
    if (target_rad.rows() < ticks) continue;  // the log was too slow
    target_rad.KeepRows(ticks);
    add(i + 1, record.setup->shadows[i].name, target_rad, result.shadows[i].step.Quantile_us(0.99));
  }
  const std::vector<TargetScores> scores = ScoreTargets(ScoringOf(finished.study), asked);
  for (std::size_t i = 0; i < shadows.size(); ++i) {
    shadows[i].jitter_rms_deg = scores[i].jitter_rms_deg;
    shadows[i].delay_ms = scores[i].delay_ms;
    shadows[i].tracking_rmse_deg = scores[i].tracking_rmse_deg;
  }
  return shadows;
}

}  // namespace

double TraceLength_s(double seconds, double motion_s) {
  constexpr double kUnknown_s = 120.0;
  constexpr double kMost_s = 600.0;
  double length_s = seconds > 0.0 ? seconds : kUnknown_s;
  if (motion_s > 0.0) length_s = seconds > 0.0 ? std::min(seconds, motion_s) : motion_s;
  return std::min(length_s, kMost_s);
}

LiveOutcome ScoreSession(const LiveRecord& record, const std::filesystem::path& recording,
                         const std::filesystem::path& folder, LiveResult& result) {
  LiveOutcome outcome;
  Trace trace = std::move(result.trace);
  const Index rows = trace.hand_angle_rad.rows();
  const double rate_hz = record.study->hand->timing().tick_rate_hz();
  Study study = *record.study;
  auto glove = std::make_shared<GloveSignal>();
  try {
    if (record.setup->source != nullptr) {
      if (result.recorded.kept < 2) throw UserError("the recording has fewer than two samples");
      const double length_s =
          std::min(static_cast<double>(rows) / rate_hz, result.recorded.last_time_s);
      study = PrepareStudy(ScenarioOfSession(
          study.scenario, recording,
          std::floor(length_s * study.scenario.glove.rate_hz) / study.scenario.glove.rate_hz));
    } else {
      study.scenario.controllers.resize(1);
    }
    *glove = *study.gloves.front();
    const Index ticks = std::min(rows, glove->true_angle_rad.rows());
    CutGlove(ticks, *glove);
    CutTrace(ticks, trace);
    study.scenario.score.Check(rate_hz, ticks);
    outcome.finished = FinishedOf(std::move(study), std::move(glove), std::move(trace));
  } catch (const UserError& error) {
    outcome.remark = fmt::format("no scores and no trace: {}", error.what());
    return outcome;
  } catch (const RunError& error) {
    outcome.remark = fmt::format("no scores and no trace: {}", error.what());
    return outcome;
  } catch (const controller::SettingError& error) {
    outcome.remark = fmt::format("no scores and no trace: {}", error.what());
    return outcome;
  }
  outcome.finished->folder = folder;
  if (result.trace_rows_left_out > 0) {
    outcome.remark =
        fmt::format("the trace lacks {} ticks: the disk was too slow", result.trace_rows_left_out);
  }
  if (result.facts.switch_count > 0) {
    outcome.remark +=
        fmt::format("{}trace and scores are of {} alone, until the first switch after {:.2f} s",
                    outcome.remark.empty() ? "" : "; ", record.setup->trial.controller_name,
                    result.facts.switches.front().time_s);
  }
  if (result.shadows.empty()) return outcome;
  outcome.shadows = ScoreShadows(record, *outcome.finished, result);
  return outcome;
}

RunningScoring RunningScoringOf(const Study& study, const LiveSetup& setup) {
  RunningScoring how{.scoring = ScoringOf(study),
                     .earliest_delay_s = EarliestDelays_s(setup),
                     .joint_map = study.joint_map(),
                     .simulated_glove = setup.simulated_glove,
                     .smoothing_hz = RecordedMotionConfig{}.smoothing_hz,
                     .longest_gap_s = 1e-3 * RecordedMotionConfig{}.longest_gap_ms,
                     .recovery_s = study.scenario.score.recovery_s};
  if (setup.simulated_glove) {
    const std::optional<CountedParts> parts =
        CountedPartsOf(study, setup.simulated_glove->masked,
                       static_cast<int>(setup.simulated_glove->true_angle_rad.rows()));
    if (parts) how.counted = parts->joints;
  }
  return how;
}

void WriteSession(const std::filesystem::path& folder, const FinishedStudy& finished) {
  WriteStudyFiles(folder, finished);
  WriteOutputFile(folder / "report.html", ReportPage(finished, VideoBeside{}));
}

}  // namespace gauntlet::sim
