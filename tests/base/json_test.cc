#include "sim/base/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/random.h"

namespace gauntlet::sim {
namespace {

using Nlohmann = nlohmann::ordered_json;

constexpr int kTrees = 1000;

std::string RandomText(RandomStream& random) {
  constexpr const char* kPieces[] = {"a",    "key", "\"",           "\\", "/",    "\n", "\x01",
                                     "\x7f", "±",   "\xE2\x80\xA8", "😀",  "</b>", " "};
  std::string text;
  for (std::uint64_t i = random.Index(4); i > 0; --i) {
    text += kPieces[random.Index(std::size(kPieces))];
  }
  return random.Index(20) == 0 ? text + '\0' : text;
}

/// One tree in both types, equal for equal numbers.
template <class AnyJson>
AnyJson RandomTree(RandomStream& random, int depth) {
  constexpr double kNumbers[] = {0.0,      -0.0, 0.1,  1e300, 5e-324,
                                 100000.0, 1e15, 1e16, NAN,   INFINITY};
  constexpr std::int64_t kSmallest = std::numeric_limits<std::int64_t>::min();
  switch (random.Index(depth > 0 ? 12 : 9)) {
    case 0:
      return nullptr;
    case 1:
      return random.Index(2) == 0;
    case 2:
      return static_cast<std::int64_t>(random.Bits());
    case 3:
      return random.Bits();
    case 4:
      return static_cast<int>(random.Index(20)) - 10;
    case 5:
      return random.Index(2) == 0 ? AnyJson(kSmallest) : AnyJson(~std::uint64_t{0});
    case 6:
      return std::bit_cast<double>(random.Bits());
    case 7:
      return kNumbers[random.Index(std::size(kNumbers))];
    case 8:
      return RandomText(random);
    case 9: {
      AnyJson array = AnyJson::array();
      for (auto i = random.Index(5); i > 0; --i) {
        array.push_back(RandomTree<AnyJson>(random, depth - 1));
      }
      return array;
    }
    case 10: {  // a key may come again
      AnyJson object = AnyJson::object();
      for (auto i = random.Index(6); i > 0; --i) {
        const std::string key = RandomText(random);
        object[key] = RandomTree<AnyJson>(random, depth - 1);
      }
      return object;
    }
    default: {
      AnyJson tree;  // null, until something is put into it
      for (auto i = random.Index(3); i > 0; --i) tree["a"]["b"].push_back(RandomText(random));
      for (auto i = random.Index(3); i > 0; --i) tree["a"].update({{"c", i}, {"b", {i}}});
      return tree;
    }
  }
}

std::pair<Json, Nlohmann> RandomPair(int number) {
  RandomStream ours(1, "tree", static_cast<std::uint64_t>(number)), theirs = ours;
  return {RandomTree<Json>(ours, 4), RandomTree<Nlohmann>(theirs, 4)};
}

/// Printed value of a text; empty if the text is not JSON.
std::string Read(std::string_view text) {
  const Json read = Json::parse_or_discard(text);
  return read.is_discarded() ? "" : read.dump(-1, Json::InvalidText::kReplaced);
}
std::string ReadByNlohmann(std::string_view text) {
  const Nlohmann read = Nlohmann::parse(text, nullptr, false);
  return read.is_discarded() ? "" : read.dump(-1, ' ', false, Nlohmann::error_handler_t::replace);
}

TEST(Json, PrintsWhatNlohmannPrints) {
  for (int i = 0; i < kTrees; ++i) {
    const auto [ours, theirs] = RandomPair(i);
    for (const int indent : {-1, 0, 1, 2}) ASSERT_EQ(ours.dump(indent), theirs.dump(indent)) << i;
  }
}

TEST(Json, ReadsWhatNlohmannReadsAlsoFromDamagedTexts) {
  RandomStream random(2, "damage");
  int discarded = 0;
  for (int i = 0; i < kTrees; ++i) {
    std::string text = RandomPair(i).second.dump(static_cast<int>(random.Index(3)) - 1);
    ASSERT_EQ(Read(text), ReadByNlohmann(text)) << text;
    for (auto changes = 1 + random.Index(2); changes > 0 && !text.empty(); --changes) {
      constexpr std::string_view kBytes = "[]{},:\"0-.e \\\xff";
      const std::size_t place = random.Index(text.size());
      if (random.Index(2) == 0)
        text.erase(place, 1 + random.Index(3));
      else
        text[place] = kBytes[random.Index(kBytes.size())];
    }
    ASSERT_EQ(Read(text), ReadByNlohmann(text)) << text;
    if (Read(text).empty()) ++discarded;
  }
  EXPECT_GT(discarded, kTrees / 4);
  EXPECT_LT(discarded, kTrees - kTrees / 20);
}

TEST(Json, ReadsRareTextsAsNlohmannDoes) {
  for (const char* text : {"",
                           " ",
                           "nul",
                           "[1,]",
                           "{\"a\":}",
                           "1 2",
                           "01",
                           "1e999",
                           "-1e999",
                           "18446744073709551616",
                           "-9223372036854775809",
                           "-0",
                           "-0.0",
                           "1E2",
                           "\"\\ud83d\\ude00\"",
                           "\"\\ud83d\"",
                           "\"\xff\"",
                           "\xEF\xBB\xBF[1]",
                           "\xEF\xBB",
                           "// no",
                           "[NaN]",
                           "{\"a\":1,\"b\":2,\"a\":{\"c\":3}}",
                           "{\"a\":[1],\"a\":[]}",
                           "{\"\":{}}",
                           " [ ] ",
                           "{1:2}"}) {
    EXPECT_EQ(Read(text), ReadByNlohmann(text)) << text;
    EXPECT_EQ(Json::parse_or_discard(text).is_discarded(), ReadByNlohmann(text).empty()) << text;
    if (ReadByNlohmann(text).empty()) {
      EXPECT_THROW(Json::parse(text), JsonError) << text;
    }
  }
}

TEST(Json, IsNestedAsDeeplyAsItsTextIsLong) {
  constexpr std::size_t kDepth = 1'000'000;
  const std::string lists(kDepth, '[');
  EXPECT_TRUE(Json::parse_or_discard(lists).is_discarded());
  EXPECT_TRUE(Json::parse_or_discard(lists + std::string(kDepth, ']')).is_array());
  std::string objects;
  for (std::size_t i = 0; i < kDepth; ++i) objects += "{\"a\":";
  Json read = Json::parse(objects + "1" + std::string(kDepth, '}'));
  for (int i = 0; i < 100; ++i) read = Json(std::move(read["a"]));
  EXPECT_TRUE(read.is_object());
}

TEST(Json, RefusesOrReplacesTextThatIsNotUtf8) {
  for (const char* text : {"a\xff"
                           "b",
                           "\xE2\x82", "\xC0\x80", "\xED\xA0\x80", "\xF5", "ok\x80"}) {
    const Json ours = {{text, {text}}};
    const Nlohmann theirs = {{text, {text}}};
    EXPECT_EQ(ours.dump(-1, Json::InvalidText::kReplaced),
              theirs.dump(-1, ' ', false, Nlohmann::error_handler_t::replace));
    std::string problem;
    try {
      theirs.dump();
    } catch (const Nlohmann::exception& error) {
      problem = error.what();
    }
    EXPECT_THAT([&ours] { ours.dump(); }, testing::ThrowsMessage<JsonError>(problem)) << problem;
  }
}

/// Lists in braces and values that become JSON without being asked.
template <class AnyJson>
std::string Made() {
  const std::string text = "text";
  const std::string_view part = "part";
  std::vector<bool> flags = {true, false};
  AnyJson big = {{"list", std::vector<double>(3, 0.5)}};
  AnyJson json = AnyJson::array();
  json.push_back({{"a", 1}, {"b", {2, "c"}}});
  json.push_back({{"a", 1}, {"b", 2}, {"a", 3}});  // the first one counts
  json.push_back({{"a", 1}, {"b", 2, 3}});
  json.push_back({{"a", 1}, {2, "b"}});
  json.push_back({"a", 1});
  json.push_back({"a", "b"});
  json.push_back({{"a", "b"}});
  json.push_back({{"a", "b"}, {"c", "d"}});
  json.push_back({{{"a", 1}}});
  json.push_back({text});
  json.push_back({nullptr, nullptr});
  json.push_back({{"big", big}, {"again", big}, {text, part}});
  json.push_back(flags);
  json.push_back({flags[0], flags[1]});
  json.push_back(std::vector<std::string>{"x", "y"});
  json.push_back(std::vector<std::vector<int>>{{1}, {}});
  json.push_back(std::map<std::string, int>{{"x", 1}, {"y", 2}});
  json.push_back(std::map<std::string, std::vector<double>>());
  json.push_back(std::array<float, 2>{0.1F, 1.0F});
  json.push_back({true, 'a', 1U, 1L, -1LL, std::uint8_t{200}, 0.25F, 2.0});
  json.push_back(part);
  json.emplace_back(text);
  json.emplace_back(nullptr) = {1, 2};
  json.back().push_back({3});
  AnyJson chained;
  auto& inner = chained["list"] = AnyJson::array();
  inner.push_back(1);
  chained["empty"] = {};
  json.push_back(chained);
  json.push_back(AnyJson{{"one", text}});
  return json.dump(1) + big.dump();
}

TEST(Json, IsMadeOfBracesAndValuesAsNlohmannIs) { EXPECT_EQ(Made<Json>(), Made<Nlohmann>()); }

/// Result of a reader for a value; errors are named.
template <class AnyJson, class Error>
std::string Seen(const AnyJson& json) {
  std::ostringstream seen;
  const auto get = [&](const auto& reader) {
    try {
      seen << reader() << ' ';
    } catch (const Error&) {
      seen << "error ";
    }
  };
  seen << json.is_null() << json.is_boolean() << json.is_number() << json.is_number_integer()
       << json.is_string() << json.is_array() << json.is_object() << json.is_structured() << ' '
       << json.size() << json.empty() << json.contains("a") << (json.find("a") == json.end())
       << ' ';
  get([&] { return json.template get<bool>(); });
  get([&] { return json.template get<int>(); });
  get([&] { return json.template get<std::int64_t>(); });
  get([&] { return json.template get<std::uint32_t>(); });
  get([&] { return json.template get<std::uint64_t>(); });
  get([&] { return json.template get<double>(); });
  get([&] { return json.template get<std::string>(); });
  get([&] { return json.template get<std::vector<double>>().size(); });
  get([&] { return json.template get<std::vector<std::string>>().size(); });
  get([&] { return json.at("a").dump(); });
  get([&] { return json.value("a", AnyJson(7)).dump(); });
  for (const AnyJson& value : json) seen << value.dump() << ';';
  for (const auto& [key, value] : json.items()) seen << key << '=' << value.dump() << ';';
  return seen.str();
}

TEST(Json, IsSeenByReadersAsNlohmannIs) {
  for (const char* text :
       {"null", "true", "false", "0", "-5", "1.75", "4294967297", "18446744073709551615", "\"a\"",
        "[]", "[1,2.5]", "[\"a\",\"b\"]", "[1,\"b\"]", "[null,[1]]", "{}", "{\"a\":\"text\"}",
        "{\"b\":1,\"a\":2}", "{\"a\":[\"x\"]}", "{\"a\":null}"}) {
    EXPECT_EQ((Seen<Json, JsonError>(Json::parse(text))),
              (Seen<Nlohmann, Nlohmann::exception>(Nlohmann::parse(text))))
        << text;
  }
}

TEST(Json, IsEqualToWhatNlohmannFindsEqual) {
  const std::vector<std::string> texts = {"null",
                                          "true",
                                          "1",
                                          "1.0",
                                          "-1",
                                          "18446744073709551615",
                                          "\"1\"",
                                          "[]",
                                          "{}",
                                          "[1]",
                                          "[2]",
                                          "[1.0]",
                                          "{\"a\":1}",
                                          "{\"b\":1}",
                                          "{\"a\":2}",
                                          "{\"a\":1,\"b\":2}",
                                          "{\"b\":2,\"a\":1}"};
  for (const std::string& a : texts) {
    for (const std::string& b : texts) {
      EXPECT_EQ(Json::parse(a) == Json::parse(b), Nlohmann::parse(a) == Nlohmann::parse(b))
          << a << " " << b;
    }
  }
  EXPECT_NE(Json::parse_or_discard("no"), Json::parse_or_discard("no"));
  EXPECT_NE(NumberOrNull(0.0), Json(nullptr));
  EXPECT_EQ(NumberOrNull(INFINITY), Json(nullptr));
}

TEST(Json, IsCopiedWhollyAndTakesItsOwnPart) {
  Json json = {{"list", {1, 2}}, {"text", "long enough to lie somewhere else"}};
  const Json copy = json;
  json["list"].push_back(3);
  json["text"] = "other";
  EXPECT_EQ(copy.dump(), R"({"list":[1,2],"text":"long enough to lie somewhere else"})");
  json = json["list"];
  EXPECT_EQ(json.dump(), "[1,2,3]");
  json.push_back(json);
  json = std::move(json[3]);
  EXPECT_EQ(json.dump(), "[1,2,3]");
  const Json moved = std::move(json);
  EXPECT_EQ(moved.size(), 3u);
}

TEST(JsonDeathTest, EndsAProgramThatUsesAValueAsWhatItIsNot) {
  Json number = 1;
  const Json object = Json::object();
  EXPECT_DEATH(number["key"] = 2, "is_object");
  EXPECT_DEATH(number.push_back(2), "is_array");
  EXPECT_DEATH(number.update(object), "is_object");
  EXPECT_DEATH(object["key"].size(), "found");
  EXPECT_DEATH(Json::array()[0].size(), "place < size");
  EXPECT_DEATH(object.front().size(), "empty");
}

}  // namespace
}  // namespace gauntlet::sim
