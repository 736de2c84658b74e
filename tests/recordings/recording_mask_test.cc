// What nobody knows of a recording is masked and told: gaps, restarts, stops, lacks of a reference
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/glove/glove.h"
#include "sim/recordings/clipping.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Rows of a sensor at 50 Hz that ends at its stops: clamped to 0 .. 1, or not.
std::vector<double> Swings(double amplitude, double step) {
  std::vector<double> values;
  for (int i = 0; i < 500; ++i) {
    const double value = 0.5 + amplitude * std::sin(2.0 * std::numbers::pi * i / 100.0);
    values.push_back(std::clamp(step * std::round(value / step), 0.0, 1.0));
  }
  return values;
}

std::vector<double> Times(std::size_t rows) {
  std::vector<double> time_s;
  for (std::size_t i = 0; i < rows; ++i) time_s.push_back(0.02 * static_cast<double>(i));
  return time_s;
}

TEST(Clipping, IsWhereASensorStandsAtItsStop) {
  const std::vector<double> values = Swings(0.8, 1e-6);
  const std::vector<RowRange> clipped = FindClipped(Times(500), values);
  ASSERT_EQ(clipped.size(), 10u);  // both stops in each of five swings
  std::size_t rows = 0;
  for (const RowRange& range : clipped) {
    for (std::size_t i = range.begin; i < range.end; ++i) {
      EXPECT_TRUE(values[i] == 0.0 || values[i] == 1.0) << i;
      ++rows;
    }
  }
  // |sin| above 0.5 / 0.8 for 57 % of the time.
  EXPECT_NEAR(static_cast<double>(rows) / 500.0, 1.0 - 2.0 / std::numbers::pi * std::asin(0.625),
              0.02);
}

TEST(Clipping, IsNotWhereASensorHasFewStepsIsSlowOrStandsStill) {
  EXPECT_TRUE(FindClipped(Times(500), Swings(0.3, 1e-6)).empty());
  EXPECT_TRUE(FindClipped(Times(500), std::vector<double>(500, 0.4)).empty());
  EXPECT_TRUE(FindClipped({}, {}).empty());
  // Eight values a second, polled fifty times a second, turn round at their extremes.
  std::vector<double> slow = Swings(0.3, 1e-6);
  for (std::size_t i = 0; i < slow.size(); ++i) slow[i] = slow[i / 6 * 6];
  EXPECT_TRUE(FindClipped(Times(500), slow).empty());
}

TEST(Clipping, LastsLongerThanAnyOtherValue) {
  // A value in the middle and the highest one, each for so many rows.
  const auto clipped = [](std::size_t middle, std::size_t highest) {
    std::vector<double> values = {0.0, 0.1};
    values.insert(values.end(), middle, 0.5);
    values.insert(values.end(), {0.6, 0.7});
    values.insert(values.end(), highest, 1.0);
    values.insert(values.end(), {0.7, 0.2});
    return FindClipped(Times(values.size()), values).size();
  };
  EXPECT_EQ(clipped(10, 10), 0u);
  EXPECT_EQ(clipped(10, 11), 1u);
  EXPECT_EQ(clipped(1, 5), 0u);  // for 80 ms
  EXPECT_EQ(clipped(1, 7), 1u);
}

