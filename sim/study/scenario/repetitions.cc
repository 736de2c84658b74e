#include "sim/study/scenario/repetitions.h"

#include <fmt/format.h>
#include <glob.h>
#include <yaml-cpp/emitter.h>
#include <yaml-cpp/emittermanip.h>

#include <algorithm>
#include <filesystem>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "sim/glove/glove.h"
#include "sim/settings/yaml_writer.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kGlove = "glove.";

[[noreturn]] void Fail(const YamlSource& source, const YamlNode& node, const std::string& key,
                       const std::string& problem) {
  const std::string path = "repetitions" + (key.empty() ? "" : "." + key);
  throw source.At(node, controller::SettingError(path, problem));
}

/// Lists stand in the file, or in one --set that replaces all of them.
void RefuseSetOfOneList(const YamlSource& source) {
  for (const auto& [path, text] : source.overrides) {
    if (path == "repetitions" || !IsAtOrBelow(path, "repetitions")) continue;
    throw UserError(
        {.place = OverridePlace(text),
         .key = "repetitions",
         .problem = "--set cannot change one list: it gives one value to all replicates (--set "
                    "glove.motion.file=a.csv) or replaces all lists (--set repetitions={})"});
  }
}

void CheckKey(const YamlSource& source, const YamlNode& node, const std::string& key,
              const std::vector<RepeatedSetting>& lists) {
  if (!key.starts_with(kGlove)) {
    Fail(source, node, key, "must be a setting of the glove, as glove.motion.file");
  }
  if (key.ends_with(".kind")) {
    Fail(source, node, key,
         fmt::format("cannot be repeated by itself, as every kind has settings of its own: repeat "
                     "{}",
                     key.substr(0, key.rfind('.'))));
  }
  for (const RepeatedSetting& other : lists) {
    if (key == other.key) Fail(source, node, key, "is given twice");
    if (IsAtOrBelow(key, other.key) || IsAtOrBelow(other.key, key)) {
      Fail(source, node, key, fmt::format("and {} are parts of each other", other.key));
    }
  }
}

RepeatedSetting ReadList(const YamlSource& source, const std::string& key, const YamlNode& list) {
  if (!list.IsSequence() || list.items().empty()) {
    Fail(source, list, key, "must be a list of values, one for each replicate");
  }
  const std::string* set = source.OverrideOf("repetitions");
  return {.key = key, .values = list.items(), .set = set == nullptr ? "" : *set};
}

constexpr std::string_view kFile = "glove.motion.file";
constexpr std::string_view kFiles = "glove.motion.files";

const YamlNode& MotionOf(const YamlNode& root) { return ChildOf(ChildOf(root, "glove"), "motion"); }

/// The files of a folder, or those that a pattern names, in the order of their names.
std::vector<std::string> FilesOf(const std::filesystem::path& path) {
  RefuseOutside(path);
  std::error_code none;
  const std::string pattern =
      std::filesystem::is_directory(path, none) ? (path / "*").string() : path.string();
  std::vector<std::string> files;
  glob_t found;
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      if (std::filesystem::is_regular_file(found.gl_pathv[i], none)) {
        files.emplace_back(found.gl_pathv[i]);
      }
    }
  }
  globfree(&found);
  return files;
}

/// Adds `glove.motion.files` as the list that it is short for.
void ReadFiles(const YamlNode& root, const YamlSource& source,
               std::vector<RepeatedSetting>& lists) {
  const YamlNode& motion = MotionOf(root);
  const YamlNode& files = ChildOf(motion, "files");
  if (!files.IsDefined()) return;
  const auto fail = [&](const std::string& problem) {
    throw source.At(files, controller::SettingError(std::string(kFiles), problem));
  };
  const std::string* set = source.OverrideOf(std::string(kFiles));
  if (ChildOf(motion, "file").IsDefined()) {
    const bool one_for_all = set == nullptr && source.OverrideOf(std::string(kFile)) != nullptr;
    if (one_for_all) return;
    fail("and file cannot both be given");
  }
  RepeatedSetting list{.key = std::string(kFile), .values = {}, .set = set == nullptr ? "" : *set};
  if (files.IsScalar()) {
    if (files.text().empty()) fail("is empty, must be a list of files, a folder or a pattern");
    const std::filesystem::path base =
        set == nullptr ? source.file.parent_path() : std::filesystem::current_path();
    for (const std::string& file : FilesOf(std::filesystem::absolute(base / files.text()))) {
      list.values.push_back(YamlNode::Scalar(file));
    }
    if (list.values.empty()) {
      fail(fmt::format("{}: there is no such file", OneLine(files.text())));
    }
  } else {
    list = ReadList(source, std::string(kFiles), files);
    list.key = kFile;
    list.set = set == nullptr ? "" : *set;
  }
  if (set != nullptr) {  // in the place of those of the scenario
    std::erase_if(lists, [](const RepeatedSetting& other) { return other.key == kFile; });
  }
  for (const RepeatedSetting& other : lists) {
    if (IsAtOrBelow(list.key, other.key)) {
      fail(fmt::format("and values of {} in repetitions cannot both be given", other.key));
    }
    if (other.values.size() != list.values.size()) {
      fail(fmt::format("has {} values, {} has {}: each replicate takes one of every list",
                       list.values.size(), other.key, other.values.size()));
    }
  }
  lists.push_back(std::move(list));
}

