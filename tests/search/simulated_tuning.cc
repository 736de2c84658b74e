#include "tests/search/simulated_tuning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <numbers>
#include <string>
#include <vector>

#include "sim/answers/tune/tune.h"
#include "sim/base/error.h"
#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/base/threads.h"
#include "sim/settings/yaml_tree.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

constexpr double kGloveRate_hz = 60.0;
constexpr double kNoise_deg = 2.0;
constexpr const char* kWindow = "controllers.mean.filter.window";

class Wearer {
 public:
  Wearer(const TuningShape& shape, const std::string& stream)
      : motion_(shape.motion), random_(shape.seed, stream) {}

  /// Writes the readings of a glove with white noise.
  void Record(double duration_s, const fs::path& file) {
    const auto samples = static_cast<std::size_t>(duration_s * kGloveRate_hz);
    const std::vector<double> angles_deg =
        motion_ == SimulatedMotion::kContinuous ? Continuous(samples) : Movements(samples);
    std::ofstream csv(file);
    csv << "time_s,index_mcp\n";
    for (std::size_t n = 0; n < samples; ++n) {
      const double read_deg = std::clamp(angles_deg[n] + kNoise_deg * Normal(), 0.0, 90.0);
      csv << fmt::format("{:.4f},{:.4f}\n", static_cast<double>(n) / kGloveRate_hz, read_deg);
    }
  }

 private:
  double Normal() { return BoxMuller(random_).first; }

  std::vector<double> Continuous(std::size_t samples) {
    const double decay = std::exp(-2.0 * std::numbers::pi / kGloveRate_hz);
    double first = 0.0, second = 0.0;
    std::vector<double> angles;
    for (std::size_t n = 0; n < samples + 300; ++n) {  // five seconds until it is stationary
      first = decay * first + std::sqrt(1.0 - decay * decay) * Normal();
      second = decay * second + (1.0 - decay) * first;
      if (n >= 300) angles.push_back(45.0 + 15.0 * second);
    }
    return angles;
  }

  std::vector<double> Movements(std::size_t samples) {
    std::vector<double> angles;
    double from_deg = 45.0;
    while (angles.size() < samples) {
      const double to_deg = random_.Uniform(20.0, 70.0);
      const auto steps = static_cast<int>(random_.Uniform(0.4, 1.2) * kGloveRate_hz);
      for (int n = 0; n < steps; ++n) {
        const double s = static_cast<double>(n) / steps;
        angles.push_back(from_deg +
                         (to_deg - from_deg) * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s));
      }
      const auto rest = static_cast<int>(-std::log(random_.UniformAboveZero()) * kGloveRate_hz);
      angles.insert(angles.end(), static_cast<std::size_t>(rest), to_deg);
      from_deg = to_deg;
    }
    angles.resize(samples);
    return angles;
  }

  SimulatedMotion motion_;
  RandomStream random_;
};

ScenarioSource SourceOf(const std::string& files, const fs::path& folder) {
  const fs::path file = folder / "s.yaml";
  std::ofstream(file) << "question: How long a window?\n"
                         "glove:\n"
                         "  rate_hz: 60\n"
                         "  channels: [index_mcp]\n"
                         "  motion: {kind: recording, use: measured, "
                      << files
                      << "}\n"
                         "controllers:\n"
                         "  mean: {filter: {kind: moving_average, window: 9}}\n";
  return {.file = file, .text = ReadYamlText(file)};
}

/// Mean tracking error in recordings that no search saw, per window.
class FreshErrors {
 public:
  FreshErrors(ScenarioSource source, int recordings)
      : source_(std::move(source)), recordings_(recordings) {}

  double Of(const std::string& window) {
    const std::lock_guard lock(mutex_);
    const auto [at, is_new] = errors_deg_.insert({window, 0.0});
    if (is_new) {
      ScenarioSource source = source_;
      source.overrides.push_back(kWindow + ("=" + window));
      const std::size_t tracking = MetricIndex("tracking_rmse_deg");
      const StudyResult result =
          RunStudy(PrepareStudy(ParseScenario(source)), {.seeds = recordings_,
                                                         .keep_first_traces = false,
                                                         .physics = false,
                                                         .scores = {tracking}});
      for (const SeedOutcome& seed : result.seeds) {
        at->second += seed.controllers.front().scores.summary[tracking] / recordings_;
      }
    }
    return at->second;
  }

 private:
  ScenarioSource source_;
  int recordings_;
  std::mutex mutex_;
  std::map<std::string, double> errors_deg_;
};

TunePlan PlanIn(const fs::path& folder) {
  TunePlan plan;
  plan.scenario = SourceOf("files: \"r*.csv\"", folder);
  plan.controller = "mean";
  plan.free = {ParseFree("filter.window=1:6:whole", "mean")};
  plan.minimise = MetricIndex("tracking_rmse_deg");
  plan.evaluations = 5;
  plan.physics = false;
  return plan;
}

}  // namespace

TuningOutcome SimulateTuning(const TuningShape& shape) {
  const test::TemporaryDirectory folder;
  const fs::path fresh_folder = folder.path() / "fresh";
  fs::create_directory(fresh_folder);
  // The score of several recordings is the mean of theirs, so fresh ones are as long as the parts.
  const double part_s = shape.files < 8 ? 0.5 * shape.duration_s : shape.duration_s;
  const int count = shape.files == 1 ? 1 : static_cast<int>(shape.fresh_s / part_s);
  Wearer fresh_wearer(shape, "fresh");
  for (int i = 0; i < count; ++i) {
    fresh_wearer.Record(shape.files == 1 ? shape.fresh_s : part_s,
                        fresh_folder / fmt::format("r{:03}.csv", i));
  }
  FreshErrors fresh(SourceOf("files: \"r*.csv\"", fresh_folder), count);
  TuningOutcome outcome;
  std::mutex mutex;
  ForEachOnThreads(static_cast<std::size_t>(shape.jobs), static_cast<std::size_t>(shape.scenarios),
                   [&](std::size_t i) {
                     const fs::path own_folder = folder.path() / std::to_string(i);
                     fs::create_directory(own_folder);
                     Wearer wearer(shape, std::to_string(i));
                     for (int file = 0; file < shape.files; ++file) {
                       wearer.Record(shape.duration_s, own_folder / fmt::format("r{}.csv", file));
                     }
                     TuneResult result;
                     try {
                       result = Tune(PlanIn(own_folder), 1, [](double, double) { return true; });
                     } catch (const RunError&) {  // too short
                       return;
                     }
                     const TunedSetting& fitted = result.tried[result.chosen];
                     const double fresh_deg = fresh.Of(fitted.values.front()) - fresh.Of("9");
                     const MeanInterval& printed = result.gain.difference;
                     const std::lock_guard lock(mutex);
                     ++outcome.answered;
                     outcome.covered += printed.low <= fresh_deg && fresh_deg <= printed.high;
                     outcome.equal_parts +=
                         fitted.scores.front().mean == result.verdict.scores.front().mean;
                     outcome.printed_deg += printed.mean;
                     outcome.fresh_deg += fresh_deg;
                     fs::remove_all(own_folder);
                   });
  outcome.printed_deg /= outcome.answered;
  outcome.fresh_deg /= outcome.answered;
  return outcome;
}

}  // namespace gauntlet::sim
