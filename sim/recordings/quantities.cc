#include "sim/recordings/quantities.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "controller/number.h"
#include "sim/tables/name_words.h"

namespace gauntlet::sim {
namespace {

using Words = std::vector<std::string>;

/// Words that a sensor of a finger may have besides the finger and its joint.
constexpr std::string_view kBendWords =
    "flex flexion extension stretch bend bending finger joint angle ang sensor hand deviation dev "
    "ulnar "
    "radial supination";

/// A name taken apart.
struct NameParts {
  Words stem;        // the rest
  std::string part;  // finger or part of the arm; empty: none
  bool is_arm = false;
  std::string side;         // left or right
  bool is_joint = false;    // has a word of a joint or of bending
  std::string axes;         // "xyz", "wxyz", "rpy": it is one of these of a vector
  std::string vector = {};  // name without the axis
  std::optional<double> number = std::nullopt;
};

NameParts PartsOf(const std::string& name) {
  NameParts parts;
  bool is_spread = false;
  for (const std::string& word : WordsOf(name)) {
    is_spread = is_spread || IsSpread(word);
    std::string_view part = FingerOf(word);
    if (part.empty()) part = ArmPartOf(word);
    const bool is_joint = !JointOf(word).empty() || IsSpread(word) || HasWordOf({word}, kBendWords);
    if (!part.empty()) {
      if (parts.part.empty()) {
        parts.part = part;
        parts.is_arm = FingerOf(word).empty();
      }
    } else if (!SideOf(word).empty() && parts.side.empty()) {
      parts.side = SideOf(word);
    } else if (std::isdigit(static_cast<unsigned char>(word.front())) != 0) {
      parts.number = controller::ParseNumber(word);
    } else {
      parts.is_joint = parts.is_joint || is_joint;
      parts.stem.push_back(word);
    }
  }
  if (parts.part.empty() && is_spread) parts.part = "fingers";  // finger_spread
  return parts;
}

std::string TextOf(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// The name with the axis replaced, and the axis: the last letter of a word, or a word of turning.
using AxisKey = std::pair<std::string, char>;
std::vector<AxisKey> AxisKeysOf(const std::string& name) {
  std::vector<AxisKey> keys;
  Words words = WordsOf(name);
  for (std::string& word : words) {
    const std::string whole = word;
    const char last = word.back();
    if (std::string_view("wxyz").find(last) != std::string_view::npos && word.size() < 5) {
      word.back() = '?';
      keys.emplace_back(TextOf(words), last);
    }
    for (const auto& [turn, axis] : {std::pair("roll", 'r'), {"pitch", 'p'}, {"yaw", 'q'}}) {
      if (whole != turn) continue;
      word = "??";
      keys.emplace_back(TextOf(words), axis);
    }
    word = whole;
  }
  return keys;
}

/// True if a word of the name is x or y.
bool IsAxisAlone(const std::string& name) { return HasWordOf(WordsOf(name), "x y"); }

/// Marks columns that are components of a vector, a quaternion or of roll, pitch and yaw.
void MarkVectors(std::span<const ColumnEvidence> columns, std::vector<NameParts>& parts) {
  std::map<std::string, std::set<char>> axes;
  for (const ColumnEvidence& column : columns) {
    for (const auto& [key, axis] : AxisKeysOf(column.name)) axes[key].insert(axis);
  }
  const auto has = [&axes](const std::string& key, std::string_view all) {
    return std::ranges::all_of(all, [&](char axis) { return axes[key].contains(axis); });
  };
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (const auto& [key, axis] : AxisKeysOf(columns[c].name)) {
      const bool is_turn = std::string_view("rpq").find(axis) != std::string_view::npos;
      // Wrist pitch and yaw alone are joints of a glove.
      const bool is_joint = !has(key, "rpq") && !parts[c].part.empty();
      if (is_turn && !is_joint && (has(key, "pq") || has(key, "rp"))) {
        parts[c].axes = "rpy";
      } else if (!is_turn && has(key, "xyz")) {
        parts[c].axes = has(key, "wxyz") ? "wxyz" : "xyz";
      } else if (!is_turn && has(key, "xy") && IsAxisAlone(columns[c].name)) {
        parts[c].axes = "xy";  // points of an image
      } else {
        continue;
      }
      parts[c].vector = key;
      break;
    }
  }
}

/// The words of a vector's name without the axis: `ax` and `Acc_X` have an acceleration's.
Words StemOfVector(const std::string& key) {
  static const std::map<std::string, std::string> kShort = {
      {"a?", "acc"}, {"g?", "gyro"}, {"m?", "mag"}, {"q?", "quat"}, {"p?", "pos"}, {"v?", "vel"}};
  Words stem;
  for (const std::string& word : WordsOf(key)) stem.push_back(word);
  for (const auto& [text, word] : kShort) {
    const std::size_t place = key.find(text);
    const bool is_word = place != std::string::npos && (place == 0 || key[place - 1] == ' ');
    if (is_word) stem.push_back(word);
  }
  return stem;
}

/// `index` alone, or as in `episode_index`, is a number. It is a finger beside other fingers, or
/// with a word of bending.
void CheckIndexFinger(std::vector<NameParts>& parts) {
  std::map<std::string, std::set<std::string>> fingers;
  for (const NameParts& part : parts) {
    if (!part.part.empty()) fingers[TextOf(part.stem)].insert(part.part);
  }
  for (NameParts& part : parts) {
    if (part.part != "index" || part.is_joint || fingers[TextOf(part.stem)].size() > 1) continue;
    part.part.clear();
    part.stem.emplace_back("index");
  }
}

std::vector<NameParts> PartsOfAll(std::span<const ColumnEvidence> columns) {
  std::vector<NameParts> parts;
  for (const ColumnEvidence& column : columns) parts.push_back(PartsOf(column.name));
  CheckIndexFinger(parts);
  MarkVectors(columns, parts);
  for (NameParts& part : parts) {
    if (!part.axes.empty()) part.stem = StemOfVector(part.vector);
    const bool is_letter = part.stem.size() == 1 && part.stem[0].size() == 1;
    if (is_letter && part.axes.empty() && !part.number) part.stem = {"abc"};  // a, b, c, ..
    if (part.part.empty()) continue;
    std::erase_if(part.stem, [&part](const std::string& word) {
      return HasWordOf({word}, kBendWords) || IsSpread(word) ||
             (part.axes.empty() && !JointOf(word).empty());
    });
  }
  return parts;
}

// --- Facts ---------------------------------------------------------------------------------------

/// Correlation of a column that never falls with the times or, without them, numbers of its rows.
double ClockCorrelation(const ColumnEvidence& column, std::span<const double> row_time_s) {
  constexpr std::size_t kFewestRows = 8;
  if (column.values.size() < kFewestRows || column.statistics.falling_share > 0.0) return 0.0;
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  const double first = column.statistics.low;
  for (std::size_t i = 0; i < column.values.size(); ++i) {
    const double time = row_time_s.empty() ? static_cast<double>(i) : row_time_s[i];
    const double value = column.values[i] - first;
    if (!std::isfinite(value) || !std::isfinite(time)) continue;
    n += 1.0;
    x += time;
    y += value;
    xx += time * time;
    yy += value * value;
    xy += time * value;
  }
  const double spread = (n * xx - x * x) * (n * yy - y * y);
  return spread > 0.0 ? (n * xy - x * y) / std::sqrt(spread) : 0.0;
}

bool IsCounting(const ColumnStatistics& is) {
  constexpr double kNearlyAll = 0.98;
  constexpr double kFew = 0.01;
  constexpr double kMostChanges = 0.9;  // are by 1
  return is.is_whole && is.low < is.high && is.counting_share >= kNearlyAll &&
         is.falling_share <= kFew &&
         is.counting_share - is.still_share > kMostChanges * (1.0 - is.still_share);
}

/// Few different values, each for many rows.
bool HoldsRuns(const ColumnStatistics& is) {
  constexpr std::size_t kMostLabels = 60;
  constexpr double kChangesPerRow = 0.05;
  return is.is_whole && is.values <= kMostLabels && 1.0 - is.still_share < kChangesPerRow &&
         is.good_rows > 20;
}

/// Mean and relative spread of the norm over the columns.
void AddNorm(std::span<const ColumnEvidence> columns, const std::vector<std::size_t>& of,
             FamilyFacts& facts) {
  const std::size_t rows = columns[of.front()].values.size();
  double sum = 0.0, squares = 0.0, n = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    double square = 0.0;
    for (const std::size_t c : of) {
      square += i < columns[c].values.size() ? columns[c].values[i] * columns[c].values[i] : 0.0;
    }
    if (!std::isfinite(square)) continue;
    sum += std::sqrt(square);
    squares += square;
    n += 1.0;
  }
  if (n < 2.0 || sum == 0.0) return;
  facts.norm = sum / n;
  facts.norm_spread = std::sqrt(std::max(squares / n - facts.norm * facts.norm, 0.0)) / facts.norm;
}

/// Adds a column that has values.
void AddColumn(const ColumnStatistics& is, FamilyFacts& facts) {
  facts.is_whole = facts.is_whole && is.is_whole;
  facts.is_counting = facts.is_counting && IsCounting(is);
  facts.holds_runs = facts.holds_runs && HoldsRuns(is);
  if (is.turns > 0) facts.turning_span = std::max(facts.turning_span, is.high - is.low);
  facts.turns += is.turns;
  facts.full_percent += is.low == 0.0 && is.high == 100.0 ? 1 : 0;
  const double reach = std::max(std::abs(is.usual_low), std::abs(is.usual_high));
  facts.near_zero += is.usual_low < 0.1 * reach ? 1 : 0;
  if (is.low == is.high) return;
  ++facts.moving;
  facts.low = std::min(facts.low, is.usual_low);
  facts.high = std::max(facts.high, is.usual_high);
  if (is.deviation > 0.0) facts.roughness = std::min(facts.roughness, is.noise / is.deviation);
}

/// True if the moving columns are all of whole numbers or none is, and are of one size.
bool AreEven(std::span<const ColumnEvidence> columns, const std::vector<std::size_t>& of) {
  constexpr double kLargestRatio = 50.0;
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  std::size_t moving = 0, whole = 0;
  for (const std::size_t c : of) {
    const ColumnStatistics& is = columns[c].statistics;
    if (is.good_rows == 0 || is.low == is.high) continue;
    const double reach = std::max(std::abs(is.usual_low), std::abs(is.usual_high));
    least = std::min(least, reach);
    most = std::max(most, reach);
    if (is.is_whole && reach <= 1.0) continue;  // a share at its ends
    ++moving;
    whole += is.is_whole ? 1 : 0;
  }
  return (whole == 0 || whole == moving) && most <= kLargestRatio * least;
}

FamilyFacts FactsOf(std::span<const ColumnEvidence> columns, const std::vector<std::size_t>& of,
                    const NameParts& parts, std::span<const double> row_time_s) {
  FamilyFacts facts;
  facts.words = parts.stem;
  facts.axes = parts.axes == "xyz"    ? std::string_view("xyz")
               : parts.axes == "xy"   ? std::string_view("xy")
               : parts.axes == "wxyz" ? std::string_view("wxyz")
               : parts.axes == "rpy"  ? std::string_view("rpy")
                                      : std::string_view();
  facts.names_fingers = !parts.part.empty();
  facts.names_arm = parts.is_arm;
  facts.names_joints = std::ranges::any_of(of, [&](std::size_t c) {
    const Words words = WordsOf(columns[c].name);
    return std::ranges::any_of(words, [](const std::string& w) { return !JointOf(w).empty(); }) ||
           HasWordOf(words, "position positions pos qpos joint joints");
  });
  facts.columns = of.size();
  facts.low = facts.roughness = std::numeric_limits<double>::infinity();
  facts.high = -facts.low;
  facts.is_empty = true;
  for (const std::size_t c : of) {
    facts.is_text = facts.is_text || columns[c].is_text;
    if (columns[c].statistics.good_rows == 0) continue;
    facts.is_empty = false;
    AddColumn(columns[c].statistics, facts);
  }
  if (facts.moving == 0) {
    const ColumnStatistics& is = columns[of.front()].statistics;
    facts.low = is.low;
    facts.high = is.high;
    facts.roughness = 0.0;
  }
  facts.reach = std::max(std::abs(facts.low), std::abs(facts.high));
  facts.is_even = AreEven(columns, of);
  if (of.size() == 1) facts.clock_correlation = ClockCorrelation(columns[of.front()], row_time_s);
  if (of.size() > 1) AddNorm(columns, of, facts);
  return facts;
}

bool IsHeld(const QuantityRule& rule, const FamilyFacts& facts) {
  return (rule.words.empty() || HasWordOf(facts.words, rule.words)) && rule.holds(facts);
}

/// `is_sensor`: only the unit is not known.
void Decide(ColumnFamily& family, bool is_sensor) {
  for (const QuantityRule& rule : QuantityRules()) {
    if (!IsHeld(rule, family.facts) || (is_sensor && rule.quantity != Quantity::kSensor)) continue;
    family.quantity = rule.quantity;
    family.unit = rule.unit;
    family.is_assumed = rule.is_assumed;
    family.rule = rule.key;
    family.why = rule.reason;
    return;
  }
}

// --- Groups --------------------------------------------------------------------------------------

/// True for a column that is something by itself, whatever the columns beside it are.
bool IsApart(std::span<const ColumnEvidence> columns, std::size_t c, const NameParts& parts,
             std::span<const double> row_time_s) {
  const ColumnEvidence& column = columns[c];
  if (column.is_text || column.is_time || column.statistics.good_rows == 0) return true;
  // `index` of pandas beside `thumb`, `index`, .. is a counter.
  const bool may_count = parts.part.empty() || WordsOf(column.name).size() == 1;
  if (!may_count) return false;
  return IsCounting(column.statistics) || (parts.part.empty() && parts.axes.empty() &&
                                           ClockCorrelation(column, row_time_s) > 0.9999);
}

struct Group {
  NameParts parts;
  std::vector<std::size_t> columns;
  bool is_time = false;
};

/// The number of columns from `c` on, 4 or 3, that have a constant norm of 1 together; else 0.
std::size_t UnitNormFrom(std::span<const ColumnEvidence> columns, std::size_t c,
                         const std::vector<bool>& is_free) {
  for (const std::size_t width : {std::size_t{4}, std::size_t{3}}) {
    if (c + width > columns.size()) continue;
    std::vector<std::size_t> of(width);
    std::iota(of.begin(), of.end(), c);
    if (!std::ranges::all_of(of, [&](std::size_t k) { return is_free[k]; })) continue;
    const FamilyFacts facts = FactsOf(columns, of, {}, {});
    // One that hardly moves would make any others beside it small.
    if (facts.moving < 2 || facts.norm_spread > 0.01 || std::abs(facts.norm - 1.0) > 0.03) continue;
    return width;
  }
  return 0;
}

/// Largest magnitude of the moving columns, and whether all have whole numbers.
std::pair<double, bool> SizeOf(std::span<const ColumnEvidence> columns,
                               const std::vector<std::size_t>& of) {
  std::pair<double, bool> size = {0.0, true};
  for (const std::size_t c : of) {
    const ColumnStatistics& is = columns[c].statistics;
    if (is.low == is.high) continue;
    size.first = std::max({size.first, std::abs(is.usual_low), std::abs(is.usual_high)});
    size.second = size.second && is.is_whole;
  }
  return size;
}

/// The arm has a family of its own if its values have another size than those of the fingers.
void SplitArms(std::span<const ColumnEvidence> columns, const std::vector<NameParts>& parts,
               std::vector<Group>& groups) {
  constexpr double kOtherSize = 5.0;
  for (std::size_t g = 0, count = groups.size(); g < count; ++g) {
    Group arm = groups[g];
    Group fingers = groups[g];
    std::erase_if(arm.columns, [&](std::size_t c) { return !parts[c].is_arm; });
    std::erase_if(fingers.columns, [&](std::size_t c) { return parts[c].is_arm; });
    if (arm.columns.empty() || fingers.columns.empty()) continue;
    const auto [arm_size, arm_is_whole] = SizeOf(columns, arm.columns);
    const auto [finger_size, finger_is_whole] = SizeOf(columns, fingers.columns);
    if (arm_is_whole == finger_is_whole && arm_size < kOtherSize * finger_size &&
        finger_size < kOtherSize * arm_size) {
      continue;
    }
    arm.parts = parts[arm.columns.front()];
    fingers.parts = parts[fingers.columns.front()];
    groups[g] = fingers;
    groups.push_back(arm);
  }
}

std::vector<Group> GroupsOf(std::span<const ColumnEvidence> columns,
                            std::span<const double> row_time_s) {
  const std::vector<NameParts> parts = PartsOfAll(columns);
  std::vector<Group> groups;
  std::vector<bool> is_free(columns.size(), false);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (IsApart(columns, c, parts[c], row_time_s)) {
      NameParts alone = parts[c];
      if (!alone.part.empty()) alone.stem.push_back(std::exchange(alone.part, ""));
      groups.push_back({alone, {c}, columns[c].is_time});
    } else {
      is_free[c] = true;
    }
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!is_free[c] || !parts[c].stem.empty() || !parts[c].part.empty()) continue;
    const std::size_t width = UnitNormFrom(columns, c, is_free);
    if (width == 0) continue;
    Group& group = groups.emplace_back();
    for (std::size_t k = c; k < c + width; ++k) {
      group.columns.push_back(k);
      is_free[k] = false;
    }
  }
  std::map<std::tuple<std::string, std::string, std::string, bool>, std::size_t> group_of;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!is_free[c]) continue;
    const auto key =
        std::tuple(TextOf(parts[c].stem), parts[c].side, parts[c].axes, !parts[c].part.empty());
    const auto [found, is_new] = group_of.try_emplace(key, groups.size());
    if (is_new) groups.push_back({parts[c], {}});
    groups[found->second].columns.push_back(c);
  }
  SplitArms(columns, parts, groups);
  return groups;
}

