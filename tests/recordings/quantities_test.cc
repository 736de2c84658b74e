// Which quantity the columns of a file have: each rule decides a family of its own, and not one
// that is like it.
#include "sim/recordings/quantities.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAreArray;

using Formula = std::function<double(int row)>;
constexpr int kRows = 400;

double Swing(int row, int phase = 0) { return 0.5 + 0.5 * std::sin(0.05 * row + phase); }
double Noise(int row) {
  const double mixed = std::sin(12.9898 * row) * 43758.5453;
  return mixed - std::floor(mixed) - 0.5;
}
/// From `low` to `high` and back; `step` 0: continuous.
Formula Between(double low, double high, double step = 0.0, int phase = 0) {
  return [=](int row) {
    const double value = low + (high - low) * Swing(row, phase);
    return step > 0.0 ? step * std::round(value / step) : value;
  };
}
Formula Percent(int phase) {
  return [phase](int row) { return std::clamp(110.0 * Swing(row, phase) - 5.0, 0.0, 100.0); };
}
Formula Fixed(double value) {
  return [value](int) { return value; };
}
double NoValue(int) { return std::nan(""); }

struct TestColumn {
  std::string name;
  Formula value;
};

std::vector<ColumnFamily> FamiliesOf(const std::vector<TestColumn>& columns, bool is_text = false) {
  TableStatistics statistics(columns.size());
  for (int row = 0; row < kRows; ++row) {
    std::vector<double> values;
    for (const TestColumn& column : columns) values.push_back(column.value(row));
    statistics.Add(0.01 * row, values);
  }
  std::vector<ColumnEvidence> evidence;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    evidence.push_back(
        {.name = columns[c].name, .is_text = is_text, .statistics = statistics.Column(c)});
  }
  return FindFamilies(evidence);
}

struct RuleRow {
  std::string rule;
  std::vector<TestColumn> columns;    // one family, which this rule decides
  std::vector<TestColumn> otherwise;  // one family of the same kind, which another rule decides
};

std::vector<TestColumn> Fingers(const std::string& more, const Formula& value) {
  return {{"index" + more, value}, {"middle" + more, value}};
}
std::vector<TestColumn> Axes(const std::string& stem, const std::string& axes) {
  std::vector<TestColumn> columns;
  for (const char axis : axes) {
    columns.push_back({stem + axis, Between(-9.0, 9.0 + static_cast<double>(columns.size()))});
  }
  return columns;
}

