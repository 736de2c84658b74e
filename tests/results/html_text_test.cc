#include "sim/results/html_text.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "sim/base/json.h"

namespace gauntlet::sim {
namespace {

TEST(EscapeHtml, LeavesNothingThatMarkupIsMadeOf) {
  EXPECT_EQ(EscapeHtml(R"(<b title="it's">R&D</b>)"),
            "&lt;b title=&quot;it&#39;s&quot;&gt;R&amp;D&lt;/b&gt;");
  EXPECT_EQ(EscapeHtml("plain ± text"), "plain ± text");
}

TEST(JsonForScript, CannotEndItsElementAndReadsBackTheSame) {
  Json json;
  json["</script><script>alert(1)</script>"] = "<!-- & \" \\ \xE2\x80\xA8 ±";
  const std::string text = JsonForScript(json);
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos);
  EXPECT_EQ(Json::parse(text), json);
}

TEST(JsonForScript, ReplacesBytesThatAreNotUtf8) {
  const Json json =
      "a\xFF"
      "b";
  EXPECT_EQ(Json::parse(JsonForScript(json)).get<std::string>(),
            "a\xEF\xBF\xBD"
            "b");
}

TEST(FillTemplate, LooksAtNoValueTwice) {
  EXPECT_EQ(FillTemplate("<{{a}}|{{b}}|{{a}}>", {{"a", "{{b}}"}, {"b", "}}{{"}}),
            "<{{b}}|}}{{|{{b}}>");
  EXPECT_EQ(FillTemplate("an open {{ stays", {}), "an open {{ stays");
}

TEST(FillTemplate, RefusesANameWithoutAValue) {
  EXPECT_THROW(FillTemplate("{{missing}}", {}), std::logic_error);
}

}  // namespace
}  // namespace gauntlet::sim
