#include "sim/scenario/scenario_files.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "sim/base/hash.h"

namespace gauntlet::sim {
namespace {

using controller::Setting;
using controller::SettingsVisitor;

/// Collects every path of a config struct.
class PathCollector final : public SettingsVisitor {
 public:
  void Number(const Setting& /*setting*/, double& /*value*/) override {}
  void Integer(const Setting& /*setting*/, int& /*value*/) override {}
  void Flag(const Setting& /*setting*/, bool& /*value*/) override {}
  void Text(const Setting& /*setting*/, std::string& /*value*/) override {}
  void Path(const Setting& /*setting*/, std::string& value) override { paths.insert(value); }
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

  std::set<std::string> paths;
};

}  // namespace

std::vector<NamedFile> FilesOf(const Scenario& scenario) {
  std::vector<GloveConfig> gloves = scenario.repetitions.gloves;
  gloves.push_back(scenario.glove);
  PathCollector collector;
  for (GloveConfig& glove : gloves) glove.Visit(collector);
  std::vector<NamedFile> files;
  for (const std::string& path : collector.paths) {
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(path, unreadable)) continue;
    files.push_back({.file = path, .hash = HashOfFile(path)});
  }
  return files;
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
