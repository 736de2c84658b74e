#include "sim/show/paper/paper_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <initializer_list>
#include <numbers>

#include "controller/filters/filter_registry.h"
#include "controller/filters/paper_noise.h"
#include "sim/base/error.h"
#include "sim/base/normal_pair.h"
#include "sim/glove/noise/galton_board.h"
#include "sim/results/table_text.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

constexpr double kRateHz = 1000.0;        // of the first test; the scenario has its own
constexpr int kOneChannelSamples = 6000;  // the paper's
constexpr int kSeeds = 4;

// --- Filters, by their answer to a pulse --------------------------------------------------------

}  // namespace

PaperFilter AnalyseFilter(const NamedController& named, const controller::Timing& timing) {
  PaperFilter facts;
  facts.name = named.name;
  facts.per_event = named.config.filter_at == controller::FilterAt::kEvent;
  const double rate_hz = facts.per_event ? timing.event_rate_hz() : timing.sample_rate_hz();
  const int channels = static_cast<int>(controller::PaperMeasurementVariance().size());
  const auto filter = controller::MakeFilter(named.config.filters.at(0), channels, rate_hz);

  constexpr int kSettling = 20'000;
  constexpr int kAnswer = 20'000;
  std::vector<double> input(static_cast<std::size_t>(channels), 0.0);
  std::vector<double> output(input.size());
  for (int k = 0; k < kSettling; ++k) filter->Step(input, output);
  std::vector<double> power(input.size(), 0.0);
  std::vector<std::complex<double>> at_1_hz(input.size());
  for (int k = 0; k < kAnswer; ++k) {
    std::fill(input.begin(), input.end(), k == 0 ? 1.0 : 0.0);
    filter->Step(input, output);
    if (k == 0) facts.gain = output;
    const auto turn = std::polar(1.0, -2.0 * std::numbers::pi * k / rate_hz);
    for (std::size_t c = 0; c < output.size(); ++c) {
      power[c] += output[c] * output[c];
      at_1_hz[c] += output[c] * turn;
    }
  }
  for (std::size_t c = 0; c < output.size(); ++c) {
    facts.noise_share.push_back(std::sqrt(power[c]));
    facts.delay_ms -= 1e3 * std::arg(at_1_hz[c]) / (2.0 * std::numbers::pi) / channels;
  }
  return facts;
}

namespace {

// --- The first test: one channel ----------------------------------------------------------------

/// The recursion as textbooks have it, with its 2 x 2 matrices (section 2.3.2 of the paper, with K
/// from the a-priori covariance).
std::vector<double> TextbookKalman(const std::vector<double>& measured, double r, double q) {
  Eigen::Matrix2d a;
  a << 1.0, 1.0, 0.0, 1.0;
  const Eigen::RowVector2d h(1.0, 0.0);
  Eigen::Vector2d x(measured[0], 0.0);
  Eigen::Matrix2d p = Eigen::Matrix2d::Identity();
  std::vector<double> posterior{measured[0]};
  for (std::size_t k = 1; k < measured.size(); ++k) {
    x = a * x;
    p = a * p * a.transpose() + q * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d gain = p * h.transpose() / (h * p * h.transpose() + r);
    x += gain * (measured[k] - h * x);
    p = (Eigen::Matrix2d::Identity() - gain * h) * p;
    posterior.push_back(x[0]);
  }
  return posterior;
}

}  // namespace

OneChannelTest RunOneChannelTest() {
  OneChannelTest test;
  const double r = controller::PaperMeasurementVariance().front();
  RandomStream random(1, "one channel of the paper", 0);
  for (int k = 0; k < kOneChannelSamples; ++k) {  // a finger that bends to and fro, in counts
    test.truth.push_back(500.0 + 150.0 * std::sin(2.0 * std::numbers::pi * 0.5 * k / kRateHz));
  }
  test.measured = test.truth;
  AddBoxMuller(random, std::sqrt(r), test.measured);

  controller::FilterConfig config;
  controller::KalmanConfig kalman;
  kalman.noise.r = {r};
  config.settings = kalman;
  const auto filter = controller::MakeFilter(config, 1, kRateHz);
  for (const double z : test.measured) {
    double x = 0.0;
    filter->Step({&z, 1}, {&x, 1});
    test.filtered.push_back(x);
  }
  const std::vector<double> textbook = TextbookKalman(test.measured, r, 1.0);
  for (std::size_t k = 0; k < textbook.size(); ++k) {
    test.textbook_difference =
        std::max(test.textbook_difference, std::abs(textbook[k] - test.filtered[k]));
  }
  return test;
}

