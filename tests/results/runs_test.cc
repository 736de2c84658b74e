#include "sim/results/runs.h"

#include <gtest/gtest.h>

#include <fstream>

#include "sim/base/manifest.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// An output folder with this second paragraph of its answer.
void WriteRun(const fs::path& folder, const std::string& answer, const std::string& choices) {
  fs::create_directories(folder);
  OutputFiles files({.folder = folder, .command = "run", .choices = choices});
  files.Write([&](const fs::path& place) {
    std::ofstream(place / "answer.txt") << "door: Which one?\n3 s\n\n" << answer << "\n\nTable\n";
  });
  files.Commit();
}

TEST(Runs, AnswersEndWithASentence) {
  const test::TemporaryDirectory folder;
  const std::string one = "Use a" + std::string(200, 'b') + ", better in all.";
  const std::string other(150, 'c');
  WriteRun(folder.path() / "short", one, "");
  WriteRun(folder.path() / "two", one + " And " + other + ".", "");
  WriteRun(folder.path() / "long",
           "Use " + other + " " + other + " in place of " + other + ". More.", "");
  for (const auto& run : FindRuns(folder.path())) {
    const std::string name = run.folder.filename().string();
    EXPECT_EQ(run.question, "door: Which one?");
    EXPECT_EQ(run.answer,
              name == "long" ? "Use " + other + " " + other + " in place of " + other + "." : one)
        << name;
  }
}

TEST(Runs, WhatWasSetTellsThemApart) {
  const test::TemporaryDirectory folder;
  WriteRun(folder.path() / "a", "Use a.", "");
  WriteRun(folder.path() / "b", "Use b.",
           ChoicesText({.set = {"event.delay_ms=50", "name=a b"},
                        .added = {"one_euro:beta=0.1"},
                        .controllers = {"raw", "one_euro"},
                        .priority = "jitter"}));
  const auto runs = FindRuns(folder.path());
  ASSERT_EQ(runs.size(), 2u);
  for (const auto& run : runs) {
    const bool is_b = run.folder.filename() == "b";
    EXPECT_EQ(run.choices,
              is_b ? "--add 'one_euro:beta=0.1' --set 'event.delay_ms=50' --set 'name=a "
                     "b' --controllers raw,one_euro --priority jitter"
                   : "");
    EXPECT_EQ(LinesOf(run).size(), is_b ? 4u : 3u);
  }
  EXPECT_EQ(ChoicesText({}), "");
}

}  // namespace
}  // namespace gauntlet::sim