std::vector<RuleRow> RulesOfRows() {
  return {
      {"clock_by_name", {{"clock", Between(0, 9)}}, {{"flex1", Between(0, 9)}}},
      {"rate", {{"sampling_hz", Between(99.5, 100.5)}}, {{"sensor_1", Between(99.5, 100.5)}}},
      {"number_by_name", {{"episode_index", Fixed(3)}}, {{"index_mcp", Between(0, 90, 1)}}},
      {"number_by_values", {{"", [](int row) { return row % 200; }}}, {{"", Between(0, 200, 1)}}},
      {"label_by_name", {{"gesture", Between(0, 3, 1)}}, {{"sensor", Between(0, 300, 1)}}},
      {"quaternion_axes", Axes("q", "wxyz"), Axes("acc_", "xyz")},
      {"orientation_by_name", {{"heading", Between(0, 90)}}, {{"bend", Between(0, 90)}}},
      {"roll_pitch_yaw",
       {{"roll", Between(-90, 90)}, {"pitch", Between(-50, 50)}, {"yaw", Between(0, 30)}},
       {{"wrist_pitch", Between(-50, 50)}, {"wrist_yaw", Between(0, 30)}}},
      {"acceleration", Axes("a", "xyz"), {{"a1", Between(0, 90)}}},
      {"angular_rate", Axes("gyro_", "xyz"), {{"glove_1", Between(0, 90)}}},
      {"magnetic_field", Axes("m", "xyz"), {{"sensor_m", Between(0, 90)}}},
      {"velocity", Fingers("_velocity", Between(-9, 9)), Fingers("_mcp", Between(-9, 9))},
      {"force", Fingers("_force", Between(0, 9)), Fingers("", Between(0, 90))},
      {"current", {{"current_mA", Between(0, 90)}}, {{"angle", Between(0, 90)}}},
      {"temperature", {{"temperature", Between(20, 30)}}, {{"sensor", Between(20, 30)}}},
      {"battery", {{"Vbat", Between(3, 4)}}, {{"sensor", Between(3, 4)}}},
      {"temperature", Fingers("_degC", Between(20, 30)), Fingers("_deg", Between(20, 30))},
      {"force", Fingers("_N", Between(0, 9)), {{"a", Between(0, 9)}, {"n", Between(0, 9)}}},
      {"muscle", {{"emg_1", Noise}, {"emg_2", Noise}}, {{"flex_1", Noise}, {"flex_2", Noise}}},
      {"quality", Fingers("_confidence", Between(0, 1)), Fingers("_share", Between(0, 1))},
      {"command", {{"goal_position", Between(0, 90)}}, {{"position", Between(0, 90)}}},
      {"distance", Fingers("_distance_mm", Between(0, 90)), Fingers("_bend", Between(0, 90))},
      {"rotation_axes", Axes("index_rotation_", "xyz"), Axes("index_", "xyz")},
      {"position", Axes("thumb_tip_", "xyz"), {{"thumb_tip", Between(-9, 19)}}},
      {"plane", Axes("tip_", "xy"), Axes("tip_", "xyz")},
      {"foreign_name", {{"humidity", Between(0, 90)}}, {{"bend", Between(0, 90)}}},
      // Values never override a name.
      {"deg_by_name", {{"angle_deg", Between(0, 1.5)}}, {{"angle", Between(0, 90)}}},
      {"rad_by_name", {{"angle_rad", Between(0, 90)}}, {{"angle", Between(0, 1.5)}}},
      {"mrad_by_name", Fingers("_mrad", Between(0, 900)), Fingers("_rad", Between(0, 900))},
      {"other_unit", Fingers("_Ohm", Between(0, 900)), Fingers("_V", Between(0, 900))},
      {"volts_by_name", {{"flex_v", Between(0, 3)}}, {{"flex", Between(0, 3)}}},
      {"counts_by_name", {{"flex_adc", Between(10, 90, 1)}}, {{"flex", Between(10, 90, 1)}}},
      {"share_by_name", {{"ch_norm", Between(0, 1)}}, {{"ch", Between(0, 1)}}},
      {"percent_by_name", {{"ch_percent", Between(0, 90)}}, {{"ch", Between(0, 90)}}},
      {"turns",
       {{"angle", [](int row) { return std::fmod(300.0 + 0.5 * row, 360.0); }}},
       {{"angle", Between(0, 359.9)}}},
      {"counts", {{"", Between(300, 900, 1)}}, {{"", Between(0, 90, 1)}}},
      {"percent",
       {{"a1", Percent(0)}, {"a2", Percent(1)}},
       {{"a1", Between(0, 99)}, {"a2", Between(0, 99)}}},
      {"share", {{"", Between(0.1, 0.9)}}, {{"", Between(0.1, 1.3)}}},
      {"share", Fingers("_mcp", Between(0, 1)), Fingers("_mcp", Between(0.1, 0.9))},
      {"radians", Fingers("_mcp", Between(0.2, 1.5)), Fingers("", Between(0.2, 1.5))},
      {"radians", {{"", Between(-0.4, 1.5)}}, {{"", Between(-0.4, 4)}}},
      {"degrees", Fingers("_mcp", Between(0, 5)), Fingers("", Between(0, 5))},
      {"degrees", {{"", Between(-10, 95)}}, {{"", Between(-10, 950)}}},
      {"unknown_unit", {{"", Between(1.2, 2.8)}}, {{"", Between(0, 95.5)}}},
  };
}

TEST(QuantityRules, DecideFamiliesOfTheirOwnAndNoOthers) {
  std::set<std::string> tested = {"text", "empty"};
  for (const auto& [rule, columns, otherwise] : RulesOfRows()) {
    tested.insert(rule);
    const auto families = FamiliesOf(columns);
    ASSERT_EQ(families.size(), 1U) << rule;
    EXPECT_EQ(families[0].rule, rule);
    for (const ColumnFamily& family : FamiliesOf(otherwise)) EXPECT_NE(family.rule, rule);
  }
  EXPECT_EQ(FamiliesOf({{"a", NoValue}}).front().rule, "empty");
  EXPECT_EQ(FamiliesOf({{"a", NoValue}}, true).front().rule, "text");
  std::vector<std::string> keys;
  for (const QuantityRule& rule : QuantityRules()) {
    keys.emplace_back(rule.key);
    EXPECT_FALSE(rule.reason.empty() || rule.source.empty()) << rule.key;
  }
  EXPECT_THAT(tested, UnorderedElementsAreArray(keys));
}

