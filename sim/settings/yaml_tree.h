#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "controller/settings.h"
#include "sim/base/error.h"
#include "sim/settings/yaml_node.h"

namespace gauntlet::sim {

/// Refused setting as the user's mistake at a place.
UserError AtPlace(std::string place, const controller::SettingError& error);

/// `--set key=value` as the place of a mistake.
std::string OverridePlace(std::string_view text);

/// Origin of values, for error messages: the file, and what --set put over it.
///
/// A path of keys has dots between keys and `[i]` for the items of a list: `filter[0].kind`.
struct YamlSource {
  std::filesystem::path file;
  std::map<std::string, std::string> overrides = {};  // path of keys -> text of the --set
  std::map<std::string, TextPlace> groups = {};       // those of the file that an override changed
  std::map<std::string, std::filesystem::path> included = {};  // path of keys -> its own file

  /// The file of what stands at this path: an included one, or `file`.
  const std::filesystem::path& FileOf(const std::string& path) const;

  /// The text of the --set that gave the value at this path; null if the file did.
  const std::string* OverrideOf(const std::string& path) const;
  /// `file:line:column` of a node, or `--set text` if an override gave it.
  std::string PlaceOf(const YamlNode& node, const std::string& path) const;
  /// The error at the place of its node.
  UserError At(const YamlNode& node, const controller::SettingError& error) const;
};

/// The text of a file. Errors: as of InputFile() and LimitedText(), for 4 MB.
std::string ReadYamlText(const std::filesystem::path& file);

/// `!include FILE`, and what is said of it where it may not stand.
inline constexpr std::string_view kIncludeTag = "!include";
inline constexpr std::string_view kMisplacedInclude =
    "!include stands for all settings of a controller in a scenario, "
    "controllers: {tuned: !include FILE}, and nowhere else";

/// Treatment of scalars with kIncludeTag in a text.
enum class YamlIncludes { kRefused, kAllowed };

/// The tree of a text. It is bounded: 64 levels, 200,000 values with those of aliases counted where
/// they are used.
/// Errors: UserError `file:line:column` for a syntax error, a byte that is not UTF-8, a control
/// character, an alias inside what it stands for, a tag, a second document, or a top level that is
/// not a map.
YamlNode ParseYaml(const std::filesystem::path& file, std::string_view text,
                   YamlIncludes includes = YamlIncludes::kRefused);

/// The tree of a text that SettingsToYaml() wrote, of any size.
YamlNode ParseOwnYaml(std::string_view text);

/// ParseYaml() of ReadYamlText().
YamlNode ParseYamlFile(const std::filesystem::path& file);

/// Puts `value` at the end of a path of keys over the tree, as ApplyOverride() does. `place` is
/// that of a mistake in the path. Errors: UserError. Returns the path as a reader has it.
std::string PutOver(YamlNode& root, const std::string& path, const YamlNode& value,
                    const std::string& place, YamlSource& source);

/// True if a path of keys is `group` or leads into it.
bool IsAtOrBelow(const std::string& path, const std::string& group);

/// Puts `key.path=value` over the tree. Groups on the way are copied, so that what an alias shares
/// with another group stays as it is there. Items of a list are named by their number from 0; a
/// list of one may be passed over. Errors: UserError for a text that is not an override, or leads
/// to an item or a controller that is not there.
void ApplyOverride(YamlNode& root, const std::string& text, YamlSource& source);

}  // namespace gauntlet::sim
