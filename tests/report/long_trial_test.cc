// What a long trial must not change, tried with short ones whose signals all lie on the disk.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "sim/answers/compare/study_files.h"
#include "sim/base/error.h"
#include "sim/show/pages/report_page.h"
#include "tests/support/program.h"
#include "tests/support/signal_limits.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

NamedController Controller(const std::string& name, std::vector<controller::FilterConfig> filters) {
  NamedController named{.name = name, .calibration = {}, .config = {}};
  named.config.filters = std::move(filters);
  return named;
}

Scenario ShortScenario(double rate_hz) {
  Scenario scenario;
  scenario.name = "long";
  scenario.question = "Does it matter where signals lie?";
  scenario.glove.rate_hz = rate_hz;
  scenario.glove.motion.settings = RandomMotionConfig{.duration_s = 3.0};
  scenario.glove.tremor.rms_deg = 0.3;
  scenario.controllers = {
      Controller("raw", {}),
      Controller("mean", {{.settings = controller::MovingAverageConfig{.window = 20}}})};
  return scenario;
}

/// All that a comparison of two seeds writes, by name; the page is `report.html`.
std::map<std::string, std::string> FilesOf(const Scenario& scenario) {
  FinishedStudy finished;
  finished.comparison = true;
  finished.study = PrepareStudy(scenario);
  finished.result = RunStudy(finished.study, {.seeds = 2, .jobs = 2, .progress = {}});
  finished.summary = Summarise(finished.study, finished.result);
  const test::TemporaryDirectory folder;
  WriteStudyFiles(folder.path(), finished, {.csv = true});
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    std::ifstream file(entry.path(), std::ios::binary);
    files[entry.path().filename()] = {std::istreambuf_iterator<char>(file), {}};
  }
  files["report.html"] = ReportPage(finished, {});
  return files;
}

void ExpectTheSameOnDisk(const Scenario& scenario) {
  const auto on_heap = FilesOf(scenario);
  const test::SignalLimits all_on_disk(test::AllOnDisk());
  const auto on_disk = FilesOf(scenario);
  ASSERT_EQ(on_heap.size(), on_disk.size());
  EXPECT_GE(on_heap.size(), 7U);
  for (const auto& [name, bytes] : on_heap) {
    EXPECT_GT(bytes.size(), 1000U) << name;
    EXPECT_TRUE(bytes == on_disk.at(name)) << name;
  }
}

TEST(LongTrial, WritesTheSameBytes) { ExpectTheSameOnDisk(ShortScenario(1000.0)); }

TEST(LongTrial, WritesTheSameBytesOfASlowGlove) { ExpectTheSameOnDisk(ShortScenario(33.3)); }

TEST(LongTrial, KeepsTheMemoryOfItsGloveFlat) {
  GloveConfig config;
  config.motion.settings = HoldConfig{.duration_s = 300.0};
  SignalStorageLimits limits;
  limits.resident_bytes = std::size_t{48} << 20;
  const test::SignalLimits set(limits);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const GloveSignal glove = SynthesiseGlove(config, 1);  // three signals of 43 to 58 MB at a time
  getrusage(RUSAGE_SELF, &after);
  EXPECT_EQ(glove.counts.rows(), 300'000);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 80 << 10);  // KiB
}

TEST(LongTrial, LeavesFewSignalsOnTheHeapAsLongAsItsResultExists) {
  const Study study = PrepareStudy(ShortScenario(1000.0));
  const auto run_with = [&study](std::size_t all_on_heap_mb) {
    SignalStorageLimits limits;
    limits.all_on_heap_bytes = all_on_heap_mb << 20;
    const test::SignalLimits set(limits);
    return RunStudy(study, {.seeds = 1, .jobs = 1, .progress = {}});
  };
  const auto five_mb_are_on_disk = [] { return Signal(5 << 17, 1).is_on_disk(); };
  {
    const StudyResult short_one = run_with(192);
    EXPECT_FALSE(five_mb_are_on_disk());
    const StudyResult long_one = run_with(1);
    EXPECT_TRUE(five_mb_are_on_disk());
  }
  EXPECT_FALSE(five_mb_are_on_disk());
}

TEST(LongTrial, ThatDoesNotFitIsRefusedBeforeItStarts) {
  const Study study = PrepareStudy(ShortScenario(1000.0));
  SignalStorageLimits limits = test::AllOnDisk();
  limits.all_on_heap_bytes = 0;
  limits.all_on_disk_bytes = 1'000'000;
  const test::SignalLimits set(limits);
  bool started = false;
  const auto progress = [&started](double, int) { return started = true; };
  try {
    RunStudy(study, {.seeds = 1, .jobs = 1, .progress = progress});
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("3 s of 2 controllers need about 0.0 GB on the disk of "));
    EXPECT_THAT(error.what(), HasSubstr("0.0 GB are free: a shorter glove.motion.duration_s"));
  }
  EXPECT_FALSE(started);
}

}  // namespace
}  // namespace gauntlet::sim
