// How much of the delay each way to look ahead takes away, how much could be taken, and what a
// wrong model costs. The tables of docs/evidence/measurements.md.
#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "controller/calibration/predictor_fit.h"
#include "controller/prediction/horizon.h"
#include "sim/fit/identified_hand.h"
#include "sim/study/prediction_fit.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study.h"
#include "sim/study/trial_score.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

using controller::ControllerConfig;
using Eigen::Index;

constexpr int kTrainingSeeds = 4;
// Seeds behind those that are measured. Of the 25 recordings of door_opening they are numbers 17 to
// 20, so that up to 16 repetitions can be measured on others.
constexpr int kTrainingFrom = 516;
constexpr int kMostSeeds = 16;
constexpr const char* kStart = "no prediction";
constexpr const char* kOptimum = "fitted to other repetitions, order 40";

struct Row {
  std::string name;
  ControllerConfig controller;
  std::function<GloveSignal(const Study&, int)> glove;
};

GloveSignal AsItIs(const Study& study, int seed) { return *GloveOfSeed(study, seed); }
GloveSignal NoiseFree(const Study& study, int seed) {
  return SynthesiseGlove(WithoutNoise(GloveOf(study.scenario, seed)),
                         static_cast<std::uint64_t>(seed));
}

/// Its first channel stays where it is in the middle of the motion: a broken one as the guard holds
/// it.
GloveSignal WithDeadChannel(const Study& study, int seed) {
  GloveSignal glove = AsItIs(study, seed);
  auto channel = glove.counts.col(0);
  const Index dead = channel.size() / 2;
  channel.tail(channel.size() - dead).setConstant(channel[dead]);
  return glove;
}

/// The same glove, each channel so many samples ahead.
GloveSignal Ahead(GloveSignal glove, const Eigen::ArrayXd& horizon_steps) {
  const Signal counts = glove.counts;
  for (Index c = 0; c < counts.cols(); ++c) {
    const Index steps = std::lround(horizon_steps[c]);
    for (Index k = 0; k < counts.rows(); ++k) {
      glove.counts(k, c) = counts(std::min(k + steps, counts.rows() - 1), c);
    }
  }
  return glove;
}

/// Counts to angles, by the line of the controller.
double RadPerCount(const controller::GloveCalibration& known, Index c) {
  return (known.high_angle_rad[c] - known.low_angle_rad[c]) /
         (known.high_counts[c] - known.low_counts[c]);
}

/// A glove whose counts are, not rounded, what the controller takes for the true angle.
GloveSignal Truth(const Study& study, int seed) {
  GloveSignal glove = NoiseFree(study, seed);
  const controller::GloveCalibration& known = study.calibration;
  for (Index c = 0; c < glove.counts.cols(); ++c) {
    const double counts_per_rad = 1.0 / RadPerCount(known, c);
    for (Index k = 0; k < glove.counts.rows(); ++k) {
      const double angle_rad = glove.true_angle_rad(k * glove.ticks_per_sample, c);
      glove.counts(k, c) =
          known.low_counts[c] + counts_per_rad * (angle_rad - known.low_angle_rad[c]);
    }
  }
  return glove;
}

struct MeanAndHalfWidth {
  double mean = 0.0;
  double half_width = 0.0;  // of the 95 % interval, normal
};

MeanAndHalfWidth Summary(const std::vector<double>& values) {
  const Eigen::Map<const Eigen::ArrayXd> x(values.data(), std::ssize(values));
  const double n = static_cast<double>(x.size());
  const double variance = n > 1 ? (x - x.mean()).square().sum() / (n - 1.0) : 0.0;
  return {x.mean(), 1.96 * std::sqrt(variance / n)};
}

struct Outcome {
  std::vector<double> tracking_deg;
  std::vector<double> delay_ms;
  std::vector<double> jitter_deg;
  std::vector<double> reversals_per_s;
};

Outcome Measure(const Study& study, const Row& row, int seeds) {
  Outcome outcome;
  for (int i = 0; i < seeds; ++i) {
    const int seed = study.scenario.seed + i;
    const GloveSignal glove = row.glove(study, seed);
    const Signal reference = ReferenceAngles(study.joint_map(), glove.true_angle_rad);
    const Trace trace =
        RunTrial(SetupOf(study, {.name = row.name, .config = row.controller}, seed), glove);
    const Scores scores = ScoreTrial(study, row.controller, glove, reference, trace, std::nullopt);
    outcome.tracking_deg.push_back(scores.summary[MetricIndex("tracking_rmse_deg")]);
    outcome.delay_ms.push_back(scores.summary[MetricIndex("delay_ms")]);
    outcome.jitter_deg.push_back(scores.summary[MetricIndex("jitter_rms_deg")]);
    outcome.reversals_per_s.push_back(scores.summary[MetricIndex("command_reversals_per_s")]);
  }
  return outcome;
}