/// Why one controller, with one calibration, does not serve both gloves; empty if it does.
std::string WhyNotAlike(const GloveConfig& first, const GloveConfig& other) {
  if (other.rate_hz != first.rate_hz) {
    return fmt::format("glove.rate_hz is {}, in the first {}", other.rate_hz, first.rate_hz);
  }
  if (ChannelsOf(other) != ChannelsOf(first)) return "glove.channels are others than in the first";
  const controller::GloveCalibration a = NominalCalibration(first);
  const controller::GloveCalibration b = NominalCalibration(other);
  const bool same = controller::ConvertersOf(a) == controller::ConvertersOf(b) &&
                    a.low_counts == b.low_counts && a.high_counts == b.high_counts &&
                    a.low_angle_rad == b.low_angle_rad && a.high_angle_rad == b.high_angle_rad;
  return same ? ""
              : "glove.converter, glove.sensor or the column map need another calibration than the "
                "first";
}

}  // namespace

void Repetitions::Rotate(int steps) {
  const int count = static_cast<int>(gloves.size());
  if (count == 0) return;
  const int first = ((steps % count) + count) % count;
  std::rotate(gloves.begin(), gloves.begin() + first, gloves.end());
}

std::vector<RepeatedSetting> ReadRepetitions(const YamlNode& root, const YamlSource& source) {
  std::vector<RepeatedSetting> lists;
  if (!root.IsMap()) return lists;
  RefuseSetOfOneList(source);
  for (const auto& entry : root.entries()) {
    if (entry.first.text() != "repetitions" || entry.second.IsNull()) continue;
    if (!entry.second.IsMap()) {
      Fail(source, entry.second, "", "must be settings of the glove, each with a list of values");
    }
    if (!lists.empty()) Fail(source, entry.first, "", "is given twice");
    std::size_t count = 0;
    for (const auto& list : entry.second.entries()) {
      if (!list.first.IsScalar()) Fail(source, list.first, "", "must have texts as keys");
      const std::string key = OneLine(list.first.text());
      CheckKey(source, list.first, key, lists);
      lists.push_back(ReadList(source, key, list.second));
      const std::size_t size = lists.back().values.size();
      if (count == 0) count = size;
      if (size == count) continue;
      Fail(source, list.second, key,
           fmt::format("has {} values, {} has {}: each replicate takes one of every list", size,
                       lists.front().key, count));
    }
  }
  std::erase_if(lists, [&source](const RepeatedSetting& list) {
    return source.OverrideOf(list.key) != nullptr;
  });
  ReadFiles(root, source, lists);
  return lists;
}

void RemoveRepetitions(YamlNode& root) {
  root = WithoutChild(root, "repetitions");
  const YamlNode& motion = MotionOf(root);
  if (!ChildOf(motion, "files").IsDefined()) return;
  root = WithChild(root, "glove",
                   WithChild(ChildOf(root, "glove"), "motion", WithoutChild(motion, "files")));
}

void PutRepetition(const std::vector<RepeatedSetting>& lists, std::size_t i, ListsFrom from,
                   YamlNode& root, YamlSource& source) {
  for (const RepeatedSetting& list : lists) {
    if (list.set.empty() != (from == ListsFrom::kFile)) continue;
    const YamlNode& value = list.values[i];
    const std::string place =
        list.set.empty() ? source.PlaceOf(value, list.key) : OverridePlace(list.set);
    const std::string path = PutOver(root, list.key, value, place, source);
    if (!list.set.empty()) source.overrides[path] = list.set;
  }
}

void CheckRepetitions(const std::vector<RepeatedSetting>& lists, const Repetitions& repetitions,
                      const YamlSource& source) {
  for (std::size_t i = 1; i < repetitions.gloves.size(); ++i) {
    std::string problem;
    try {
      repetitions.gloves[i].noise.Check();
      repetitions.gloves[i].converter.Check();
      problem = WhyNotAlike(repetitions.gloves.front(), repetitions.gloves[i]);
    } catch (const controller::SettingError& error) {
      throw source.At(lists.front().values[i],
                      controller::SettingError("glove." + error.key(), error.problem()));
    }
    if (problem.empty()) continue;
    Fail(source, lists.front().values[i], "",
         fmt::format("in replicate {} {}; one controller must fit all", i + 1, problem));
  }
}

namespace {

void Emit(const YamlNode& node, YAML::Emitter& emitter) {
  if (node.IsMap()) {
    emitter << YAML::BeginMap;
    for (const auto& [key, value] : node.entries()) {
      emitter << YAML::Key << key.text() << YAML::Value;
      Emit(value, emitter);
    }
    emitter << YAML::EndMap;
  } else if (node.IsSequence()) {
    if (std::ranges::all_of(node.items(), &YamlNode::IsScalar)) emitter << YAML::Flow;
    emitter << YAML::BeginSeq;
    for (const YamlNode& item : node.items()) Emit(item, emitter);
    emitter << YAML::EndSeq;
  } else {
    emitter << node.text();
  }
}

}  // namespace

std::string RepetitionsToYaml(const Repetitions& repetitions, const std::filesystem::path& folder) {
  std::vector<YamlNode> gloves;
  for (GloveConfig glove : repetitions.gloves) {  // a copy: a visitor may change what it sees
    gloves.push_back(ParseOwnYaml(SettingsToYaml(
        [&glove](controller::SettingsVisitor& visitor) { glove.Visit(visitor); }, folder)));
  }
  YAML::Emitter emitter;
  emitter << YAML::BeginMap << YAML::Key << "repetitions" << YAML::Value << YAML::BeginMap;
  for (const std::string& key : repetitions.keys) {
    emitter << YAML::Key << key << YAML::Value << YAML::BeginSeq;
    for (const YamlNode& glove : gloves) Emit(NodeAt(glove, key.substr(kGlove.size())), emitter);
    emitter << YAML::EndSeq;
  }
  emitter << YAML::EndMap << YAML::EndMap;
  return std::string(emitter.c_str()) + "\n";
}

}  // namespace gauntlet::sim
