// Load a controller that was tuned in the simulator, and step it: the whole of a robot's program
// but for its glove and its motors.

#include <cstdio>
#include <vector>

#include "controller/controller.h"
#include "sim/base/error.h"
#include "sim/settings/robot_file.h"

namespace {

void DriveHand(const char* file) {
  const auto robot = gauntlet::sim::LoadRobot(file);
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

}  // namespace

int main(int count, char** arguments) {
  try {
    DriveHand(count > 1 ? arguments[1] : "robot.yaml");
  } catch (const gauntlet::sim::UserError& error) {  // what is wrong with the file, and where
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
