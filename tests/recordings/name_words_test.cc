#include "sim/tables/name_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "sim/tables/joint_unit.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;

TEST(WordsOf, TakesNamesApart) {
  EXPECT_THAT(WordsOf("IndexPIP_deg2"), ElementsAre("index", "pip", "deg", "2"));
  EXPECT_THAT(WordsOf("R.hand/thumb-ip (V)"), ElementsAre("r", "hand", "thumb", "ip", "v"));
  EXPECT_THAT(WordsOf("q_FFJ3"), ElementsAre("q", "ffj", "3"));
  EXPECT_THAT(WordsOf("ThumbMCPStretch"), ElementsAre("thumb", "mcp", "stretch"));
  EXPECT_THAT(WordsOf("thumb_degC"), ElementsAre("thumb", "degc"));
  EXPECT_THAT(WordsOf("Thumb [°C]"), ElementsAre("thumb", "degc"));
  EXPECT_THAT(WordsOf("Thumb(°)"), ElementsAre("thumb", "deg"));
  EXPECT_THAT(WordsOf("°"), ElementsAre("deg"));
  EXPECT_THAT(WordsOf("degCount"), ElementsAre("deg", "count"));
  EXPECT_THAT(WordsOf("ch0_pF"), ElementsAre("ch", "0", "pf"));
  EXPECT_THAT(WordsOf(""), ElementsAre());
}

TEST(WithDigits, CountsFromTheThumb) {
  EXPECT_THAT(WithDigits({"RightDigit1Distal", "digit_5_flexion", "Digit6", "digit", "digits_2"}),
              ElementsAre("right_thumb_distal", "little_flexion", "Digit6", "digit", "digits_2"));
}

TEST(WithJoints, KnowsAnatomy) {
  EXPECT_THAT(WithJoints({"index_ProximalInterphalangeal_flexion", "thumb InterPhalangeal",
                          "ring.metacarpophalangeal", "Distal_Inter_phalangeal", "proximal"}),
              ElementsAre("index_pip_flexion", "thumb_ip", "ring_mcp", "dip", "proximal"));
}

TEST(InEnglish, NeedsThreeFingers) {
  EXPECT_THAT(InEnglish({"t", "Daumen [°]", "Mittelfinger", "Kleiner Finger"}),
              ElementsAre("t", "thumb_deg", "middle", "little_finger"));
  EXPECT_THAT(InEnglish({"t", "pollice", "medio", "index"}), ElementsAre());
  EXPECT_THAT(InEnglish({"thumb", "index", "middle", "ring", "little"}), ElementsAre());
}

TEST(WithFingers, TakesFiveLettersForFingersAndTwoForSides) {
  EXPECT_THAT(
      WithFingers({"time", "T_MPJ", "I_MPJ", "M_PIJ", "R_PIJ", "L_PIJ"}),
      ElementsAre("time", "thumb_MPJ", "index_MPJ", "middle_PIJ", "ring_PIJ", "little_PIJ"));
  EXPECT_THAT(WithFingers({"t_s", "L_flex1", "R_flex1"}), ElementsAre("t_s", "L_flex1", "R_flex1"));
}

TEST(WordsOf, KeepsUnitsTogetherAtTheirEnd) {
  for (const auto& [name, unit] : {std::pair("a_mA", "ma"),
                                   {"a_mV", "mv"},
                                   {"a_uV", "uv"},
                                   {"a_pF", "pf"},
                                   {"a_nF", "nf"},
                                   {"a_degF", "degf"},
                                   {"a_mV (raw)", "mv"}}) {
    EXPECT_EQ(WordsOf(name)[1], unit) << name;
  }
  // No units: another letter in front, something behind, or another letter for degrees.
  EXPECT_THAT(WordsOf("a_pV"), ElementsAre("a", "p", "v"));
  EXPECT_THAT(WordsOf("a_kV"), ElementsAre("a", "k", "v"));
  EXPECT_THAT(WordsOf("mVolt"), ElementsAre("m", "volt"));
  EXPECT_THAT(WordsOf("a_degA"), ElementsAre("a", "deg", "a"));
  EXPECT_THAT(WordsOf("MCPJoint2A"), ElementsAre("mcp", "joint", "2", "a"));
  EXPECT_THAT(WordsOf("aB°C1"), ElementsAre("a", "b", "deg", "c", "1"));
}

