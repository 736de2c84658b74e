#include "sim/recordings/profile.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/settings/yaml_reader.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".yaml";
constexpr std::string_view kEndingBeside = ".profile.yaml";

fs::path UserFolder() {
  const char* config = std::getenv("XDG_CONFIG_HOME");
  if (config != nullptr && *config != '\0') return fs::path(config) / "gauntlet/profiles";
  const char* home = std::getenv("HOME");
  return home == nullptr || *home == '\0' ? fs::path()
                                          : fs::path(home) / ".config/gauntlet/profiles";
}

/// Files of a folder with this ending, by name.
std::vector<fs::path> FilesIn(const fs::path& folder, std::string_view ending) {
  std::vector<fs::path> files;
  std::error_code missing;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, missing)) {
    if (entry.path().filename().string().ends_with(ending)) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

std::string NameOf(const fs::path& file) {
  const std::string name = file.filename().string();
  const bool is_beside = name.ends_with(kEndingBeside);
  return name.substr(0, name.size() - (is_beside ? kEndingBeside : kEnding).size());
}

bool IsWithin(double value, const std::vector<double>& range) {
  return value >= range.front() && value <= range.back();
}

/// True if all columns that the profile is about fit its values.
bool FitsValues(const ProfileMatch& match, const ProfileFacts& table) {
  return std::ranges::all_of(table.columns, [&](const ProfileFacts::Column& column) {
    const bool is_meant =
        match.names.empty() || std::ranges::any_of(match.names, [&](const std::string& name) {
          return IsSameName(name, column.name);
        });
    return !is_meant || ((match.values.empty() || (IsWithin(column.low, match.values) &&
                                                   IsWithin(column.high, match.values))) &&
                         (!match.whole || column.is_whole));
  });
}

}  // namespace

void ProfileMatch::Visit(controller::SettingsVisitor& visitor) {
  visitor.Texts({"names", "names of columns, all of them"}, names);
  visitor.Numbers({"columns", "number of columns, or the least and the most", 1, 100000}, columns);
  visitor.Numbers({"values", "lowest and highest possible value"}, values);
  visitor.Flag({"whole", "only whole numbers"}, whole);
  visitor.Texts({"format", "format of the file, or several"}, format);
}

void Profile::Visit(controller::SettingsVisitor& visitor) {
  visitor.Text({.key = "device", .help = "what writes such files", .required = true}, device);
  visitor.Texts({.key = "source", .help = "where the facts are from", .required = true}, source);
  visitor.Group({"match", "facts by which a file is known"},
                [this](controller::SettingsVisitor& inner) { match.Visit(inner); });
  visitor.Text({.key = "map", .help = "a column map", .required = true}, map);
  visitor.Text({"example", "rows in the shape of a file"}, example);
}

bool IsSameName(std::string_view one, std::string_view other) {
  constexpr std::string_view kRad = "_rad";
  const auto bare = [&](std::string_view name) {
    return BareName(name.ends_with(kRad) ? name.substr(0, name.size() - kRad.size()) : name);
  };
  return bare(one) == bare(other);
}

ProfileEvidence EvidenceFor(const Profile& profile, const ProfileFacts& table) {
  const ProfileMatch& match = profile.match;
  std::size_t given = 0, held = 0;
  const auto count = [&](bool is_given, bool is_held) {
    given += is_given ? 1 : 0;
    held += is_given && is_held ? 1 : 0;
  };
  count(
      !match.columns.empty(),
      !match.columns.empty() && IsWithin(static_cast<double>(table.columns.size()), match.columns));
  count(!match.values.empty() || match.whole, FitsValues(match, table));
  count(!match.format.empty(), std::ranges::find(match.format, table.format) != match.format.end());
  if (!match.names.empty()) {
    const bool has_names = std::ranges::all_of(match.names, [&](const std::string& name) {
      return std::ranges::any_of(table.names,
                                 [&](const std::string& other) { return IsSameName(name, other); });
    });
    if (has_names && held == given && held > 0) return ProfileEvidence::kKnown;
    // The same device without its names, or with others.
    return held == given || has_names ? ProfileEvidence::kOneFact : ProfileEvidence::kNone;
  }
  if (held < given) return ProfileEvidence::kNone;
  constexpr std::size_t kAll = 3;
  const bool is_exact = held == kAll && match.columns.front() == match.columns.back();
  return is_exact ? ProfileEvidence::kKnown : ProfileEvidence::kOneFact;
}

Profile ReadProfile(const fs::path& file) {
  auto profile = ReadAll<Profile>(file);
  profile.name = NameOf(file);
  for (const std::vector<double>* range : {&profile.match.columns, &profile.match.values}) {
    if (range->size() > 2 || !std::ranges::is_sorted(*range)) {
      throw UserError({.place = file.string(),
                       .problem = "match: columns and values are a number, or two that rise"});
    }
  }
  return profile;
}

std::vector<Profile> AllProfiles(const fs::path& recording) {
  std::vector<fs::path> files;
  if (!recording.empty()) {
    files = FilesIn(fs::absolute(recording).parent_path(), kEndingBeside);
  }
  for (const fs::path& folder : {UserFolder(), DataFolder("scenarios") / "maps"}) {
    const std::vector<fs::path> more = FilesIn(folder, kEnding);
    files.insert(files.end(), more.begin(), more.end());
  }
  std::vector<Profile> profiles;
  for (const fs::path& file : files) {
    if (std::ranges::find(profiles, NameOf(file), &Profile::name) != profiles.end()) continue;
    profiles.push_back(ReadProfile(file));
  }
  std::ranges::sort(profiles, {}, &Profile::name);
  return profiles;
}

fs::path FileOfProfile(std::string_view name) {
  std::error_code unreadable;
  const fs::path file = fs::path(name).filename().concat(kEnding);
  if (file.filename().string() != std::string(name).append(kEnding)) return {};
  for (const fs::path& folder : {UserFolder(), DataFolder("scenarios") / "maps"}) {
    if (fs::exists(folder / file, unreadable)) return folder / file;
  }
  return {};
}

}  // namespace gauntlet::sim
