// One answer in all outputs: random studies and searches, of which terminal, page, JSON and video
// have to show the same order, roles, marks and setting.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "sim/answers/compare/comparison_verdict.h"
#include "sim/answers/compare/study_files.h"
#include "sim/answers/tune/tune_tables.h"
#include "sim/base/json.h"
#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/results/html_text.h"
#include "sim/show/pages/pages.h"
#include "sim/show/pages/score_table.h"
#include "sim/show/video/score_board.h"
#include "tests/report/made_up_study.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using Marks = std::map<std::pair<std::string, std::size_t>, char>;  // controller, metric

// --- random studies -----------------------------------------------------------------------------

/// Means that are equal, slightly or clearly different, with scatter; copies of controllers; values
/// that are missing in some or all seeds; failed trials; with and without a baseline, bounds and
/// several runs.
test::MadeUpStudy RandomStudy(RandomStream& random) {
  const auto happens = [&](double share) { return random.Uniform() < share; };
  test::MadeUpStudy made =
      test::MakeUpStudy({.samples = 20,
                         .channels = 1,
                         .controllers = 2 + static_cast<int>(random.Index(5)),
                         .seeds = happens(0.1) ? 1 : 2 + static_cast<int>(random.Index(9))});
  StudyResult& result = made.result;
  Scenario& scenario = made.study.scenario;
  if (happens(0.25)) scenario.controllers.front().config = scenario.controllers.back().config;
  if (happens(0.2)) scenario.baseline = scenario.controllers[1].name;
  constexpr const char* kPriorities[] = {"tracking", "delay", "jitter", "tracking, delay_ms<=10"};
  scenario.priority = kPriorities[random.Index(4)];
  const double scatter = happens(0.5) ? 0.05 : 0.6;  // over D
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    const double d = RelevantDifferenceBetween(Metrics()[m], 10.0, 10.0);
    std::vector<double> before;
    for (std::size_t c = 0; c < result.controller_names.size(); ++c) {
      const bool is_copy = c > 0 && happens(0.15);
      const double side = happens(0.5) ? 1.0 : -1.0;
      const double offset = happens(0.3)   ? 0.0
                            : happens(0.5) ? side * random.Uniform(0.2, 0.8)
                                           : side * random.Uniform(1.5, 4.0);
      const double missing = happens(0.02) ? 1.0 : happens(0.05) ? 0.4 : 0.0;
      std::vector<double> values;
      for (std::size_t s = 0; s < result.seeds.size(); ++s) {
        const double own = 10.0 + d * (offset + scatter * BoxMuller(random).first);
        values.push_back(happens(missing) ? kNaN : is_copy ? before[s] : own);
        result.seeds[s].controllers[c].scores.summary[m] = values.back();
      }
      before = values;
    }
  }
  if (happens(0.1)) {
    TrialOutcome& trial = result.seeds[0].controllers[random.Index(2)];
    trial.health = {.ok = false, .problem = "diverged"};
    trial.scores.summary.assign(Metrics().size(), kNaN);
  }
  made.comparison = true;
  made.summary = Summarise(made.study, result);
  return made;
}

// --- what the outputs show ----------------------------------------------------------------------

/// A table of controllers, as an output shows it.
struct Shown {
  std::vector<std::string> order;
  std::map<std::string, std::string> roles;
  Marks marks;
};

char MarkOf(const std::string& value) {
  return value.find_last_of("*=!?") == value.size() - 1 && !value.empty() ? value.back() : ' ';
}

/// Tables of a terminal's text without limits of width: rows behind the line that begins with
/// "controller". The last column has words if `has_roles`.
Shown TableOf(std::istringstream& lines, const std::vector<std::size_t>& metrics) {
  Shown shown;
  std::string line;
  while (std::getline(lines, line) && !line.starts_with("controller ")) {
  }
  while (std::getline(lines, line) && !line.empty()) {
    if (line.starts_with(" ")) continue;  // differences
    std::istringstream words(line);
    std::string name, word, role;
    words >> name;
    shown.order.push_back(name);
    for (const std::size_t metric : metrics) {
      words >> word;
      shown.marks[{name, metric}] = MarkOf(word);
    }
    std::getline(words >> std::ws, role);
    shown.roles[name] = role;
  }
  return shown;
}

