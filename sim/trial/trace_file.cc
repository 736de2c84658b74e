#include "sim/trial/trace_file.h"

#include <H5Cpp.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "sim/base/error.h"
#include "sim/base/helper_process.h"
#include "sim/base/output_file.h"
#include "sim/base/stop.h"
#include "sim/trial/trace_signals.h"

namespace gauntlet::sim {
namespace {

template <class Scalar>
using RowMajor = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

const H5::PredType& FileType(float) { return H5::PredType::IEEE_F32LE; }
const H5::PredType& FileType(int) { return H5::PredType::STD_I32LE; }
const H5::PredType& FileType(std::uint8_t) { return H5::PredType::STD_U8LE; }
const H5::PredType& MemoryType(float) { return H5::PredType::NATIVE_FLOAT; }
const H5::PredType& MemoryType(int) { return H5::PredType::NATIVE_INT; }
const H5::PredType& MemoryType(std::uint8_t) { return H5::PredType::NATIVE_UINT8; }

const H5::StrType& TextType() {
  static const H5::StrType kType = [] {
    H5::StrType text(H5::PredType::C_S1, H5T_VARIABLE);
    text.setCset(H5T_CSET_UTF8);
    return text;
  }();
  return kType;
}

void WriteText(H5::H5Object& object, const char* name, const std::string& text) {
  object.createAttribute(name, TextType(), H5::DataSpace(H5S_SCALAR)).write(TextType(), text);
}

void WriteNumber(H5::H5Object& object, const char* name, double value) {
  object.createAttribute(name, H5::PredType::IEEE_F64LE, H5::DataSpace(H5S_SCALAR))
      .write(H5::PredType::NATIVE_DOUBLE, &value);
}

void WriteTexts(H5::H5Object& object, const char* name, const std::vector<std::string>& texts) {
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  const hsize_t size = pointers.size();
  const H5::Attribute attribute = object.createAttribute(name, TextType(), H5::DataSpace(1, &size));
  if (size > 0) attribute.write(TextType(), static_cast<const void*>(pointers.data()));
}

/// Some 300 KB of 18 channels: stays in a core's cache.
constexpr Eigen::Index kBlockRows = 4096;

/// Tells how the dataset of a signal is made and filled.
struct DatasetPlace {
  H5::Group& group;
  std::string name;
  std::string unit;
  double rate_hz;
};

/// HDF5 1.10 writes what it still holds when it closes, complains where that fails, and crashes
/// when it closes again. Once a file that the disk did not take is empty, the disk has space for
/// that.
void MakeRoom(const std::string& file) { static_cast<void>(truncate(file.c_str(), 0)); }

/// Block by block through a small buffer: turning the whole matrix at once costs as much memory
/// again, and the time to get it.
template <class Scalar>
void WriteBlocks(H5::DataSet& dataset, const hsize_t (&size)[2], const SignalOf<Scalar>& matrix) {
  RowMajor<Stored<Scalar>> block;
  for (Eigen::Index row = 0; row < matrix.rows(); row += kBlockRows) {
    block = matrix.middleRows(row, std::min(kBlockRows, matrix.rows() - row))
                .template cast<Stored<Scalar>>();
    const hsize_t begin[2] = {static_cast<hsize_t>(row), 0};
    const hsize_t count[2] = {static_cast<hsize_t>(block.rows()), size[1]};
    H5::DataSpace place_in_file(2, size);
    place_in_file.selectHyperslab(H5S_SELECT_SET, count, begin);
    ThrowIfStopped();
    dataset.write(block.data(), MemoryType(Stored<Scalar>{}), H5::DataSpace(2, count),
                  place_in_file);
    TrimSignals();
  }
}

template <class Scalar>
void WriteMatrix(const DatasetPlace& place, const std::vector<std::string>& columns,
                 const SignalOf<Scalar>& matrix) {
  const hsize_t size[2] = {static_cast<hsize_t>(matrix.rows()),
                           static_cast<hsize_t>(matrix.cols())};
  // Without the time of writing, the same signals give the same bytes.
  const H5::DSetCreatPropList properties;
  H5Pset_obj_track_times(properties.getId(), false);
  H5::DataSet dataset = place.group.createDataSet(place.name, FileType(Stored<Scalar>{}),
                                                  H5::DataSpace(2, size), properties);
  try {
    WriteBlocks(dataset, size, matrix);
    WriteText(dataset, "unit", place.unit);
    WriteNumber(dataset, "rate_hz", place.rate_hz);
    WriteTexts(dataset, "columns", columns);
    dataset.close();
  } catch (const H5::Exception&) {
    MakeRoom(place.group.getFileName());  // before the dataset goes
    throw;
  }
}

/// A stretch of samples [begin, end) with a name, and the channel it is about.
struct Stretch {
  const char* name;
  const char* channel;
  int begin;
  int end;
};

/// A table: one row per stretch, columns by name.
void WriteStretches(H5::Group& group, const char* table, const char* name_column,
                    const std::vector<Stretch>& stretches) {
  const H5::CompType row(sizeof(Stretch));
  row.insertMember(name_column, HOFFSET(Stretch, name), TextType());
  row.insertMember("channel", HOFFSET(Stretch, channel), TextType());
  row.insertMember("begin_sample", HOFFSET(Stretch, begin), H5::PredType::NATIVE_INT);
  row.insertMember("end_sample", HOFFSET(Stretch, end), H5::PredType::NATIVE_INT);
  const hsize_t size = stretches.size();
  const H5::DSetCreatPropList properties;
  H5Pset_obj_track_times(properties.getId(), false);
  const H5::DataSet dataset = group.createDataSet(table, row, H5::DataSpace(1, &size), properties);
  if (!stretches.empty()) dataset.write(stretches.data(), row);
}

void WriteFaults(H5::Group& group, const GloveSignal& glove) {
  std::vector<Stretch> stretches;
  for (const FaultEvent& fault : glove.faults) {
    const std::string& channel = glove.channel_names[static_cast<std::size_t>(fault.channel)];
    stretches.push_back({fault.kind.data(), channel.c_str(), fault.begin, fault.end});
  }
  WriteStretches(group, "faults", "kind", stretches);
}

void WriteSegments(H5::Group& group, const GloveSignal& glove) {
  std::vector<Stretch> stretches;
  for (const Segment& segment : glove.segments) {
    stretches.push_back({segment.label.c_str(), "all", segment.begin, segment.end});
  }
  WriteStretches(group, "segments", "label", stretches);
}

/// Unknown motion, in ticks.
/// Remarks that begin with the place of a file, with its name alone: no folder of a person goes
/// with a result.
std::vector<std::string> WithoutFolders(std::vector<std::string> remarks) {
  for (std::string& remark : remarks) {
    const std::string place = remark.substr(0, remark.find(": "));
    remark.replace(0, place.size(), std::filesystem::path(place).filename().string());
  }
  return remarks;
}

void WriteMasked(H5::Group& group, const GloveSignal& glove) {
  std::vector<Stretch> stretches;
  for (const MaskedStretch& masked : glove.masked) {
    const std::string& channel = glove.channel_names[static_cast<std::size_t>(masked.channel)];
    const std::string_view reason = kMaskReasonNames[static_cast<std::size_t>(masked.reason)];
    stretches.push_back({reason.data(), channel.c_str(), masked.begin, masked.end});
  }
  if (!stretches.empty()) WriteStretches(group, "masked", "reason", stretches);
}

/// Runs `action`; what HDF5 throws becomes a RunError about `path`.
template <class Action>
void Guarded(const std::filesystem::path& path, const Action& action) {
  const auto no_helper_starts = HoldHelpers();
  errno = 0;
  try {
    action();
  } catch (const H5::Exception& error) {
    const bool too_many_files = errno == EMFILE || errno == ENFILE;
    throw RunError(fmt::format("{}: cannot write ({}); {}", path.string(), error.getDetailMsg(),
                               too_many_files ? std::strerror(errno) : "is the disk full?"));
  }
}

}  // namespace

struct TraceWriter::State {
  State(const std::filesystem::path& path, TraceColumnNames column_names)
      : target(path), atomic(path), names(std::move(column_names)) {}
  ~State() {
    if (!file) return;  // committed, or never opened
    MakeRoom(atomic.temporary_path().string());
    const auto no_helper_starts = HoldHelpers();
    try {
      Close();
    } catch (const H5::Exception&) {  // the file is given up anyway
    }
  }
  /// Closes the file once, whether or not that succeeds: closing again is what crashes.
  /// Errors: H5::Exception.
  void Close() {
    std::unique_ptr<H5::H5File> closing = std::move(file);
    try {
      closing->close();
    } catch (const H5::Exception&) {
      static_cast<void>(closing.release());
      // HDF5 would close it again at the end of the program.
      on_exit(
          [](int exit_code, void*) {
            std::fflush(nullptr);
            _exit(exit_code);
          },
          nullptr);
      throw;
    }
  }
  std::filesystem::path target;
  OutputFile atomic;
  TraceColumnNames names;
  double tick_rate_hz = 1000.0;
  std::vector<std::string> controllers;
  std::unique_ptr<H5::H5File> file;
};

TraceWriter::TraceWriter(const std::filesystem::path& target, const GloveSignal& glove,
                         const Signal& reference_angle_rad, const HandModel& hand,
                         const std::string& scenario, int seed)
    : state_(std::make_unique<State>(target, TraceColumnNames(glove.channel_names, hand))) {
  H5::Exception::dontPrint();
  state_->tick_rate_hz = glove.tick_rate_hz;
  Guarded(target, [&] {
    state_->file =
        std::make_unique<H5::H5File>(state_->atomic.temporary_path().string(), H5F_ACC_TRUNC);
    WriteText(*state_->file, "scenario", scenario);
    WriteNumber(*state_->file, "seed", seed);
    H5::Group group = state_->file->createGroup("glove");
    WriteText(group, "reference", glove.reference_name);
    WriteMatrix<double>({group, "true_angle_rad", "rad", glove.tick_rate_hz}, glove.channel_names,
                        glove.true_angle_rad);
    WriteMatrix<double>({group, "reference_angle_rad", "rad", glove.tick_rate_hz},
                        hand.joint_names(), reference_angle_rad);
    WriteMatrix<double>({group, "counts", "counts", glove.rate_hz}, glove.channel_names,
                        glove.counts);
    WriteFaults(group, glove);
    WriteSegments(group, glove);
    WriteMasked(group, glove);
    WriteTexts(group, "remarks", WithoutFolders(glove.remarks));
    state_->file->createGroup("controllers");
  });
}

TraceWriter::~TraceWriter() = default;

void TraceWriter::Add(const Trace& trace, const NoiseFreeTwin* twin, const CauseAngles& angles) {
  Guarded(state_->target, [&] {
    H5::Group group = state_->file->createGroup("controllers/" + trace.controller_name);
    const auto write = [&](std::string_view name, std::string_view unit, TraceColumns columns,
                           const auto& matrix) {
      if (matrix.cols() == 0) return;
      WriteMatrix({group, std::string(name), std::string(unit), state_->tick_rate_hz},
                  state_->names.Of(columns), matrix);
    };
    ForEachSignal(trace, [&](const auto& signal, const auto& matrix) {
      write(signal.name, signal.unit, signal.columns, matrix);
    });
    if (twin != nullptr) {
      write("noise_free_hand_angle_rad", "rad", TraceColumns::kJoints, twin->hand_angle_rad);
      write("noise_free_spool_speed_rad_s", "rad/s", TraceColumns::kMotors,
            twin->spool_speed_rad_s);
    }
    constexpr const char* kWithout[] = {"glove",      "link_loss", "link_jitter", "link",
                                        "saturation", "friction",  "servo"};
    static_assert(std::size(kWithout) == kCauseTrialCount - 2);
    for (std::size_t i = 0; i < std::size(kWithout); ++i) {
      write(fmt::format("without_{}_hand_angle_rad", kWithout[i]), "rad", TraceColumns::kJoints,
            angles.without[i + 1]);
    }
    write("asked_angle_rad", "rad", TraceColumns::kJoints, angles.without.back());
    constexpr const char* kSwitched[] = {"noise",      "glove",    "link",
                                         "saturation", "friction", "servo"};
    static_assert(std::size(kSwitched) == kSwitchedCauseCount);
    for (std::size_t i = 0; i < std::size(kSwitched); ++i) {
      write(fmt::format("without_{}_alone_hand_angle_rad", kSwitched[i]), "rad",
            TraceColumns::kJoints, angles.switched_off[i]);
    }
    write("arm_at_rest_hand_angle_rad", "rad", TraceColumns::kJoints, angles.arm_at_rest);
    WriteText(group, "health", trace.health.ok ? "ok" : trace.health.problem);
    state_->controllers.push_back(trace.controller_name);
  });
}

void TraceWriter::Commit() {
  Guarded(state_->target, [&] {
    WriteTexts(*state_->file, "controllers", state_->controllers);
    state_->file->flush(H5F_SCOPE_GLOBAL);
    state_->Close();
  });
  state_->atomic.Commit();
}

}  // namespace gauntlet::sim
