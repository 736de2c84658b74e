#include "sim/paper/paper_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "controller/calibration/noise_estimate.h"
#include "controller/filters/paper_noise.h"
#include "sim/base/error.h"
#include "sim/glove/noise/box_muller.h"
#include "sim/glove/noise/galton_board.h"
#include "sim/results/table_text.h"
#include "sim/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

constexpr double kRateHz = 1000.0;        // of the first test; the scenario has its own
constexpr int kOneChannelSamples = 6000;  // the paper's
constexpr int kSeeds = 4;

// --- Filters, by their answer to a pulse --------------------------------------------------------

}  // namespace

FilterFacts AnalyseFilter(const NamedController& named, const controller::Timing& timing) {
  FilterFacts facts;
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

GeneratorTest RunGeneratorTest(std::int64_t draws) {
  GeneratorTest test;
  test.draws = draws;
  constexpr double kReach = 4.5;
  test.first_bin = -kReach + 0.5 * test.bin_width;
  test.normal_density.assign(static_cast<std::size_t>(std::lround(2.0 * kReach / test.bin_width)),
                             0.0);
  RandomStream random(1, "figure 7 of the paper", 0);
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  const auto take = [&](double value) {
    sum += value;
    squares += value * value;
    fourth += value * value * value * value;
    const double bin = std::floor((value + kReach) / test.bin_width);
    if (bin < 0.0 || bin >= static_cast<double>(test.normal_density.size())) return;
    test.normal_density[static_cast<std::size_t>(bin)] +=
        1.0 / (static_cast<double>(draws) * test.bin_width);
  };
  for (std::int64_t i = 0; i < draws / 2; ++i) {
    const NormalPair pair = BoxMuller(random);
    take(pair.first);
    take(pair.second);
  }
  const double n = static_cast<double>(draws);
  test.normal_mean = sum / n;
  test.normal_deviation = std::sqrt(squares / n);
  test.normal_kurtosis = fourth / n / (squares / n * squares / n);

  test.galton_rows = 20;
  RandomStream board(1, "figure 9 of the paper", 0);
  const std::vector<double> law = GaltonProbabilities(test.galton_rows);
  double seen = 0.0, expected = 0.0;
  const std::vector<std::int64_t> balls = GaltonHistogram(board, test.galton_rows, draws);
  for (std::size_t bin = 0; bin < balls.size(); ++bin) {
    test.galton_share.push_back(static_cast<double>(balls[bin]) / n);
    seen += test.galton_share.back();
    expected += law[bin];
    test.galton_seen_distance = std::max(test.galton_seen_distance, std::abs(seen - expected));
  }
  test.galton_distance = GaltonDistanceFromNormal(test.galton_rows);
  return test;
}

namespace {

/// R of the scenario's own glove, as `gauntlet calibrate` finds it from a hand that holds still.
void EstimateVariance(const Scenario& scenario, bool quick, PaperExperiment& experiment) {
  GloveConfig glove = scenario.glove;
  glove.motion.settings = HoldConfig{.duration_s = quick ? 5.0 : 60.0};
  const GloveSignal signal = SynthesiseGlove(glove, static_cast<std::uint64_t>(scenario.seed));
  const auto estimate = controller::EstimateNoise(signal.counts, {{0, signal.counts.rows()}});
  for (Eigen::Index c = 0; c < estimate.variance.size(); ++c) {
    experiment.estimated_variance.push_back(estimate.variance[c]);
    experiment.estimated_variance_low.push_back(estimate.variance_low[c]);
    experiment.estimated_variance_high.push_back(estimate.variance_high[c]);
  }
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
  const std::size_t index = ControllerIndex(result, controller);
  std::vector<double> values;
  for (const SeedOutcome& seed : result.seeds) {
    values.push_back(seed.controllers[index].scores.summary[MetricIndex(metric)]);
  }
  return values;
}

/// What the filter takes away of a score, in percent, seed by seed.
std::vector<double> Reduction(const StudyResult& result, std::string_view metric) {
  const std::vector<double> raw = SeedValues(result, "raw", metric);
  std::vector<double> percent = SeedValues(result, "paper_kalman", metric);
  for (std::size_t i = 0; i < raw.size(); ++i) percent[i] = 100.0 * (1.0 - percent[i] / raw[i]);
  return percent;
}

/// "jitter_rms_deg 0.235 -> 0.421": the main metrics in which the second controller is worse, or
/// may be, as the mean is by what matters.
std::string CostsOf(const FinishedStudy& finished, const std::string& before,
                    const std::string& after) {
  const std::size_t first = ControllerIndex(finished.result, before);
  const std::size_t second = ControllerIndex(finished.result, after);
  const auto& controllers = finished.summary.controllers;
  std::string costs;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    if (!Metrics()[m].main) continue;
    const auto& [difference, relevant_difference, judgement] =
        finished.summary.Of(m, second, first);
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
  explicit Claims(const PaperExperiment& experiment) : experiment_(experiment) {}

  /// That a metric is less, or more, with `after` than with `before`.
  Claim& Add(const char* row, const char* claim, std::string_view metric, const char* before,
             const char* after, bool less_is_claimed) {
    const FinishedStudy& finished = experiment_.finished;
    Claim& added = AddScores(finished.result, row, claim, metric, before, after, less_is_claimed);
    if (less_is_claimed) added.costs = CostsOf(finished, before, after);
    return added;
  }

  Claim& AddScores(const StudyResult& result, const char* row, const char* claim,
                   std::string_view metric, const char* before, const char* after,
                   bool less_is_claimed) {
    const std::vector<double> first = SeedValues(result, before, metric);
    const std::vector<double> second = SeedValues(result, after, metric);
    const std::vector<int> motions = MotionsOf(result);
    const Metric& known = Metrics()[MetricIndex(metric)];
    return AddValues(
        row, claim, fmt::format("{}: {}, then {}", metric, before, after), first, second, motions,
        {.difference = EstimateDifference(second, first, motions),
         .relevant_difference = RelevantDifferenceBetween(known, EstimateMean(first, motions).mean,
                                                          EstimateMean(second, motions).mean),
         .lower_is_better = less_is_claimed},
        known.relevant_difference.reason);
  }

  /// That the filter takes away a larger share of the second score's jitter.
  Claim& AddReduction(const char* claim, const char* measured, const std::vector<double>& before,
                      const std::vector<double>& after) {
    const StudyResult& result = experiment_.finished.result;
    const std::vector<int> motions = MotionsOf(result);
    const Metric& jitter = Metrics()[MetricIndex("jitter_rms_deg")];
    const double raw_deg = EstimateMean(SeedValues(result, "raw", jitter.key), motions).mean;
    const double visible_deg = jitter.relevant_difference.absolute;
    return AddValues("P16", claim, measured, before, after, motions,
                     {.difference = EstimateDifference(after, before, motions),
                      .relevant_difference = 100.0 * visible_deg / raw_deg,
                      .lower_is_better = false},
                     fmt::format("the points of the unfiltered {:.2f} deg that make {:g} deg, the "
                                 "smallest trembling that is seen",
                                 raw_deg, visible_deg));
  }

  std::vector<Claim> Judged() {
    const std::vector<Comparison> answers = Judge(questions_);
    for (std::size_t i = 0; i < answers.size(); ++i) claims_[i].comparison = answers[i];
    return std::move(claims_);
  }

 private:
  Claim& AddValues(const char* row, const char* claim, std::string measured,
                   const std::vector<double>& before, const std::vector<double>& after,
                   const std::vector<int>& motions, Question question, std::string_view reason) {
    questions_.push_back(question);
    Claim& added = claims_.emplace_back();
    added.row = row;
    added.claim = claim;
    added.measured = std::move(measured);
    added.before = EstimateMean(before, motions).mean;
    added.after = EstimateMean(after, motions).mean;
    added.relevant_reason = reason;
    return added;
  }

  const PaperExperiment& experiment_;
  std::vector<Claim> claims_;
  std::vector<Question> questions_;
};

std::vector<Claim> JudgeClaims(const PaperExperiment& experiment) {
  const StudyResult& result = experiment.finished.result;
  Claims claims(experiment);
  const auto filter_lowers = [&](const char* claim, const char* metric) {
    claims.Add("P16", claim, metric, "raw", "paper_kalman", true);
  };
  filter_lowers("Much less local jumps", "command_reversals_per_s");
  filter_lowers("Fingers move quieter", "jitter_rms_deg");
  filter_lowers("Motor noise is lower in level", "motor_noise_rms_deg_s");
  filter_lowers("Motor noise is lower in frequency", "motor_noise_centroid_hz");
  claims.AddReduction(
      "More so in slow motion", "jitter that the filter takes away, %: fast motion, then slow",
      Reduction(result, "fast_jitter_rms_deg"), Reduction(result, "slow_jitter_rms_deg"));
  claims.AddReduction("Better servos gain more",
                      "jitter that the filter takes away, %: RC servos with dead band and play "
                      "(rc_digital), then the default servos (dynamixel)",
                      Reduction(experiment.rc_servo_result, "jitter_rms_deg"),
                      Reduction(result, "jitter_rms_deg"));
  claims.Add("P4", "A mean filter costs real-time behaviour", "delay_ms", "paper_kalman", "mean_20",
             false);
  claims.Add("P18", "Prediction follows better when the master moves quickly (never built)",
             "fast_tracking_rmse_deg", "tuned_kalman", "prediction", true);
  claims.AddScores(experiment.burst_result, "P18", "The same in short bursts (fast_bursts)",
                   "tracking_rmse_deg", "tuned_kalman", "prediction", true);
  return claims.Judged();
}

}  // namespace

std::string_view AnswerText(Judgement judgement) {
  switch (judgement) {
    case Judgement::kNone:
      return "not measured";
    case Judgement::kBetter:
      return "confirmed";
    case Judgement::kEqual:
      return "too small to matter";
    case Judgement::kUndecided:
      return "undecided";
    case Judgement::kWorse:
      return "refuted";
  }
  return "";
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
  experiment.finished.comparison = true;
  std::vector<std::string> overrides;
  if (options.quick) overrides.push_back("glove.motion.duration_s=6");
  experiment.finished.study = PrepareStudy(LoadScenario(options.scenario, overrides));
  // No claim needs twins here.
  overrides.insert(overrides.end(),
                   {"hand.servo={kind: rc_digital}", "score.noise_free_twin=false"});
  Scenario rc_servo = LoadScenario(options.scenario, overrides);
  std::erase_if(rc_servo.controllers, [](const NamedController& named) {
    return named.name != "raw" && named.name != "paper_kalman";
  });
  const Study rc_servo_study = PrepareStudy(std::move(rc_servo));
  std::vector<std::string> of_bursts = {"score.noise_free_twin=false"};
  if (options.quick) of_bursts.emplace_back("glove.motion.bursts=1");
  Scenario bursts = LoadScenario(options.scenario.parent_path() / "fast_bursts.yaml", of_bursts);
  bursts.controllers = experiment.finished.study.scenario.controllers;
  std::erase_if(bursts.controllers, [](const NamedController& named) {
    return named.name != "tuned_kalman" && named.name != "prediction";
  });
  bursts.baseline.clear();
  const Study burst_study = PrepareStudy(std::move(bursts));

  const auto trials = [](const Study& study) {
    return static_cast<double>(study.scenario.controllers.size()) * kSeeds;
  };
  const double total =
      trials(experiment.finished.study) + trials(rc_servo_study) + trials(burst_study);
  const auto run = [&](const Study& study, double before) {
    return RunStudy(study, {.seeds = kSeeds,
                            .jobs = options.jobs,
                            .progress =
                                [&options, before, total](double done, int) {
                                  return !options.progress ||
                                         options.progress(before + done, total);
                                },
                            .remark = options.remark,
                            .keep_first_traces = true});
  };
  experiment.finished.result = run(experiment.finished.study, 0.0);
  experiment.rc_servo_result = run(rc_servo_study, trials(experiment.finished.study));
  experiment.burst_result = run(burst_study, total - trials(burst_study));
  experiment.finished.summary = Summarise(experiment.finished.study, experiment.finished.result);

  const controller::Timing& timing = experiment.finished.study.hand->timing().controller;
  for (const NamedController& named : experiment.finished.study.scenario.controllers) {
    if (named.name != "prediction") experiment.filters.push_back(AnalyseFilter(named, timing));
  }
  experiment.claims = JudgeClaims(experiment);
  experiment.one_channel = RunOneChannelTest();
  experiment.generators = RunGeneratorTest(options.quick ? 100'000 : 1'000'000);
  EstimateVariance(experiment.finished.study.scenario, options.quick, experiment);
  experiment.switching_change =
      SwitchingChange(experiment.finished.study, *experiment.finished.result.first_glove);
  return experiment;
}

}  // namespace gauntlet::sim
