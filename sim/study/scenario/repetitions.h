#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/glove/glove_config.h"
#include "sim/settings/yaml_tree.h"

namespace gauntlet::sim {

/// Differences between the repetitions of a comparison: settings below `glove.` that have a list of
/// values. Repetition i is a whole glove, made with the i-th value of each list.
struct Repetitions {
  std::vector<std::string> keys;    // as "glove.motion.file", in the order of the file
  std::vector<GloveConfig> gloves;  // one per repetition; none: there are no lists

  /// The next repetition becomes the first, `steps` times. Below 0: the one before.
  void Rotate(int steps);
};

/// One list of `repetitions` as it was read.
struct RepeatedSetting {
  std::string key;
  std::vector<YamlNode> values;
  std::string set = {};  // text of the --set that gave it; empty: it stands in the file
};

/// The lists below `repetitions` that --set leaves in force: a --set of the same setting, or of a
/// group around it, is for all repetitions. `glove.motion.files`, a list of recordings, a folder or
/// a pattern (`monday/*.csv`) whose files are taken by name, is short for such a list of
/// glove.motion.file.
/// Errors: UserError for what is no map from keys below `glove.` to lists of one length, for a
/// --set of a part of it, and for files that there are not.
std::vector<RepeatedSetting> ReadRepetitions(const YamlNode& root, const YamlSource& source);

/// Takes all of that away, so that the tree has only what a scenario has.
void RemoveRepetitions(YamlNode& root);

/// Source of lists of values: the scenario's file, or --set.
enum class ListsFrom { kFile, kSet };

/// Puts the i-th value of each list from there over the tree, at the place where it stands.
void PutRepetition(const std::vector<RepeatedSetting>& lists, std::size_t i, ListsFrom from,
                   YamlNode& root, YamlSource& source);

/// Errors: UserError at the first repetition whose glove has another rate, other channels or
/// another nominal calibration than the first: one controller serves all.
void CheckRepetitions(const std::vector<RepeatedSetting>& lists, const Repetitions& repetitions,
                      const YamlSource& source);

/// As it stands in a scenario of `folder` (see SettingsToYaml()), each value as the glove of its
/// repetition has it.
std::string RepetitionsToYaml(const Repetitions& repetitions, const std::filesystem::path& folder);

}  // namespace gauntlet::sim
