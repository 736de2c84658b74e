#include "sim/show/pages/difference_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "sim/score/score.h"

namespace gauntlet::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

StudyFolder Folder(const std::string& name, std::vector<double> jitter_by_seed) {
  StudyFolder folder;
  folder.name = name;
  folder.scenario.name = "door";
  folder.scenario.controllers = {{.name = "raw", .config = {}}};
  folder.scores.controllers = {"raw"};
  for (std::size_t i = 0; i < jitter_by_seed.size(); ++i) {
    folder.scores.seeds.push_back(static_cast<int>(i) + 1);
  }
  const std::vector<double> same(jitter_by_seed.size(), 2.0);
  folder.scores.has_metric.assign(Metrics().size(), true);
  folder.scores.summary = {{Metrics().size(), same}};
  folder.scores.summary[0][MetricIndex("jitter_rms_deg")] = std::move(jitter_by_seed);
  return folder;
}

std::string Text(const StudyFolder& a, const StudyFolder& b, const DifferenceDetail& detail = {},
                 const TerminalStyle& style = TerminalStyle::Unlimited()) {
  return TextOf(DifferenceText(a, b, CompareStudies(a, b), detail), style);
}

void SetAll(StudyFolder& folder, double value) {
  for (std::vector<double>& values : folder.scores.summary[0]) {
    for (double& of_seed : values) of_seed = value;
  }
}

TEST(DifferenceText, BeginsWithTheAnswer) {
  const StudyFolder a = Folder("out/a", {0.5, 0.5, 0.5});
  StudyFolder b = Folder("out/b", {0.25, 0.25, 0.25});
  b.scenario.seed = 3;
  const std::string text = Text(a, b);
  EXPECT_THAT(text, testing::StartsWith("Different: 1 setting and 1 of "));
  EXPECT_THAT(
      text,
      AllOf(HasSubstr("Changed: jitter of raw 0.500 -> 0.250\ndeg RMS (better)."),
            HasSubstr("\nseed: 1 -> 3\n"), HasSubstr("jitter  0.500  0.250  -0.25  better"),
            HasSubstr("A: out/a, door, seeds 1 to 3"), Not(HasSubstr("below the smallest")),
            Not(HasSubstr("tracking error")), Not(HasSubstr("95 % CI")), Not(HasSubstr("\033["))));
  EXPECT_THAT(Text(a, b, {.all = true}), HasSubstr("tracking error"));
  EXPECT_THAT(Text(a, b, {.verbose = true}), HasSubstr("95 % CI"));
  b = Folder("out/b", {0.4999, 0.4999, 0.4999});
  EXPECT_THAT(Text(a, b), HasSubstr("below the smallest relevant"));
}

TEST(DifferenceText, ShowsTheLargestDifferencesFirst) {
  StudyFolder a = Folder("a", {0.5, 0.5});
  StudyFolder b = a;
  SetAll(a, 2.0);
  SetAll(b, 2.01);
  b.scores.summary[0][MetricIndex("delay_ms")] = {400.0, 400.0};
  b.scores.summary[0][MetricIndex("jitter_rms_deg")] = {20.0, 20.0};
  const std::string text = Text(a, b);
  EXPECT_THAT(text, HasSubstr(". Largest: "));
  const std::size_t jitter = text.find("raw         jitter");
  EXPECT_LT(text.find("raw         delay"), text.size());
  EXPECT_LT(jitter, text.size());
  EXPECT_EQ(text.find("raw         tracking error"), std::string::npos);
  EXPECT_THAT(text, HasSubstr(" other scores changed (--verbose)."));
  EXPECT_LE(std::ranges::count(Text(a, b, {}, {}), '\n'), 20);
  EXPECT_THAT(Text(a, b, {.verbose = true}), Not(HasSubstr("(--verbose)")));
}

TEST(DifferenceText, ColoursBetterAndWorseOnATerminal) {
  const StudyFolder a = Folder("a", {0.5, 0.5});
  const StudyFolder b = Folder("b", {0.4, 0.4});
  EXPECT_THAT(Text(a, b, {}, {.table_width = TerminalStyle::kNoLimit, .colour = true}),
              HasSubstr("\033[1;32mbetter\033[0m"));
  EXPECT_THAT(Text(b, a, {}, {.table_width = TerminalStyle::kNoLimit, .colour = true}),
              HasSubstr("\033[33mworse\033[0m"));
}

TEST(DifferenceText, FitsTheTerminal) {
  const StudyFolder a = Folder("a", {0.5, 0.52, 0.49});
  const StudyFolder b = Folder("b", {0.4, 0.41, 0.38});
  for (const std::size_t width : {60, 80}) {
    std::istringstream table(Text(a, b, {.all = true}, {.width = width, .table_width = width}));
    std::string line;
    while (!line.starts_with("controller")) ASSERT_TRUE(std::getline(table, line));
    bool judged = false;
    while (std::getline(table, line) && !line.starts_with("A: ")) {
      EXPECT_LE(Width(line), width) << line;
      judged = judged || line.ends_with("better");
    }
    EXPECT_TRUE(judged);
  }
}

TEST(DifferenceText, SaysThatOneSeedHasNoInterval) {
  EXPECT_THAT(Text(Folder("a", {0.5}), Folder("b", {0.4})),
              AllOf(HasSubstr("one seed has no interval"), HasSubstr("A: a, door, seed 1,"),
                    Not(HasSubstr("chance alone"))));
}

TEST(DifferenceText, OfARunAndAComparisonIsOfTheSeedThatBothHave) {
  const StudyFolder comparison = Folder("comparison", {0.5, 0.9, 0.9});
  EXPECT_THAT(Text(Folder("run", {0.5}), comparison),
              AllOf(HasSubstr("A: run, door, seed 1,"),
                    HasSubstr(" scores of the common seed 1 without a difference.")));
  EXPECT_THAT(Text(Folder("run", {0.4}), comparison),
              AllOf(HasSubstr("\nScores of the common seed 1: one seed has no interval"),
                    HasSubstr("0.400  0.500   +0.1"), Not(HasSubstr("chance alone"))));
  StudyFolder other_seed = Folder("run", {0.5});
  other_seed.scores.seeds = {9};
  EXPECT_THAT(Text(other_seed, comparison),
              HasSubstr("Scores: no common seed, and one seed has no interval"));
}

TEST(DifferenceText, OfTheSameBeginsWithIt) {
  const StudyFolder a = Folder("a", {0.5, 0.6});
  EXPECT_THAT(Text(a, a), testing::StartsWith("Same: equal settings, and "));
}

}  // namespace
}  // namespace gauntlet::sim
