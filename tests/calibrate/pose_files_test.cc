// Recordings of known poses as a lab has them: columns of any name, poses in a table of their own,
// and stretches that somebody knows to be still.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/fit/calibration.h"
#include "sim/fit/pose_recording.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRate_hz = 100.0;
constexpr int kPoses = 4;
constexpr int kRowsPerPose = 300;

/// A noise of three counts that repeats only after 97 rows.
int NoiseOf(int row) { return (row * 37 % 97) % 7 - 3; }
/// Four poses of 3 s, the way from one to the next takes the first second.
int PoseOf(int row) { return row / kRowsPerPose; }
bool IsMoving(int row) { return row % kRowsPerPose < 100 && row >= 100; }
double AngleOf(int row) {
  const double to = 25.0 * PoseOf(row);
  return IsMoving(row) ? to - 25.0 + 0.25 * (row % kRowsPerPose) : to;
}
int CountsOf(int row, int channel) {
  return static_cast<int>(std::lround((channel == 0 ? 200.0 : 900.0) +
                                      (channel == 0 ? 6.0 : -5.0) * AngleOf(row))) +
         NoiseOf(row + 31 * channel);
}

class PoseFiles : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text) const {
    const std::string file = (folder_.path() / name).string();
    std::ofstream(file) << text;
    return file;
  }
  std::string ErrorOf(const std::string& file, const PoseRecordingFormat& format) const {
    try {
      LoadPoseRecording(file, format);
    } catch (const UserError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      return message;
    }
    return "";
  }
  /// The recording with known angles as columns.
  std::string OwnNames() const {
    std::string text = "t_s,index_mcp_counts,index_mcp_deg,index_pip_counts,index_pip_deg\n";
    for (int row = 0; row < kPoses * kRowsPerPose; ++row) {
      const std::string angle = IsMoving(row) ? "" : fmt::format("{}", AngleOf(row));
      text += fmt::format("{},{},{},{},{}\n", row / kRate_hz, CountsOf(row, 0), angle,
                          CountsOf(row, 1), angle);
    }
    return Write("own.csv", text);
  }
  /// The same from a stranger's software: a clock of its own, other names, more columns.
  std::string OfAStranger() const {
    std::string text = "stamp;flexA;comment;flexB;battery\n";
    for (int row = 0; row < kPoses * kRowsPerPose; ++row) {
      text += fmt::format("{};{};ok;{};3,7\n", 1'700'000'000'000LL + 10 * row, CountsOf(row, 0),
                          CountsOf(row, 1));
    }
    return Write("stranger.csv", text);
  }
  std::string Map(const std::string& bits = "") const {
    return Write("map.csv",
                 "column,channel,unit,scale,bits\nstamp,time,ms,,\nflexA,index_mcp,counts,"
                 "3.5," +
                     bits + "\nflexB,index_pip,counts,," + bits + "\n");
  }
  std::string Poses() const {
    std::string text = "name,start_s,end_s,index_pip_deg,index_mcp_rad\n";
    for (int pose = 0; pose < kPoses; ++pose) {
      text += fmt::format("pose {},{},{},{},{}\n", pose, 3.0 * pose + (pose > 0 ? 1.0 : 0.0),
                          3.0 * (pose + 1), 25.0 * pose, 25.0 * pose / kDegPerRad);
    }
    return Write("table.csv", text);
  }

  test::TemporaryDirectory folder_;
};

TEST_F(PoseFiles, AreTakenFromAnArrayOfSeveral) {
  std::string t, angle, counts;
  for (int row = 0; row < kPoses * kRowsPerPose; ++row) {
    const char* const comma = row == 0 ? "" : ",";
    t += fmt::format("{}{}", comma, row / kRate_hz);
    counts += fmt::format("{}{}", comma, CountsOf(row, 0));
    angle += comma + (IsMoving(row) ? std::string("null") : fmt::format("{}", AngleOf(row)));
  }
  const std::string file = Write(
      "poses.json", fmt::format("{{\"camera\": [[1, 2, 3], [4, 5, 6]], \"glove\": {{\"t\": [{}], "
                                "\"index_mcp_counts\": [{}], \"index_mcp_deg\": [{}]}}}}",
                                t, counts, angle));
  const PoseRecording recording = LoadPoseRecording(file, {.array = "glove"});
  EXPECT_THAT(recording.channel_names, ElementsAre("index_mcp"));
  EXPECT_EQ(recording.counts(5, 0), CountsOf(5, 0));
  EXPECT_THAT(ErrorOf(file, {.array = "hand"}), HasSubstr("holds no array hand, but camera"));
}

