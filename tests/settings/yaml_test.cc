// Strict reading: every kind of mistake is one line that names its place.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "sim/base/error.h"
#include "sim/settings/setting_rows.h"
#include "sim/settings/yaml_reader.h"
#include "sim/settings/yaml_writer.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using controller::Setting;
using controller::SettingsVisitor;
using testing::EndsWith;
using testing::HasSubstr;

struct Inner {
  int order = 2;
  double cutoff_hz = 5.0;
  void Visit(SettingsVisitor& visitor) {
    visitor.Integer({.key = "order", .help = "", .min = 1, .max = 8}, order);
    visitor.Number({.key = "cutoff_hz", .help = "", .min = 0, .open_range = true}, cutoff_hz);
  }
};

enum class Kind { kSlow, kFast };

struct Outer {
  std::string title;
  bool enabled = false;
  std::vector<double> weights = {1.0};
  Kind kind = Kind::kSlow;
  Inner inner;
  std::vector<Inner> list;
  void Visit(SettingsVisitor& visitor) {
    visitor.Text({.key = "title", .help = "", .required = true}, title);
    visitor.Flag({.key = "enabled", .help = ""}, enabled);
    visitor.Numbers({.key = "weights", .help = "", .min = 0, .max = 10}, weights);
    static constexpr std::array<std::string_view, 2> kNames = {"slow", "fast"};
    controller::VisitEnum(visitor, {.key = "kind", .help = ""}, kNames, kind);
    controller::VisitGroup(visitor, {.key = "inner", .help = ""}, inner);
    controller::VisitList(visitor, {.key = "list", .help = ""}, list);
  }
};

class YamlReaderTest : public testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::temp_directory_path() /
            ("gauntlet_yaml_" + std::to_string(getpid()) + ".yaml");
  }
  void TearDown() override { std::filesystem::remove(file_); }

  Outer Read(const std::string& text, const std::vector<std::string>& overrides = {}) {
    std::ofstream(file_) << text;
    YamlNode root = ParseYamlFile(file_);
    YamlSource source{.file = file_, .overrides = {}};
    for (const std::string& override : overrides) ApplyOverride(root, override, source);
    YamlReader reader(root, "", source);
    Outer outer;
    outer.Visit(reader);
    reader.RejectUnknownKeys();
    return outer;
  }

  /// The message without the file's name, which differs from run to run.
  std::string Complaint(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
      Read(text, overrides);
    } catch (const UserError& error) {
      std::string message = error.what();
      const std::string name = file_.string();
      if (message.starts_with(name)) message = "file" + message.substr(name.size());
      EXPECT_THAT(message, testing::Not(HasSubstr("\n")));
      return message;
    }
    return "no complaint";
  }

  std::filesystem::path file_;
};

TEST_F(YamlReaderTest, GivesPlaceKeyAndProblemApart) {
  const auto error = [&](const std::string& text, const std::vector<std::string>& overrides) {
    try {
      Read(text, overrides);
    } catch (const UserError& caught) {
      return caught;
    }
    return UserError("none");
  };
  const UserError in_file = error("title: a\ninner: {order: x}\n", {});
  EXPECT_EQ(in_file.place(), file_.string() + ":2:16");
  EXPECT_EQ(in_file.key(), "inner.order");
  EXPECT_EQ(in_file.problem(), "is \"x\", must be a number");
  const UserError on_command_line = error("title: a\n", {"inner.order=x"});
  EXPECT_EQ(on_command_line.place(), "--set inner.order=x");
  EXPECT_EQ(on_command_line.key(), "inner.order");
}