const ControllerConfig& ControllerOf(const Study& study, std::string_view name) {
  for (const NamedController& named : study.scenario.controllers) {
    if (named.name == name) return named.config;
  }
  throw std::invalid_argument(fmt::format("the scenario has no controller {}", name));
}

/// Fitted to what the gloves of other repetitions said.
ControllerConfig Fitted(const Study& study, const std::vector<double>& horizon_ms,
                        bool all_channels) {
  ControllerConfig config = ControllerOf(study, "raw");
  std::vector<Eigen::MatrixXd> recordings;
  for (int i = 0; i < kTrainingSeeds; ++i) {
    const auto glove = GloveOfSeed(study, study.scenario.seed + kTrainingFrom + i);
    for (Eigen::MatrixXd& seen : SeenByPredictor(study, config, *glove)) {
      recordings.push_back(std::move(seen));
    }
  }
  config.prediction.settings =
      controller::FitPredictor(recordings, TimingOf(study.scenario).controller.sample_rate_hz(),
                               {.horizon_ms = horizon_ms,
                                .offset = true,
                                .all_channels = all_channels,
                                .fallback = false})
          .predictor;
  return config;
}

/// What `gauntlet identify out/probe_chain --from target` finds of the default hand.
IdentifiedChain ChainFromTarget() {
  const Study probe = PrepareStudy(LoadScenario("scenarios/probe_chain.yaml", {}));
  const GloveSignal glove = AsItIs(probe, probe.scenario.seed);
  const Trace trace =
      RunTrial(SetupOf(probe, probe.scenario.controllers.front(), probe.scenario.seed), glove);
  const ChainLog log = {.name = "probe_chain",
                        .episode = {},
                        .parts = probe.hand->joint_names(),
                        .rate_hz = probe.hand->timing().tick_rate_hz(),
                        .command_deg = trace.target_angle_rad * kDegPerRad,
                        .angle_deg = trace.hand_angle_rad * kDegPerRad,
                        .motor_deg = {},
                        .columns_ignored = {},
                        .unit_note = {}};
  return MakeIdentifiedChain(log, FitChains(log));
}

/// Commands that are planned for the chain, as docs/evidence/controller.md has them.
ControllerConfig Planned(ControllerConfig ours, const IdentifiedChain& chain, double change_weight,
                         double friction_share) {
  auto& adaptive = std::get<controller::AdaptivePredictionConfig>(ours.prediction.settings);
  adaptive.horizon_ms = {0.0};  // beyond the dead time, which the plan adds
  ours.model_predictive = {.kind = controller::ModelPredictiveKind::kSecondOrder,
                           .dead_time_ms = chain.dead_time_ms,
                           .lag_ms = chain.lag_ms,
                           .natural_frequency_hz = chain.natural_frequency_hz,
                           .change_weight = change_weight};
  if (friction_share == 0.0) return ours;
  ours.joint_loop = {.kind = controller::JointLoopKind::kPi,
                     .proportional = 0.0,
                     .integral_per_s = 0.0,
                     .friction_deg = chain.friction_deg};
  for (double& value : ours.joint_loop.friction_deg) value *= friction_share;
  return ours;
}

/// A little calmer, within what the default servo can do, by a prediction that trusts the glove
/// more and remembers longer.
ControllerConfig PlannedForCalm(const ControllerConfig& ours, const IdentifiedChain& chain) {
  ControllerConfig config = Planned(ours, chain, 1.7, 0.5);
  config.model_predictive.speed_limit_deg_s = 400.0;
  config.model_predictive.lead_limit_deg = 16.6;
  auto& adaptive = std::get<controller::AdaptivePredictionConfig>(config.prediction.settings);
  adaptive.r_deg2 = {0.6};
  adaptive.memory_ms = 2000.0;
  return config;
}