TEST_F(PoseFiles, OfAStrangerGiveWhatOurOwnWouldGive) {
  const PoseRecording own = LoadPoseRecording(OwnNames(), {});
  const PoseRecording other = LoadPoseRecording(OfAStranger(), {.map = Map(), .poses = Poses()});
  EXPECT_THAT(other.channel_names, ElementsAre("index_mcp", "index_pip"));
  EXPECT_NEAR(other.rate_hz, kRate_hz, 1e-6);
  ASSERT_EQ(other.counts.rows(), own.counts.rows());
  EXPECT_EQ(other.counts, own.counts) << "the map's scale must not matter";
  for (Eigen::Index k = 0; k < own.angle_deg.size(); ++k) {
    const double expected = own.angle_deg.data()[k];
    const double actual = other.angle_deg.data()[k];
    ASSERT_EQ(std::isnan(expected), std::isnan(actual)) << k;
    if (std::isnan(expected)) continue;
    ASSERT_NEAR(actual, expected, 1e-6) << k;
  }
  CurveErrors errors;
  const Calibration of_own = Calibrate(own, {}, errors);
  const Calibration of_other = Calibrate(other, {}, errors);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(of_other.channels[i].variance_counts2, of_own.channels[i].variance_counts2);
    EXPECT_EQ(of_other.linearisation.channels[i].counts, of_own.linearisation.channels[i].counts);
  }
}

TEST_F(PoseFiles, LastUntilTheNextPoseWithoutAnEnd) {
  const std::string table =
      Write("table.csv", "start_s,index_mcp_deg,index_pip_deg\n1,10,\n4,20,5\n8.005,30,6\n");
  const PoseRecording recording =
      LoadPoseRecording(OfAStranger(), {.map = Map(), .poses = table, .settle_ms = 0.0});
  const auto& angle_deg = recording.angle_deg;
  EXPECT_TRUE(std::isnan(angle_deg(99, 0)));
  EXPECT_EQ(angle_deg(100, 0), 10.0);
  EXPECT_TRUE(std::isnan(angle_deg(100, 1)));
  EXPECT_EQ(angle_deg(399, 0), 10.0);
  EXPECT_EQ(angle_deg(400, 1), 5.0);
  EXPECT_EQ(angle_deg(800, 0), 20.0);
  EXPECT_EQ(angle_deg(801, 0), 30.0);
  EXPECT_EQ(angle_deg(1199, 1), 6.0);
}

TEST_F(PoseFiles, TakeTheScaleOfTheConverterFromTheMap) {
  const PoseRecording recording = LoadPoseRecording(OfAStranger(), {.map = Map("12")});
  EXPECT_EQ(recording.converter(0).full_scale_counts, 4095.0);
  EXPECT_THAT(ErrorOf(OfAStranger(), {.map = Map("8")}), HasSubstr("full scale of 255"));
  const std::string bits =
      Write("bits.csv",
            "column,channel,unit,bits\nflexA,index_mcp,counts,12\nflexB,ring_mcp,counts,11\n");
  const PoseRecording mixed =
      LoadPoseRecording(OfAStranger(), {.min_counts = {0.0, -1000.0}, .map = bits});
  EXPECT_EQ(mixed.converter(0).full_scale_counts, 4095.0);
  EXPECT_EQ(mixed.converter(1).min_counts, -1000.0);
  EXPECT_EQ(mixed.converter(1).full_scale_counts, 1047.0);
}