TEST(WithFingers, NeedsEveryFingerAndOneOfTwoLetters) {
  const std::vector<std::string> pinky = WithFingers({"T_1", "i_1", "M_1", "r_1", "x_P", "P_1"});
  EXPECT_THAT(pinky, ElementsAre("thumb_1", "index_1", "middle_1", "ring_1", "x_P", "little_1"));
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"I_1", "M_1", "R_1", "L_1"},
        {"T_1", "M_1", "R_1", "L_1"},
        {"T_1", "I_1", "R_1", "L_1"},
        {"T_1", "I_1", "M_1", "L_1"},
        {"T_1", "I_1", "M_1", "R_1"},
        {"T_1", "I_1", "M_1", "R_1", "L_1", "P_1"}}) {
    EXPECT_EQ(WithFingers(names), names);
  }
}

TEST(WithDigits, KnowsFiveFingers) {
  EXPECT_THAT(WithDigits({"digit1", "digit2", "digit3", "digit4", "digit5", "digit0", "digit12"}),
              ElementsAre("thumb", "index", "middle", "ring", "little", "digit0", "digit12"));
}

TEST(WithJoints, NeedsTheWholeNameOfAJoint) {
  EXPECT_THAT(WithJoints({"metacarpo_phalangeal", "phalangeal", "other_phalangeal",
                          "thumb_carpometacarpal", "medial_interphalangeal"}),
              ElementsAre("mcp", "phalangeal", "other_phalangeal", "thumb_cmc", "medial_ip"));
}

// --- Columns of time -----------------------------------------------------------------------------

TEST(TimeScaleS, KnowsTimesWithTheirUnits) {
  for (const char* time :
       {"t", "ts", "Time", "timestamp", "stamp", "elapsed", "Elapsed Time", "X_Value"}) {
    EXPECT_EQ(TimeScaleS(time), 1.0) << time;
    EXPECT_EQ(TimeScaleS(std::string(time) + " [ms]"), 1e-3) << time;
  }
  for (const auto& [scale_s, units] : {std::pair(1.0, "sec secs second seconds"),
                                       {1e-3, "ms msec millis millisec milliseconds"},
                                       {1e-6, "us usec micros microsec microseconds"},
                                       {1e-9, "ns nsec nanos nanosec nanoseconds"}}) {
    std::string rest(units);
    for (std::size_t end = 0; end != rest.npos;
         rest = end == rest.npos ? "" : rest.substr(end + 1)) {
      end = rest.find(' ');
      EXPECT_EQ(TimeScaleS(rest.substr(0, end)), scale_s) << rest;
      EXPECT_EQ(TimeScaleS("time_" + rest.substr(0, end)), scale_s) << rest;
    }
  }
  EXPECT_EQ(TimeScaleS("time_s"), 1.0);
  for (const char* other : {"s", "", "sms", "index", "time_min", "secs_ms", "mst", "frame"}) {
    EXPECT_EQ(TimeScaleS(other), std::nullopt) << other;
  }
}

TEST(SecondsPerUnit, IsTheInverseOfUnitOfSeconds) {
  for (const auto& [unit, seconds] : {std::pair("s", 1.0),
                                      {"ms", 1e-3},
                                      {"us", 1e-6},
                                      {"ns", 1e-9},
                                      {"ticks", 1e-7},
                                      {"min", 60.0},
                                      {"h", 3600.0},
                                      {"day", 86400.0}}) {
    EXPECT_EQ(SecondsPerUnit(unit), seconds);
    EXPECT_EQ(UnitOfSeconds(seconds), unit);
  }
  EXPECT_EQ(SecondsPerUnit("sec"), std::nullopt);
}

