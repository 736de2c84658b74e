#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include "tests/hand/hand_fixture.h"
#include "tests/hand/sine_delay.h"
#include "tests/measurements/hand_measurements.h"

namespace gauntlet::sim::testing {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// A smooth motion of all channels through most of their ranges: sines between 0.2 and 1 Hz.
std::vector<double> SmoothPosture(const controller::TendonTransmission& map, double time_s,
                                  std::uint64_t seed) {
  std::vector<double> angle(map.joint_names.size());
  for (std::size_t i = 0; i < angle.size(); ++i) {
    RandomStream random(seed, "smooth", i);
    const double frequency = random.Uniform(0.2, 1.0);
    const double phase = random.Uniform(0.0, kTwoPi);
    const double share = 0.5 + 0.4 * std::sin(kTwoPi * frequency * time_s + phase);
    angle[i] = map.joint_min_rad[i] + share * (map.joint_max_rad[i] - map.joint_min_rad[i]);
  }
  return angle;
}

/// Joint angles [rad] of 4 s of a smooth motion, row after row.
std::vector<double> Trajectory(double step_ms) {
  HandConfig config;
  config.step_ms = step_ms;
  Hand hand(MakeModel(config));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  hand.Reset(SmoothPosture(map, 0.0, 5));
  std::vector<double> rows;
  for (int sample = 0; sample < 4000; ++sample) {
    if (sample % 20 == 0) hand.SetCommand(CountsFor(map, SmoothPosture(map, sample * 1e-3, 5)));
    hand.Step();
    const std::vector<double> angle = JointAngles(hand);
    rows.insert(rows.end(), angle.begin(), angle.end());
  }
  return rows;
}

double ProcessorSeconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return usage.ru_utime.tv_sec + 1e-6 * usage.ru_utime.tv_usec + usage.ru_stime.tv_sec +
         1e-6 * usage.ru_stime.tv_usec;
}

/// A random posture every 100 ms and trembling commands; false if the hand was stopped.
/// `least_tension_n` is lowered to the least of all cables.
bool SurvivesRandomMotion(Hand& hand, std::uint64_t seed, double& least_tension_n) {
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  RandomStream random(seed, "motion");
  hand.Reset(RandomPosture(map, random));
  std::vector<std::int32_t> counts;
  std::vector<double> tension(hand.hand_model().cable_names().size());
  for (int sample = 0; sample < 2000; ++sample) {
    if (sample % 100 == 0) counts = CountsFor(map, RandomPosture(map, random));
    if (sample % 20 == 0) {
      for (std::int32_t& count : counts) count += static_cast<int>(random.Index(5)) - 2;
      hand.SetCommand(counts);
    }
    hand.Step();
    hand.ReadCableTensions(tension);
    least_tension_n = std::min(least_tension_n, *std::min_element(tension.begin(), tension.end()));
  }
  if (!hand.health().ok) fmt::print("seed {}: {}\n", seed, hand.health().problem);
  return hand.health().ok;
}

/// A random closing of the hand on a random bottle, then a random arm motion.
bool SurvivesRandomGrasp(std::uint64_t seed) {
  RandomStream random(seed, "grasp");
  HandConfig config;
  config.contact = Contact::kObject;
  config.object.mass_kg = random.Uniform(0.05, 1.0);
  config.object.diameter_mm = random.Uniform(30.0, 55.0);
  Hand hand(MakeModel(config));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  std::vector<double> open(map.joint_names.size());
  open[ChannelIndex("thumb_rotation")] = 72.0 * kRadPerDeg;
  open[ChannelIndex("thumb_abduction")] = 60.0 * kRadPerDeg;
  open[ChannelIndex("wrist_deviation")] = -20.0 * kRadPerDeg;
  open[ChannelIndex("elbow_flexion")] = 28.0 * kRadPerDeg;
  open[ChannelIndex("shoulder_flexion")] = 75.0 * kRadPerDeg;
  hand.Reset(open);
  const std::vector<double> first = RandomPosture(map, random);
  const std::vector<double> second = RandomPosture(map, random);
  for (int frame = 0; frame < 150; ++frame) {
    std::vector<double> angle = open;
    for (std::size_t i = 0; i < angle.size(); ++i) {
      const bool arm = i >= static_cast<std::size_t>(ChannelIndex("wrist_flexion"));
      const double close = std::clamp(frame / 50.0, 0.0, 1.0);
      const double move = std::clamp((frame - 50) / 50.0, 0.0, 1.0);
      if (!arm) angle[i] += close * (std::max(first[i], map.reference_angle_rad[i]) - angle[i]);
      if (arm) angle[i] += move * 0.5 * (second[i] - angle[i]);
    }
    hand.SetCommand(CountsFor(map, angle));
    StepTimes(hand, 20);
  }
  if (!hand.health().ok) fmt::print("grasp {}: {}\n", seed, hand.health().problem);
  return hand.health().ok;
}

}  // namespace

void PrintSteps() {
  Hand hand(MakeModel());
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  fmt::print("| channel | step [deg] | 10 to 90 % [ms] | overshoot [%] |\n|---|---|---|---|\n");
  for (std::size_t channel = 0; channel < map.joint_names.size(); ++channel) {
    std::vector<double> angle = HomePosture(map);
    const double start = angle[channel];
    const double step = std::min(20.0 * kRadPerDeg, map.joint_max_rad[channel] - start);
    hand.Reset(angle);
    angle[channel] += step;
    hand.SetCommand(CountsFor(map, angle));
    int low = -1;
    int high = -1;
    double most = 0.0;
    for (int sample = 0; sample < 800; ++sample) {
      hand.Step();
      const double share = (JointAngles(hand)[channel] - start) / step;
      if (low < 0 && share > 0.1) low = sample;
      if (high < 0 && share > 0.9) high = sample;
      most = std::max(most, share);
    }
    fmt::print("| {} | {:.0f} | {} | {:.1f} |\n", map.joint_names[channel], step * kDegPerRad,
               high < 0 ? "not reached" : fmt::format("{}", high - low),
               std::max(0.0, 100.0 * (most - 1.0)));
  }
}

