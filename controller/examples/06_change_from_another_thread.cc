// Other settings from another thread: it prepares them and destroys the old ones; the control loop
// only swaps and neither waits nor allocates.

#include <atomic>
#include <cstdio>
#include <memory>
#include <thread>
#include <vector>

#include "controller/controller.h"

namespace gc = gauntlet::controller;

int main() {
  const gc::GloveCalibration glove = {.channel_names = {"index"},
                                      .low_counts = {200},
                                      .high_counts = {800},
                                      .low_angle_rad = {0},
                                      .high_angle_rad = {1.5}};
  const gc::TendonTransmission hand = {.joint_names = {"index"},
                                       .motor_names = {"index"},
                                       .coupling = {1},
                                       .reference_angle_rad = {0},
                                       .joint_min_rad = {0},
                                       .joint_max_rad = {1.5},
                                       .counts_per_rad = {195},
                                       .center_counts = {300},
                                       .min_counts = {0},
                                       .max_counts = {1023}};
  gc::ControllerConfig config;
  config.filters = {{gc::ButterworthConfig{.cutoff_hz = 2.0}}};
  gc::Controller controller(config, glove, hand);
  controller.Reset(std::vector<int>{348});  // where the motor is: read it from your servo

  std::atomic<gc::Controller*> prepared = nullptr;  // to the control loop, and back from it
  std::atomic<gc::Controller*> replaced = nullptr;
  std::thread tuner([&] {
    for (const double cutoff_hz : {4.0, 8.0, 16.0}) {
      config.filters = {{gc::ButterworthConfig{.cutoff_hz = cutoff_hz}}};
      prepared = std::make_unique<gc::Controller>(controller.Prepare(config)).release();
      while (replaced == nullptr) std::this_thread::yield();
      const std::unique_ptr<gc::Controller> old(replaced.exchange(nullptr));
    }
  });

  int swaps = 0;
  int last = 348;
  for (int k = 0; k < 1000 || swaps < 3; ++k) {  // your loop, once per millisecond
    if (gc::Controller* next = prepared.exchange(nullptr)) {
      controller.Swap(*next);
      replaced = next;
      ++swaps;
    }
    const double counts = 300.0 + 0.1 * (k % 1000);
    const gc::Command command = controller.Step({.counts = {&counts, 1}});
    const int change = command.motor_counts[0] - last;
    if (change < -79 || change > 79) return 1;  // 20 rad/s, 20 ms and 195 counts per rad
    last = command.motor_counts[0];
  }
  tuner.join();
  std::printf("%d other settings, motor at %d\n", swaps, last);
  return 0;
}
