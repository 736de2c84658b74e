#include "sim/recordings/quantities.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "controller/number.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

using Words = std::vector<std::string>;

/// Words that a sensor of a finger may have besides the finger and its joint.
constexpr std::string_view kBendWords =
    "flex flexion extension stretch bend bending curl closure finger joint angle ang sensor hand "
    "deviation dev ulnar radial supination";

/// A name taken apart.
struct NameParts {
  Words stem;        // the rest
  std::string part;  // finger or part of the arm; empty: none
  bool is_arm = false;
  std::string side;       // left or right
  bool is_joint = false;  // has a word of a joint or of bending
  char axis = '\0';       // w, x, y, z, or r, p, q for roll, pitch, yaw
  std::string axis_word;
  std::string_view axes;  // "xyz", "xy", "wxyz", "rpy": it is one of these of a vector
  std::optional<double> number = std::nullopt;
};

/// Takes a component of a vector from a name: `x`, `ax`, `yaw`. False for other words.
bool TakeAxis(const std::string& word, NameParts& parts) {
  constexpr std::array<Meaning, 6> kShort = {{{"acc", "a acc"},
                                              {"gyro", "g gyr gyro"},
                                              {"mag", "m mag"},
                                              {"quat", "q rot"},
                                              {"pos", "p pos tip"},
                                              {"vel", "v vel"}}};
  constexpr std::array<Meaning, 3> kTurns = {{{"r", "roll"}, {"p", "pitch"}, {"q", "yaw"}}};
  const bool has_axis = std::string_view("wxyz").find(word.back()) != std::string_view::npos;
  const std::string_view turn = MeaningOf(kTurns, word);
  const std::string_view vector =
      has_axis && word.size() > 1 ? MeaningOf(kShort, word.substr(0, word.size() - 1)) : "";
  if (turn.empty() && vector.empty() && !(has_axis && word.size() == 1)) return false;
  parts.axis = turn.empty() ? word.back() : turn.front();
  parts.axis_word = word;
  if (!vector.empty()) parts.stem.emplace_back(vector);
  return true;
}

NameParts PartsOf(const std::string& name) {
  NameParts parts;
  bool is_spread = false;
  for (const std::string& word : WordsOf(name)) {
    is_spread = is_spread || IsSpread(word);
    std::string_view part = FingerOf(word);
    if (part.empty()) part = ArmPartOf(word);
    if (!part.empty()) {
      if (parts.part.empty()) {
        parts.part = part;
        parts.is_arm = FingerOf(word).empty();
      }
    } else if (!SideOf(word).empty() && parts.side.empty()) {
      parts.side = SideOf(word);
    } else if (std::isdigit(static_cast<unsigned char>(word.front())) != 0) {
      parts.number = controller::ParseNumber(word);
    } else if (!TakeAxis(word, parts)) {
      parts.is_joint =
          parts.is_joint || !JointOf(word).empty() || IsSpread(word) || IsWordOf(kBendWords, word);
      parts.stem.push_back(word);
    }
  }
  if (parts.part.empty() && is_spread) parts.part = "fingers";  // finger_spread
  return parts;
}

std::string TextOf(const Words& words) { return fmt::format("{}", fmt::join(words, " ")); }

/// Marks components of a vector, a quaternion or of roll, pitch and yaw, if the table has the
/// others.
void MarkVectors(std::vector<NameParts>& parts) {
  const auto key = [](const NameParts& of) {
    return std::tuple(TextOf(of.stem), of.part, of.side, of.number);
  };
  std::map<decltype(key(parts[0])), std::set<char>> found;
  for (const NameParts& part : parts) found[key(part)].insert(part.axis);
  for (NameParts& part : parts) {
    const std::set<char>& axes = found[key(part)];
    const auto has = [&axes](std::string_view all) {
      return std::ranges::all_of(all, [&axes](char axis) { return axes.contains(axis); });
    };
    const bool is_turn = std::string_view("rpq").find(part.axis) != std::string_view::npos;
    // Wrist pitch and yaw alone are joints of a glove.
    const bool is_joint = !part.part.empty() && !has("rpq");
    if (part.axis != '\0' && is_turn && !is_joint && (has("pq") || has("rp"))) {
      part.axes = "rpy";
    } else if (part.axis != '\0' && !is_turn && has("xy")) {
      part.axes = has("wxyz") ? "wxyz" : has("z") ? "xyz" : "xy";
    } else if (part.axis != '\0') {
      part.is_joint = part.is_joint || is_turn;
      part.stem.push_back(part.axis_word);
    }
  }
}

std::vector<NameParts> PartsOfAll(std::span<const ColumnEvidence> columns) {
  std::vector<NameParts> parts;
  bool has_other_finger = false;
  for (const ColumnEvidence& column : columns) {
    parts.push_back(PartsOf(column.name));
    const NameParts& of = parts.back();
    has_other_finger = has_other_finger || (!of.part.empty() && !of.is_arm && of.part != "index");
  }
  if (!parts.empty()) MarkVectors(parts);
  for (NameParts& part : parts) {
    // `index` alone, or as in `episode_index`, is a number.
    if (part.part == "index" && !part.is_joint &&
        (!has_other_finger || HasWordOf(part.stem, "frame episode task sample row"))) {
      part.part.clear();
      part.stem.emplace_back("index");
    }
    const bool is_letter = part.stem.size() == 1 && part.stem[0].size() == 1;
    if (is_letter && part.axes.empty() && !part.number && part.part.empty())
      part.stem = {"abc"};  // a, b, c, ..
    if (part.part.empty()) continue;
    std::erase_if(part.stem, [&part](const std::string& word) {
      return IsWordOf(kBendWords, word) || IsSpread(word) ||
             (part.axes.empty() && !JointOf(word).empty());
    });
  }
  return parts;
}

