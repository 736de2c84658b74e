#include "sim/recordings/profile.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <system_error>

#include "sim/base/csv_line.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
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

/// Names of the columns that drive a joint by the map of a profile.
std::vector<std::string> JointColumns(const Profile& profile) {
  std::vector<std::string> names;
  for (const std::string_view line : SplitLines(profile.map)) {
    const auto cells = SplitCells(line);
    const bool is_joint =
        cells.size() > 1 && cells[0] != "column" && cells[1] != "ignore" && cells[1] != "time";
    if (is_joint) names.emplace_back(cells[0]);
  }
  return names;
}

/// Values of the joints of a profile.
struct JointValues {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  double widest = 0.0;  // range of a column
  bool is_whole = true;
};

/// Profiles without names are of all columns.
JointValues ValuesOf(const Profile& profile, const ProfileFacts& table) {
  JointValues values;
  const std::vector<std::string> names = JointColumns(profile);
  for (const ProfileFacts::Column& column : table.columns) {
    const bool is_joint =
        profile.match.names.empty() || std::ranges::any_of(names, [&](const std::string& name) {
          return IsSameName(name, column.name);
        });
    if (!is_joint) continue;
    values.low = std::min(values.low, column.low);
    values.high = std::max(values.high, column.high);
    values.widest = std::max(values.widest, column.high - column.low);
    values.is_whole = values.is_whole && column.is_whole;
  }
  return values;
}

constexpr double kMostRad = 7.0;  // a turn, and a little

double ReachOf(double low, double high) { return std::max(std::abs(low), std::abs(high)); }

/// True for values so much smaller than the largest of the profile that another unit is as likely.
/// A hand at rest has whole counts near 0; of bytes, both ends are open or closed hands.
bool AreTooSmall(const JointValues& values, double largest) {
  constexpr double kLargestByte = 255.0;
  constexpr double kLargestJoint_deg = 110.0;
  constexpr double kMotion_deg = 20.0;
  const double reach = ReachOf(values.low, values.high);
  if (largest <= kMostRad || values.widest == 0.0) return false;
  if (reach < kMostRad) return !values.is_whole;
  return largest >= kLargestByte && reach <= kLargestJoint_deg && values.widest >= kMotion_deg &&
         (largest == kLargestByte || !values.is_whole);
}

/// True for whole numbers in motion where rows of the profile have fractions: raw bytes under the
/// names of angles, as drivers publish both. Counts beside angles of a frame are none.
bool AreBytes(const JointValues& values, const Profile& profile) {
  constexpr double kMotion = 20.0;
  constexpr double kMostDeg = 200.0;
  const ProfileMatch& match = profile.match;
  if (match.names.empty() || ReachOf(match.values.front(), match.values.back()) > kMostDeg) {
    return false;
  }
  if (!values.is_whole || values.low < 0.0 || values.widest < kMotion) return false;
  const auto lines = SplitLines(profile.example);
  if (lines.empty()) return false;
  const auto cells = SplitCells(lines.back());
  const auto fractions = std::ranges::count_if(
      cells, [](std::string_view cell) { return cell.find('.') != cell.npos; });
  return 2 * fractions > std::ssize(cells);
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

std::optional<OtherValues> ValuesAgainst(const Profile& profile, const ProfileFacts& table) {
  constexpr double kEnough_s = 1.0;
  const ProfileMatch& match = profile.match;
  const JointValues values = ValuesOf(profile, table);
  if (!(values.low <= values.high)) return std::nullopt;
  bool are_bytes = false;
  bool is_against = match.whole && !values.is_whole;
  if (!match.values.empty()) {
    const double largest = ReachOf(match.values.front(), match.values.back());
    const bool is_judged = table.duration_s >= kEnough_s;
    is_against = is_against || !IsWithin(values.low, match.values) ||
                 !IsWithin(values.high, match.values) ||
                 (is_judged && AreTooSmall(values, largest));
    are_bytes = is_judged && AreBytes(values, profile);
  }
  if (!is_against && !are_bytes) return std::nullopt;
  return OtherValues{values.low, values.high, are_bytes};
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
  const bool fits = !ValuesAgainst(profile, table);
  count(!match.values.empty() || match.whole, fits);
  count(!match.format.empty(), std::ranges::find(match.format, table.format) != match.format.end());
  if (!match.names.empty()) {
    const bool has_names = std::ranges::all_of(match.names, [&](const std::string& name) {
      return std::ranges::any_of(table.names,
                                 [&](const std::string& other) { return IsSameName(name, other); });
    });
    if (has_names && held == given && held > 0) return ProfileEvidence::kKnown;
    if (has_names && !fits && held + 1 == given) return ProfileEvidence::kOtherValues;
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
