#include "sim/study/scenario/scenario_files.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "sim/base/hash.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

using controller::Setting;
using controller::SettingsVisitor;

/// Shows every path of a config struct.
class PathVisitor final : public SettingsVisitor {
 public:
  explicit PathVisitor(std::function<void(std::string&)> see) : see_(std::move(see)) {}

  void Number(const Setting& /*setting*/, double& /*value*/) override {}
  void Integer(const Setting& /*setting*/, int& /*value*/) override {}
  void Flag(const Setting& /*setting*/, bool& /*value*/) override {}
  void Text(const Setting& /*setting*/, std::string& /*value*/) override {}
  void Path(const Setting& /*setting*/, std::string& value) override { see_(value); }
  void Numbers(const Setting& /*setting*/, std::vector<double>& /*value*/) override {}
  void Texts(const Setting& /*setting*/, std::vector<std::string>& /*value*/) override {}
  void Choice(const Setting& /*setting*/, std::span<const std::string_view> /*names*/,
              std::size_t& /*index*/) override {}
  void Group(const Setting& /*setting*/,
             const std::function<void(SettingsVisitor&)>& visit) override {
    visit(*this);
  }
  void List(const Setting& /*setting*/, const controller::SettingList& list) override {
    for (std::size_t i = 0; i < list.size(); ++i) list.visit(i, *this);
  }
  void Map(const Setting& /*setting*/, const controller::SettingMap& map) override {
    for (std::size_t i = 0; i < map.size(); ++i) map.visit(i, *this);
  }

 private:
  std::function<void(std::string&)> see_;
};

PathVisitor FolderDropper() {
  return PathVisitor([](std::string& path) { path = std::filesystem::path(path).filename(); });
}

}  // namespace

std::vector<NamedFile> FilesOf(const Scenario& scenario) {
  std::vector<GloveConfig> gloves = scenario.repetitions.gloves;
  gloves.push_back(scenario.glove);
  std::set<std::string> paths;
  PathVisitor collector([&paths](const std::string& path) { paths.insert(path); });
  for (GloveConfig& glove : gloves) glove.Visit(collector);
  for (const NamedController& named : scenario.controllers) {
    for (const std::filesystem::path& file : ProgramFiles(named.config)) paths.insert(file);
  }
  std::vector<NamedFile> files;
  for (const std::string& path : paths) {
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(path, unreadable)) continue;
    files.push_back({.file = path, .hash = HashOfFile(path)});
  }
  return files;
}

void DropFolders(Scenario& scenario) {
  PathVisitor drop = FolderDropper();
  scenario.Visit(drop);
  for (GloveConfig& glove : scenario.repetitions.gloves) glove.Visit(drop);
}

void DropFolders(NamedController& controller) {
  PathVisitor drop = FolderDropper();
  controller.Visit(drop);
}

std::vector<ChangedFile> ChangedFiles(const Scenario& scenario) {
  std::vector<ChangedFile> changed;
  if (scenario.made_with.files.empty()) return changed;
  for (const NamedFile& now : FilesOf(scenario)) {
    const auto then = std::ranges::find(scenario.made_with.files, now.file, &NamedFile::file);
    if (then == scenario.made_with.files.end() || then->hash == now.hash) continue;
    changed.push_back({.then = *then, .now = now});
  }
  return changed;
}

}  // namespace gauntlet::sim
