#include "sim/show/pages/score_table.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <regex>
#include <sstream>

#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr TerminalStyle kInOnePiece = {.width = 1000, .table_width = TerminalStyle::kNoLimit};

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The words of a text, sorted: what it says, wherever it stands.
std::vector<std::string> Words(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) words.push_back(word);
  std::ranges::sort(words);
  return words;
}

TEST(ScoreTable, ShowsTheGripOnlyWhereSomethingWasHeld) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  const auto table = [&] { return TextOf(ScoreText(made, true), kInOnePiece); };
  EXPECT_THAT(table(), HasSubstr("ripple"));
  EXPECT_THAT(table(), HasSubstr("0.01 N or 7 %"));
  for (ControllerSummary& controller : made.summary.controllers) {
    controller.summary[MetricIndex("grip_force_ripple_n")].mean =
        std::numeric_limits<double>::quiet_NaN();
  }
  EXPECT_THAT(table(), Not(HasSubstr("ripple")));
  EXPECT_THAT(table(), HasSubstr("tracking"));
}

TEST(ScoreTable, OfOneSeedClaimsNoIntervalAndNoChance) {
  const test::MadeUpStudy one = test::MakeUpStudy({.seeds = 1});
  const std::string table = TextOf(ScoreText(one, true), kInOnePiece);
  EXPECT_THAT(table, HasSubstr("3 of 3 joints; seed 1; reference"));
  EXPECT_THAT(table, HasSubstr("For a recommendation, run several seeds (gauntlet compare)."));
  EXPECT_THAT(table, Not(HasSubstr("±")));
  EXPECT_THAT(table, Not(HasSubstr("*")));
  EXPECT_THAT(table, Not(HasSubstr("!")));
  const test::MadeUpStudy five = test::MakeUpStudy({});
  EXPECT_THAT(TextOf(ScoreText(five, true), kInOnePiece),
              AllOf(HasSubstr("seeds 1 to 5"), HasSubstr("±"), HasSubstr("* better, = equivalent"),
                    HasSubstr("One motion: the confidence intervals cover noise only."),
                    Not(HasSubstr("of 5 seeds"))));
}

TEST(ScoreTable, ShowsTheDifferenceThatItsMarksComeFrom) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  for (int s = 0; s < 5; ++s) {
    const double seed = 10.0 + 2.0 * std::sin(1.7 * s);  // the same for all
    constexpr double kMore[] = {0.0, 0.2, 3.0};
    for (int c = 0; c < 3; ++c) {
      made.result.seeds[s].controllers[c].scores.summary[tracking] =
          seed + kMore[c] + 0.001 * std::cos(3.1 * s + c);
    }
  }
  made.summary = Summarise(made.study, made.result);
  const MeanInterval& difference = made.summary.controllers[2].to_baseline[tracking].difference;
  const std::string table = TextOf(ScoreText(made, true), kInOnePiece);
  EXPECT_THAT(table, HasSubstr(fmt::format("{:+.3f}±{:.3f}", difference.mean,
                                           difference.high - difference.mean)));
  EXPECT_THAT(table, Not(HasSubstr("±2")));  // no interval of a mean, which the seeds make wide
  EXPECT_EQ(made.summary.controllers[1].AgainstBaseline(tracking), Judgement::kEqual);
  EXPECT_EQ(made.summary.MarkOf(2, tracking), '!');
}

TEST(ScoreTable, OfOneControllerShowsItsOwnInterval) {
  const test::MadeUpStudy made = test::MakeUpStudy({.controllers = 1});
  EXPECT_THAT(TextOf(ScoreText(made, true), kInOnePiece),
              AllOf(HasSubstr("±0."), HasSubstr("95 % confidence interval of the mean"),
                    Not(HasSubstr("best")), Not(HasSubstr("pairs"))));
}

TEST(ScoreTable, FitsTheTerminal) {
  const test::MadeUpStudy made = test::MakeUpStudy({.controllers = 4});
  for (const std::size_t width : {40u, 60u, 80u, 100u, 140u}) {
    for (const std::string& line :
         Lines(TextOf(ScoreText(made, true), {.width = width, .table_width = width}))) {
      EXPECT_LE(Width(line), width) << line;
    }
  }
}

