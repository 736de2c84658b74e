// A scenario: refused with a sentence, or read; and then what is written of it reads back the same.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "sim/base/error.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

void Read(const std::string& text) {
  Scenario scenario;
  try {
    scenario = ParseScenario({.file = "fuzzed.yaml", .text = text});
  } catch (const UserError&) {
    return;
  }
  const std::string written = ScenarioToYaml(scenario);
  const Scenario again = ParseScenario({.file = "scenario.resolved.yaml", .text = written});
  if (ScenarioToYaml(again) != written) std::abort();
}

}  // namespace
}  // namespace gauntlet::sim

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gauntlet::sim::Read(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
