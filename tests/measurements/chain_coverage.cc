// How near gauntlet identify comes to what simulated logs hide, and how often its intervals hold
// it. The table of docs/evidence/measurements.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "sim/fit/chain_fit.h"
#include "tests/calibrate/other_chains.h"
#include "tests/calibrate/simulated_chain.h"

namespace gauntlet::sim {
namespace {

int logs = 100;  // per row

/// Errors and intervals of one quantity over all logs.
class Quantity {
 public:
  explicit Quantity(std::string name) : name_(std::move(name)) {}

  void Add(const ChainEstimate& estimate, double truth) {
    if (!std::isfinite(estimate.value)) {
      ++missing_;
      return;
    }
    held_ += estimate.low <= truth && truth <= estimate.high;
    error_.push_back(std::abs(estimate.value / truth - 1.0));
    width_ += 0.5 * (estimate.high - estimate.low) / truth;
  }
  void Print() {
    if (error_.empty()) return;
    std::ranges::sort(error_);
    const double count = static_cast<double>(error_.size());
    fmt::print("  {:<22} {:>8.1f} {:>8.1f} {:>8.1f} {:>10.1f} {:>8}\n", name_,
               100.0 * error_[error_.size() / 2], 100.0 * error_[error_.size() * 95 / 100],
               100.0 * width_ / count, 100.0 * held_ / count, missing_);
  }