/// Facts by which a rule holds, and others, each a step beyond one of its limits.
struct RuleLimits {
  std::string rule;
  FamilyFacts facts;
  std::vector<std::function<void(FamilyFacts&)>> beyond;
};

TEST(QuantityRules, HoldUpToTheirLimitsAndNoFurther) {
  const auto of_fingers = [](FamilyFacts& facts) { facts.names_fingers = true; };
  const auto with_fractions = [](FamilyFacts& facts) { facts.is_whole = false; };
  const auto low = [](double value) { return [=](FamilyFacts& facts) { facts.low = value; }; };
  const auto high = [](double value) { return [=](FamilyFacts& facts) { facts.high = value; }; };
  const auto reach = [](double value) { return [=](FamilyFacts& facts) { facts.reach = value; }; };
  const auto words = [](const std::vector<std::string>& list) {
    return [=](FamilyFacts& facts) { facts.words = list; };
  };
  const std::vector<RuleLimits> limits = {
      {"clock_by_name", {}, {of_fingers}},
      {"rate", {.low = 0.0}, {of_fingers, low(-0.001)}},
      {"number_by_name", {}, {of_fingers, with_fractions}},
      {"number_by_values",
       {.moving = 1},
       {of_fingers, [](FamilyFacts& facts) { facts.is_counting = false; },
        [](FamilyFacts& facts) { facts.moving = 0; }}},
      {"label_by_name", {.moving = 1}, {of_fingers, with_fractions}},
      {"label_by_name",
       {.moving = 0, .is_whole = false},
       {of_fingers, [](FamilyFacts& facts) { facts.moving = 1; }}},
      {"command", {.words = {"action"}}, {of_fingers}},
      {"command",
       {.words = {"cmd"}, .names_fingers = true},
       {words({"action"}), words({"actions"})}},
      {"foreign_name",
       {.words = {"humidity"}},
       {of_fingers, words({}), words({"humidity", "flex"}), words({"pos"})}},
      {"counts_by_name", {.low = -0.01}, {low(-0.011)}},
      {"share_by_name", {.low = -0.01, .high = 1.05}, {low(-0.011), high(1.051)}},
      {"percent_by_name", {.low = -0.01, .high = 105.0}, {low(-0.011), high(105.1)}},
      {"turns",
       {.reach = 400.0, .turns = 1, .turning_span = 361.0},
       {reach(400.1), [](FamilyFacts& facts) { facts.turns = 0; },
        [](FamilyFacts& facts) { facts.turning_span = 361.1; }}},
      {"counts", {.low = 0.0, .reach = 180.1}, {with_fractions, low(-0.1), reach(180.0)}},
      {"counts", {.low = 20.1, .reach = 100.1}, {with_fractions, low(20.0), reach(100.0)}},
      {"percent",
       {.high = 105.0, .full_percent = 2},
       {high(105.1), low(-0.011), [](FamilyFacts& facts) { facts.full_percent = 1; }}},
      {"share",
       {.low = 0.3, .high = 1.05},
       {low(-0.011), high(1.051), [](FamilyFacts& facts) { facts.names_joints = true; }}},
      {"share", {.names_joints = true, .low = 0.05, .high = 0.95}, {low(0.051), high(0.949)}},
      {"radians", {.low = -0.011, .reach = 3.14159}, {low(-0.01), reach(3.1416)}},
      {"radians", {.names_joints = true, .reach = 3.14159}, {reach(3.1416)}},
      {"degrees", {.reach = 5.31}, {reach(5.3), reach(200.1)}},
      {"degrees", {.names_joints = true, .reach = 200.0}, {reach(200.1)}},
  };
  for (const auto& [rule, facts, beyond] : limits) {
    const auto found = std::ranges::find(QuantityRules(), rule, &QuantityRule::key);
    ASSERT_NE(found, QuantityRules().end()) << rule;
    EXPECT_TRUE(found->holds(facts)) << rule;
    for (std::size_t i = 0; i < beyond.size(); ++i) {
      FamilyFacts other = facts;
      beyond[i](other);
      EXPECT_FALSE(found->holds(other)) << rule << " " << i;
    }
  }
  for (const auto& [rule, axes] : {std::pair("quaternion_axes", "wxyz"),
                                   {"roll_pitch_yaw", "rpy"},
                                   {"position", "xyz"},
                                   {"plane", "xy"}}) {
    const auto found = std::ranges::find(QuantityRules(), rule, &QuantityRule::key);
    for (const char* other : {"wxyz", "rpy", "xyz", "xy", ""}) {
      EXPECT_EQ(found->holds({.axes = other}), std::string_view(other) == axes) << rule << other;
    }
  }
}