// --- Facts ---------------------------------------------------------------------------------------

bool IsCounting(const ColumnStatistics& is) {
  constexpr double kNearlyAll = 0.98;
  constexpr double kFew = 0.01;
  constexpr double kMostChanges = 0.9;  // are by 1
  return is.is_whole && is.low < is.high && is.counting_share >= kNearlyAll &&
         is.falling_share <= kFew &&
         is.counting_share - is.still_share > kMostChanges * (1.0 - is.still_share);
}

/// Adds a column that has values.
void AddColumn(const ColumnStatistics& is, FamilyFacts& facts) {
  facts.is_whole = facts.is_whole && is.is_whole;
  facts.is_counting = facts.is_counting && IsCounting(is);
  if (is.turns > 0) facts.turning_span = std::max(facts.turning_span, is.high - is.low);
  facts.turns += is.turns;
  facts.full_percent += is.low == 0.0 && is.high == 100.0 ? 1 : 0;
  if (is.low == is.high) return;
  ++facts.moving;
  facts.low = std::min(facts.low, is.usual_low);
  facts.high = std::max(facts.high, is.usual_high);
  facts.least_reach =
      std::min(facts.least_reach, std::max(std::abs(is.usual_low), std::abs(is.usual_high)));
}

FamilyFacts FactsOf(std::span<const ColumnEvidence> columns, const std::vector<std::size_t>& of,
                    const NameParts& parts) {
  FamilyFacts facts;
  facts.words = parts.stem;
  facts.axes = parts.axes;
  facts.names_fingers = !parts.part.empty();
  facts.names_arm = parts.is_arm;
  facts.names_joints = std::ranges::any_of(of, [&](std::size_t c) {
    const Words words = WordsOf(columns[c].name);
    return std::ranges::any_of(words, [](const std::string& w) { return !JointOf(w).empty(); }) ||
           HasWordOf(words, "position positions pos qpos joint joints");
  });
  facts.columns = of.size();
  facts.low = facts.least_reach = std::numeric_limits<double>::infinity();
  facts.high = -facts.low;
  facts.is_empty = true;
  for (const std::size_t c : of) {
    facts.is_text = facts.is_text || columns[c].is_text;
    if (columns[c].statistics.good_rows == 0) continue;
    facts.is_empty = false;
    AddColumn(columns[c].statistics, facts);
  }
  if (facts.moving == 0) {
    facts.low = columns[of.front()].statistics.low;
    facts.high = columns[of.front()].statistics.high;
  }
  facts.reach = std::max(std::abs(facts.low), std::abs(facts.high));
  return facts;
}

/// `is_sensor`: only the unit is not known.
void Decide(ColumnFamily& family, bool is_sensor) {
  for (const QuantityRule& rule : QuantityRules()) {
    const bool has_word = rule.words.empty() || HasWordOf(family.facts.words, rule.words);
    const bool is_other = is_sensor && rule.quantity != Quantity::kSensor;
    if (!has_word || is_other || !rule.holds(family.facts)) continue;
    family.quantity = rule.quantity;
    family.unit = rule.unit;
    family.is_assumed = rule.is_assumed;
    family.rule = rule.key;
    family.why = rule.reason;
    return;
  }
}

/// In the order of the numbers in their names, if all have different ones.
void SortByNumbers(const std::vector<NameParts>& parts, std::vector<std::size_t>& of) {
  std::map<double, std::size_t> by_number;
  for (const std::size_t c : of) {
    if (!parts[c].number || !parts[c].part.empty()) return;
    by_number[*parts[c].number] = c;
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
  common.axes = {};
  for (const std::size_t c : sensors) {
    if (common.part.empty()) common.part = parts[c].part;
  }
  ColumnFamily family{.stem = TextOf(common.stem), .columns = sensors};
  SortByNumbers(parts, family.columns);
  family.facts = FactsOf(columns, family.columns, common);
  Decide(family, true);
  return family;
}

std::vector<ColumnFamily> FindFamilies(std::span<const ColumnEvidence> columns) {
  std::vector<NameParts> parts = PartsOfAll(columns);
  std::vector<std::vector<std::size_t>> groups;
  using Key = std::tuple<std::string, std::string, std::string_view, bool, bool>;
  std::map<Key, std::size_t> group_of;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    NameParts& part = parts[c];
    // `index` of pandas beside `thumb`, `index`, .. is a counter.
    const bool may_count = part.part.empty() || WordsOf(columns[c].name).size() == 1;
    const bool is_counter = may_count && IsCounting(columns[c].statistics);
    if (columns[c].is_text || columns[c].is_time || columns[c].statistics.good_rows == 0 ||
        is_counter) {
      if (!part.part.empty()) part.stem.push_back(std::exchange(part.part, ""));
      groups.push_back({c});
      continue;
    }
    const Key key(TextOf(part.stem), part.side, part.axes, !part.part.empty(), part.is_arm);
    const auto [found, is_new] = group_of.try_emplace(key, groups.size());
    if (is_new) groups.emplace_back();
    groups[found->second].push_back(c);
  }
  std::vector<ColumnFamily> families;
  for (std::vector<std::size_t>& group : groups) {
    const NameParts common = parts[group.front()];
    SortByNumbers(parts, group);
    ColumnFamily& family = families.emplace_back();
    family.stem = TextOf(common.stem);
    family.side = common.side;
    family.facts = FactsOf(columns, group, common);
    family.columns = std::move(group);
    if (columns[family.columns.front()].is_time) {
      family.quantity = Quantity::kTime;
    } else {
      Decide(family, false);
    }
  }
  return families;
}

}  // namespace gauntlet::sim
