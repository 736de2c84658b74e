#include "sim/recordings/inspect/joint_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <tuple>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/recordings/keypoints/keypoint_layout.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/name_words.h"

namespace gauntlet::sim {
namespace {

/// A glove by its number of sensors.
struct KnownGlove {
  std::size_t sensors;
  std::string_view preset;
  std::vector<RawUnit> units;  // of its values; empty: any
};

const std::vector<KnownGlove>& KnownGloves() {
  using enum RawUnit;
  static const std::vector<KnownGlove> kGloves = {{5, "flex5", {}},
                                                  {14, "5dt14", {kCounts, kShare}},
                                                  {18, "cyberglove18", {kCounts, kDegrees}},
                                                  {20, "manus20", {kDegrees}},
                                                  {22, "cyberglove22", {kCounts, kDegrees}}};
  return kGloves;
}

/// Channels by the number of the sensor, and whether all values must be angles.
struct Preset {
  std::vector<std::string> channels;  // empty: the sensor drives no joint
  std::size_t last_joint = 0;         // sensors up to the last one with a joint
  bool is_degrees = false;
};

Preset ReadPreset(const std::string& name) {
  const std::filesystem::path file = FileOfMap(name);
  CsvReader csv(file.string(), FileSource(file), ProblemHandling::kAllowMissing);
  std::vector<std::string> cells;
  Preset preset;
  while (csv.NextRow(cells)) {
    const auto number = static_cast<std::size_t>(csv.Number(cells.front(), 1));
    if (number < 1 || number > 1000) csv.Fail(1, "must be the number of a sensor");
    preset.channels.resize(std::max(preset.channels.size(), number));
    if (cells[1] == "ignore" || !preset.channels[number - 1].empty()) continue;
    preset.channels[number - 1] = cells[1];
    preset.last_joint = std::max(preset.last_joint, number);
    preset.is_degrees = preset.is_degrees || (cells.size() > 2 && cells[2] == "deg");
  }
  return preset;
}

std::string_view PresetFor(std::size_t sensors, RawUnit unit) {
  for (const KnownGlove& glove : KnownGloves()) {
    const bool has_unit =
        glove.units.empty() || std::ranges::find(glove.units, unit) != glove.units.end();
    if (glove.sensors == sensors && has_unit) return glove.preset;
  }
  return "";
}

bool IsAngle(RawUnit unit) { return unit == RawUnit::kDegrees || unit == RawUnit::kRadians; }

/// Larger is better: angle before share before counts.
int RankOf(RawUnit unit) {
  if (IsAngle(unit)) return 3;
  return unit == RawUnit::kShare ? 2 : 1;
}

auto QualityOf(const ColumnFamily& family) {
  return std::tuple(family.facts.names_fingers, family.facts.moving > 0, RankOf(family.unit));
}

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
bool IsCommandLog(const std::vector<ColumnFamily>& families) {
  constexpr std::string_view kAnswers = "state observation measured actual feedback present";
  const auto command_rule = std::ranges::find(QuantityRules(), "command", &QuantityRule::key);
  bool has_command = false, has_held = false, has_measured = false, has_answer = false;
  for (const ColumnFamily& family : families) {
    const std::vector<std::string>& words = family.facts.words;
    if (HasWordOf(words, "glove flex bend")) return false;
    if (family.facts.moving == 0) continue;
    if (HasWordOf(words, command_rule->words)) {
      has_held = true;
      has_command = has_command || family.quantity == Quantity::kCommand;
      continue;
    }
    has_answer = has_answer || HasWordOf(words, kAnswers);
    has_measured = has_measured || family.quantity == Quantity::kSensor ||
                   HasWordOf(words, kAnswers) || HasWordOf(words, "position current");
  }
  return (has_command && has_measured) || (has_held && has_answer);
}

/// Sensors of the asked hand. `question` receives a sentence if a file with both has none asked.
std::vector<const ColumnFamily*> SensorsOf(const std::vector<ColumnFamily>& families,
                                           const std::string& hand, std::string& question) {
  std::vector<const ColumnFamily*> sensors;
  bool has_left = false, has_right = false;
  for (const ColumnFamily& family : families) {
    if (family.quantity != Quantity::kSensor) continue;
    has_left = has_left || family.side == "left";
    has_right = has_right || family.side == "right";
    sensors.push_back(&family);
  }
  if (!has_left || !has_right) return sensors;
  if (hand.empty()) {
    question =
        "holds both hands; gauntlet inspect --hand left or --hand right takes one, with "
        "--write-scenario for compare";
  }
  std::erase_if(sensors, [&hand](const ColumnFamily* family) {
    return !hand.empty() && !family->side.empty() && family->side != hand;
  });
  return sensors;
}

/// The sensors that a preset is of: those in the given range, else the family of the right size.
ColumnFamily SensorsForPreset(const std::vector<ColumnFamily>& families, const Preset& preset,
                              const JointOptions& options) {
  const std::size_t most = preset.channels.size();
  const auto fits = [&](std::size_t width) { return width >= preset.last_joint && width <= most; };
  const std::string needs =
      preset.last_joint == most
          ? fmt::format("{} has {} sensors", options.preset, most)
          : fmt::format("{} has {} to {} sensors", options.preset, preset.last_joint, most);
  ColumnFamily all;
  for (const ColumnFamily& family : families) {
    if (family.quantity != Quantity::kSensor) continue;
    if (fits(family.columns.size())) return family;
    if (all.columns.empty()) all = family;
  }
  const std::size_t found = all.columns.size();
  throw UserError(fmt::format("{}, and {} of one kind {} found; --columns FIRST-LAST says which {}",
                              needs, found == 1 ? "1 column" : fmt::format("{} columns", found),
                              found == 1 ? "is" : "are", "the sensors are"));
}

void ChooseByPreset(const std::vector<ColumnFamily>& families, const JointOptions& options,
                    JointChoice& choice) {
  const Preset preset = ReadPreset(options.preset);
  const ColumnFamily sensors = SensorsForPreset(families, preset, options);
  if (preset.is_degrees && !IsAngle(sensors.unit)) {
    throw UserError(fmt::format("{} gives degrees, {} look like {} ({:.4g} to {:.4g})",
                                options.preset, ColumnsText(sensors.columns), NameOf(sensors.unit),
                                sensors.facts.low, sensors.facts.high));
  }
  ChooseFamily(sensors, choice);
  for (std::size_t i = 0; i < choice.joints.size(); ++i) {
    const std::string& channel = preset.channels[i];
    choice.joints[i] = {channel, JointBasis::kPreset,
                        channel.empty() ? fmt::format("sensor {} of {}, which drives no joint",
                                                      i + 1, options.preset)
                                        : fmt::format("sensor {} of {}", i + 1, options.preset)};
  }
}

/// Joints of a column map.
void ChooseByMap(const std::vector<ColumnFamily>& families, const ColumnMap& map,
                 JointChoice& choice) {
  std::map<std::size_t, int> channels;  // by column
  for (const ColumnMapping& mapping : map.channels) channels[mapping.column] = mapping.channel;
  const auto mapped = [&channels](const ColumnFamily& family) {
    return std::ranges::count_if(family.columns,
                                 [&](std::size_t c) { return channels.contains(c); });
  };
  const auto best = std::ranges::max_element(families, {}, mapped);
  if (best == families.end() || mapped(*best) == 0) {
    throw UserError("the columns of the map's channels contain no numbers");
  }
  ChooseFamily(*best, choice);
  choice.columns.clear();
  choice.joints.clear();
  for (const auto& [column, channel] : channels) {
    choice.columns.push_back(column);
    choice.joints.push_back(
        {std::string(KnownChannels()[channel].name), JointBasis::kMap, "by the map"});
  }
}

/// Joints by the number of the sensors, or a question.
void ChooseByNumber(const ColumnFamily& family, JointChoice& choice) {
  const std::string_view preset = PresetFor(family.columns.size(), family.unit);
  const bool is_beyond_all =
      family.is_assumed && family.unit == RawUnit::kCounts && family.facts.low < 0.0;
  const bool may_be_ordered =
      std::ranges::all_of(family.facts.words, IsSensorWord) && !is_beyond_all;
  if (preset.empty() || !may_be_ordered || !family.facts.is_even) {
    choice.question = fmt::format(
        "{}: {} [{}], {}", ColumnsText(family.columns),
        family.columns.size() == 1 ? "1 sensor" : fmt::format("{} sensors", family.columns.size()),
        NameOf(family.unit),
        family.facts.is_even ? "whose joints are unknown" : "of different sizes");
    return;
  }
  const Preset order = ReadPreset(std::string(preset));
  for (std::size_t i = 0; i < choice.joints.size(); ++i) {
    choice.joints[i] = {order.channels[i], JointBasis::kAssumed,
                        fmt::format("by the order of {}, which has as many sensors", preset)};
  }
}

/// Adds the family with parts of the arm, if it has the unit and the stem of the fingers'.
ColumnFamily WithArm(const ColumnFamily& fingers, const std::vector<const ColumnFamily*>& sensors) {
  ColumnFamily all = fingers;
  for (const ColumnFamily* family : sensors) {
    if (family->columns == fingers.columns || !family->facts.names_fingers ||
        family->stem != fingers.stem || family->unit != fingers.unit) {
      continue;
    }
    all.columns.insert(all.columns.end(), family->columns.begin(), family->columns.end());
    all.is_assumed = all.is_assumed && family->is_assumed;
  }
  return all;
}

/// Joints in degrees beside a family that is small enough for radians, and may be in either.
const ColumnFamily* InDegreesBeside(const ColumnFamily& family,
                                    const std::vector<const ColumnFamily*>& sensors) {
  if (!family.is_assumed || family.unit != RawUnit::kRadians) return nullptr;
  const auto found = std::ranges::find_if(sensors, [](const ColumnFamily* other) {
    return other->unit == RawUnit::kDegrees &&
           (other->facts.names_fingers || other->facts.names_arm);
  });
  return found == sensors.end() ? nullptr : *found;
}

bool IsRange(const std::vector<std::size_t>& columns) {
  return columns.back() - columns.front() + 1 == columns.size();
}

/// Joints of the best family. A question if none is best.
void ChooseBest(const std::vector<const ColumnFamily*>& sensors,
                const std::vector<std::string>& names, JointChoice& choice) {
  const auto best = std::ranges::max_element(sensors, {}, [](const ColumnFamily* family) {
    return std::tuple(QualityOf(*family), family->columns.size());
  });
  const ColumnFamily& family = **best;
  const auto is_equal = [&](const ColumnFamily* other) {
    return other != &family && QualityOf(*other) == QualityOf(family) && !other->facts.names_arm &&
           other->stem != family.stem;
  };
  const auto rival = std::ranges::find_if(sensors, is_equal);
  const ColumnFamily all = family.facts.names_fingers ? WithArm(family, sensors) : family;
  ChooseFamily(all, choice);
  if (rival != sensors.end()) {
    const bool is_range = IsRange(family.columns) && IsRange((*rival)->columns);
    choice.question = fmt::format("both {} and {} may be the joints{}", ColumnsText(family.columns),
                                  ColumnsText((*rival)->columns),
                                  is_range ? "; --columns FIRST-LAST says which" : "");
    return;
  }
  if (const ColumnFamily* in_deg = InDegreesBeside(family, sensors); in_deg != nullptr) {
    choice.question = fmt::format("{} reads as rad and {} as deg; a map says the unit of each",
                                  ColumnsText(family.columns), ColumnsText(in_deg->columns));
    return;
  }
  if (!family.facts.names_fingers) {
    ChooseByNumber(family, choice);
    return;
  }
  std::vector<std::string> own_names;
  const std::vector<std::string> finger_names = WithFingers(names);
  for (const std::size_t c : choice.columns) own_names.push_back(finger_names[c]);
  choice.joints = JointsByNames(own_names, choice.question);
  // A word that is not known may say that it is no angle of the joint.
  if (!std::ranges::all_of(family.facts.words, [](const std::string& word) {
        return IsSensorWord(word) || HasWordOf({word}, "pos position positions");
      })) {
    for (ColumnJoint& joint : choice.joints) joint.basis = JointBasis::kAssumed;
  }
  const bool any_joint = std::ranges::any_of(
      choice.joints, [](const ColumnJoint& joint) { return !joint.channel.empty(); });
  if (!any_joint && choice.question.empty()) choice.question = "no name of a column is a joint's";
}

/// Muscles of which a person may make channels.
void ChooseMuscles(const std::vector<ColumnFamily>& families, JointChoice& choice) {
  const auto is_muscle = [](const ColumnFamily& family) {
    return family.quantity == Quantity::kMuscle && family.facts.moving > 0;
  };
  const auto muscles = std::ranges::find_if(families, is_muscle);
  if (muscles == families.end()) return;
  ChooseFamily(*muscles, choice);
  choice.question = fmt::format("{}: {} of muscles; the joint that each is to move is unknown",
                                ColumnsText(muscles->columns),
                                muscles->columns.size() == 1 ? "activity" : "activities");
}

/// Content of a table that has no sensors of a hand.
std::string WithoutSensors(const std::vector<ColumnFamily>& families,
                           const std::vector<std::string>& names) {
  std::size_t positions = 0;
  for (const ColumnFamily& family : families) {
    positions += family.quantity == Quantity::kPosition ? family.columns.size() : 0;
  }
  constexpr std::size_t kLeast = 9;  // of three points, the fewest that have an angle
  if (positions < kLeast) return "no column looks like a sensor of a hand";
  if (const std::string problem = FindKeypoints(names).problem; !problem.empty()) {
    return fmt::format("no angles without more keypoints: the table {}", problem);
  }
  return fmt::format(
      "{} columns are positions, not angles; points become angles if their names are a hand's: "
      "wrist_x, index_mcp_x .. little_tip_z, or the numbers 0 to 20",
      positions);
}

}  // namespace

JointChoice ChooseJoints(const std::vector<ColumnFamily>& families,
                         const std::vector<std::string>& names, const JointOptions& options,
                         const std::optional<ColumnMap>& map) {
  JointChoice choice;
  if (map) {
    ChooseByMap(families, *map, choice);
    return choice;
  }
  if (!options.preset.empty()) {
    ChooseByPreset(families, options, choice);
    return choice;
  }
  if (IsCommandLog(families)) {
    choice.is_command_log = true;
    choice.question = "a log of commands and measured angles, not of a glove";
    return choice;
  }
  const auto sensors = SensorsOf(families, options.hand, choice.question);
  if (!choice.question.empty()) return choice;
  if (sensors.empty()) {
    ChooseMuscles(families, choice);
    if (choice.columns.empty()) choice.question = WithoutSensors(families, names);
    return choice;
  }
  ChooseBest(sensors, names, choice);
  return choice;
}

}  // namespace gauntlet::sim
