#include "sim/study/study_identity.h"

#include "sim/base/hash.h"
#include "sim/base/mathematics.h"
#include "sim/scenario/scenario_files.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {
namespace {

/// The program's own bytes: another build may compute other bytes.
const std::string& HashOfProgram() {
  static const std::string kHash = HashOfFile("/proc/self/exe");
  return kHash;
}

}  // namespace

std::string SharedSettings(const Study& study) {
  Scenario scenario = study.scenario;
  scenario.name.clear();
  scenario.question.clear();
  scenario.video = {};
  scenario.made_with = {};
  scenario.controllers.clear();
  scenario.baseline.clear();  // judges trials, and changes none
  DropFolders(scenario);      // what is in the files counts: in the signals and in the hand
  return ScenarioToYaml(scenario);
}

std::string HashOfStudy(const Study& study) {
  Hash hash;
  hash.Add(SharedSettings(study));
  hash.Add(study.hand->Hash());
  for (const GloveFacts& glove : study.repetitions) hash.Add(glove.signal_hash);
  hash.Add(HashOfProgram());
  hash.Add(HashOfMathematics());
  return hash.Text();
}

std::string HashOfSettings(const NamedController& controller) {
  NamedController settings = controller;
  DropFolders(settings);  // what the files gave stands in the settings
  Hash hash;
  hash.Add(settings.name + "\n");
  hash.Add(SettingsToYaml([&](controller::SettingsVisitor& visitor) { settings.Visit(visitor); }));
  return hash.Text();
}

StudyIdentity IdentityOf(const Study& study) {
  StudyIdentity identity{.hash = HashOfStudy(study),
                         .shared_settings = SharedSettings(study),
                         .controller_settings = {}};
  for (const NamedController& named : study.scenario.controllers) {
    identity.controller_settings.push_back(HashOfSettings(named));
  }
  return identity;
}

}  // namespace gauntlet::sim