class MaskedRecording : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_.path() / name) << text;
    return (folder_.path() / name).string();
  }
  /// 8 s at 100 Hz of index_pip and ring_pip; `time_of` gives the time of a row, below 0: no row.
  std::string Wave(const std::string& name, const std::function<double(double)>& time_of,
                   double shift_s = 0.0) {
    std::string text = "time_s,index_pip,ring_pip\n";
    for (int i = 0; i < 800; ++i) {
      const double t = 0.01 * i;
      if (time_of(t) < 0.0) continue;
      const auto angle = [&](double hz) {
        return 50.0 +
               30.0 * std::sin(2.0 * std::numbers::pi * hz * (t - shift_s)) * std::exp(-0.1 * t);
      };
      text += fmt::format("{:.2f},{:.4f},{:.4f}\n", time_of(t), angle(0.7), angle(0.4));
    }
    return Write(name, text);
  }
  static GloveSignal Play(RecordedMotionConfig recording) {
    GloveConfig config;
    config.channels = {"index_pip", "ring_pip"};
    config.noise.kind = WhiteNoiseKind::kNone;
    config.motion.settings = std::move(recording);
    return SynthesiseGlove(config, 1);
  }
  static RecordedMotionConfig Measured(const std::string& file) {
    return {.file = file, .problems = ProblemHandling::kRepair, .use = RecordingUse::kMeasured};
  }
  static std::vector<std::string> Masked(const GloveSignal& glove) {
    std::vector<std::string> texts;
    for (const MaskedStretch& stretch : glove.masked) {
      texts.push_back(fmt::format("{} {} {}-{}", kMaskReasonNames[static_cast<int>(stretch.reason)],
                                  glove.channel_names[stretch.channel], stretch.begin,
                                  stretch.end));
    }
    return texts;
  }

  test::TemporaryDirectory folder_;
};

double Always(double t) { return t; }

TEST_F(MaskedRecording, WithoutGapsHasNoMask) {
  EXPECT_THAT(Masked(Play(Measured(Wave("a.csv", Always)))), IsEmpty());
}

TEST_F(MaskedRecording, HidesAGapOfBothUses) {
  const std::string file =
      Wave("gap.csv", [](double t) { return t > 2.995 && t < 4.005 ? -1.0 : t; });
  RecordedMotionConfig recording = Measured(file);
  // The last row before it is known until the next would have come.
  EXPECT_THAT(Masked(Play(recording)),
              ElementsAre("gap index_pip 2991-4010", "gap ring_pip 2991-4010"));
  recording.use = RecordingUse::kTruth;
  EXPECT_EQ(Play(recording).masked.size(), 2u);
}

TEST_F(MaskedRecording, HidesRowsInWhichAllChannelsStop) {
  // 80 rows of the sine of second 2, and then one channel that stops alone.
  const auto text_of = [](bool one_moves) {
    std::string text = "time_s,index_pip,ring_pip\n";
    for (int row = 0; row < 600; ++row) {
      const double t = 0.01 * (row >= 200 && row < 280 ? 200 : row);
      text += fmt::format("{:.2f},{:.4f},{:.4f}\n", 0.01 * row, 40.0 + 30.0 * std::sin(4.0 * t),
                          40.0 + 30.0 * std::sin(3.0 * (one_moves ? 0.01 * row : t)));
    }
    return text;
  };
  const GloveSignal glove = Play(Measured(Write("frozen.csv", text_of(false))));
  EXPECT_THAT(glove.remarks, Contains(HasSubstr("frozen, all channels at once, 1 times, 0.79 s")));
  EXPECT_THAT(Masked(glove), ElementsAre("gap index_pip 2001-2800", "gap ring_pip 2001-2800"));
  EXPECT_THAT(Masked(Play(Measured(Write("one.csv", text_of(true))))), IsEmpty());
}

TEST_F(MaskedRecording, HidesARestartAndSmoothsItsTwoSidesByThemselves) {
  const auto restarts = [](double t) { return t < 4.0 ? t + 10.0 : t; };
  const GloveSignal glove = Play(Measured(Wave("restart.csv", restarts)));
  EXPECT_THAT(Masked(glove),
              ElementsAre("restart index_pip 4000-4000", "restart ring_pip 4000-4000"));
  // What comes before does not depend on what comes behind.
  const GloveSignal first =
      Play(Measured(Wave("first.csv", [](double t) { return t < 4.0 ? t : -1.0; })));
  EXPECT_NEAR(glove.true_angle_rad(3500, 0), first.true_angle_rad(3500, 0), 1e-8);
  EXPECT_NEAR(glove.true_angle_rad(3980, 0), first.true_angle_rad(3980, 0), 2e-3);
}