/// In the order of the numbers in their names, if all have different ones.
void SortByNumbers(std::span<const ColumnEvidence> columns, std::vector<std::size_t>& of) {
  std::map<double, std::size_t> by_number;
  for (const std::size_t c : of) {
    const NameParts parts = PartsOf(columns[c].name);
    if (!parts.number || !parts.part.empty()) return;
    by_number[*parts.number] = c;
  }
  if (by_number.size() != of.size()) return;
  of.clear();
  for (const auto& [number, c] : by_number) of.push_back(c);
}

}  // namespace

ColumnFamily FamilyOfSensors(std::span<const ColumnEvidence> columns,
                             const std::vector<std::size_t>& sensors) {
  const std::vector<NameParts> parts = PartsOfAll(columns);
  NameParts common = parts[sensors.front()];
  common.axes.clear();
  for (const std::size_t c : sensors) {
    if (common.part.empty()) common.part = parts[c].part;
  }
  ColumnFamily family;
  family.columns = sensors;
  SortByNumbers(columns, family.columns);
  family.stem = TextOf(common.stem);
  family.facts = FactsOf(columns, family.columns, common, {});
  Decide(family, true);
  return family;
}

std::vector<ColumnFamily> FindFamilies(std::span<const ColumnEvidence> columns,
                                       std::span<const double> row_time_s) {
  std::vector<ColumnFamily> families;
  for (Group& group : GroupsOf(columns, row_time_s)) {
    SortByNumbers(columns, group.columns);
    ColumnFamily& family = families.emplace_back();
    family.stem = TextOf(group.parts.stem);
    family.side = group.parts.side;
    family.facts = FactsOf(columns, group.columns, group.parts, row_time_s);
    family.columns = std::move(group.columns);
    if (group.is_time) {
      family.quantity = Quantity::kTime;
    } else {
      Decide(family, false);
    }
  }
  return families;
}

}  // namespace gauntlet::sim