// --- Noise --------------------------------------------------------------------------------------

namespace {

void TestBoxMuller(GeneratorTest& test) {
  constexpr double kReach = 4.5;
  const double n = static_cast<double>(test.draws);
  test.first_bin = -kReach + 0.5 * test.bin_width;
  test.normal_density.assign(static_cast<std::size_t>(std::lround(2.0 * kReach / test.bin_width)),
                             0.0);
  RandomStream random(1, "figure 7 of the paper", 0);
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (std::int64_t i = 0; i < test.draws / 2; ++i) {
    const NormalPair pair = BoxMuller(random);
    for (const double value : {pair.first, pair.second}) {
      sum += value;
      squares += value * value;
      fourth += value * value * value * value;
      const double bin = std::floor((value + kReach) / test.bin_width);
      if (bin < 0.0 || bin >= static_cast<double>(test.normal_density.size())) continue;
      test.normal_density[static_cast<std::size_t>(bin)] += 1.0 / (n * test.bin_width);
    }
  }
  test.normal_mean = sum / n;
  test.normal_deviation = std::sqrt(squares / n);
  test.normal_kurtosis = fourth / n / (squares / n * squares / n);
}

void TestGaltonBoard(GeneratorTest& test) {
  test.galton_rows = 20;
  RandomStream board(1, "figure 9 of the paper", 0);
  const std::vector<double> law = GaltonProbabilities(test.galton_rows);
  double seen = 0.0, expected = 0.0;
  const std::vector<std::int64_t> balls = GaltonHistogram(board, test.galton_rows, test.draws);
  for (std::size_t bin = 0; bin < balls.size(); ++bin) {
    test.galton_share.push_back(static_cast<double>(balls[bin]) / static_cast<double>(test.draws));
    seen += test.galton_share.back();
    expected += law[bin];
    test.galton_seen_distance = std::max(test.galton_seen_distance, std::abs(seen - expected));
  }
  test.galton_distance = GaltonDistanceFromNormal(test.galton_rows);
}

}  // namespace

GeneratorTest RunGeneratorTest(std::int64_t draws) {
  GeneratorTest test;
  test.draws = draws;
  TestBoxMuller(test);
  TestGaltonBoard(test);
  return test;
}

