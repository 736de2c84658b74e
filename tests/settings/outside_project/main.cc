#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "controller/step_recorder.h"
#include "sim/base/error.h"
#include "sim/settings/robot_file.h"
#include "sim/settings/steps_csv.h"

int main(int, char** arguments) {
  const auto robot = gauntlet::sim::LoadRobot(arguments[1]);
  gauntlet::controller::Controller controller(robot);
  gauntlet::controller::StepRecorder recorder(robot, 10000);
  const std::size_t columns = recorder.column_names().size();
  std::vector<double> rows(10000 * columns);
  const double counts[] = {400.0, 600.0};
  const gauntlet::controller::GloveSample sample = {.counts = counts};
  const auto command = controller.Step(sample);
  std::printf("%d %d\n", command.motor_counts[0], command.event);
  recorder.Add(sample, controller, command);
  rows.resize(recorder.CopyTo(rows) * columns);
  const std::string csv = gauntlet::sim::StepsToCsv(recorder.column_names(), rows);
  if (csv.find("\n0,1,,1,good,400,600,,,") == std::string::npos) return 1;
  try {
    gauntlet::sim::LoadRobot("nowhere.yaml");
  } catch (const gauntlet::sim::UserError&) {
    return controller.channel_count() == 2 && controller.motor_count() == 18 ? 0 : 1;
  }
  return 1;
}
