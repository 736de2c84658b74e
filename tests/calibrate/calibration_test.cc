// From what a glove says of known poses back to its curves and to the covariance of its noise.
#include "sim/fit/calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "controller/filters/paper_noise.h"
#include "controller/linearisation/linearisation.h"
#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/glove/glove.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

/// The wearer takes postures and holds each; the glove has the paper's noise.
GloveConfig GloveInKnownPoses() {
  GloveConfig config;
  config.motion.settings = MovesConfig{
      .postures = {"open", "lateral", "rest", "power", "hook", "precision", "point", "tripod"},
      .hold_s = 1.2};
  return config;
}

/// The recording that a person would make of it.
PoseRecording RecordingOf(const GloveSignal& glove, Eigen::Index settle_samples = 200) {
  PoseRecording recording;
  recording.name = "poses.csv";
  recording.channel_names = glove.channel_names;
  recording.rate_hz = glove.rate_hz;
  recording.counts = glove.counts;
  recording.angle_deg = glove.true_angle_rad * kDegPerRad;
  recording.resolution_counts = 1.0;
  for (Eigen::Index c = 0; c < recording.angle_deg.cols(); ++c) {
    KeepSettledPoses(settle_samples, recording.angle_deg.col(c));
  }
  return recording;
}

TEST(Calibrate, GivesBackThePapersRWithinItsConfidence) {
  const std::vector<double> r = controller::PaperMeasurementVariance();
  int inside = 0;
  constexpr int kGloves = 20;
  for (int seed = 1; seed <= kGloves; ++seed) {
    CurveErrors errors;
    const Calibration calibration =
        Calibrate(RecordingOf(SynthesiseGlove(GloveInKnownPoses(), seed)), {}, errors);
    for (std::size_t i = 0; i < 18; ++i) {
      const ChannelCalibration& channel = calibration.channels[i];
      EXPECT_NEAR(channel.variance_counts2, r[i], 0.1 * r[i]);
      inside += channel.variance_low_counts2 <= r[i] && r[i] <= channel.variance_high_counts2;
    }
  }
  // 360 intervals of 95 %: 342 expected, standard deviation 4.1.
  EXPECT_GE(inside, 342 - 17);
  EXPECT_LE(inside, 342 + 17);
}

TEST(Calibrate, FindsTheCovarianceOfCoupledChannels) {
  GloveConfig config = GloveInKnownPoses();
  config.noise.covariance_counts2.assign(18 * 18, 0.0);
  for (std::size_t i = 0; i < 18; ++i) config.noise.covariance_counts2[19 * i] = 16.0;
  config.noise.covariance_counts2[18 * 4 + 5] = config.noise.covariance_counts2[18 * 5 + 4] = 9.0;
  CurveErrors errors;
  const Calibration calibration =
      Calibrate(RecordingOf(SynthesiseGlove(config, 3)), {.confidence_percent = 99.99}, errors);
  const ChannelCalibration& index_mcp = calibration.channels[4];
  EXPECT_NEAR(index_mcp.covariance_counts2[5], 9.0, 1.0);
  EXPECT_LE(index_mcp.covariance_low_counts2[5], 9.0);
  EXPECT_GE(index_mcp.covariance_high_counts2[5], 9.0);
  EXPECT_NEAR(index_mcp.covariance_counts2[6], 0.0, 1.0);
  EXPECT_EQ(index_mcp.covariance_counts2[5], calibration.channels[5].covariance_counts2[4]);
}

/// Largest RMS difference of a channel between the wearer's angle and what a linearisation says
/// without noise, over the grasp of a bottle.
double WorstChannelErrorDeg(GloveConfig config, int seed,
                            const controller::LinearisationConfig& linearisation) {
  config.motion.settings = GraspConfig{};
  config.noise.kind = WhiteNoiseKind::kNone;
  const GloveSignal glove = SynthesiseGlove(config, static_cast<std::uint64_t>(seed));
  const auto curve =
      controller::MakeLinearisation(linearisation, NominalCalibration(config), glove.channel_names);
  Eigen::ArrayXd square_sum = Eigen::ArrayXd::Zero(18);
  Eigen::VectorXd row(18);
  for (Eigen::Index k = 0; k < glove.counts.rows(); ++k) {
    row = glove.counts.row(k);
    curve->ToAngles({row.data(), 18}, {row.data(), 18});
    square_sum += (row - glove.true_angle_rad.row(k).transpose()).array().square();
  }
  return std::sqrt(square_sum.maxCoeff() / static_cast<double>(glove.counts.rows())) * kDegPerRad;
}

