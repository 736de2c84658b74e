// What is written is what is read.
#include "sim/trial/trace_file.h"

#include <H5Cpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/trial/trace_reader.h"
#include "tests/support/program.h"

namespace {

constexpr off_t kEndless = std::numeric_limits<off_t>::max();
/// What the disk still takes of one file.
off_t disk_room_bytes = kEndless;

}  // namespace

/// Stands in for the C library's, which HDF5 writes by: a disk of a given size.
extern "C" ssize_t pwrite(int file, const void* data, size_t size, off_t offset) {
  struct stat info = {};
  fstat(file, &info);
  if (512 * info.st_blocks + static_cast<off_t>(size) > disk_room_bytes) {
    errno = ENOSPC;
    return -1;
  }
  return syscall(SYS_pwrite64, file, data, size, offset);
}

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

/// More than the writer takes at a time.
constexpr int kSamples = 5000;

class TraceFileTest : public testing::Test {
 protected:
  TraceFileTest() {
    glove_.channel_names = GloveChannelNames();
    glove_.true_angle_rad = Signal::Random(kSamples, 18);
    glove_.counts = Signal::Constant(kSamples, 18, 512.0);
    glove_.counts(2, 3) = std::numeric_limits<double>::quiet_NaN();
    glove_.reference_name = "ground truth";
    reference_ = Signal::Random(kSamples, 18);
  }

  Trace MakeTrace(const std::string& name) const {
    Trace trace;
    trace.controller_name = name;
    trace.linearised_angle_rad = Signal::Random(kSamples, 18);
    trace.filtered_angle_rad = Signal::Random(kSamples, 18);
    trace.command_counts = IntegerSignal::Constant(kSamples, 18, 7);
    trace.spool_angle_rad = Signal::Random(kSamples, 18);
    trace.spool_speed_rad_s = Signal::Random(kSamples, 18);
    trace.motor_at_limit = FlagSignal::Constant(kSamples, 18, 1);
    trace.motor_at_limit(7, 3) = 0;
    trace.hand_angle_rad = Signal::Random(kSamples, 18);
    trace.tension_n =
        Signal::Random(kSamples, static_cast<Eigen::Index>(hand_.cable_names().size()));
    trace.object_pose =
        Signal::Random(kSamples, 7);  // and no grip force: what has no columns is left out
    return trace;
  }

  test::TemporaryDirectory folder_;
  fs::path file_ = folder_.path() / "trace.h5";
  HandModel hand_{HandConfig{}};
  GloveSignal glove_;
  Signal reference_;  // ticks x joints
};

/// What 24 significant bits leave of a signal.
Signal Stored(const Signal& signal) { return signal.cast<float>().cast<double>(); }

TEST_F(TraceFileTest, GivesBackTwentyFourBitsOfEverySignal) {
  const Trace a = MakeTrace("raw");
  const Trace b = MakeTrace("kalman");
  TraceWriter writer(file_, glove_, reference_, hand_, "test", 42);
  writer.Add(a);
  writer.Add(b);
  EXPECT_FALSE(fs::exists(file_));  // not before it is whole
  writer.Commit();

  const TraceFile read = ReadTraceFile(file_);
  EXPECT_EQ(read.seed, 42);
  EXPECT_EQ(read.scenario, "test");
  EXPECT_EQ(read.channel_names, GloveChannelNames());
  EXPECT_EQ(read.joint_names, hand_.joint_names());
  EXPECT_EQ(read.true_angle_rad, Stored(glove_.true_angle_rad));
  EXPECT_EQ(read.reference_angle_rad, Stored(reference_));
  EXPECT_TRUE(std::isnan(read.counts(2, 3)));
  ASSERT_EQ(read.traces.size(), 2u);
  EXPECT_EQ(read.traces[1].controller_name, "kalman");
  EXPECT_EQ(read.traces[1].hand_angle_rad, Stored(b.hand_angle_rad));
  EXPECT_EQ(read.traces[1].command_counts, b.command_counts);
  EXPECT_EQ(read.traces[1].motor_at_limit, b.motor_at_limit);
  EXPECT_EQ(read.traces[0].tension_n, Stored(a.tension_n));
  EXPECT_EQ(read.traces[0].object_pose, Stored(a.object_pose));
  EXPECT_EQ(read.traces[0].grip_force_n.size(), 0);
  EXPECT_EQ(ReadTraceFile(file_, {.only = {"kalman"}}).traces.size(), 1u);
}

