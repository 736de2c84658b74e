#include "sim/recordings/inspect/joint_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>

#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/limited_text.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/recordings/column_scale.h"
#include "sim/recordings/keypoints/keypoint_layout.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/name_words.h"
#include "sim/tables/text_lines.h"

namespace gauntlet::sim {
namespace {

/// "columns 2, 4 to 6", from 1; of many parts the first.
std::string ColumnsText(std::vector<std::size_t> columns) {
  std::ranges::sort(columns);
  std::string text = columns.size() == 1 ? "column " : "columns ";
  constexpr int kMostParts = 4;
  for (std::size_t i = 0, part = 0; i < columns.size(); ++part) {
    if (part == kMostParts) return text + fmt::format(" .. ({} in all)", columns.size());
    std::size_t last = i;
    while (last + 1 < columns.size() && columns[last + 1] == columns[last] + 1) ++last;
    text += fmt::format("{}{}", i > 0 ? ", " : "", columns[i] + 1);
    if (last > i) text += fmt::format(" to {}", columns[last] + 1);
    i = last + 1;
  }
  return text;
}

constexpr std::size_t kMostMapBytes = 1'000'000;

void ChooseFamily(const ColumnFamily& family, JointChoice& choice) {
  choice.columns = family.columns;
  choice.joints.assign(family.columns.size(), {});
  choice.unit = family.unit;
  choice.unit_is_assumed = family.is_assumed;
  choice.unit_why = fmt::format("{} from {:.4g} to {:.4g}, {}",
                                family.facts.is_whole ? "whole numbers" : "numbers",
                                family.facts.low, family.facts.high, family.why);
  choice.high = family.facts.high;
}

/// A log of commands and of what was measured, and no glove. A command that is held for many rows
/// looks like a label: then a word of the measured columns must say that they answer.
bool IsCommandLog(std::span<const ColumnFamily> families) {
  constexpr std::string_view kAnswers = "state observation measured actual feedback present";
  const auto command_rule = std::ranges::find(QuantityRules(), "command", &QuantityRule::key);
  bool has_command = false, has_held = false, has_measured = false, has_answer = false;
  for (const ColumnFamily& family : families) {
    const std::vector<std::string>& words = family.facts.words;
    if (HasWordOf(words, "glove flex bend")) return false;
    if (family.facts.moving == 0) continue;
    if (HasWordOf(words, command_rule->words)) {
      has_held = true;
      has_command = has_command || family.quantity == Quantity::kCommand ||
                    HasWordOf(words, "action actions");
      continue;
    }
    has_answer = has_answer || HasWordOf(words, kAnswers);
    has_measured = has_measured || family.quantity == Quantity::kSensor ||
                   HasWordOf(words, kAnswers) || HasWordOf(words, "position current");
  }
  return (has_command && has_measured) || (has_held && has_answer);
}

/// "5 sensors", "1 sensor".
std::string SensorsText(std::size_t count) {
  return count == 1 ? "1 sensor" : fmt::format("{} sensors", count);
}

/// The table of a family alone: profiles without names are of the sensors only.
ProfileFacts FactsOfSensors(const JointEvidence& evidence, const ColumnFamily& family) {
  ProfileFacts facts = {.format = evidence.format};
  for (const std::size_t c : family.columns) {
    const ColumnStatistics& is = evidence.columns[c].statistics;
    facts.columns.push_back({evidence.columns[c].name, is.low, is.high, is.is_whole});
  }
  return facts;
}

/// Profiles for which this evidence is the given one, in their order.
std::vector<const Profile*> ProfilesWith(ProfileEvidence evidence, const ProfileFacts& table,
                                         const std::vector<Profile>& profiles, bool by_names) {
  std::vector<const Profile*> found;
  for (const Profile& profile : profiles) {
    if (profile.match.names.empty() == by_names) continue;
    if (EvidenceFor(profile, table) == evidence) found.push_back(&profile);
  }
  return found;
}

std::size_t NumberOfNames(const Profile* profile) { return profile->match.names.size(); }

std::vector<std::string> NamesOf(const std::vector<const Profile*>& profiles) {
  std::vector<std::string> names;
  for (const Profile* profile : profiles) names.push_back(profile->name);
  return names;
}

/// Unit in which a column's values are shown: that of the map's row.
RawUnit UnitOf(const ColumnMapping& mapping) {
  if (mapping.unit == RecordedUnit::kRadians) return RawUnit::kRadians;
  if (mapping.unit == RecordedUnit::kShare) return RawUnit::kShare;
  if (mapping.in_counts || mapping.unit == RecordedUnit::kCounts) return RawUnit::kCounts;
  if (!mapping.points) return RawUnit::kDegrees;
  const double full = std::max(std::abs(mapping.points->low), std::abs(mapping.points->high));
  const bool is_share = full == 1.0 || full == 100.0 || full == 1000.0;
  return is_share ? RawUnit::kShare : RawUnit::kUnknown;
}

/// Joints of a map. `columns`: those of the table that the map's columns are; empty: the same.
void ChooseByMap(const JointEvidence& evidence, const ColumnMap& map, JointBasis basis,
                 const std::string& why, const std::vector<std::size_t>& columns,
                 JointChoice& choice) {
  std::map<std::size_t, std::vector<ColumnMapping>> of_column;
  for (ColumnMapping mapping : map.channels) {
    if (!columns.empty() && mapping.column >= columns.size()) continue;
    if (!columns.empty()) mapping.column = columns[mapping.column];
    of_column[mapping.column].push_back(mapping);
  }
  for (const auto& [column, mappings] : of_column) {
    const ColumnEvidence& is = evidence.columns[column];
    if (is.is_text || is.statistics.good_rows == 0) continue;
    const Channel& joint = KnownChannels()[mappings.front().channel];
    choice.columns.push_back(column);
    choice.joints.push_back({std::string(joint.name), basis, why});
    choice.mappings.push_back(mappings);
    choice.unit = UnitOf(mappings.front());
    choice.high = std::max(choice.high, is.statistics.usual_high);
  }
  if (choice.columns.empty()) {
    throw UserError("the columns of the map's channels contain no numbers");
  }
  if (choice.unit == RawUnit::kUnknown) {  // two values of it are known, but not what it is
    choice.unit = FamilyOfSensors(evidence.columns, choice.columns).unit;
  }
  choice.unit_why = why;
}

/// The columns of a profile that numbers the sensors: those in the given range, else the family of
/// the right size.
const ColumnFamily& SensorsForProfile(const JointEvidence& evidence, const Profile& profile) {
  const std::vector<double>& width = profile.match.columns;
  std::size_t families = 0, found = 0;
  for (const ColumnFamily& family : evidence.families) {
    if (family.quantity != Quantity::kSensor) continue;
    const auto columns = static_cast<double>(family.columns.size());
    if (width.empty() || (columns >= width.front() && columns <= width.back())) return family;
    if (families++ == 0) found = family.columns.size();
  }
  const std::string needs =
      width.empty() ? fmt::format("{} needs sensors", profile.name)
      : width.front() == width.back()
          ? fmt::format("{} has {} sensors", profile.name, width.front())
          : fmt::format("{} has {} to {} sensors", profile.name, width.front(), width.back());
  throw UserError(fmt::format("{}, and {} of one kind {} found; --columns FIRST-LAST says which {}",
                              needs, found == 1 ? "1 column" : fmt::format("{} columns", found),
                              found == 1 ? "is" : "are", "the sensors are"));
}

/// True if the profile's columns are numbers of sensors.
bool CountsSensors(const Profile& profile) { return profile.match.names.empty(); }

void ChooseByProfile(const JointEvidence& evidence, const Profile& profile, JointBasis basis,
                     JointChoice& choice) {
  choice.profile = profile.name;
  const std::string why = "by the profile " + profile.name;
  if (!CountsSensors(profile)) {
    std::vector<std::string> names;
    for (const ColumnEvidence& column : evidence.columns) names.push_back(column.name);
    const ColumnMap map = MapOfProfile(
        profile, {.name = "the table", .header = names, .count = evidence.columns.size()});
    ChooseByMap(evidence, map, basis, why, {}, choice);
    return;
  }
  const ColumnFamily& sensors = SensorsForProfile(evidence, profile);
  constexpr std::size_t kMostSensors = 1000;  // a profile may be of more than the table has
  const ColumnMap map = MapOfProfile(profile, {.name = "the profile", .count = kMostSensors});
  ChooseByMap(evidence, map, basis, why, sensors.columns, choice);
}

bool IsAngle(RawUnit unit) {
  using enum RawUnit;
  return unit == kDegrees || unit == kRadians || unit == kMilliradians;
}

/// The joints of a profile, for a map in another unit. Offsets and signs of angles stay.
void UseOtherUnit(RawUnit unit, const std::string& why, JointChoice& choice) {
  const auto has_points = [](const std::vector<ColumnMapping>& mappings) {
    return mappings.front().points.has_value();
  };
  if (!IsAngle(unit) || !IsAngle(choice.unit) || std::ranges::any_of(choice.mappings, has_points)) {
    choice.mappings.clear();
  }
  for (std::vector<ColumnMapping>& mappings : choice.mappings) {
    for (ColumnMapping& mapping : mappings) {
      const bool is_rad = unit == RawUnit::kRadians,
                 was_rad = mapping.unit == RecordedUnit::kRadians;
      mapping.unit = unit == RawUnit::kRadians ? RecordedUnit::kRadians : RecordedUnit::kDegrees;
      if (is_rad != was_rad) mapping.offset *= is_rad ? kRadPerDeg : kDegPerRad;
      mapping.assumed += mapping.assumed.empty() ? "unit" : " unit";
    }
  }
  choice.unit = unit;
  choice.unit_is_assumed = true;
  choice.unit_why = why;
}

/// A unit as a person gives it.
RawUnit UnitNamed(const std::string& name) {
  using enum RawUnit;
  for (const RawUnit unit : {kDegrees, kRadians, kCounts, kVolts}) {
    if (name == NameOf(unit)) return unit;
  }
  return kShare;
}

/// For a question: the unit of joints by the size of their values.
RawUnit UnitBySize(const OtherValues& values) {
  constexpr double kMostShare = 1.05;
  constexpr double kMostRad = 7.0;
  constexpr double kMostDeg = 200.0;
  const double reach = std::max(std::abs(values.low), std::abs(values.high));
  return values.low >= 0.0 && reach <= kMostShare ? RawUnit::kShare
         : reach <= kMostRad                      ? RawUnit::kRadians
         : reach <= kMostDeg                      ? RawUnit::kDegrees
                                                  : RawUnit::kCounts;
}

/// The unit of a profile's values, as --unit has it.
std::string_view UnitOfProfile(const JointChoice& choice) {
  const ColumnMapping& mapping = choice.mappings.front().front();
  if (!mapping.points) return NameOf(UnitOf(mapping));
  const double full = std::max(std::abs(mapping.points->low), std::abs(mapping.points->high));
  return full <= 1.0 ? "share" : full == 100.0 ? "percent" : "counts";
}

/// The table of the columns that a profile took.
ProfileFacts FactsOfTaken(const JointEvidence& evidence, const Profile& profile,
                          const JointChoice& choice) {
  if (!CountsSensors(profile)) return FactsOf(evidence);
  ProfileFacts facts = {.duration_s = evidence.duration_s};
  for (const std::size_t c : choice.columns) {
    const ColumnStatistics& is = evidence.columns[c].statistics;
    facts.columns.push_back({evidence.columns[c].name, is.usual_low, is.usual_high, is.is_whole});
  }
  return facts;
}

/// Asks if the values of a profile, or the unit that a person gives, are not those of the file.
/// The unit of the profile, given, is an answer.
void CheckValues(const JointEvidence& evidence, const Profile& profile, const std::string& given,
                 JointChoice& choice) {
  const std::string_view own = UnitOfProfile(choice);
  if (given == own) return;
  if (!given.empty()) {
    choice.question =
        fmt::format("like {}, which has the unit {} and not {}", profile.name, own, given);
    UseOtherUnit(UnitNamed(given), "as given", choice);
    return;
  }
  const auto other = ValuesAgainst(profile, FactsOfTaken(evidence, profile, choice));
  if (!other) return;
  const std::vector<double>& values = profile.match.values;
  const RawUnit may_be = UnitBySize(*other);
  choice.question =
      fmt::format("like {}, but its joints have values from {:.3g} to {:.3g}{}", profile.name,
                  other->low, other->high, other->are_bytes ? " in whole numbers" : "");
  choice.question += values.empty() ? ", not whole numbers"
                                    : fmt::format(", where {} has {:g} to {:g}{}", profile.name,
                                                  values.front(), values.back(),
                                                  profile.match.whole ? " in whole numbers"
                                                  : other->are_bytes  ? " with fractions"
                                                                      : "");
  if (NameOf(may_be) != own) choice.question += fmt::format(": {}?", NameOf(may_be));
  choice.question += fmt::format("; --unit {0} if they are {0}", own);
  if (NameOf(may_be) != own || !IsAngle(may_be)) {
    UseOtherUnit(may_be, "by the size of the values, which are not the profile's", choice);
  }
}

/// Asks if the map of a profile takes the other hand than a person.
void CheckHand(const JointEvidence& evidence, const Profile& profile, const std::string& hand,
               JointChoice& choice) {
  const std::string other = hand == "left" ? "right" : "left";
  const bool takes_other = std::ranges::any_of(choice.columns, [&](std::size_t c) {
    return ReadJointName(evidence.columns[c].name).side == other;
  });
  if (hand.empty() || !takes_other) return;
  choice.question =
      fmt::format("the map of {} takes the {} hand; name the columns of the {} one in it",
                  profile.name, other, hand);
}

/// The unit of angles that the header of the file gives decides, unless the names say another. If
/// the file only has to have one (`angle`), the size of the values decides.
void UseUnitOfFile(const std::string& unit, ColumnFamily& family) {
  constexpr double kTurn_rad = 6.6;
  if (unit.empty() || family.rule.ends_with("_by_name") ||
      HasWordOf(family.facts.words, "activation excitation")) {
    return;
  }
  family.is_assumed = unit == "angle";
  const bool is_rad = family.is_assumed ? family.facts.reach < kTurn_rad : unit == "rad";
  family.unit = is_rad ? RawUnit::kRadians : RawUnit::kDegrees;
  family.why = family.is_assumed ? "angles whose unit the header of the file does not say"
                                 : "by the header of the file";
}

/// The unit that a person gives counts, whatever the file says.
void UseGivenUnit(const std::string& unit, ColumnFamily& family) {
  if (unit.empty()) return;
  family.unit = UnitNamed(unit);
  if (family.unit == RawUnit::kShare) family.facts.high = unit == "percent" ? 100.0 : 1.0;
  family.is_assumed = false;
  family.rule = "given";
  family.why = "as given";
}

Profile ProfileNamed(const std::string& name, const std::vector<Profile>& profiles) {
  const auto found = std::ranges::find(profiles, name, &Profile::name);
  if (found != profiles.end()) return *found;
  const std::filesystem::path file = name;
  if (file.extension() == ".yaml") return ReadProfile(file);
  if (file.extension() == ".csv") {  // a column map with numbers of sensors
    return {.name = name, .device = name, .map = LimitedText(InputFile(file), kMostMapBytes)};
  }
  std::vector<std::string> names;
  for (const Profile& profile : profiles) names.push_back(profile.name);
  throw UserError(
      {.place = "--preset",
       .problem = fmt::format("no profile {}{}", OneLine(name, 30), Suggestion(name, names))});
}

/// A family of columns of which it is known that they are sensors, in the unit of the file or of a
/// person, if one is given.
ColumnFamily InGivenUnit(const JointEvidence& evidence, const std::vector<std::size_t>& columns,
                         const std::string& given) {
  ColumnFamily family = FamilyOfSensors(evidence.columns, columns);
  UseUnitOfFile(evidence.angle_unit, family);
  UseGivenUnit(given, family);
  return family;
}

/// Joints beside these that may be in degrees where these may be in radians, or the other way.
std::vector<std::size_t> InOtherUnit(const JointEvidence& evidence, const JointChoice& choice) {
  const bool is_rad = choice.unit == RawUnit::kRadians;
  if (!choice.unit_is_assumed || (!is_rad && choice.unit != RawUnit::kDegrees)) return {};
  const RawUnit other_unit = is_rad ? RawUnit::kDegrees : RawUnit::kRadians;
  for (const ColumnFamily& other : evidence.families) {
    const bool is_joint = other.facts.names_fingers || other.facts.names_arm;
    if (other.quantity == Quantity::kSensor && other.unit == other_unit && is_joint &&
        std::ranges::find(choice.columns, other.columns.front()) == choice.columns.end()) {
      return other.columns;
    }
  }
  return {};
}

/// Columns that name a joint, by the words that the grammar does not have.
using NamedColumns = std::map<std::string, std::vector<std::size_t>>;

NamedColumns ColumnsWithJoints(const JointEvidence& evidence, const std::string& hand,
                               std::string& question) {
  NamedColumns named;
  bool has_left = false, has_right = false;
  for (const ColumnFamily& family : evidence.families) {
    if (family.quantity != Quantity::kSensor) continue;
    for (const std::size_t c : family.columns) {
      const JointName name = ReadJointName(evidence.columns[c].name);
      has_left = has_left || name.side == "left";
      has_right = has_right || name.side == "right";
      const bool is_asked = hand.empty() || name.side.empty() || name.side == hand;
      if (name.is_joint && is_asked) named[name.other].push_back(c);
    }
  }
  for (auto& [other, columns] : named) std::ranges::sort(columns);
  if (has_left && has_right && hand.empty()) {
    question =
        "holds both hands; gauntlet inspect --hand left or --hand right takes one, with "
        "--write-scenario for compare";
  }
  return named;
}

/// Columns that name fingers of which no exact name has a joint. `named` begins with the exact.
std::vector<std::size_t> FingersBeside(const JointEvidence& evidence, const NamedColumns& named) {
  const auto finger_of = [&](std::size_t c) {
    return ReadSensorName(evidence.columns[c].name).finger;
  };
  std::set<std::string> exact, others;
  for (const std::size_t c : named.begin()->second) exact.insert(finger_of(c));
  std::vector<std::size_t> beside;
  for (const auto& [other, columns] : named) {
    for (const std::size_t c : columns) {
      const ColumnStatistics& is = evidence.columns[c].statistics;
      const std::string finger = finger_of(c);
      if (finger.empty() || exact.contains(finger) || is.low == is.high) continue;
      others.insert(finger);
      beside.push_back(c);
    }
  }
  constexpr std::size_t kFewest = 2;  // one may be of another device
  return others.size() < kFewest ? std::vector<std::size_t>() : beside;
}

/// A sentence if the unit is in no name and no profile, and the values may be of several.
std::string UnitQuestion(const JointChoice& choice) {
  if (choice.unit != RawUnit::kUnknown) return "";
  return fmt::format("{}: {}; --unit deg, rad, counts, share, percent or volts says it",
                     ColumnsText(choice.columns), choice.unit_why);
}

/// Asks if names give the joints several units, or the values of those without one are of another.
/// The map then has the unit of each.
void CheckUnitsOfNames(const JointEvidence& evidence, JointChoice& choice) {
  std::map<std::string_view, std::vector<std::size_t>> of_rule;  // "": without a unit in the name
  for (const std::size_t c : choice.columns) {
    const std::string_view rule = FamilyOfSensors(evidence.columns, {c}).rule;
    of_rule[rule.ends_with("_by_name") || rule == "other_unit" ? rule : ""].push_back(c);
  }
  std::map<RawUnit, std::vector<std::size_t>> of_unit;
  for (const auto& [rule, columns] : of_rule) {
    std::vector<std::size_t>& all = of_unit[InGivenUnit(evidence, columns, "").unit];
    all.insert(all.end(), columns.begin(), columns.end());
  }
  if (of_unit.size() < 2) return;
  const auto& [unit, columns] = *of_unit.begin();
  const auto& [other_unit, others] = *std::next(of_unit.begin());
  choice.question =
      fmt::format("{} [{}] and {} [{}] have different units; a map says the unit of each",
                  ColumnsText(columns), NameOf(unit), ColumnsText(others), NameOf(other_unit));
  for (std::size_t i = 0; i < choice.columns.size(); ++i) {
    std::vector<ColumnMapping>& mappings = choice.mappings.emplace_back();
    const auto is_own = [&](const auto& entry) {
      return std::ranges::find(entry.second, choice.columns[i]) != entry.second.end();
    };
    const RawUnit own = std::ranges::find_if(of_unit, is_own)->first;
    if (choice.joints[i].channel.empty() || !IsAngle(own)) continue;
    mappings.push_back(
        {.column = choice.columns[i],
         .channel = ChannelIndex(choice.joints[i].channel),
         .unit = own == RawUnit::kDegrees ? RecordedUnit::kDegrees : RecordedUnit::kRadians,
         .scale = own == RawUnit::kMilliradians ? 1e-3 : 1.0});
  }
}

/// Joints whose names say that the values rise as the finger opens.
std::vector<std::size_t> OpeningJoints(const JointEvidence& evidence, const JointChoice& choice) {
  constexpr std::string_view kOpening = "open opening openness extension extended straightness";
  constexpr std::string_view kBending =
      "flex flexion bend bending close closing closed closure curl";
  std::vector<std::size_t> opening;
  for (std::size_t i = 0; i < choice.columns.size(); ++i) {
    const std::vector<std::string> words = WordsOf(evidence.columns[choice.columns[i]].name);
    if (choice.joints[i].channel.empty() || HasWordOf(words, kBending)) continue;
    if (HasWordOf(words, kOpening)) opening.push_back(choice.columns[i]);
  }
  return opening;
}

/// True if a question was asked or joints were found.
bool ChooseByNames(const JointEvidence& evidence, const JointOptions& options,
                   JointChoice& choice) {
  const NamedColumns named = ColumnsWithJoints(evidence, options.hand, choice.question);
  if (!choice.question.empty()) return true;
  if (named.empty()) return false;
  const auto& [other, columns] = *named.begin();  // exact names come first
  ChooseFamily(InGivenUnit(evidence, columns, options.unit), choice);
  if (!other.empty() && named.size() > 1) {
    choice.question = fmt::format("both {} and {} may be the joints", ColumnsText(columns),
                                  ColumnsText(std::next(named.begin())->second));
    return true;
  }
  if (const auto beside = FingersBeside(evidence, named); other.empty() && !beside.empty()) {
    choice.question =
        fmt::format("{} {} by name, and {} name other fingers", ColumnsText(columns),
                    columns.size() == 1 ? "is a joint" : "are joints", ColumnsText(beside));
    return true;
  }
  if (const auto beside = InOtherUnit(evidence, choice); !beside.empty()) {
    const bool is_rad = choice.unit == RawUnit::kRadians;
    choice.question =
        fmt::format("{} reads as rad and {} as deg; a map says the unit of each",
                    ColumnsText(is_rad ? columns : beside), ColumnsText(is_rad ? beside : columns));
    return true;
  }
  std::vector<std::string> names;
  for (const std::size_t c : choice.columns) names.push_back(evidence.columns[c].name);
  choice.joints = JointsByNames(names, choice.question);
  choice.asks_joints = true;
  const bool any_joint = std::ranges::any_of(
      choice.joints, [](const ColumnJoint& joint) { return !joint.channel.empty(); });
  if (!any_joint && choice.question.empty()) choice.question = "no name of a column is a joint's";
  if (choice.question.empty()) choice.question = UnitQuestion(choice);
  if (choice.question.empty() && options.unit.empty()) CheckUnitsOfNames(evidence, choice);
  if (const auto opening = OpeningJoints(evidence, choice);
      choice.question.empty() && !opening.empty()) {
    choice.question = fmt::format(
        "{} rise as the finger opens, by their names; a map says sign and offset, or "
        "raw_low of the open finger",
        ColumnsText(opening));
  }
  if (choice.question.empty() && evidence.is_translated) {
    choice.question =
        fmt::format("{} name fingers in another language; the map has the joints that they may be",
                    ColumnsText(choice.columns));
  }
  for (ColumnJoint& joint : choice.joints) {
    // A word that is not known may say that it is no angle of the joint.
    if (!other.empty()) joint.basis = JointBasis::kAssumed;
  }
  return true;
}

/// Profiles of sensors that may be among these columns, with clocks and labels beside them.
std::vector<const Profile*> OfAboutThisWidth(std::size_t columns,
                                             const std::vector<Profile>& profiles) {
  constexpr double kMostShare = 1.1;
  std::vector<const Profile*> found;
  for (const Profile& profile : profiles) {
    const std::vector<double>& width = profile.match.columns;
    if (!profile.match.names.empty() || width.empty()) continue;
    const auto count = static_cast<double>(columns);
    if (count >= width.front() && count <= kMostShare * width.back()) found.push_back(&profile);
  }
  return found;
}

/// True for as many values as x, y and z of 21, 25 or 26 points have, of one hand or two.
bool MayBePoints(std::size_t columns) {
  return std::ranges::any_of(std::array{63U, 75U, 78U, 126U, 150U, 156U},
                             [columns](std::size_t points) { return columns == points; });
}

/// True if the columns that move hardly have more than what changes from row to row.
bool AreRough(const JointEvidence& evidence, const std::vector<std::size_t>& columns) {
  constexpr double kRough = 0.12;  // of the range of values; white noise has 0.19
  std::size_t moving = 0, rough = 0;
  for (const std::size_t c : columns) {
    const ColumnStatistics& is = evidence.columns[c].statistics;
    const double range = is.usual_high - is.usual_low;
    moving += range > 0.0 ? 1 : 0;
    rough += range > 0.0 && (is.noise > kRough * range || is.slow < is.noise) ? 1 : 0;
  }
  return moving > 0 && rough == moving;
}

/// Joints of sensors without names.
void ChooseByNumber(const JointEvidence& evidence, const JointOptions& options,
                    const std::vector<Profile>& profiles, JointChoice& choice) {
  std::vector<const ColumnFamily*> sensors;
  for (const ColumnFamily& family : evidence.families) {
    if (family.quantity == Quantity::kSensor) sensors.push_back(&family);
  }
  // One that never moves is no rival of others.
  if (std::ranges::any_of(sensors, [](const auto* family) { return family->facts.moving > 0; })) {
    std::erase_if(sensors, [](const auto* family) { return family->facts.moving == 0; });
  }
  const ColumnFamily& family = *sensors.front();
  ChooseFamily(InGivenUnit(evidence, family.columns, options.unit), choice);
  if (sensors.size() > 1) {
    choice.question = fmt::format(
        "both {} and {} may be the joints; --columns FIRST-LAST says "
        "which",
        ColumnsText(family.columns), ColumnsText(sensors[1]->columns));
    return;
  }
  constexpr double kLargestRatio = 50.0;  // of sensors of one glove
  const bool is_even = family.facts.reach <= kLargestRatio * family.facts.least_reach;
  const bool may_be_ordered = std::ranges::all_of(family.facts.words, IsSensorWord) && is_even;
  const auto known =
      ProfilesWith(ProfileEvidence::kKnown, FactsOfSensors(evidence, family), profiles, false);
  if (may_be_ordered && known.size() == 1) {
    JointChoice by_profile;
    ChooseByProfile(evidence, *known.front(), JointBasis::kAssumed, by_profile);
    // Sensors without names may be in another order: the profile gives the joints, the file the
    // range.
    choice.profile = by_profile.profile;
    for (std::size_t i = 0; i < by_profile.columns.size(); ++i) {
      const auto place = std::ranges::find(choice.columns, by_profile.columns[i]);
      choice.joints[static_cast<std::size_t>(place - choice.columns.begin())] =
          by_profile.joints[i];
    }
    choice.question = UnitQuestion(choice);
    return;
  }
  choice.question = fmt::format(
      "{}: {} [{}], {}{}", ColumnsText(family.columns), SensorsText(family.columns.size()),
      NameOf(choice.unit), is_even ? "whose joints are unknown" : "of different sizes",
      family.columns.size() > 2 * KnownChannels().size() && !MayBePoints(family.columns.size())
          ? ", more than a hand has; if a row is a window of samples, write one sample "
            "a row"
          : "");
  if (MayBePoints(family.columns.size())) {
    choice.question +=
        "; x, y, z of the points of a hand are read by their names, landmark_0_x to landmark_20_z";
  }
  if (AreRough(evidence, family.columns)) {
    choice.question +=
        "; they change from row to row more than a hand does: of muscles they need envelope_ms in "
        "the map";
  }
  choice.asks_joints = true;
  constexpr std::size_t kMost = 4;  // more say nothing
  auto possible = known.empty() ? ProfilesWith(ProfileEvidence::kOneFact,
                                               FactsOfSensors(evidence, family), profiles, false)
                                : known;
  if (possible.empty() && !is_even) possible = OfAboutThisWidth(family.columns.size(), profiles);
  if (possible.size() <= kMost) choice.profiles_to_ask_for = NamesOf(possible);
}

/// Muscles of which a person may make channels.
void ChooseMuscles(std::span<const ColumnFamily> families, JointChoice& choice) {
  const auto is_muscle = [](const ColumnFamily& family) {
    return family.quantity == Quantity::kMuscle && family.facts.moving > 0;
  };
  const auto muscles = std::ranges::find_if(families, is_muscle);
  if (muscles == families.end()) return;
  ChooseFamily(*muscles, choice);
  choice.question = fmt::format("{}: {} of muscles; the joint that each is to move is unknown",
                                ColumnsText(muscles->columns),
                                muscles->columns.size() == 1 ? "activity" : "activities");
  choice.asks_joints = true;
}

/// Content of a table that has no sensors of a hand.
std::string WithoutSensors(const JointEvidence& evidence) {
  std::size_t positions = 0, in_plane = 0, rotations = 0;
  for (const ColumnFamily& family : evidence.families) {
    rotations += family.rule == "rotation_axes" ? family.columns.size() : 0;
    positions += family.quantity == Quantity::kPosition ? family.columns.size() : 0;
    in_plane += family.facts.axes == "xy" ? family.columns.size() : 0;
  }
  if (in_plane > 0 && in_plane == positions) {
    return "x and y without z are points in an image, which have no angles; world landmarks have "
           "x, y and z";
  }
  if (rotations > 0) {
    return fmt::format(
        "{} columns are rotations of bones about x, y and z; --map names those that bend a joint",
        rotations);
  }
  constexpr std::size_t kLeast = 9;  // of three points, the fewest that have an angle
  if (positions < kLeast) return "no column looks like a sensor of a hand";
  std::vector<std::string> names;
  for (const ColumnEvidence& column : evidence.columns) names.push_back(column.name);
  if (const std::string problem = FindKeypoints(names).problem; !problem.empty()) {
    return fmt::format("no angles without more keypoints: the table {}", problem);
  }
  return fmt::format(
      "{} columns are positions, not angles; points become angles if their names are a hand's: "
      "wrist_x, index_mcp_x .. little_tip_z, or the numbers 0 to 20",
      positions);
}

/// Joints by exact names that a profile leaves out, neither mapped nor ignored: then the file is of
/// another version of the device, or of another one.
std::vector<std::size_t> JointsBeside(const JointEvidence& evidence, const Profile& profile,
                                      const JointChoice& choice) {
  const auto is_known = [&profile](const std::string& name) {
    return std::ranges::any_of(SplitLines(profile.map), [&name](std::string_view line) {
      return IsSameName(std::string(line.substr(0, line.find(','))), name);
    });
  };
  std::vector<std::size_t> beside;
  for (std::size_t c = 0; c < evidence.columns.size(); ++c) {
    const ColumnEvidence& column = evidence.columns[c];
    const JointName name = ReadJointName(column.name);
    const bool is_joint = name.is_joint && name.other.empty() && !column.is_text &&
                          !column.is_time && column.statistics.good_rows > 0;
    const std::string channel = ReadSensorName(column.name).channel;
    if (!is_joint || channel.empty() || is_known(column.name)) continue;
    const bool is_mapped =
        std::ranges::find(choice.joints, channel, &ColumnJoint::channel) != choice.joints.end();
    if (!is_mapped) beside.push_back(c);
  }
  return beside;
}

}  // namespace

ProfileFacts FactsOf(const JointEvidence& evidence) {
  ProfileFacts facts = {.format = evidence.format, .duration_s = evidence.duration_s};
  for (const ColumnFamily& family : evidence.families) {
    for (const std::size_t c : family.columns) {
      facts.names.push_back(evidence.columns[c].name);
      using enum Quantity;
      const bool is_value = family.quantity != kText && family.quantity != kNothing &&
                            family.quantity != kTime && family.quantity != kNumber;
      const ColumnStatistics& is = evidence.columns[c].statistics;
      if (!is_value) continue;
      facts.columns.push_back({evidence.columns[c].name, is.usual_low, is.usual_high, is.is_whole});
    }
  }
  return facts;
}

JointChoice ChooseJoints(const JointEvidence& evidence, const JointOptions& options,
                         const std::optional<ColumnMap>& map,
                         const std::vector<Profile>& profiles) {
  JointChoice choice;
  if (map) {
    ChooseByMap(evidence, *map, JointBasis::kMap, "by the map", {}, choice);
    return choice;
  }
  if (!options.preset.empty()) {
    const Profile profile = ProfileNamed(options.preset, profiles);
    ChooseByProfile(evidence, profile, JointBasis::kProfile, choice);
    const std::string unit = options.unit == "percent" ? "share" : options.unit;
    if (unit.empty()) {
      CheckValues(evidence, profile, "", choice);
    } else if (unit != NameOf(choice.unit) && options.unit != UnitOfProfile(choice)) {
      throw UserError({.place = "--unit " + options.unit,
                       .problem = fmt::format("--preset {} has the unit {}; leave out one of them, "
                                              "or fill in a map",
                                              options.preset, UnitOfProfile(choice))});
    }
    return choice;
  }
  if (IsCommandLog(evidence.families)) {
    choice.is_command_log = true;
    choice.question = "a log of commands and measured angles, not of a glove";
    return choice;
  }
  auto known = ProfilesWith(ProfileEvidence::kKnown, FactsOf(evidence), profiles, true);
  const bool is_known = !known.empty();
  if (!is_known) {
    known = ProfilesWith(ProfileEvidence::kOtherValues, FactsOf(evidence), profiles, true);
  }
  // One that asks for more names is of the same maker's larger hand.
  std::ranges::stable_sort(known, std::ranges::greater(), NumberOfNames);
  if (is_known && known.size() > 1 && NumberOfNames(known[0]) == NumberOfNames(known[1])) {
    choice.question = "may be a file of several devices";
    choice.profiles_to_ask_for = NamesOf(known);
    return choice;
  }
  if (!known.empty()) {
    const Profile& profile = *known.front();
    ChooseByProfile(evidence, profile, JointBasis::kProfile, choice);
    CheckValues(evidence, profile, options.unit, choice);
    if (choice.question.empty()) CheckHand(evidence, profile, options.hand, choice);
    if (!choice.question.empty()) return choice;
    if (const auto beside = JointsBeside(evidence, profile, choice); !beside.empty()) {
      choice.question =
          fmt::format("like {}, but {}, which it does not have", profile.name,
                      ColumnsText(beside) + (beside.size() == 1 ? " is a joint by its name"
                                                                : " are joints by their names"));
      choice.profiles_to_ask_for = {profile.name};
    }
    return choice;
  }
  if (ChooseByNames(evidence, options, choice)) return choice;
  const bool has_sensors = std::ranges::any_of(evidence.families, [](const ColumnFamily& family) {
    return family.quantity == Quantity::kSensor;
  });
  if (has_sensors) {
    ChooseByNumber(evidence, options, profiles, choice);
    return choice;
  }
  ChooseMuscles(evidence.families, choice);
  if (choice.columns.empty()) choice.question = WithoutSensors(evidence);
  return choice;
}

}  // namespace gauntlet::sim
