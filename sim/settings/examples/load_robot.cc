// Load a controller that was tuned in the simulator, and step it: a robot's program in ten lines.

#include <cstdio>
#include <vector>

#include "controller/controller.h"
#include "sim/settings/robot_file.h"

int main(int count, char** arguments) {
  const auto robot = gauntlet::sim::LoadRobot(count > 1 ? arguments[1] : "robot.yaml");
  gauntlet::controller::Controller controller(robot);
  std::vector<double> counts(robot.glove.channel_names.size());
  for (int tick = 0; tick < 200; ++tick) {  // robot.timing.tick_rate_hz times per second
    const bool fresh = tick % robot.timing.ticks_per_sample == 0;
    if (fresh) counts.assign(counts.size(), 300.0 + 2.0 * tick);  // read your glove here
    const auto command = fresh ? controller.Step({.counts = counts}) : controller.Step();
    if (!command.event) continue;
    for (const int motor : command.motor_counts) std::printf("%5d", motor);  // send them here
    std::printf("\n");
  }
}