namespace {

/// R of the scenario's own glove, estimated from a hand that holds still as by `calibrate`.
controller::NoiseEstimate EstimateGloveNoise(const Scenario& scenario, bool quick) {
  GloveConfig glove = scenario.glove;
  glove.motion.settings = HoldConfig{.duration_s = quick ? 5.0 : 60.0};
  const GloveSignal signal = SynthesiseGlove(glove, static_cast<std::uint64_t>(scenario.seed));
  return controller::EstimateNoise(
      {signal.counts.data(), static_cast<std::size_t>(signal.counts.size())},
      static_cast<int>(signal.counts.cols()), {{0, signal.counts.rows()}});
}

/// Filtered angles of all other channels, with one switched off and on again, against those
/// without.
double SwitchingChange(const Study& study, const GloveSignal& glove) {
  const auto& config = study.scenario.controllers[1].config;
  const controller::Timing& timing = study.hand->timing().controller;
  controller::Controller undisturbed(config, study.calibration, study.hand->transmission(), timing);
  controller::Controller switched(config, study.calibration, study.hand->transmission(), timing);
  const auto channels = static_cast<std::size_t>(glove.counts.cols());
  constexpr std::size_t kSwitched = 3;
  double change = 0.0;
  std::vector<double> counts(channels);
  for (Eigen::Index k = 0; k < std::min<Eigen::Index>(3000, glove.counts.rows()); ++k) {
    if (k == 1000) switched.SetChannelActive(kSwitched, false);
    if (k == 2000) switched.SetChannelActive(kSwitched, true);
    for (std::size_t c = 0; c < channels; ++c) {
      counts[c] = glove.counts(k, static_cast<Eigen::Index>(c));
    }
    undisturbed.Step({.counts = counts});
    switched.Step({.counts = counts});
    for (std::size_t c = 0; c < channels; ++c) {
      if (c == kSwitched) continue;
      change = std::max(
          change, std::abs(undisturbed.filtered_angle_rad()[c] - switched.filtered_angle_rad()[c]));
    }
  }
  return change;
}

// --- Claims -------------------------------------------------------------------------------------

std::vector<double> SeedValues(const StudyResult& result, const std::string& controller,
                               std::string_view metric) {
  return SeedValues(result, ControllerIndex(result, controller), MetricIndex(metric));
}

/// Reduction of a score by the filter, in percent, seed by seed.
std::vector<double> Reduction(const StudyResult& result, std::string_view metric) {
  const std::vector<double> raw = SeedValues(result, "raw", metric);
  std::vector<double> percent = SeedValues(result, "paper_kalman", metric);
  for (std::size_t i = 0; i < raw.size(); ++i) percent[i] = 100.0 * (1.0 - percent[i] / raw[i]);
  return percent;
}

/// "jitter_rms_deg 0.235 -> 0.421": the main metrics in which the second controller is worse, or
/// may be, as the mean is by the smallest relevant difference.
std::string CostsOf(const StudyResult& result, const Summary& summary, const std::string& before,
                    const std::string& after) {
  const std::size_t first = ControllerIndex(result, before);
  const std::size_t second = ControllerIndex(result, after);
  const auto& controllers = summary.controllers;
  std::string costs;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    if (!Metrics()[m].main) continue;
    const auto& [difference, relevant_difference, judgement] = summary.Of(m, second, first);
    const double more = Metrics()[m].lower_is_better ? difference.mean : -difference.mean;
    const bool undecided = judgement == Judgement::kUndecided && more >= relevant_difference;
    if (judgement != Judgement::kWorse && !undecided) continue;
    if (!costs.empty()) costs += ", ";
    costs += fmt::format("{} {} -> {}", Metrics()[m].key, Short(controllers[first].summary[m].mean),
                         Short(controllers[second].summary[m].mean));
    if (undecided) costs += " (undecided)";
  }
  return costs;
}

/// Claims and their questions, gathered before all are judged at once.
class Claims {
 public:
  /// That a score is less, or more, with the second controller.
  void AddScores(const StudyResult& result, Claim claim, std::string_view metric,
                 const char* before, const char* after, bool less_is_claimed = true) {
    const Metric& known = Metrics()[MetricIndex(metric)];
    claim.measured = fmt::format("{}: {}, then {}", metric, before, after);
    claim.relevant_reason = known.relevant_difference.reason;
    Add(MotionsOf(result), std::move(claim), SeedValues(result, before, metric),
        SeedValues(result, after, metric), less_is_claimed);
    questions_.back().relevant_difference =
        RelevantDifferenceBetween(known, claims_.back().before, claims_.back().after);
  }

  /// That the filter takes away a larger share of the second score's jitter [%]. Of the unfiltered
  /// jitter of `result` the smallest jitter that is seen is such a share. Where this is more than
  /// half of it, no difference of two shares says that a person sees it.
  void AddReduction(const StudyResult& result, Claim claim, const std::vector<double>& before,
                    const std::vector<double>& after) {
    const std::vector<int> motions = MotionsOf(result);
    const Metric& jitter = Metrics()[MetricIndex("jitter_rms_deg")];
    const double raw_deg = EstimateMean(SeedValues(result, "raw", jitter.key), motions).mean;
    const double visible_deg = jitter.relevant_difference.absolute;
    claim.relevant_reason = fmt::format(
        "the points of the unfiltered {:.2f} deg that make {:g} deg, the smallest visible "
        "jitter",
        raw_deg, visible_deg);
    Add(motions, std::move(claim), before, after, false);
    questions_.back().relevant_difference = 100.0 * visible_deg / raw_deg;
    if (2.0 * visible_deg > raw_deg) not_testable_.push_back(claims_.size() - 1);
  }