std::string Between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  if (begin == std::string::npos) return "";
  return text.substr(begin + from.size(), text.find(to, begin + from.size()) - begin - from.size());
}

/// The table of a page.
Shown HtmlTableOf(const std::string& html, const std::vector<std::size_t>& metrics) {
  Shown shown;
  const std::string body = Between(html, "<tbody>", "</tbody>");
  for (std::size_t at = body.find("<tr>"); at != std::string::npos;
       at = body.find("<tr>", at + 1)) {
    std::string row = Between(body.substr(at), "<tr>", "</tr>");
    const std::string name = Between(row, "<th scope=\"row\">", "</th>");
    shown.order.push_back(name);
    for (std::size_t i = 0; i <= metrics.size(); ++i) {
      const std::size_t begin = row.find("<td");
      if (begin == std::string::npos) break;
      row = row.substr(begin);
      const std::string value = Between(row, ">", "</td>");
      if (i == metrics.size()) {
        shown.roles[name] = value;
      } else {
        const char mark = MarkOf(value);
        shown.marks[{name, metrics[i]}] = mark;
        EXPECT_EQ(row.starts_with("<td class=\"good\""), mark == '*') << row;
        EXPECT_EQ(row.starts_with("<td class=\"warn\""), mark == '!') << row;
      }
      row = row.substr(3);
    }
  }
  return shown;
}

std::vector<std::size_t> MetricsOfAnswer(const Summary& summary, bool primary_alone) {
  std::vector<std::size_t> metrics = ShownMetrics(summary);
  std::erase_if(metrics, [&](std::size_t metric) {
    const bool is_primary = std::ranges::count(PrimaryScores(), metric, &PrimaryScore::metric) > 0;
    return !is_primary && (primary_alone || Metrics()[metric].part == ScoredPart::kJoint);
  });
  return metrics;
}

// --- the answer of scores.json, which the others have to show -----------------------------------

struct Answer {
  std::string recommended;  // may be empty
  std::string baseline;     // may be empty
  std::vector<std::string> order, shown, reasons;
  std::map<std::string, std::string> roles;
  Marks marks;
};

/// Marks follow from the printed intervals alone.
Answer AnswerIn(const Json& scores) {
  Answer answer;
  if (!scores["verdict"]["recommended"].is_null()) {
    answer.recommended = scores["verdict"]["recommended"].get<std::string>();
  }
  if (!scores["baseline"].is_null()) answer.baseline = scores["baseline"].get<std::string>();
  answer.order = scores["order"].get<std::vector<std::string>>();
  answer.shown = scores["shown"].get<std::vector<std::string>>();
  for (const Json& reason : scores["verdict"]["reasons"]) {
    answer.reasons.push_back(reason["text"].get<std::string>());
  }
  for (const Json& controller : scores["controllers"]) {
    const auto name = controller["name"].get<std::string>();
    answer.roles[name] = controller["role"].get<std::string>();
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      answer.marks[{name, m}] = ' ';
      if (!controller.contains("difference_to_baseline")) continue;
      const Json& all = controller["difference_to_baseline"];
      if (!all.contains(std::string(Metrics()[m].key))) continue;
      const Json& difference = all[std::string(Metrics()[m].key)];
      if (difference["verdict"].is_null()) continue;
      const auto number = [&](const char* key) {
        return difference[key].is_null() ? kNaN : difference[key].get<double>();
      };
      const Judgement judgement =
          JudgeDifference({.mean = number("mean"), .low = number("low"), .high = number("high")},
                          number("relevant_difference"), Metrics()[m].lower_is_better);
      EXPECT_EQ(difference["verdict"], JudgementText(judgement));
      answer.marks[{name, m}] = judgement == Judgement::kBetter  ? '*'
                                : judgement == Judgement::kEqual ? '='
                                : judgement == Judgement::kWorse ? '!'
                                                                 : '?';
    }
  }
  return answer;
}

