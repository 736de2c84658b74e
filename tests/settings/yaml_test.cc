// Strict reading: every kind of mistake is one line that names its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "sim/base/error.h"
#include "sim/settings/setting_rows.h"
#include "sim/settings/yaml_reader.h"
#include "sim/settings/yaml_writer.h"

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
    YAML::Node root = ParseYamlFile(file_);
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
            "file:2:20: inner.cutoff_hz: is .nan, must be finite");
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

TEST_F(YamlReaderTest, OverridesWinOverTheFile) {
  const Outer outer =
      Read("title: t\ninner: {order: 3}\nlist: [{order: 1}, {order: 2}]\n",
           {"inner.order=4", "inner.cutoff_hz=2.5", "list.1.order=7", "title=other"});
  EXPECT_EQ(outer.inner.order, 4);
  EXPECT_EQ(outer.inner.cutoff_hz, 2.5);
  EXPECT_EQ(outer.list[0].order, 1);
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

TEST(YamlWriter, WritesWhatTheReaderReadsBackToTheSameBits) {
  Outer outer;
  outer.title = "quotes \" and: colons";
  outer.weights = {0.1, 1.0 / 3.0, 9.87654321098765432};
  outer.kind = Kind::kFast;
  outer.list.resize(2);
  outer.list[1].cutoff_hz = 1e-300;
  const std::string text = SettingsToYaml([&](SettingsVisitor& visitor) { outer.Visit(visitor); });
  const YamlSource source{.file = "memory.yaml", .overrides = {}};
  YamlReader reader(YAML::Load(text), "", source);
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
