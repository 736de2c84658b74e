#include "sim/tables/name_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace gauntlet::sim
