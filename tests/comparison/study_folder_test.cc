#include "sim/answers/compare/study_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "sim/answers/compare/study_files.h"
#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

/// Two seeds, two controllers, one channel; every value tells where it belongs, one is missing.
StudyResult MadeUpResult() {
  StudyResult result;
  result.controller_names = {"raw", "mean"};
  result.row_names = {"index_mcp"};
  for (const int seed : {4, 5}) {
    SeedOutcome outcome{.seed = seed, .controllers = {}};
    for (int controller = 0; controller < 2; ++controller) {
      TrialOutcome trial;
      for (std::size_t m = 0; m < Metrics().size(); ++m) {
        trial.scores.summary.push_back(100.0 * seed + 10.0 * controller +
                                       0.1 * static_cast<double>(m));
      }
      trial.scores.channels = {std::vector<double>(Metrics().size(), -1.0)};
      outcome.controllers.push_back(std::move(trial));
    }
    result.seeds.push_back(std::move(outcome));
  }
  result.seeds[1].controllers[0].scores.summary.back() = kNaN;
  return result;
}

TEST(ParseScoresCsv, ReadsBackWhatWasWritten) {
  const StudyResult written = MadeUpResult();
  const ScoreFile read = ParseScoresCsv("scores.csv", ScoresCsv(written));
  EXPECT_EQ(read.seeds, (std::vector<int>{4, 5}));
  EXPECT_EQ(read.controllers, written.controller_names);
  EXPECT_EQ(read.channels, written.row_names);
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t c = 0; c < 2; ++c) {
      for (std::size_t m = 0; m < Metrics().size(); ++m) {
        const double value = written.seeds[s].controllers[c].scores.summary[m];
        const double again = read.summary[c][m][s];
        EXPECT_TRUE(value == again || (std::isnan(value) && std::isnan(again)))
            << s << ' ' << c << ' ' << Metrics()[m].key;
      }
    }
  }
}

TEST(ParseScoresCsv, ReadsWhatASpreadsheetSaved) {
  const std::string written = ScoresCsv(MadeUpResult());
  std::string saved = "\xEF\xBB\xBF";
  for (const char c : written) saved += c == '\n' ? "\r\n" : std::string(1, c);
  const ScoreFile plain = ParseScoresCsv("scores.csv", written);
  const ScoreFile read = ParseScoresCsv("scores.csv", saved);
  EXPECT_EQ(read.seeds, plain.seeds);
  EXPECT_EQ(read.channels, plain.channels);
  EXPECT_EQ(read.summary[1], plain.summary[1]);
  EXPECT_TRUE(std::isnan(read.summary[0].back()[1]));  // the last field of its line
}

TEST(ParseScoresCsv, ReadsAFileThatLacksAMetric) {
  // An older version knew no delay: the column goes, and its field in every row.
  std::string older;
  std::istringstream lines(ScoresCsv(MadeUpResult()));
  const std::size_t column = 3 + MetricIndex("delay_ms");
  for (std::string line; std::getline(lines, line);) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < column; ++i) begin = line.find(',', begin) + 1;
    older += line.erase(begin, line.find(',', begin) + 1 - begin) + "\n";
  }
  const ScoreFile read = ParseScoresCsv("scores.csv", older);
  EXPECT_FALSE(read.has_metric[MetricIndex("delay_ms")]);
  EXPECT_TRUE(read.has_metric[MetricIndex("peak_error_deg")]);
  EXPECT_TRUE(std::isnan(read.summary[0][MetricIndex("delay_ms")][0]));
  EXPECT_EQ(read.summary[0][MetricIndex("peak_error_deg")][0],
            MadeUpResult().seeds[0].controllers[0].scores.summary[MetricIndex("peak_error_deg")]);
}

std::string Complaint(const std::string& text) {
  try {
    ParseScoresCsv("scores.csv", text);
  } catch (const UserError& error) {
    return error.what();
  }
  return "none";
}

/// The text with its first `what` replaced.
std::string With(std::string text, const std::string& what, const std::string& replacement) {
  return text.replace(text.find(what), what.size(), replacement);
}

TEST(ParseScoresCsv, NamesThePlaceOfWhatIsWrong) {
  const std::string good = ScoresCsv(MadeUpResult());
  EXPECT_EQ(Complaint(good), "none");
  EXPECT_EQ(Complaint(""), "scores.csv: holds no scores");
  EXPECT_EQ(Complaint(With(good, "delay_ms", "lag_ms")),
            "scores.csv:1:5: unknown column lag_ms; written by another version?");
  EXPECT_EQ(Complaint(With(good, "seed,controller", "controller,seed")),
            "scores.csv:1: must begin with the columns seed,controller,channel");
  EXPECT_EQ(Complaint(With(good, "\n4,", "\nfour,")),
            "scores.csv:2:1: seed is \"four\", must be a whole number");
  for (const char* text : {"4oo", "nan", "inf", "-inf", "1e999", " "}) {
    EXPECT_EQ(Complaint(With(good, "raw,summary,400,", fmt::format("raw,summary,{},", text))),
              fmt::format("scores.csv:2:4: tracking_rmse_deg is \"{}\", must be a number, or "
                          "empty where there is no score",
                          text));
  }
  EXPECT_EQ(Complaint(With(good, "raw,summary,400,", "raw,summary,")),
            fmt::format("scores.csv:2: has {} fields, must have {}", Metrics().size() + 2,
                        Metrics().size() + 3));
  EXPECT_EQ(Complaint(With(good, "raw,index_mcp", "raw,summary")),
            "scores.csv:3: seed, controller and channel appear twice");
  EXPECT_EQ(Complaint(good.substr(0, good.rfind("5,mean,index_mcp"))),
            "scores.csv: has 7 rows, must have 8: one per seed, controller and channel");
}

}  // namespace
}  // namespace gauntlet::sim