/// The recording by own names, of a converter of 12 bits and a signed one of 10 bits.
TEST_F(PoseFiles, MayHaveAConverterForEachChannel) {
  std::string text = "t_s,index_mcp_counts,index_pip_counts,index_mcp_deg,index_pip_deg\n";
  for (int row = 0; row < kPoses * kRowsPerPose; ++row) {
    const bool first = PoseOf(row) == 0;  // saturated: the first channel above, the second below
    text += fmt::format("{},{},{},{},{}\n", row / kRate_hz, first ? 4095 : CountsOf(row, 0),
                        first ? -512 : CountsOf(row, 1) - 512, AngleOf(row), AngleOf(row));
  }
  const std::string file = Write("mixed.csv", text);
  const PoseRecordingFormat format = {
      .full_scale_counts = {4095.0, 511.0}, .min_counts = {0.0, -512.0}, .still = {{4.1, 5.9}}};
  const PoseRecording recording = LoadPoseRecording(file, format);
  EXPECT_EQ(recording.rows_beyond_scale, 0U);
  CurveErrors errors;
  const Calibration calibration = Calibrate(recording, {}, errors);
  EXPECT_EQ(calibration.linearisation.channels[0].counts.size(), 3U);
  EXPECT_EQ(calibration.linearisation.channels[1].counts.size(), 3U);
  EXPECT_THAT(ErrorOf(file, {.full_scale_counts = {4095.0}}),
              HasSubstr("is -512 counts, must be from 0 to the converter's full scale of 4095 "
                        "(--min-counts)"));
  EXPECT_EQ(ErrorOf(file, {.full_scale_counts = {1.0, 2.0, 3.0}}),
            "--full-scale: has 3 values, must have 1 for all channels or 2, one for each column of "
            "counts");
  EXPECT_EQ(ErrorOf(file, {.full_scale_counts = {511.0}, .min_counts = {0.0, 511.0}}),
            "--full-scale: is 511, must be above --min-counts, 511");
}

TEST_F(PoseFiles, AreStillWhereSomebodySaysSo) {
  // A slow drift of the glove that is no motion, or a motion of which somebody says that it is not.
  std::string text = "t_s,index_mcp_counts\n";
  for (int row = 0; row < 1000; ++row) {
    text +=
        fmt::format("{},{}\n", row / kRate_hz, (row < 600 ? 300 + row / 2 : 800) + NoiseOf(row));
  }
  const std::string file = Write("drift.csv", text);
  const auto r = [&](const std::vector<TimeStretch>& still) {
    CurveErrors errors;
    return Calibrate(LoadPoseRecording(file, {.still = still}), {}, errors);
  };
  double sum = 0.0;
  double squares = 0.0;
  for (int row = 700; row < 900; ++row) {
    sum += NoiseOf(row);
    squares += NoiseOf(row) * NoiseOf(row);
  }
  const double variance = (squares - sum * sum / 200.0) / 199.0 - 1.0 / 12.0;
  const Calibration said = r({{7.0, 9.0}});
  EXPECT_EQ(said.degrees_of_freedom, 199.0);
  EXPECT_NEAR(said.channels[0].variance_counts2, variance, 1e-2 * variance);
  EXPECT_EQ(r({{9.5, 9.9}, {7.0, 9.0}}).degrees_of_freedom, 199.0 + 39.0);
  EXPECT_NE(r({}).degrees_of_freedom, 199.0);

  EXPECT_EQ(ErrorOf(file, {.still = {{9.0, 10.0}}}), "");
  EXPECT_THAT(ErrorOf(file, {.still = {{9.0, 12.0}}}),
              HasSubstr("--still 9:12: the recording ends at 9.99 s"));
  EXPECT_THAT(ErrorOf(file, {.still = {{9.95, 10.0}}}),
              HasSubstr("--still 9.95:10: holds 5 samples, must have 10 or more"));
  EXPECT_THAT(ErrorOf(file, {.still = {{1.0, 3.0}, {2.0, 4.0}}}), HasSubstr("overlaps another"));
}

TEST_F(PoseFiles, NameTheirMistakes) {
  const std::string file = OfAStranger();
  const auto error = [&](const std::string& table) {
    return ErrorOf(file, {.map = Map(), .poses = Write("table.csv", table)});
  };
  const std::string head = "start_s,end_s,index_mcp_deg,index_pip_deg\n";
  EXPECT_THAT(error(head), HasSubstr("table.csv"));
  EXPECT_THAT(error(head + "2,1,0,0\n"), HasSubstr("table.csv:2:2: the pose ends at 1 s"));
  EXPECT_THAT(error(head + "1,3,0,0\n2,4,0,0\n"), HasSubstr("table.csv:3:1: the pose begins at 2"));
  EXPECT_THAT(error(head + ",3,0,0\n"), HasSubstr("table.csv:2:1: must be given"));
  EXPECT_THAT(error(head + "100,110,0,0\n"),
              HasSubstr("a pose begins at 100 s, the recording ends at 11.99 s"));
  EXPECT_THAT(error("start_s,index_mcp_deg\n1,2\n"), HasSubstr("there is no column index_pip_deg"));
  EXPECT_THAT(error("start_s,index_mpc_deg\n1,2\n"),
              HasSubstr("table.csv:1:2: 'index_mpc_deg' is no column of a table of poses"));
  EXPECT_THAT(ErrorOf(OwnNames(), {.poses = Poses()}),
              HasSubstr("own.csv:1:3: is a known angle: leave it out of the recording"));
  const std::string twice =
      Write("twice.csv", "column,channel,weight\nflexA,index_mcp,0.5\nflexB,index_mcp,0.5\n");
  EXPECT_THAT(ErrorOf(file, {.map = twice}), HasSubstr("is a second column of index_mcp"));
  std::string text = "time_s,index_mcp_counts\n";
  for (int row = 0; row < 20; ++row) text += fmt::format("{}e-9,{}\n", row, 500 + row);
  EXPECT_THAT(ErrorOf(Write("wrong_unit.csv", text), {}),
              HasSubstr("the times give 1e+09 samples per second, must be at most 1e+06"));
}