TEST_F(YamlReaderTest, ReadsEveryKindOfSetting) {
  const Outer outer = Read(
      "title: hello\nenabled: true\nweights: [1, 2.5]\nkind: fast\n"
      "inner: {order: 3, cutoff_hz: 0.25}\nlist:\n  - order: 1\n  - order: 4\n");
  EXPECT_EQ(outer.title, "hello");
  EXPECT_TRUE(outer.enabled);
  EXPECT_EQ(outer.weights, (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(outer.kind, Kind::kFast);
  EXPECT_EQ(outer.inner.order, 3);
  EXPECT_EQ(outer.inner.cutoff_hz, 0.25);
  ASSERT_EQ(outer.list.size(), 2u);
  EXPECT_EQ(outer.list[1].order, 4);
}

TEST_F(YamlReaderTest, OneItemMayStandForAList) {
  const Outer outer = Read("title: t\nweights: 2\nlist: {order: 5}\n");
  EXPECT_EQ(outer.weights, std::vector<double>{2.0});
  ASSERT_EQ(outer.list.size(), 1u);
  EXPECT_EQ(outer.list[0].order, 5);
}

TEST_F(YamlReaderTest, NamesThePlaceOfEveryMistake) {
  EXPECT_EQ(Complaint("title: t\ninner:\n  cutof_hz: 3\n"),
            "file:3:3: inner.cutof_hz: unknown key (did you mean cutoff_hz?)");
  EXPECT_EQ(Complaint("title: t\nenabled: true\nenabled: false\n"),
            "file:3:1: enabled: is given twice");
  EXPECT_EQ(Complaint("enabled: true\n"), "file:1:1: title: is missing");
  EXPECT_EQ(Complaint("title: t\ninner: {cutoff_hz: .nan}\n"),
            "file:2:20: inner.cutoff_hz: is \".nan\", must be a number");
  EXPECT_EQ(Complaint("title: t\ninner: {cutoff_hz: 1e999}\n"),
            "file:2:20: inner.cutoff_hz: is \"1e999\", must be a number");
  EXPECT_EQ(Complaint("title: t\ninner: {cutoff_hz: 0}\n"),
            "file:2:20: inner.cutoff_hz: is 0, must be above 0");
  EXPECT_EQ(Complaint("title: t\ninner: {order: 9}\n"),
            "file:2:16: inner.order: is 9, must be from 1 to 8");
  EXPECT_EQ(Complaint("title: t\ninner: {order: 2.5}\n"),
            "file:2:16: inner.order: is 2.5, must be a whole number");
  EXPECT_EQ(Complaint("title: t\ninner: {order: two}\n"),
            "file:2:16: inner.order: is \"two\", must be a number");
  EXPECT_EQ(Complaint("title: t\nenabled: yes\n"),
            "file:2:10: enabled: is \"yes\", must be true or false");
  EXPECT_EQ(Complaint("title: t\nkind: medium\n"),
            "file:2:7: kind: is medium, must be one of slow, fast");
  EXPECT_EQ(Complaint("title: t\nweights: [1, 11]\n"),
            "file:2:14: weights[1]: is 11, must be from 0 to 10");
  EXPECT_EQ(Complaint("title: [a, b]\n"), "file:1:8: title: must be a text");
}

TEST_F(YamlReaderTest, SyntaxErrorsAndEmptyFilesHaveAPlace) {
  EXPECT_THAT(Complaint("title: [a\n"), testing::StartsWith("file:2:1: "));
  EXPECT_EQ(Complaint(""), "file:1:1: must be a map of keys");
  EXPECT_EQ(Complaint("- a\n- b\n"), "file:1:1: must be a map of keys");
}

TEST_F(YamlReaderTest, AMisspeltKeyIsNotSaidToBeMissing) {
  EXPECT_EQ(Complaint("titel: t\n"), "file:1:1: titel: unknown key (did you mean title?)");
  EXPECT_EQ(Complaint("titel: t\ninner: {order: 9}\n"),
            "file:1:1: titel: unknown key (did you mean title?)");
  EXPECT_EQ(Complaint("enabled: true\ninner: {order: 9}\n"), "file:1:1: title: is missing");
}

TEST_F(YamlReaderTest, BytesThatNoTextHasAreRefusedWithTheirPlace) {
  EXPECT_EQ(Complaint("title: t\nkind: caf\xe9\n"), "file:2:10: the byte \\xe9 is not UTF-8");
  EXPECT_EQ(Complaint(std::string("title: a\0b\n", 11)),
            "file:1:9: has the control character \\x00");
  EXPECT_EQ(Complaint(std::string("\xff\xfet\0i\0", 6)),
            "file:1:1: is UTF-16, must be saved as UTF-8");
  EXPECT_EQ(Complaint("title: \"a\\e[2J\"\n"), "file:1:8: title: has the control character \\x1b");
  EXPECT_EQ(Read("\xef\xbb\xbftitle: \"caf\u00e9\\nau lait\"\r\n").title, "caf\u00e9\nau lait");
}

TEST_F(YamlReaderTest, AnAliasInsideWhatItStandsForIsRefused) {
  EXPECT_EQ(Complaint("title: t\ninner: &i {order: *i}\n"),
            "file:2:19: stands inside what it stands for");
  EXPECT_EQ(Complaint("title: t\nlist: &l\n  - [a, {b: *l}]\n"),
            "file:3:13: stands inside what it stands for");
  EXPECT_EQ(Read("title: t\nlist: [&i {order: 3}, *i]\n").list[1].order, 3);
}

TEST_F(YamlReaderTest, DepthAndSizeAreBounded) {
  const std::string deep = std::string(64, '[') + std::string(64, ']');
  EXPECT_EQ(Complaint("title: " + deep + "\n"), "file:1:71: is nested deeper than 64 levels");
  EXPECT_EQ(Complaint("title: " + deep.substr(1, 126) + "\n"), "file:1:8: title: must be a text");
  EXPECT_THAT(Complaint("title: " + std::string(100'000, '[')),
              EndsWith("is nested deeper than 64 levels"));
  std::string bomb = "a0: &a0 [x, x]\n";
  for (int i = 1; i < 40; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    bomb += fmt::format("a{0}: &a{0} [{1}, {1}]\n", i, before);
  }
  EXPECT_EQ(Complaint(bomb), "file:16:18: has more than 200000 values");
  std::string wide = "title: [";
  for (int i = 0; i < 200'000; ++i) wide += "0,";
  EXPECT_THAT(Complaint(wide + "0]\n"), EndsWith(": has more than 200000 values"));
  EXPECT_EQ(Complaint("title: " + std::string(4'000'000, 'x')),
            "file: has more than 4 MB, the limit of such a file");
}

TEST_F(YamlReaderTest, AFileHasOneDocumentAndNoTags) {
  EXPECT_EQ(Complaint("title: t\n---\ntitle: u\n"),
            "file:2:1: a second document begins here, there must be one");
  EXPECT_EQ(Complaint("title: !include other.yaml\n"),
            "file:1:8: !include stands for all settings of a controller in a scenario, "
            "controllers: {tuned: !include FILE}, and nowhere else");
  EXPECT_EQ(Read("---\ntitle: !!str t\n...\n").title, "t");
}

TEST_F(YamlReaderTest, WhatCannotBeReadSaysWhy) {
  const auto problem = [](const std::filesystem::path& file) -> std::string {
    try {
      ReadYamlText(file);
    } catch (const UserError& error) {
      return error.what();
    }
    return "none";
  };
  const test::TemporaryDirectory folder;
  const std::filesystem::path loop = folder.path() / "loop";
  std::filesystem::create_symlink("loop", loop);
  EXPECT_THAT(problem(loop), EndsWith("loop: cannot be read: Too many levels of symbolic links"));
  EXPECT_THAT(problem(folder.path()), EndsWith(": is a folder, must be a regular file"));
  EXPECT_THAT(problem(folder.path() / "none"), EndsWith("none: no such file"));
  EXPECT_THAT(problem(folder.path() / std::string(300, 'x')), EndsWith("File name too long"));
  EXPECT_EQ(problem(""), "'': no such file");
  EXPECT_EQ(problem("/dev/zero"), "/dev/zero: is a device, must be a regular file");
  std::ofstream(folder.path() / "long") << std::string(5'000'000, '#');
  EXPECT_THAT(problem(folder.path() / "long"),
              EndsWith("has more than 4 MB, the limit of such a file"));
}

TEST_F(YamlReaderTest, MessagesShowLongValuesInShort) {
  const std::string value = std::string(70'000, 'x') + "end";
  const std::string from_file = Complaint("title: t\ninner: {order: " + value + "}\n");
  EXPECT_THAT(from_file, testing::StartsWith("file:2:16: inner.order: is \"xxx"));
  EXPECT_THAT(from_file, EndsWith("xxend\", must be a number"));
  EXPECT_LT(from_file.size(), 150u);
  const std::string overridden = Complaint("title: t\n", {"inner.order=" + value});
  EXPECT_THAT(overridden, testing::StartsWith("--set inner.order=xxx"));
  EXPECT_THAT(overridden, EndsWith("xxend\", must be a number"));
  EXPECT_LT(overridden.size(), 250u);
  const std::string key = Complaint("title: t\n" + value.substr(0, 1000) + ": 1\n");
  EXPECT_THAT(key, testing::StartsWith("file:2:1: unknown key (one of: title, enabled"));
}

TEST_F(YamlReaderTest, OverridesWinOverTheFile) {
  const Outer outer = Read(
      "title: t\ninner: {order: 3}\nlist: [{order: 1}, {order: 2}]\n",
      {"inner.order=4", "inner.cutoff_hz=2.5", "list[0].order=5", "list.1.order=7", "title=other"});
  EXPECT_EQ(outer.inner.order, 4);
  EXPECT_EQ(outer.inner.cutoff_hz, 2.5);
  EXPECT_EQ(outer.list[0].order, 5);
  EXPECT_EQ(outer.list[1].order, 7);
  EXPECT_EQ(outer.title, "other");
}

TEST_F(YamlReaderTest, MistakesInOverridesNameTheOverride) {
  EXPECT_EQ(Complaint("title: t\n", {"inner.order=many"}),
            "--set inner.order=many: inner.order: is \"many\", must be a number");
  EXPECT_EQ(Complaint("title: t\n", {"iner.order=1"}),
            "--set iner.order=1: iner: unknown key (did you mean inner?)");
  EXPECT_THAT(Complaint("title: t\n", {"order"}), EndsWith("must be key.path=value"));
}

TEST_F(YamlReaderTest, MistakesInOverridesOfAListNameTheOverride) {
  const std::string two = "title: t\nlist: [{order: 1}, {order: 2}]\n";
  EXPECT_EQ(
      Complaint(two, {"list.2.order=3"}),
      "--set list.2.order=3: list is a list of 2: an item is named by its number, 0 to 1, not "
      "by 2");
  EXPECT_THAT(Complaint(two, {"list[2].order=3"}), EndsWith("by its number, 0 to 1, not by 2"));
  EXPECT_THAT(Complaint(two, {"list[1.order=3"}), EndsWith("unknown key (did you mean list?)"));
  EXPECT_EQ(Complaint(two, {"list.order=3"}),
            "--set list.order=3: list is a list of 2: an item is named by its number, 0 to 1, not "
            "by order");
  EXPECT_EQ(
      Complaint(two, {"list.-1.order=3"}),
      "--set list.-1.order=3: list is a list of 2: an item is named by its number, 0 to 1, not "
      "by -1");
  EXPECT_EQ(Complaint(two, {"list.99999999999999999999.order=3"}),
            "--set list.99999999999999999999.order=3: list is a list of 2: an item is named by its "
            "number, 0 to 1, not by 99999999999999999999");
  EXPECT_EQ(Complaint(two, {"list.1.order=9"}),
            "--set list.1.order=9: list[1].order: is 9, must be from 1 to 8");
  EXPECT_EQ(Complaint("title: t\nlist: []\n", {"list.0.order=3"}),
            "--set list.0.order=3: list is an empty list");
  EXPECT_EQ(Complaint("title: t\nlist: [{order: 1}]\n", {"list.order=9"}),
            "--set list.order=9: list[0].order: is 9, must be from 1 to 8");
}

TEST_F(YamlReaderTest, TextsThatAreNoOverridesSayWhatOneIs) {
  EXPECT_EQ(Complaint("title: t\n", {"="}), "--set =: must be key.path=value");
  EXPECT_EQ(Complaint("title: t\n", {""}), "--set : must be key.path=value");
  for (const char* path : {".", "inner.", ".inner", "inner..order"}) {
    EXPECT_THAT(Complaint("title: t\n", {std::string(path) + "=1"}), EndsWith("has an empty key"));
  }
  std::string deep = "inner";
  for (int i = 0; i < 1000; ++i) deep += ".x";
  EXPECT_THAT(Complaint("title: t\n", {deep + "=1"}), EndsWith("has more than 64 keys"));
  EXPECT_EQ(Complaint("title: t\n", {"title=caf\xe9"}),
            "--set title=caf\\xe9: the byte \\xe9 is not UTF-8");
  EXPECT_EQ(Complaint("title: t\n", {"title=\n---\n---\n"}),
            "--set title=\\n---\\n---\\n: a second document begins here, there must be one");
  EXPECT_THAT(Complaint("title: t\n", {"title.x=1"}), EndsWith("title: must be a text"));
}

TEST_F(YamlReaderTest, AnItemAloneInPlaceOfAListIsItsFirst) {
  const YamlSource source{.file = "file", .overrides = {{"list.order", "list.order=9"}}};
  EXPECT_EQ(source.PlaceOf(YamlNode(), "list[0].order"), "--set list.order=9");
  EXPECT_EQ(source.PlaceOf(YamlNode(), "list[1].order"), "file");
}

TEST_F(YamlReaderTest, NothingIsAnEmptyText) {
  EXPECT_EQ(Complaint("title:\n"), "file:2:1: title: is empty");
  EXPECT_EQ(Complaint("title: t\n", {"title="}), "--set title=: title: is empty");
}

TEST_F(YamlReaderTest, ALaterOverrideIsNamedForWhatItGave) {
  EXPECT_EQ(Complaint("title: t\n", {"inner={order: 3}", "inner.order=9"}),
            "--set inner.order=9: inner.order: is 9, must be from 1 to 8");
  EXPECT_EQ(Complaint("title: t\n", {"inner.order=3", "inner={order: 9}"}),
            "--set inner={order: 9}: inner.order: is 9, must be from 1 to 8");
}

TEST_F(YamlReaderTest, AnOverrideLeavesOtherPlacesAsTheyWere) {
  // What is wrong elsewhere in a group that an override changed is still found there.
  EXPECT_EQ(Complaint("title: t\ninner: {order: 3, cutof_hz: 1}\n", {"inner.order=4"}),
            "file:2:19: inner.cutof_hz: unknown key (did you mean cutoff_hz?)");
  EXPECT_EQ(Complaint("enabled: true\n", {"inner.order=4"}), "file:1:1: title: is missing");
  const Outer shared = Read("title: t\ninner: &i {order: 3}\nlist: [*i, *i]\n", {"list.1.order=5"});
  EXPECT_EQ(shared.inner.order, 3);
  EXPECT_EQ(shared.list[0].order, 3);
  EXPECT_EQ(shared.list[1].order, 5);
}

TEST(YamlNode, ATreeWithADifferenceSharesTheRestAndLeavesTheOther) {
  const YamlNode tree = ParseYaml("f.yaml", "a: {b: [1, 2], c: x}\nd: &d {e: 3}\nf: *d\n");
  EXPECT_TRUE(ChildOf(tree, "d").Is(ChildOf(tree, "f")));
  YamlNode other = tree;
  YamlSource source{.file = "f.yaml"};
  ApplyOverride(other, "a.b.1=7", source);
  ApplyOverride(other, "f.g=8", source);
  EXPECT_EQ(NodeAt(tree, "a.b[1]").text(), "2");
  EXPECT_EQ(NodeAt(other, "a.b[1]").text(), "7");
  EXPECT_TRUE(NodeAt(other, "a.c").Is(NodeAt(tree, "a.c")));
  EXPECT_TRUE(NodeAt(other, "d").Is(NodeAt(tree, "d")));
  EXPECT_EQ(ChildOf(NodeAt(other, "f"), "g").text(), "8");
  EXPECT_FALSE(ChildOf(ChildOf(tree, "f"), "g").IsDefined());
  EXPECT_EQ(ChildOf(WithoutChild(tree, "a"), "a").IsDefined(), false);
  EXPECT_EQ(NodeAt(tree, "a.c").place().line, 0);
  EXPECT_EQ(NodeAt(tree, "a.c").place().column, 18);
}

TEST(YamlWriter, WritesWhatTheReaderReadsBackToTheSameBits) {
  Outer outer;
  outer.title = "quotes \" and: colons";
  outer.weights = {0.1, 1.0 / 3.0, 9.87654321098765432};
  outer.kind = Kind::kFast;
  outer.list.resize(2);
  outer.list[1].cutoff_hz = 1e-300;
  const std::string text = SettingsToYaml([&](SettingsVisitor& visitor) { outer.Visit(visitor); });
  const YamlSource source{.file = "memory.yaml", .overrides = {}};
  YamlReader reader(ParseOwnYaml(text), "", source);
  Outer back;
  back.Visit(reader);
  reader.RejectUnknownKeys();
  EXPECT_EQ(back.title, outer.title);
  EXPECT_EQ(back.weights, outer.weights);
  EXPECT_EQ(back.kind, outer.kind);
  EXPECT_EQ(back.list[1].cutoff_hz, 1e-300);
}

TEST(SettingRows, TellKeyDefaultAndRange) {
  Outer outer;
  const auto rows = ListSettings([&](SettingsVisitor& visitor) { outer.Visit(visitor); });
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_EQ(rows[0].key, "title");
  EXPECT_EQ(rows[0].default_value, "");
  EXPECT_EQ(rows[4].key, "inner.order");
  EXPECT_EQ(rows[4].default_value, "2");
  EXPECT_EQ(rows[4].range, "1 to 8");
  EXPECT_EQ(rows[5].range, "above 0");
}

}  // namespace
}  // namespace gauntlet::sim