TEST_F(MaskedRecording, CountsAnglesBeyondTheJointsRangeAndStrictlyStops) {
  std::string text = "time_s,index_pip,ring_pip\n";
  for (int i = 0; i < 400; ++i) {
    text += fmt::format("{:.2f},{},{}\n", 0.01 * i, i < 300 ? 103.0 + 0.001 * i : 90.0,
                        i == 7 ? -5.0 : 20.0 + 0.01 * i);
  }
  RecordedMotionConfig recording = Measured(Write("beyond.csv", text));
  EXPECT_THAT(Play(recording).remarks,
              Contains(HasSubstr("beyond the joint's range: 301 times, first in row 2 (index_pip "
                                 "75 %, ring_pip 0.25 % of the rows)")));
  recording.problems = ProblemHandling::kStrict;
  try {
    Play(recording);
    FAIL();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("beyond.csv:2:2: index_pip is 103 deg, the joint has 0 to 100 deg"));
  }
}

TEST_F(MaskedRecording, FitsAReferenceOfOtherTimesAndNames) {
  const std::string file = Wave("glove.csv", Always);
  std::string text = "t_ms;a;b\n";
  for (int i = 0; i < 1400; ++i) {  // 2.5 s earlier, and longer
    const double t = 0.01 * i - 2.5;
    const auto angle = [&](double hz) {
      return 50.0 + 30.0 * std::sin(2.0 * std::numbers::pi * hz * t) * std::exp(-0.1 * t);
    };
    text += fmt::format("{};{:.4f};{:.4f}\n", 10 * i, angle(0.7), 0.5 * angle(0.4));
  }
  RecordedMotionConfig recording = Measured(file);
  recording.reference = Write("truth.csv", text);
  recording.reference_map = Write(
      "truth.map.csv", "column,channel,unit,scale\nt_ms,time,ms,\na,index_pip,,\nb,ring_pip,,2\n");
  recording.reference_offset = ReferenceOffset::kAuto;
  const GloveSignal found = Play(recording);
  EXPECT_THAT(found.remarks, Contains(HasSubstr("truth.csv: found 2.500 s later")));
  recording.reference_offset = ReferenceOffset::kGiven;
  recording.reference_offset_s = 2.5;
  const GloveSignal given = Play(recording);
  const GloveSignal alone = Play({.file = file});
  EXPECT_LT((given.true_angle_rad - alone.true_angle_rad).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT((found.true_angle_rad - given.true_angle_rad).cwiseAbs().maxCoeff(), 5e-3);
}

TEST_F(MaskedRecording, RefusesAReferenceThatIsTooShortOrOfSomethingElse) {
  const auto error_of = [](const RecordedMotionConfig& recording) -> std::string {
    try {
      Play(recording);
    } catch (const UserError& error) {
      return error.what();
    }
    return "no error";
  };
  RecordedMotionConfig recording = Measured(Wave("glove.csv", Always));
  recording.reference = Wave("short.csv", [](double t) { return t < 5.0 ? t : -1.0; });
  EXPECT_THAT(error_of(recording), HasSubstr("short.csv: the reference has 0.000 to 4.990 s, the "
                                             "recording's stretch needs 0.000 to 7.990 s of it"));
  recording.duration_s = 4.0;
  EXPECT_EQ(error_of(recording), "no error");
  std::string text = "time_s,index_pip\n";
  for (int i = 0; i < 800; ++i) text += fmt::format("{:.2f},{}\n", 0.01 * i, 50.0 + i % 2);
  recording.reference = Write("noise.csv", text);
  recording.reference_offset = ReferenceOffset::kAuto;
  EXPECT_THAT(error_of(recording), HasSubstr("noise.csv: no offset to the recording within 10 s"));
  recording.reference_offset = ReferenceOffset::kGiven;
  EXPECT_THAT(Masked(Play(recording)),
              ElementsAre("gap ring_pip 0-4000"));  // it has no such column
}

}  // namespace
}  // namespace gauntlet::sim