class EveryCurve : public testing::TestWithParam<CurveKind> {};

TEST_P(EveryCurve, MakesABadGloveGood) {
  GloveConfig config = GloveInKnownPoses();
  config.sensor.gain_deviation_percent = 10.0;
  config.sensor.offset_deviation_percent = 3.0;
  for (int seed = 1; seed <= 3; ++seed) {
    CurveErrors errors;
    const Calibration calibration =
        Calibrate(RecordingOf(SynthesiseGlove(config, static_cast<std::uint64_t>(seed))),
                  {.curve = GetParam(), .degree = 2}, errors);
    const double before = WorstChannelErrorDeg(config, seed, {});
    const double after = WorstChannelErrorDeg(config, seed, calibration.linearisation);
    EXPECT_GT(before, 8.0);
    // Cross-talk and play stay: 1 % of a neighbour's range, half a degree.
    EXPECT_LT(after, 3.0);
    EXPECT_LT(calibration.channels[0].rms_error_deg, 2.0);
  }
}

std::string CurveName(const testing::TestParamInfo<CurveKind>& test) {
  if (test.param == CurveKind::kTable) return "Table";
  return test.param == CurveKind::kTwoPoint ? "TwoPoint" : "Polynomial";
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryCurve,
                         testing::Values(CurveKind::kTable, CurveKind::kTwoPoint,
                                         CurveKind::kPolynomial),
                         CurveName);

TEST(Calibrate, LeavesPosesAtAnEndOfTheScaleOut) {
  PoseRecording recording = RecordingOf(SynthesiseGlove(GloveInKnownPoses(), 1));
  CurveErrors errors;
  const std::size_t corners =
      Calibrate(recording, {}, errors).linearisation.channels[4].counts.size();
  double lowest = 1e9;
  for (const double angle : recording.angle_deg.col(4)) {
    if (std::isfinite(angle)) lowest = std::min(lowest, angle);
  }
  for (Eigen::Index k = 0; k < recording.counts.rows(); ++k) {
    if (recording.angle_deg(k, 4) == lowest) recording.counts(k, 4) = 0.0;
  }
  const Calibration clipped = Calibrate(recording, {}, errors);
  EXPECT_EQ(clipped.linearisation.channels[4].counts.size(), corners - 1);
  // A third of the stretch's variance would be missing otherwise.
  EXPECT_NEAR(clipped.channels[4].variance_counts2, 26.94, 0.1 * 26.94);
}

TEST(Calibrate, IsNotMovedBySpikesNorBySomeAtAnEndOfTheScale) {
  const PoseRecording good = RecordingOf(SynthesiseGlove(GloveInKnownPoses(), 1));
  PoseRecording bad = good;
  for (Eigen::Index k = 7; k < bad.counts.rows(); k += 150) {
    bad.counts(k, 4) = 1023.0;
    bad.counts(k + 1, 4) = std::max(bad.counts(k + 1, 4) - 124.0, 0.0);
  }
  CurveErrors errors;
  const Calibration of_good = Calibrate(good, {}, errors);
  const Calibration of_bad = Calibrate(bad, {}, errors);
  EXPECT_EQ(of_good.channels[4].spikes, 0);
  EXPECT_GT(of_bad.channels[4].spikes, 50);
  EXPECT_NEAR(of_bad.channels[4].variance_counts2, of_good.channels[4].variance_counts2, 1.0);
  const auto& before = of_good.linearisation.channels[4].counts;
  const auto& after = of_bad.linearisation.channels[4].counts;
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 0.5);
}

