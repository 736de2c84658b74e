// What somebody else's robot does with what gauntlet export wrote: reads where its motors are, then
// samples of the glove, one a line, and prints the command of every event. It knows Gauntlet only
// as a library.
#include <cstdio>
#include <iostream>
#include <vector>

#include "controller/controller.h"
#include "sim/settings/robot_file.h"

int main(int, char** arguments) {
  const gauntlet::controller::RobotConfig settings = gauntlet::sim::LoadRobot(arguments[1]);
  gauntlet::controller::Controller controller(settings);
  std::vector<double> counts(settings.glove.channel_names.size());
  std::ios::sync_with_stdio(false);
  std::vector<int> motors(settings.hand.motor_names.size());
  for (int& motor : motors) std::cin >> motor;
  controller.Reset(motors);
  for (long tick = 0;; ++tick) {
    const bool fresh = tick % settings.timing.ticks_per_sample == 0;
    for (std::size_t i = 0; fresh && i < counts.size(); ++i) std::cin >> counts[i];
    if (!std::cin) return 0;
    const auto command = fresh ? controller.Step({.counts = counts}) : controller.Step();
    if (!command.event) continue;
    std::printf("%ld", tick);
    for (const int motor : command.motor_counts) std::printf(" %d", motor);
    std::printf("\n");
  }
}
