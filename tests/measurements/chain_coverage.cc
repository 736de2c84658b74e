// How near gauntlet identify comes to what simulated logs hide, and how often its intervals hold
// it. The table of tests/measurements/README.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "sim/calibrate/chain_fit.h"
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
  std::optional<FrameClock> frames;
  if (recording.held_s * recording.rate_hz == 1.0) frames = FrameClock();  // rows do not tell
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
  measure("30 s at 500 Hz, noise of 0.3 deg, correlation 0.95", {.noise_correlation = 0.95});
}
