// How often the intervals of a calibration hold the truth, on gloves as they are: coarse
// converters, spikes, noise that is not white, values at the end of the scale. The table of
// docs/evidence/measurements.md.
#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "controller/calibration/curve_fit.h"
#include "controller/calibration/noise_estimate.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;

constexpr double kFullScale = 1023.0;
constexpr int kRepeats = 200;
constexpr int kPoses = 6;

struct Case {
  std::string name;
  double deviation_counts = 3.0;
  double correlation = 0.0;  // of neighbouring samples, first-order
  double white_share = 0.0;  // of the variance: white noise on top of it
  double spike_share = 0.0;  // of 124 counts
  double clipped_share = 0.0;
  double rate_hz = 1000.0;
  double hold_s = 1.5;
  int channels = 3;

  Index HoldSamples() const { return std::lround(hold_s * rate_hz); }
  Index MoveSamples() const { return std::lround(0.3 * rate_hz); }
};

/// A wearer who takes poses and holds each; what the glove says is rounded.
struct Recording {
  Eigen::MatrixXd counts;
  Eigen::MatrixXd settled_deg;  // NaN while moving
  Eigen::MatrixXd pose_counts;  // the true level of each pose
};

class Glove {
 public:
  Glove(const Case& glove, std::uint64_t seed) : case_(glove), random_(seed) {}

  Recording Record() {
    const Index rows = kPoses * (case_.HoldSamples() + case_.MoveSamples());
    Recording recording{Eigen::MatrixXd(rows, case_.channels),
                        Eigen::MatrixXd(rows, case_.channels),
                        Eigen::MatrixXd(kPoses, case_.channels)};
    for (int c = 0; c < case_.channels; ++c) RecordChannel(c, recording);
    return recording;
  }

 private:
  double Normal() {
    return std::sqrt(-2.0 * std::log(1.0 - random_.Uniform())) *
           std::cos(2.0 * std::numbers::pi * random_.Uniform());
  }
  /// First-order noise and white noise, of variance 1 together.
  double Noise() {
    const double c = case_.correlation;
    const double white = case_.white_share;
    state_ = c * state_ + std::sqrt(1.0 - c * c) * Normal();
    if (white == 0.0) return state_;
    return std::sqrt(1.0 - white) * state_ + std::sqrt(white) * Normal();
  }
  double Seen(double level) {
    const double counts = std::round(level + case_.deviation_counts * Noise());
    const double fate = random_.Uniform();
    if (fate < case_.spike_share) return counts + (random_.Uniform() < 0.5 ? -124.0 : 124.0);
    if (fate < case_.spike_share + case_.clipped_share) return kFullScale;
    return counts;
  }
  void RecordChannel(int channel, Recording& recording) {
    for (int k = 0; k < 500; ++k) Noise();  // forgets where it began
    Index row = 0;
    double before = 0.0;
    for (int pose = 0; pose < kPoses; ++pose) {
      const double level = 200.0 + 100.0 * pose + random_.Uniform() * 10.0;
      recording.pose_counts(pose, channel) = level;
      if (pose == 0) before = level;
      for (Index k = 0; k < case_.MoveSamples() + case_.HoldSamples(); ++k, ++row) {
        const double part = std::min(1.0, static_cast<double>(k) / case_.MoveSamples());
        recording.counts(row, channel) = Seen(before + part * (level - before));
        recording.settled_deg(row, channel) = k < case_.MoveSamples() ? std::nan("") : 10.0 * pose;
      }
      before = level;
    }
  }

  const Case& case_;
  TestNoise random_;
  double state_ = 0.0;
};

struct Coverage {
  int held = 0;
  int intervals = 0;
  double sum = 0.0;  // of the estimates, in units of the truth

  void Add(double low, double estimate, double high, double truth) {
    held += low <= truth && truth <= high;
    ++intervals;
    sum += estimate / truth;
  }
  std::string Text() const {
    return fmt::format("{:6.1f} %   {:6.3f}", 100.0 * held / std::max(intervals, 1),
                       sum / std::max(intervals, 1));
  }
};