/// `rows`: names that the table has to show, in this order.
void ExpectTable(const Answer& answer, const std::vector<std::string>& rows, const Shown& table,
                 bool has_roles) {
  EXPECT_EQ(table.order, rows);
  for (const auto& [key, mark] : table.marks) {
    EXPECT_EQ(mark, answer.marks.at(key)) << key.first << " " << Metrics()[key.second].key;
  }
  if (!has_roles) return;
  for (const auto& [name, role] : table.roles) EXPECT_EQ(role, answer.roles.at(name)) << name;
}

void ExpectTerminal(const Answer& answer, const FinishedStudy& finished) {
  for (const bool verbose : {false, true}) {
    const std::string text =
        TextOf(ScoreText(finished, verbose),
               {.width = TerminalStyle::kNoLimit, .table_width = TerminalStyle::kNoLimit});
    for (const std::string& reason : answer.reasons) {
      EXPECT_NE(text.find(reason), std::string::npos) << reason << "\n" << text;
    }
    std::istringstream lines(text);
    ExpectTable(answer, answer.order, TableOf(lines, MetricsOfAnswer(finished.summary, false)),
                true);
    if (!verbose) continue;
    ExpectTable(answer, answer.order, TableOf(lines, DetailedMetrics(finished.summary)), false);
  }
}

void ExpectPage(const Answer& answer, const test::MadeUpStudy& made) {
  ExpectTable(answer, answer.order,
              HtmlTableOf(HtmlOf(AnswerText(made)), MetricsOfAnswer(made.summary, false)), true);
  std::vector<std::string> first;
  for (const std::string& name : answer.order) {
    const bool is_shown = std::ranges::count(answer.shown, name) > 0;
    if (is_shown && name != answer.baseline) first.push_back(name);
  }
  if (!answer.baseline.empty()) first.push_back(answer.baseline);
  ExpectTable(answer, first,
              HtmlTableOf(HtmlOf(ShownText(made)), MetricsOfAnswer(made.summary, true)), true);
  const Json data = PageData(made, made.first_seed());
  std::vector<std::string> order, shown;
  for (const Json& c : data["order"]) {
    order.push_back(data["controllers"][c.get<std::size_t>()]["name"].get<std::string>());
  }
  for (const Json& c : data["shown"]) {
    shown.push_back(data["controllers"][c.get<std::size_t>()]["name"].get<std::string>());
  }
  EXPECT_EQ(order, answer.order);
  EXPECT_EQ(shown, answer.shown);
  for (const Json& controller : data["controllers"]) {
    const auto name = controller["name"].get<std::string>();
    const auto marks = controller["marks"].get<std::string>();
    for (std::size_t m = 0; m < Metrics().size(); ++m) {
      EXPECT_EQ(marks.at(m), answer.marks.at({name, m})) << name << " " << Metrics()[m].key;
    }
  }
}

/// The end card of the video, as text.
void ExpectCard(const Answer& answer, const std::filesystem::path& file) {
  const VideoPlan plan = ReadVideoPlan(file);
  std::vector<std::string> order;
  for (const VideoPlan::Named& named : plan.controllers) {
    order.push_back(named.name);
    EXPECT_EQ(named.role, answer.roles.at(named.name));
  }
  EXPECT_EQ(order, answer.order);
  EXPECT_EQ(plan.shown, answer.shown);
  const ScoreBoard board = ReadScoreBoard(file, plan.shown);
  EXPECT_EQ(board.answer, fmt::format("{}", fmt::join(answer.reasons, " ")));
  const std::map<char, std::string> words = {
      {'*', "better"}, {'=', "equivalent"}, {'!', "worse"}, {'?', "undecided"}};
  const std::size_t metrics[] = {MetricIndex("tracking_rmse_deg"), MetricIndex("delay_ms"),
                                 MetricIndex("jitter_rms_deg")};
  for (const ScoreBoardRow& row : board.rows) {
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const ScoreBoardCell& cell = row.cells[i];
      const char mark = answer.marks.at({row.controller, metrics[i]});
      using Tone = ScoreBoardCell::Tone;
      EXPECT_EQ(cell.tone, mark == '*' ? Tone::kBetter : mark == '!' ? Tone::kWorse : Tone::kPlain);
      EXPECT_EQ(cell.detail.empty(), mark == ' ') << cell.detail;
      if (mark != ' ') {
        EXPECT_TRUE(cell.detail.ends_with(": " + words.at(mark))) << cell.detail;
      }
    }
  }
}

