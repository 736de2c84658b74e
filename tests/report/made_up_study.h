#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/show/pages/page_data.h"

namespace gauntlet::test {

/// A study that nobody ran, with curves and scores of the right shapes: channels that swing, a raw
/// glove that trembles, hands that lag. Commands are left out, as they need a hand.
struct MadeUpStudy : sim::FinishedStudy {
  std::vector<sim::WayOfAngles> ways;
  std::vector<sim::Signal> hand_rad;
  std::vector<std::optional<sim::LatencyBudget>> latency;
  std::optional<sim::CountedParts> counted;

  sim::FirstSeed first_seed() const {
    sim::FirstSeed first(result.first_glove->true_angle_rad, ways.size());
    for (std::size_t i = 0; i < ways.size(); ++i) first.Add(ways[i], hand_rad[i]);
    first.latency = latency;
    first.counted = counted;
    return first;
  }
};

struct MadeUpShape {
  int samples = 1500;
  int channels = 3;
  int controllers = 3;  // the first is the raw one
  int seeds = 5;
};

inline sim::Signal Swing(const MadeUpShape& shape, double lag_s, double tremble_rad) {
  sim::Signal angle(shape.samples, shape.channels);
  for (int c = 0; c < shape.channels; ++c) {
    for (int k = 0; k < shape.samples; ++k) {
      const double t = k / 1000.0 - lag_s;
      // As rough as noise and the same everywhere: Knuth's multiplicative hash, in -1 .. 1.
      const std::uint32_t hash = static_cast<std::uint32_t>(1000 * k + c + 1) * 2654435761U;
      const double rough = static_cast<double>(hash >> 8) / (1 << 23) - 1.0;
      angle(k, c) = 0.6 + 0.5 * std::sin(2.1 * t + 0.7 * c) + tremble_rad * rough;
    }
  }
  return angle;
}

inline void MakeUpScores(const MadeUpShape& shape, sim::StudyResult& result) {
  for (int s = 0; s < shape.seeds; ++s) {
    sim::SeedOutcome seed{.seed = 1 + s, .controllers = {}};
    for (int i = 0; i < shape.controllers; ++i) {
      sim::TrialOutcome trial;
      for (std::size_t m = 0; m < sim::Metrics().size(); ++m) {
        const double base = 1.0 + static_cast<double>(m) + 0.4 * std::cos(2.0 * i + 1.3 * m);
        trial.scores.summary.push_back(base + 0.05 * std::sin(1.7 * s + i));
      }
      trial.scores.channels.assign(shape.channels, trial.scores.summary);
      trial.untrusted_samples.assign(shape.channels, 0);
      seed.controllers.push_back(trial);
    }
    result.seeds.push_back(seed);
  }
}

inline MadeUpStudy MakeUpStudy(const MadeUpShape& shape) {
  MadeUpStudy made;
  made.study.scenario.name = "made_up";
  made.study.scenario.question = "Is the page whole?";
  sim::StudyResult& result = made.result;
  result.reference_name = "ground truth";
  for (int c = 0; c < shape.channels; ++c) {
    result.row_names.push_back("channel_" + std::to_string(c));
  }
  made.comparison = true;
  made.study.measured_joint_names = result.row_names;
  made.study.joint_count = shape.channels;
  made.study.rows = sim::ScoreRows(result.row_names, result.row_names, {});
  made.study.scenario.video.channel = result.row_names.back();
  sim::GloveSignal glove;
  glove.true_angle_rad = Swing(shape, 0.0, 0.0);
  glove.counts = glove.true_angle_rad;
  result.shortest_s = result.longest_s = shape.samples / 1000.0;
  result.first_glove = std::make_shared<const sim::GloveSignal>(std::move(glove));
  for (int i = 0; i < shape.controllers; ++i) {
    sim::NamedController named{.name = i == 0 ? "raw" : "filter_" + std::to_string(i),
                               .config = {}};
    if (i > 0) {
      controller::FilterConfig filter;
      filter.settings = controller::MovingAverageConfig{};
      named.config.filters = {filter};
    }
    made.study.scenario.controllers.push_back(named);
    result.controller_names.push_back(named.name);
    const sim::Signal filtered = Swing(shape, 0.01 * i, 0.02 / (1 + i));
    made.ways.push_back({.raw = Swing(shape, 0.0, 0.02),
                         .filtered = filtered,
                         .target = filtered,
                         .command = filtered});
    made.hand_rad.push_back(Swing(shape, 0.06 + 0.01 * i, 0.004 / (1 + i)));
    made.latency.push_back(sim::LatencyBudget{
        .stages = {{.key = "filter_ms", .help = "filter", .mean_ms = 3.0 + i, .channel_ms = {}},
                   {.key = "rest_ms", .help = "rest", .mean_ms = 60.0, .channel_ms = {}}},
        .sum_ms = 63.0 + i,
        .total_ms = 64.0 + i});
  }
  MakeUpScores(shape, result);
  result.causes = {.switched = true, .chain = true, .seeds = shape.seeds};
  made.summary = sim::Summarise(made.study, result);
  return made;
}

}  // namespace gauntlet::test
