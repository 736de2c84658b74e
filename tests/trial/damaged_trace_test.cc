// A trace file that is damaged, or made to do harm, costs one sentence and nothing else.
#include <H5Cpp.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/trial/trace_file.h"
#include "sim/trial/trace_reader.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// So few that most of the file is what HDF5 finds its way by.
constexpr int kTicks = 20;

class DamagedTrace : public testing::Test {
 protected:
  DamagedTrace() {
    glove_.channel_names = GloveChannelNames();
    glove_.true_angle_rad = Signal::Random(kTicks, 18);
    glove_.counts = Signal::Constant(kTicks, 18, 512.0);
    glove_.reference_name = "ground truth";
    glove_.faults = {{.kind = "stuck", .channel = 3, .begin = 1, .end = 4}};
    TraceWriter writer(file_, glove_, Signal::Random(kTicks, 18), hand_, "test", 42);
    writer.Add(MakeTrace("raw"));
    writer.Add(MakeTrace("kalman"));
    writer.Commit();
  }

  Trace MakeTrace(const std::string& name) const {
    Trace trace;
    trace.controller_name = name;
    trace.linearised_angle_rad = Signal::Random(kTicks, 18);
    trace.filtered_angle_rad = Signal::Random(kTicks, 18);
    trace.target_angle_rad = Signal::Random(kTicks, 18);
    trace.command_counts = IntegerSignal::Constant(kTicks, 18, 7);
    trace.spool_angle_rad = Signal::Random(kTicks, 18);
    trace.spool_speed_rad_s = Signal::Random(kTicks, 18);
    trace.hand_angle_rad = Signal::Random(kTicks, 18);
    trace.tension_n = Signal::Random(kTicks, std::ssize(hand_.cable_names()));
    return trace;
  }

  /// What ReadTraceFile says against the file; "" if nothing.
  std::string Problem() const {
    try {
      ReadTraceFile(file_, {.processor_s = 0.1});
      return "";
    } catch (const UserError& error) {
      return error.what();
    }
  }

  /// The same after a change by HDF5's own means.
  std::string ProblemAfter(const std::function<void(H5::H5File&)>& change) const {
    {
      H5::H5File file(file_.string(), H5F_ACC_RDWR);
      change(file);
    }
    return Problem();
  }

  test::TemporaryDirectory folder_;
  fs::path file_ = folder_.path() / "trace.h5";
  HandModel hand_{HandConfig{}};
  GloveSignal glove_;
};

std::string Bytes(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Flipped bits, zeros, an end too soon, two blocks that changed places.
void Damage(std::mt19937& random, std::string& bytes) {
  const auto below = [&random](std::size_t limit) { return random() % limit; };
  switch (below(4)) {
    case 0:
      for (std::size_t flips = 1 + below(8); flips > 0; --flips) {
        bytes[below(bytes.size())] ^= static_cast<char>(1u << below(8));
      }
      break;
    case 1:
      for (std::size_t i = below(bytes.size()), end = i + 1 + below(64);
           i < std::min(end, bytes.size()); ++i) {
        bytes[i] = '\0';
      }
      break;
    case 2:
      bytes.resize(below(bytes.size()));
      break;
    default:
      const std::size_t size = 8u << below(6);
      const std::size_t a = below(bytes.size() - size);
      const std::size_t b = below(bytes.size() - size);
      std::swap_ranges(bytes.begin() + static_cast<std::ptrdiff_t>(a),
                       bytes.begin() + static_cast<std::ptrdiff_t>(a + size),
                       bytes.begin() + static_cast<std::ptrdiff_t>(b));
  }
}

TEST_F(DamagedTrace, IsReadOrRefusedInOneSentence) {
  const std::string whole = Bytes(file_);
  std::mt19937 random(1);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    std::string bytes = whole;
    Damage(random, bytes);
    std::ofstream(file_, std::ios::binary) << bytes;
    const std::string problem = Problem();
    if (problem.empty()) continue;
    ++refused;
    EXPECT_THAT(problem, testing::StartsWith(file_.string() + ": ")) << i;
    EXPECT_EQ(problem.find('\n'), std::string::npos) << i;
  }
  EXPECT_GT(refused, 100);
}