TEST(OneAnswer, OfAComparisonIsInAllOutputs) {
  constexpr int kStudies = 500;
  const test::TemporaryDirectory folder;
  const std::filesystem::path file = folder.path() / "scores.json";
  RandomStream random(1, "one answer");
  std::map<std::string, int> seen;
  for (int i = 0; i < kStudies && !testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const test::MadeUpStudy made = RandomStudy(random);
    std::ofstream(file) << ScoresJson(made);
    const Answer answer = AnswerIn(Json::parse(ScoresJson(made)));
    for (const auto& [name, role] : answer.roles) {
      EXPECT_EQ(role.starts_with("recommended"), name == answer.recommended) << name << role;
      EXPECT_EQ(role.ends_with("baseline"), name == answer.baseline) << name << role;
      if (role.starts_with("equivalent")) ++seen["equivalent"];
      if (role.starts_with("less ")) ++seen["alternative"];
    }
    if (!answer.recommended.empty()) {
      EXPECT_EQ(answer.order.front(), answer.recommended);
      EXPECT_NE(answer.reasons.front().find("Use " + answer.recommended), std::string::npos);
    }
    ExpectTerminal(answer, made);
    ExpectPage(answer, made);
    ExpectCard(answer, file);
    ++seen[answer.recommended.empty()              ? "nothing"
           : answer.recommended == answer.baseline ? "baseline"
                                                   : "another"];
    ++seen[answer.baseline.empty() ? "without baseline" : "with baseline"];
    for (const auto& [key, mark] : answer.marks) ++seen[std::string(1, mark)];
  }
  for (const char* kind : {"equivalent", "alternative", "nothing", "baseline", "another",
                           "without baseline", "with baseline", "*", "=", "!", "?", " "}) {
    EXPECT_GE(seen[kind], 10) << kind;  // or the test holds nothing
  }
}

// --- searches -----------------------------------------------------------------------------------

TunePlan PlanOfSearch() {
  TunePlan plan;
  plan.scenario.file = "made_up.yaml";
  plan.controller = "it";
  plan.free = {ParseFree("filter.min_cutoff_hz=0.1:10:log", "it"),
               ParseFree("filter.beta=0:1", "it")};
  plan.minimise = MetricIndex("tracking_rmse_deg");
  return plan;
}

/// A search of which some setting is chosen that seldom has the least error.
TuneResult RandomSearch(const TunePlan& plan, RandomStream& random) {
  TuneResult result;
  result.metrics = {plan.minimise, MetricIndex("delay_ms"), MetricIndex("jitter_rms_deg")};
  const std::size_t count = 3 + random.Index(20);
  const auto draw = [&](TunedSetting& setting) {
    for (const double mean : {4.0, 50.0, 0.3}) {
      setting.scores.push_back({.mean = mean * random.Uniform(0.8, 1.2)});
    }
  };
  for (std::size_t i = 0; i < count; ++i) {
    TunedSetting& setting = result.tried.emplace_back();
    for (const SweepAxis& axis : plan.free)
      setting.values.push_back(axis.ValueAt(random.Uniform()));
    draw(setting);
    if (random.Uniform() < 0.2) setting.met = Met::kNo;
  }
  result.chosen = random.Index(count);
  result.verdict.values = result.tried[result.chosen].values;
  draw(result.verdict);
  draw(result.before);
  constexpr Judgement kGains[] = {Judgement::kBetter, Judgement::kEqual, Judgement::kUndecided};
  result.gain.judgement = kGains[random.Index(3)];
  result.equal.resize(plan.free.size(), {"0.1", "1"});
  return result;
}