TEST(ScoreTable, InPiecesSaysTheSameAsInOne) {
  const test::MadeUpStudy made = test::MakeUpStudy({.controllers = 4});
  const std::string narrow = TextOf(ScoreText(made, true), {.width = 60, .table_width = 60});
  // At 80, seven metrics need two pieces; each names the controllers again.
  const auto count = [](const std::string& text, const std::string& word) {
    return std::ranges::count(Words(text), word);
  };
  const std::string one_piece = TextOf(ScoreText(made, true), {.width = 60, .table_width = 10'000});
  EXPECT_EQ(count(one_piece, "filter_3"), 5);  // answer, warning, scores, causes and their shares
  EXPECT_GT(count(narrow, "filter_3"), 4);
  // A difference and its interval stand side by side in the one, below each other in the other.
  const auto values = [](std::string text) {
    for (std::size_t at = 0; (at = text.find("±", at)) != std::string::npos; at += 3) {
      text.insert(at, " ");
    }
    std::vector<std::string> words = Words(text);
    const auto is_no_value = [](const std::string& word) {
      return word.find_first_of("0123456789") == std::string::npos || word.starts_with("filter_");
    };
    std::erase_if(words, is_no_value);
    return words;
  };
  EXPECT_EQ(values(narrow), values(one_piece));
}

TEST(ScoreTable, GivesALongNameALineOfItsOwn) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  made.summary.controllers[1].name = std::string(60, 'x');
  const std::string table = TextOf(ScoreText(made, true), {.width = 60, .table_width = 60});
  EXPECT_THAT(table, HasSubstr("\n" + std::string(60, 'x') + "\n    "));
}

TEST(ScoreTable, HasColoursOnlyWhereAsked) {
  const test::MadeUpStudy made = test::MakeUpStudy({});
  const std::string coloured = TextOf(ScoreText(made, true), {.colour = true});
  std::string plain = TextOf(ScoreText(made, true), {.colour = false});
  EXPECT_THAT(plain, Not(HasSubstr("\033")));
  // The baseline has the first colour of the palette, the best of the others the next.
  EXPECT_THAT(coloured, HasSubstr("\033[38;5;241mraw\033[0m "));
  EXPECT_THAT(coloured, HasSubstr("\033[38;5;25mfilter_"));
  EXPECT_EQ(std::regex_replace(coloured, std::regex("\033\\[[0-9;]*m"), ""), plain);
}

TEST(ScoreTable, TellsWhoseTheScatterIs) {
  test::MadeUpStudy made = test::MakeUpStudy({.seeds = 6});
  for (int s = 0; s < 6; ++s) made.result.seeds[s].motion = s % 3;
  made.summary = Summarise(made.study, made.result);
  EXPECT_THAT(
      TextOf(ScoreText(made, true), kInOnePiece),
      AllOf(HasSubstr("Replicates: 3 motions."), Not(HasSubstr("One motion")),
            HasSubstr("Variance of the tracking error:"), HasSubstr("% between noise seeds")));
}

TEST(ScoreTable, NamesWhatFailedAndDoesNotRankIt) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  TrialOutcome& trial = made.result.seeds[1].controllers[1];
  trial.health = {.ok = false, .problem = "at 0.1 s: bad value in qacc (dof 12)"};
  trial.scores.summary.assign(Metrics().size(), std::numeric_limits<double>::quiet_NaN());
  made.summary = Summarise(made.study, made.result);
  const std::string table = TextOf(ScoreText(made, true), kInOnePiece);
  EXPECT_THAT(table, HasSubstr("filter_1 failed in 1 of 5 trials and is not ranked: at 0.1 s: bad "
                               "value in qacc (dof 12) (seed 2)\n"));
  EXPECT_THAT(made.summary.answer.verdict.Text(), Not(HasSubstr("filter_1")));
  const std::size_t row = table.find("\nfilter_1 ") + 1;
  EXPECT_THAT(table.substr(row, table.find('\n', row) - row),
              AllOf(HasSubstr("failed"), Not(HasSubstr("*")), Not(HasSubstr("="))));
}

TEST(ScoreTable, SaysWhenEverySeedGivesTheSameRun) {
  test::MadeUpStudy made = test::MakeUpStudy({.seeds = 1});
  made.result.seeds_alike = true;
  EXPECT_THAT(TextOf(ScoreText(made, true), kInOnePiece),
              HasSubstr("The input is fixed, so one run was made."));
}

TEST(ScoreTable, NamesTheBaselineAndIsSilentWithoutOne) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  made.study.scenario.baseline = "filter_1";
  made.summary = Summarise(made.study, made.result);
  EXPECT_THAT(TextOf(ScoreText(made, true), kInOnePiece), HasSubstr("(compared with filter_1)"));
  made.study.scenario.baseline.clear();
  made.study.scenario.controllers.front().config = made.study.scenario.controllers.back().config;
  made.summary = Summarise(made.study, made.result);
  EXPECT_THAT(TextOf(ScoreText(made, true), kInOnePiece),
              AllOf(HasSubstr("baseline: NAME"), Not(HasSubstr("compared with"))));
}

TEST(ScoreTable, TellsOfHowManySeedsAScoreIs) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::size_t delay = MetricIndex("delay_ms");
  for (const int seed : {0, 2}) made.result.seeds[seed].controllers[1].scores.summary[delay] = kNaN;
  for (SeedOutcome& seed : made.result.seeds) seed.controllers[2].scores.summary[delay] = kNaN;
  made.summary = Summarise(made.study, made.result);
  const std::string table = TextOf(ScoreText(made, true), kInOnePiece);
  EXPECT_THAT(table,
              HasSubstr("filter_1: delay is the mean of 3 of 5 seeds; the others have no value\n"));
  EXPECT_THAT(table, Not(HasSubstr("filter_2: delay is")));  // a "-" shows it
}

}  // namespace
}  // namespace gauntlet::sim
