#include "sim/results/result_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "controller/number.h"
#include "sim/base/json.h"
#include "sim/results/html_text.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {
namespace {

/// Two filters: a name, settings in a group, a score with its interval, what only one kind of file
/// has, and a text for people alone.
ResultTable Filters() {
  ResultTable table{.columns = {{"name", "filter"},
                                ResultColumn("filter.q", "q").In("settings"),
                                ResultColumn("delay_ms", "delay", "ms",
                                             {{"mean", "delay_ms"}, {"ci95_low", "delay_ms_low"}})
                                    .In("scores"),
                                OnlyInCsv("rows"),
                                OnlyInJson("problem"),
                                ForPeople("verdict").Words()}};
  table.rows.push_back({ResultCell("raw, \"as it is\""), ResultCell("0.1"),
                        ResultCell({3.125, 3.0}, "3.1\n+0.2\v±0.1", '*'),
                        ResultCell(std::int64_t{7}), ResultCell(), ResultCell::Text("best <1>")});
  table.rows.push_back({ResultCell("kalman"), ResultCell("2"),
                        ResultCell({controller::kNaN, std::monostate()}, "-"),
                        ResultCell(std::int64_t{0}), ResultCell("stopped"), ResultCell::Text("")});
  return table;
}

// Better and worse are exchanged easily.
TEST(ResultTable, ShowsItsMarksInTheirColours) {
  ResultTable table{.columns = {ForPeople("name"), ForPeople("score")}, .rows = {}};
  for (const auto& [text, mark] :
       {std::pair("1.1", '*'), {"2.2", '!'}, {"3.3", '~'}, {"4.4", ' '}}) {
    table.rows.push_back({ResultCell("a"), ResultCell({1.0}, text, mark)});
  }
  const std::string html = HtmlOf(table);
  for (const char* cell :
       {"<td class=\"good\">1.1", "<td class=\"warn\">2.2", "<td>3.3", "<td>4.4"}) {
    EXPECT_NE(html.find(cell), std::string::npos) << cell << "\n" << html;
  }
  const std::string coloured = TextOf(table, {.colour = true});
  EXPECT_NE(coloured.find(Good("  1.1*")), std::string::npos) << coloured;
  EXPECT_NE(coloured.find(Warning("  2.2!")), std::string::npos) << coloured;
  EXPECT_NE(coloured.find("  3.3~\n"), std::string::npos) << coloured;
  EXPECT_NE(coloured.find("  4.4\n"), std::string::npos) << coloured;
  EXPECT_EQ(Good("x"), "\033[1;32mx\033[0m");   // green
  EXPECT_EQ(Warning("x"), "\033[33mx\033[0m");  // yellow
}

TEST(ResultTable, IsWrittenAsCsvWithAColumnPerPart) {
  EXPECT_EQ(CsvOf(Filters()),
            "name,filter.q,delay_ms,delay_ms_low,rows\n"
            "\"raw, \"\"as it is\"\"\",0.1,3.125,3,7\n"
            "kalman,2,,,0\n");
}

TEST(ResultTable, IsWrittenAsJsonWithoutWhatIsNotThere) {
  const auto expected = Json::parse(R"([
    {"name": "raw, \"as it is\"", "settings": {"filter.q": "0.1"},
     "scores": {"delay_ms": {"mean": 3.125, "ci95_low": 3.0}}},
    {"name": "kalman", "settings": {"filter.q": "2"}, "scores": {"delay_ms": {"mean": null}},
     "problem": "stopped"}])");
  EXPECT_EQ(Json::parse(JsonOf(Filters()).dump()), expected);
}

TEST(ResultTable, IsShownToPeopleWithTheColumnsThatHaveAHeading) {
  EXPECT_EQ(TextOf(Filters(), TerminalStyle::Unlimited()),
            "                         delay\n"
            "filter             q        ms   verdict\n"
            "raw, \"as it is\"  0.1       3.1*  best <1>\n"
            "                      +0.2±0.1\n"
            "kalman             2         -\n");
}

TEST(ResultTable, IsBrokenWhereItMayBeIfItIsTooWide) {
  const std::string text = TextOf(Filters(), {.table_width = 30});
  EXPECT_NE(text.find("+0.2\n"), std::string::npos) << text;
  EXPECT_NE(text.find("±0.1\n"), std::string::npos) << text;
}

TEST(ResultTable, OnAPageHasItsTextEscaped) {
  const std::string html = HtmlOf(Filters());
  EXPECT_NE(html.find("<th scope=\"row\">raw, &quot;as it is&quot;</th>"), std::string::npos);
  EXPECT_NE(html.find("<td class=\"good\">3.1<br>+0.2<wbr>±0.1*</td>"), std::string::npos) << html;
  EXPECT_NE(html.find("<td class=\"words\">best &lt;1&gt;</td>"), std::string::npos);
  EXPECT_NE(html.find("<th scope=\"col\">delay <small>ms</small></th>"), std::string::npos);
  EXPECT_EQ(html.find("stopped"), std::string::npos);  // in files only
}

TEST(ResultText, HasAnEmptyLineBetweenItsParts) {
  ResultText text;
  AddLine("one", text);
  AddLine("", text);
  AddLine("two words", text);
  text.emplace_back("");
  text.emplace_back(ResultTable{.columns = Filters().columns});  // without rows
  text.emplace_back(CommandLines{"gauntlet compare \\\n  --seeds 4\n"});
  EXPECT_EQ(TextOf(text, {.width = 5}), "one\ntwo\nwords\n\ngauntlet compare \\\n  --seeds 4\n");
  EXPECT_EQ(HtmlOf(text),
            "<p class=\"note\">one<br>two words</p>\n"
            "<pre tabindex=\"0\">gauntlet compare \\\n  --seeds 4\n</pre>\n");
}

}  // namespace
}  // namespace gauntlet::sim
