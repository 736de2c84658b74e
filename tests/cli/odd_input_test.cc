// Names, bytes and scenarios that nobody means: refused before anything runs, in one line that a
// terminal can show, and nothing is left or touched.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/support/program.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
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
    EXPECT_THAT(line, testing::EndsWith("\n"));
    if (!line.empty()) line.pop_back();
    EXPECT_LE(line.size(), 400u) << line;
    EXPECT_TRUE(std::ranges::none_of(line, [](char c) { return (c >= 0 && c < ' ') || c == 127; }))
        << line;
    return line;
  }

  TemporaryDirectory folder_;
};

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

}  // namespace
}  // namespace gauntlet::test