TEST(NameOf, IsOfEachQuantityAndUnit) {
  EXPECT_EQ(NameOf(Quantity::kText), "text");
  EXPECT_EQ(NameOf(Quantity::kOrientation), "orientation");
  EXPECT_EQ(NameOf(Quantity::kPosition), "position");
  EXPECT_EQ(NameOf(Quantity::kCommand), "command");
  EXPECT_EQ(NameOf(Quantity::kUnknown), "unknown");
  EXPECT_EQ(NameOf(Quantity::kSensor), "sensor");
  EXPECT_EQ(NameOf(RawUnit::kCounts), "counts");
  EXPECT_EQ(NameOf(RawUnit::kMilliradians), "mrad");
  EXPECT_EQ(NameOf(RawUnit::kUnknown), "unknown");
}

TEST(FamilyOfSensors, HasTheUnitOfSensorsWhateverTheyAreCalled) {
  TableStatistics statistics(3);
  for (int row = 0; row < kRows; ++row) {
    statistics.Add(0.01 * row, std::vector{Between(300, 900, 1)(row), Between(300, 900, 1, 1)(row),
                                           Between(300, 900, 1, 2)(row)});
  }
  std::vector<ColumnEvidence> columns;
  for (const char* name : {"force_3", "force_1", "force_2"}) {
    columns.push_back({.name = name, .statistics = statistics.Column(columns.size())});
  }
  EXPECT_EQ(FindFamilies(columns).front().quantity, Quantity::kForce);
  const ColumnFamily family = FamilyOfSensors(columns, {0, 1, 2});
  EXPECT_EQ(family.quantity, Quantity::kSensor);
  EXPECT_EQ(family.unit, RawUnit::kCounts);
  EXPECT_EQ(family.stem, "force");
  EXPECT_THAT(family.columns, ElementsAre(1, 2, 0));
}

/// Columns of the family with the first sensor.
std::vector<std::size_t> SensorsOf(const std::vector<TestColumn>& columns) {
  for (const ColumnFamily& family : FamiliesOf(columns)) {
    if (family.quantity == Quantity::kSensor) return family.columns;
  }
  return {};
}

TEST(FindFamilies, GroupsColumnsByTheirStem) {
  EXPECT_THAT(SensorsOf({{"flex2", Between(300, 900, 1)},
                         {"roll", Between(-60, 60)},
                         {"pitch", Between(-20, 20)},
                         {"flex1", Between(300, 900, 1)},
                         {"flex3", Fixed(512)},
                         {"sampling_hz", Between(99.5, 100.5)}}),
              ElementsAre(3, 0, 4));  // by their numbers, the dead one included
  EXPECT_THAT(SensorsOf({{"Thumb_MCP_Position_X", Between(0, 1)},
                         {"Thumb_MCP_Position_Y", Between(0, 1)},
                         {"Thumb_MCP_Position_Z", Between(0, 1)},
                         {"Thumb_MCP_Flex", Between(0, 60)},
                         {"Index_PIP_Flex", Between(0, 90)}}),
              ElementsAre(3, 4));
  EXPECT_THAT(SensorsOf({{"index", [](int row) { return row; }},
                         {"thumb", Between(0, 90)},
                         {"index", Between(0, 90)},
                         {"middle", Between(0, 90)}}),
              ElementsAre(1, 2, 3));  // the first one counts the rows
  EXPECT_TRUE(SensorsOf({{"episode_index", Fixed(1)}, {"task_index", Fixed(0)}}).empty());
}

TEST(FindFamilies, KeepsHandsApart) {
  const auto families = FamiliesOf({{"left_index_mcp", Between(0, 90)},
                                    {"right_index_mcp", Between(0, 90)},
                                    {"left_index_pip", Between(0, 90)}});
  ASSERT_EQ(families.size(), 2U);
  EXPECT_EQ(families[0].side, "left");
  EXPECT_THAT(families[0].columns, ElementsAre(0, 2));
  EXPECT_EQ(families[1].side, "right");
}

}  // namespace
}  // namespace gauntlet::sim