TEST_F(TraceFileTest, HoldsTheTrialsBesideItAndOneByteForEveryFlag) {
  const Trace trace = MakeTrace("raw");
  const NoiseFreeTwin twin{.hand_angle_rad = Signal::Random(kSamples, 18),
                           .spool_speed_rad_s = Signal::Random(kSamples, 18)};
  CauseAngles angles;  // noise is in the twin, friction could not be taken away
  for (const std::size_t i : {1, 4, 5, 7, 8}) angles.without[i] = Signal::Random(kSamples, 18);
  angles.arm_at_rest = Signal::Random(kSamples, 18);
  angles.switched_off[2] = Signal::Random(kSamples, 18);
  TraceWriter writer(file_, glove_, reference_, hand_, "test", 42);
  writer.Add(trace, &twin, angles);
  writer.Add(MakeTrace("kalman"));
  writer.Commit();
  EXPECT_EQ(ReadTraceFile(file_).traces.size(), 2u);
  const H5::H5File file(file_.string(), H5F_ACC_RDONLY);
  const H5::Group raw = file.openGroup("controllers/raw");
  EXPECT_EQ(raw.openDataSet("motor_at_limit").getStorageSize(), kSamples * 18u);
  const auto first_row = [&](const char* name) {
    std::vector<double> values(kSamples * 18);
    raw.openDataSet(name).read(values.data(), H5::PredType::NATIVE_DOUBLE);
    return Signal(Eigen::Map<Eigen::RowVectorXd>(values.data(), 18));
  };
  EXPECT_EQ(first_row("noise_free_hand_angle_rad"), Stored(twin.hand_angle_rad.topRows(1)));
  EXPECT_EQ(first_row("noise_free_spool_speed_rad_s"), Stored(twin.spool_speed_rad_s.topRows(1)));
  EXPECT_EQ(first_row("without_glove_hand_angle_rad"), Stored(angles.without[1].topRows(1)));
  EXPECT_EQ(first_row("without_servo_hand_angle_rad"), Stored(angles.without[7].topRows(1)));
  EXPECT_EQ(first_row("asked_angle_rad"), Stored(angles.without[8].topRows(1)));
  EXPECT_EQ(first_row("arm_at_rest_hand_angle_rad"), Stored(angles.arm_at_rest.topRows(1)));
  EXPECT_EQ(first_row("without_link_alone_hand_angle_rad"),
            Stored(angles.switched_off[2].topRows(1)));
  EXPECT_FALSE(raw.nameExists("without_servo_alone_hand_angle_rad"));
  EXPECT_FALSE(raw.nameExists("without_friction_hand_angle_rad"));
  for (const char* name : {"noise_free_hand_angle_rad", "without_glove_hand_angle_rad"}) {
    EXPECT_FALSE(file.openGroup("controllers/kalman").nameExists(name)) << name;
  }
}

TEST_F(TraceFileTest, ReadsOneOfAnEarlierVersionWithoutLimits) {
  Trace trace = MakeTrace("raw");
  trace.motor_at_limit = {};
  TraceWriter writer(file_, glove_, reference_, hand_, "test", 42);
  writer.Add(trace);
  writer.Commit();
  EXPECT_EQ(ReadTraceFile(file_).traces[0].motor_at_limit.size(), 0);
}

struct StretchRow {
  char* name;
  char* channel;
  int begin;
  int end;
};

/// The rows of /glove/faults or /glove/segments as text.
std::vector<std::string> ReadStretches(const fs::path& file, const std::string& table,
                                       const std::string& name_column) {
  H5::StrType text(H5::PredType::C_S1, H5T_VARIABLE);
  text.setCset(H5T_CSET_UTF8);
  const H5::CompType type(sizeof(StretchRow));
  type.insertMember(name_column, HOFFSET(StretchRow, name), text);
  type.insertMember("channel", HOFFSET(StretchRow, channel), text);
  type.insertMember("begin_sample", HOFFSET(StretchRow, begin), H5::PredType::NATIVE_INT);
  type.insertMember("end_sample", HOFFSET(StretchRow, end), H5::PredType::NATIVE_INT);
  const H5::DataSet dataset =
      H5::H5File(file.string(), H5F_ACC_RDONLY).openGroup("glove").openDataSet(table);
  std::vector<StretchRow> rows(
      static_cast<std::size_t>(dataset.getSpace().getSimpleExtentNpoints()));
  if (!rows.empty()) dataset.read(rows.data(), type);
  std::vector<std::string> texts;
  for (const StretchRow& row : rows) {
    texts.push_back(fmt::format("{} {} {} {}", row.name, row.channel, row.begin, row.end));
    H5free_memory(row.name);
    H5free_memory(row.channel);
  }
  return texts;
}

