// Measures the hand: the numbers and pictures of docs/evidence/hand.md.

#include "tests/measurements/hand_measurements.h"

#include <fmt/core.h>

#include <functional>
#include <map>
#include <string>

int main(int argc, char** argv) {
  using namespace gauntlet::sim::testing;
  const std::filesystem::path folder = argc > 2 ? argv[2] : ".";
  const std::map<std::string, std::function<void()>> measurements = {
      {"joints", PrintJoints},
      {"coupling", PrintCoupling},
      {"thumb", PrintOpposition},
      {"friction", PrintFriction},
      {"reach", PrintReach},
      {"steps", PrintSteps},
      {"closing", PrintClosing},
      {"delays", PrintDelays},
      {"servos", PrintServos},
      {"joint_loop", PrintJointLoop},
      {"slack", PrintSlack},
      {"warnings", PrintWarnings},
      {"speed", PrintSpeed},
      {"hysteresis", [&] { WriteHysteresis(folder); }},
      {"convergence", [&] { WriteConvergence(folder); }},
      {"pictures", [&] { WritePictures(folder); }},
  };
  const auto found = argc > 1 ? measurements.find(argv[1]) : measurements.end();
  if (found == measurements.end()) {
    fmt::print(stderr, "usage: hand_measurements WHAT [FOLDER]; WHAT is one of:");
    for (const auto& [name, run] : measurements) fmt::print(stderr, " {}", name);
    fmt::print(stderr, "\n");
    return 2;
  }
  found->second();
  return 0;
}
