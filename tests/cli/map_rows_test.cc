// Rows of a column map do the same to samples in run, compare FILE, filter and live.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/csv_line.h"
#include "sim/base/signal.h"
#include "tests/support/working_folder.h"

namespace gauntlet::test {
namespace {

constexpr int kMapRows = 150;
constexpr double kMapRate_hz = 100.0;

/// Rows of every kind. The first one rises all the time: its value is the number of the sample.
constexpr std::string_view kEveryRow =
    "column,channel,unit,scale,sign,offset,bits,raw_low,raw_high,deg_low,deg_high,weight,wraps_at,"
    "envelope_ms\n"
    "t_ms,time,ms,,,,,,,,,,,\n"
    "a,thumb_ip,deg,,-1,2,,,,,,,,\n"
    "b,index_mcp,rad,0.5,,0.1,,,,,,,,\n"
    "c,index_pip,counts,,,,12,,,,,,,\n"
    "d,middle_pip,counts,,,7,10,,,,,,,\n"
    "e,ring_mcp,share,0.01,,,,,,,,,,\n"
    "f,ring_pip,volts,,,,,2.4,1.2,0,90,0.5,,\n"
    "e,ring_pip,deg,,,,,,,,,0.5,,\n"
    "d,middle_mcp,counts,,,,10,,,,,-0.5,,\n"
    "c,middle_mcp,counts,,,,12,,,,,1,,\n"
    "w,little_mcp,deg,0.5,,-150,,,,,,,360,\n"
    "muscle,little_pip,counts,,,,,0,1,,,,,50\n";
constexpr int kMapChannels = 9;

std::string RecordingForMap() {
  std::string text = "t_ms,a,b,c,d,e,f,w,muscle\n";
  for (int k = 0; k < kMapRows; ++k) {
    const double share = 0.5 - 0.5 * std::cos(std::numbers::pi * k / kMapRate_hz);
    text +=
        fmt::format("{},{},{:.4f},{:.0f},{:.0f},{:.2f},{:.4f},{:.3f},{:.4f}\n", 10 * k,
                    -20.0 - 0.25 * k, 0.2 + 2.0 * share, 600.0 + 2400.0 * share,
                    200.0 + 500.0 * share, 10.0 + 80.0 * share, 2.4 - 1.2 * share,
                    std::fmod(300.0 + 100.0 * share, 360.0), (k % 2 == 0 ? -1 : 1) * (0.1 + share));
  }
  return text;
}

/// The columns of a CSV file whose names have this beginning and this end; rows x columns.
std::vector<std::vector<double>> CsvColumns(const std::string& text, std::string_view begin,
                                            std::string_view end) {
  std::vector<std::vector<double>> rows;
  std::vector<std::size_t> taken;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string_view> names = sim::SplitCells(line);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].starts_with(begin) && names[i].ends_with(end)) taken.push_back(i);
  }
  while (std::getline(lines, line)) {
    const std::vector<std::string_view> cells = sim::SplitCells(line);
    std::vector<double>& row = rows.emplace_back();
    for (const std::size_t column : taken) row.push_back(std::stod(std::string(cells[column])));
  }
  return rows;
}

class MapRows : public testing::Test {
 protected:
  std::string Run(const std::vector<std::string>& arguments) const {
    const ProgramResult result = folder_.Run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    return result.standard_output;
  }
  void SetUp() override {
    folder_.Write("glove.csv", RecordingForMap());
    folder_.Write("map.csv", std::string(kEveryRow));
    Run({"inspect", "glove.csv", "--map", "map.csv", "--write-scenario", "glove.yaml"});
  }
  /// The samples of a trial's controller, behind the converter of 12 bits [deg].
  std::vector<std::vector<double>> Samples(const std::string& trace) const {
    const auto ticks = CsvColumns(folder_.Read(trace), "linearised_angle_rad.", "");
    const auto ticks_per_sample = static_cast<std::size_t>(1000.0 / kMapRate_hz);
    std::vector<std::vector<double>> samples;
    for (std::size_t tick = 0; tick < ticks.size(); tick += ticks_per_sample) {
      samples.push_back(ticks[tick]);
      for (double& value : samples.back()) value *= sim::kDegPerRad;
    }
    return samples;
  }

  WorkingFolder folder_{GAUNTLET_PROGRAM};
};

TEST_F(MapRows, DoTheSameInRunCompareFilterAndLive) {
  const ProgramResult filtered =
      RunProgram({"/bin/sh", "-c",
                  fmt::format("cd {} && {} filter none --map map.csv < glove.csv",
                              folder_.path().string(), GAUNTLET_PROGRAM)});
  ASSERT_EQ(filtered.exit_code, 0) << filtered.standard_error;
  const auto expected_deg = CsvColumns(filtered.standard_output, "", "_deg");
  ASSERT_EQ(expected_deg.size(), kMapRows);
  ASSERT_EQ(expected_deg.front().size(), kMapChannels);
  // Half a count of 12 bits over the widest joint, and the rounding of a trace.
  constexpr double kConverter_deg = 0.5 * 135.0 / (0.8 * 4095.0) + 1e-4;
  Run({"run", "glove.yaml", "--controllers", "raw", "--csv", "--out", "run"});
  Run({"compare", "glove.csv", "--map", "map.csv", "--controllers", "raw", "--causes", "none",
       "--csv", "--out", "compared"});
  for (const char* out : {"run", "compared"}) {
    const auto samples_deg = Samples(fmt::format("{}/trace.raw.csv", out));
    ASSERT_GE(samples_deg.size(), kMapRows - 1) << out;
    const std::size_t rows = std::min<std::size_t>(samples_deg.size(), kMapRows);
    for (std::size_t k = 0; k < rows; ++k) {
      EXPECT_THAT(samples_deg[k],
                  testing::Pointwise(testing::DoubleNear(kConverter_deg), expected_deg[k]))
          << out << " " << k;
    }
  }
  Run({"live", "glove.yaml", "--controller", "raw", "--glove", "file:glove.csv", "--map", "map.csv",
       "--motors", "none", "--record", "live.csv", "--out", "live"});
  const auto live_deg = CsvColumns(folder_.Read("live.csv"), "", "_deg");
  ASSERT_GT(live_deg.size(), kMapRows / 2);
  for (const std::vector<double>& sample : live_deg) {
    const auto row = static_cast<std::size_t>(std::lround((sample[0] - 22.0) / 0.25));
    ASSERT_LT(row, expected_deg.size());
    constexpr double kSixDigits_deg = 1e-4;
    EXPECT_THAT(sample, testing::Pointwise(testing::DoubleNear(kSixDigits_deg), expected_deg[row]))
        << row;
  }
}

}  // namespace
}  // namespace gauntlet::test
