#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::sim {

/// Facts by which a file of a device is known. Empty: not one of them.
struct ProfileMatch {
  std::vector<std::string> names =
      {};                            // of columns, all of them; case and punctuation do not count
  std::vector<double> columns = {};  // of numbers, besides times and counters; two: from, to
  std::vector<double> values = {};   // lowest and highest possible value of a joint
  bool whole = false;                // only whole numbers
  std::vector<std::string> format = {};  // as in ProfileFacts: one of these

  void Visit(controller::SettingsVisitor& visitor);
};

/// Description of what a device or a program writes: a column map, and how a file of it is known.
struct Profile {
  std::string name = {};  // of the file, without its ending
  std::string device = {};
  std::vector<std::string> source = {};
  ProfileMatch match = {};
  std::string map =
      {};  // the text of a column map; columns by name, or by the number of the sensor
  std::string example = {};  // rows in the shape of a file of it

  void Visit(controller::SettingsVisitor& visitor);
};

/// Facts about a table that profiles look at.
struct ProfileFacts {
  struct Column {
    std::string name;
    double low = 0.0;  // of columns that a profile names without their rarest values
    double high = 0.0;
    bool is_whole = true;
  };
  std::vector<Column> columns = {};     // of numbers, besides times and counters
  std::vector<std::string> names = {};  // of all columns
  std::string format = {};  // text, json, mat, hdf5, npy, parquet, mcap, bag, echo or other
  double duration_s = 0.0;
};

/// Values that a profile does not have.
struct OtherValues {
  double low = 0.0;
  double high = 0.0;
  bool are_bytes = false;  // whole numbers where rows of the profile have fractions
};
/// Range of the joints of a profile if it is not the profile's: values are beyond it, or over a
/// second or more so small that another unit is as likely, or whole numbers where the profile's
/// rows have fractions. Angles below 7 deg may be radians.
std::optional<OtherValues> ValuesAgainst(const Profile& profile, const ProfileFacts& table);

/// Evidence that a table is of a profile.
enum class ProfileEvidence {
  kNone,         // a fact of the profile is not true of the table
  kOneFact,      // no more than one fact is true: the profile may be asked for
  kOtherValues,  // all facts but ValuesAgainst(): in another unit, or of another device
  kKnown,        // names and another fact; or number, values and format of columns without names
};
ProfileEvidence EvidenceFor(const Profile& profile, const ProfileFacts& table);

/// Errors: UserError with file, line and column.
Profile ReadProfile(const std::filesystem::path& file);

/// All profiles, by name: those beside the recording (NAME.profile.yaml), those of the user
/// (gauntlet/profiles/NAME.yaml in $XDG_CONFIG_HOME or ~/.config), and Gauntlet's own
/// (scenarios/maps). Of two with one name the first counts. `recording` may be empty.
/// Errors: UserError for a file that is no profile.
std::vector<Profile> AllProfiles(const std::filesystem::path& recording);

/// The file of a profile with this name, in the places of AllProfiles() without a recording; empty
/// if there is none.
std::filesystem::path FileOfProfile(std::string_view name);

/// Letters and digits are the same, whatever their case and what stands between them. `_rad` behind
/// them is not compared: columns of a JointState get it, also where a driver writes degrees.
bool IsSameName(std::string_view one, std::string_view other);

}  // namespace gauntlet::sim