TEST(MayBeTime, KnowsNumbersOfRowsAndClocks) {
  for (const char* name : {"frame", "Sample", "row", "seq", "k", "frame_number", "row no",
                           "sample_idx", "frameNr", "kindex"}) {
    EXPECT_EQ(IsSampleNumber(name), std::string_view(name) != "sample_idx") << name;
    EXPECT_EQ(MayBeTime(name), std::string_view(name) != "sample_idx") << name;
  }
  for (const char* name : {"s", "i", "n", "id", "idx", "index", "sequence", "counter", "datetime",
                           "rosclock_x", "ticks", "x [s]", "y(s)", "date", "my_time_2"}) {
    EXPECT_TRUE(MayBeTime(name)) << name;
    EXPECT_FALSE(IsSampleNumber(name)) << name;
  }
  for (const char* name : {"index_mcp", "thumb", "x [m]", "counters", "framework"}) {
    EXPECT_FALSE(MayBeTime(name)) << name;
  }
}

TEST(IsWordOf, TakesWholeWordsOnly) {
  for (const char* word : {"ab", "cd", "a"}) EXPECT_TRUE(IsWordOf("ab cd a", word)) << word;
  for (const char* word : {"b", "c", "d", "abc", "", " "})
    EXPECT_FALSE(IsWordOf("ab cd a", word)) << word;
  EXPECT_TRUE(IsWordOf("xab ab", "ab"));
  EXPECT_TRUE(IsWordOf("", ""));
}

// --- Units of joints in messages -----------------------------------------------------------------

TEST(UnitOfJoint, FollowsTheNameThenTheTypeThenTheValues) {
  const JointTypes types = {{"lift", "prismatic"},
                            {"grip_turn", "revolute"},
                            {"rail_wheel", "continuous"},
                            {"base", "fixed"},
                            {"a_deg", "prismatic"}};
  const auto unit = [&](const std::string& name, double largest = 1.0) {
    const JointUnit found = UnitOfJoint(name, largest, types);
    return std::string(found.suffix) + (found.why.empty() ? "" : "?");
  };
  for (const char* name : {"x_rad", "x_deg", "x_m", "x_mm", "a_deg"})
    EXPECT_EQ(unit(name), "") << name;
  EXPECT_EQ(unit("lift"), "_m?");
  EXPECT_EQ(UnitOfJoint("lift", 1.0, types).why,
            "lift: metres, as the URDF in the file says (prismatic)");
  EXPECT_EQ(unit("grip_turn"), "_rad");
  EXPECT_EQ(unit("rail_wheel"), "_rad");
  EXPECT_EQ(unit("base"), "_rad");
  for (const char* name :
       {"gripper", "left_jaw", "slide_2", "linear_axis", "finger_joint1", "finger_joint"}) {
    EXPECT_EQ(unit(name), "?") << name;
  }
  for (const char* name :
       {"shoulder_lift", "index_finger_joint", "finger1_joint2", "finger_spread", "finger"}) {
    EXPECT_EQ(unit(name), "_rad") << name;
  }
  EXPECT_EQ(unit("pan", 6.2831), "_rad");  // a turn, and a little more
  EXPECT_EQ(unit("pan", 6.59), "_rad");
  EXPECT_EQ(unit("pan", 6.61), "?");
  EXPECT_EQ(unit("left_wheel", 500.0), "_rad");
}

TEST(JointTypesIn, ReadsNamesAndTypesInEitherOrderAndQuote) {
  const JointTypes types = JointTypesIn(
      "<robot name='r'><joint name=\"a\" type=\"revolute\"><axis type='no'/></joint>"
      "<joint\n type = 'prismatic'\n name = 'b'/><joint rename='x' name='c' type='fixed'>"
      "<joint name='d'><joint type='fixed'><joint name='e' type='cut>");
  EXPECT_EQ(types, (JointTypes{{"a", "revolute"}, {"b", "prismatic"}, {"c", "fixed"}}));
  EXPECT_TRUE(JointTypesIn("").empty());
}

}  // namespace
}  // namespace gauntlet::sim