std::vector<Row> RowsOf(const Study& study, const IdentifiedChain& chain) {
  const ControllerConfig raw = ControllerOf(study, "raw");
  const ControllerConfig ours = ControllerOf(study, "prediction");
  const auto& adaptive = std::get<controller::AdaptivePredictionConfig>(ours.prediction.settings);
  const int channels = static_cast<int>(study.channel_names().size());
  const Eigen::ArrayXd steps = controller::HorizonSteps(
      adaptive.horizon_ms, channels, TimingOf(study.scenario).controller.sample_rate_hz());
  ControllerConfig before = ControllerOf(study, "tuned_kalman");
  before.prediction.settings = controller::KalmanPredictionConfig{};
  const auto with = [&](auto settings) {
    ControllerConfig config = raw;
    config.prediction.settings = settings;
    return config;
  };
  const auto fitted = [&](bool all_channels) {
    return Fitted(study, adaptive.horizon_ms, all_channels);
  };
  const auto wrong = [&](double horizon, double noise) {
    controller::AdaptivePredictionConfig settings = adaptive;
    for (double& value : settings.horizon_ms) value *= horizon;
    for (double& value : settings.r_deg2) value *= noise;
    return with(settings);
  };
  return {
      {kStart, raw, AsItIs},
      {"tuned_kalman", ControllerOf(study, "tuned_kalman"), AsItIs},
      {"tuned_kalman, then kalman 45 ms", before, AsItIs},
      {"prediction of the scenario", ours, AsItIs},
      {"kalman, 2 states, q 1e5",
       with(controller::KalmanPredictionConfig{
           .horizon_ms = adaptive.horizon_ms, .q_deg2_per_s3 = 1e5, .r_deg2 = adaptive.r_deg2}),
       AsItIs},
      {kOptimum, fitted(false), AsItIs},
      {"fitted to all channels", fitted(true), AsItIs},
      {"fitted, a channel dead", fitted(false), WithDeadChannel},
      {"fitted to all channels, a channel dead", fitted(true), WithDeadChannel},
      {"glove without noise, known ahead", raw,
       [steps](const Study& of, int seed) { return Ahead(NoiseFree(of, seed), steps); }},
      {"truth, known ahead", raw,
       [steps](const Study& of, int seed) { return Ahead(Truth(of, seed), steps); }},
      {"ours, delay 30 % less", wrong(0.7, 1.0), AsItIs},
      {"ours, delay 30 % more", wrong(1.3, 1.0), AsItIs},
      {"ours, noise 30 % less", wrong(1.0, 0.7), AsItIs},
      {"ours, noise 30 % more", wrong(1.0, 1.3), AsItIs},
      {"planned, plain", Planned(ours, chain, 1.0, 0.0), AsItIs},
      {"planned, friction", Planned(ours, chain, 1.0, 0.5), AsItIs},
      {"planned, friction, change_weight 2", Planned(ours, chain, 2.0, 0.5), AsItIs},
      {"planned, friction, for calm", PlannedForCalm(ours, chain), AsItIs},
  };
}

/// Of the rows whose name has this part, and those between which ways are measured.
void MeasureScenario(const std::string& file, int seeds, const IdentifiedChain& chain,
                     const std::string& part) {
  const Study study = PrepareStudy(LoadScenario(file, {}));
  fmt::print("\n{}, {} repetitions\n\n", study.scenario.name, seeds);
  fmt::print("| | tracking [deg] | delay [ms] | jitter [deg] | reversals [1/s] | way [%] |\n");
  fmt::print("|---|---|---|---|---|---|\n");
  struct Line {
    std::string name;
    Outcome outcome;
  };
  std::vector<Line> lines;
  double none = 0.0;
  double fitted = 0.0;
  for (const Row& row : RowsOf(study, chain)) {
    const bool is_end = row.name == kStart || row.name == kOptimum;
    if (!is_end && row.name.find(part) == std::string::npos) continue;
    lines.push_back({row.name, Measure(study, row, seeds)});
    const double tracking = Summary(lines.back().outcome.tracking_deg).mean;
    if (row.name == kStart) none = tracking;
    if (row.name == kOptimum) fitted = tracking;
  }
  for (const auto& [name, outcome] : lines) {
    const auto [tracking, half] = Summary(outcome.tracking_deg);
    fmt::print("| {} | {:.2f} ± {:.2f} | {:.0f} | {:.3f} | {:.1f} | {:.0f} |\n", name, tracking,
               half, Summary(outcome.delay_ms).mean, Summary(outcome.jitter_deg).mean,
               Summary(outcome.reversals_per_s).mean, 100.0 * (none - tracking) / (none - fitted));
  }
  std::fflush(stdout);
}

}  // namespace
}  // namespace gauntlet::sim

int main(int count, char** arguments) {
  const int seeds = count > 1 ? std::stoi(arguments[1]) : 4;
  if (seeds < 1 || seeds > gauntlet::sim::kMostSeeds) {
    fmt::print(stderr, "repetitions: is {}, must be from 1 to {}\n", seeds,
               gauntlet::sim::kMostSeeds);
    return 2;
  }
  const gauntlet::sim::IdentifiedChain chain = gauntlet::sim::ChainFromTarget();
  for (const char* name : {"random_motion", "fast_bursts", "door_opening"}) {
    if (count > 2 && std::string(name).find(arguments[2]) == std::string::npos) continue;
    gauntlet::sim::MeasureScenario(std::string("scenarios/") + name + ".yaml", seeds, chain,
                                   count > 3 ? arguments[3] : "");
  }
}