 private:
  std::string name_;
  std::vector<double> error_;
  double width_ = 0.0;
  int held_ = 0;
  int missing_ = 0;
};

double Between(double low, double high, controller::TestNoise& random) {
  return low + (high - low) * random.Uniform();
}

HiddenChain SomeChain(controller::TestNoise& random) {
  return {.dead_time_ms = Between(15.0, 80.0, random),
          .lag_ms = Between(25.0, 60.0, random),
          .natural_frequency_hz = Between(4.0, 8.0, random),
          .gain = Between(0.8, 1.1, random),
          .hysteresis_deg = Between(1.0, 8.0, random),
          .offset_deg = Between(-5.0, 5.0, random),
          .lost_motion_deg = 0.0};
}

/// With a dead zone behind the motor, first without its angle in the log, and then with it.
void MeasureLostMotion(const std::string& name, const ChainRecording& recording,
                       double least_lost_deg = 1.0, double most_lost_deg = 8.0) {
  Quantity quantities[] = {Quantity("lost motion, alone"),
                           Quantity("of motor, alone"),
                           Quantity("hysteresis, as the sum"),
                           Quantity("dead time"),
                           Quantity("lag"),
                           Quantity("lost motion"),
                           Quantity("hysteresis of motor")};
  for (int i = 0; i < logs; ++i) {
    controller::TestNoise random(9000 + i);
    HiddenChain chain = SomeChain(random);
    chain.lost_motion_deg = Between(least_lost_deg, most_lost_deg, random);
    const SimulatedLog log = SimulateLog(chain, recording, 100 + i);
    ChainFit fit = FitChain(log.command_deg, log.angle_deg, recording.rate_hz);
    quantities[0].Add(fit.lost_motion_deg, chain.lost_motion_deg);
    quantities[1].Add(fit.motor_hysteresis_deg, chain.hysteresis_deg);
    quantities[2].Add(fit.hysteresis_deg, chain.hysteresis_deg + chain.lost_motion_deg);
    quantities[3].Add(fit.dead_time_ms, chain.dead_time_ms);
    quantities[4].Add(fit.lag_ms, chain.lag_ms);
    AddMotor(log.command_deg, log.motor_deg, log.angle_deg, recording.rate_hz, fit);
    quantities[5].Add(fit.lost_motion_deg, chain.lost_motion_deg);
    quantities[6].Add(fit.motor_hysteresis_deg, chain.hysteresis_deg);
  }
  fmt::print("{}\n", name);
  for (Quantity& quantity : quantities) quantity.Print();
  std::fflush(stdout);
}

void Measure(const std::string& name, const ChainRecording& recording) {
  Quantity quantities[] = {Quantity("dead time"), Quantity("lag"),  Quantity("natural frequency"),
                           Quantity("damping"),   Quantity("gain"), Quantity("hysteresis")};
  constexpr int kParts = 20;  // of a hand
  std::optional<CommandClock> frames;
  if (recording.held_s * recording.rate_hz == 1.0) frames = CommandClock();  // rows do not tell
  int lost = 0;
  int lost_of_parts = 0;
  for (int i = 0; i < logs; ++i) {
    controller::TestNoise random(7000 + i);
    const HiddenChain chain = SomeChain(random);
    const SimulatedLog log = SimulateLog(chain, recording, 100 + i);
    const ChainFit fit = FitChain(log.command_deg, log.angle_deg, recording.rate_hz, 1, frames);
    lost += std::isfinite(fit.lost_motion_deg.value);
    lost_of_parts +=
        std::isfinite(FitChain(log.command_deg, log.angle_deg, recording.rate_hz, kParts, frames)
                          .lost_motion_deg.value);
    const double damping = 1e-3 * chain.lag_ms * std::numbers::pi * chain.natural_frequency_hz;
    quantities[0].Add(fit.dead_time_ms, chain.dead_time_ms);
    quantities[1].Add(fit.lag_ms, chain.lag_ms);
    quantities[2].Add(fit.natural_frequency_hz, chain.natural_frequency_hz);
    quantities[3].Add(fit.damping_ratio, damping);
    quantities[4].Add(fit.gain, chain.gain);
    quantities[5].Add(fit.hysteresis_deg, chain.hysteresis_deg);
  }
  fmt::print("{}\n", name);
  for (Quantity& quantity : quantities) quantity.Print();
  fmt::print("  lost motion claimed, of none: {} of {}, as one of {} parts: {}\n", lost, logs,
             kParts, lost_of_parts);
  std::fflush(stdout);
}

/// One log in one line, with a star at intervals that do not hold.
void Show(const ChainFit& fit, const OtherLog& log, int number) {
  const auto one = [](const char* name, const ChainEstimate& e, double truth) {
    const bool held = e.low <= truth && truth <= e.high;
    if (!std::isfinite(e.value)) return std::string();
    return fmt::format(" {}{} {:.3g} ({:.3g}..{:.3g}) {:.3g};", held ? "" : "*", name, e.value,
                       e.low, e.high, truth);
  };
  const OtherTruth& truth = log.truth;
  fmt::print(
      "{:3} {:.0f}Hz [{}] left {:.3f}/{:.3f}{}{}{}{}{}{}{}{}{} {}{}\n", number, log.rate_hz,
      fit.model_text, fit.residual_rms_deg, fit.held_out_rms_deg,
      one("dead", fit.dead_time_ms, truth.dead_time_ms), one("lag", fit.lag_ms, truth.lag_ms),
      one("f", fit.natural_frequency_hz, truth.natural_frequency_hz),
      one("damp", fit.damping_ratio, truth.damping_ratio), one("gain", fit.gain, truth.gain),
      one("off", fit.offset_deg, truth.offset_deg),
      one("hyst", fit.hysteresis_deg, truth.hysteresis_deg), one("lost", fit.lost_motion_deg, 0.0),
      one("limit", fit.speed_limit_deg_s, truth.speed_limit_deg_s), fit.problem, fit.split_problem);
}

/// Intervals of hands of other kinds than the basic model: see OtherChain. Every value that is
/// given is counted, also values that such a hand does not have.
class OtherQuantity {
 public:
  void Add(const ChainEstimate& estimate, double truth) {
    ++logs_;
    if (!std::isfinite(estimate.value)) return;
    ++given_;
    held_ += estimate.low <= truth && truth <= estimate.high;
    half_widths_.push_back(0.5 * (estimate.high - estimate.low));
    errors_.push_back(std::abs(estimate.value - truth));
  }
  void Print(const std::string& name) {
    if (given_ == 0) return;
    std::ranges::sort(half_widths_);
    std::ranges::sort(errors_);
    fmt::print("  {:<22} {:>6} {:>6} {:>8.1f} {:>12.3g} {:>12.3g}\n", name, logs_, given_,
               100.0 * held_ / given_, errors_[errors_.size() / 2],
               half_widths_[half_widths_.size() / 2]);
  }
  int given() const { return given_; }
  int held() const { return held_; }

