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
#include "sim/show/pages/score_table.h"
#include "sim/study/study_room.h"
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

/// The files in a folder, by name.
std::map<std::string, std::string> ContentOf(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    files[entry.path().filename()] = {std::istreambuf_iterator<char>(file), {}};
  }
  return files;
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
  std::map<std::string, std::string> files = ContentOf(folder.path());
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

TEST(LongTrial, WritesTheSameBytesWhereSignalsGoAsTheyAreWritten) {
  FinishedStudy finished;
  finished.comparison = true;
  finished.study = PrepareStudy(ShortScenario(1000.0));
  finished.result = RunStudy(finished.study, {.causes = CauseSeeds::kFirst});
  finished.summary = Summarise(finished.study, finished.result);
  const test::TemporaryDirectory folder, last;
  const TraceFormats formats{.csv = true, .mcap = true};
  WriteStudyFiles(folder.path(), finished, formats);
  ASSERT_GT(finished.result.first_others.back().switched_off.back().size(), 0);
  WriteLastStudyFiles(last.path(), finished, formats);
  EXPECT_EQ(ContentOf(folder.path()).size(), 7U);
  EXPECT_TRUE(ContentOf(folder.path()) == ContentOf(last.path()));
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(finished.result.first_traces[c].hand_angle_rad.size(), 0);
    EXPECT_EQ(finished.result.first_traces[c].tension_n.size(), 0);
    EXPECT_FALSE(finished.result.first_twins[c]);
    EXPECT_EQ(finished.result.first_others[c].switched_off.back().size(), 0);
  }
}

TEST(LongTrial, NeedsLessDiskWhereSignalsGoAsTheyAreWritten) {
  const Study study = PrepareStudy(ShortScenario(1000.0));
  const auto fits = [&study](std::uintmax_t bytes, const StudyOptions& options) {
    SignalStorageLimits limits = test::AllOnDisk();
    limits.all_on_heap_bytes = 0;
    limits.all_on_disk_bytes = bytes;
    const test::SignalLimits set(limits);
    try {
      CheckRoom(study, options);
      return true;
    } catch (const RunError&) {
      return false;
    }
  };
  const auto needed = [&fits](const StudyOptions& options) {
    std::uintmax_t low = 0, high = 1 << 30;
    while (high - low > 1) (fits((low + high) / 2, options) ? high : low) = (low + high) / 2;
    return static_cast<double>(high);
  };
  // The trace file has all signals again, in half the bytes; or those of one of two controllers.
  EXPECT_LT(needed({.traces_go = true}), 0.85 * needed({}));
}

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

// The page and both tables ask for it, without any other use of the signal between them.
TEST(LongTrial, LooksForJointsAtRestInOneColumnAfterTheOther) {
  const Study study = PrepareStudy(ShortScenario(1000.0));
  SignalStorageLimits limits = test::AllOnDisk();
  limits.resident_bytes = std::size_t{48} << 20;
  const test::SignalLimits set(limits);
  StudyResult result;
  result.first_reference_rad = Signal(1'500'000, study.joint_count);  // 12 MB a column
  for (int joint = 0; joint < study.joint_count; ++joint) {
    result.first_reference_rad.col(joint).setLinSpaced(0.0, joint % 2);
    TrimSignals();
  }
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  EXPECT_THAT(Measured(study, result), HasSubstr("of them at rest"));
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 24 << 10);  // KiB; all columns: 150 MB and more
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