void PrintClosing() {
  Hand hand(MakeModel());
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  std::vector<double> open = HomePosture(map);
  std::vector<double> closed = open;
  for (const char* finger : {"index", "middle", "ring", "little"}) {
    for (const char* joint : {"_mcp", "_pip"}) {
      const int channel = ChannelIndex(std::string(finger) + joint);
      open[channel] = 0.0;
      closed[channel] = map.joint_max_rad[channel];
    }
  }
  const auto time_ms = [&](const std::vector<double>& from, const std::vector<double>& to) {
    hand.Reset(from);
    hand.SetCommand(CountsFor(map, to));
    int last = 0;
    for (int sample = 1; sample <= 1500; ++sample) {
      hand.Step();
      const std::vector<double> angle = JointAngles(hand);
      for (std::size_t i = 0; i < angle.size(); ++i) {
        if (std::abs(angle[i] - to[i]) > 5.0 * kRadPerDeg) last = sample;
      }
    }
    return last;
  };
  fmt::print("four fingers, all joints within 5 deg of the goal: closed after {} ms, ",
             time_ms(open, closed));
  fmt::print("open again after {} ms\n", time_ms(closed, open));
}

void PrintDelays() {
  Hand hand(MakeModel());
  Hand servos(MakeModel(ServosAlone()));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  fmt::print(
      "| channel | frame and servo alone [ms] | spool in the hand [ms] | joint [ms] | cables and "
      "load "
      "[ms] |\n|---|---|---|---|---|\n");
  for (std::size_t channel = 0; channel < map.joint_names.size(); ++channel) {
    const double alone = MeasureDelay(servos, channel).spool.Milliseconds();
    const DriveDelay delay = MeasureDelay(hand, channel);
    fmt::print("| {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", map.joint_names[channel], alone,
               delay.spool.Milliseconds(), delay.joint.Milliseconds(),
               delay.joint.Milliseconds() - alone);
  }
}

void PrintWarnings() {
  for (const ServoKind& kind : ServoKinds()) {
    HandConfig config;
    config.servo = kind.defaults;
    Hand hand(MakeModel(config));
    int motions = 0;
    double least_n = 1e9;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      motions += SurvivesRandomMotion(hand, seed, least_n);
    }
    fmt::print("{}: {} of 200 random motions of 2 s without a warning; least tension {} N\n",
               kind.name, motions, least_n);
  }
  int grasps = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) grasps += SurvivesRandomGrasp(seed);
  fmt::print("{} of 20 random grasps of 3 s without a warning\n", grasps);
}

void WriteConvergence(const std::filesystem::path& folder) {
  const std::vector<double> finest = Trajectory(0.03125);
  std::ofstream out(folder / "convergence.csv");
  out << "step_ms,rms_deg,largest_deg\n";
  for (double step_ms : {1.0, 0.5, 0.25, 0.125, 0.0625}) {
    const std::vector<double> coarse = Trajectory(step_ms);
    double sum = 0.0;
    double largest = 0.0;
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      const double difference = std::abs(coarse[i] - finest[i]) * kDegPerRad;
      sum += difference * difference;
      largest = std::max(largest, difference);
    }
    const std::string row =
        fmt::format("{},{:.5f},{:.5f}", step_ms, std::sqrt(sum / coarse.size()), largest);
    out << row << "\n";
    fmt::print("{}\n", row);
  }
}

// Processor time, since the clock on the wall also counts what else the machine does.
void PrintSpeed() {
  constexpr int kSteps = 20000;
  const std::string command = fmt::format(
      "mujoco-testspeed /usr/share/mujoco/model/humanoid/humanoid.xml {} > /dev/null", kSteps);
  for (int run = 0; run < 3; ++run) {
    const double before_child = ProcessorSeconds(RUSAGE_CHILDREN);
    if (std::system(command.c_str()) != 0) {
      fmt::print("mujoco-testspeed is missing (Debian: libmujoco-samples)\n");
      return;
    }
    const double humanoid_us = 1e6 * (ProcessorSeconds(RUSAGE_CHILDREN) - before_child) / kSteps;
    for (Contact contact : {Contact::kNone, Contact::kObject}) {
      HandConfig config;
      config.contact = contact;
      Hand hand(MakeModel(config));
      const controller::TendonTransmission& map = hand.hand_model().transmission();
      hand.Reset(SmoothPosture(map, 0.0, 5));
      double motion_us = 0.0;
      for (int sample = 0; sample < kSteps; ++sample) {
        if (sample % 20 == 0) hand.SetCommand(CountsFor(map, SmoothPosture(map, sample * 1e-3, 5)));
        const double before = sample % 20 == 0 ? ProcessorSeconds(RUSAGE_SELF) : 0.0;
        if (sample % 20 == 0) motion_us -= before * 1e6;
        hand.Step();
        if (sample % 20 == 19) motion_us += ProcessorSeconds(RUSAGE_SELF) * 1e6;
      }
      fmt::print("{}: hand {:.1f} us a step, humanoid {:.1f} us, ratio {:.2f}\n",
                 contact == Contact::kNone ? "contacts off" : "with an object", motion_us / kSteps,
                 humanoid_us, motion_us / kSteps / humanoid_us);
    }
  }
}

}  // namespace gauntlet::sim::testing