std::string ErrorOf(const PoseRecording& recording, const CalibrationOptions& options = {}) {
  try {
    CurveErrors errors;
    Calibrate(recording, options, errors);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Calibrate, NamesWhatARecordingLacks) {
  const PoseRecording good = RecordingOf(SynthesiseGlove(GloveInKnownPoses(), 1));
  EXPECT_EQ(ErrorOf(good), "");

  GloveConfig moving;
  moving.motion.settings = SineConfig{};
  EXPECT_THAT(
      ErrorOf(RecordingOf(SynthesiseGlove(moving, 1))),
      HasSubstr("thumb_rotation: has 0 poses, must have at least 2; a pose is a known angle "
                "(thumb_rotation_deg) that stays the same for more than 200 ms"));
  PoseRecording no_angles = RecordingOf(SynthesiseGlove(moving, 1));
  no_angles.angle_deg = Signal(no_angles.counts.rows(), 0);
  EXPECT_THAT(ErrorOf(no_angles), HasSubstr("never holds still"));

  PoseRecording broken = good;
  broken.counts.col(7).setZero();
  broken.angle_deg = Signal(broken.counts.rows(), 0);
  EXPECT_THAT(ErrorOf(broken), HasSubstr("middle_pip: is at 0 or at full scale"));

  EXPECT_THAT(ErrorOf(good, {.curve = CurveKind::kPolynomial, .degree = 9}),
              HasSubstr("thumb_rotation: --degree is 9, must be from 1 to 6, below its 7 poses"));

  PoseRecording clipped = good;
  clipped.counts.col(4).setConstant(1023.0);
  EXPECT_THAT(ErrorOf(clipped), testing::ContainsRegex("index_mcp: has 0 poses besides [0-9]+ "
                                                       "at 0 or at full scale"));
  PoseRecording turned = good;
  for (Eigen::Index k = 0; k < turned.counts.rows(); ++k) {
    if (turned.angle_deg(k, 4) > 0.0) turned.counts(k, 4) = 500.0;
  }
  EXPECT_THAT(ErrorOf(turned), HasSubstr("index_mcp: its counts do not follow its angle one way"));
}

class PoseFile : public testing::Test {
 protected:
  PoseRecording Load(const std::string& text, const PoseRecordingFormat& format = {}) {
    std::ofstream(folder_.path() / "poses.csv") << text;
    return LoadPoseRecording(folder_.path() / "poses.csv", format);
  }
  std::string ErrorOfFile(const std::string& text) {
    try {
      Load(text);
    } catch (const UserError& error) {
      return std::string(error.what()).substr((folder_.path().string() + "/").size());
    }
    return "";
  }
  static std::string Rows(int count, const std::string& cells) {
    std::string text;
    for (int k = 0; k < count; ++k) text += std::to_string(0.01 * k) + "," + cells + "\n";
    return text;
  }

  test::TemporaryDirectory folder_;
};

TEST_F(PoseFile, HasCountsAndAnglesOfEachChannelInAnyOrder) {
  const PoseRecording recording =
      Load("t_s,index_pip_rad,index_mcp_counts,index_mcp_deg,index_pip_counts\n" +
               Rows(6, "1.5707963267948966,100,30,200.5") + Rows(0, "") + "0.06,,101,30,\n" +
               "0.07,0,102,30,201\n0.08,0,103,,201\n" + "0.09,0,103,31,201\n0.1,0,104,31,201\n",
           {.settle_ms = 10.0});
  EXPECT_THAT(recording.channel_names, testing::ElementsAre("index_mcp", "index_pip"));
  EXPECT_EQ(recording.rows_left_out, 1u);
  EXPECT_NEAR(recording.rate_hz, 100.0, 1e-9);
  EXPECT_EQ(recording.resolution_counts, 0.0);
  ASSERT_EQ(recording.counts.rows(), 10);
  EXPECT_EQ(recording.counts(0, 1), 200.5);
  EXPECT_EQ(recording.counts(6, 0), 102.0);
  EXPECT_TRUE(std::isnan(recording.angle_deg(0, 1)));  // has not settled
  EXPECT_EQ(recording.angle_deg(1, 1), 90.0);
  EXPECT_TRUE(std::isnan(recording.angle_deg(7, 0)));  // not known
  EXPECT_TRUE(std::isnan(recording.angle_deg(8, 0)));  // known again, not settled
  EXPECT_EQ(recording.angle_deg(9, 0), 31.0);
}

TEST_F(PoseFile, LeavesGlitchesBeyondTheScaleOut) {
  const PoseRecording recording =
      Load("t_s,a_counts\n" + Rows(60, "5") + "0.6,65535\n0.61,5\n0.62,-1\n" + "0.63,5\n",
           {.full_scale_counts = {1023.0}});
  EXPECT_EQ(recording.counts.rows(), 62);
  EXPECT_EQ(recording.rows_beyond_scale, 2u);
  EXPECT_EQ(recording.rows_left_out, 0u);
  EXPECT_EQ(recording.counts.maxCoeff(), 5.0);
}

TEST_F(PoseFile, HasChannelsOfAnyName) {
  const PoseRecording recording =
      Load("t_s,Flex 1_counts,left.thumb_counts,index_mpc_counts\n" + Rows(12, "1,2,3"));
  EXPECT_THAT(recording.channel_names, testing::ElementsAre("Flex 1", "left.thumb", "index_mpc"));
}

TEST_F(PoseFile, MayBeATraceOrHaveNoAngles) {
  const PoseRecording trace =
      Load("t_s,true_angle_rad.index_mcp,counts.index_mcp,hand_angle_rad.index_mcp\n" +
           Rows(12, "0,7,nan"));
  EXPECT_THAT(trace.channel_names, testing::ElementsAre("index_mcp"));
  EXPECT_EQ(trace.angle_deg.cols(), 1);
  const PoseRecording still = Load("k,index_mcp_counts\n" + Rows(12, "7"), {.rate_hz = 250.0});
  EXPECT_EQ(still.angle_deg.cols(), 0);
  EXPECT_EQ(still.rate_hz, 250.0);
  EXPECT_EQ(still.resolution_counts, 1.0);
}

TEST_F(PoseFile, NamesThePlaceOfAMistake) {
  const std::string header = "t_s,index_mcp_counts,index_mcp_deg\n";
  EXPECT_EQ(ErrorOfFile(header + "0,1,2\n0.01,x,2\n"), "poses.csv:3:2: 'x' is not a number");
  EXPECT_EQ(ErrorOfFile(header + "0,1,2\n1,1,2\n2,1\n"),
            "poses.csv:4:2: the row has 2 of 3 values");
  EXPECT_THAT(ErrorOfFile(header + "0,1,2\n0,1,2\n"),
              HasSubstr("poses.csv:3:1: the time is 0 s, must be above the 0 s"));
  EXPECT_THAT(ErrorOfFile(header + "0,1,2\n,1,2\n"), HasSubstr(":3:1: the time is missing"));
  EXPECT_THAT(ErrorOfFile(header + "0,2000,2\n"),
              HasSubstr("poses.csv:2:2: is 2000 counts, must be from 0 to"));
  EXPECT_THAT(ErrorOfFile(header + Rows(20, "5,2") + "0.3,2000,2\n0.4,-1,2\n"),
              HasSubstr("poses.csv:22:2: is 2000 counts, must be from 0 to the converter's full "
                        "scale of 1023 (--full-scale); 2 of 22 rows have such values"));
  EXPECT_THAT(ErrorOfFile(header + "0,1,2\n"), HasSubstr("has 1 rows"));
  EXPECT_THAT(ErrorOfFile(header), HasSubstr("holds no table"));
  EXPECT_THAT(ErrorOfFile("t_s,a\n0,1\n"), HasSubstr("poses.csv:1:2: unknown column 'a'"));
  EXPECT_THAT(ErrorOfFile("t_s,index_mcp_deg\n0,1\n"), HasSubstr("no column of counts"));
  EXPECT_THAT(
      ErrorOfFile("index_mcp_counts,index_pip_counts,index_mcp_deg\n1,2,3\n"),
      HasSubstr(
          "poses.csv:1:2: 'index_pip' has counts but no known angle, add a column index_pip_deg"));
  EXPECT_THAT(ErrorOfFile("index_mcp_counts,index_mcp_deg,index_pip_deg\n1,2,3\n"),
              HasSubstr("poses.csv:1:3: 'index_pip' has a known angle but no counts"));
  EXPECT_THAT(ErrorOfFile("index_mcp_counts,index_mcp_deg,index_mcp_rad\n1,2,3\n"),
              HasSubstr("'index_mcp' appears twice"));
  EXPECT_THAT(ErrorOfFile(""), HasSubstr("holds no table"));
}

}  // namespace
}  // namespace gauntlet::sim