std::size_t Count(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

TEST(OneAnswer, OfASearchIsInAllOutputs) {
  const TunePlan plan = PlanOfSearch();
  RandomStream random(2, "one answer");
  int recommended = 0;
  constexpr int kSearches = 200;
  for (int i = 0; i < kSearches && !testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const TuneResult result = RandomSearch(plan, random);
    const std::vector<std::string>& values = result.tried[result.chosen].values;
    const Json json = Json::parse(TuneJson(plan, result));
    const bool is_recommended = !json["verdict"]["recommended"].is_null();
    recommended += is_recommended;
    if (is_recommended) {
      EXPECT_EQ(json["verdict"]["recommended"], SettingsText(plan, values));
    }
    EXPECT_EQ(json["tuned"]["settings"][plan.free[0].key], values[0]);
    const auto reason = json["verdict"]["reasons"][0]["text"].get<std::string>();
    const std::string page = TunePage(plan, result);
    EXPECT_EQ(Between(page, "id=\"point-name\">", "<"),
              fmt::format("try {}, {}", result.chosen,
                          is_recommended ? "the answer" : "not recommended"));
    EXPECT_NE(Between(page, "id=\"point-yaml\"", "</").find("beta: " + values[1] + "\n"),
              std::string::npos);
    EXPECT_NE(page.find(EscapeHtml(reason)), std::string::npos);
    EXPECT_NE(TextOf(TuneText(plan, result, true), {.width = TerminalStyle::kNoLimit}).find(reason),
              std::string::npos);
  }
  EXPECT_GT(recommended, 20);
  EXPECT_LT(recommended, kSearches - 5);
}

TEST(OneAnswer, OfKindsOfFiltersIsInAllOutputs) {
  TunePlan plan = PlanOfSearch();
  RandomStream random(3, "one answer");
  std::map<bool, int> seen;
  for (int i = 0; i < 200 && !testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE(i);
    std::vector<TunedKind> kinds;
    for (const char* kind : {"kalman", "one_euro", "median"}) {
      TunedKind& tuned = kinds.emplace_back();
      tuned.kind = kind;
      tuned.plan = plan;
      tuned.result = RandomSearch(plan, random);
      constexpr Judgement kAll[] = {Judgement::kWorse, Judgement::kEqual, Judgement::kWorse,
                                    Judgement::kUndecided, Judgement::kBetter};
      tuned.to_best.judgement = kAll[random.Index(5)];
    }
    const Json json = Json::parse(TuneJson(plan, kinds));
    const bool is_recommended = !json["verdict"]["recommended"].is_null();
    ++seen[is_recommended];
    if (is_recommended) {
      EXPECT_EQ(json["verdict"]["recommended"], "kalman");
    }
    const std::string settings = SettingsText(plan, kinds[0].result.verdict.values);
    const std::string page = TunePage(plan, kinds);
    EXPECT_EQ(Between(page, "id=\"point-name\">", "<"),
              fmt::format("kalman: {}, {}", settings,
                          is_recommended ? "the answer" : "chosen, not recommended"));
    EXPECT_EQ(Count(Between(page, "id=\"data\"", "</script>"), ", the answer\""), is_recommended);
    const std::string text =
        TextOf(TuneText(plan, kinds, true),
               {.width = TerminalStyle::kNoLimit, .table_width = TerminalStyle::kNoLimit});
    const auto reason = json["verdict"]["reasons"][0]["text"].get<std::string>();
    EXPECT_NE(reason.find("kalman with " + settings), std::string::npos) << reason;
    EXPECT_NE(text.find(reason), std::string::npos);
    EXPECT_NE(page.find(EscapeHtml(reason)), std::string::npos);
    for (const TunedKind& tuned : kinds) {
      const std::string row = Between(text, "\n" + tuned.kind + " ", "\n");
      EXPECT_EQ(row.find(" chosen ") != std::string::npos, &tuned == &kinds.front()) << text;
    }
  }
  EXPECT_GT(seen[true], 10);
  EXPECT_GT(seen[false], 10);
}

}  // namespace
}  // namespace gauntlet::sim
