#include "sim/show/video/score_board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "sim/base/error.h"
#include "sim/show/video/card.h"
#include "tests/video/test_files.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

constexpr const char* kScores = R"({
  "seeds": [1, 2, 3], "baseline": "raw",
  "controllers": [
    {"name": "raw",
     "summary": {"tracking_rmse_deg": {"mean": 6.444}, "delay_ms": {"mean": 104.2},
                 "jitter_rms_deg": {"mean": 0.2781}}},
    {"name": "slow",
     "summary": {"tracking_rmse_deg": {"mean": null}, "delay_ms": {"mean": 117.0},
                 "jitter_rms_deg": {"mean": 0.1005}},
     "difference_to_baseline": {
         "tracking_rmse_deg": {"mean": null, "low": null, "high": null, "verdict": null},
         "delay_ms": {"mean": 12.8, "low": 9.0, "high": 16.6, "verdict": "worse"},
         "jitter_rms_deg": {"mean": -0.1776, "low": -0.1916, "high": -0.1636,
                            "verdict": "better"}}},
    {"name": "near",
     "summary": {"tracking_rmse_deg": {"mean": 6.456}, "delay_ms": {"mean": 107.0},
                 "jitter_rms_deg": {"mean": 0.2701}},
     "difference_to_baseline": {
         "tracking_rmse_deg": {"mean": 0.012, "low": -0.008, "high": 0.032, "verdict": "equal"},
         "delay_ms": {"mean": 2.8, "low": -1.0, "high": 6.6, "verdict": "undecided"},
         "jitter_rms_deg": {"mean": -0.008, "low": -0.02, "high": 0.004,
                            "verdict": "equal"}}}]})";

class ScoreBoardTest : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& text) const {
    std::ofstream(folder_.path() / "scores.json") << text;
    return folder_.path() / "scores.json";
  }
  TemporaryFolder folder_;
};

TEST_F(ScoreBoardTest, ComparesWithTheBaselineAsTheTableDoes) {
  const ScoreBoard verdict = ReadScoreBoard(Write(kScores), {"slow", "near", "raw"});
  ASSERT_EQ(verdict.rows.size(), 3u);
  const ScoreBoardRow &slow = verdict.rows[0], &near = verdict.rows[1], &raw = verdict.rows[2];
  EXPECT_EQ(slow.controller, "slow");
  EXPECT_EQ(slow.cells[0].value, "–");
  EXPECT_EQ(slow.cells[0].detail, "");
  EXPECT_EQ(slow.cells[1].detail, "+13 ± 4: worse");
  EXPECT_EQ(slow.cells[1].tone, ScoreBoardCell::Tone::kWorse);
  EXPECT_EQ(slow.cells[2].detail, "-0.178 ± 0.014: better");
  EXPECT_EQ(slow.cells[2].tone, ScoreBoardCell::Tone::kBetter);
  EXPECT_EQ(near.cells[0].detail, "+0.01 ± 0.02: equivalent");
  EXPECT_EQ(near.cells[0].tone, ScoreBoardCell::Tone::kPlain);
  EXPECT_EQ(near.cells[1].detail, "+3 ± 4: undecided");
  EXPECT_EQ(raw.cells[0].value, "6.44°");
  EXPECT_EQ(raw.cells[1].value, "104 ms");
  EXPECT_EQ(raw.cells[2].value, "0.278°");
  EXPECT_EQ(raw.cells[2].detail, "");
  EXPECT_THAT(verdict.remark, HasSubstr("3 seeds"));
  EXPECT_THAT(verdict.remark, HasSubstr("Differences to raw"));
}

TEST_F(ScoreBoardTest, ComparesWithNothingThatIsNotOnIt) {
  const ScoreBoard verdict = ReadScoreBoard(Write(kScores), {"slow", "near"});
  for (const ScoreBoardRow& row : verdict.rows) {
    for (const ScoreBoardCell& cell : row.cells) {
      EXPECT_EQ(cell.detail, "");
      EXPECT_EQ(cell.tone, ScoreBoardCell::Tone::kPlain);
    }
  }
  EXPECT_EQ(verdict.remark, "Mean over 3 seeds.");
}

TEST_F(ScoreBoardTest, OneRunSaysNothingAboutChance) {
  std::string scores = kScores;
  scores.replace(scores.find("[1, 2, 3]"), 9, "[1]");
  const ScoreBoard verdict = ReadScoreBoard(Write(scores), {"slow", "raw"});
  EXPECT_EQ(verdict.rows[0].cells[2].value, "0.101°");
  EXPECT_EQ(verdict.remark, "One run: no confidence interval.");

  const ScoreBoard run =
      ReadScoreBoard(Write(R"({"seed": 1, "controllers": [{"name": "raw", "summary":
          {"tracking_rmse_deg": 6.444, "delay_ms": null, "jitter_rms_deg": 0.2781}}]})"),
                     {"raw"});
  EXPECT_EQ(run.rows[0].cells[0].value, "6.44°");
  EXPECT_EQ(run.rows[0].cells[1].value, "–");
  EXPECT_EQ(run.rows[0].cells[2].detail, "");
}

TEST_F(ScoreBoardTest, WhatIsNoScoresFileIsTheUsersMistake) {
  EXPECT_THROW(ReadScoreBoard(Write("{\"controllers\": 3}"), {"raw"}), UserError);
  EXPECT_THROW(ReadScoreBoard(Write("[1"), {"raw"}), UserError);
  EXPECT_THROW(ReadScoreBoard(folder_.path() / "none.json", {"raw"}), UserError);
  EXPECT_THROW(ReadScoreBoard(Write(kScores), {"rav"}), UserError);
}

TEST_F(ScoreBoardTest, CardsHoldTheirTextInsideTheFrame) {
  const ScoreBoard verdict = ReadScoreBoard(Write(kScores), {"slow", "raw"});
  for (const auto& [width, height] : {std::pair(1280, 720), std::pair(480, 270)}) {
    const Rect frame = {0.0, 0.0, double(width), double(height)};
    const double unit = std::min(width / 1280.0, height / 720.0);
    for (const bool title : {true, false}) {
      Image image(width, height);
      {
        const std::unique_ptr<Painter> opened = OpenPainter(image);
        Painter& painter = *opened;
        if (title) {
          DrawTitleCard(painter, frame, unit, "a_scenario", std::string(60, 'w') + " or not?");
        } else {
          DrawScoreBoard(painter, frame, unit, "a_scenario", verdict);
        }
      }
      int dark = 0;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          if ((image.Row(y)[x] >> 8 & 255) > 120) continue;
          ++dark;
          ASSERT_GT(x, 20 * unit);
          ASSERT_LT(x, width - 20 * unit);
        }
      }
      EXPECT_GT(dark, 100 * unit) << width << " " << title;
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
