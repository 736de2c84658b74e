#include "sim/study/study_identity.h"

#include <dlfcn.h>
#include <link.h>

#include <span>
#include <string_view>

#include "sim/base/hash.h"
#include "sim/base/mathematics.h"
#include "sim/study/scenario/scenario_files.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

using controller::Setting;

/// The file that contains this code: the program, or a library in the program that loads it, as
/// Python.
std::string FileOfCode() {
  static const char kHere = 0;
  Dl_info info;
  const link_map* object = nullptr;
  void* found = nullptr;
  if (dladdr1(&kHere, &info, &found, RTLD_DL_LINKMAP) != 0) {
    object = static_cast<const link_map*>(found);
  }
  const bool is_library = object != nullptr && object->l_name[0] != '\0';
  return is_library ? object->l_name : "/proc/self/exe";
}

/// The program's own bytes: another build may compute other bytes.
const std::string& HashOfProgram() {
  static const std::string kHash = HashOfFile(FileOfCode());
  return kHash;
}

/// Every key with its value. Numbers are their bytes: what is equal as a number and not in its
/// bytes, 0 and -0, is not the same setting.
class SettingsHash final : public controller::SettingsVisitor {
 public:
  void Number(const Setting& setting, double& value) override {
    Key(setting);
    Numbers({&value, 1});
  }
  void Integer(const Setting& setting, int& value) override {
    Key(setting);
    hash_.Add(std::span<const int>(&value, 1));
  }
  void Flag(const Setting& setting, bool& value) override {
    Key(setting);
    Text(value ? "true" : "false");
  }
  void Text(const Setting& setting, std::string& value) override {
    Key(setting);
    Text(value);
  }
  void Path(const Setting& setting, std::string& value) override {
    Key(setting);
    Text(value);
  }
  void Numbers(const Setting& setting, std::vector<double>& value) override {
    Key(setting);
    Count(value.size());
    Numbers(value);
  }
  void Texts(const Setting& setting, std::vector<std::string>& value) override {
    Key(setting);
    Count(value.size());
    for (const std::string& text : value) Text(text);
  }
  void Choice(const Setting& setting, std::span<const std::string_view> names,
              std::size_t& index) override {
    Key(setting);
    Text(names[index]);
  }
  void NamedNumbers(const Setting& setting, std::vector<controller::NamedNumber>& values) override {
    Count(values.size());
    SettingsVisitor::NamedNumbers(setting, values);
  }
  void Group(const Setting& setting,
             const std::function<void(controller::SettingsVisitor&)>& visit) override {
    Key(setting);
    visit(*this);
  }
  void List(const Setting& setting, const controller::SettingList& list) override {
    Key(setting);
    Count(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) list.visit(i, *this);
  }
  void Map(const Setting& setting, const controller::SettingMap& map) override {
    Key(setting);
    Count(map.size());
    for (std::size_t i = 0; i < map.size(); ++i) {
      Text(map.name(i));
      if (map.visit) map.visit(i, *this);
    }
  }

  void Text(std::string_view text) {
    Count(text.size());
    hash_.Add(text);
  }
  std::string Result() const { return hash_.Text(); }

 private:
  void Key(const Setting& setting) { Text(setting.key); }
  void Count(std::size_t count) { hash_.Add(std::span<const std::size_t>(&count, 1)); }
  void Numbers(std::span<const double> numbers) { hash_.Add(numbers); }

  Hash hash_;
};

}  // namespace

std::string SharedSettings(const Study& study) {
  Scenario scenario = study.scenario;
  scenario.name.clear();
  scenario.question.clear();
  scenario.video = {};
  scenario.made_with = {};
  scenario.controllers.clear();
  scenario.baseline.clear();  // judges trials, and changes none
  scenario.priority.clear();  // the same
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
  SettingsHash hash;
  hash.Text(settings.name);
  settings.Visit(hash);
  if (HasPrograms(controller.config)) hash.Text(HashOfPrograms(controller.config));
  return hash.Result();
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
