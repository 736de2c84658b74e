#include <cstdio>

#include "controller/controller.h"
#include "sim/base/error.h"
#include "sim/settings/robot_file.h"

int main(int, char** arguments) {
  gauntlet::controller::Controller controller(gauntlet::sim::LoadRobot(arguments[1]));
  const double counts[] = {400.0, 600.0};
  const auto command = controller.Step({.counts = counts});
  std::printf("%d %d\n", command.motor_counts[0], command.event);
  try {
    gauntlet::sim::LoadRobot("nowhere.yaml");
  } catch (const gauntlet::sim::UserError&) {
    return controller.channel_count() == 2 && controller.motor_count() == 18 ? 0 : 1;
  }
  return 1;
}