TEST_F(TraceFileTest, TellsTheTruthOfEveryFaultAndWhatTheWearerDid) {
  glove_.faults = {{.kind = "stuck", .channel = 3, .begin = 1, .end = 4},
                   {.kind = "late_frames", .channel = 0, .begin = 0, .end = 2}};
  glove_.segments = {{.label = "rest", .begin = 0, .end = 3},
                     {.label = "fast", .begin = 3, .end = 5}};
  TraceWriter(file_, glove_, reference_, hand_, "test", 1).Commit();
  EXPECT_EQ(ReadStretches(file_, "faults", "kind"),
            (std::vector<std::string>{"stuck " + glove_.channel_names[3] + " 1 4",
                                      "late_frames " + glove_.channel_names[0] + " 0 2"}));
  EXPECT_EQ(ReadStretches(file_, "segments", "label"),
            (std::vector<std::string>{"rest all 0 3", "fast all 3 5"}));

  const std::vector<Segment> segments = ReadTraceFile(file_).segments;
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_EQ(segments[1].label, "fast");
  EXPECT_EQ(segments[1].begin, 3);
  EXPECT_EQ(segments[1].end, 5);
  EXPECT_TRUE(ReadTraceFile(file_).masked.empty());

  glove_.faults.clear();
  std::filesystem::remove(file_);  // it was read
  TraceWriter(file_, glove_, reference_, hand_, "test", 1).Commit();
  EXPECT_TRUE(ReadStretches(file_, "faults", "kind").empty());
}

TEST_F(TraceFileTest, TellsWhatNobodyKnowsOfARecording) {
  glove_.masked = {{MaskReason::kGap, 3, 10, 400},
                   {MaskReason::kRestart, 0, 700, 700},
                   {MaskReason::kClipped, 17, 4000, kSamples}};
  TraceWriter(file_, glove_, reference_, hand_, "test", 1).Commit();
  const std::vector<MaskedStretch> masked = ReadTraceFile(file_).masked;
  ASSERT_EQ(masked.size(), glove_.masked.size());
  for (std::size_t i = 0; i < masked.size(); ++i) {
    EXPECT_EQ(masked[i].reason, glove_.masked[i].reason);
    EXPECT_EQ(masked[i].channel, glove_.masked[i].channel);
    EXPECT_EQ(masked[i].begin, glove_.masked[i].begin);
    EXPECT_EQ(masked[i].end, glove_.masked[i].end);
  }
}

TEST_F(TraceFileTest, LeavesNothingWithoutCommit) {
  { TraceWriter writer(file_, glove_, reference_, hand_, "test", 42); }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(TraceFileTest, RefusesWhatIsNoTrace) {
  EXPECT_THROW(ReadTraceFile(file_), UserError);
  std::ofstream(file_) << "not HDF5";
  EXPECT_THROW(ReadTraceFile(file_), UserError);
}

/// HDF5 locks itself: a copy of the program made while a thread writes would wait for it for ever.
TEST_F(TraceFileTest, AHelperCanReadWhileAThreadWrites) {
  const std::string other = folder_.path() / "other.h5";
  TraceWriter(other, glove_, reference_, hand_, "test", 1).Commit();
  std::atomic<bool> done = false;
  std::thread thread([&] {
    while (!done) TraceWriter(file_, glove_, reference_, hand_, "test", 1).Commit();
  });
  EXPECT_NO_THROW({
    for (int i = 0; i < 50; ++i) {
      HelperProcess([&](const auto&) { H5::H5File(other, H5F_ACC_RDONLY).close(); },
                    {.silence_s = 2})
          .Finish();
    }
  });
  done = true;
  thread.join();
}

TEST_F(TraceFileTest, AFolderThatCannotBeIsARunError) {
  EXPECT_THROW(TraceWriter("/dev/full/trace.h5", glove_, reference_, hand_, "test", 1), RunError);
}

TEST_F(TraceFileTest, AFullDiskIsARunErrorWhereverItHappens) {
  for (disk_room_bytes = 0; disk_room_bytes < 3'000'000; disk_room_bytes += 150'000) {
    EXPECT_THROW(
        {
          TraceWriter writer(file_, glove_, reference_, hand_, "test", 1);
          writer.Add(MakeTrace("raw"));
          writer.Commit();
        },
        RunError)
        << disk_room_bytes;
    EXPECT_TRUE(fs::is_empty(folder_.path())) << disk_room_bytes;
  }
  disk_room_bytes = kEndless;
}

}  // namespace
}  // namespace gauntlet::sim