  std::vector<Claim> Judged() {
    const std::vector<Comparison> answers = Judge(questions_);
    for (std::size_t i = 0; i < answers.size(); ++i) claims_[i].comparison = answers[i];
    for (const std::size_t i : not_testable_) claims_[i].comparison.judgement = Judgement::kNone;
    return std::move(claims_);
  }

 private:
  void Add(const std::vector<int>& motions, Claim claim, const std::vector<double>& before,
           const std::vector<double>& after, bool less_is_claimed) {
    claim.before = EstimateMean(before, motions).mean;
    claim.after = EstimateMean(after, motions).mean;
    claims_.push_back(std::move(claim));
    questions_.push_back({.difference = EstimateDifference(after, before, motions),
                          .lower_is_better = less_is_claimed});
  }

  std::vector<Claim> claims_;
  std::vector<Question> questions_;
  std::vector<std::size_t> not_testable_;
};

std::vector<Claim> JudgeClaims(const PaperExperiment& experiment) {
  const FinishedStudy& finished = experiment.finished;
  const StudyResult& result = finished.result;
  const std::string filter_costs = CostsOf(result, finished.summary, "raw", "paper_kalman");
  Claims claims;
  for (const auto& [claim, metric] : {
           std::pair{"Much less local jumps", "command_reversals_per_s"},
           std::pair{"Fingers move quieter", "finger_jitter_rms_deg"},
           std::pair{"Motor noise is lower in level", "motor_noise_rms_deg_s"},
           std::pair{"Motor noise is lower in frequency", "motor_noise_centroid_hz"},
       }) {
    claims.AddScores(result, {.row = "P16", .claim = claim, .costs = filter_costs}, metric, "raw",
                     "paper_kalman");
  }
  claims.AddReduction(result,
                      {.row = "P16",
                       .claim = "More so in slow motion",
                       .measured = "jitter that the filter takes away, %: fast motion, then slow"},
                      Reduction(result, "fast_jitter_rms_deg"),
                      Reduction(result, "slow_jitter_rms_deg"));
  claims.AddReduction(result,
                      {.row = "P16",
                       .claim = "Better servos gain more",
                       .measured = "jitter that the filter takes away, %: RC servos with dead band "
                                   "and backlash (rc_digital), then the default servos"},
                      Reduction(experiment.rc_servo_result, "jitter_rms_deg"),
                      Reduction(result, "jitter_rms_deg"));
  claims.AddScores(result, {.row = "P4", .claim = "A mean filter costs real-time behaviour"},
                   "delay_ms", "paper_kalman", "mean_20", false);
  claims.AddScores(
      result,
      {.row = "P18",
       .claim = "Prediction follows better when the master moves quickly (never built)",
       .costs = CostsOf(result, finished.summary, "tuned_kalman", "prediction")},
      "fast_tracking_rmse_deg", "tuned_kalman", "prediction");
  claims.AddScores(experiment.burst_result,
                   {.row = "P18",
                    .claim = "The same in short bursts (fast_bursts)",
                    .costs = CostsOf(experiment.burst_result, experiment.burst_summary,
                                     "tuned_kalman", "prediction")},
                   "tracking_rmse_deg", "tuned_kalman", "prediction");
  claims.AddScores(result, {.row = "P18", .claim = "Prediction answers faster"}, "delay_ms",
                   "tuned_kalman", "prediction");
  claims.AddScores(experiment.burst_result,
                   {.row = "P18", .claim = "Movements begin sooner (fast_bursts)"},
                   "onset_delay_ms", "tuned_kalman", "prediction");
  return claims.Judged();
}

// --- Studies ------------------------------------------------------------------------------------

std::vector<std::string> OverridesOf(const PaperExperimentOptions& options,
                                     std::initializer_list<const char*> more) {
  std::vector<std::string> overrides = options.set;
  overrides.insert(overrides.end(), more.begin(), more.end());
  if (options.quick) overrides.emplace_back("glove.motion.duration_s=6");
  return overrides;
}

/// The experiment with RC servos. No claim needs noise-free reference runs of it, nor of the next.
Study RcServoStudy(const PaperExperimentOptions& options) {
  Scenario scenario = LoadScenario(
      options.scenario,
      OverridesOf(options, {"hand.servo={kind: rc_digital}", "hand.arm_servo={kind: rc_digital}",
                            "score.noise_free_twin=false"}));
  KeepControllers({"raw", "paper_kalman"}, scenario);
  return PrepareStudy(std::move(scenario));
}