TEST_F(DamagedTrace, MustBeARegularFile) {
  fs::remove(file_);
  EXPECT_THAT(Problem(), HasSubstr("no such file"));
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_THAT(Problem(), HasSubstr("must be a regular file"));
  fs::remove(file_);
  fs::create_symlink("/dev/zero", file_);
  EXPECT_THAT(Problem(), HasSubstr("must be a regular file"));
}

/// Another dataset in place of one.
void Replace(H5::H5File& file, const std::string& name, hsize_t rows, hsize_t columns,
             const H5::DSetCreatPropList& properties = {}) {
  file.unlink(name);
  const hsize_t size[2] = {rows, columns};
  file.createDataSet(name, H5::PredType::IEEE_F32LE, H5::DataSpace(2, size), properties);
}

TEST_F(DamagedTrace, MustHaveSizesThatFitEachOther) {
  const std::string raw = "controllers/raw/";
  EXPECT_THAT(ProblemAfter([&](auto& file) { Replace(file, raw + "hand_angle_rad", kTicks, 17); }),
              HasSubstr("controllers.raw.hand_angle_rad: has 17 columns, must have 18"));
  EXPECT_THAT(ProblemAfter([&](auto& file) { Replace(file, raw + "hand_angle_rad", 19, 18); }),
              HasSubstr("rows, hand_angle_rad has 19"));
  EXPECT_THAT(ProblemAfter([&](auto& file) { file.unlink(raw + "hand_angle_rad"); }),
              HasSubstr("hand_angle_rad has 0"));
  EXPECT_THAT(ProblemAfter([](auto& file) { Replace(file, "glove/true_angle_rad", kTicks, 18); }),
              HasSubstr("H5Aopen failed"));  // no names of columns
  EXPECT_THAT(ProblemAfter([](auto& file) { file.unlink("glove"); }), HasSubstr("H5Gopen2 failed"));
}

TEST_F(DamagedTrace, MustHaveStretchesOfItsOwnMotion) {
  const auto problem_of = [&](const Segment& segment, const MaskedStretch& masked) {
    glove_.segments = {segment};
    glove_.masked = {masked};
    std::filesystem::remove(file_);  // it was read
    TraceWriter(file_, glove_, Signal::Random(kTicks, 18), hand_, "test", 42).Commit();
    return Problem();
  };
  const Segment part = {"slow", 0, kTicks};
  const MaskedStretch gap = {MaskReason::kGap, 3, 4, kTicks};
  EXPECT_EQ(problem_of(part, gap), "");
  EXPECT_THAT(problem_of({"slow", 0, kTicks + 1}, gap),
              HasSubstr("glove.segments: has ticks 0 to 21, the motion 20"));
  EXPECT_THAT(problem_of({"slow", 3, 2}, gap), HasSubstr("glove.segments: has ticks 3 to 2"));
  EXPECT_THAT(problem_of(part, {MaskReason::kGap, 3, -1, 4}),
              HasSubstr("glove.masked: has ticks -1 to 4"));
  EXPECT_THAT(ProblemAfter([](auto& file) {
                file.unlink("glove/masked");
                file.move("glove/segments", "glove/masked");
              }),
              HasSubstr("glove.masked: has a reason that is none"));
}

TEST_F(DamagedTrace, MustNotSayThatItHasMoreThanFitsIntoIt) {
  H5::DSetCreatPropList packed;
  const hsize_t chunk[2] = {1'000'000, 18};
  packed.setChunk(2, chunk);
  packed.setDeflate(9);
  EXPECT_THAT(ProblemAfter([&](auto& file) {
                Replace(file, "controllers/raw/hand_angle_rad", hsize_t{1} << 40, 18, packed);
              }),
              HasSubstr("more signals than fit into its size"));
}