 private:
  int logs_ = 0;
  int given_ = 0;
  int held_ = 0;
  std::vector<double> half_widths_;
  std::vector<double> errors_;
};

constexpr std::array<const char*, 9> kOtherQuantities = {
    "dead time", "lag",        "natural frequency", "damping",    "gain",
    "offset",    "hysteresis", "lost motion",       "speed limit"};

void AddOther(const ChainFit& fit, const OtherTruth& truth,
              std::array<OtherQuantity, kOtherQuantities.size()>& quantities) {
  quantities[0].Add(fit.dead_time_ms, truth.dead_time_ms);
  quantities[1].Add(fit.lag_ms, truth.lag_ms);
  quantities[2].Add(fit.natural_frequency_hz, truth.natural_frequency_hz);
  quantities[3].Add(fit.damping_ratio, truth.damping_ratio);
  quantities[4].Add(fit.gain, truth.gain);
  if (std::isfinite(truth.offset_deg)) quantities[5].Add(fit.offset_deg, truth.offset_deg);
  quantities[6].Add(fit.hysteresis_deg, truth.hysteresis_deg);
  quantities[7].Add(fit.lost_motion_deg, 0.0);
  quantities[8].Add(fit.speed_limit_deg_s, truth.speed_limit_deg_s);
}

void MeasureOthers(const std::string& wanted) {
  constexpr double kRates_hz[] = {30.0, 100.0, 200.0, 500.0};
  int given = 0;
  int held = 0;
  const bool verbose = std::getenv("CHAIN_COVERAGE_VERBOSE") != nullptr;
  for (std::size_t kind = 0; kind < kOtherKindNames.size(); ++kind) {
    const std::string name = std::string("other models: ") + kOtherKindNames[kind];
    if (name.find(wanted) == std::string::npos) continue;
    std::array<OtherQuantity, kOtherQuantities.size()> quantities;
    const int count =
        (4 * logs + static_cast<int>(kind)) / static_cast<int>(kOtherKindNames.size());
    for (int i = 0; i < count; ++i) {
      OtherChain chain(static_cast<OtherKind>(kind), 1000 * (kind + 1) + i);
      const OtherLog log = chain.Simulate(kRates_hz[i % 4]);
      const ChainFit fit = FitChain(log.command_deg, log.angle_deg, log.rate_hz);
      if (verbose) Show(fit, log, i);
      AddOther(fit, log.truth, quantities);
    }
    fmt::print("{}\n", name);
    for (std::size_t i = 0; i < quantities.size(); ++i) {
      quantities[i].Print(kOtherQuantities[i]);
      given += quantities[i].given();
      held += quantities[i].held();
    }
    std::fflush(stdout);
  }
  if (given > 0) {
    fmt::print("other models: {} of {} given intervals hold, {:.1f} %\n", held, given,
               100.0 * held / given);
  }
}

}  // namespace
}  // namespace gauntlet::sim

int main(int count, char** arguments) {
  using gauntlet::sim::Measure;
  const std::string wanted = count > 1 ? arguments[1] : "";
  if (count > 2) gauntlet::sim::logs = std::stoi(arguments[2]);
  fmt::print("  {:<22} {:>8} {:>8} {:>8} {:>10} {:>8}\n", "", "median %", "95th %", "half %",
             "covered %", "not had");
  const auto measure = [&](const std::string& name,
                           const gauntlet::sim::ChainRecording& recording) {
    if (name.find(wanted) != std::string::npos) Measure(name, recording);
  };
  for (const double rate_hz : {500.0, 100.0}) {
    const std::string name = fmt::format("lost motion, 30 s at {:g} Hz", rate_hz);
    if (name.find(wanted) != std::string::npos) {
      gauntlet::sim::MeasureLostMotion(name, {.rate_hz = rate_hz});
      gauntlet::sim::MeasureLostMotion(name + ", no noise of motor",
                                       {.rate_hz = rate_hz, .motor_noise_deg = 0.0});
    }
  }
  const std::string little = "little lost motion, 30 s at 500 Hz";
  if (little.find(wanted) != std::string::npos) {
    gauntlet::sim::MeasureLostMotion(little, {}, 0.1, 1.0);
  }
  for (const double rate_hz : {500.0, 100.0, 50.0}) {
    const std::string rows = fmt::format("30 s at {:g} Hz, white noise of 0.3 deg", rate_hz);
    measure(rows, {.rate_hz = rate_hz});
    measure(rows + ", held for 20 ms", {.rate_hz = rate_hz, .held_s = 0.02});
    measure(rows + ", held for 21.7 ms", {.rate_hz = rate_hz, .held_s = 0.0217});
  }
  gauntlet::sim::MeasureOthers(wanted);
  measure("30 s at 500 Hz, noise of 0.3 deg, correlation 0.95", {.noise_correlation = 0.95});
}