/// Short bursts of fast motion, with the controllers of `paper`.
Study BurstStudy(const PaperExperimentOptions& options, const Scenario& paper) {
  std::vector<std::string> overrides = {"score.noise_free_twin=false"};
  for (const std::string& setting : options.set) {
    const bool is_of_other_parts =
        setting.starts_with("glove.motion") || setting.starts_with("controllers");
    if (!is_of_other_parts) overrides.push_back(setting);
  }
  if (options.quick) overrides.emplace_back("glove.motion.bursts=1");
  Scenario bursts = LoadScenario(options.scenario.parent_path() / "fast_bursts.yaml", overrides);
  bursts.controllers = paper.controllers;
  KeepControllers({"tuned_kalman", "prediction"}, bursts);
  bursts.baseline.clear();
  return PrepareStudy(std::move(bursts));
}

/// Fills in the results of the three studies.
void RunStudies(const PaperExperimentOptions& options, PaperExperiment& experiment) {
  FinishedStudy& finished = experiment.finished;
  finished.comparison = true;
  Scenario scenario = LoadScenario(options.scenario, OverridesOf(options, {}));
  for (const char* name : {"raw", "mean_20", "paper_kalman", "tuned_kalman", "prediction"}) {
    if (std::ranges::count(scenario.controllers, name, &NamedController::name) > 0) continue;
    throw UserError({.place = "--set",
                     .key = "controllers",
                     .problem = fmt::format("leaves out {}, which the claims are about", name)});
  }
  finished.study = PrepareStudy(std::move(scenario));
  const Study rc_servo = RcServoStudy(options);
  const Study bursts = BurstStudy(options, finished.study.scenario);
  const std::array<std::pair<const Study*, StudyResult*>, 3> studies = {
      {{&finished.study, &finished.result},
       {&rc_servo, &experiment.rc_servo_result},
       {&bursts, &experiment.burst_result}}};
  const auto trials = [](const Study& study) {
    return static_cast<double>(study.scenario.controllers.size()) * kSeeds;
  };
  double total = 0.0, before = 0.0;
  for (const auto& [study, result] : studies) total += trials(*study);
  for (const auto& [study, result] : studies) {
    const auto progress = [&](double done, int) {
      return !options.progress || options.progress(before + done, total);
    };
    *result = RunStudy(*study, {.seeds = kSeeds,
                                .jobs = options.jobs,
                                .progress = progress,
                                .remark = options.remark,
                                .keep_first_traces = true});
    before += trials(*study);
  }
  finished.summary = Summarise(finished.study, finished.result);
  experiment.burst_summary = Summarise(bursts, experiment.burst_result);
}

}  // namespace

std::string_view AnswerText(Judgement judgement) {
  static constexpr std::string_view kTexts[] = {"not testable here", "confirmed",
                                                "too small to matter", "undecided", "refuted"};
  return kTexts[static_cast<std::size_t>(judgement)];
}

std::size_t ControllerIndex(const StudyResult& result, const std::string& name) {
  const auto& names = result.controller_names;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw UserError(fmt::format("the paper's scenario has no controller named {}", name));
  }
  return static_cast<std::size_t>(found - names.begin());
}

PaperExperiment RunPaperExperiment(const PaperExperimentOptions& options) {
  PaperExperiment experiment;
  experiment.quick = options.quick;
  experiment.set = options.set;
  RunStudies(options, experiment);
  const Study& study = experiment.finished.study;
  for (const NamedController& named : study.scenario.controllers) {
    if (named.name == "prediction") continue;
    experiment.filters.push_back(AnalyseFilter(named, study.hand->timing().controller));
  }
  experiment.claims = JudgeClaims(experiment);
  experiment.one_channel = RunOneChannelTest();
  experiment.generators = RunGeneratorTest(options.quick ? 100'000 : 1'000'000);
  experiment.estimated_noise = EstimateGloveNoise(study.scenario, options.quick);
  experiment.switching_change = SwitchingChange(study, *experiment.finished.result.first_glove);
  return experiment;
}

}  // namespace gauntlet::sim