TEST_F(DamagedTrace, MayNotPointToOtherFiles) {
  const fs::path other = folder_.path() / "other";
  std::ofstream(other) << std::string(4 * kTicks * 18, 'x');
  H5::DSetCreatPropList elsewhere;
  elsewhere.setExternal(other.c_str(), 0, 4 * kTicks * 18);
  EXPECT_THAT(ProblemAfter([&](auto& file) {
                Replace(file, "controllers/raw/hand_angle_rad", kTicks, 18, elsewhere);
              }),
              HasSubstr("H5Dread failed"));
  EXPECT_THAT(ProblemAfter([&](auto& file) {
                file.unlink("controllers/raw");
                H5Lcreate_external(file_.c_str(), "controllers/kalman", file.getId(),
                                   "controllers/raw", H5P_DEFAULT, H5P_DEFAULT);
              }),
              HasSubstr("H5Gopen2 failed"));
}

TEST_F(DamagedTrace, MayHoldOnlyFiniteNumbersWhereHandsAreDrawn) {
  EXPECT_THAT(
      ProblemAfter([](auto& file) {
        const std::vector<float> values(kTicks * 18, NAN);
        file.openDataSet("controllers/kalman/hand_angle_rad")
            .write(values.data(), H5::PredType::NATIVE_FLOAT);
      }),
      HasSubstr("controllers.kalman.hand_angle_rad: has values that are no finite numbers"));
}

void SetNumber(H5::H5Object& object, const char* name, double value) {
  object.openAttribute(name).write(H5::PredType::NATIVE_DOUBLE, &value);
}

TEST_F(DamagedTrace, MustHaveARateAndASeed) {
  for (const double rate_hz : {0.0, -1000.0, 1e300, std::nan("")}) {
    EXPECT_THAT(ProblemAfter([&](auto& file) {
                  H5::DataSet truth = file.openDataSet("glove/true_angle_rad");
                  SetNumber(truth, "rate_hz", rate_hz);
                }),
                HasSubstr("rate_hz is "));
  }
  EXPECT_THAT(ProblemAfter([](auto& file) { SetNumber(file, "seed", 1e100); }),
              HasSubstr("seed: is 1e+100"));
}

TEST_F(DamagedTrace, MustNameControllersAsScenariosDo) {
  const auto rename = [](const char* a, const char* b) {
    return [=](H5::H5File& file) {
      H5::StrType text(H5::PredType::C_S1, H5T_VARIABLE);
      text.setCset(H5T_CSET_UTF8);
      const char* names[] = {a, b};
      file.openAttribute("controllers").write(text, static_cast<const void*>(names));
    };
  };
  EXPECT_THAT(ProblemAfter(rename("raw", "raw")), HasSubstr("controllers: raw appears twice"));
  EXPECT_THAT(ProblemAfter(rename("../glove", "raw")), HasSubstr("a name has letters, digits"));
  EXPECT_THAT(ProblemAfter(rename("raw", "other")), HasSubstr("H5Gopen2 failed"));
}

TEST_F(DamagedTrace, TextsMayHaveAFixedLength) {
  EXPECT_EQ(
      ProblemAfter([](auto& file) {
        H5::DataSet truth = file.openDataSet("glove/true_angle_rad");
        truth.removeAttr("columns");
        constexpr std::size_t kLength = 24;
        std::string names;
        for (std::string name : GloveChannelNames()) {
          name.resize(kLength);
          names += name;
        }
        const hsize_t count = GloveChannelNames().size();
        const H5::StrType text(H5::PredType::C_S1, kLength);
        truth.createAttribute("columns", text, H5::DataSpace(1, &count)).write(text, names.data());
      }),
      "");
  EXPECT_EQ(ReadTraceFile(file_).channel_names, GloveChannelNames());
}

TEST_F(DamagedTrace, ReadingEndsWhenTheUserWantsIt) {
  EXPECT_THROW(ReadTraceFile(file_, {.keep_going = [] { return false; }}), Cancelled);
}

}  // namespace
}  // namespace gauntlet::sim