TEST_F(PoseFiles, MayHaveColumnsThatAreNoSensors) {
  std::string text = "t_s,index_mcp_counts,battery,note\n";
  for (int row = 0; row < 300; ++row) {
    text += fmt::format("{},{},3.7,ok\n", row / kRate_hz, 300 + NoiseOf(row));
  }
  const PoseRecording recording = LoadPoseRecording(Write("more.csv", text), {});
  EXPECT_THAT(recording.columns_unknown, ElementsAre("battery", "note"));
  EXPECT_THAT(recording.channel_names, ElementsAre("index_mcp"));
}

Signal ColumnOf(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
}

TEST(Resolution, IsTheStepOfTheConverter) {
  std::vector<double> counts;
  std::vector<double> volts;   // of 12 bits, with four digits behind the point
  std::vector<double> smooth;  // never rounded
  std::vector<double> even;    // whole numbers two apart
  for (int row = 0; row < 500; ++row) {
    const int level = 1000 + row * 37 % 41;
    counts.push_back(level);
    even.push_back(2 * level);
    volts.push_back(std::round(1e4 * level * 3.3 / 4095.0) / 1e4);
    smooth.push_back(level + 0.3 * std::sin(row));
  }
  EXPECT_EQ(ResolutionOf(ColumnOf(counts)), 1.0);
  EXPECT_EQ(ResolutionOf(ColumnOf(even)), 2.0);
  EXPECT_NEAR(ResolutionOf(ColumnOf(volts)), 3.3 / 4095.0, 1e-5);
  EXPECT_EQ(ResolutionOf(ColumnOf(smooth)), 0.0);
  // Too few values to tell, as of two poses without noise.
  EXPECT_EQ(ResolutionOf(ColumnOf({300.0, 300.0, 500.0, 500.0})), 1.0);
  EXPECT_EQ(ResolutionOf(ColumnOf({0.25, 0.5, 0.25, 0.5})), 0.0);
}

TEST_F(PoseFiles, GiveAFilterNoLessNoiseThanRounding) {
  // One sensor does not move at all, in counts and in volts.
  for (const double step : {1.0, 3.3 / 4095.0}) {
    std::string text = "t_s,index_mcp_counts,index_pip_counts\n";
    for (int row = 0; row < 1000; ++row) {
      text += fmt::format("{},{:.6f},{:.6f}\n", row / kRate_hz,
                          step * (500 + NoiseOf(row) + NoiseOf(row + 13)), step * 400);
    }
    CurveErrors errors;
    const Calibration calibration =
        Calibrate(LoadPoseRecording(Write("still.csv", text), {}), {}, errors);
    EXPECT_NEAR(calibration.resolution_counts, step, 1e-2 * step);
    controller::ControllerConfig config;
    config.filters = {controller::FilterConfig{controller::KalmanConfig{}}};
    UseCalibration(calibration, {"index_mcp", "index_pip"}, false, {true}, config);
    const std::vector<double>& r =
        std::get<controller::KalmanConfig>(config.filters[0].settings).noise.r;
    ASSERT_EQ(r.size(), 2u);
    EXPECT_GT(r[0], step * step / 12.0);
    EXPECT_NEAR(r[1], step * step / 12.0, 0.02 * step * step / 12.0) << step;
  }
}

}  // namespace
}  // namespace gauntlet::sim
