#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "controller/calibration/noise_estimate.h"
#include "sim/answers/compare/summary.h"
#include "sim/score/statistics/judgement.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// Properties of a filter, found without any signal: from its answer to a single pulse, once it has
/// settled.
struct PaperFilter {
  std::string name;
  bool per_event = false;    // a step is an event and not a sample
  std::vector<double> gain;  // per channel: the share of a jump that passes at once
  std::vector<double>
      noise_share;        // per channel: standard deviation after over before, white noise
  double delay_ms = 0.0;  // at 1 Hz, mean over channels
};

/// One claim, with the numbers that decide it. All claims are one family of questions: see Judge().
struct Claim {
  std::string row;  // of the paper, or of what was added: P4, P16, P18
  std::string claim;
  std::string costs = {};            // in what `after` is worse than `before`; may be empty
  std::string measured = {};         // what the two numbers are
  std::string relevant_reason = {};  // why a smaller difference does not matter
  double before = 0.0;               // as a mean over seeds
  double after = 0.0;
  Comparison comparison = {};  // after - before, paired by seed; better: as claimed
};

/// "confirmed" (better as claimed), "too small to matter", "undecided", "refuted", or "not testable
/// here", where no effect that is to be expected would matter.
std::string_view AnswerText(Judgement judgement);

/// The first test of the paper: one channel, filtered alone [counts].
struct OneChannelTest {
  std::vector<double> truth, measured, filtered;
  double textbook_difference = 0.0;  // largest, against the recursion as printed in textbooks
};

/// The two generators of noise. Bins of the normal one are 0.1 standard deviations wide.
struct GeneratorTest {
  std::int64_t draws = 0;
  double first_bin = 0.0;
  double bin_width = 0.1;
  std::vector<double> normal_density;  // of Box-Muller, per bin
  double normal_mean = 0.0, normal_deviation = 0.0, normal_kurtosis = 0.0;
  int galton_rows = 0;
  std::vector<double> galton_share;   // of the balls, per bin
  double galton_distance = 0.0;       // of the board from the normal law
  double galton_seen_distance = 0.0;  // of the balls from the board's own law
};

/// All that the paper did and said, measured.
struct PaperExperiment {
  bool quick = false;
  std::vector<std::string> set = {};  // as asked for
  FinishedStudy finished;
  StudyResult rc_servo_result;  // raw and paper_kalman with RC servos
  StudyResult burst_result;     // tuned_kalman and prediction in fast_bursts
  Summary burst_summary;
  std::vector<PaperFilter> filters;
  std::vector<Claim> claims;
  OneChannelTest one_channel;
  GeneratorTest generators;
  controller::NoiseEstimate estimated_noise;  // of the glove, from a hand that holds still
  double switching_change = 0.0;  // of other channels' outputs when one is switched off and on
};

/// Facts about the first filter of a controller, for 18 channels with the paper's R.
PaperFilter AnalyseFilter(const NamedController& controller, const controller::Timing& timing);
OneChannelTest RunOneChannelTest();
GeneratorTest RunGeneratorTest(std::int64_t draws);

struct PaperExperimentOptions {
  std::filesystem::path scenario;     // paper_claims.yaml; fast_bursts.yaml stands beside it
  bool quick = false;                 // seconds instead of minutes of motion
  std::vector<std::string> set = {};  // changes of both, KEY=VALUE: the paper's test no more
  int jobs = 1;
  std::function<bool(double done, double total)> progress;
  std::function<void(const std::string&)> remark = {};  // see StudyOptions
};

/// Deterministic. The bursts keep their own motion: `glove.motion` is not changed there. Errors:
/// UserError for the scenario, also where a controller of the claims is not there; Cancelled.
PaperExperiment RunPaperExperiment(const PaperExperimentOptions& options);

/// Index of a controller by its name. Errors: UserError if the scenario has none of that name.
std::size_t ControllerIndex(const StudyResult& result, const std::string& name);

}  // namespace gauntlet::sim