/// Corners of a table, of samples without spikes.
void AddTable(const Recording& recording, int channel, Coverage& coverage) {
  std::vector<double> counts, angle_deg;
  for (Index k = 0; k < recording.counts.rows(); ++k) {
    if (std::isnan(recording.settled_deg(k, channel))) continue;
    counts.push_back(recording.counts(k, channel));
    angle_deg.push_back(recording.settled_deg(k, channel));
  }
  const CurveFit fit = FitTable(counts, angle_deg, 1.0);
  for (int pose = 0; pose < kPoses; ++pose) {
    double slope = 0.0;  // the steeper of the two beside it, as the fit takes it
    for (int i = std::max(pose, 1); i < std::min(pose + 2, kPoses); ++i) {
      slope = std::max(slope, 10.0 / (fit.curve.counts[i] - fit.curve.counts[i - 1]));
    }
    const double half = fit.half_width_95_deg[pose] / slope;
    const double mean = fit.curve.counts[pose];
    const double truth = recording.pose_counts(pose, channel);
    coverage.Add(mean - half, mean, mean + half, truth);
  }
}

/// Cases whose names hold this are measured.
std::string wanted;

void Measure(const Case& glove) {
  if (glove.name.find(wanted) == std::string::npos) return;
  Coverage variance, table;
  int without_rest = 0;
  Index spikes = 0;
  int rounded = 0;
  const double truth = glove.deviation_counts * glove.deviation_counts;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const Recording recording = Glove(glove, 1000 + repeat).Record();
    const std::span<const double> counts = {recording.counts.data(),
                                            static_cast<std::size_t>(recording.counts.size())};
    const auto stretches = FindStillStretches(counts, glove.channels, glove.rate_hz);
    if (stretches.size() < kPoses / 2) {
      ++without_rest;
      continue;
    }
    const NoiseEstimate estimate = EstimateNoise(counts, glove.channels, stretches);
    for (int c = 0; c < glove.channels; ++c) {
      variance.Add(estimate.variance_low[c], estimate.variance[c], estimate.variance_high[c],
                   truth);
      spikes += estimate.spikes[static_cast<std::size_t>(c)];
      rounded += estimate.rounded[static_cast<std::size_t>(c)];
      if (glove.spike_share + glove.clipped_share == 0.0) AddTable(recording, c, table);
    }
  }
  fmt::print("{:<28} {}   {}   {:>6.1f}   {:>4}   {:>4}\n", glove.name, variance.Text(),
             table.intervals > 0 ? table.Text() : std::string(17, '-'),
             static_cast<double>(spikes) / kRepeats / glove.channels, rounded, without_rest);
  std::fflush(stdout);
}

}  // namespace
}  // namespace gauntlet::controller

int main(int count, char** arguments) {
  if (count > 1) gauntlet::controller::wanted = arguments[1];
  fmt::print("{:<28} {:>9}  {:>7}   {:>9} {:>7}   {:>6}   {:>4}   {:>4}\n", "noise", "R covers",
             "R/truth", "table", "mean", "spikes", "rnd", "lost");
  for (const double deviation : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 3.0}) {
    gauntlet::controller::Measure(
        {.name = fmt::format("white, {} counts", deviation), .deviation_counts = deviation});
  }
  for (const double correlation : {-0.5, 0.3, 0.5, 0.8, 0.9, 0.95, 0.98}) {
    gauntlet::controller::Measure(
        {.name = fmt::format("correlation {}", correlation), .correlation = correlation});
  }
  for (const double white_share : {0.2, 0.5, 0.8}) {
    for (const double correlation : {0.9, 0.98}) {
      gauntlet::controller::Measure(
          {.name = fmt::format("correlation {}, {:.0f} % white", correlation, 100 * white_share),
           .correlation = correlation,
           .white_share = white_share});
    }
  }
  gauntlet::controller::Measure({.name = "spikes, 1 %", .spike_share = 0.01});
  gauntlet::controller::Measure({.name = "spikes, 5 %", .spike_share = 0.05});
  gauntlet::controller::Measure({.name = "at full scale, 0.5 %", .clipped_share = 0.005});
  for (const int channels : {5, 18}) {
    for (const double hold_s : {1.0, 1.5, 2.0}) {
      gauntlet::controller::Measure(
          {.name = fmt::format("10 Hz, {} channels, {:g} s", channels, hold_s),
           .rate_hz = 10.0,
           .hold_s = hold_s,
           .channels = channels});
    }
  }
}
