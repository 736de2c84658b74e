// Names, bytes and scenarios that nobody means: refused before anything runs, in one line that a
// terminal can show, and nothing is left or touched.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::EndsWith;
using testing::HasSubstr;

const std::string kQuestion = "question: q\n";
const std::string kGlove = "glove: {motion: {kind: hold, duration_s: 0.1}}\n";
const std::string kControllers = "controllers: {raw: {}}\n";
const std::string kGood = kQuestion + kGlove + kControllers;

class OddInput : public testing::Test {
 protected:
  ProgramResult Gauntlet(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    ProgramOptions options;
    options.working_directory = folder_.path();
    return RunProgram(arguments, options);
  }
  void Write(const fs::path& file, const std::string& text) const {
    std::ofstream(folder_.path() / file) << text;
  }
  std::size_t FileCount() const {
    return std::distance(fs::recursive_directory_iterator(folder_.path()), {});
  }

  /// The line on standard error of a program that found a mistake and left everything as it was.
  std::string Refusal(const std::vector<std::string>& arguments) const {
    const std::size_t before = FileCount();
    const ProgramResult result = Gauntlet(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.signal;
    EXPECT_EQ(result.standard_output, "");
    EXPECT_EQ(FileCount(), before);
    std::string line = result.standard_error;
    EXPECT_THAT(line, EndsWith("\n"));
    if (!line.empty()) line.pop_back();
    EXPECT_LE(line.size(), 300u) << line;
    EXPECT_TRUE(std::ranges::none_of(line, [](char c) { return (c >= 0 && c < ' ') || c == 127; }))
        << line;
    return line;
  }

  TemporaryDirectory folder_;
};

TEST_F(OddInput, AByteThatIsNotUtf8IsRefusedBeforeAnythingRuns) {
  Write("question.yaml", "question: caf\xe9\n" + kGlove + kControllers);
  EXPECT_EQ(Refusal({"run", "question.yaml"}),
            "gauntlet: question.yaml:1:14: the byte \\xe9 is not UTF-8");
  Write("t\xfcr.yaml", kGood);
  EXPECT_EQ(Refusal({"run", "t\xfcr.yaml"}),
            "gauntlet: t\\xfcr.yaml: name: must be given, as the file's name cannot be one: it has "
            "the byte \\xfc, which is not UTF-8");
  Write("good.yaml", kGood);
  EXPECT_EQ(Refusal({"run", "good.yaml", "--set", "question=caf\xe9"}),
            "gauntlet: --set question=caf\\xe9: the byte \\xe9 is not UTF-8");
  EXPECT_THAT(Refusal({"run", "good.yaml", "--controllers", "r\xe4w"}), HasSubstr("r\\xe4w"));
  EXPECT_THAT(Refusal({"run", "g\xf6od.yaml"}), HasSubstr("g\\xf6od.yaml: no such file"));
  EXPECT_THAT(Refusal({"run", "good.yaml", "--r\xfcn"}), HasSubstr("r\\xfcn"));
  EXPECT_THAT(Refusal({"list", "k\xe4ys"}), HasSubstr("k\\xe4ys"));
}

TEST_F(OddInput, AFileNamedInAnotherEncodingRunsUnderAGivenName) {
  Write("t\xfcr.yaml", "name: t\u00fcr\n" + kGood);
  const ProgramResult result = Gauntlet({"run", "t\xfcr.yaml"});
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  std::ifstream scores(folder_.path() / "out/t\u00fcr/scores.json");
  EXPECT_EQ(nlohmann::json::parse(scores)["scenario"], "t\u00fcr");
}

TEST_F(OddInput, APathThatResultsCouldNotNameIsRefused) {
  fs::create_directory(folder_.path() / "\xe4");
  Write("\xe4/s.yaml",
        kQuestion + "glove: {motion: {kind: recording, file: r.csv}}\n" + kControllers);
  EXPECT_THAT(Refusal({"run", "\xe4/s.yaml"}),
              testing::AllOf(HasSubstr("s.yaml:2:41: glove.motion.file: "),
                             EndsWith("\\xe4/r.csv: the path has the byte \\xe4, which is not "
                                      "UTF-8")));
}

TEST_F(OddInput, ANameNeverLeavesTheFolderOut) {
  Write("report.html", "mine");
  Write("trace.old.csv", "mine");
  for (const char* name :
       {"'..'", "'.'", "../../x", "a/b", "/tmp/x", "''", "' '", "\"a\\0b\"", ".hidden"}) {
    Write("s.yaml", "name: " + std::string(name) + "\n" + kGood);
    EXPECT_THAT(Refusal({"run", "s.yaml"}), HasSubstr("s.yaml:1:7: name: ")) << name;
  }
  Write("...yaml", kGood);
  EXPECT_THAT(Refusal({"run", "...yaml"}), EndsWith("it begins with a dot, which no name does"));
  Write("good.yaml", kGood);
  EXPECT_THAT(Refusal({"run", "good.yaml", "--set", "name=.."}),
              HasSubstr("--set name=..: name: begins with a dot"));
  EXPECT_THAT(Refusal({"run", "good.yaml", "--set", "name=" + std::string(61, 'x')}),
              EndsWith("name: has 61 characters, a name has at most 60"));
  EXPECT_EQ(Gauntlet({"run", "good.yaml", "--set", "name=a \u00e4,b"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_.path() / "out/a \u00e4,b/scores.json"));
}

TEST_F(OddInput, AnEmptyPathIsAMistake) {
  Write("good.yaml", kGood);
  for (const char* command : {"run", "compare"}) {
    EXPECT_THAT(Refusal({command, "good.yaml", "--out", ""}), HasSubstr("--out: is empty"));
  }
  EXPECT_THAT(Refusal({"render", "x", "--out", ""}), HasSubstr("--out: is empty"));
  EXPECT_THAT(Refusal({"calibrate", "x", "--out", ""}), HasSubstr("--out: is empty"));
  EXPECT_THAT(Refusal({"reproduce", "--out", ""}), HasSubstr("--out: is empty"));
  EXPECT_THAT(Refusal({"run", ""}), HasSubstr("no such file"));
}

TEST_F(OddInput, NamesOfControllersAreThoseOfFiles) {
  const auto refusal = [this](const std::string& controllers) {
    Write("s.yaml", kQuestion + kGlove + "controllers:\n" + controllers);
    return Refusal({"run", "s.yaml"});
  };
  for (const char* name :
       {"..", "a/b", "a,b", "\"a\\nb\"", "\"a\\0b\"", "'a\"b'", ".a", "' '", "\u00e4", "a.b"}) {
    EXPECT_THAT(refusal(fmt::format("  {}: {{}}\n", name)),
                EndsWith("a name has letters, digits, _, - and + only"))
        << name;
  }
  EXPECT_THAT(refusal("  '': {}\n"), EndsWith("is empty, must be a name"));
  EXPECT_THAT(refusal(fmt::format("  {}: {{}}\n", std::string(1000, 'x'))),
              EndsWith("x: has 1000 characters, a name has at most 60"));
  EXPECT_EQ(refusal("  raw: {}\n  Raw: {}\n"),
            "gauntlet: s.yaml:5:8: controllers.Raw: differs from raw by case only, which not all "
            "file systems tell apart");
  EXPECT_THAT(refusal("  [raw, tuned]\n"),
              EndsWith("controllers: must be names with their settings"));
}

TEST_F(OddInput, AScenarioThatRefersToItselfOrExplodesIsRefused) {
  Write("cycle.yaml",
        kQuestion + "glove: {motion: &m {kind: sequence, parts: [*m]}}\n" + kControllers);
  EXPECT_EQ(Refusal({"run", "cycle.yaml"}),
            "gauntlet: cycle.yaml:2:45: stands inside what it stands for");
  std::string bomb = kQuestion + "m0: &m0 {kind: hold}\n";
  for (int i = 1; i < 30; ++i) {
    const std::string n = std::to_string(i);
    const std::string alias = "*m" + std::to_string(i - 1);
    bomb += "m" + n + ": &m" + n + " {kind: sequence, parts: [" + alias + ", " + alias + "]}\n";
  }
  Write("bomb.yaml", bomb + "glove: {motion: *m29}\n" + kControllers);
  EXPECT_THAT(Refusal({"run", "bomb.yaml"}), EndsWith("has more than 200000 values"));
  Write("deep.yaml", kQuestion + "glove: " + std::string(100'000, '[') + "\n");
  EXPECT_THAT(Refusal({"run", "deep.yaml"}), EndsWith("is nested deeper than 64 levels"));
  EXPECT_THAT(Refusal({"run", "/dev/zero"}), EndsWith("is a device, must be a regular file"));
}

TEST_F(OddInput, AChainOfFiltersThatAliasesMakeLongIsRefused) {
  std::string filters = "&m {kind: median, window: 10001}";
  for (int i = 0; i < 3000; ++i) filters += ", *m";
  Write("s.yaml", kQuestion + kGlove + "controllers: {a: {filter: [" + filters + "]}}\n");
  EXPECT_EQ(Refusal({"run", "s.yaml"}),
            "gauntlet: s.yaml:3:27: controllers.a.filter: has 3001 filters, must have at most 64");
}

/// A file of another program, or with another's secrets.
struct OthersFile {
  std::string name;
  std::string text;
  std::vector<std::string> secrets;  // parts of it that no message may have
};

const std::vector<OthersFile> kOthersFiles = {
    {"passwd",
     "root:x:0:0:root:/root:/bin/bash\nmary:x:1:1:Mary,,,:/home/mary:/bin/sh\n",
     {"root", "bash", "mary", "Mary"}},
    {"shadow",
     "root:*:20228:0:99999:7:::\nmary:$y$j9T$hash:20228:0:99999:7:::\n",
     {"root", "20228", "99999", "hash"}},
    {"password", "sesame\nsesame2\n", {"sesame"}},
    {"key.pem",
     "-----BEGIN PRIVATE KEY-----\nMIIEvQIBADANBgkqhkiG9w0BAQEFAASCBKcwggSjAgEAAoIBAQC7\nVJTUt9Us\n"
     "-----END PRIVATE KEY-----\n",
     {"BEGIN", "PRIVATE", "MIIE", "VJTU", "END"}},
    {"token.json",
     "{\"the token\": \"sesame\", \"list\": [{\"of\": \"sesame\"}]}\n",
     {"the token", "sesame"}},
    {"binary",
     std::string("\x7f"
                 "ELF\2\1sesame\0\1\2sesame\n",
                 21),
     {"ELF", "sesame"}},
    {"table.csv",
     "name of it,card no\nmary,4111-sesame\nbob,5222-sesame\n",
     {"name of it", "card no", "mary", "sesame"}},
    {"environment", "PASSWORD=sesame\nTOKEN=sesame\n", {"PASSWORD", "TOKEN", "sesame"}},
    {"settings.ini", "[sesame]\nkey = sesame\n", {"sesame"}},
    {"alias.yaml", "a: *sesame\n", {"sesame"}},
    {"tag.yaml", "a: !sesame 1\n", {"sesame"}},
    {"twice.yaml", "the sesame: 1\nthe sesame: 2\n", {"sesame"}},
    {"keys.yaml", "sesame/of/mine: 1\n", {"sesame"}},
    {"deep.yaml", "glove: {sesame of mine: 1}\nfilter: {sesame of mine: 2}\n", {"sesame"}}};

TEST_F(OddInput, NoMessageRepeatsAFileThatIsOfAnother) {
  Write("table.yaml", "t_s,index_mcp_counts\n0,1\n0.1,2\n0.2,3\n");
  const std::string recording = "glove: {motion: {kind: recording, file: ";
  for (const OthersFile& file : kOthersFiles) {
    Write(file.name, file.text);
    Write("included.yaml", kQuestion + kGlove + "controllers: {a: !include " + file.name + "}\n");
    Write("calibration.yaml",
          kQuestion + kGlove + "controllers: {a: {calibration: " + file.name + "}}\n");
    Write("chain.yaml", kQuestion + kGlove + "controllers: {a: {chain: " + file.name +
                            ", prediction: {kind: linear}}}\n");
    Write("recording.yaml", kQuestion + recording + file.name + "}}\n" + kControllers);
    Write("map.yaml",
          kQuestion + recording + "table.yaml, map: " + file.name + "}}\n" + kControllers);
    Write("hand.yaml",
          kQuestion + kGlove + kControllers + "hand: {model_path: " + file.name + "}\n");
    Write("study.yaml",
          kQuestion + "scenario: " + file.name + "\naxes: [{key: event.delay_ms, values: [0]}]\n");
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"run", file.name},
                                               {"run", "included.yaml"},
                                               {"run", "calibration.yaml"},
                                               {"run", "chain.yaml"},
                                               {"run", "recording.yaml"},
                                               {"run", "map.yaml"},
                                               {"run", "hand.yaml"},
                                               {"sweep", file.name},
                                               {"sweep", "study.yaml"},
                                               {"calibrate", file.name},
                                               {"calibrate", "table.yaml", "--poses", file.name},
                                               {"identify", file.name}}) {
      const std::string refusal = Refusal(words);
      for (const std::string& secret : file.secrets) {
        EXPECT_THAT(refusal, testing::Not(HasSubstr(secret))) << testing::PrintToString(words);
      }
    }
  }
}

TEST_F(OddInput, AKeyThatLooksLikeOneIsRepeatedAndAnyIsGuessed) {
  Write("s.yaml", kGood + "sede: 3\n");
  EXPECT_EQ(Refusal({"run", "s.yaml"}),
            "gauntlet: s.yaml:4:1: sede: unknown key (did you mean seed?)");
  Write("s.yaml", kGood + "seed : 1\n'se ed': 3\n");
  EXPECT_EQ(Refusal({"run", "s.yaml"}), "gauntlet: s.yaml:5:1: unknown key (did you mean seed?)");
  Write("s.yaml", kQuestion + "glove: {'rate hz': 1}\n" + kControllers);
  EXPECT_EQ(Refusal({"run", "s.yaml"}),
            "gauntlet: s.yaml:2:9: glove: unknown key (did you mean rate_hz?)");
  Write("s.yaml", kQuestion + "glove: {'a b': 1, 'a b': 1}\n" + kControllers);
  EXPECT_EQ(Refusal({"run", "s.yaml"}), "gauntlet: s.yaml:2:19: glove: has a key twice");
  EXPECT_EQ(Refusal({"run", "s.yaml", "--set", "glove={rate hz: 1}"}),
            "gauntlet: --set glove={rate hz: 1}: glove: unknown key (did you mean rate_hz?)");
}

TEST_F(OddInput, AnOverrideOfAnItemThatIsNotThereIsRefused) {
  Write("s.yaml", kQuestion + "glove: {faults: [spikes, dropouts]}\n" + kControllers);
  EXPECT_EQ(
      Refusal({"run", "s.yaml", "--set", "glove.faults.2.kind=stuck"}),
      "gauntlet: --set glove.faults.2.kind=stuck: glove.faults is a list of 2: an item is named "
      "by its number, 0 to 1, not by 2");
  Write("list.yaml", kQuestion + "controllers: [{filter: none}, {filter: kalman}]\n");
  EXPECT_THAT(Refusal({"run", "list.yaml", "--set", "controllers.raw.filter=none"}),
              HasSubstr("controllers is a list of 2"));
}

TEST_F(OddInput, MessagesAreOneLineThatATerminalCanShow) {
  Write("good.yaml", kGood);
  const std::string wild = "\x1b[2J\n\r\x07" + std::string(70'000, 'x') + "\u202e";
  for (const std::string& key : {std::string("seed"), std::string("question.x"),
                                 std::string("glove.motion.kind"), std::string("baseline")}) {
    Refusal({"run", "good.yaml", "--set", key + "=" + wild});
    Refusal({"run", "good.yaml", "--set", key + "='" + wild + "'"});
    Refusal({"run", "good.yaml", "--set", wild + "=" + key});
  }
  Refusal({"run", "good.yaml", "--controllers", wild});
  Refusal({"run", wild});
  Refusal({wild});
  Refusal({"run", "good.yaml", "--seed", wild});
  Refusal({"filter", wild});
  Refusal({"list", wild});
  Refusal({"diff", wild, wild});
  Write("keys.yaml", kGood + wild.substr(9) + ": 1\n");
  Refusal({"run", "keys.yaml"});
}

TEST_F(OddInput, WhatOnlyTheWholeScenarioShowsHasItsPlaceInTheFile) {
  Write("s.yaml", kQuestion + "joint_map:\n  index_mpc: {channels: [index_mcp], gains: [1]}\n" +
                      kControllers);
  EXPECT_THAT(Refusal({"run", "s.yaml"}), HasSubstr("s.yaml:3:"));
  Write("s.yaml", kGood);
  EXPECT_THAT(Refusal({"run", "s.yaml", "--set", "hand.servo.travel_deg=100"}),
              HasSubstr("gauntlet: --set hand.servo.travel_deg=100: hand.servo.travel_deg: "));
}

}  // namespace
}  // namespace gauntlet::test
